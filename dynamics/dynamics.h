#pragma once
// The simulation behind World, one implementation per backend and precision. What a step
// is stands behind it.

#include "host/world.h"

namespace scree {

class Dynamics {
 public:
  virtual ~Dynamics() = default;
  virtual StepReport step(BodyProblem* problem) = 0;
  /// CUDA device that must be the current one during a call; negative: none.
  virtual int cuda_device() const = 0;
  virtual std::int64_t steps_done() const = 0;
  virtual double time() const = 0;
  virtual int body_count() const = 0;
  virtual BodyStates states() = 0;
  virtual const BodyConstants& constants() const = 0;
  virtual std::vector<ContactRecord> contacts() = 0;
  virtual std::vector<ContactRecord> overlaps() = 0;
  virtual std::vector<ArrayInfo> arrays() = 0;
  virtual ArrayView array(const std::string& name) = 0;
  virtual void arrays_changed(Written what) = 0;
  virtual WorldState save() = 0;
  virtual void restore(const WorldState& state) = 0;
  virtual Image render(const PictureSettings& settings) = 0;
  virtual std::size_t memory() const = 0;
  virtual std::size_t peak_memory() const = 0;
};

/// Compiled once per backend: B is Cpu or Cuda.
template <class B>
std::unique_ptr<Dynamics> make_dynamics(Scene scene, const WorldOptions& options);

}  // namespace scree
