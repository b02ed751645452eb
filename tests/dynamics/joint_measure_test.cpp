// How the rows of joints turn with what they measure: first and second derivatives of positions, by differences.

#include "kernels/step/joint_measure.h"

#include <gtest/gtest.h>

#include <functional>

namespace scree {
namespace {

using Way = std::function<Quat<double>(double)>;  ///< axes of a joint on one body, by time

constexpr double kTick = 2e-4;

/// Rotation velocity in the middle of an interval of two ticks.
Vec3<double> turning_at(const Way& way, double time) {
  const Quat<double> q = way(time + kTick) * conjugate(way(time - kTick));
  const Vec3<double> half{q.x, q.y, q.z};
  const double sine = norm(half);
  return (std::asin(sine) / (kTick * sine)) * half;
}

JointSide side_of(const Way& way, double time) {
  JointSide s;
  s.frame = way(time);
  s.turning = turning_at(way, time);
  s.acceleration =
      (1 / (2 * kTick)) * (turning_at(way, time + kTick) - turning_at(way, time - kTick));
  return s;
}

JointMeasure measure_at(JointForm form, const Way& a, const Way& b, double time) {
  JointSide first = side_of(a, time);
  return measure_joint(form, 0, 0, first, side_of(b, time), {});
}

/// Rates of the row are those of the position, and of its second derivative.
void expect_rates(JointForm form, const Way& a, const Way& b) {
  const auto position = [&](double time) { return measure_at(form, a, b, time).position; };
  for (const double time : {0.0, 0.3, 0.7}) {
    const JointMeasure m = measure_at(form, a, b, time);
    const JointSide first = side_of(a, time), second = side_of(b, time);
    const double rate = (position(time + kTick) - position(time - kTick)) / (2 * kTick);
    const double change =
        (position(time + kTick) - 2 * m.position + position(time - kTick)) / (kTick * kTick);
    EXPECT_NEAR(turning_about_axis(m.frame, first.turning, second.turning), m.gear * rate, 1e-5)
        << time;
    const JointDrift drift = drift_of_joint(form, m, first, second, 1e-6);
    EXPECT_NEAR(dot(rotate(m.frame, {0, 0, 1}), drift.angular), m.gear * change, 1e-3) << time;
  }
}

/// A body that tumbles.
Quat<double> tumbling(double time) {
  return exp_map(Vec3<double>{0.4 + 1.1 * time, -0.9 * time + 0.5 * time * time, 0.3}) *
         exp_map(Vec3<double>{0.7 * time * time, 0.2, 1.3 * time});
}

TEST(JointMeasure, SwingAndTwistTurnAsTheirRowsDo) {
  const Way other = [](double time) {
    return tumbling(time) * exp_map(Vec3<double>{0.6 + 0.8 * time, 0.4 - time, 0.5 * time}) *
           exp_map(Vec3<double>{0, 0, 0.9 * time});
  };
  for (const JointForm form : {JointForm::swing, JointForm::twist}) {
    expect_rates(form, tumbling, other);
    expect_rates(form, other, tumbling);
  }
}

// The twist is the angle that is put behind a shortest rotation of the axis, either way round.
TEST(JointMeasure, TwistIsWhatIsLeftOfARotationWithoutItsSwing) {
  for (const double swing : {0.0, 0.5, 1.7, 2.9}) {
    for (const double twist : {-2.0, 0.3, 3.0}) {
      JointSide a, b;
      a.frame = tumbling(0.4);
      b.frame = a.frame * exp_map(swing * Vec3<double>{0.6, -0.8, 0}) *
                exp_map(Vec3<double>{0, 0, twist});
      JointSide one = a, other = b;
      const JointMeasure m = measure_joint(JointForm::twist, 0, 0, one, b, {});
      EXPECT_NEAR(m.position, twist, 1e-12);
      EXPECT_NEAR(m.gear, std::cos(swing / 2), 1e-12);
      EXPECT_NEAR(measure_joint(JointForm::twist, 0, 0, other, a, {}).position, -twist, 1e-12);
      EXPECT_NEAR(measure_joint(JointForm::swing, 0, 0, one, b, {}).position, swing, 1e-12);
    }
  }
}

// Two turns, one after the other, of a universal joint: each row measures its own, past a quarter of a turn and past half of one.
TEST(JointMeasure, TurnsOfAUniversalJointAreThoseAboutItsAxes) {
  const auto axes_along = [](const Vec3<double>& axis, const Vec3<double>& across) {
    const Quat<double> some = rotation_to(axis);
    const Vec3<double> x = rotate(some, {1, 0, 0});
    return exp_map(std::atan2(dot(axis, cross(x, across)), dot(x, across)) * axis) * some;
  };
  const Quat<double> first = axes_along({1, 0, 0}, {0, 1, 0}),
                     second = axes_along({0, 1, 0}, {1, 0, 0});
  const auto first_angle = [](double time) { return 0.4 + 2 * time - 1.5 * time * time; };
  const auto second_angle = [](double time) { return 2.5 + 1.5 * time; };
  const Way body = tumbling;
  const Way other = [&](double time) {
    return tumbling(time) * exp_map(Vec3<double>{first_angle(time), 0, 0}) *
           exp_map(Vec3<double>{0, second_angle(time), 0});
  };
  const auto with = [](const Way& way, const Quat<double>& axes) {
    return [way, axes](double time) { return way(time) * axes; };
  };
  for (const bool is_turned : {false, true}) {
    for (const bool is_second : {false, true}) {
      const Quat<double> axes = is_second ? second : first;
      const JointForm form =
          form_of_sides(is_second ? JointForm::second_turn : JointForm::turn, is_turned);
      const Way a = with(is_turned ? other : body, axes), b = with(is_turned ? body : other, axes);
      const double sign = is_turned ? -1 : 1;
      for (const double time : {0.0, 0.5, 1.1}) {
        const double angle = is_second ? second_angle(time) : first_angle(time);
        EXPECT_NEAR(
            std::remainder(measure_at(form, a, b, time).position - sign * angle, 6.283185307179586),
            0, 1e-12);
      }
      expect_rates(form, a, b);
    }
  }
}

}  // namespace
}  // namespace scree
