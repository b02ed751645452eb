// Surfaces as free bodies: volume, center and moments of the solid inside against closed forms.

#include "host/scene/free_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "host/error.h"
#include "shapes/mesh.h"
#include "tests/box_mesh.h"

namespace scree {
namespace {

using testing::HasSubstr;

TriangleMesh unit_tetrahedron() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

/// A torus about z as a surface of flat triangles.
TriangleMesh torus_mesh(double ring, double tube, int around, int across) {
  TriangleMesh mesh;
  const double turn = 2 * std::numbers::pi;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double a = turn * i / around, b = turn * j / across;
      const double r = ring + tube * std::cos(b);
      mesh.vertices.push_back({r * std::cos(a), r * std::sin(a), tube * std::sin(b)});
    }
  const auto at = [&](int i, int j) { return (i % around) * across + j % across; };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

/// Integral over the solid inside of x^a y^b z^c, a + b + c <= 2, as a flux along x:
/// of x^(a+1) / (a+1) y^b z^c through the triangles, by a rule that is exact up to degree 3.
double integral(const TriangleMesh& mesh, int a, int b, int c) {
  struct Point {
    std::array<double, 3> at;
    double weight;
  };
  const std::array<Point, 4> rule{Point{{1. / 3, 1. / 3, 1. / 3}, -27. / 48},
                                  {{0.6, 0.2, 0.2}, 25. / 48},
                                  {{0.2, 0.6, 0.2}, 25. / 48},
                                  {{0.2, 0.2, 0.6}, 25. / 48}};
  double sum = 0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3d p = mesh.vertices.at(static_cast<std::size_t>(i));
    const Vec3d q = mesh.vertices.at(static_cast<std::size_t>(j));
    const Vec3d r = mesh.vertices.at(static_cast<std::size_t>(k));
    const double flux = cross(q - p, r - p).x / 2;
    for (const Point& point : rule) {
      const Vec3d x = point.at[0] * p + point.at[1] * q + point.at[2] * r;
      sum += flux * point.weight * std::pow(x.x, a + 1) / (a + 1) * std::pow(x.y, b) *
             std::pow(x.z, c);
    }
  }
  return sum;
}

BodyDescription free_body(Scene& scene, TriangleMesh mesh, double density = 1) {
  BodyDescription body;
  set_free_mesh(scene, body, std::move(mesh));
  set_mass_from_density(body, density);
  return body;
}

std::array<double, 3> sorted(const Vec3d& v) {
  std::array<double, 3> values{v.x, v.y, v.z};
  std::sort(values.begin(), values.end());
  return values;
}

TEST(FreeMesh, ABoxHasTheMassOfABox) {
  Scene scene;
  const BodyDescription body = free_body(scene, test::box_mesh({1, 2, 3}, {5, -6, 7}), 10);
  EXPECT_NEAR(body.shape.volume, 48, 48e-12);
  EXPECT_NEAR(body.mass, 480, 480e-12);
  EXPECT_LT(norm(body.shape.half_extents - Vec3d{1, 2, 3}), 1e-12);
  EXPECT_LT(norm(body.position - Vec3d{5, -6, 7}), 1e-12);
  EXPECT_NEAR(body.inertia.x, 480. / 3 * (4 + 9), 1e-8);
  EXPECT_NEAR(body.inertia.y, 480. / 3 * (9 + 1), 1e-8);
  EXPECT_NEAR(body.inertia.z, 480. / 3 * (1 + 4), 1e-8);
}

TEST(FreeMesh, ATetrahedronHasItsPrincipalAxes) {
  Scene scene;
  const TriangleMesh before = unit_tetrahedron();
  const BodyDescription body = free_body(scene, before);
  EXPECT_NEAR(body.mass, 1. / 6, 1e-15);
  EXPECT_LT(norm(body.position - Vec3d{0.25, 0.25, 0.25}), 1e-15);
  // Means of x x and x y about the center: 1/10 - 1/16 and 1/20 - 1/16. The matrix of 3/80 on the
  // diagonal and -1/80 off it has the eigenvalues 1/80, 4/80, 4/80.
  const auto moments = sorted((1 / body.mass) * body.inertia);
  EXPECT_NEAR(moments[0], 5. / 80, 1e-15);
  EXPECT_NEAR(moments[1], 5. / 80, 1e-15);
  EXPECT_NEAR(moments[2], 8. / 80, 1e-15);
  // The body is where the surface was.
  const TriangleMesh& mesh = scene.meshes.at(static_cast<std::size_t>(body.shape.mesh));
  for (std::size_t v = 0; v < before.vertices.size(); ++v)
    EXPECT_LT(norm(body.position + rotate(body.orientation, mesh.vertices[v]) - before.vertices[v]),
              1e-15);
  EXPECT_EQ(free_mesh_fault(mesh), std::nullopt);
}

TEST(FreeMesh, ATorusHasTheIntegralsOfItsTriangles) {
  const TriangleMesh torus = torus_mesh(2, 0.5, 24, 12);
  Scene scene;
  const BodyDescription body = free_body(scene, torus);
  const double volume = integral(torus, 0, 0, 0);
  const double xx = integral(torus, 2, 0, 0), yy = integral(torus, 0, 2, 0),
               zz = integral(torus, 0, 0, 2);
  EXPECT_NEAR(body.shape.volume, volume, 1e-12 * volume);
  const auto moments = sorted(body.inertia), expected = sorted({yy + zz, zz + xx, xx + yy});
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(moments[k], expected[k], 1e-12 * expected[k]);
  // And about those of a torus: volume 2 pi^2 R r^2, moment about its axis m (R^2 + 3/4 r^2).
  EXPECT_NEAR(volume, 2 * std::numbers::pi * std::numbers::pi * 2 * 0.25, 0.08 * volume);
  EXPECT_NEAR(moments[2] / volume, 4 + 0.75 * 0.25, 0.1);
}

TEST(FreeMesh, WhereItIsDoesNotMatter) {
  TriangleMesh far = torus_mesh(2, 0.5, 24, 12);
  for (Vec3d& v : far.vertices) v += Vec3d{1e3, -1e3, 1e3};
  Scene scene;
  const BodyDescription near_body = free_body(scene, torus_mesh(2, 0.5, 24, 12));
  const BodyDescription far_body = free_body(scene, far);
  // Corners at 1000 m are rounded by 1e-13 m.
  EXPECT_NEAR(far_body.mass, near_body.mass, 1e-12 * near_body.mass);
  EXPECT_LT(norm(far_body.position - near_body.position - Vec3d{1e3, -1e3, 1e3}), 1e-12);
  const auto a = sorted(near_body.inertia), b = sorted(far_body.inertia);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 1e-12 * a[k]);
}

