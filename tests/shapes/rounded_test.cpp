// Rounded shapes: volumes and moments against other integrals, bounds, chords, rays and surfaces against the distance from
// the core.

#include "shapes/rounded.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "host/scene/convex_hull.h"
#include "shapes/capsule.h"
#include "shapes/sphere.h"

namespace scree {
namespace {

using shapes::Rounded;

Shape core_of_kind(ShapeKind kind, const Vec3d& half) {
  Shape core;
  core.kind = kind;
  core.half_extents = half;
  return core;
}
std::vector<Vec3d> box_points(const Vec3d& half) {
  std::vector<Vec3d> points;
  for (int k = 0; k < 8; ++k)
    points.push_back(
        {k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z});
  return points;
}
/// A hull without any symmetry.
std::vector<Vec3d> rock_points() {
  return {{0, 0, 0}, {1, 0.1, 0}, {0.2, 1.1, 0}, {0.1, 0.3, 0.9}, {0.8, 0.9, 0.7}, {1.1, 0.5, 0.4}};
}

struct Sample {
  Shape shape;
  TriangleMesh mesh;
};
/// One of each core, those of hulls in the frame of the rounded body.
std::vector<Sample> samples(double radius) {
  std::vector<Sample> all;
  for (const Shape& core : {core_of_kind(shapes::Box::kind, {0.3, 0.5, 0.8}),
                            core_of_kind(shapes::Cylinder::kind, {0.4, 0.4, 0.7}),
                            core_of_kind(shapes::Cone::kind, {0.6, 0.6, 0.9}),
                            core_of_kind(shapes::Ellipsoid::kind, {0.9, 0.5, 0.4})})
    all.push_back({Rounded::of(core, radius), {}});
  Sample rock;
  rock.mesh = convex_hull(rock_points(), "rock");
  move_to_principal_frame(rock.mesh, radius);
  rock.shape = hull_of(rock.mesh, radius);
  all.push_back(rock);
  return all;
}
const char* core_name(const Shape& shape) { return shape_card(shape.rounded.core).name; }

Vec3d random_side(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random);
  return normalized(Vec3d{x, y, normal(random)});
}

/// Integrals over a body by its support alone: of its boundary as points that face the directions of a sphere of triangles,
/// each refined so often. Triangles of the boundary lie inside, so sums grow with the square of their edges.
SolidMoments by_support(const Shape& shape, const TriangleMesh& mesh, int level) {
  TriangleMesh body;
  const Quatd turn = exp_map(Vec3d{0.3, 0.5, -0.7});  // no direction is that of a face
  const int count = 1 << level;
  for (int octant = 0; octant < 8; ++octant) {
    const auto at = [&](int i, int j) {
      const auto warp = [&](int t, int bit) {
        return (octant & bit ? -1 : 1) * std::sin(std::numbers::pi / 2 * t / count);
      };
      const Vec3d n{warp(i, 1), warp(j, 2), warp(count - i - j, 4)};
      return Rounded::farthest(shape, &mesh, rotate(turn, normalized(n)));
    };
    const bool is_mirrored = ((octant & 1) + (octant >> 1 & 1) + (octant >> 2 & 1)) % 2 != 0;
    const auto add = [&](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
      const int first = static_cast<int>(body.vertices.size());
      for (const Vec3d& v : {a, b, c}) body.vertices.push_back(v);
      body.triangles.push_back(is_mirrored ? std::array{first, first + 2, first + 1}
                                           : std::array{first, first + 1, first + 2});
    };
    for (int i = 0; i < count; ++i)
      for (int j = 0; i + j < count; ++j) {
        add(at(i, j), at(i + 1, j), at(i, j + 1));
        if (i + j + 1 < count) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
  }
  return moments_of(body);
}

/// Integrals by chords of lines, across no face: another way through the body, with the distance from its core.
SolidMoments by_chords(const Shape& shape, const TriangleMesh& mesh, int lines) {
  const double bound = Rounded::bounding_radius(shape, &mesh), width = 2 * bound / lines;
  const Quatd turn = exp_map(Vec3d{0.4, -0.9, 0.3});
  const Vec3d along = rotate(turn, {0, 0, 1});
  SolidSums sums;
  for (int i = 0; i < lines; ++i)
    for (int j = 0; j < lines; ++j) {
      const Vec3d start = rotate(turn, {(i + 0.5) * width - bound, (j + 0.5) * width - bound, 0});
      const Chord c = Rounded::chord(shape, &mesh, start, along);
      if (c.is_empty()) continue;
      const double length = c.out - c.in, part = length * width * width;
      sums.add_at(start + 0.5 * (c.out + c.in) * along, part, {});
      sums.add_second(part * length * length / 12, along, along);
    }
  return sums.moments();
}

void expect_moments(const SolidMoments& a, const SolidMoments& b, double tolerance) {
  const double size = std::cbrt(b.volume);
  EXPECT_NEAR(a.volume, b.volume, tolerance * b.volume);
  EXPECT_LT(norm(a.center - b.center), tolerance * size);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_NEAR(a.second[i][j], b.second[i][j], tolerance * size * size) << i << j;
}

SolidMoments own_moments(const Sample& s) {
  SolidMoments m;
  m.volume = s.shape.volume;
  const Vec3d& i = s.shape.moments;
  const double trace = 0.5 * (i.x + i.y + i.z);
  for (std::size_t k = 0; k < 3; ++k) m.second[k][k] = trace - i[static_cast<int>(k)];
  return m;
}

TEST(RoundedMass, IsThatOfChordsOfFineLines) {
  for (const double radius : {0.02, 0.3, 2.0})
    for (const Sample& s : samples(radius)) {
      SCOPED_TRACE(std::string(core_name(s.shape)) + " " + std::to_string(radius));
      expect_moments(own_moments(s), by_chords(s.shape, s.mesh, 200), 5e-4);
    }
}

// Triangles between points that face neighboring directions: of smooth bodies two refinements together are exact to the
// fourth power of their edges.
TEST(RoundedMass, IsThatOfASurfaceOfSupports) {
  for (const double radius : {0.1, 0.5})
    for (const Sample& s : samples(radius)) {
      SCOPED_TRACE(std::string(core_name(s.shape)) + " " + std::to_string(radius));
      const SolidMoments coarse = by_support(s.shape, s.mesh, 6);
      SolidMoments best = by_support(s.shape, s.mesh, 7);
      EXPECT_LT(best.volume, s.shape.volume);
      const auto improve = [](double& fine, double rough) { fine += (fine - rough) / 3; };
      improve(best.volume, coarse.volume);
      for (int k = 0; k < 3; ++k) improve(best.center[k], coarse.center[k]);
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b) improve(best.second[a][b], coarse.second[a][b]);
      const bool is_smooth = s.shape.rounded.core == shapes::Ellipsoid::kind;
      expect_moments(own_moments(s), best, is_smooth ? 1e-7 : 5e-4);
    }
}

// Steiner: V + S r + M r^2 + 4/3 pi r^3, with surface and mean width by their own closed forms.
TEST(RoundedMass, VolumesAreSteinersPolynomials) {
  const double r = 0.37;
  const double ball = 4.0 / 3 * std::numbers::pi * r * r * r;
  const auto volume = [&](const Shape& core) { return Rounded::of(core, r).volume; };
  const double radius = 0.4, height = 1.4;
  // Of a disk of revolution: integral of mean curvature pi (height + pi radius).
  EXPECT_NEAR(volume(core_of_kind(shapes::Cylinder::kind, {radius, radius, height / 2})),
              std::numbers::pi * radius * radius * height +
                  2 * std::numbers::pi * radius * (radius + height) * r +
                  std::numbers::pi * (height + std::numbers::pi * radius) * r * r + ball,
              1e-14);
  // Of a cone: its side is curved by pi height, its rim turns by the angle between base and side.
  const double slant = std::hypot(radius, height),
               rim = std::numbers::pi - std::atan2(height, radius);
  EXPECT_NEAR(volume(core_of_kind(shapes::Cone::kind, {radius, radius, 0.75 * height})),
              std::numbers::pi * radius * radius * height / 3 +
                  std::numbers::pi * radius * (radius + slant) * r +
                  std::numbers::pi * (height + radius * rim) * r * r + ball,
              1e-14);
  // A spheroid: surface, and integral of mean curvature by that of its polar one.
  const double a = 0.5, c = 0.9, e = std::sqrt(1 - a * a / (c * c));
  const double surface = 2 * std::numbers::pi * a * a * (1 + c / (a * e) * std::asin(e));
  const double mean = 2 * std::numbers::pi * (c + a * a / (c * e) * std::atanh(e));
  EXPECT_NEAR(volume(core_of_kind(shapes::Ellipsoid::kind, {a, a, c})),
              4.0 / 3 * std::numbers::pi * a * a * c + surface * r + mean * r * r + ball, 1e-13);
  EXPECT_NEAR(volume(core_of_kind(shapes::Ellipsoid::kind, {c, a, a})),
              4.0 / 3 * std::numbers::pi * a * a * c + surface * r + mean * r * r + ball, 1e-13);
}

TEST(RoundedMass, OfVanishingCoresIsThatOfABallOrACapsule) {
  const double r = 0.3;
  const SolidMoments point = rounded::moments_of_box({0, 0, 0}, r);
  EXPECT_NEAR(point.volume, 4.0 / 3 * std::numbers::pi * r * r * r, 1e-15);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(point.second[k][k], 0.2 * r * r, 1e-15);
  Shape capsule;
  capsule.half_extents = {r, r, r + 0.7};
  const MassProperties expected = shapes::Capsule::mass(capsule, 1);
  for (const SolidMoments& m :
       {rounded::moments_of_box({0, 0, 0.7}, r), rounded::moments_of_round(0, 0, 1.4, r)}) {
    EXPECT_NEAR(m.volume, expected.mass, 1e-14);
    const Vec3d moments = m.principal_moments();
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(m.volume * moments[k], expected.inertia[k], 1e-14);
  }
}

TEST(RoundedMass, OfAHullOfEightCornersIsThatOfABox) {
  const Vec3d half{0.3, 0.5, 0.8}, place{3, -2, 1};
  for (const double r : {1e-6, 0.1, 5.0}) {
    std::vector<Vec3d> points = box_points(half);
    for (Vec3d& p : points) p += place;
    const SolidMoments hull = rounded::moments_of_hull(convex_hull(points, "box"), r);
    SolidMoments box = rounded::moments_of_box(half, r);
    box.center = place;
    expect_moments(hull, box, 1e-13);
  }
}

// A sphere of a very fine hull, rounded, is a larger sphere; a ball that is an ellipsoid likewise.
TEST(RoundedMass, OfARoundedBallIsThatOfALargerBall) {
  Shape ball = core_of_kind(shapes::Ellipsoid::kind, {0.4, 0.4, 0.4});
  const Shape out = Rounded::of(ball, 0.6);
  EXPECT_NEAR(out.volume, 4.0 / 3 * std::numbers::pi, 1e-13);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(out.moments[k], 0.4, 1e-13);
}

// Curvatures of needles and disks peak; sums must not depend on the order of the axes.
TEST(RoundedMass, OfThinEllipsoidsIsThatOfTheirLimits) {
  const double r = 0.1;
  const Shape needle = Rounded::of(core_of_kind(shapes::Ellipsoid::kind, {1e-5, 1e-5, 1}), r);
  Shape capsule;
  capsule.half_extents = {r, r, r + 1};
  // A capsule, and the surface of the needle, pi^2 a c, times the radius.
  EXPECT_NEAR(
      needle.volume,
      shapes::Capsule::mass(capsule, 1).mass + std::numbers::pi * std::numbers::pi * 1e-5 * r,
      1e-8);
  const Shape a = Rounded::of(core_of_kind(shapes::Ellipsoid::kind, {0.01, 1, 0.2}), r);
  const Shape b = Rounded::of(core_of_kind(shapes::Ellipsoid::kind, {1, 0.2, 0.01}), r);
  EXPECT_NEAR(a.volume, b.volume, 1e-12 * a.volume);
  EXPECT_NEAR(a.moments.x, b.moments.z, 1e-12);
  EXPECT_NEAR(a.moments.y, b.moments.x, 1e-12);
}

TEST(RoundedShape, LiesWithinItsBounds) {
  std::mt19937 random(1);
  for (const Sample& s : samples(0.2)) {
    SCOPED_TRACE(core_name(s.shape));
    EXPECT_EQ(Rounded::fault(s.shape), std::nullopt);
    const double bound = Rounded::bounding_radius(s.shape, &s.mesh);
    double farthest = 0;
    for (int k = 0; k < 20000; ++k) {
      const Vec3d x = Rounded::farthest(s.shape, &s.mesh, random_side(random));
      farthest = std::max(farthest, norm(x));
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_LE(std::abs(x[axis]), s.shape.half_extents[axis] + 1e-12);
    }
    EXPECT_LE(farthest, bound + 1e-12);
    EXPECT_GT(farthest, 0.995 * bound);
    for (int axis = 0; axis < 3; ++axis) {
      Vec3d n;
      n[axis] = 1;
      const double most = std::max(Rounded::farthest(s.shape, &s.mesh, n)[axis],
                                   -Rounded::farthest(s.shape, &s.mesh, -n)[axis]);
      EXPECT_NEAR(most, s.shape.half_extents[axis], 1e-12);
    }
  }
}

/// What a search over directions may miss [m].
constexpr double kFound = 1e-4;

/// Distance from the core by a search over directions: the largest height over its supporting planes.
double distance_by_supports(const Sample& s, const Vec3d& x, std::mt19937& random) {
  const auto height = [&](const Vec3d& n) {
    return dot(x, n) - dot(Rounded::farthest(s.shape, &s.mesh, n), n);
  };
  double best = -1e300;
  for (int start = 0; start < 5; ++start) {
    Vec3d n = random_side(random);
    double found = height(n);
    for (double step = 0.5; step > 1e-5; step *= 0.85)
      for (int k = 0; k < 24; ++k) {
        const Vec3d turned = normalized(n + step * random_side(random));
        if (height(turned) > found) found = height(turned), n = turned;
      }
    best = std::max(best, found);
  }
  return best;
}

/// A shape as pictures see it.
struct DrawnRounded {
  Vec3f half_extents;
  Rounding<float> rounded;
  shapes::MeshHull hull;
  Vec3f reach() const {
    const float more = rounded.reach();
    return half_extents + Vec3f{more, more, more};
  }
};
DrawnRounded drawn(const Sample& s) {
  const Shape core = Rounded::core(s.shape);
  const Rounding<double>& r = s.shape.rounded;
  DrawnRounded d{Vec3f(core.half_extents),
                 {r.core, static_cast<float>(r.radius), static_cast<float>(r.shift)},
                 {}};
  if (core.kind == shapes::Hull::kind)
    d.hull = {s.mesh.vertices.data(), s.mesh.triangles.data(), s.mesh.triangles.size(), 1};
  return d;
}

TEST(RoundedShape, RaysAndChordsEndAtTheDistanceOfItsSupports) {
  std::mt19937 random(4);
  for (const Sample& s : samples(0.2)) {
    SCOPED_TRACE(core_name(s.shape));
    const DrawnRounded as_drawn = drawn(s);
    const double bound = Rounded::bounding_radius(s.shape, &s.mesh);
    int hits = 0, misses = 0;
    for (int k = 0; k < 70; ++k) {
      const Vec3d from = 3 * bound * random_side(random);
      const Vec3d way = 0.9 * bound * random_side(random) - from;
      const Chord chord = Rounded::chord(s.shape, &s.mesh, from, way);
      const Ray ray{Vec3f(from), Vec3f(way)};
      const float depth = Rounded::hit(as_drawn, ray);
      if (chord.is_empty()) {
        ++misses;
        EXPECT_EQ(depth, kMiss);
        for (double t = 0.3; t < 1.7; t += 0.2)
          EXPECT_GT(distance_by_supports(s, from + t * way, random), -kFound);
        continue;
      }
      ++hits;
      EXPECT_NEAR(depth, chord.in, 2e-4);  // grazing rays end early
      EXPECT_NEAR(distance_by_supports(s, from + chord.in * way, random), 0, kFound);
      EXPECT_NEAR(distance_by_supports(s, from + chord.out * way, random), 0, kFound);
      EXPECT_LT(distance_by_supports(s, from + 0.5 * (chord.in + chord.out) * way, random), 1e-9);
      const Vec3d n(Rounded::normal_at(as_drawn, ray, depth));
      EXPECT_NEAR(norm(n), 1, 1e-5);
      EXPECT_LT(dot(n, way), 0);
      const Vec3d out = from + chord.in * way + 1e-2 * n;
      EXPECT_NEAR(distance_by_supports(s, out, random), 1e-2, 1e-4);
    }
    EXPECT_GT(hits, 20);
    EXPECT_GT(misses, 0);
  }
}

TEST(RoundedShape, NearestPointsAreAtTheirDistance) {
  std::mt19937 random(6);
  for (const Sample& s : samples(0.15)) {
    SCOPED_TRACE(core_name(s.shape));
    struct {
      Vec3d half_extents;
      Rounding<double> rounded;
      shapes::MeshHull hull;
    } m{Rounded::core(s.shape).half_extents, s.shape.rounded, drawn(s).hull};
    for (int k = 0; k < 50; ++k) {
      const Vec3d x = 1.5 * random_side(random);
      const double distance = distance_by_supports(s, x, random);
      const Vec3d y = Rounded::nearest(m, x);
      EXPECT_NEAR(norm(x - y), std::max(0.0, distance), kFound);
    }
    EXPECT_EQ(norm(Rounded::nearest(m, {0, 0, 0})), 0);
  }
}

// A closed surface whose corners lie on the shape, seen from outside, holds nearly its volume.
TEST(RoundedShape, ItsSurfaceIsClosedAndOnIt) {
  std::mt19937 random(8);
  for (const double radius : {0.05, 0.4})
    for (const Sample& s : samples(radius)) {
      SCOPED_TRACE(core_name(s.shape));
      const Surface surface = Rounded::surface(s.shape, &s.mesh, 0);
      TriangleMesh mesh;
      mesh.vertices = surface.vertices;
      for (const std::vector<int>& face : surface.faces)
        for (std::size_t k = 2; k < face.size(); ++k)
          mesh.triangles.push_back({face[0], face[k - 1], face[k]});
      Vec3d area;
      for (const std::array<int, 3>& t : mesh.triangles) {
        const auto at = [&](std::size_t k) {
          return mesh.vertices[static_cast<std::size_t>(t[k])];
        };
        area += cross(at(1) - at(0), at(2) - at(0));
      }
      EXPECT_LT(norm(area), 1e-12);
      const SolidMoments m = moments_of(mesh);
      EXPECT_LT(m.volume, s.shape.volume);
      EXPECT_GT(m.volume, 0.9 * s.shape.volume);
      EXPECT_LT(norm(m.center), 0.01);
      for (std::size_t k = 0; k < surface.vertices.size(); k += 1 + surface.vertices.size() / 20)
        EXPECT_NEAR(distance_by_supports(s, surface.vertices[k], random), 0, kFound);
    }
}

TEST(RoundedShape, ScalesAsAWhole) {
  for (const Sample& s : samples(0.2)) {
    SCOPED_TRACE(core_name(s.shape));
    const Shape twice = Rounded::scaled(s.shape, 2);
    EXPECT_EQ(twice.rounded.radius, 0.4);
    EXPECT_NEAR(Rounded::bounding_radius(twice, &s.mesh),
                2 * Rounded::bounding_radius(s.shape, &s.mesh), 1e-12);
    Sample large = s;
    for (Vec3d& v : large.mesh.vertices) v *= 2;
    const Shape core = Rounded::core(twice);
    const Shape again = Rounded::of(core, 0.4, &large.mesh);
    EXPECT_NEAR(again.volume, twice.volume, 1e-11);
    EXPECT_NEAR(norm(again.moments - twice.moments), 0, 1e-11);
    EXPECT_NEAR(again.rounded.shift, twice.rounded.shift, 1e-13);
  }
}

TEST(RoundedShape, TellsWhatIsWrong) {
  const Shape box = core_of_kind(shapes::Box::kind, {0.3, 0.5, 0.8});
  Shape shape = Rounded::of(box, 0.1);
  const auto field = [](const Shape& s) {
    const auto fault = Rounded::fault(s);
    return fault ? fault->field : "";
  };
  EXPECT_EQ(field(shape), "");
  Shape other = shape;
  other.rounded.core = shapes::Capsule::kind;
  EXPECT_EQ(field(other), "rounded.core");
  other = shape;
  other.rounded.radius = 0;
  EXPECT_EQ(field(other), "rounding");
  other.rounded.radius = NAN;
  EXPECT_EQ(field(other), "rounding");
  EXPECT_EQ(field(Rounded::of(box, 801)), "rounding");
  EXPECT_EQ(field(Rounded::of(box, 799)), "");
  other = shape;
  other.half_extents.y = 0.1;
  EXPECT_EQ(field(other), "half_extents");
  other = shape;
  other.volume = 0;
  EXPECT_EQ(field(other), "volume");
}

}  // namespace
}  // namespace scree
