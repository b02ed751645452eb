#pragma once
// Promised extents of ranks: while no body has left that of its rank, and none is unseen by them, all that meet are shown.

#include <random>
#include <utility>
#include <vector>

#include "dynamics/rigid/body_loading.h"
#include "dynamics/rigid/body_store.h"
#include "dynamics/rigid/obstacles.h"
#include "dynamics/rigid/shared_constants.h"
#include "kernels/broad_phase/ghost_search.h"
#include "tests/backend_fixture.h"
#include "tests/physics/scene_builder.h"

namespace scree {
namespace {

/// Bodies of one of two ranks, and to whom they are shown.
template <class Real>
class RankOfSpheres {
 public:
  using B = TestBackend;
  static constexpr double kRadius = 0.02, kSlack = 0.04, kPromised = 0.01;  // [m]

  RankOfSpheres(B& b, Index rank, std::vector<Vec3d> x)
      : b_(&b),
        rank_(rank),
        x_(std::move(x)),
        scene_(of_spheres(x_)),
        store_(b, count(), 0, shared_constants(scene_), false),
        obstacles_(b, scene_, store_.fixed_begin(), store_.fixed_begin()),
        shown_(b, count()),
        peer_(b),
        promise_(b, 1),
        extents_(b, 2),
        found_(b, 1) {
    BodyLoading<B, Real>(scene_, store_, obstacles_).load_first();
    upload(b, std::vector<Index>{1 - rank}, peer_);
  }

  std::vector<Vec3d>& x() { return x_; }
  void move() { upload(*b_, x_.data(), store_.view().position.first(count())); }
  BallExtent promise() {
    reduce<BallExtent>(*b_, count(), MeasureReach<Real>{reach()},
                       StorePromise{kPromised, promise_.data()});
    return fetch(*b_, std::as_const(promise_).data());
  }
  void hear(const BallExtent& first, const BallExtent& second) {
    upload(*b_, std::vector<BallExtent>{first, second}, extents_);
  }
  void choose() {
    for_each(*b_, count(), ChooseShown<Real>{near(kSlack), shown_.view()});
    is_shown_ = download(*b_, std::as_const(shown_).view(count()));
  }
  bool is_shown(std::size_t i) const { return is_shown_[i] != 0; }
  bool holds() {
    const NearPeers<Real> near_now = near(0);
    reduce<Sums<1>>(*b_, count(),
                    CountUnseen<Real>{near_now, std::as_const(shown_).view(count()), rank_},
                    StoreUnseen{near_now.extent, near_now.peer, {}, rank_, 0, found_.data()});
    return fetch(*b_, std::as_const(found_).data()).value[0] == 0;
  }

 private:
  static Scene of_spheres(const std::vector<Vec3d>& x) {
    Scene scene = physics::empty_scene(1e-3, 0);
    for (const Vec3d& at : x) physics::add_sphere(scene, at, kRadius, 1);
    return scene;
  }
  Index count() const { return static_cast<Index>(x_.size()); }
  ReachOfBody<Real> reach() { return {{store_.view(), ContactRange{}, {}}, {}}; }
  NearPeers<Real> near(double slack) {
    return {reach(), std::as_const(extents_).view(2), std::as_const(peer_).view(1), slack};
  }

  B* b_;
  Index rank_;
  std::vector<Vec3d> x_;
  Scene scene_;
  BodyStore<B, Real> store_;
  Obstacles<B, Real> obstacles_;
  Buffer<B, std::uint64_t> shown_;
  Buffer<B, Index> peer_;
  Buffer<B, BallExtent> promise_, extents_;
  Buffer<B, Sums<2>> found_;
  std::vector<std::uint64_t> is_shown_;
};

template <class Real>
class PromisedExtentsTest : public BackendTest<Real> {};
TYPED_TEST_SUITE(PromisedExtentsTest, Reals);

/// Two clouds that drift into each other. The second promise is larger or moved, without bodies chosen anew, as long as it serves.
TYPED_TEST(PromisedExtentsTest, WhatMeetsIsShownWhileTheyHold) {
  using Rank = RankOfSpheres<TypeParam>;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto cloud = [&](double at) {
    std::vector<Vec3d> x;
    for (int k = 0; k < 150; ++k) {
      const double px = u(random), py = u(random), pz = u(random);
      x.push_back({at + 0.4 * px, 0.2 * py, 0.2 * pz});
    }
    return x;
  };
  Rank left(this->backend(), 0, cloud(-0.4)), right(this->backend(), 1, cloud(0.42));
  const auto promise = [&] {
    const BallExtent of_left = left.promise(), of_right = right.promise();
    left.hear(of_left, of_right);
    right.hear(of_left, of_right);
  };
  const auto hold = [&] {
    const bool first = left.holds(), second = right.holds();
    return first && second;
  };
  promise();
  left.choose();
  right.choose();
  int held = 0, renewed = 0, chosen = 0, met = 0;
  for (int step = 0; step < 200; ++step) {
    for (Rank* rank : {&left, &right}) {
      for (Vec3d& x : rank->x()) {
        const double px = u(random), py = u(random), pz = u(random);
        x += 2e-4 * Vec3d{px, py, pz} + Vec3d{rank == &left ? 5e-4 : -5e-4, 0, 0};
      }
      rank->move();
    }
    if (hold()) {
      ++held;
    } else {
      promise();
      if (hold()) {
        ++renewed;
      } else {
        ++chosen;
        left.choose();
        right.choose();
        ASSERT_TRUE(hold()) << step;
      }
    }
    for (std::size_t i = 0; i < left.x().size(); ++i) {
      for (std::size_t j = 0; j < right.x().size(); ++j) {
        if (norm(left.x()[i] - right.x()[j]) > 2 * Rank::kRadius) continue;
        ++met;
        ASSERT_TRUE(left.is_shown(i) && right.is_shown(j)) << step;
      }
    }
  }
  EXPECT_GT(held, 100);
  EXPECT_GT(renewed, 5);
  EXPECT_GT(chosen, 2);
  EXPECT_GT(met, 500);
}

}  // namespace
}  // namespace scree
