// Distances, barrier, mollifier and their sums over bodies against searches, differences and Eigen.

#include <random>

#include "kernels/affine/contact_modes.h"
#include "kernels/affine/expected_forces.h"
#include "tests/affine_reference/hessians.h"
#include "tests/affine_reference/reduction.h"
#include "tests/backend_fixture.h"
#include "tests/kernels/affine/differences.h"

namespace scree::affine {
namespace {

struct RunContact {
  static constexpr const char* name = "run_contact";
  ContactPair pair;
  Barrier barrier;
  PairMobility mobility;
  Span<const Four> x;
  Span<Nearest> nearest;
  Span<double> energy;
  Span<Four> gradient;
  Span<Dense<12>> parts;
  SCREE_HD void operator()(Index k) const {
    nearest[k] = nearest_points(pair.kind, x[k]);
    energy[k] = contact_energy(pair, barrier, x[k]);
    gradient[k] = contact_gradient(pair, barrier, x[k]);
    PairMobility way = mobility;
    way.rest = x[k];
    Dense<12> sum;
    for (int part = 0; part < mode_parts(mollifier(pair, x[k])); ++part) {
      const Modes modes =
          contact_modes(pair, barrier, contact_place(pair, barrier, x[k]), x[k], way, part);
      for (int m = 0; m < modes.count; ++m)
        for (int i = 0; i < 4; ++i)
          for (int j = 0; j < 4; ++j) sum.add_outer(i, j, 1, modes.at[m][i], modes.at[m][j]);
    }
    parts[k] = sum;
  }
};

/// Apart from RunContact: in one program with its sums, nvcc 13 makes NaN of them (bench/results/h200/2026-11-30-turning-and-slips.md).
struct RunHessians {
  static constexpr const char* name = "run_hessians";
  ContactPair pair;
  Barrier barrier;
  Span<const Four> x;
  Span<Dense<12>> hessian, projected, gauss_newton;
  SCREE_HD void operator()(Index k) const {
    hessian[k] = contact_hessian(pair, barrier, x[k], Projection::none);
    projected[k] = contact_hessian(pair, barrier, x[k], Projection::eigenvalues);
    gauss_newton[k] = contact_hessian(pair, barrier, x[k], Projection::gauss_newton);
  }
};

/// Bodies as large as what sample() makes.
PairMobility mobility_of_both(PairKind kind) {
  PairMobility m;
  m.split = first_points(kind);
  for (Mobility& body : m.body) {
    body.center = 1;
    body.columns.xx = 2, body.columns.yy = 3, body.columns.zz = 4;
    body.columns.xy = 0.5, body.columns.xz = -0.3, body.columns.yz = 0.2;
  }
  return m;
}

constexpr PairKind kPairKinds[] = {PairKind::point_triangle, PairKind::edge_edge};

class ContactPotentialTest : public BackendTest<double> {
 protected:
  struct Results {
    std::vector<Nearest> nearest;
    std::vector<double> energy;
    std::vector<Four> gradient;
    std::vector<Dense<12>> hessian, projected, parts, gauss_newton;
  };
  Results run(const ContactPair& pair, const Barrier& barrier, const std::vector<Four>& x) {
    return run(pair, barrier, x, mobility_of_both(pair.kind));
  }
  Results run(const ContactPair& pair, const Barrier& barrier, const std::vector<Four>& x,
              const PairMobility& mobility) {
    TestBackend& b = backend();
    const auto n = static_cast<Index>(x.size());
    Buffer<TestBackend, Four> in(b), gradient(b, n);
    Buffer<TestBackend, Nearest> nearest(b, n);
    Buffer<TestBackend, double> energy(b, n);
    Buffer<TestBackend, Dense<12>> hessian(b, n), projected(b, n), parts(b, n), gauss_newton(b, n);
    upload(b, x, in);
    for_each(b, n,
             RunContact{pair, barrier, mobility, std::as_const(in).view(n), nearest.view(),
                        energy.view(), gradient.view(), parts.view()});
    for_each(b, n,
             RunHessians{pair, barrier, std::as_const(in).view(n), hessian.view(), projected.view(),
                         gauss_newton.view()});
    return {download(b, nearest.view()),     download(b, energy.view()),
            download(b, gradient.view()),    download(b, hessian.view()),
            download(b, projected.view()),   download(b, parts.view()),
            download(b, gauss_newton.view())};
  }

