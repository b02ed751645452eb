#include "dynamics/affine/joint_warnings.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>

namespace scree::affine {
namespace {

/// Bodies about a motor that are looked at. Those farther off count as loose, so what they hold is not told.
constexpr std::size_t kMostHeld = 16;

/// Slopes of one way of bodies by the motions of these as rigid ones: velocities, and spins times a length.
class RigidSlopes {
 public:
  RigidSlopes(const AffineSetup& setup, std::map<Index, Eigen::Index> place_of_row)
      : setup_(setup), place_of_row_(std::move(place_of_row)) {}

  Eigen::Index size() const { return 6 * static_cast<Eigen::Index>(place_of_row_.size()); }

  /// Adds those of one body to `to`. @param row  -1, or of a body that is not looked at: there are none
  void add(Index row, const AffineVec& slope, Eigen::VectorXd& to) const {
    const auto found = place_of_row_.find(row);
    if (found == place_of_row_.end()) return;
    const auto body = static_cast<std::size_t>(setup_.body_of_row[static_cast<std::size_t>(row)]);
    const AffineVec& q = setup_.position[body];
    Vec3d turn;
    for (int k = 1; k < 4; ++k) turn += cross(q.node[k], slope.node[k]);
    turn *= 1 / setup_.bodies[body].radius;
    for (int k = 0; k < 3; ++k) {
      to[6 * found->second + k] += slope.node[0][k];
      to[6 * found->second + 3 + k] += turn[k];
    }
  }

 private:
  const AffineSetup& setup_;
  std::map<Index, Eigen::Index> place_of_row_;
};

/// Whether a motor keeps its speed whatever it takes.
bool is_unbounded(const DriveLaw& law) {
  return law.most == INFINITY && !(law.stiffness > 0 || law.damping > 0);
}

/// -1 of the world.
Index row_of(const AffineSetup& setup, Index body) {
  return body < 0 ? -1 : setup.bodies[static_cast<std::size_t>(body)].row;
}

bool has_led_body(const AffineSetup& setup, const DrivenJoint& joint) {
  return std::any_of(std::begin(joint.body), std::end(joint.body),
                     [&](Index body) { return row_of(setup, body) >= setup.first_led_row; });
}

/// Motors that hold the way of another one, for which they are in `drives`: those without a bound. What a led body does is not known
/// here, so motors of such hold nothing, and are held by equations alone.
std::vector<std::size_t> motors_beside(const AffineSetup& setup, std::size_t motor) {
  std::vector<std::size_t> beside;
  if (has_led_body(setup, setup.drives[motor])) return beside;
  for (std::size_t k = 0; k < setup.drives.size(); ++k)
    if (k != motor && is_unbounded(setup.drives[k].law) && !has_led_body(setup, setup.drives[k]))
      beside.push_back(k);
  return beside;
}

/// Rows of the bodies that a motor drives and of those that equations and other motors join them with, the nearest first. Bodies
/// that are led go where they are led, so they hold as the world does.
std::map<Index, Eigen::Index> rows_about(const AffineSetup& setup, const DrivenJoint& joint,
                                         const std::vector<std::size_t>& motors) {
  std::map<Index, Eigen::Index> found;
  std::vector<Index> order;
  const auto visit = [&](Index row) {
    if (row < 0 || row >= setup.first_led_row || order.size() >= kMostHeld) return;
    if (found.emplace(row, static_cast<Eigen::Index>(order.size())).second) order.push_back(row);
  };
  for (const Index body : joint.body) visit(row_of(setup, body));
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Index row = order[k];
    for (const NodeEquation& e : setup.equations)
      if (e.row[0] == row || e.row[1] == row)
        for (const Index other : e.row) visit(other);
    for (const std::size_t motor : motors) {
      const Index(&body)[2] = setup.drives[motor].body;
      if (row_of(setup, body[0]) == row || row_of(setup, body[1]) == row)
        for (const Index other : body) visit(row_of(setup, other));
    }
  }
  return found;
}

/// Ways of bodies and the rates at which they are held.
class HeldWays {
 public:
  HeldWays(const AffineSetup& setup, const std::vector<DriveTerm>& terms, std::size_t motor)
      : setup_(setup),
        terms_(terms),
        motors_(motors_beside(setup, motor)),
        rows_(rows_about(setup, setup.drives[motor], motors_)),
        slopes_(setup, rows_) {
    for (const NodeEquation& e : setup.equations) {
      if (!is_known(e.row[0]) || !is_known(e.row[1])) continue;
      for (int d = 0; d < e.count; ++d) {
        Eigen::VectorXd way = Eigen::VectorXd::Zero(slopes_.size());
        for (int side = 0; side < 2; ++side) {
          AffineVec slope;
          for (int k = 0; k < 4; ++k) slope.node[k] = e.weight[side][k] * e.direction[d];
          slopes_.add(e.row[side], slope, way);
        }
        hold(way, 0);
      }
    }
    for (const std::size_t k : motors_) {
      const DrivenJoint& joint = setup.drives[k];
      if (is_known(row_of(setup, joint.body[0])) && is_known(row_of(setup, joint.body[1])))
        hold(way_of(k), joint.law.speed);
    }
  }

