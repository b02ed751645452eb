#include "dynamics/affine/joint_warnings.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
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

/// Rows of the bodies that a motor drives and of those that equations join them with, the nearest first. Bodies that are led go
/// where they are led, so they hold as the world does.
std::map<Index, Eigen::Index> rows_about(const AffineSetup& setup, const DrivenJoint& joint) {
  std::map<Index, Eigen::Index> found;
  std::vector<Index> order;
  const auto visit = [&](Index row) {
    if (row < 0 || row >= setup.first_led_row || order.size() >= kMostHeld) return;
    if (found.emplace(row, static_cast<Eigen::Index>(order.size())).second) order.push_back(row);
  };
  for (const Index body : joint.body)
    if (body >= 0) visit(setup.bodies[static_cast<std::size_t>(body)].row);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Index row = order[k];
    for (const NodeEquation& e : setup.equations)
      if (e.row[0] == row || e.row[1] == row)
        for (const Index other : e.row) visit(other);
  }
  return found;
}

/// Whether equations leave a way no motion that would change it.
bool is_held(const AffineSetup& setup, const DrivenJoint& joint, const DriveTerm& term) {
  const std::map<Index, Eigen::Index> rows = rows_about(setup, joint);
  const RigidSlopes slopes(setup, rows);
  Eigen::VectorXd way = Eigen::VectorXd::Zero(slopes.size());
  for (std::size_t side = 0; side < 2; ++side)
    if (joint.body[side] >= 0)
      slopes.add(setup.bodies[static_cast<std::size_t>(joint.body[side])].row, term.slope[side],
                 way);
  if (!(way.norm() > 0)) return false;  // of bodies that rest or are led
  std::vector<Eigen::VectorXd> held;
  for (const NodeEquation& e : setup.equations) {
    const auto is_known = [&](Index row) {  // far bodies are loose, and so is what holds to them
      return row < 0 || row >= setup.first_led_row || rows.contains(row);
    };
    if (!is_known(e.row[0]) || !is_known(e.row[1])) continue;
    for (int d = 0; d < e.count; ++d) {
      Eigen::VectorXd each = Eigen::VectorXd::Zero(slopes.size());
      for (int side = 0; side < 2; ++side) {
        AffineVec slope;
        for (int k = 0; k < 4; ++k) slope.node[k] = e.weight[side][k] * e.direction[d];
        slopes.add(e.row[side], slope, each);
      }
      if (each.norm() > 0) held.push_back(each.normalized());
    }
  }
  if (held.empty()) return false;
  Eigen::MatrixXd all(slopes.size(), static_cast<Eigen::Index>(held.size()));
  for (std::size_t k = 0; k < held.size(); ++k) all.col(static_cast<Eigen::Index>(k)) = held[k];
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> span(all);
  span.setThreshold(1e-9);
  Eigen::VectorXd left = span.householderQ().adjoint() * way;
  return left.tail(left.size() - span.rank()).norm() < 1e-6 * way.norm();
}

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
  for (Index j = 0; j < count; ++j) {
    const auto k = static_cast<std::size_t>(j);
    const DrivenJoint& joint = setup.drives[k];
    const DriveLaw& law = joint.law;
    set(j);
    const double off = std::max(law.lower - position[k], position[k] - law.upper);
    const char* unit = joint.slides ? "m" : "rad";
    if (off > kRounding * (joint.slides ? setup.size : 1))
      limits.add(
          setup.joint_of_drive[k],
          fmt::format("its bodies began apart, {:.3g} {} beyond its \"limits\" [{:g}, {:g}]: "
                      "the first step takes them there, at {:.3g} {}/s",
                      off, unit, law.lower, law.upper, off / time_step, unit));
    const bool is_unbounded = law.most == INFINITY && !(law.stiffness > 0 || law.damping > 0);
    if (is_unbounded && law.speed != 0 && is_held(setup, joint, terms[k]))
      motors.add(setup.joint_of_drive[k],
                 "its motor has no \"max_force\", and other joints or locks hold what it drives: "
                 "they contradict each other, and it does not move");
  }
  std::vector<std::string> warnings;
  for (const Told* told : {&limits, &motors})
    if (told->count > 0) warnings.push_back(told->text());
  return warnings;
}

}  // namespace scree::affine
