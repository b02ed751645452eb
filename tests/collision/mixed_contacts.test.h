// Contacts of bodies of many shapes as detection finds them in stages, against all pairs one after the other.

#include <tuple>

#include "collision/hull_tables.h"
#include "host/scene/convex_hull.h"
#include "kernels/narrow_phase/body_pairs.h"
#include "shapes/capsule.h"
#include "shapes/cone.h"
#include "shapes/cylinder.h"
#include "shapes/ellipsoid.h"
#include "shapes/hull.h"
#include "shapes/polyhedron.h"
#include "tests/backend_fixture.h"
#include "tests/collision/collision_scene.h"

namespace scree {
namespace {

enum class Form { sphere, box, capsule, cylinder, cone, ellipsoid, hull };

using Expected = std::tuple<Index, Index, std::uint32_t, ContactGeometry>;  ///< bodies, feature

/// All contacts of two bodies, by bodies and features, that close to the envelope within a step of h. Pair functions are many,
/// so they are compiled once for both precisions.
std::vector<Expected> contacts_of(const std::vector<BodySample>& bodies, double h,
                                  double envelope) {
  std::vector<Expected> out;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      const BodySample &a = bodies[i], &b = bodies[j];
      const auto listed = [&](const ContactGeometry& g, bool is_swapped) {
        const ContactGeometry x = is_swapped ? swapped(g) : g;
        return x.gap + h * std::min(0.0, separation_speed(x, a.motion, b.motion)) <= envelope;
      };
      PairList::for_each_body_pair([&]<class P>(P, int) {
        const bool is_reversed = a.kind != P::A::kind;
        if (is_reversed ? b.kind != P::A::kind || a.kind != P::B::kind : b.kind != P::B::kind)
          return;
        const OrderedPair<P> p(a, b, b.position - a.position, is_reversed, h);
        const auto is_wanted = [&](const ContactGeometry& g) { return listed(g, p.is_swapped); };
        const auto add = [&](std::uint32_t feature, const ContactGeometry& g) {
          out.emplace_back(static_cast<Index>(i), static_cast<Index>(j), feature,
                           p.is_swapped ? swapped(g) : g);
        };
        if constexpr (P::kFeatureBits == 0) {
          const ContactGeometry g = P::contact(p.a, p.b, p.d, 0);
          if (is_wanted(g)) add(0, g);
        } else {
          const Manifold m = P::manifold(p.a, p.b, p.d, 1e3, is_wanted);
          for (int k = 0; k < m.count; ++k) add(m.feature[k], m.contact[k]);
        }
      });
    }
  }
  return out;
}

template <class Real>
class MixedContactsTest : public BackendTest<Real> {
 protected:
  using Scene = CollisionScene<Real>;

  static ShapeKind kind_of(Form form) {
    switch (form) {
      case Form::box:
        return shapes::Box::kind;
      case Form::capsule:
        return shapes::Capsule::kind;
      case Form::cylinder:
        return shapes::Cylinder::kind;
      case Form::cone:
        return shapes::Cone::kind;
      case Form::ellipsoid:
        return shapes::Ellipsoid::kind;
      case Form::hull:
        return shapes::Hull::kind;
      default:
        return shapes::Sphere::kind;
    }
  }

