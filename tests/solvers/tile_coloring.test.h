// Tiles of a contact problem, their colors and those of their contacts, against what they are
// defined to be. On a device this checks the tuned twins as well.
#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "solvers/tile_coloring.h"
#include "tests/backend_fixture.h"
#include "tests/problem_builder.h"

namespace scree {
namespace {

using fixtures::lattice_problem;
using fixtures::PlainProblem;
using fixtures::ProblemBuffers;

class TileColoringTest : public BackendTest<double> {
 protected:
  static constexpr Index kBodies = 48;  ///< of a tile

  /// What is known of the tiles, on the host.
  struct Found {
    std::vector<Index> color, sequence, starts, first, outside;
    std::vector<TileLink> link;
    std::vector<TileShape> shape;
    std::vector<std::map<Index, bool>> neighbors;  ///< whether each comes after the tile
  };

  Found find(const PlainProblem& plain) {
    ProblemBuffers<TestBackend, double> buffers(backend(), plain);
    TileColoring<TestBackend> tiles(backend());
    tiles.compute(backend(), buffers.problem(), kBodies);
    Found f{download(backend(), tiles.color()),
            download(backend(), tiles.sequence()),
            tiles.starts(),
            download(backend(), tiles.first()),
            download(backend(), tiles.outside()),
            download(backend(), tiles.link()),
            download(backend(), tiles.shape()),
            {}};
    const TileLists lists = tiles.neighbors();
    const std::vector<Index> all = download(backend(), lists.tile);
    const std::vector<Index> count = download(backend(), lists.count);
    for (std::size_t t = 0; t < f.color.size(); ++t) {
      f.neighbors.emplace_back();
      for (Index k = 0; k < count[t]; ++k) {
        const Index neighbor = all[t * static_cast<std::size_t>(lists.room) + k];
        EXPECT_TRUE(f.neighbors[t].emplace(neighbor / 2, neighbor % 2 == 1).second) << "twice";
      }
    }
    return f;
  }

  static Index tile(Index body) { return body / kBodies; }

  /// Tiles that touch each free body.
  static std::vector<std::set<Index>> touching(const PlainProblem& plain) {
    std::vector<std::set<Index>> tiles(plain.data.free_count);
    for (Index i = 0; i < plain.data.free_count; ++i) tiles[i].insert(tile(i));
    for (const oracle::Contact& c : plain.data.contacts)
      if (c.b < plain.data.free_count) tiles[c.b].insert(tile(c.a));
    return tiles;
  }

  static void expect_conflicts(const PlainProblem& plain, const Found& f) {
    std::vector<std::set<Index>> expected(f.color.size());
    for (const std::set<Index>& tiles : touching(plain)) {
      for (Index t : tiles)
        for (Index u : tiles)
          if (t != u) expected[t].insert(u);
    }
    for (std::size_t t = 0; t < expected.size(); ++t) {
      std::set<Index> found;
      for (const auto& [u, is_after] : f.neighbors[t]) {
        found.insert(u);
        EXPECT_NE(f.color[u], f.color[t]);
        EXPECT_EQ(is_after, f.color[u] > f.color[t]);
      }
      ASSERT_EQ(found, expected[t]) << "tile " << t;
    }
  }

  static void expect_sequence(const PlainProblem& plain, const Found& f) {
    std::vector<Index> sorted(f.color.size());
    for (std::size_t t = 0; t < sorted.size(); ++t) sorted[t] = static_cast<Index>(t);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [&](Index x, Index y) { return f.color[x] < f.color[y]; });
    EXPECT_EQ(f.sequence, sorted);
    for (std::size_t k = 0; k + 1 < f.starts.size(); ++k) {
      ASSERT_LT(f.starts[k], f.starts[k + 1]) << "a color without tiles";
      EXPECT_EQ(f.color[sorted[f.starts[k]]], static_cast<Index>(k));
    }
    const std::vector<std::set<Index>> tiles = touching(plain);
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      const Index lowest =
          *std::min_element(tiles[i].begin(), tiles[i].end(),
                            [&](Index x, Index y) { return f.color[x] < f.color[y]; });
      ASSERT_EQ(f.first[i], lowest) << "body " << i;
    }
  }