  std::mt19937 random_{17};
  double uniform(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }
  Vec3d vector(double size = 1) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }
  /// Four points whose features are `gap` apart, at whichever corners, edges or insides.
  /// @param angle  between edges at most, about [rad]; 0: any
  Four sample(PairKind kind, double gap, double angle = 0) {
    for (;;) {
      Four x;
      for (int i = 0; i < 4; ++i) x[i] = vector();
      if (angle > 0) {
        x[3] = x[2] + uniform(0.5, 1) * (x[1] - x[0]) + vector(angle);
      }
      const Nearest n = nearest_points(kind, x);
      const double now = std::sqrt(n.squared);
      if (now < 1e-3) continue;
      for (int i = 0; i < first_points(kind); ++i) x[i] += (gap / now - 1) * n.gap;
      if (std::abs(std::sqrt(nearest_points(kind, x).squared) / gap - 1) < 1e-9) return x;
    }
  }
  /// Whether the nearest features are the same ones at a few steps from here.
  static bool same_features_near(PairKind kind, const Four& x, double step) {
    const Nearest at = nearest_points(kind, x);
    for (int k = 0; k < 24; ++k) {
      Four y = x;
      y[k / 6][k / 2 % 3] += (k % 2 == 0 ? 3 : -3) * step;
      const Nearest n = nearest_points(kind, y);
      if (n.free != at.free) return false;
      for (int i = 0; i < 4; ++i)
        if ((n.weight[i] == 0) != (at.weight[i] == 0)) return false;
    }
    return true;
  }
};

/// Against alternating projections, which need no cases: the distance is convex.
TEST_F(ContactPotentialTest, NearestPointsAreThoseOfASearch) {
  for (const PairKind kind : kPairKinds) {
    std::vector<Four> x;
    for (int k = 0; k < 300; ++k) x.push_back(sample(kind, std::pow(10, uniform(-3, 0))));
    const Results r = run({kind}, {}, x);
    int found[3] = {};
    for (std::size_t k = 0; k < x.size(); ++k) {
      const Nearest& n = r.nearest[k];
      ++found[n.free];
      Vec3d gap;
      double of_first = 0, of_second = 0;
      for (int i = 0; i < 4; ++i) {
        gap += n.weight[i] * x[k][i];
        (i < first_points(kind) ? of_first : of_second) += n.weight[i];
        EXPECT_GE(i < first_points(kind) ? n.weight[i] : -n.weight[i], 0);
      }
      EXPECT_LT(norm(gap - n.gap), 1e-14);
      EXPECT_NEAR(of_first, 1, 1e-15);
      EXPECT_NEAR(of_second, -1, 1e-15);
      EXPECT_NEAR(norm2(gap) / n.squared, 1, 1e-10);
      // No corner is on the near side of the planes through both nearest points.
      const Vec3d normal = normalized(n.gap);
      double lowest = 1e300, highest = -1e300;
      for (int i = 0; i < 4; ++i) {
        const double at = dot(normal, x[k][i]);
        if (i < first_points(kind))
          lowest = std::min(lowest, at);
        else
          highest = std::max(highest, at);
      }
      EXPECT_NEAR(lowest - highest, std::sqrt(n.squared), 1e-12) << k;
    }
    for (const int count : found) EXPECT_GT(count, 10);
  }
}

TEST_F(ContactPotentialTest, DegenerateFeaturesHaveADistance) {
  Four x;  // a triangle that is a segment, one that is a point, parallel edges, edges in a line
  x[0] = {0.5, 2, 0}, x[1] = {0, 0, 0}, x[2] = {1, 0, 0}, x[3] = {2, 0, 0};
  EXPECT_EQ(squared_distance(PairKind::point_triangle, x), 4);
  x[2] = x[3] = x[1];
  EXPECT_EQ(squared_distance(PairKind::point_triangle, x), 4.25);
  x[0] = {0, 1, 0}, x[1] = {3, 1, 0}, x[2] = {1, 0, 0}, x[3] = {2, 0, 0};
  EXPECT_EQ(squared_distance(PairKind::edge_edge, x), 1);
  x[0] = {5, 0, 0}, x[1] = {8, 0, 0};
  EXPECT_EQ(squared_distance(PairKind::edge_edge, x), 9);
}

TEST_F(ContactPotentialTest, DerivativesOfDistancesAreThoseOfDifferences) {
  for (const PairKind kind : kPairKinds) {
    int tried[3] = {};
    for (int k = 0; k < 150; ++k) {
      const Four x = sample(kind, uniform(0.05, 1));
      if (!same_features_near(kind, x, 1e-3)) continue;
      const Nearest n = nearest_points(kind, x);
      ++tried[n.free];
      const auto gradient = [&](const Eigen::VectorXd& y) {
        return test::to_eigen(distance_gradient(nearest_points(kind, test::to_four(y))));
      };
      const auto squared = [&](const Eigen::VectorXd& y) {
        return test::scalar(nearest_points(kind, test::to_four(y)).squared);
      };
      const Eigen::VectorXd at = test::to_eigen(x);
      EXPECT_LT(
          test::relative_error(gradient(at).transpose(), test::differences(squared, at, 1e-4)),
          1e-7);
      EXPECT_LT(test::relative_error(test::to_eigen(distance_hessian(x, n)),
                                     test::differences(gradient, at, 1e-4)),
                1e-6);
    }
    for (const int count : tried) EXPECT_GT(count, 5);
  }
}

TEST_F(ContactPotentialTest, TheBarrierIsItsFormula) {
  for (const double separation : {0.0, 0.3}) {
    const Barrier original{5, 0.2, separation, BarrierForm::original};
    const Barrier physical{5, 0.2, separation, BarrierForm::physical};
    const double s = 2 * separation * 0.2 + 0.04;
    for (const double d : {0.001, 0.05, 0.1, 0.19, 0.199}) {
      const double squared = (separation + d) * (separation + d);
      const double y = squared - separation * separation;
      const double b = -5 * (y - s) * (y - s) * std::log(y / s);
      EXPECT_NEAR(original(squared).value, b, 1e-12 * b);
      EXPECT_NEAR(physical(squared).value, 0.2 / (s * s) * b, 1e-12 * 0.2 / (s * s) * b);
      for (const Barrier& barrier : {original, physical}) {
        const Derivatives r = barrier(squared);
        const double step = std::min(1e-3 * y, 0.2 * (s - y));
        const auto value = [&](const Eigen::VectorXd& z) {
          return test::scalar(barrier(z(0)).value);
        };
        const auto first = [&](const Eigen::VectorXd& z) {
          return test::scalar(barrier(z(0)).first);
        };
        EXPECT_NEAR(test::differences(value, test::scalar(squared), step)(0, 0) / r.first, 1, 1e-7);
        EXPECT_NEAR(test::differences(first, test::scalar(squared), step)(0, 0) / r.second, 1,
                    1e-7);
        EXPECT_LT(r.first, 0);
        EXPECT_GT(r.second, 0);
      }
    }
    const double reach = separation + 0.2;
    EXPECT_EQ(original(reach * reach * 1.0000001).value, 0);
    EXPECT_EQ(original(separation * separation).value, HUGE_VAL);
    EXPECT_EQ(original(0.99 * separation * separation).value, HUGE_VAL);
  }
}

/// Without and with the factor of nearly parallel edges, near and far, in both forms.
TEST_F(ContactPotentialTest, DerivativesOfTheEnergyAreThoseOfDifferences) {
  struct Case {
    PairKind kind;
    double angle;
  };
  for (const Case& c : {Case{PairKind::point_triangle, 0}, Case{PairKind::edge_edge, 0},
                        Case{PairKind::edge_edge, 0.02}}) {
    for (const double reach : {1.0, 0.01}) {
      const Barrier barrier{3, reach, 0.1 * reach,
                            reach == 1.0 ? BarrierForm::original : BarrierForm::physical};
      ContactPair pair{c.kind, 0.7, 0};
      std::vector<Four> x;
      for (int k = 0; k < 120; ++k) x.push_back(sample(c.kind, uniform(0.15, 1) * reach, c.angle));
      if (c.angle > 0) pair.parallel_below = 1e-3;  // edges are about one long
      const Results r = run(pair, barrier, x);
      int tried = 0, lessened = 0;
      for (std::size_t k = 0; k < x.size(); ++k) {
        const double edges = norm(cross(x[k][1] - x[k][0], x[k][3] - x[k][2]));
        const double step = (c.angle > 0 ? 0.5e-3 : 1e-3) * std::min(0.1 * reach, edges);
        if (!same_features_near(c.kind, x[k], step)) continue;
        if (std::abs(edges * edges / 1e-3 - 1) < 0.01) continue;  // second derivatives jump there
        ++tried;
        lessened += mollifier(pair, x[k]).value < 0.9 ? 1 : 0;
        const auto energy = [&](const Eigen::VectorXd& y) {
          return test::scalar(contact_energy(pair, barrier, test::to_four(y)));
        };
        const auto gradient = [&](const Eigen::VectorXd& y) {
          return test::to_eigen(contact_gradient(pair, barrier, test::to_four(y)));
        };
        const Eigen::VectorXd at = test::to_eigen(x[k]);
        EXPECT_EQ(r.energy[k] > 0, true);
        EXPECT_LT(test::relative_error(test::to_eigen(r.gradient[k]).transpose(),
                                       test::differences(energy, at, step)),
                  1e-7)
            << k << " " << c.angle << " " << reach;
        EXPECT_LT(test::relative_error(test::to_eigen(r.hessian[k]),
                                       test::differences(gradient, at, step)),
                  1e-6)
            << k << " " << c.angle << " " << reach;
      }
      EXPECT_GT(tried, 60);
      EXPECT_EQ(lessened > 30, c.angle > 0);
    }
  }
}

TEST_F(ContactPotentialTest, ProjectionsAreSemidefinite) {
  for (const PairKind kind : kPairKinds) {
    for (const double angle : {0.0, 0.02}) {
      if (kind == PairKind::point_triangle && angle > 0) continue;
      const Barrier barrier{3, 0.1};
      const ContactPair pair{kind, 0.7, angle > 0 ? 1e-3 : 0};
      std::vector<Four> x;
      for (int k = 0; k < 200; ++k) x.push_back(sample(kind, uniform(0.001, 0.1), angle));
      const Results r = run(pair, barrier, x);
      int changed = 0;
      for (std::size_t k = 0; k < x.size(); ++k) {
        const Eigen::MatrixXd h = test::to_eigen(r.hessian[k]);
        const Eigen::MatrixXd p = test::to_eigen(r.projected[k]);
        const Eigen::MatrixXd g = test::to_eigen(r.gauss_newton[k]);
        EXPECT_LT((p - test::semidefinite(h)).norm(), 1e-10 * h.norm()) << k << " " << angle;
        EXPECT_GE(test::lowest_eigenvalue(p), -1e-12 * h.norm());
        EXPECT_GE(test::lowest_eigenvalue(g), -1e-12 * h.norm());
        // Modes leave out nothing that is positive, but for terms of a mollifier that go with the angle, here up to 0.05. They
        // are more than the nearest matrix where gaps are not small against edges.
        const Eigen::MatrixXd parts = test::to_eigen(r.parts[k]);
        const double lowest = test::lowest_eigenvalue(parts - h) / h.norm();
        const double far = (parts - p).norm() / h.norm();
        EXPECT_GE(lowest, angle == 0 ? -1e-12 : -0.05) << k << " " << angle;
        EXPECT_LT(far, 0.5) << k << " " << angle;
        changed += (p - h).norm() > 1e-6 * h.norm() ? 1 : 0;
        // Moving a body along the normal, both are the second derivative of the barrier of the distance.
        if (angle > 0) continue;
        Four moved;
        for (int i = 0; i < first_points(kind); ++i) moved[i] = normalized(r.nearest[k].gap);
        const Eigen::VectorXd along = test::to_eigen(moved);
        EXPECT_NEAR(along.dot(g * along) / along.dot(h * along), 1, 1e-9);
        EXPECT_EQ(Eigen::FullPivLU<Eigen::MatrixXd>(g).setThreshold(1e-10).rank(), 1);
      }
      EXPECT_GT(changed, 100);
    }
  }
}

/// What turns about a contact, in coordinates in which the mass of both bodies is one: each free parameter's term has a positive and a
/// negative eigenvalue there, and the modes have the positive one. The term here is what is left of the whole Hessian.
TEST_F(ContactPotentialTest, TermsOfFreeParametersAreMeasuredWithTheMassOfBodies) {
  const Barrier barrier{3, 0.1};
  for (const PairKind kind : kPairKinds) {
    const ContactPair pair{kind, 0.7, 0};
    const int split = first_points(kind);
    for (const bool is_second_fixed : {false, true}) {
      PairMobility mobility = mobility_of_both(kind);
      if (is_second_fixed) mobility.body[1] = {};
      std::vector<Four> x;
      for (int k = 0; k < 200; ++k) x.push_back(sample(kind, uniform(0.001, 0.1)));
      const Results r = run(pair, barrier, x, mobility);
      int tried = 0;
      for (std::size_t k = 0; k < x.size(); ++k) {
        const Nearest& n = r.nearest[k];
        if (n.free != 1) continue;  // with two, terms are no eigenvectors of their sum
        ++tried;
        // Twelve coordinates of each body, in which M is the unit matrix: J L^-T of M = L L^T.
        Eigen::MatrixXd j = Eigen::MatrixXd::Zero(12, 24);
        for (int side = 0; side < 2; ++side) {
          Eigen::Matrix4d inverse = Eigen::Matrix4d::Zero();
          const Mobility& m = mobility.body[side];
          inverse(0, 0) = m.center;
          for (int a = 0; a < 3; ++a) {
            Vec3d unit;
            unit[a] = 1;
            const Vec3d column = m.columns * unit;
            for (int c = 0; c < 3; ++c) inverse(1 + c, 1 + a) = column[c];
          }
          // M^-1 = R R^T; a body that is fixed has zeros.
          const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> of(inverse);
          const Eigen::Matrix4d root =
              of.eigenvectors() * of.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
          for (int i = 0; i < 4; ++i) {
            if ((i < split) != (side == 0)) continue;
            const Eigen::Vector4d at(1, x[k][i].x, x[k][i].y, x[k][i].z);
            const Eigen::Vector4d carried = root.transpose() * at;
            for (int c = 0; c < 4; ++c)
              for (int a = 0; a < 3; ++a) j(3 * i + a, 12 * side + 3 * c + a) = carried(c);
          }
        }
        // The Hessian less b' 2 w_i w_j I, which has no free parameter, and less what acts along the normal.
        const Derivatives b = barrier(n.squared);
        const Eigen::Map<const Eigen::Vector4d> w(n.weight);
        const Vec3d normal = normalized(n.gap);
        const Eigen::Vector3d along(normal.x, normal.y, normal.z);
        Vec3d across;
        for (int i = 0; i < 4; ++i) across += n.slope[0][i] * x[k][i];
        across = normalized(across);
        const Eigen::Vector3d tangent(across.x, across.y, across.z);
        Eigen::MatrixXd term = test::to_eigen(r.hessian[k]);
        const Eigen::Matrix4d ww = w * w.transpose();
        for (int i = 0; i < 4; ++i) {
          for (int l = 0; l < 4; ++l) {
            const double plain = 2 * pair.weight * b.first * ww(i, l);
            term.block<3, 3>(3 * i, 3 * l) -=
                plain * (Eigen::Matrix3d::Identity() - tangent * tangent.transpose()) +
                4 * pair.weight * b.second * n.squared * ww(i, l) * along * along.transpose();
          }
        }
        const double stiff =
            pair.weight * (4 * b.second * n.squared + 2 * b.first);  // along the normal
        Eigen::MatrixXd modes = test::to_eigen(r.parts[k]);
        for (int i = 0; i < 4; ++i)
          for (int l = 0; l < 4; ++l)
            modes.block<3, 3>(3 * i, 3 * l) -= stiff * ww(i, l) * along * along.transpose();
        const Eigen::MatrixXd expected = test::semidefinite(j.transpose() * term * j);
        const Eigen::MatrixXd found = j.transpose() * modes * j;
        const double size = (j.transpose() * test::to_eigen(r.hessian[k]) * j).norm();
        EXPECT_LT((found - expected).norm(), 1e-9 * size) << k;
      }
      EXPECT_GT(tried, 40);
    }
  }
}

/// A triangle that does not turn pushes along its normal, wherever the point of the other body goes.
TEST_F(ContactPotentialTest, NothingTurnsAboutAFixedTriangle) {
  const Barrier barrier{3, 0.1};
  const ContactPair pair;
  PairMobility mobility = mobility_of_both(pair.kind);
  mobility.body[1] = {};
  Four x;
  x[0] = {0.2, 0.3, 1e-3}, x[1] = {0, 0, 0}, x[2] = {1, 0, 0}, x[3] = {0, 1, 0};
  const Results r = run(pair, barrier, {x}, mobility);
  const Eigen::MatrixXd of_point = test::to_eigen(r.parts[0]).topLeftCorner(3, 3);
  EXPECT_GT(of_point(2, 2), 0);
  EXPECT_EQ(
      (of_point - of_point(2, 2) * Eigen::Vector3d::UnitZ() * Eigen::RowVector3d::UnitZ()).norm(),
      0);
}

TEST_F(ContactPotentialTest, NothingActsBeyondTheReach) {
  const Results r =
      run({PairKind::edge_edge, 1, 1e-3}, {3, 0.1}, {sample(PairKind::edge_edge, 0.1001, 0.02)});
  EXPECT_EQ(r.energy[0], 0);
  EXPECT_EQ(test::to_eigen(r.gradient[0]).norm(), 0);
  EXPECT_EQ(test::to_eigen(r.hessian[0]).norm(), 0);
}

/// A push of the normal force through a small way takes as much energy as the barrier gains.
TEST_F(ContactPotentialTest, TheNormalForceIsTheSlopeOfTheEnergy) {
  for (const PairKind kind : kPairKinds) {
    const Barrier barrier{3, 0.1};
    const ContactPair pair{kind, 0.7, 0};
    for (int k = 0; k < 20; ++k) {
      const Four x = sample(kind, uniform(0.02, 0.09));
      const Vec3d normal = normalized(nearest_points(kind, x).gap);
      const auto energy = [&](const Eigen::VectorXd& y) {
        Four z = x;
        for (int i = 0; i < first_points(kind); ++i) z[i] -= y(0) * normal;
        return test::scalar(contact_energy(pair, barrier, z));
      };
      EXPECT_NEAR(
          test::differences(energy, test::scalar(0), 1e-5)(0, 0) / normal_force(pair, barrier, x),
          1, 1e-7);
    }
  }
}

/// Against the chain rule with dense Jacobians of four points by both bodies.
TEST_F(ContactPotentialTest, BodiesGetTheSumsOfTheirPoints) {
  for (const PairKind kind : kPairKinds) {
    Four rest;
    for (int i = 0; i < 4; ++i) rest[i] = vector();
    const Four x = sample(kind, 0.05);
    const Barrier barrier{3, 0.1};
    const ContactPair pair{kind, 1, 0};
    Eigen::MatrixXd j = Eigen::MatrixXd::Zero(12, 24);
    for (int i = 0; i < 4; ++i) {
      const int body = i < first_points(kind) ? 0 : 12;
      for (int c = 0; c < 4; ++c)
        for (int a = 0; a < 3; ++a) j(3 * i + a, body + 3 * c + a) = c == 0 ? 1 : rest[i][c - 1];
    }
    const Four g = contact_gradient(pair, barrier, x);
    AffineVec first, second;
    add_forces(kind, rest, g, first, second);
    const Eigen::VectorXd expected = j.transpose() * test::to_eigen(g);
    EXPECT_LT((test::to_eigen(first) - expected.head(12)).norm(), 1e-13 * expected.norm());
    EXPECT_LT((test::to_eigen(second) - expected.tail(12)).norm(), 1e-13 * expected.norm());

    const auto expect_blocks = [&](const BodyBlocks& blocks, const Dense<12>& h) {
      const Eigen::MatrixXd all = j.transpose() * test::to_eigen(h) * j;
      Eigen::MatrixXd found(24, 24);
      found << test::to_eigen(blocks.first), test::to_eigen(blocks.mixed),
          test::to_eigen(blocks.mixed).transpose(), test::to_eigen(blocks.second);
      EXPECT_LT((found - all).norm(), 1e-12 * all.norm());
    };
    const Dense<12> h = contact_hessian(pair, barrier, x, Projection::none);
    BodyBlocks blocks;
    add_blocks(kind, rest, h, blocks);
    expect_blocks(blocks, h);
    // The matrix of rank one, by the points that touch alone.
    const Nearest n = nearest_points(kind, x);
    Dense<3> k;
    k.add_outer(0, 0, normal_stiffness(pair, barrier, n, {}), normalized(n.gap), normalized(n.gap));
    BodyBlocks short_way;
    add_blocks(touching_points(kind, rest, n.weight), k, short_way);
    expect_blocks(short_way, contact_hessian(pair, barrier, x, Projection::gauss_newton));
  }
}

/// The sum of the modes of a pair, without those of its mollifier.
Dense<12> sum_of_modes(const ContactPair& pair, const Barrier& barrier, const Four& x,
                       double surplus) {
  Dense<12> sum;
  PairMobility mobility = mobility_of_both(pair.kind);
  mobility.rest = x;
  const Modes modes =
      contact_modes(pair, barrier, contact_place(pair, barrier, x), x, mobility, 0, surplus);
  for (int m = 0; m < modes.count; ++m)
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) sum.add_outer(i, j, 1, modes.at[m][i], modes.at[m][j]);
  return sum;
}

