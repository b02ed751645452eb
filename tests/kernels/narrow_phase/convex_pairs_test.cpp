// Contacts of every two convex shapes, against the least overlap that a search over directions finds with the supports
// of the shapes' own files.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "collision/hull_tables.h"
#include "host/scene/convex_hull.h"
#include "kernels/narrow_phase/body_pairs.h"
#include "shapes/shape_card.h"
#include "tests/kernels/narrow_phase/convex_oracle.h"

namespace scree {
namespace {

/// Hulls of some runs of the tests, as a run has them.
class HullStore {
 public:
  void add(const TriangleMesh& mesh) {
    sources_.push_back({mesh.vertices, mesh.triangles, true});
    tables_ = build_hull_tables(sources_);
  }
  Hull hull(double half_x) const {
    return view_of(tables_).hull(static_cast<Index>(tables_.hulls.size()) - 1, half_x);
  }

 private:
  std::vector<MeshSource> sources_;
  HullTables tables_;
};

/// A body of any convex shape.
struct Solid {
  Shape shape;
  TriangleMesh mesh;
  HullStore store;
  Vec3d center;
  Quatd q;

  PairSide side() const {
    PairSide s{shape.radius, q, core_half_extents(shape), shape.kind, {}, shape.rounded};
    if (has_hull(shape)) s.hull = store.hull(s.half_extents.x);
    return s;
  }
  double reach(const Vec3d& n) const {
    return dot(rotate(q, shape_card(shape.kind).support(shape, &mesh, rotate_back(q, n))), n);
  }
};

Solid random_solid(std::mt19937& random, ShapeKind kind, double spread);

/// A solid of any core, rounded.
Solid random_rounded(std::mt19937& random, double spread) {
  constexpr ShapeKind kCores[] = {shapes::Box::kind, shapes::Cylinder::kind, shapes::Cone::kind,
                                  shapes::Ellipsoid::kind, shapes::Hull::kind};
  std::uniform_real_distribution<double> radius(0.05, 0.4);
  Solid s = random_solid(random, kCores[random() % 5], spread);
  const double r = radius(random);
  if (has_hull(s.shape)) {
    const double scale = shapes::Hull::scale(s.shape, s.mesh);
    s.shape = shapes::Rounded::scaled(hull_of(s.mesh, r / scale), scale);
  } else {
    s.shape = shapes::Rounded::of(s.shape, r);
  }
  return s;
}

Solid random_solid(std::mt19937& random, ShapeKind kind, double spread) {
  if (kind == shapes::Rounded::kind) return random_rounded(random, spread);
  std::uniform_real_distribution<double> size(0.3, 0.9), unit(-1, 1);
  Solid s;
  s.shape.kind = kind;
  s.shape.radius = size(random);
  s.shape.half_extents = {size(random), size(random), size(random)};
  if (kind == shapes::Cylinder::kind || kind == shapes::Cone::kind)
    s.shape.half_extents.y = s.shape.half_extents.x;
  if (kind == shapes::Capsule::kind) {
    s.shape.half_extents.x = s.shape.half_extents.y = 0.3;
    s.shape.half_extents.z += 0.3;
  }
  if (kind == shapes::Hull::kind) {
    // Half of them are prisms, whose ends have more corners than contacts show.
    constexpr int kSides = 24;
    const bool is_prism = unit(random) < 0;
    std::vector<Vec3d> points;
    for (int k = 0; k < (is_prism ? 2 * kSides : 30); ++k) {
      const double angle = 6.283185307179586 * k / kSides;
      points.push_back(
          is_prism ? Vec3d{0.6 * std::cos(angle), 0.5 * std::sin(angle), k < kSides ? 0.4 : -0.4}
                   : hadamard({0.5, 0.6, 0.8}, normalized(any_vector(random))));
    }
    s.mesh = convex_hull(points, "hull");
    move_to_principal_frame(s.mesh);
    shapes::Hull::measure(s.mesh, s.shape);
    s.store.add(s.mesh);
    s.shape = shapes::Hull::scaled(s.shape, size(random) + 0.3);
  }
  const double x = unit(random), y = unit(random);
  s.center = spread * Vec3d{x, y, unit(random)};
  const Vec3d v = any_vector(random);
  s.q = normalized(Quatd(unit(random), v.x, v.y, v.z));
  return s;
}

double overlap_along(const Solid& a, const Solid& b, const Vec3d& n) {
  return dot(a.center, n) + a.reach(n) - (dot(b.center, n) - b.reach(-n));
}

/// The least overlap of all directions, which is the distance with another sign where bodies are apart.
double least_overlap(const Solid& a, const Solid& b, std::mt19937& random) {
  const auto overlap = [&](const Vec3d& n) { return overlap_along(a, b, n); };
  return least_of_directions(overlap, 24, random);
}

/// A search that another one went before, for less, tells what it does alone.
template <InParts P>
void expect_search_goes_on(const PairSide& a, const PairSide& b, const Vec3d& d, double reach) {
  const auto alone = P::search(a, b, d, reach, nullptr);
  for (const double part : {0.0, 0.3, 0.9}) {
    const auto before = P::search(a, b, d, part * reach, nullptr);
    const auto found = P::search(a, b, d, reach, &before);
    ASSERT_EQ(found.is_beyond(), alone.is_beyond()) << part;
    if (alone.is_beyond()) {
      EXPECT_GT(found.separation, reach) << part;
    } else {
      EXPECT_EQ(found.separation, alone.separation) << part;
    }
  }
}

/// All contacts of two bodies with gaps up to a reach.
template <class P>
std::vector<ContactGeometry> contacts(const Solid& a, const Solid& b, double reach) {
  const Vec3d d = b.center - a.center;
  std::vector<ContactGeometry> out;
  if constexpr (P::kFeatureBits == 0) {
    const ContactGeometry g = P::contact(a.side(), b.side(), d, 0);
    if (g.gap <= reach) out.push_back(g);
  } else {
    using Program = ProgramOf<P>;
    if constexpr (InParts<Program>) {
      if (reach > 0) expect_search_goes_on<Program>(a.side(), b.side(), d, reach);
    }
    const Manifold m = Program::manifold(a.side(), b.side(), d, reach, IsWithin{reach});
    for (int k = 0; k < m.count; ++k) {
      const ContactGeometry again = P::contact(a.side(), b.side(), d, m.feature[k]);
      EXPECT_EQ(again.gap, m.contact[k].gap) << "a feature names its contact";
      out.push_back(m.contact[k]);
    }
  }
  return out;
}

/// Those of boxes, capsules and spheres among themselves have tests of their own.
template <class P>
constexpr bool is_here() {
  const auto is_new = [](ShapeKind kind) {
    return kind == shapes::Cone::kind || kind == shapes::Ellipsoid::kind ||
           kind == shapes::Hull::kind || kind == shapes::Cylinder::kind ||
           kind == shapes::Rounded::kind;
  };
  return is_new(P::A::kind) || is_new(P::B::kind);
}

template <class P>
void expect_meets() {
  SCOPED_TRACE(std::string(P::A::name) + " and " + P::B::name);
  std::mt19937 random(7);
  int apart = 0, deep = 0, shallow = 0;
  for (int trial = 0; trial < 120 && !testing::Test::HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    const Solid a = random_solid(random, P::A::kind, 0.9),
                b = random_solid(random, P::B::kind, 0.9);
    const double overlap = least_overlap(a, b, random);
    const auto found = contacts<P>(a, b, 0.05 - overlap);
    ASSERT_FALSE(found.empty());
    EXPECT_TRUE(contacts<P>(a, b, -overlap - 2e-3 - 0.02 * std::abs(overlap)).empty());
    ContactGeometry nearest = found[0];
    for (const ContactGeometry& g : found) {
      if (g.gap < nearest.gap) nearest = g;
      EXPECT_NEAR(norm(g.normal), 1, 1e-12);
      EXPECT_LT(norm(b.center - a.center + g.arm_b - g.arm_a - g.gap * g.normal), 1e-12);
      // Points of contacts are on the bodies, or within what they overlap.
      EXPECT_LT(dot(g.arm_a, g.normal), a.reach(g.normal) + 1e-9);
      EXPECT_GT(dot(g.arm_b, g.normal), -b.reach(-g.normal) - 1e-9);
    }
    const double along = overlap_along(a, b, nearest.normal);
    EXPECT_NEAR(along, overlap, 1e-3 + 0.02 * std::max(0.0, overlap));
    EXPECT_NEAR(nearest.gap, -along, 1e-3 + 0.05 * std::abs(overlap));
    apart += overlap < -0.05;
    shallow += std::abs(overlap) < 0.05;
    deep += overlap > 0.1;
  }
  EXPECT_GT(apart, 5);
  EXPECT_GT(shallow, 1);
  EXPECT_GT(deep, 20);
}

std::vector<int> numbers() {
  std::vector<int> out;
  PairList::for_each_body_pair([&]<class P>(P, int number) {
    if (is_here<P>()) out.push_back(number);
  });
  return out;
}

class ConvexPairs : public testing::TestWithParam<int> {};

TEST_P(ConvexPairs, MeetAtTheirDistanceAndDepth) {
  PairList::for_each_body_pair([&]<class P>(P, int number) {
    if constexpr (is_here<P>()) {
      if (number == GetParam()) expect_meets<P>();
    }
  });
}
INSTANTIATE_TEST_SUITE_P(All, ConvexPairs, testing::ValuesIn(numbers()),
                         [](const testing::TestParamInfo<int>& info) {
                           std::string name;
                           PairList::for_each_body_pair([&]<class P>(P, int number) {
                             if (number == info.param)
                               name = std::string(P::A::name) + "_" + P::B::name;
                           });
                           return name;
                         });

/// The lowest contact of a plane is the support of the shape, and all are on it.
TEST(ConvexShapes, TouchPlanesAtTheirSupport) {
  std::mt19937 random(3);
  for (const ShapeCard& card : shape_cards()) {
    if (!card.may_be_part() || card.is_ball) continue;
    SCOPED_TRACE(card.name);
    for (int trial = 0; trial < 100; ++trial) {
      const Solid a = random_solid(random, card.kind, 0);
      const Vec3d normal = normalized(any_vector(random));
      double least = INFINITY;
      int count = 0;
      PairList::visit_plane(card.kind, [&](auto pair) {
        using P = decltype(pair);
        for (int k = 0; k < P::kCorners; ++k) {
          const ContactGeometry g = P::contact(a.side(), 2, normal, {}, k);
          if (g.gap == INFINITY) continue;
          ++count;
          least = std::min(least, g.gap);
          EXPECT_NEAR(g.gap, 2 + dot(normal, g.arm_a), 1e-12);
        }
      });
      EXPECT_GT(count, 0);
      EXPECT_NEAR(least, 2 - a.reach(-normal), 1e-9);
    }
  }
}

/// Where a curved body meets another, Newton's steps end at the true depth, not near it.
TEST(ConvexShapes, EllipsoidsThatOverlapALittleAreExact) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 200; ++trial) {
    Solid a = random_solid(random, shapes::Ellipsoid::kind, 0);
    Solid b = random_solid(random, shapes::Ellipsoid::kind, 0);
    // They touch at a point whose normal is known, and overlap along it by a known way.
    const Vec3d n = normalized(any_vector(random));
    const auto farthest = [](const Solid& s, const Vec3d& m) {
      return rotate(s.q, shapes::Ellipsoid::extreme(s.shape.half_extents, rotate_back(s.q, m)));
    };
    const double depth = 1e-3;
    b.center = a.center + farthest(a, n) - farthest(b, -n) - depth * n;
    const auto found = contacts<EllipsoidEllipsoid>(a, b, 0);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].gap, -depth, 1e-12);
    EXPECT_LT(norm(found[0].normal - n), 1e-6);
    EXPECT_LT(norm(found[0].arm_a - farthest(a, n)), 1e-5);
  }
}

}  // namespace
}  // namespace scree