  /// Turned bodies in a cube of this edge, which move.
  static void add_heap(Scene& s, const std::vector<Form>& forms, int count, double edge,
                       std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto signed_unit = [&] { return 2 * unit(random) - 1; };
    const auto vector = [&] {
      const double x = signed_unit(), y = signed_unit();
      return Vec3d{x, y, signed_unit()};
    };
    for (int k = 0; k < count; ++k) {
      const Form form = forms[static_cast<std::size_t>(k) % forms.size()];
      const double r = 0.3 + 0.2 * unit(random), h = 0.3 + 0.4 * unit(random);
      const ShapeKind kind = kind_of(form);
      const Vec3d half = form == Form::capsule                          ? Vec3d{r, r, h + r}
                         : form == Form::cylinder || form == Form::cone ? Vec3d{r, r, h}
                                                                        : Vec3d{r, h, 0.4};
      const double reach = form == Form::sphere ? r : norm(half);
      s.add_free((0.5 * edge) * vector(), reach, vector());
      s.orientation.back() = Quat<Real>(exp_map(3.0 * vector()));
      s.angular_velocity.back() = Vec3<Real>(vector());
      if (form == Form::sphere) continue;
      ShapeRecord<Real>& shape = s.give_shape(kind, false);
      shape.half_extents = Vec3<Real>(half);
      if (form != Form::hull) continue;
      // A rock in the box of the half extents: its points are on an ellipsoid.
      std::vector<Vec3d> points;
      for (int p = 0; p < 24; ++p) {
        const double z = 1 - 2 * (p + 0.5) / 24, across = std::sqrt(1 - z * z);
        points.push_back(
            hadamard(half, Vec3d{across * std::cos(2.4 * p), across * std::sin(2.4 * p), z}));
      }
      const TriangleMesh mesh = convex_hull(points, "rock");
      shape.mesh = static_cast<Index>(s.obstacles.hulls.size());
      shape.half_extents = Vec3<Real>(box_about(mesh));
      s.obstacles.hulls.push_back({mesh.vertices, mesh.triangles, true});
    }
  }

  static BodySample sample(const Scene& s, const HullTables& hulls, std::size_t i) {
    BodySample b;
    b.kind = shapes::Sphere::kind;
    b.position = s.position[i];
    b.radius = s.radius[i];
    b.motion = {Vec3d(s.velocity[i]), Vec3d(s.angular_velocity[i])};
    b.name = static_cast<Index>(i);
    if (s.shape[i] < 0) return b;
    const ShapeRecord<Real>& record = s.obstacles.shapes[static_cast<std::size_t>(s.shape[i])];
    b.kind = record.kind;
    b.half_extents = Vec3d(record.half_extents);
    b.orientation = normalized(Quatd(s.orientation[i]));
    if (b.kind == shapes::Hull::kind) b.hull = view_of(hulls).hull(record.mesh, b.half_extents.x);
    return b;
  }

  /// All contacts of two bodies, by bodies and features.
  static std::vector<Expected> expected(const Scene& s) {
    const HullTables hulls = build_hull_tables(s.obstacles.hulls);
    std::vector<BodySample> bodies;
    for (std::size_t i = 0; i < static_cast<std::size_t>(s.owned_count); ++i)
      bodies.push_back(sample(s, hulls, i));
    return contacts_of(bodies, s.h, s.settings.envelope);
  }

  /// How far apart normals and arms of two devices may be: depths are found to 1e-10 of the size of
  /// bodies, so normals to its root, and devices round differently.
  static constexpr double kTurn = 1e-3;
  /// The same of depths: the polytope of bodies that overlap deeply may end when it is full.
  static constexpr double kDepth = 1e-6;

  /// @return how many contacts there are
  std::size_t expect_found(const Scene& s) {
    CollisionRun<TestBackend, Real> run(this->backend(), s);
    const std::vector<HostContact> found = run.detect();
    EXPECT_EQ(run.detect(), found);
    const std::vector<Expected> all = expected(s);
    EXPECT_EQ(found.size(), all.size());
    if (found.size() != all.size()) return 0;
    const ContactKeys& keys = run.detector().keys();
    const double tolerance = this->tolerance(1e-9, 1e-5);
    for (std::size_t c = 0; c < found.size(); ++c) {
      const auto& [a, b, feature, g] = all[c];
      EXPECT_EQ(found[c].a, a);
      EXPECT_EQ(found[c].b, b);
      EXPECT_EQ(keys.feature(key_element(found[c].key)), feature);
      EXPECT_NEAR(found[c].gap, g.gap, g.gap > 0 ? tolerance : std::max(tolerance, kDepth));
      EXPECT_NEAR(norm(found[c].normal - g.normal), 0, kTurn);
      EXPECT_NEAR(norm(found[c].arm_a - g.arm_a), 0, kTurn);
      EXPECT_NEAR(norm(found[c].arm_b - g.arm_b), 0, kTurn);
      if (testing::Test::HasFailure()) return 0;
    }
    return found.size();
  }

