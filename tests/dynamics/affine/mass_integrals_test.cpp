// Mass integrals of turned solids of triangles, spheres and tori, against those of the very solids in closed form, and of the
// smooth ones that they converge to.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <vector>

#include "dynamics/affine/affine_setup.h"
#include "host/scene_reader.h"
#include "kernels/affine/affine_state.h"
#include "shapes/polyhedron.h"
#include "tests/dynamics/affine_scenes.h"
#include "tests/host/io/output_fixtures.h"
#include "tests/turned_solid.h"

namespace scree::affine {
namespace {

using test::ProfilePoint;
using test::turned_solid;

/// Integrals of a solid of density one about its center.
struct SolidIntegrals {
  double volume = 0, xx = 0, zz = 0;  ///< [m^3], [m^5]; yy is xx, and all others are zero
};

/// A sector of half the angle a is the profile in its plane of symmetry, smaller by cos a, swept across it: |y| < x tan a.
/// @param first, height, third  integrals over the profile of r, r z^2 and r^3
SolidIntegrals of_sectors(int around, double first, double height, double third) {
  const double a = physics::kPi / around, c = std::cos(a), s = std::sin(a), t = s / c;
  return {around * 2 * c * s * first, around * s * c * c * c * (1 + t * t / 3) * third,
          around * 2 * c * s * height};
}

struct TurnedCase {
  TriangleMesh mesh;
  SolidIntegrals exact;
};

/// A torus with a regular polygon of at least four corners as its profile, which has the same second moment about all axes and
/// no third ones.
TurnedCase torus(double large, double small, int around, int corners) {
  std::vector<ProfilePoint> profile;
  for (int j = 0; j < corners; ++j) {
    const double b = 2 * physics::kPi * j / corners;
    profile.push_back({large + small * std::cos(b), small * std::sin(b)});
  }
  const double side = 2 * small * std::sin(physics::kPi / corners);
  const double area = 0.5 * corners * small * small * std::sin(2 * physics::kPi / corners);
  const double second = area / 24 * (6 * small * small - side * side);
  return {turned_solid(profile, around),
          of_sectors(around, large * area, large * second,
                     large * large * large * area + 3 * large * second)};
}

/// A sphere with rings at equal angles: its profile is a stack of trapezoids, over whose heights the integrands are of the
/// fourth degree, for which three points of Gauss are exact.
TurnedCase ball(double radius, int around, int rings) {
  std::vector<ProfilePoint> profile;
  for (int j = 0; j <= rings; ++j) {
    const double b = physics::kPi * j / rings;
    profile.push_back({j % rings == 0 ? 0 : radius * std::sin(b), -radius * std::cos(b)});
  }
  double first = 0, height = 0, third = 0;
  for (int j = 0; j < rings; ++j) {
    const auto [r0, z0] = profile[static_cast<std::size_t>(j)];
    const auto [r1, z1] = profile[static_cast<std::size_t>(j) + 1];
    for (int g = -1; g <= 1; ++g) {
      const double share = 0.5 + 0.5 * g * std::sqrt(0.6);
      const double weight = (g == 0 ? 8.0 : 5.0) / 18 * (z1 - z0);
      const double r = r0 + share * (r1 - r0), z = z0 + share * (z1 - z0);
      first += weight * r * r / 2;
      height += weight * r * r / 2 * z * z;
      third += weight * r * r * r * r / 4;
    }
  }
  return {turned_solid(profile, around), of_sectors(around, first, height, third)};
}

constexpr double kIntegralShare = 1e-12;

void expect_integrals(const AffineMass& m, const SolidIntegrals& exact, double density) {
  EXPECT_NEAR(m.mass, density * exact.volume, kIntegralShare * density * exact.volume);
  const double size = density * (2 * exact.xx + exact.zz);
  EXPECT_NEAR(m.second.xx, density * exact.xx, kIntegralShare * size);
  EXPECT_NEAR(m.second.yy, density * exact.xx, kIntegralShare * size);
  EXPECT_NEAR(m.second.zz, density * exact.zz, kIntegralShare * size);
  for (const double none : {m.second.xy, m.second.xz, m.second.yz})
    EXPECT_NEAR(none, 0, kIntegralShare * size);
}

std::vector<TurnedCase> turned_cases() {
  return {torus(1, 0.3, 24, 12), torus(0.7, 0.5, 7, 5), torus(2, 0.01, 64, 4),  ball(0.4, 32, 16),
          ball(1.5, 5, 4),       ball(1, 3, 2),         torus(1, 0.99, 90, 45), ball(1, 120, 60)};
}

/// The same with corners that stay what they are when a thousand is added.
TriangleMesh on_a_grid(TriangleMesh mesh, double place) {
  constexpr double kGrid = 1099511627776.0;  // 2^40
  for (Vec3d& x : mesh.vertices)
    for (int k = 0; k < 3; ++k) x[k] = std::round(kGrid * x[k]) / kGrid + place * (k - 1.5);
  return mesh;
}

TEST(AffineMassIntegrals, OfTurnedSolidsOfTrianglesAreExact) {
  for (const TurnedCase& each : turned_cases()) {
    SCOPED_TRACE(each.mesh.vertices.size());
    const SolidMoments moments = moments_of(each.mesh);
    expect_integrals(affine_mass(moments, 700), each.exact, 700);
    EXPECT_LT(norm(moments.center), kIntegralShare);
  }
}

TEST(AffineMassIntegrals, DoNotChangeWithThePlace) {
  for (const TurnedCase& each : turned_cases()) {
    SCOPED_TRACE(each.mesh.vertices.size());
    const SolidMoments here = moments_of(on_a_grid(each.mesh, 0)),
                       there = moments_of(on_a_grid(each.mesh, 1e3));
    const auto& s = here.second;
    expect_integrals(affine_mass(there, 700),
                     {here.volume, here.volume * s[0][0], here.volume * s[2][2]}, 700);
    EXPECT_LT(norm(there.center - here.center - Vec3d{-1500, -500, 500}), kIntegralShare * 1e3);
  }
}

/// Errors of a mesh of twice as many sectors and rings are a fourth.
TEST(AffineMassIntegrals, ConvergeToThoseOfSmoothSolidsWithTheSecondOrder) {
  using physics::kPi;
  const double large = 1, small = 0.3, radius = 0.4;
  const double ring = 2 * kPi * kPi * large * small * small;
  const double full = 4 * kPi / 3 * radius * radius * radius;
  const SolidIntegrals smooth[] = {
      {ring, ring * (large * large / 2 + 3 * small * small / 8), ring * small * small / 4},
      {full, full * radius * radius / 5, full * radius * radius / 5}};
  for (int which = 0; which < 2; ++which) {
    std::array<double, 3> before{};
    for (const int n : {32, 64, 128, 256}) {
      const AffineMass m = affine_mass(
          moments_of(which == 0 ? torus(large, small, 2 * n, n).mesh : ball(radius, 2 * n, n).mesh),
          1);
      const SolidIntegrals& s = smooth[which];
      const std::array<double, 3> off{s.volume - m.mass, s.xx - m.second.xx, s.zz - m.second.zz};
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_GT(off[k], 0);
        if (n > 32) {
          EXPECT_NEAR(std::log2(before[k] / off[k]), 2, 0.01) << which << " " << k << " " << n;
        }
      }
      before = off;
    }
  }
}

/// From a file, near and far from the origin of the file: the body turns about its own principal axes.
TEST(AffineMassIntegrals, OfBodiesInScenesAreExact) {
  const test::ScratchDirectory scratch;
  for (const double place : {0.0, 1e3}) {
    const TurnedCase each = torus(1, 0.3, 24, 12);
    const TriangleMesh mesh = on_a_grid(each.mesh, place);
    {
      std::ofstream file(scratch / "torus.obj");
      file.precision(17);
      for (const Vec3d& x : mesh.vertices) file << "v " << x.x << " " << x.y << " " << x.z << "\n";
      for (const auto& t : mesh.triangles)
        file << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
    }
    const Scene scene = parse_scene(
        R"({"name": "torus", "dynamics": {"type": "affine"}, "time_step": 0.01, "duration": 0.1,
            "bodies": [{"kind": "free", "shape": "mesh", "file": "torus.obj", "density": 700, "position": [0, 0, 5]}]})",
        "torus.json", scratch.path());
    const AffineSetup setup = affine_setup(scene);
    ASSERT_EQ(setup.bodies.size(), 1u);
    AffineMass m = setup.bodies[0].mass;
    // Which of its axes is that of the torus is free.
    std::array<double, 3> s{m.second.xx, m.second.yy, m.second.zz};
    std::sort(s.begin(), s.end());
    m.second.zz = s[0], m.second.xx = s[1], m.second.yy = s[2];
    expect_integrals(m, each.exact, 700);
  }
}

}  // namespace
}  // namespace scree::affine