  /// Links say where bodies are, and put contacts in the order of greedy colors.
  /// @return tiles without links
  static int expect_links(const PlainProblem& plain, const Found& f) {
    const std::vector<oracle::Contact>& contacts = plain.data.contacts;
    const Index free_count = plain.data.free_count;
    int without = 0;
    std::size_t first = 0;
    for (std::size_t t = 0; t < f.shape.size(); ++t) {
      std::size_t last = first;
      while (last < contacts.size() && tile(contacts[last].a) == static_cast<Index>(t)) ++last;
      const Index begin = static_cast<Index>(t) * kBodies;
      const Index own = std::min(kBodies, free_count - begin);
      const TileShape& s = f.shape[t];
      std::set<Index> outside;
      Index fixed = 0;
      std::map<Index, std::set<Index>> used;
      std::vector<std::tuple<Index, std::size_t>> order;
      for (std::size_t c = first; c < last; ++c) {
        const Index a = contacts[c].a, b = contacts[c].b;
        if (b >= free_count) ++fixed;
        if (b < free_count && tile(b) != static_cast<Index>(t)) outside.insert(b);
        Index color = 0;
        while (used[a].count(color) || (b < free_count && used[b].count(color))) ++color;
        used[a].insert(color);
        used[b].insert(color);
        order.emplace_back(color, c);
      }
      EXPECT_EQ(s.free_bodies, own + static_cast<Index>(outside.size()));
      EXPECT_EQ(s.bodies, s.free_bodies + fixed);
      for (Index k = own; k < s.free_bodies; ++k)
        EXPECT_EQ(outside.erase(f.outside[first + k - own]), 1U);
      std::sort(order.begin(), order.end());
      const Index colors = order.empty() ? 0 : std::get<0>(order.back()) + 1;
      if (colors > kTileColors) {
        EXPECT_EQ(s.colors, 0);
        ++without;
      } else {
        EXPECT_EQ(s.colors, colors);
        for (std::size_t k = 0; k < order.size(); ++k) {
          const auto [color, c] = order[k];
          const TileLink& link = f.link[c];
          EXPECT_EQ(link.place, k);
          EXPECT_LT(link.place, s.color_end[color]);
          EXPECT_GE(link.place, color > 0 ? s.color_end[color - 1] : 0);
          EXPECT_EQ(begin + link.a, contacts[c].a);
          const Index b = link.b < own             ? begin + link.b
                          : link.b < s.free_bodies ? f.outside[first + link.b - own]
                                                   : f.outside[last - 1 - (link.b - s.free_bodies)];
          EXPECT_EQ(b, contacts[c].b);
        }
      }
      first = last;
    }
    EXPECT_EQ(first, contacts.size());
    return without;
  }

  int expect_right(const PlainProblem& plain) {
    const Found f = find(plain);
    expect_conflicts(plain, f);
    expect_sequence(plain, f);
    return expect_links(plain, f);
  }
};

TEST_F(TileColoringTest, Lattice) {
  EXPECT_EQ(expect_right(lattice_problem(8, 0.5, 1)), 0);
  EXPECT_EQ(expect_right(lattice_problem(9, 1, 2)), 0);
}

TEST_F(TileColoringTest, BodiesWithoutContacts) {
  EXPECT_EQ(expect_right(lattice_problem(8, 0.03, 3)), 0);
}

/// Every tile conflicts with every other; several contacts of one pair; fixed bodies.
TEST_F(TileColoringTest, RandomProblem) {
  EXPECT_EQ(expect_right(fixtures::random_problem(
                {.free_count = 1500, .fixed_count = 40, .contact_count = 4000, .seed = 5})),
            0);
}

TEST_F(TileColoringTest, OneBody) {
  PlainProblem plain;
  plain.add_sphere(1, 0.5);
  plain.add_fixed();
  plain.data.free_count = 1;
  plain.add_radial_contact(0, 1, {0, 0, -1}, 0.5);
  EXPECT_EQ(expect_right(plain), 0);
}

/// Tiles that run out of colors while contacts with known bodies are still to come.
TEST_F(TileColoringTest, ManyContactsOfEveryBody) {
  EXPECT_EQ(expect_right(fixtures::random_problem(
                {.free_count = 150, .fixed_count = 3, .contact_count = 4500, .seed = 4})),
            3);
}

/// A body with more contacts than a tile has colors, and more contacts than a tile of a device
/// keeps in fast memory; others of hundreds of tiles touch one more body.
TEST_F(TileColoringTest, BodiesWithVeryManyContacts) {
  PlainProblem plain;
  const int bodies = 10000;
  for (int i = 0; i < bodies; ++i) plain.add_sphere(1, 0.5);
  plain.add_fixed();
  plain.data.free_count = bodies;
  for (int i = 0; i < bodies - 1; ++i) {
    if (i == 100) {
      for (int k = 1; k <= 500; ++k) plain.add_radial_contact(i, i + 3 * k, {1, 0, 0}, 0.5);
    } else if (i % 50 == 7) {
      plain.add_radial_contact(i, bodies - 1, {0, 1, 0}, 0.5);
    } else if (i % 3 == 0) {
      plain.add_radial_contact(i, i + 1, {0, 1, 0}, 0.5);
    } else if (i % 3 == 1) {
      plain.add_radial_contact(i, bodies, {0, 0, 1}, 0.5);
    }
  }
  EXPECT_EQ(expect_right(plain), 1);
}

}  // namespace
}  // namespace scree
