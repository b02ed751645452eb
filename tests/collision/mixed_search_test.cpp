// Repeated searches of a step, among bodies of many shapes and at solid walls: what is kept of the searches before is what a
// first search would find. On the CPU, since the element programs are those of the detector.

#include <gtest/gtest.h>

#include <random>

#include "kernels/backend/cpu.h"

namespace scree {
using TestBackend = Cpu;
}
#include "shapes/capsule.h"
#include "shapes/cylinder.h"
#include "tests/collision/collision_scene.h"

namespace scree {
namespace {

using SearchScene = CollisionScene<double>;

SearchScene heap(int count, double edge) {
  SearchScene s;
  s.settings.envelope = 0.02;
  s.settings.margin_limit = 0.25;
  s.h = 0.01;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vector = [&] {
    const double x = unit(random), y = unit(random);
    return Vec3d{x, y, unit(random)};
  };
  const ShapeKind kinds[] = {shapes::Box::kind, shapes::Capsule::kind, shapes::Cylinder::kind};
  for (int k = 0; k < count; ++k) {
    const double r = 0.25 + 0.05 * unit(random), h = 0.5 + 0.1 * unit(random);
    s.add_free(0.5 * edge * vector(), std::sqrt(2 * r * r + h * h), vector());
    s.orientation.back() = exp_map(3.0 * vector());
    s.angular_velocity.back() = vector();
    if (k % 5 == 0) continue;  // a sphere
    s.give_shape(kinds[k % 3], false).half_extents = {r, r, h};
  }
  s.add_half_space({0, 0, -0.4 * edge}, {0, 0, 1});
  return s;
}

/// The contacts that a search lists.
struct Listed {
  std::vector<std::uint64_t> key;
  std::vector<Vec3<double>> normal, arm_a, arm_b;
  std::vector<double> gap;
  bool operator==(const Listed&) const = default;
};

class MixedSearch {
 public:
  explicit MixedSearch(const SearchScene& s)
      : run_(cpu_, s),
        obstacles_(cpu_, s.obstacles, {}),
        candidates_(cpu_),
        margin_(cpu_),
        range_{s.settings.envelope, s.h, {}, {}, {}} {
    range_.margin_limit = s.settings.margin_limit;
    keys_ = run_.detector().name_elements(run_.bodies());
    obstacles_.refresh(cpu_, run_.bodies(), range_, keys_);
  }

  /// @param margin  of each body [m]
  Listed search(MixedContacts<Cpu, double>& mixed, const std::vector<float>& margin) {
    upload(cpu_, margin, margin_);
    range_.margin = std::as_const(margin_).view(static_cast<Offset>(margin.size()));
    Buffer<Cpu, float> no_note(cpu_);
    if (!candidates_.covers(cpu_, run_.bodies(), range_))
      candidates_.renew(cpu_, run_.bodies(), range_, {0.1}, no_note);
    const ContactTest<ShapeMix::any, double> test{
        run_.bodies(), obstacles_.shapes(), candidates_.view(), obstacles_.walls(), range_, keys_};
    const Index pieces = test.candidates.piece_count();
    Buffer<Cpu, Index> count(cpu_, pieces);
    Buffer<Cpu, Offset> begin(cpu_, static_cast<Offset>(pieces) + 1);
    mixed.find(cpu_, test, count.view());
    exclusive_scan(cpu_, Span<const Index>(count.view()), begin.view());
    const Offset n = fetch(cpu_, begin.data() + pieces);
    FoundContacts<Cpu, double> found(cpu_);
    const Span<std::uint64_t> key = found.key.resize_discard(n);
    mixed.write_keys(cpu_, test, begin.view(), key);
    found.resize_discard(ContactParts(ContactLayout::general), n, 0);
    const ContactArrays<double> out{found.spans(), 0};
    mixed.fill(cpu_, test, candidates_.has_passes(), key, out);
    return {download(cpu_, key), download(cpu_, out.normal), download(cpu_, out.arm_a),
            download(cpu_, out.arm_b), download(cpu_, out.gap)};
  }
  Cpu& cpu() { return cpu_; }

