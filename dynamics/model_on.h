#pragma once
// What models of dynamics share on backend B in precision Real: the backend itself, time, constants
// of bodies, arrays by name, pictures.

#include <chrono>
#include <functional>
#include <optional>
#include <utility>

#include "dynamics/dynamics.h"
#include "dynamics/model_errors.h"
#include "host/render/labels.h"
#include "host/render/renderer.h"

namespace scree {

/// Wall clock of a stage; waits for the device so that stages do not run into each other.
template <class B>
class StageClock {
 public:
  explicit StageClock(B& b) : b_(&b), last_(Clock::now()) {}
  /// Since the last call [ms].
  double lap() {
    b_->synchronize();
    const auto now = Clock::now();
    return std::chrono::duration<double, std::milli>(now - std::exchange(last_, now)).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  B* b_;
  Clock::time_point last_;
};

template <class B>
std::unique_ptr<B> make_backend(const WorldOptions& options) {
  if constexpr (B::kIsDevice) {
    return std::make_unique<B>(options.device);
  } else {
    return std::make_unique<B>(options.threads);
  }
}

template <class B, class Real>
class ModelOn : public Dynamics {
 public:
  std::int64_t steps_done() const final { return step_; }
  double time() const final { return time_; }
  const BodyConstants& constants() const final { return constants_; }

  std::vector<ArrayInfo> arrays() final {
    std::vector<ArrayInfo> known;
    for_each_array([&](const ArrayInfo& info, const MakeView&) { known.push_back(info); });
    return known;
  }

  ArrayView array(const std::string& name) final {
    std::optional<ArrayView> found;
    for_each_array([&](const ArrayInfo& info, const MakeView& make) {
      if (info.name != name) return;
      found = make();
      found->writable = info.writable;
    });
    if (!found) throw_unknown_array(name, arrays());
    backend_->synchronize();
    if constexpr (B::kIsDevice) {
      found->backend = BackendKind::cuda;
      found->device = backend_->device();
      found->stream = backend_->stream();
    }
    return *found;
  }

  WorldState save() final {
    WorldState s;
    s.dynamics = model_;
    s.step = step_;
    s.time = time_;
    save_arrays(s);
    return s;
  }
  void restore(const WorldState& s) final {
    if (s.dynamics != model_) throw_wrong_model(s.dynamics, model_);
    restore_arrays(s);
    step_ = s.step;
    time_ = s.time;
  }

  Image render(const PictureSettings& settings) override {
    render::ColorRange range;
    const Drawn bodies = drawn();
    Image image =
        renderer_.render(*backend_, bodies.bodies, bodies.shapes, bodies.meshes, settings, &range);
    if (settings.labels) render::add_labels(image, settings.color_by, range, time_, time_step_);
    return image;
  }

  int cuda_device() const final {
    if constexpr (B::kIsDevice) {
      return backend_->device();
    } else {
      return -1;
    }
  }
  std::size_t memory() const final { return backend_->allocated(); }
  std::size_t peak_memory() const final { return backend_->peak(); }

 protected:
  ModelOn(std::unique_ptr<B> backend, const Scene& scene)
      : backend_(std::move(backend)),
        constants_(scene),
        model_(scene.dynamics.type),
        time_step_(scene.stepping.time_step),
        renderer_(*backend_) {}

  /// Bodies as pictures show them, all in backend memory.
  struct Drawn {
    BodyView<Real> bodies;
    Span<const ShapeRecord<Real>> shapes = {};  ///< records that BodyView::shape points to
    MeshSetView<Real> meshes = {};
  };
  virtual Drawn drawn() = 0;

  /// The arrays that the card of the model names, and insertions; the rest of a state is there.
  virtual void save_arrays(WorldState& s) = 0;
  virtual void restore_arrays(const WorldState& s) = 0;

  using MakeView = std::function<ArrayView()>;
  using VisitArray = std::function<void(const ArrayInfo&, const MakeView&)>;
  /// Calls visit(info, make) for every array that programs may ask for; make() gives its view.
  virtual void for_each_array(const VisitArray& visit) = 0;

  B& backend() { return *backend_; }

  /// One more step is done. Time is a product, not a sum, so that resumed runs have the same.
  void count_step() {
    ++step_;
    time_ = static_cast<double>(step_) * time_step_;
  }

 private:
  std::unique_ptr<B> backend_;  // first: arrays of a model give their memory back to it
  BodyConstants constants_;
  std::string model_;
  double time_step_;  ///< [s]
  Renderer<B, Real> renderer_;
  std::int64_t step_ = 0;
  double time_ = 0;
};

}  // namespace scree