  /// Whether a motor is held at another rate than its own.
  bool contradict(std::size_t motor) const {
    const Eigen::VectorXd way = way_of(motor);
    if (held_.empty() || !(way.norm() > 0)) return false;  // of bodies that rest or are led
    const auto count = static_cast<Eigen::Index>(held_.size());
    Eigen::MatrixXd all(slopes_.size(), count);
    for (Eigen::Index k = 0; k < count; ++k) all.col(k) = held_[static_cast<std::size_t>(k)];
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> span(all);
    span.setThreshold(1e-9);
    const Eigen::VectorXd left = span.householderQ().adjoint() * way;
    if (!(left.tail(left.size() - span.rank()).norm() < kSame * way.norm())) return false;
    const Eigen::VectorXd part = span.solve(way);
    double rate = 0, largest = std::abs(setup_.drives[motor].law.speed);
    for (Eigen::Index k = 0; k < count; ++k) {
      const double its = part[k] * rate_[static_cast<std::size_t>(k)];
      rate += its, largest = std::max(largest, std::abs(its));
    }
    return std::abs(rate - setup_.drives[motor].law.speed) > kSame * largest;
  }

 private:
  static constexpr double kSame = 1e-6;

  /// Far bodies are loose, and so is what holds to them.
  bool is_known(Index row) const {
    return row < 0 || row >= setup_.first_led_row || rows_.contains(row);
  }
  Eigen::VectorXd way_of(std::size_t drive) const {
    Eigen::VectorXd way = Eigen::VectorXd::Zero(slopes_.size());
    for (std::size_t side = 0; side < 2; ++side)
      slopes_.add(row_of(setup_, setup_.drives[drive].body[side]), terms_[drive].slope[side], way);
    return way;
  }
  void hold(const Eigen::VectorXd& way, double rate) {
    const double size = way.norm();
    if (!(size > 0)) return;
    held_.push_back(way / size);
    rate_.push_back(rate / size);
  }

  const AffineSetup& setup_;
  const std::vector<DriveTerm>& terms_;
  std::vector<std::size_t> motors_;
  std::map<Index, Eigen::Index> rows_;
  RigidSlopes slopes_;
  std::vector<Eigen::VectorXd> held_;  ///< unit
  std::vector<double> rate_;           ///< of each
};

/// A warning of many joints.
struct Told {
  std::size_t first = 0, count = 0;
  std::string what;  ///< of the first
  void add(std::size_t joint, const std::string& its) {
    if (count++ == 0) first = joint, what = its;
  }
  std::string text() const {
    const std::string more = count > 1 ? fmt::format(", and {} more joints so", count - 1) : "";
    return fmt::format("joints[{}]: {}{}", first, what, more);
  }
};

}  // namespace

std::vector<std::string> joint_warnings(const AffineSetup& setup, double time_step) {
  constexpr double kRounding = 1e-9;
  const auto count = static_cast<Index>(setup.drives.size());
  std::vector<double> position(setup.drives.size());
  std::vector<DriveTerm> terms(setup.drives.size());
  const SetDrives set{{setup.drives.data(), count},
                      {setup.position.data(), std::ssize(setup.position)},
                      time_step,
                      {position.data(), count},
                      {terms.data(), count}};
  Told limits, motors;
  for (Index j = 0; j < count; ++j) set(j);
  for (Index j = 0; j < count; ++j) {
    const auto k = static_cast<std::size_t>(j);
    const DrivenJoint& joint = setup.drives[k];
    const DriveLaw& law = joint.law;
    const double off = std::max(law.lower - position[k], position[k] - law.upper);
    const char* unit = joint.slides ? "m" : "rad";
    if (off > kRounding * (joint.slides ? setup.size : 1))
      limits.add(
          setup.joint_of_drive[k],
          fmt::format("its bodies began apart, {:.3g} {} beyond its \"limits\" [{:g}, {:g}]: "
                      "the first step takes them there, at {:.3g} {}/s",
                      off, unit, law.lower, law.upper, off / time_step, unit));
    if (is_unbounded(law) && HeldWays(setup, terms, k).contradict(k))
      motors.add(setup.joint_of_drive[k],
                 "its motor has no \"max_force\", and other joints, locks or such motors hold what "
                 "it drives: they contradict each other, and it does not keep its speed");
  }
  std::vector<std::string> warnings;
  for (const Told* told : {&limits, &motors})
    if (told->count > 0) warnings.push_back(told->text());
  return warnings;
}

}  // namespace scree::affine