 private:
  Cpu cpu_;
  CollisionRun<Cpu, double> run_;
  ObstacleBuffers<Cpu, double> obstacles_;
  PairCandidates<Cpu, double> candidates_;
  Buffer<Cpu, float> margin_;
  ContactRange range_;
  ContactKeys keys_;
};

TEST(MixedSearch, KeepsWhatAFirstSearchWouldFind) {
  constexpr int kBodies = 250;
  MixedSearch search(heap(kBodies, 6));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  const std::vector<float> none(kBodies, 0.0f);
  // Tiny ones for all, large ones for some; then others, some of them smaller.
  std::vector<float> wide = none, other = none;
  for (std::size_t i = 0; i < kBodies; ++i) {
    wide[i] = static_cast<float>(unit(random) < 0.2 ? 0.1 * unit(random) : 1e-3 * unit(random));
    other[i] = unit(random) < 0.8   ? wide[i]
               : unit(random) < 0.5 ? 0.5f * wide[i]
                                    : static_cast<float>(0.05 * unit(random));
  }
  MixedContacts<Cpu, double> kept(search.cpu());
  std::vector<std::size_t> sizes;
  Index before = 0;
  const std::vector<float>* const margins[] = {&none, &wide, &other};
  for (const std::vector<float>* margin : margins) {
    const Listed again = search.search(kept, *margin);
    MixedContacts<Cpu, double> fresh(search.cpu());
    const Listed first = search.search(fresh, *margin);
    EXPECT_TRUE(again == first);
    sizes.push_back(first.key.size());
    // Most pairs have been kept.
    const Index computed = kept.computed_count() - before;
    if (before > 0) {
      EXPECT_LT(computed, fresh.computed_count() / 2);
    }
    EXPECT_GT(computed, 0);
    before = kept.computed_count();
  }
  EXPECT_GT(sizes[0], 200u);
  EXPECT_GT(sizes[1], sizes[0]);
}

/// What solid walls list for an envelope, and for which others the search says that this holds.
struct SolidList {
  std::vector<std::uint32_t> element;
  std::vector<double> height;  ///< of planes that are met on the way, else 0 [m]
  SameList same;
  void operator()(std::uint32_t e) { element.push_back(e), height.push_back(0); }
  void way(std::uint32_t e, const HoldingPlane& plane) {
    element.push_back(e), height.push_back(plane.height);
  }
};

TEST(SolidSearch, HoldsForTheEnvelopesItNames) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  SearchScene s;
  s.h = 0.01;
  s.settings.envelope = 0.02;
  for (int k = 0; k < 400; ++k) {
    // Near a bumpy floor or a box, slow and fast.
    const double r = 0.2 + 0.05 * unit(random), speed = k % 2 == 0 ? 0.2 : 20;
    const double x = unit(random), y = unit(random), vx = unit(random), vy = unit(random);
    s.add_free({x, y, r + 0.1 * unit(random)}, k % 3 == 0 ? std::sqrt(3.0) * r : r,
               {speed * vx, speed * vy, -std::abs(speed * unit(random))});
    if (k % 3 != 0) continue;
    s.orientation.back() = exp_map(Vec3d{x, y, vx});
    s.give_shape(shapes::Box::kind, false).half_extents = {r, r, r};
  }
  MeshSource floor;
  constexpr int kCells = 12;
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i <= kCells; ++i)
      floor.vertices.push_back({0.25 * i - 1.5, 0.25 * j - 1.5, 0.03 * unit(random)});
  }
  for (int j = 0; j < kCells; ++j) {
    for (int i = 0; i < kCells; ++i) {
      const Index v = j * (kCells + 1) + i, up = v + kCells + 1;
      floor.triangles.push_back({v, v + 1, up + 1});
      floor.triangles.push_back({v, up + 1, up});
    }
  }
  floor.closed = false;
  s.add_mesh_wall({0, 0, 0}, floor);
  s.add_box_wall({0.4, 0.2, -0.1}, {0.3, 0.4, 0.2});

  Cpu cpu;
  CollisionRun<Cpu, double> run(cpu, s);
  ObstacleBuffers<Cpu, double> obstacles(cpu, s.obstacles, {});
  const ContactRange range{s.settings.envelope, s.h, {}, {}, {}};
  obstacles.refresh(cpu, run.bodies(), range, run.detector().name_elements(run.bodies()));
  const auto list = [&](Index i, double envelope) {
    const BodySample body = load_body<ShapeMix::any>(run.bodies(), obstacles.shapes(), range, i);
    SolidList found;
    found.same = visit_solids<ShapeMix::any>(obstacles.walls(), range, body, envelope, found);
    return found;
  };
  int listed = 0, held = 0, refused = 0;
  for (Index i = 0; i < s.owned_count; ++i) {
    for (int trial = 0; trial < 20; ++trial) {
      const double first = 0.02 + 0.02 * std::abs(unit(random));
      const double other = first + 0.03 * unit(random);
      const SolidList found = list(i, first);
      listed += found.element.empty() ? 0 : 1;
      EXPECT_TRUE(found.same.holds(first));
      if (!found.same.holds(other)) {
        ++refused;
        continue;
      }
      ++held;
      const SolidList again = list(i, other);
      EXPECT_EQ(again.element, found.element) << i;
      EXPECT_EQ(again.height, found.height) << i;
    }
  }
  EXPECT_GT(listed, 2000);
  EXPECT_GT(held, 2000);
  EXPECT_GT(refused, 200);
}

TEST(MixedSearch, ComputesNothingForTheSameMargins) {
  MixedSearch search(heap(100, 4));
  const std::vector<float> margin(100, 0.01f);
  MixedContacts<Cpu, double> mixed(search.cpu());
  const Listed first = search.search(mixed, margin);
  const Index computed = mixed.computed_count();
  EXPECT_TRUE(search.search(mixed, margin) == first);
  EXPECT_EQ(mixed.computed_count(), computed);
  mixed.release();
  EXPECT_TRUE(search.search(mixed, margin) == first);
  EXPECT_EQ(mixed.computed_count(), computed);
}

}  // namespace
}  // namespace scree
