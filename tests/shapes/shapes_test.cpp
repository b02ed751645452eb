// What the files of shapes say is consistent: each shape is held to its own surface, its own mass to
// what sampling finds, and its picture to its distance.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "kernels/math/quat.h"
#include "kernels/narrow_phase/pair_table.h"
#include "shapes/capsule.h"
#include "shapes/cone.h"
#include "shapes/container.h"
#include "shapes/cylinder.h"
#include "shapes/ellipsoid.h"
#include "shapes/shape_list.h"

namespace scree {
namespace {

using shapes::Container;
using shapes::Sphere;

/// A shape of each kind that is a solid of its own.
std::vector<Shape> solids() {
  Shape sphere, box, capsule, cylinder, cone, ellipsoid;
  sphere.kind = Sphere::kind;
  sphere.radius = 0.7;
  box.kind = shapes::Box::kind;
  box.half_extents = {0.3, 0.5, 0.8};
  capsule.kind = shapes::Capsule::kind;
  capsule.half_extents = {0.3, 0.3, 0.9};
  cylinder.kind = shapes::Cylinder::kind;
  cylinder.half_extents = {0.4, 0.4, 0.7};
  cone.kind = shapes::Cone::kind;
  cone.half_extents = {0.6, 0.6, 0.9};
  ellipsoid.kind = shapes::Ellipsoid::kind;
  ellipsoid.half_extents = {0.9, 0.5, 0.4};
  return {sphere, box, capsule, cylinder, cone, ellipsoid};
}

Vec3d random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return normalized(Vec3d{normal(random), normal(random), normal(random)});
}

/// Planes of the faces of a convex surface decide what is inside.
bool is_inside(const Surface& surface, const Vec3d& x) {
  for (const std::vector<int>& face : surface.faces) {
    const auto corner = [&](std::size_t k) {
      return surface.vertices[static_cast<std::size_t>(face[k])];
    };
    const Vec3d normal = cross(corner(1) - corner(0), corner(2) - corner(0));
    if (dot(x - corner(0), normal) > 0) return false;
  }
  return true;
}

TEST(ShapeCards, HaveNamesAndNumbersOfTheirOwn) {
  std::set<std::string> names;
  std::set<ShapeKind> kinds;
  for (const ShapeCard& card : shape_cards()) {
    EXPECT_TRUE(names.insert(card.name).second) << card.name;
    EXPECT_TRUE(kinds.insert(card.kind).second) << card.name;
    EXPECT_NE(card.kind, kNoShape);
    EXPECT_EQ(shape_card(card.kind).name, card.name);
  }
  EXPECT_FALSE(is_shape(kNoShape));
  EXPECT_THROW(shape_card(kNoShape), std::logic_error);
}

TEST(ShapeCards, OneShapeIsThatOfParticles) {
  int balls = 0;
  for (const ShapeCard& card : shape_cards()) balls += card.is_ball ? 1 : 0;
  EXPECT_EQ(balls, 1);
}

TEST(ShapeCards, FreeShapesAreBoundedAndMeetSpheresAndPlanes) {
  for (const ShapeCard& card : shape_cards()) {
    if (!card.may_be_part()) continue;
    EXPECT_NE(card.support, nullptr) << card.name;
    EXPECT_NE(find_pair(card.kind, Sphere::kind), nullptr) << card.name;
    EXPECT_NE(find_pair(card.kind, shapes::HalfSpace::kind), nullptr) << card.name;
  }
}

TEST(Shapes, HoldTheirSurfaceWithinTheirBounds) {
  std::mt19937 random(1);
  for (const Shape& shape : solids()) {
    const ShapeCard& card = shape_card(shape.kind);
    EXPECT_EQ(card.fault(shape), std::nullopt) << card.name;
    const Surface surface = card.surface(shape, nullptr, 1);
    const double bound = card.bounding_radius(shape, nullptr);
    double farthest = 0;
    for (const Vec3d& v : surface.vertices) farthest = std::max(farthest, norm(v));
    EXPECT_NEAR(farthest, bound, 1e-12) << card.name;
    for (int k = 0; k < 200; ++k) {
      const Vec3d n = random_direction(random);
      const double reach = dot(card.support(shape, nullptr, n), n);
      double seen = -INFINITY;
      for (const Vec3d& v : surface.vertices) seen = std::max(seen, dot(v, n));
      EXPECT_LE(seen, reach + 1e-12) << card.name;
      EXPECT_GE(seen, 0.9 * reach) << card.name << ": the surface is a coarse one";
      EXPECT_LE(norm(card.support(shape, nullptr, n)), bound + 1e-12) << card.name;
    }
  }
}

TEST(Shapes, FacesOfSurfacesPointOutward) {
  for (const Shape& shape : solids()) {
    const Surface surface = shape_card(shape.kind).surface(shape, nullptr, 1);
    EXPECT_TRUE(is_inside(surface, {0, 0, 0})) << shape_card(shape.kind).name;
    EXPECT_FALSE(is_inside(surface, {9, 9, 9})) << shape_card(shape.kind).name;
  }
}

// The oracle counts points of a box about the shape that lie below all of its supporting planes.
TEST(Shapes, MassAndMomentsAreThoseOfASolid) {
  constexpr int kPoints = 200000;
  constexpr double kDensity = 3;
  std::mt19937 random(2);
  for (const Shape& shape : solids()) {
    const ShapeCard& card = shape_card(shape.kind);
    const double r = card.bounding_radius(shape, nullptr);
    std::uniform_real_distribution<double> coordinate(-r, r);
    std::vector<Vec3d> planes;
    for (int k = 0; k < 3000; ++k) planes.push_back(random_direction(random));
    for (int axis = 0; axis < 3; ++axis) {
      Vec3d n;
      n[axis] = 1;
      planes.push_back(n), planes.push_back(-n);
    }
    std::vector<double> height;
    for (const Vec3d& n : planes) height.push_back(dot(card.support(shape, nullptr, n), n));
    double mass = 0;
    Vec3d inertia;
    for (int k = 0; k < kPoints; ++k) {
      const Vec3d x{coordinate(random), coordinate(random), coordinate(random)};
      bool is_in = true;
      for (std::size_t p = 0; p < planes.size() && is_in; ++p)
        is_in = dot(x, planes[p]) <= height[p];
      if (!is_in) continue;
      const double part = kDensity * 8 * r * r * r / kPoints;
      mass += part;
      inertia += part * Vec3d{x.y * x.y + x.z * x.z, x.z * x.z + x.x * x.x, x.x * x.x + x.y * x.y};
    }
    const MassProperties solid = card.mass(shape, kDensity);
    EXPECT_NEAR(solid.mass, mass, 0.03 * mass) << card.name;
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(solid.inertia[axis], inertia[axis], 0.04 * inertia[axis]) << card.name << axis;
  }
}

/// A shape as pictures see it.
struct Drawn {
  float radius = 0;
  Vec3f half_extents;
};

TEST(Shapes, RaysHitWhereTheDistanceIsZero) {
  std::mt19937 random(3);
  for (const Shape& shape : solids()) {
    const Drawn drawn{static_cast<float>(shape.radius), Vec3f(shape.half_extents)};
    const double bound = shape_card(shape.kind).bounding_radius(shape, nullptr);
    int hits = 0;
    ShapeList::visit(shape.kind, [&](auto s) {
      using S = decltype(s);
      if constexpr (requires { S::nearest(shape.half_extents, Vec3d{}); }) {
        for (int k = 0; k < 500; ++k) {
          const Vec3d from = 3 * bound * random_direction(random);
          const Vec3d way = 0.8 * bound * random_direction(random) - from;
          const Ray ray{Vec3f(from), Vec3f(way)};
          const float depth = S::hit(drawn, ray);
          double least = INFINITY;
          for (int j = 0; j <= 2000; ++j) {
            const Vec3d x = from + (j / 1000.0) * way;
            least = std::min(least, norm(x - S::nearest(shape.half_extents, x)));
          }
          if (depth == kMiss) {
            EXPECT_GT(least, 0) << S::name;
            continue;
          }
          ++hits;
          const Vec3d at = from + static_cast<double>(depth) * way;
          EXPECT_LT(norm(at - S::nearest(shape.half_extents, at)), 1e-5) << S::name;
          const Vec3d before = from + (static_cast<double>(depth) - 1e-3) * way;
          EXPECT_GT(norm(before - S::nearest(shape.half_extents, before)), 0) << S::name;
          const Vec3d n(S::normal_at(drawn, ray, depth));
          EXPECT_NEAR(norm(n), 1, 1e-4) << S::name;
          EXPECT_LT(dot(n, way), 0) << S::name;
          const Vec3d out = at + 1e-2 * n;
          EXPECT_NEAR(norm(out - S::nearest(shape.half_extents, out)), 1e-2, 1e-4) << S::name;
        }
        EXPECT_GT(hits, 100) << S::name;
      }
    });
  }
}

TEST(ContainerShape, FacesPointInward) {
  Shape shape;
  shape.half_extents = {1, 2, 3};
  const std::vector<WallFace> faces = Container::faces(shape);
  ASSERT_EQ(faces.size(), 6u);
  for (std::size_t face = 0; face < 6; ++face) {
    EXPECT_NEAR(dot(Vec3d{} - faces[face].point, faces[face].normal),
                shape.half_extents[static_cast<int>(face) / 2], 1e-13);
    EXPECT_NEAR(norm(faces[face].normal), 1, 1e-13);
  }
  EXPECT_EQ(faces[0].point, (Vec3d{-1, 0, 0}));
  EXPECT_EQ(faces[5].point, (Vec3d{0, 0, 3}));
  shape.open_faces = 1u << 5 | 1u << 2;
  std::vector<std::string> names;
  for (const WallFace& face : Container::faces(shape)) names.emplace_back(face.name);
  EXPECT_THAT(names, testing::ElementsAre("-x", "+x", "+y", "-z"));
}

}  // namespace
}  // namespace scree
