// Camera arithmetic: axes, framing, projection rectangles, the light's view.

#include "host/render/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "kernels/render/view.h"
#include "shapes/sphere.h"

namespace scree::render {
namespace {

void expect_orthonormal(const CameraAxes& a) {
  EXPECT_NEAR(norm(a.right), 1, 1e-12);
  EXPECT_NEAR(norm(a.up), 1, 1e-12);
  EXPECT_NEAR(norm(a.forward), 1, 1e-12);
  EXPECT_NEAR(dot(a.right, a.up), 0, 1e-12);
  EXPECT_NEAR(dot(a.right, a.forward), 0, 1e-12);
  EXPECT_NEAR(norm(cross(a.right, a.up) + a.forward), 0, 1e-12);
}

/// Picture coordinates of a point, -1 to 1 inside the picture.
Vec3d in_picture(const View& view, double aspect, const Vec3d& point) {
  const Vec3d d = point - view.origin;
  const double z = dot(d, Vec3d(view.forward));
  const double tan_y = view.top;
  return {dot(d, Vec3d(view.right)) / (z * tan_y * aspect), dot(d, Vec3d(view.up)) / (z * tan_y),
          z};
}

TEST(Camera, AxesAreOrthonormalForAnyInput) {
  expect_orthonormal(camera_axes({1, 2, -0.5}, {0, 0, 1}));
  expect_orthonormal(camera_axes({0, 0, -1}, {0, 0, 1}));  // straight down
  expect_orthonormal(camera_axes({0, 0, 0}, {0, 0, 1}));   // target equals position
  expect_orthonormal(camera_axes({1, 0, 0}, {0, 0, 0}));   // no up
  const CameraAxes a = camera_axes({0, 1, 0}, {0, 0, 1});
  EXPECT_NEAR(a.right.x, 1, 1e-12);
  EXPECT_NEAR(a.up.z, 1, 1e-12);
}

TEST(Camera, FramedBoxFillsThePictureAndStaysInside) {
  const Box boxes[] = {{{-1, -2, 0}, {3, 1, 0.5}},
                       {{0, 0, 0}, {0.01, 0.01, 4}},
                       {{1e3, 1e3, 1e3}, {1001, 1040, 1002}}};
  for (const Vec3d& up : {Vec3d{0, 0, 1}, Vec3d{0, 1, 0}, Vec3d{0, 0, -1}}) {
    for (const double aspect : {16.0 / 9, 0.5}) {
      for (const Box& box : boxes) {
        CameraSettings base;
        base.up = up;
        const double margin = 0.1;
        FrameAxes axes = automatic_axes(base, box.center(), aspect, margin);
        for (int k = 1; k < kFramingPasses; ++k) axes = narrowed(axes, box_sides(axes, box));
        const auto camera = framing_camera(base, axes, box_sides(axes, box), box.diagonal());
        const View view = camera_view(camera, static_cast<int>(600 * aspect), 600, box.diagonal());
        double widest = 0, left = 1, right = -1, low = 1, high = -1;
        for (int k = 0; k < 8; ++k) {
          const Vec3d p = in_picture(view, aspect, box.corner(k));
          EXPECT_GT(p.z, view.near_depth);
          widest = std::max({widest, std::abs(p.x), std::abs(p.y)});
          left = std::min(left, p.x), right = std::max(right, p.x);
          low = std::min(low, p.y), high = std::max(high, p.y);
        }
        EXPECT_NEAR(widest, 1 - margin, 1e-3);
        // Centered: the free space is equal on the two sides that face each other.
        EXPECT_NEAR(left + right, 0, 0.02);
        EXPECT_NEAR(low + high, 0, 0.02);
        EXPECT_GT(dot(camera.position - camera.target, up), 0);  // seen from above
      }
    }
  }
}

TEST(Camera, FramedSphereTouchesTheMargin) {
  CameraSettings base;
  base.vertical_angle = 50;
  const FrameAxes axes = automatic_axes(base, {1, 2, 3}, 1.0, 0.2);
  const auto camera = framing_camera(base, axes, axes.sides({1, 2, 3}, 0.5), 1);
  // The tangent cone has the half angle whose tangent is 0.8 tan(25 degrees).
  const double distance = norm(camera.position - Vec3d{1, 2, 3});
  EXPECT_NEAR(std::tan(std::asin(0.5 / distance)), 0.8 * std::tan(25 * std::numbers::pi / 180),
              1e-9);
}

TEST(Camera, NothingToFrameKeepsTheGivenCamera) {
  CameraSettings base;
  const FrameAxes axes = automatic_axes(base, {}, 1.5);
  const auto camera = framing_camera(base, axes, box_sides(axes, Box{}), 1);
  EXPECT_EQ(camera.position, base.position);
  EXPECT_EQ(camera.target, base.target);
}

TEST(Camera, SingleSpherePointIsFramedAtFiniteDistance) {
  const FrameAxes axes = automatic_axes({}, {0, 0, 0}, 1.5);
  const auto camera = framing_camera({}, axes, axes.sides({0, 0, 0}, 0), 0);
  EXPECT_TRUE(is_finite(camera.position));
  EXPECT_GT(norm(camera.target - camera.position), 0);
}

TEST(Camera, SphereRectangleHoldsTheSilhouette) {
  CameraSettings camera;
  camera.position = {0, -3, 0};
  const View view = camera_view(camera, 320, 200, 1);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  for (int k = 0; k < 300; ++k) {
    const Vec3d center{uniform(random), uniform(random), uniform(random)};
    const double radius = 0.3 + 0.2 * uniform(random) * (k % 4 != 0);
    if (radius <= 0) continue;
    const Eye eye = view.eye_at(center);
    const SampleRect rect = sphere_rect(view, eye.to_view({0, 0, 0}), static_cast<float>(radius));
    const bool is_whole = center.y > -2.5 + radius && rect.x_begin > 0 && rect.y_begin > 0 &&
                          rect.x_end < view.width && rect.y_end < view.height;
    int outside = 0, edge = 0;
    for (int j = 0; j < view.height; ++j) {
      for (int i = 0; i < view.width; ++i) {
        const Ray ray = eye.ray(view.plane_x(i), view.plane_y(j));
        if (shapes::Sphere::hit(static_cast<float>(radius), ray) < view.near_depth) continue;
        outside += i < rect.x_begin || i >= rect.x_end || j < rect.y_begin || j >= rect.y_end;
        edge += i < rect.x_begin + 3 || i >= rect.x_end - 3 || j < rect.y_begin + 3 ||
                j >= rect.y_end - 3;
      }
    }
    EXPECT_EQ(outside, 0);
    EXPECT_TRUE(!is_whole || edge > 0);  // and it is no larger than it must be
  }
}

TEST(Camera, LightViewCoversTheBox) {
  const Box box{{-2, 0, 1}, {5, 1, 1.2}};
  const View light = light_view(box, normalized(Vec3d{-0.5, -0.3, 1}), 512);
  for (int k = 0; k < 8; ++k) {
    const Vec3d d = box.corner(k) - light.origin;
    EXPECT_GT(dot(d, Vec3d(light.forward)), 0);
    EXPECT_LE(std::abs(dot(d, Vec3d(light.right))), light.top);
    EXPECT_LE(std::abs(dot(d, Vec3d(light.up))), light.top);
  }
  EXPECT_EQ(light_view(Box{}, {0, 0, 1}, 512).sample_count(), 0);
}

TEST(Camera, KeyLightComesFromAboveForEveryCamera) {
  for (const Vec3d& position : {Vec3d{3, -3, 2}, Vec3d{0, 0, 5}, Vec3d{0, -5, -1}}) {
    CameraSettings camera;
    camera.position = position;
    const Vec3d light = key_light_direction(camera);
    EXPECT_NEAR(norm(light), 1, 1e-12);
    EXPECT_GT(light.z, 0.5);
  }
}

TEST(Camera, BulkLeavesTheEndsOut) {
  std::vector<Vec3d> points;
  for (int k = 0; k < 1000; ++k) points.push_back({0.001 * k, 1.0, -0.002 * k});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  points.push_back({nan, 0, 0});
  points.push_back({1e6, -1e6, 1e6});
  std::shuffle(points.begin(), points.end(), std::mt19937(5));
  const Box box = bulk_of(points);
  EXPECT_NEAR(box.lower.x, 0.020, 0.0015);
  EXPECT_NEAR(box.upper.x, 0.980, 0.0015);
  EXPECT_NEAR(box.lower.z, -1.960, 0.003);
  EXPECT_NEAR(box.upper.z, -0.040, 0.003);
  EXPECT_EQ(box.lower.y, 1.0);
  EXPECT_EQ(box.upper.y, 1.0);
  EXPECT_TRUE(bulk_of({}).empty());
  EXPECT_TRUE(bulk_of({{nan, 0, 0}}).empty());
  // Few bodies: each of them counts.
  const Box two = bulk_of({{0, 0, 0}, {100, 0, 0}});
  EXPECT_EQ(two.lower.x, 0);
  EXPECT_EQ(two.upper.x, 100);
}

TEST(Camera, KeepsWhatIsNearAndLargeBodiesFartherOff) {
  const Box bulk{{0, 0, 0}, {1, 1, 0.1}};
  const KeepRule keep = keep_rule(bulk, 0.01);
  EXPECT_TRUE(keep({0.5, 0.5, 0.05}, 0.01));
  EXPECT_TRUE(keep({1.4, -0.4, 0.14}, 0.01));
  EXPECT_FALSE(keep({1.7, 0.5, 0.05}, 0.01));
  EXPECT_FALSE(keep({0.5, 0.5, 0.5}, 0.01));
  EXPECT_TRUE(keep({0.5, 0.5, 0.5}, 0.05)) << "a ball above the bed";
  EXPECT_FALSE(keep({0.5, 0.5, -5000}, 0.05));
  EXPECT_FALSE(keep({std::numeric_limits<double>::quiet_NaN(), 0.5, 0.05}, 0.05));
}

TEST(Color, MapRisesInLightness) {
  float last = -1;
  for (int k = 0; k <= 100; ++k) {
    const Vec3f c = color_map(0.01f * static_cast<float>(k));
    const float luminance = 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
    EXPECT_GT(luminance, last);
    last = luminance;
  }
}

}  // namespace
}  // namespace scree::render
