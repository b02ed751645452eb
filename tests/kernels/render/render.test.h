#pragma once
// Pictures: what is drawn where, against closed forms, and the same bytes every time.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <vector>

#include "host/render/renderer.h"
#include "kernels/backend/atomic.h"
#include "shapes/box.h"
#include "shapes/container.h"
#include "shapes/half_space.h"
#include "shapes/mesh.h"
#include "tests/backend_fixture.h"

namespace scree {
namespace {

/// Bodies on the host, filled by a test and uploaded for a picture.
template <class Real>
struct PictureScene {
  std::vector<Vec3<double>> position;
  std::vector<Quat<Real>> orientation;
  std::vector<Vec3<Real>> velocity;
  std::vector<Real> radius;
  std::vector<Index> shape, group, id;
  std::vector<ShapeRecord<Real>> shapes;
  std::vector<Vec3<Real>> vertices;
  std::vector<TriangleIndices> triangles;
  std::vector<MeshRange> ranges;
  Index owned_count = 0;  ///< set by free_done()
  Index ghost_count = 0;
  Index fixed_begin = 0;

  void sphere(const Vec3d& center, double r, Index group_of = 0) {
    body(center, {}, r, -1, group_of);
  }
  void shaped(ShapeRecord<Real> record, const Vec3d& center, const Quat<Real>& q,
              double bounding_radius) {
    record.body = static_cast<Index>(position.size());
    shapes.push_back(record);
    body(center, q, bounding_radius, static_cast<Index>(shapes.size()) - 1, 0);
  }
  void body(const Vec3d& center, const Quat<Real>& q, double r, Index shape_of, Index group_of) {
    position.push_back(center);
    orientation.push_back(q);
    velocity.push_back({static_cast<Real>(position.size() % 7), 0, 0});
    radius.push_back(static_cast<Real>(r));
    shape.push_back(shape_of);
    group.push_back(group_of);
    id.push_back(static_cast<Index>(id.size()));
  }
  /// Bodies so far are free, the next `gap` are not yet inserted, later ones are fixed.
  void free_done(Index gap = 0) {
    owned_count = static_cast<Index>(position.size());
    fixed_begin = owned_count + gap;
  }
};

/// A picture of the scene, made on a backend from scratch.
/// @param sample_budget   see Renderer
/// @param renderer_bytes  out: what the renderer holds after the picture
template <class Real>
Image take_picture(TestBackend& b, const PictureScene<Real>& scene, const PictureSettings& settings,
                   Offset sample_budget = Renderer<TestBackend, Real>::kSampleBudget,
                   std::size_t* renderer_bytes = nullptr) {
  Buffer<TestBackend, Vec3<double>> position(b);
  Buffer<TestBackend, Quat<Real>> orientation(b);
  Buffer<TestBackend, Vec3<Real>> velocity(b), vertices(b);
  Buffer<TestBackend, Real> radius(b);
  Buffer<TestBackend, Index> shape(b), group(b), id(b);
  Buffer<TestBackend, ShapeRecord<Real>> shapes(b);
  Buffer<TestBackend, TriangleIndices> triangles(b);
  Buffer<TestBackend, MeshRange> ranges(b);
  upload(b, scene.position, position);
  upload(b, scene.orientation, orientation);
  upload(b, scene.velocity, velocity);
  upload(b, scene.radius, radius);
  upload(b, scene.shape, shape);
  upload(b, scene.group, group);
  upload(b, scene.id, id);
  upload(b, scene.shapes, shapes);
  upload(b, scene.vertices, vertices);
  upload(b, scene.triangles, triangles);
  upload(b, scene.ranges, ranges);
  BodyView<Real> view;
  view.owned_count = scene.owned_count;
  view.moving_count = scene.owned_count + scene.ghost_count;
  view.fixed_begin = scene.fixed_begin;
  view.count = static_cast<Index>(scene.position.size());
  view.position = position.view();
  view.orientation = orientation.view();
  view.velocity = velocity.view();
  view.radius = radius.view();
  view.shape = shape.view();
  view.group = group.view();
  view.id = id.view();
  const MeshSetView<Real> meshes{vertices.view(), triangles.view(), ranges.view(), {}};
  const std::size_t bytes_before = b.allocated();
  Renderer<TestBackend, Real> renderer(b, sample_budget);
  const Image image = renderer.render(b, view, shapes.view(), meshes, settings);
  if (renderer_bytes != nullptr) *renderer_bytes = b.allocated() - bytes_before;
  return image;
}

/// A camera at (0, -distance, 0) that looks along +y.
inline PictureSettings looking_along_y(int width, int height, double distance, double angle = 40) {
  PictureSettings s;
  s.width = width;
  s.height = height;
  s.color_by = ColorBy::group;
  s.camera.automatic = false;
  s.camera.position = {0, -distance, 0};
  s.camera.target = {0, 0, 0};
  s.camera.vertical_angle = angle;
  return s;
}

inline int differing_pixels(const Image& a, const Image& b, int more_than = 0) {
  EXPECT_EQ(a.rgb.size(), b.rgb.size());
  int count = 0;
  for (std::size_t p = 0; p + 2 < a.rgb.size(); p += 3) {
    int largest = 0;
    for (std::size_t k = p; k < p + 3; ++k)
      largest = std::max(largest, std::abs(a.rgb[k] - b.rgb[k]));
    count += largest > more_than;
  }
  return count;
}

/// Red minus blue of the pixel in the middle: positive for coral (group 3), negative
/// for blue (group 1).
inline int middle_warmth(const Image& image) {
  const std::size_t p =
      3 * (static_cast<std::size_t>(image.height / 2) * image.width + image.width / 2);
  return image.rgb[p] - image.rgb[p + 2];
}

/// Spheres, boxes, a container and a plane: some of everything that has no mesh.
template <class Real>
PictureScene<Real> busy_scene() {
  PictureScene<Real> scene;
  for (int k = 0; k < 600; ++k) {
    const double a = 0.37 * k;
    scene.sphere(
        {0.4 * std::cos(a) * (k % 11) / 11, 0.4 * std::sin(a) * (k % 11) / 11, 0.05 + 0.0015 * k},
        0.03 + 0.01 * (k % 3), k % 8);
  }
  ShapeRecord<Real> record;
  record.kind = shapes::Box::kind;
  record.half_extents = {Real(0.2), Real(0.1), Real(0.15)};
  scene.shaped(record, {0.6, 0.1, 0.4}, exp_map(Vec3<Real>{Real(0.3), Real(0.2), Real(0.9)}), 0.27);
  scene.free_done();
  record.kind = shapes::Container::kind;
  record.open_faces = 1u << 5;
  record.half_extents = {Real(0.9), Real(0.6), Real(0.5)};
  scene.shaped(record, {0, 0, 0.5}, {}, 1.2);
  record.kind = shapes::HalfSpace::kind;
  record.normal = {0, 0, 1};
  scene.shaped(record, {0, 0, -0.1}, {}, 0);
  return scene;
}

template <class Word>
struct ContendForMinimum {
  static constexpr const char* name = "contend_for_minimum";
  Span<Word> cells;
  SCREE_HD static Word candidate(Index i) {
    return static_cast<Word>((static_cast<std::uint64_t>(i) * 2654435761u) % 1000003u);
  }
  SCREE_HD void operator()(Index i) const { atomic_min(cells.data + i % cells.size, candidate(i)); }
};

template <class Word>
void expect_smallest_kept(TestBackend& b) {
  constexpr Index kCount = 100000, kCells = 7;
  Buffer<TestBackend, Word> cells(b, kCells);
  fill(b, cells.view(), static_cast<Word>(~Word{0}));
  for_each(b, kCount, ContendForMinimum<Word>{cells.view()});
  std::vector<Word> expected(kCells, ~Word{0});
  for (Index i = 0; i < kCount; ++i) {
    Word& cell = expected[static_cast<std::size_t>(i % kCells)];
    cell = std::min(cell, ContendForMinimum<Word>::candidate(i));
  }
  EXPECT_EQ(download(b, cells.view()), expected);
}

struct MarkThirds {
  static constexpr const char* name = "mark_thirds";
  Span<std::uint8_t> cells;
  SCREE_HD void operator()(Index i) const { atomic_mark(cells.data + 3 * i % cells.size); }
};

}  // namespace

template <class Real>
class RenderTest : public BackendTest<Real> {};
TYPED_TEST_SUITE(RenderTest, Reals);

TYPED_TEST(RenderTest, AtomicMinimumKeepsTheSmallest) {
  expect_smallest_kept<std::uint32_t>(this->backend());
  expect_smallest_kept<std::uint64_t>(this->backend());
}

TYPED_TEST(RenderTest, AtomicMarkSetsOneByte) {
  TestBackend& b = this->backend();
  Buffer<TestBackend, std::uint8_t> cells(b, 999);
  fill(b, cells.view(), std::uint8_t{0});
  for_each(b, 3000, MarkThirds{cells.view()});
  const auto marks = download(b, cells.view());
  for (std::size_t i = 0; i < marks.size(); ++i) EXPECT_EQ(marks[i], i % 3 == 0 ? 1 : 0) << i;
}

TYPED_TEST(RenderTest, SphereCoversItsClosedFormArea) {
  const auto settings = looking_along_y(800, 800, 3.0);
  PictureScene<TypeParam> scene;
  scene.free_done();
  const Image empty = take_picture(this->backend(), scene, settings);
  const double pixels_per_tangent = 400 / std::tan(20 * std::numbers::pi / 180);
  // A sphere at (x, z) off the axis by the angle c, seen under the half angle s: its silhouette is
  // an ellipse whose ends on the long axis are tan(c + s) and tan(c - s).
  for (const double x : {0.0, 0.35}) {
    PictureScene<TypeParam> one;
    one.sphere({x, 0, 0}, 0.7);
    one.free_done();
    const int seen = differing_pixels(empty, take_picture(this->backend(), one, settings));
    const double distance = std::sqrt(9 + x * x);
    const double s = std::asin(0.7 / distance), c = std::atan(x / 3.0);
    const double long_half = 0.5 * (std::tan(c + s) - std::tan(c - s));
    // The eye sees a cone of half angle s; cut by the picture plane its area is this.
    const double cos_c = std::cos(c), sin_s = std::sin(s);
    const double short_half = sin_s / std::sqrt(cos_c * cos_c - sin_s * sin_s);
    const double area =
        std::numbers::pi * long_half * short_half * pixels_per_tangent * pixels_per_tangent;
    EXPECT_NEAR(seen, area, 0.01 * area) << "x = " << x;
  }
}

TYPED_TEST(RenderTest, NearerBodyWinsInAnyOrder) {
  const auto settings = looking_along_y(64, 64, 3.0);
  for (const bool near_first : {true, false}) {
    PictureScene<TypeParam> scene;
    scene.sphere({0, near_first ? -0.5 : 0.5, 0}, 0.3, near_first ? 3 : 1);
    scene.sphere({0, near_first ? 0.5 : -0.5, 0}, 0.3, near_first ? 1 : 3);
    scene.free_done();
    EXPECT_GT(middle_warmth(take_picture(this->backend(), scene, settings)), 20);
    for (Index& g : scene.group) g = g == 3 ? 1 : 3;
    EXPECT_LT(middle_warmth(take_picture(this->backend(), scene, settings)), -20);
  }
}

TYPED_TEST(RenderTest, RepeatedPicturesHaveEqualBytes) {
  PictureSettings settings;
  settings.width = 160;
  settings.height = 90;
  const auto scene = busy_scene<TypeParam>();
  const Image first = take_picture(this->backend(), scene, settings);
  EXPECT_EQ(first.rgb, take_picture(this->backend(), scene, settings).rgb);
  if constexpr (!TestBackend::kIsDevice) {
    for (int threads = 1; threads <= 3; ++threads) {
      TestBackend b(threads);
      EXPECT_EQ(first.rgb, take_picture(b, scene, settings).rgb) << threads << " threads";
    }
  }
}

TYPED_TEST(RenderTest, NumberOfBandsDoesNotChangeThePicture) {
  // 300 x 960 samples, of which the smallest budget holds 432 rows. The bodies look so large that
  // occlusion reaches as far as it ever does.
  PictureSettings settings = looking_along_y(150, 480, 1.2, 60);
  settings.camera.position.z = 0.5;
  settings.camera.target.z = 0.4;
  auto scene = busy_scene<TypeParam>();
  for (TypeParam& r : scene.radius) r *= 4;
  TestBackend& b = this->backend();
  std::size_t bytes_in_one_band = 0;
  const Image in_one_band = take_picture(b, scene, settings, Offset{300} * 960, &bytes_in_one_band);
  for (const Offset rows : {0, 433, 959}) {
    std::size_t bytes = 0;
    const Image in_bands = take_picture(b, scene, settings, 300 * rows, &bytes);
    EXPECT_EQ(differing_pixels(in_one_band, in_bands), 0) << rows << " rows";
    EXPECT_LT(bytes, bytes_in_one_band) << rows << " rows";
  }
}

TYPED_TEST(RenderTest, BuffersStaySmallForLargePictures) {
  struct Case {
    int width, height;
    double bytes;
  };
  // The light takes 4 (1.5 width)^2 bytes of these.
  for (const Case& c : {Case{640, 480, 14.5e6}, {1280, 960, 25.5e6}}) {
    // Far away, so that the picture is soon done.
    const auto settings = looking_along_y(c.width, c.height, 30.0);
    std::size_t bytes = 0;
    take_picture(this->backend(), busy_scene<TypeParam>(), settings,
                 Renderer<TestBackend, TypeParam>::kSampleBudget, &bytes);
    EXPECT_LT(static_cast<double>(bytes), c.bytes) << c.width << " x " << c.height;
  }
}

TYPED_TEST(RenderTest, ReusedRendererForgetsTheLastPicture) {
  PictureSettings large;
  large.width = 160;
  large.height = 90;
  PictureSettings small = looking_along_y(48, 32, 3.0);
  TestBackend& b = this->backend();
  Renderer<TestBackend, TypeParam> renderer(b);
  const auto draw_nothing = [&](const PictureSettings& s) {
    return renderer.render(b, BodyView<TypeParam>{}, {}, MeshSetView<TypeParam>{}, s);
  };
  const Image before = draw_nothing(small);
  draw_nothing(large);
  EXPECT_EQ(before.rgb, draw_nothing(small).rgb);
}

TYPED_TEST(RenderTest, BoxAndMeshCubeLookTheSame) {
  const auto settings = looking_along_y(200, 150, 2.0);
  const auto q = exp_map(Vec3<TypeParam>{TypeParam(0.5), TypeParam(0.3), TypeParam(0.7)});
  PictureScene<TypeParam> box;
  box.free_done();
  ShapeRecord<TypeParam> record;
  record.kind = shapes::Box::kind;
  record.half_extents = {TypeParam(0.3), TypeParam(0.3), TypeParam(0.3)};
  PictureScene<TypeParam> mesh = box;
  const Image empty = take_picture(this->backend(), box, settings);
  box.shaped(record, {0, 0, 0}, q, 0.52);  // fixed: free boxes have lines along their edges

  for (int c = 0; c < 8; ++c) {
    const auto side = [&](int bit) { return TypeParam((c & bit) != 0 ? 0.3 : -0.3); };
    mesh.vertices.push_back({side(1), side(2), side(4)});
  }
  const int quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                           {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& v : quads) {
    mesh.triangles.push_back({{v[0], v[1], v[2]}});
    mesh.triangles.push_back({{v[0], v[2], v[3]}});
  }
  mesh.ranges.push_back({0, 12});
  record.kind = shapes::Mesh::kind;
  record.mesh = 0;
  mesh.shaped(record, {0, 0, 0}, q, 0.52);

  const Image of_box = take_picture(this->backend(), box, settings);
  const Image of_mesh = take_picture(this->backend(), mesh, settings);
  const int covered = differing_pixels(of_box, empty);
  EXPECT_GT(covered, 3000);
  EXPECT_LT(differing_pixels(of_box, of_mesh, 8), covered / 100);
}

TYPED_TEST(RenderTest, EmptySceneIsSmoothBackground) {
  for (const auto& [width, height] : {std::pair{64, 48}, std::pair{17, 33}, std::pair{16, 16}}) {
    PictureSettings settings;
    settings.width = width;
    settings.height = height;
    PictureScene<TypeParam> scene;
    const Image image = take_picture(this->backend(), scene, settings);
    ASSERT_EQ(image.width, width);
    ASSERT_EQ(image.rgb.size(), static_cast<std::size_t>(3 * width * height));
    for (std::size_t p = 3; p < image.rgb.size(); ++p) {
      EXPECT_GT(image.rgb[p], 180);
      const bool first_of_row = p % static_cast<std::size_t>(3 * width) < 3;
      EXPECT_LE(first_of_row ? 0 : std::abs(image.rgb[p] - image.rgb[p - 3]), 3);
    }
  }
}

TYPED_TEST(RenderTest, OutOfSightBodiesLeaveNoTrace) {
  const auto settings = looking_along_y(64, 48, 3.0);
  PictureScene<TypeParam> scene;
  scene.free_done();
  const Image empty = take_picture(this->backend(), scene, settings);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  scene.sphere({0, -5, 0}, 0.5);   // behind the camera
  scene.sphere({30, 0, 0}, 0.5);   // off to the side
  scene.sphere({0, nan, 0}, 0.5);  // not a number
  scene.sphere({0, 0, 0}, 0);      // no size
  scene.free_done(2);
  scene.sphere({0, 0, 0}, 0.5);  // not inserted yet
  scene.sphere({0, 0, 0.5}, 0.5);
  EXPECT_EQ(empty.rgb, take_picture(this->backend(), scene, settings).rgb);
  scene.ghost_count = 2;  // or drawn by the world that owns them
  EXPECT_EQ(empty.rgb, take_picture(this->backend(), scene, settings).rgb);
}

TYPED_TEST(RenderTest, ContainerNeverHidesItsContent) {
  const auto settings = looking_along_y(96, 96, 3.0);
  PictureScene<TypeParam> scene;
  scene.sphere({0, 0, 0}, 0.3, 3);
  scene.free_done();
  const Image bare = take_picture(this->backend(), scene, settings);
  ShapeRecord<TypeParam> record;
  record.kind = shapes::Container::kind;
  record.half_extents = {TypeParam(0.6), TypeParam(0.6), TypeParam(0.6)};
  scene.shaped(record, {0, 0, 0}, {}, 1.04);
  const Image boxed = take_picture(this->backend(), scene, settings);
  EXPECT_GT(middle_warmth(boxed), 20);
  EXPECT_NEAR(middle_warmth(boxed), middle_warmth(bare), 10);
  EXPECT_GT(differing_pixels(bare, boxed), 1000);  // its walls are there

  // A fixed plate in front counts as a wall, too.
  record.kind = shapes::Box::kind;
  record.half_extents = {TypeParam(0.6), TypeParam(0.02), TypeParam(0.6)};
  scene.shaped(record, {0, -0.8, 0}, {}, 0.85);
  EXPECT_GT(middle_warmth(take_picture(this->backend(), scene, settings)), 20);
}

TYPED_TEST(RenderTest, BodiesCastShadowsOnThePlane) {
  PictureSettings settings = looking_along_y(96, 96, 3.0);
  settings.camera.position = {0, -3, 3};
  PictureScene<TypeParam> scene;
  scene.free_done();
  ShapeRecord<TypeParam> plane;
  plane.kind = shapes::HalfSpace::kind;
  plane.normal = {0, 0, 1};
  scene.shaped(plane, {0, 0, 0}, {}, 0);
  const Image bare = take_picture(this->backend(), scene, settings);
  PictureScene<TypeParam> with;
  with.sphere({0, 0, 0.3}, 0.3);
  with.free_done();
  plane.body = -1;
  with.shaped(plane, {0, 0, 0}, {}, 0);
  const Image shaded = take_picture(this->backend(), with, settings);
  // The key light comes from the upper left: the shadow falls to the right of the sphere's foot.
  const auto brightness = [](const Image& image, int x, int y) {
    const std::size_t p = 3 * (static_cast<std::size_t>(y) * image.width + x);
    return image.rgb[p] + image.rgb[p + 1] + image.rgb[p + 2];
  };
  EXPECT_LT(brightness(shaded, 62, 48), brightness(bare, 62, 48) - 100);
  EXPECT_GT(brightness(shaded, 30, 52), brightness(bare, 30, 52) - 30);
}

TYPED_TEST(RenderTest, AutomaticCameraShowsAllBodiesAndIgnoresEscapedOnes) {
  PictureSettings settings;
  settings.width = 120;
  settings.height = 80;
  PictureScene<TypeParam> scene;
  for (int k = 0; k < 1000; ++k)
    scene.sphere({0.1 * (k % 10), 0.1 * (k / 10 % 10), 0.1 * (k / 100)}, 0.05);
  scene.free_done();
  const Image packed = take_picture(this->backend(), scene, settings);
  PictureScene<TypeParam> none;
  const Image empty = take_picture(this->backend(), none, settings);
  int border = 0;
  for (int x = 0; x < settings.width; ++x) {
    for (const int y : {0, settings.height - 1}) {
      const std::size_t p = 3 * (static_cast<std::size_t>(y) * settings.width + x);
      border += std::abs(packed.rgb[p] - empty.rgb[p]) > 2;
    }
  }
  EXPECT_EQ(border, 0);
  EXPECT_GT(differing_pixels(packed, empty, 2), settings.width * settings.height / 5);

  scene.sphere({0, 0, -5000}, 0.05);
  scene.free_done();
  const Image with_escaped = take_picture(this->backend(), scene, settings);
  EXPECT_GT(differing_pixels(with_escaped, empty, 2), settings.width * settings.height / 5);
}

TYPED_TEST(RenderTest, AutomaticCameraDoesNotFollowStrays) {
  PictureSettings settings;
  settings.width = 120;
  settings.height = 80;
  settings.color_by = ColorBy::group;
  PictureScene<TypeParam> scene;
  for (int k = 0; k < 1000; ++k)
    scene.sphere({0.1 * (k % 10), 0.1 * (k / 10 % 10), 0.1 * (k / 100)}, 0.05);
  scene.free_done();
  const Image packed = take_picture(this->backend(), scene, settings);
  // Beside the others by more than their own width, where no camera has to reach.
  for (const Vec3d& stray :
       {Vec3d{2.4, 0.5, 0.5}, {-1.5, 0.4, 0.4}, {0.4, -1.7, 0.4}, {0.4, 2.4, 1.4}, {0.5, 0.5, 2.6}})
    scene.sphere(stray, 0.05);
  scene.free_done();
  const Image with_strays = take_picture(this->backend(), scene, settings);
  EXPECT_LT(differing_pixels(packed, with_strays, 2), settings.width * settings.height / 50);
}

/// Sum of the three colors of a pixel.
inline int brightness_at(const Image& image, int x, int y) {
  const std::size_t p = 3 * (static_cast<std::size_t>(y) * image.width + x);
  return image.rgb[p] + image.rgb[p + 1] + image.rgb[p + 2];
}

TYPED_TEST(RenderTest, WallsShowNoDarkRimAroundBodiesBeforeThem) {
  const auto settings = looking_along_y(160, 160, 3.0, 20);
  ShapeRecord<TypeParam> wall;
  wall.kind = shapes::HalfSpace::kind;
  wall.normal = {0, -1, 0};
  PictureScene<TypeParam> bare, with;
  bare.sphere({5, 0, 0}, 0.1);  // out of sight, for a scene of the same size
  bare.free_done();
  bare.shaped(wall, {0, 0.05, 0}, {}, 0);
  with.sphere({0, 0, 0}, 0.1);
  with.free_done();
  with.shaped(wall, {0, 0.05, 0}, {}, 0);
  const Image empty = take_picture(this->backend(), bare, settings);
  const Image image = take_picture(this->backend(), with, settings);
  // The silhouette has a radius of 0.1 / 3 / tan(10 deg) * 80 = 15.1 pixels. The key light comes
  // from the upper left, so the shadow falls to the lower right.
  for (int r = 17; r < 40; ++r) {
    for (int k = 0; k < 8; ++k) {
      const double angle = std::numbers::pi * (0.5 + 0.5 * k / 7);  // from up to left
      const int x = 80 + static_cast<int>(std::lround(r * std::cos(angle)));
      const int y = 80 - static_cast<int>(std::lround(r * std::sin(angle)));
      EXPECT_NEAR(brightness_at(image, x, y), brightness_at(empty, x, y), 3) << x << ", " << y;
    }
  }
}

/// A straight edge seen so closely that a sample of the light's view is ten pixels wide.
TYPED_TEST(RenderTest, ShadowEdgesHaveNoSteps) {
  PictureSettings settings = looking_along_y(200, 200, 1.0, 30);
  settings.camera.position = {0, -1, 1};
  PictureScene<TypeParam> scene;
  for (const double x : {-5.0, 5.0})
    for (const double y : {-5.0, 5.0}) scene.sphere({x, y, 0.01}, 0.01);
  scene.free_done();
  ShapeRecord<TypeParam> record;
  record.kind = shapes::HalfSpace::kind;
  record.normal = {0, 0, 1};
  scene.shaped(record, {0, 0, 0}, {}, 0);
  // The light comes along (0.62, 0.3, -1): the edge of the top, 1.8 m high,
  // has its shadow at x = 0.
  record.kind = shapes::Box::kind;
  record.half_extents = {2, 2, TypeParam(0.4)};
  scene.shaped(record, {-2 - 0.62 * 1.8, -0.3 * 1.8, 1.4}, {}, 2.9);
  const Image image = take_picture(this->backend(), scene, settings);

  // Where each row crosses the middle between shadow and light.
  std::vector<double> row, crossing;
  for (int y = 30; y < 170; ++y) {
    const double middle = 0.5 * (brightness_at(image, 20, y) + brightness_at(image, 180, y));
    ASSERT_GT(brightness_at(image, 180, y) - brightness_at(image, 20, y), 60);
    int x = 20;
    while (brightness_at(image, x + 1, y) < middle) ++x;
    const double a = brightness_at(image, x, y), b = brightness_at(image, x + 1, y);
    row.push_back(y);
    crossing.push_back(x + (middle - a) / (b - a));
  }
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t k = 0; k < row.size(); ++k) {
    n += 1, sx += row[k], sy += crossing[k];
    sxx += row[k] * row[k], sxy += row[k] * crossing[k];
  }
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx), start = (sy - slope * sx) / n;
  double squares = 0;
  for (std::size_t k = 0; k < row.size(); ++k) {
    const double off = crossing[k] - start - slope * row[k];
    squares += off * off;
  }
  EXPECT_LT(std::sqrt(squares / n), 1.5);
}

}  // namespace scree