// Where the barrier is a logarithm, its curvature is f/g; with an expected force l it is l/g.
TEST_F(ContactPotentialTest, ForcesThatAreNotExpectedToStayAreNotStiff) {
  constexpr double kGap = 1e-6;
  const Barrier barrier{1, 1e-3, 0};
  const ContactPair pair;
  Four x;
  x[0] = {0.2, 0.3, kGap}, x[1] = {0, 0, 0}, x[2] = {1, 0, 0}, x[3] = {0, 1, 0};
  const double force = normal_force(pair, barrier, x);
  for (const double surplus : {0.0, 0.5, 0.9, 0.98}) {
    SCOPED_TRACE(surplus);
    // The first point, across the plane of the others.
    EXPECT_NEAR(sum_of_modes(pair, barrier, x, surplus)(2, 2) / ((1 - surplus) * force / kGap), 1,
                0.01);
  }
}

TEST_F(ContactPotentialTest, ForcesAreExpectedToBeAsTheyWereAndToDouble) {
  const Barrier barrier{1, 1e-3, 0};
  const auto squared = [](double gap) { return gap * gap; };
  const auto surplus = [&](int iteration, double gap, double at_start) {
    const ExpectedForces expected = ExpectedForces::in_step(iteration);
    if (!expected.may_have_surplus(barrier, squared(gap))) return 0.0;
    return expected.surplus(barrier, squared(gap), squared(at_start));
  };
  EXPECT_EQ(surplus(0, 1e-6, 1e-4), 0);            // the first step is Newton's
  EXPECT_EQ(surplus(6, 1e-6, 1e-4), 0);            // and so are those from the seventh on
  EXPECT_EQ(surplus(1, 2e-4, 1), 0);               // no small gap
  EXPECT_EQ(surplus(1, 1e-6, 1.5e-6), 0);          // a force that was there
  EXPECT_NEAR(surplus(1, 1e-5, 5e-5), 0.6, 0.01);  // a fifth of it, doubled
  EXPECT_NEAR(surplus(1, 1e-6, 1), 1 - 1.0 / 32, 1e-12);
  EXPECT_NEAR(surplus(5, 1e-6, 1), 0.5, 1e-12);
}

}  // namespace
}  // namespace scree::affine
