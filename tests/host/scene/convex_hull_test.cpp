// Convex hulls of points, and what a body of that shape weighs and turns about.

#include "host/scene/convex_hull.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <set>

#include "collision/hull_tables.h"
#include "shapes/hull.h"
#include "shapes/polyhedron.h"

namespace scree {
namespace {

using testing::HasSubstr;

std::vector<Vec3d> random_points(std::mt19937& random, int count, bool on_sphere) {
  std::normal_distribution<double> normal;
  std::vector<Vec3d> points;
  for (int k = 0; k < count; ++k) {
    const double x = normal(random), y = normal(random);
    const Vec3d p{x, y, normal(random)};
    points.push_back(on_sphere ? normalized(p) : p);
  }
  return points;
}

/// Corners of a cube of edge 2 with a grid on its faces and points inside.
std::vector<Vec3d> cube_points() {
  std::vector<Vec3d> points;
  for (int i = -4; i <= 4; ++i)
    for (int j = -4; j <= 4; ++j)
      for (int k = -4; k <= 4; ++k) points.push_back({0.25 * i, 0.25 * j, 0.25 * k});
  return points;
}

void expect_holds(const TriangleMesh& mesh, const std::vector<Vec3d>& points) {
  EXPECT_EQ(hull_fault(mesh, false), std::nullopt);
  for (const auto& t : mesh.triangles) {
    const auto at = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
    const Vec3d n = normalized(cross(at(1) - at(0), at(2) - at(0)));
    for (const Vec3d& x : points) ASSERT_LT(dot(x - at(0), n), 1e-8);
  }
  // Euler: V - E + F = 2 with 3 F = 2 E.
  EXPECT_EQ(2 * mesh.vertices.size(), mesh.triangles.size() + 4);
}

TEST(ConvexHull, HoldsAllPointsWithSomeOfThem) {
  std::mt19937 random(1);
  for (const int count : {4, 5, 20, 300, 3000}) {
    for (const bool on_sphere : {false, true}) {
      const std::vector<Vec3d> points = random_points(random, count, on_sphere);
      const TriangleMesh mesh = convex_hull(points, "h");
      expect_holds(mesh, points);
      if (on_sphere) {
        EXPECT_EQ(mesh.vertices.size(), points.size());
      }
    }
  }
}

TEST(ConvexHull, OfACubeWithPointsOnItsFacesHasSixFacesOfFourCorners) {
  const TriangleMesh mesh = convex_hull(cube_points(), "cube");
  expect_holds(mesh, cube_points());
  EXPECT_NEAR(moments_of(mesh).volume, 8, 1e-12);
  const HullTables tables = build_hull_tables({{mesh.vertices, mesh.triangles, true}});
  ASSERT_EQ(tables.hulls.size(), 1u);
  EXPECT_EQ(tables.faces.size(), 6u);
  for (const HullFace& face : tables.faces) {
    EXPECT_EQ(face.height, 1);
    EXPECT_EQ(std::abs(face.normal.x) + std::abs(face.normal.y) + std::abs(face.normal.z), 1);
    double area = 0;
    const auto at = [&](std::uint32_t k) {
      return tables.points[tables.corners[face.corner + k % face.count]];
    };
    for (std::uint32_t k = 1; k + 1 < face.count; ++k)
      area += 0.5 * dot(cross(at(k) - at(0), at(k + 1) - at(0)), face.normal);
    EXPECT_NEAR(area, 4, 1e-12);
  }
  for (std::size_t k = 0; k < tables.points.size(); ++k)
    EXPECT_GE(tables.first_face[k + 1] - tables.first_face[k], 2u);
  EXPECT_EQ(tables.hulls[0].inverse_half_x, 1);
}

TEST(ConvexHull, RefusesPointsInOnePlane) {
  const auto refusal = [](const std::vector<Vec3d>& points) {
    try {
      convex_hull(points, "h");
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refusal({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), HasSubstr("four points"));
  EXPECT_THAT(refusal({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 3, 1e-13}}),
              HasSubstr("one plane"));
  EXPECT_THAT(refusal({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}), HasSubstr("one plane"));
  EXPECT_THAT(refusal({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, NAN}}), HasSubstr("finite"));
}

/// A right-angled tetrahedron of edges a, b, c has its center at a quarter of these.
TEST(ConvexHull, MomentsOfATetrahedronAreThoseOfItsClosedForm) {
  const double a = 1, b = 2, c = 3;
  const SolidMoments m =
      moments_of(convex_hull({{5, 5, 5}, {5 + a, 5, 5}, {5, 5 + b, 5}, {5, 5, 5 + c}}, "t"));
  EXPECT_NEAR(m.volume, a * b * c / 6, 1e-14);
  EXPECT_LT(norm(m.center - Vec3d{5 + a / 4, 5 + b / 4, 5 + c / 4}), 1e-14);
  // Mean of x^2 is a^2 / 10, of x y a b / 20, from the corner.
  EXPECT_NEAR(m.second[0][0], a * a / 10 - a * a / 16, 1e-13);
  EXPECT_NEAR(m.second[0][1], a * b / 20 - a * b / 16, 1e-13);
  EXPECT_NEAR(m.second[1][2], b * c / 20 - b * c / 16, 1e-13);
}

TEST(ConvexHull, PrincipalFrameOfATurnedBoxIsItsOwn) {
  const Quatd q = normalized(Quatd(0.3, -0.5, 0.7, 0.2));
  const Vec3d center{1, -2, 3}, half{0.5, 0.2, 0.3};
  std::vector<Vec3d> points;
  for (int k = 0; k < 8; ++k)
    points.push_back(center + rotate(q, {k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y,
                                         k & 4 ? half.z : -half.z}));
  TriangleMesh mesh = convex_hull(points, "b");
  EXPECT_TRUE(hull_fault(mesh, true).has_value());
  const LocalFrame frame = move_to_principal_frame(mesh);
  EXPECT_EQ(hull_fault(mesh, true), std::nullopt);
  EXPECT_LT(norm(frame.origin - center), 1e-14);
  Shape shape;
  shapes::Hull::measure(mesh, shape);
  std::multiset<double> edges{shape.half_extents.x, shape.half_extents.y, shape.half_extents.z};
  const std::vector<double> expected{0.2, 0.3, 0.5};
  std::size_t k = 0;
  for (const double edge : edges) EXPECT_NEAR(edge, expected[k++], 1e-13);
  const MassProperties mass = shapes::Hull::mass(shape, 1000);
  EXPECT_NEAR(mass.mass, 1000 * 8 * 0.5 * 0.2 * 0.3, 1e-10);
  const Vec3d& e = shape.half_extents;
  EXPECT_NEAR(mass.inertia.x, mass.mass / 3 * (e.y * e.y + e.z * e.z), 1e-11);
  // The points are where they were.
  for (const Vec3d& v : mesh.vertices) {
    const Vec3d back = frame.origin + rotate(frame.axes, v);
    double nearest = INFINITY;
    for (const Vec3d& p : points) nearest = std::min(nearest, norm(back - p));
    EXPECT_LT(nearest, 1e-13);
  }
}

TEST(ConvexHull, AxesThatArePrincipalStay) {
  TriangleMesh mesh = convex_hull({{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}, {0, 0, 3}}, "s");
  const LocalFrame frame = move_to_principal_frame(mesh);
  EXPECT_EQ(frame.axes.w, 1);
  EXPECT_NEAR(frame.origin.z, 0.75, 1e-15);
}

TEST(ConvexHull, FaultsOfMeshesAreTold) {
  TriangleMesh mesh = convex_hull(cube_points(), "c");
  EXPECT_EQ(hull_fault(mesh, true), std::nullopt);
  TriangleMesh open = mesh;
  open.triangles.pop_back();
  EXPECT_EQ(hull_fault(open, false), "is not closed");
  TriangleMesh dented = mesh;
  dented.vertices[0] *= 0.2;
  EXPECT_EQ(hull_fault(dented, false), "is not convex");
  for (Vec3d& v : mesh.vertices) v.x += 0.1;
  EXPECT_EQ(hull_fault(mesh, false), std::nullopt);
  EXPECT_EQ(hull_fault(mesh, true), "has its center of mass off the origin");
}

}  // namespace
}  // namespace scree