  static Scene empty() {
    Scene s;
    s.settings.envelope = 0.02;
    return s;
  }
};
TYPED_TEST_SUITE(MixedContactsTest, Reals);

TYPED_TEST(MixedContactsTest, OfAllShapes) {
  auto s = this->empty();
  this->add_heap(s,
                 {Form::box, Form::sphere, Form::capsule, Form::cylinder, Form::cone,
                  Form::ellipsoid, Form::hull},
                 200, 7, 1);
  EXPECT_GT(this->expect_found(s), 200u);
}

TYPED_TEST(MixedContactsTest, OfOneShape) {
  for (const Form form :
       {Form::box, Form::capsule, Form::cylinder, Form::cone, Form::ellipsoid, Form::hull}) {
    auto s = this->empty();
    this->add_heap(s, {form}, 120, 5, 2);
    EXPECT_GT(this->expect_found(s), 60u) << static_cast<int>(form);
  }
}

TYPED_TEST(MixedContactsTest, OfManySpheresAndOneBox) {
  auto s = this->empty();
  this->add_heap(s, {Form::sphere}, 150, 6, 3);
  this->add_heap(s, {Form::box}, 1, 0.1, 4);
  EXPECT_GT(this->expect_found(s), 100u);
}

/// More neighbors than a piece of the candidates holds.
TYPED_TEST(MixedContactsTest, OfALargeBodyAmongSmallOnes) {
  auto s = this->empty();
  s.add_free_box({0, 0, 0}, {6, 6, 0.5}, Quat<TypeParam>(exp_map(Vec3d{0.01, 0.02, 0.3})));
  this->add_heap(s, {Form::sphere, Form::box, Form::cylinder}, 200, 8, 5);
  EXPECT_GT(this->expect_found(s), 200u);
}

/// Near pairs without contacts, and none at all.
TYPED_TEST(MixedContactsTest, OfBodiesThatDoNotTouch) {
  auto s = this->empty();
  s.add_free_box({0, 0, 0}, {1, 0.1, 0.1});
  s.add_free_box({0, 0.5, 0}, {1, 0.1, 0.1});
  EXPECT_EQ(this->expect_found(s), 0u);
  s.position[1].x = 9;
  EXPECT_EQ(this->expect_found(s), 0u);
}

/// Planes are met by each body after all others; groups of contacts keep what belongs to each.
TYPED_TEST(MixedContactsTest, GroupsHaveTheSameContacts) {
  auto s = this->empty();
  this->add_heap(s, {Form::box, Form::sphere, Form::sphere, Form::capsule}, 160, 6, 6);
  s.add_half_space({0, 0, -2}, {0, 0, 1});
  s.add_box_wall({0, 0, 3}, {2, 2, 0.5});
  s.h = 1e-3;
  CollisionRun<TestBackend, TypeParam> general(this->backend(), s);
  const std::vector<HostContact> all = general.detect();
  s.settings.layout = ContactLayout::mixed;
  CollisionRun<TestBackend, TypeParam> mixed(this->backend(), s);
  const std::vector<HostContact> groups = mixed.detect();
  const Index radial = mixed.detector().contacts().radial_count;
  ASSERT_EQ(groups.size(), all.size());
  EXPECT_GT(radial, 20);
  EXPECT_GT(static_cast<Index>(all.size()) - radial, 100);
  std::map<std::uint64_t, const HostContact*> by_key;
  for (const HostContact& c : all) by_key[c.key] = &c;
  int at_walls = 0;
  for (const HostContact& c : groups) {
    const HostContact* same = by_key[c.key & ~kGeneralGroup];
    ASSERT_NE(same, nullptr);
    EXPECT_EQ(c.gap, same->gap);
    EXPECT_EQ(c.normal, same->normal);
    EXPECT_EQ(c.b, same->b);
    at_walls += c.b >= s.owned_count ? 1 : 0;
  }
  EXPECT_GT(at_walls, 10);
}

}  // namespace
}  // namespace scree
