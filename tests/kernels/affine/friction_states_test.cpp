// Friction of two cubes as another program computed it: energies, gradients and Hessians of 112
// states. The files are not part of the source tree.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "kernels/affine/contact_potential.h"
#include "kernels/affine/friction.h"
#include "tests/affine_reference/hessians.h"
#include "tests/kernels/affine/differences.h"
#include "tests/physics/shared_data.h"

namespace scree::affine {
namespace {

using nlohmann::json;

/// A pair as the files name it: edges by four vertices, and with the first number -1 - p a point p
/// and a triangle, an edge (i, j, -count) or a point (i, -1, -count).
struct StatePair {
  PairKind kind = PairKind::point_triangle;
  std::vector<std::size_t> vertices;
  int count = 1;

  explicit StatePair(const json& ids) {
    const std::vector<int> v = ids;
    if (v[0] >= 0) {
      kind = PairKind::edge_edge;
      vertices.assign(v.begin(), v.end());
      return;
    }
    vertices = {static_cast<std::size_t>(-1 - v[0])};
    for (std::size_t k = 1; k < 4 && v[k] >= 0; ++k)
      vertices.push_back(static_cast<std::size_t>(v[k]));
    if (v[3] < 0) count = -v[3];
  }
  /// The points of the pair; those that a lower feature lacks are its last one again, and so a
  /// triangle that is an edge.
  Four points(const std::vector<Vec3d>& all) const {
    Four x;
    for (std::size_t i = 0; i < 4; ++i)
      x[static_cast<int>(i)] = all[vertices[std::min(i, vertices.size() - 1)]];
    return x;
  }
};

std::vector<Vec3d> vertices_of(const json& rows) {
  std::vector<Vec3d> r;
  for (const json& row : rows) r.emplace_back(row[0], row[1], row[2]);
  return r;
}

class FrictionStates : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path folder =
        physics::shared_file("rigid_ipc/toolkit_data/friction/cube_cube");
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error))
      files_.push_back(entry.path());
    std::sort(files_.begin(), files_.end());
    if (files_.empty()) GTEST_SKIP() << "there are no friction states in " << folder;
  }

  std::vector<std::filesystem::path> files_;
};

/// As the files describe contacts, and as this program finds them in the positions of the files.
TEST_F(FrictionStates, EnergiesGradientsAndHessiansAgree) {
  EXPECT_EQ(files_.size(), 112u);
  std::size_t pairs = 0;
  for (const std::filesystem::path& file : files_) {
    SCOPED_TRACE(file.filename());
    const json state = json::parse(std::ifstream(file));
    const std::vector<Vec3d> start = vertices_of(state["V_start"]),
                             lagged = vertices_of(state["V_lagged"]),
                             end = vertices_of(state["V_end"]);
    const SlipLaw law{std::sqrt(state["epsv_times_h_squared"].get<double>())};
    const double mu = state["mu"];
    const Barrier barrier{state["barrier_stiffness"],
                          std::sqrt(state["dhat_squared"].get<double>())};
    const auto size = static_cast<Eigen::Index>(3 * start.size());
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(size, size);
    const std::vector<double> given = state["gradient"];
    for (std::size_t i = 0; i < given.size(); ++i)
      gradient(static_cast<Eigen::Index>(i)) = given[i];
    for (const json& t : state["hessian_triplets"])
      hessian(t[0].get<Eigen::Index>(), t[1].get<Eigen::Index>()) += t[2].get<double>();

    for (const bool found_here : {false, true}) {
      SCOPED_TRACE(found_here ? "contacts found here" : "contacts of the file");
      double energy = 0;
      Eigen::VectorXd g = Eigen::VectorXd::Zero(size);
      Eigen::MatrixXd h = Eigen::MatrixXd::Zero(size, size);
      for (std::size_t k = 0; k < state["mmcvids"].size(); ++k) {
        const StatePair pair(state["mmcvids"][k]);
        pairs += found_here ? 0 : 1;
        const Four then = pair.points(lagged);
        const Nearest n = nearest_points(pair.kind, then);
        FrictionContact f =
            friction_contact(n, mu, pair.count * normal_force({pair.kind, 1, 0}, barrier, then));
        const json& at = state["closest_point_coordinates"][k];
        const double force = state["normal_force_magnitudes"][k], s = at[0], t = at[1];
        if (found_here) {
          EXPECT_NEAR(f.bound / (mu * force), 1, 1e-6);
        } else {
          const double of_edges[4] = {1 - s, s, t - 1, -t};
          const double of_point[4] = {1, s + t - 1, -s, -t};
          for (int i = 0; i < 4; ++i)
            f.weight[i] = pair.kind == PairKind::edge_edge ? of_edges[i] : of_point[i];
          for (std::size_t axis = 0; axis < 3; ++axis)
            for (std::size_t i = 0; i < 2; ++i)
              f.tangent[i][static_cast<int>(axis)] = state["tangent_bases"][3 * k + axis][i];
          f.bound = mu * force;
        }
        const Four from = pair.points(start), to = pair.points(end);
        Four moved;
        for (int i = 0; i < 4; ++i) moved[i] = to[i] - from[i];
        energy += friction_energy(f, law, moved);
        const Four pair_gradient = friction_gradient(f, law, moved);
        const Dense<12> pair_hessian = friction_hessian(f, law, moved);
        const auto row = [&](int i) {
          const std::size_t v =
              pair.vertices[std::min(static_cast<std::size_t>(i / 3), pair.vertices.size() - 1)];
          return static_cast<Eigen::Index>(3 * v) + i % 3;
        };
        for (int i = 0; i < 12; ++i) {
          g(row(i)) += pair_gradient[i / 3][i % 3];
          for (int j = 0; j < 12; ++j) h(row(i), row(j)) += pair_hessian(i, j);
        }
      }
      const double expected = state["energy"];
      EXPECT_NEAR(energy, expected, 1e-6 * std::abs(expected));
      EXPECT_LE((g - gradient).norm(), 1e-6 * gradient.norm());
      EXPECT_LE((h - hessian).norm(), 1e-6 * hessian.norm());
    }
  }
  EXPECT_EQ(pairs, 507u);
}

}  // namespace
}  // namespace scree::affine