TEST(FreeMesh, OneWithAHoleHasTheSameMassWhereverItIs) {
  TriangleMesh open = test::box_mesh({1, 2, 3});
  open.triangles.erase(open.triangles.begin());
  TriangleMesh moved = open;
  for (Vec3d& v : moved.vertices) v += Vec3d{3, 1, -2};
  const SolidMoments here = moments_inside(open), there = moments_inside(moved);
  EXPECT_NEAR(here.volume, there.volume, 1e-10);
  EXPECT_LT(norm(there.center - here.center - Vec3d{3, 1, -2}), 1e-10);
  EXPECT_GT(here.volume, 40);
  EXPECT_LT(here.volume, 48);
  Scene scene;
  const BodyDescription body = free_body(scene, open);
  EXPECT_EQ(free_mesh_fault(scene.meshes.at(static_cast<std::size_t>(body.shape.mesh))),
            std::nullopt);
}

TEST(FreeMesh, WhatHasNoSolidInsideIsRefused) {
  TriangleMesh card;
  card.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  card.triangles = {{0, 1, 2}, {0, 2, 3}};
  TriangleMesh inside_out = test::box_mesh({1, 1, 1});
  for (auto& triangle : inside_out.triangles) std::swap(triangle[0], triangle[1]);
  Scene scene;
  BodyDescription body;
  EXPECT_THROW(set_free_mesh(scene, body, card), std::invalid_argument);
  EXPECT_THROW(set_free_mesh(scene, body, inside_out), std::invalid_argument);
  EXPECT_THROW(set_free_mesh(scene, body, TriangleMesh{}), std::invalid_argument);
  EXPECT_TRUE(scene.meshes.empty());
}

TEST(FreeMesh, TheFaultOfAnotherFrameIsNamed) {
  EXPECT_THAT(free_mesh_fault(test::box_mesh({1, 2, 3}, {0.1, 0, 0})).value_or(""),
              HasSubstr("center of mass"));
  TriangleMesh turned = test::box_mesh({1, 2, 3});
  for (Vec3d& v : turned.vertices) v = rotate(exp_map(Vec3d{0, 0, 0.3}), v);
  EXPECT_THAT(free_mesh_fault(turned).value_or(""), HasSubstr("principal axes"));
}

TEST(FreeMesh, OtherModelsOfDynamicsRefuseIt) {
  Scene scene;
  scene.bodies.push_back(free_body(scene, test::box_mesh({1, 2, 3})));
  try {
    validate(scene);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("bodies[0].kind: \"free\" is not allowed"));
  }
}

}  // namespace
}  // namespace scree
