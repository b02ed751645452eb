#include "host/io/ipc_states.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "dynamics/dynamics_card.h"
#include "host/error.h"
#include "host/io/atomic_file.h"
#include "host/scene/free_mesh.h"
#include "host/scene/surface_mass.h"

namespace scree {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Json = nlohmann::json;

constexpr std::size_t kLeastTriangles = 4;  // of a solid

/// A body as rigid-ipc sees it.
struct PrincipalBody {
  double mass = 0;                                ///< [kg]
  Vector3d moments = Vector3d::Zero();            ///< of inertia, ascending [kg m^2]
  Vec3d center;                                   ///< of mass, in our frame of the body [m]
  Matrix3d axes = Matrix3d::Identity();           ///< principal, in our frame of the body
  Matrix3d axes_at_start = Matrix3d::Identity();  ///< the same in the world
  bool has_potential = true;                      ///< it is not held along x and y
};

Vector3d to_eigen(const Vec3d& v) { return {v.x, v.y, v.z}; }
Matrix3d to_eigen(const Quatd& q) {
  return Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
}
Json to_json(const Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }
Json to_json(const Matrix3d& m) {
  return Json::array(
      {to_json(Vector3d(m.row(0))), to_json(Vector3d(m.row(1))), to_json(Vector3d(m.row(2)))});
}
Matrix3d cross_matrix(const Vector3d& w) {
  Matrix3d m;
  m << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return m;
}

/// Of `is_dof_fixed`, as the fixture has it.
std::array<bool, 6> held_of(const Json& entry) {
  std::array<bool, 6> held{};
  const auto key = entry.find("is_dof_fixed");
  if (key == entry.end()) return held;
  for (std::size_t k = 0; k < 6; ++k)
    held[k] = key->is_array() ? key->at(k).get<bool>() : key->get<bool>();
  return held;
}

/// Sum of m_v (x_v - center)_i (x_v - center)_j.
Matrix3d second_moments(const std::vector<double>& mass, const TriangleMesh& mesh,
                        const Vec3d& center) {
  Matrix3d sum = Matrix3d::Zero();
  for (std::size_t v = 0; v < mass.size(); ++v) {
    const Vector3d x = to_eigen(mesh.vertices[v] - center);
    sum += mass[v] * x * x.transpose();
  }
  return sum;
}

/// @param mesh   surface of the body in its own frame
/// @param entry  of the fixture
PrincipalBody principal_body(const TriangleMesh& mesh, const BodyDescription& body,
                             const Json& entry) {
  PrincipalBody found;
  const Matrix3d turn = to_eigen(body.orientation);
  const double density = entry.value("density", 1000.0);
  Matrix3d second;  // of density 1, in the frame of the body
  const SolidMoments solid =
      mesh.triangles.size() >= kLeastTriangles ? moments_inside(mesh) : SolidMoments{};
  if (solid.volume > 0) {
    found.mass = solid.volume;
    found.center = solid.center;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        second(i, j) =
            solid.volume * solid.second[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  } else {
    const std::vector<double> area = vertex_areas(mesh);
    for (const double a : area) found.mass += a;
    found.center = center_of_surface(mesh);
    second = second_moments(area, mesh, found.center);
  }
  const Matrix3d in_world = turn * second * turn.transpose();
  Matrix3d inertia = in_world.trace() * Matrix3d::Identity() - in_world;
  const double least = 1e-16 * inertia.lpNorm<Eigen::Infinity>();
  inertia = (inertia.array().abs() > least).select(inertia, 0.0);
  const std::array<bool, 6> held = held_of(entry);
  if (std::count(held.begin() + 3, held.end(), true) == 2) {
    found.moments = inertia.diagonal();
  } else {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(inertia);
    found.moments = solver.eigenvalues().cwiseAbs();
    found.axes_at_start = solver.eigenvectors();
    if (found.axes_at_start.determinant() < 0) found.axes_at_start.col(0) *= -1;
  }
  found.axes = turn.transpose() * found.axes_at_start;
  found.mass *= density;
  found.moments *= density;
  found.has_potential = body.kind != BodyKind::fixed && !held[0] && !held[1];
  return found;
}

std::vector<PrincipalBody> principal_bodies(const IpcRun& run) {
  std::vector<PrincipalBody> bodies;
  const Json& entries = run.fixture.at("rigid_body_problem").at("rigid_bodies");
  for (const BodyDescription& body : run.scene.bodies)
    bodies.push_back(principal_body(run.scene.meshes.at(static_cast<std::size_t>(body.shape.mesh)),
                                    body, entries.at(static_cast<std::size_t>(body.entry))));
  return bodies;
}

/// Gap to the nearest body after a step, or nothing where none is within reach.
class Gaps {
 public:
  explicit Gaps(const Scene& scene) : reach_(scene.dynamics.parameters.at("reach")) {
    for (const ReportColumn& column : dynamics_card(scene.dynamics.type).report)
      if (std::string_view(column.name) == "min_gap_m") column_ = &column;
    if (column_ == nullptr) throw std::logic_error("the dynamics report no gap");
  }
  std::optional<double> of(const StepReport& step) const {
    double gap = 0;
    with_value(*column_, step, [&](auto value) { gap = static_cast<double>(value); });
    return gap < reach_ ? std::optional(gap) : std::nullopt;
  }

 private:
  double reach_;  ///< [m]
  const ReportColumn* column_ = nullptr;
};

/// States one after the other: rates of rotation are differences.
class StateText {
 public:
  StateText(const IpcRun& run, std::vector<PrincipalBody> bodies)
      : run_(run), gaps_(run.scene), bodies_(std::move(bodies)), before_(bodies_.size()) {}

  /// @param frame  the one after that of the last call
  std::string of(std::size_t frame) {
    const BodyStates states = run_.frames.states(frame);
    const Vector3d gravity = to_eigen(run_.scene.gravity);
    Vector3d momentum = Vector3d::Zero(), angular = Vector3d::Zero();
    double kinetic = 0, potential = 0;
    Json list = Json::array();
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const PrincipalBody& body = bodies_[i];
      const Matrix3d turn = to_eigen(states.orientation[i]);
      const Vector3d arm = turn * to_eigen(body.center);
      const Vector3d spin = to_eigen(states.angular_velocity[i]);
      const Vector3d x = to_eigen(states.position[i]) + arm;
      const Vector3d v = to_eigen(states.velocity[i]) + spin.cross(arm);
      const Matrix3d q = turn * body.axes;
      const Vector3d w = body.axes_at_start.transpose() * spin;
      const Matrix3d rate = frame == 0 ? Matrix3d(q * cross_matrix(w))
                                       : Matrix3d((q - before_[i]) / run_.scene.stepping.time_step);
      const Eigen::AngleAxisd rotation(q);
      list.push_back({{"position", to_json(x)},
                      {"rotation", to_json(Vector3d(rotation.angle() * rotation.axis()))},
                      {"linear_velocity", to_json(v)},
                      {"angular_velocity", to_json(w)},
                      {"Qdot", to_json(rate)},
                      {"Qddot", to_json(Matrix3d(Matrix3d::Zero()))}});
      before_[i] = q;
      const Vector3d spun = body.moments.cwiseProduct(w);
      momentum += body.mass * v;
      angular += spun;
      kinetic += 0.5 * (body.mass * v.squaredNorm() + w.dot(spun));
      if (body.has_potential) potential -= body.mass * gravity.dot(x);
    }
    const std::optional<double> gap = frame == 0 ? std::nullopt : gaps_.of(run_.steps[frame - 1]);
    return Json{
        {"rigid_bodies", std::move(list)},      {"linear_momentum", to_json(momentum)},
        {"angular_momentum", to_json(angular)}, {"kinetic_energy", kinetic},
        {"potential_energy", potential},        {"min_distance", gap ? Json(*gap) : Json(nullptr)}}
        .dump();
  }

 private:
  const IpcRun& run_;
  Gaps gaps_;
  std::vector<PrincipalBody> bodies_;
  std::vector<Matrix3d> before_;  ///< rotation matrices of the state before
};

std::size_t edge_count(const TriangleMesh& mesh) {
  std::set<std::pair<int, int>> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.insert(std::minmax(t[k], t[(k + 1) % 3]));
  return edges.size();
}

/// @param steps  of run.steps, as many as there are states after the first
Json stats_of(const IpcRun& run, std::size_t steps) {
  Json stats{{"dim", 3},
             {"num_bodies", run.scene.bodies.size()},
             {"num_timesteps", steps},
             {"memory", run.memory}};
  std::size_t vertices = 0, edges = 0, faces = 0;
  std::vector<std::size_t> edges_of;  // meshes are shared
  for (const TriangleMesh& mesh : run.scene.meshes) edges_of.push_back(edge_count(mesh));
  for (const BodyDescription& body : run.scene.bodies) {
    const auto m = static_cast<std::size_t>(body.shape.mesh);
    vertices += run.scene.meshes[m].vertices.size();
    faces += run.scene.meshes[m].triangles.size();
    edges += edges_of[m];
  }
  stats["num_vertices"] = vertices;
  stats["num_edges"] = edges;
  stats["num_faces"] = faces;
  const Gaps gaps(run.scene);
  Json seconds = Json::array(), iterations = Json::array(), contacts = Json::array(),
       distances = Json::array();
  for (std::size_t k = 0; k < steps; ++k) {
    const StepReport& step = run.steps[k];
    seconds.push_back(step.ms.total / 1000);
    iterations.push_back(step.iterations);
    contacts.push_back(step.contact_count);
    distances.push_back(gaps.of(step).value_or(-1));
  }
  stats["step_timings"] = std::move(seconds);
  stats["solver_iterations"] = std::move(iterations);
  stats["num_contacts"] = std::move(contacts);
  stats["step_minimum_distances"] = std::move(distances);
  return stats;
}

/// The fixture without the keys that only this program knows.
Json arguments_of(Json fixture) {
  for (const char* key : {"name", "backend", "precision", "dynamics", "output", "dialect"})
    fixture.erase(key);
  return fixture;
}

void require_every_step(const IpcRun& run) {
  const double h = run.scene.stepping.time_step;
  const std::vector<double>& times = run.frames.times();
  for (std::size_t k = 0; k < times.size(); ++k)
    if (std::abs(times[k] - static_cast<double>(k) * h) > 0.01 * h)
      throw InputError(
          fmt::format("frame {} is at {:g} s, expected {:g} s: the file has a state for the start "
                      "and one for every step; run the scene with --set output.frame_interval={:g}",
                      k, times[k], static_cast<double>(k) * h, h));
  if (times.size() > run.steps.size() + 1)
    throw InputError(
        fmt::format("there are {} frames but {} steps, expected a step for each but the first",
                    times.size(), run.steps.size()));
}

}  // namespace

void write_ipc_states(const std::filesystem::path& file, const IpcRun& run) {
  if (run.frames.body_count() != run.scene.bodies.size())
    throw InputError(fmt::format("the frames have {} bodies, the scene {}", run.frames.body_count(),
                                 run.scene.bodies.size()));
  require_every_step(run);
  const std::size_t states = run.frames.times().size();
  AtomicFile out(file);
  StateText text(run, principal_bodies(run));
  out.write(R"({"animation":{"state_sequence":[)");
  for (std::size_t k = 0; k < states; ++k) {
    if (k > 0) out.write(",\n");
    out.write(text.of(k));
  }
  out.write("]},\n\"args\":" + arguments_of(run.fixture).dump() +
            ",\n\"stats\":" + stats_of(run, states - 1).dump() + "}\n");
  out.commit();
}

}  // namespace scree
