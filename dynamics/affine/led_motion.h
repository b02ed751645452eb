#pragma once
// Bodies whose motion is prescribed: where they are in it, and which part of a step they go. All go the same part, and what they
// miss of their motion they do later.

#include <utility>
#include <vector>

#include "dynamics/affine/affine_setup.h"

namespace scree::affine {

class LedMotion {
 public:
  explicit LedMotion(std::vector<LedBody> bodies)
      : bodies_(std::move(bodies)), time_(bodies_.size()) {}

  int count() const { return static_cast<int>(bodies_.size()); }

  /// A step begins: they try the whole of it, or of one after a step that squeezed a body somewhat more than they went in that.
  void begin();
  /// Where they should be after the part of a step that they try. @param h  of the step [s]
  std::vector<AffineVec> targets(double h) const;
  /// That part squeezed a body: they try a smaller one, at last none.
  void shorten(double h);
  /// Whether they try none.
  bool stay() const { return part_ == 0; }
  bool is_slow() const { return part_ < 1; }
  /// They went that part.
  void end(double h);

  /// Largest turn of one in a step to come that is made in equal parts, of one of these [rad]
  double turn(double h, int parts) const;
  /// How far their motion is behind a time [s].
  double delay(double now) const;

  const std::vector<double>& time() const { return time_; }
  std::vector<double> part() const { return {last_, rise_}; }
  /// @throws InputError when these are not of such bodies
  void restore(const std::vector<double>& time, const std::vector<double>& part);

 private:
  /// Least part of a step that they go, and by which that grows; and what is left of a part after a try.
  static constexpr double kLeastPart = 1.0 / 1024, kLeft = 0.25;

  AffineVec place(std::size_t body, double ahead) const;
  bool moves(double h) const;

  std::vector<LedBody> bodies_;
  std::vector<double> time_;  ///< of their motions [s]
  double part_ = 1;           ///< of the step that they try
  bool is_short_ = false;     ///< whether it is not what the step began with
  double last_ = 1;           ///< that they went in the step before
  double rise_ = 1;           ///< by which the next part is larger
};

}  // namespace scree::affine
