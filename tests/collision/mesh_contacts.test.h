#pragma once
// Spheres on triangle meshes: one contact where the surface is smooth, none that
// a smooth surface lacks.

#include <cmath>
#include <numbers>

#include "tests/backend_fixture.h"
#include "tests/collision/collision_scene.h"

namespace scree {
namespace {

template <class Real>
class MeshContactTest : public BackendTest<Real> {
 protected:
  std::vector<HostContact> contacts(const CollisionScene<Real>& scene) {
    CollisionRun<TestBackend, Real> run(this->backend(), scene);
    return run.detect();
  }
  static constexpr double kEps = std::is_same_v<Real, float> ? 2e-6 : 1e-12;
};
TYPED_TEST_SUITE(MeshContactTest, Reals);

TYPED_TEST(MeshContactTest, FlatFloorIsOneContactASphere) {
  CollisionScene<TypeParam> s;
  s.settings.envelope = 0.02;
  // Over faces, on edges, on diagonals, on vertices, and a hair beside them.
  for (const double x : {0.0, 0.1, 0.2, 0.25, 0.5, 0.4999999999, 1e-13, 0.3 + 1e-12}) {
    for (const double y : {0.0, 0.1, 0.13, 0.5, 0.25, 1e-11, 0.2500000001})
      s.add_free({x, y, 0.3}, 0.29);
  }
  const Index wall = s.add_mesh_wall({0, 0, 0}, flat_floor(16, 0.25));
  auto c = this->contacts(s);
  const auto to_wall = [&] {
    std::vector<Index> count(static_cast<std::size_t>(s.owned_count));
    for (const auto& contact : c) {
      if (contact.b != wall) continue;
      ++count[contact.a];
      EXPECT_NEAR(contact.gap, 0.01, this->kEps);
      EXPECT_NEAR(contact.normal.z, -1, this->kEps);
    }
    return count;
  };
  for (const Index n : to_wall()) EXPECT_EQ(n, 1);
  // The same from below: an open mesh has two sides.
  for (Index i = 0; i < s.owned_count; ++i) s.position[i].z = -0.3;
  c = this->contacts(s);
  std::vector<Index> count(static_cast<std::size_t>(s.owned_count));
  for (const auto& contact : c) {
    if (contact.b == wall) {
      ++count[contact.a];
      EXPECT_NEAR(contact.normal.z, 1, this->kEps);
    }
  }
  for (const Index n : count) EXPECT_EQ(n, 1);
}

TYPED_TEST(MeshContactTest, RollingOverInnerEdgesMeetsNoGhost) {
  CollisionScene<TypeParam> s;
  s.settings.envelope = 0.01;
  s.add_free({0, 0, 0}, 0.3);
  s.add_mesh_wall({0.013, -0.02, 0.1}, flat_floor(8, 0.25));
  CollisionRun<TestBackend, TypeParam> run(this->backend(), s);
  for (int step = 0; step <= 400; ++step) {
    run.scene().position[0] = {-0.7 + 0.0035 * step, -0.4 + 0.0021 * step, 0.395};
    run.load();
    const auto c = run.detect();
    ASSERT_EQ(c.size(), 1u) << "step " << step;
    EXPECT_NEAR(c[0].gap, -0.005, this->kEps);
    EXPECT_NEAR(c[0].normal.z, -1, this->kEps);
  }
}

/// A floor that fills a periodic domain, with an edge that float and double round differently.
MeshSource repeating_floor(int n, double cell) {
  MeshSource m = flat_floor(n, cell);
  m.periods = {{n * cell, 0, 0}, {0, n * cell, 0}};
  return m;
}

TYPED_TEST(MeshContactTest, AFloorThatGoesOnInItsImagesHoldsASphereEverywhere) {
  for (const double period : {2.1, 0.3, 1.1}) {
    for (const int n : {1, 2, 7}) {
      const double cell = period / n, low = -(n / 2) * cell, high = low + period;
      CollisionScene<TypeParam> s;
      s.settings.envelope = 0.01 * period;
      s.settings.period = {period, period, 0};
      // Rounding decides next to seams, so there are many places there; far from them a sphere has one contact.
      std::vector<double> places{low, high, 0.5 * (low + high)};
      for (double off = 1e-12; off < 0.3; off *= 2.3)
        places.push_back(low + off * period), places.push_back(high - off * period);
      const std::vector<double> across{low, high - 3e-7, low + 2e-7, low + 0.37 * cell};
      for (const double x : places)
        for (const double y : across) {
          s.add_free({x, y, 0.15 * period}, 0.145 * period);
          s.add_free({y, x, 0.15 * period}, 0.145 * period);
        }
      const Index wall = s.add_mesh_wall({0, 0, 0}, repeating_floor(n, cell));
      std::vector<Index> count(static_cast<std::size_t>(s.owned_count));
      for (const auto& contact : this->contacts(s)) {
        if (contact.b != wall) continue;
        ++count[contact.a];
        EXPECT_NEAR(contact.gap, 0.005 * period, 10 * this->kEps);
        EXPECT_NEAR(contact.normal.z, -1, this->kEps);
      }
      for (std::size_t i = 0; i < count.size(); ++i) {
        const auto& x = s.position[i];
        EXPECT_GE(count[i], 1) << n << " cells, " << period << " m, at " << x.x << " " << x.y;
        const auto is_far = [&](double at) { return at - low > 1e-4 && high - at > 1e-4; };
        if (is_far(x.x) && is_far(x.y)) {
          EXPECT_EQ(count[i], 1);
        }
      }
    }
  }
}

// Faces and edges at a seam are found from points that rounding has put at different places: between them is nothing.
TYPED_TEST(MeshContactTest, BesideASeamNoSphereFallsThrough) {
  for (const double period : {2.1, 0.3, 1.1, 0.02}) {
    const double cell = period / 2, low = -cell, high = low + period;
    for (const bool is_corner : {false, true}) {
      CollisionScene<TypeParam> s;
      s.settings.envelope = 0.01 * period;
      s.settings.period = {period, period, 0};
      for (int k = -60; k < 60; ++k) {
        const double off = 2.5e-8 * k * period;
        s.add_free({high + off, is_corner ? high + 0.4 * off : low + 0.37 * cell, 0.15 * period},
                   0.145 * period);
      }
      const Index wall = s.add_mesh_wall({0, 0, 0}, repeating_floor(2, cell));
      std::vector<Index> count(static_cast<std::size_t>(s.owned_count));
      for (const auto& contact : this->contacts(s))
        if (contact.b == wall) ++count[contact.a];
      for (std::size_t i = 0; i < count.size(); ++i)
        EXPECT_GE(count[i], 1) << period << " m, at " << s.position[i].x - high;
    }
  }
}

TYPED_TEST(MeshContactTest, BoxMeshAgreesWithBox) {
  const Vec3<double> half{0.5, 0.8, 0.3}, center{1, 2, 3};
  const Quat<double> q = exp_map(Vec3<double>{0.5, 1.0, -0.2});
  CollisionScene<TypeParam> as_box, as_mesh;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (auto* s : {&as_box, &as_mesh}) {
    s->settings.envelope = 0.05;
    random.seed(6);
    for (int k = 0; k < 1500; ++k) {
      const Vec3<double> p{uniform(random), 1.2 * uniform(random), uniform(random)};
      const Vec3<double> outside = hadamard(p, {1 / half.x, 1 / half.y, 1 / half.z});
      const double reach =
          std::max({std::abs(outside.x), std::abs(outside.y), std::abs(outside.z)});
      if (reach > 1) s->add_free(center + rotate(q, p), 0.25);
    }
  }
  const Index wall = as_box.add_box_wall(center, half);
  ASSERT_EQ(as_mesh.add_mesh_wall(center, box_mesh(half)), wall);
  as_box.orientation.back() = as_mesh.orientation.back() = Quat<TypeParam>(q);
  const auto only_wall = [wall](std::vector<HostContact> c) {
    std::erase_if(c, [wall](const HostContact& x) { return x.b != wall; });
    return c;
  };
  const auto box = only_wall(this->contacts(as_box)), mesh = only_wall(this->contacts(as_mesh));
  ASSERT_GT(box.size(), 100u);
  ASSERT_EQ(mesh.size(), box.size());
  for (std::size_t c = 0; c < box.size(); ++c) {
    EXPECT_EQ(mesh[c].a, box[c].a);
    EXPECT_NEAR(mesh[c].gap, box[c].gap, 4 * this->kEps);
    EXPECT_NEAR(norm(mesh[c].normal - box[c].normal), 0, 1e3 * this->kEps);
    EXPECT_NEAR(norm(mesh[c].arm_b - box[c].arm_b), 0, 1e2 * this->kEps);
  }
}

TYPED_TEST(MeshContactTest, InsideOfAClosedMeshIsNotSurface) {
  CollisionScene<TypeParam> s;
  s.add_free({0.45, 0, 0}, 0.2);        // center inside, near a face
  s.add_free({0.45, 0.45, 0.45}, 0.2);  // near a corner
  s.add_mesh_wall({0, 0, 0}, box_mesh({0.5, 0.5, 0.5}));
  EXPECT_EQ(this->contacts(s).size(), 0u);
  s.obstacles.meshes[0].closed = false;
  EXPECT_GT(this->contacts(s).size(), 0u);
}

TYPED_TEST(MeshContactTest, ValleyHasTwoContactsAndRidgeOne) {
  MeshSource roof;  // two slopes that meet along y
  roof.closed = false;
  roof.vertices = {{-1, -1, 1}, {0, -1, 0}, {1, -1, 1}, {-1, 1, 1}, {0, 1, 0}, {1, 1, 1}};
  roof.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
  CollisionScene<TypeParam> s;
  s.settings.envelope = 0.01;
  s.add_free({0, 0.1, 0.3 * std::numbers::sqrt2}, 0.3);
  s.add_mesh_wall({0, 0, 0}, roof);
  EXPECT_EQ(this->contacts(s).size(), 2u);
  s.position[0] = {0, 0.1, -0.3};  // from below the same edge is a ridge
  const auto c = this->contacts(s);
  ASSERT_EQ(c.size(), 1u);
  EXPECT_NEAR(c[0].normal.z, 1, this->kEps);
}

TYPED_TEST(MeshContactTest, MovingMeshCarriesItsContacts) {
  CollisionScene<TypeParam> s;
  s.h = 0.1;
  const Vec3<double> center{10, -4, 2};
  const Quat<double> q = exp_map(Vec3<double>{0.6, 0.3, 0.1});
  const Vec3<double> up = rotate(q, Vec3<double>{0, 0, 1});
  s.add_free(center + rotate(q, Vec3<double>{0.31, 0.17, 0}) + 0.5 * up, 0.3);
  s.add_mesh_wall(center, flat_floor(8, 0.25));
  s.orientation.back() = Quat<TypeParam>(q);
  EXPECT_EQ(this->contacts(s).size(), 0u);
  s.velocity.back() = Vec3<TypeParam>(2.1 * up);
  const auto c = this->contacts(s);
  ASSERT_EQ(c.size(), 1u);
  EXPECT_NEAR(c[0].gap, 0.2, 10 * this->kEps);
  EXPECT_NEAR(dot(c[0].normal, up), -1, 10 * this->kEps);
}

TYPED_TEST(MeshContactTest, VerticesListedTwiceAreJoined) {
  const MeshSource shared = flat_floor(4, 0.5);
  MeshSource split;
  split.closed = false;
  for (const auto& t : shared.triangles) {
    const auto first = static_cast<Index>(split.vertices.size());
    for (const Index v : t) split.vertices.push_back(shared.vertices[static_cast<std::size_t>(v)]);
    split.triangles.push_back({first, first + 1, first + 2});
  }
  split.triangles.push_back({0, 0, 1});  // no area
  CollisionScene<TypeParam> s;
  s.add_free({0.25, 0.25, 0.2}, 0.3);  // over a diagonal
  s.add_free({-0.5, 0.5, 0.2}, 0.3);   // over a vertex
  s.add_mesh_wall({0, 0, 0}, split);
  EXPECT_EQ(this->contacts(s).size(), 2u);
}

TYPED_TEST(MeshContactTest, BadTrianglesAreRefused) {
  MeshSource mesh = flat_floor(1, 1);
  mesh.triangles.push_back({0, 1, 99});
  CollisionScene<TypeParam> s;
  s.add_mesh_wall({0, 0, 0}, mesh);
  EXPECT_THROW(this->contacts(s), std::runtime_error);
}

}  // namespace
}  // namespace scree
