#pragma once
// A bed, and the same bed divided between two worlds: each owns the bodies on one side of a plane
// and has ghosts of those on the other.

#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <tuple>
#include <vector>

#include "dynamics/rigid/contact_names.h"
#include "tests/collision/collision_scene.h"

namespace scree {

/// What a world has of a bed.
template <class Real>
struct Part {
  CollisionScene<Real> scene;
  std::vector<Index> id;  ///< of each place in storage, the same in all worlds; -1: room
};

template <class Real>
struct Bed {
  struct Body {
    Vec3<double> x;
    double r = 0;
    Vec3<double> v, w;
    Vec3<double> half;  ///< of a box; zero: a sphere
    std::uint8_t locks = 0;
    int owner = 0;  ///< one of the two worlds
  };
  std::vector<Body> free;
  /// Adds the fixed bodies to a scene.
  std::function<void(CollisionScene<Real>&)> add_fixed = [](CollisionScene<Real>&) {};
  CollisionScene<Real> settings;       ///< without bodies
  static constexpr double kCut = 0.5;  ///< x of the plane that divides it [m]

  /// Gives bodies to the world on whose side they are.
  void divide() {
    for (Body& body : free) body.owner = body.x.x < kCut ? 0 : 1;
  }

  Part<Real> whole() const {
    return part([](const Body&) { return true; }, [](const Body&) { return false; });
  }
  /// @param reach  ghosts are the bodies of the other world up to this distance from the plane [m]
  Part<Real> half(int side, double reach) const {
    return part(
        [=](const Body& body) { return body.owner == side; },
        [=](const Body& body) { return body.owner != side && std::abs(body.x.x - kCut) <= reach; });
  }

 private:
  template <class IsOwned, class IsGhost>
  Part<Real> part(IsOwned&& is_owned, IsGhost&& is_ghost) const {
    Part<Real> p;
    p.scene = settings;
    for (std::size_t i = 0; i < free.size(); ++i)
      if (is_owned(free[i])) add(free[i], static_cast<Index>(i), p);
    const Index owned = p.scene.owned_count;
    for (std::size_t i = 0; i < free.size(); ++i)
      if (is_ghost(free[i])) add(free[i], static_cast<Index>(i), p);
    p.scene.ghost_count = p.scene.owned_count - owned;
    p.scene.owned_count = owned;
    // What lies in room must not be seen, wherever it is.
    p.scene.room = 3;
    for (Index k = 0; k < p.scene.room; ++k) p.scene.add(free.front().x, 10 * free.front().r);
    p.id.resize(p.scene.position.size(), -1);
    add_fixed(p.scene);
    for (auto id = static_cast<Index>(free.size()); p.id.size() < p.scene.position.size(); ++id)
      p.id.push_back(id);
    return p;
  }
  static void add(const Body& body, Index id, Part<Real>& p) {
    if (norm2(body.half) > 0) {
      p.scene.add_free_box(body.x, body.half);
    } else {
      p.scene.add_free(body.x, body.r, body.v);
    }
    p.scene.velocity.back() = Vec3<Real>(body.v);
    p.scene.angular_velocity.back() = Vec3<Real>(body.w);
    p.scene.locks.push_back(body.locks);
    p.id.push_back(id);
  }
};

/// Spheres in a unit box that overlap here and there, and move.
template <class Real>
Bed<Real> bed_of_spheres(Index count, double small, double large, unsigned seed) {
  Bed<Real> bed;
  bed.settings.settings.envelope = 0.05 * small;
  bed.settings.settings.skin = 0.2 * small;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto vector = [&](double size) {
    return size *
           Vec3<double>{2 * uniform(random) - 1, 2 * uniform(random) - 1, 2 * uniform(random) - 1};
  };
  for (Index i = 0; i < count; ++i) {
    const double size = std::pow(large / small, std::pow(uniform(random), 4));
    typename Bed<Real>::Body body;
    body.x = {uniform(random), uniform(random), 0.3 * uniform(random)};
    body.r = 0.5 * small * size;
    body.v = vector(1);
    body.w = vector(5);
    bed.free.push_back(body);
  }
  bed.divide();
  return bed;
}

/// A contact by the ids of its bodies, the lower one first, -1 for a wall; and which of them it is.
using ContactName = std::tuple<Index, Index, std::uint64_t>;

/// A contact, and whether its normal leads from the body with the higher id to the other one.
struct NamedContact {
  HostContact contact;
  Index index = 0;  ///< in the list
  bool is_turned = false;
};

template <class Real>
std::multimap<ContactName, NamedContact> by_name(const std::vector<HostContact>& contacts,
                                                 const ContactKeys& rule, const Part<Real>& part) {
  std::vector<std::uint64_t> keys;
  for (const HostContact& c : contacts) keys.push_back(c.key);
  const NamedContacts names = names_of(keys, rule, part.id);
  std::multimap<ContactName, NamedContact> out;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const Index a = names.body_a[c], b = names.body_b[c];
    const bool is_turned = b >= 0 && b < a;
    out.insert({{is_turned ? b : a, is_turned ? a : b, names.feature[c]},
                {contacts[c], static_cast<Index>(c), is_turned}});
  }
  return out;
}

}  // namespace scree
