#pragma once
// A step in which some of the bodies are ghosts: the contact problem of a bed divided between two
// worlds, what solvers make of one half, and the motion of its bodies.

#include <array>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "dynamics/rigid/integration.h"
#include "dynamics/rigid/problem_assembly.h"
#include "host/problems/download_problem.h"
#include "host/problems/upload_problem.h"
#include "kernels/solve/metric_step.h"
#include "solvers/solver.h"
#include "solvers/solver_card.h"
#include "tests/backend_fixture.h"
#include "tests/collision/divided_bed.h"

namespace scree {
namespace {

/// A part of a bed of spheres with the contact problem of its next step.
template <class Real>
class WorldOfPart {
 public:
  using B = TestBackend;
  static constexpr double kDensity = 2500;  ///< [kg/m^3]

  WorldOfPart(B& b, const Part<Real>& part, ContactLayout layout)
      : b_(&b),
        part_(part),
        layout_(layout),
        run_(b, part.scene),
        id_(b),
        material_(b),
        inv_mass_(b),
        assembly_(b, scene(layout), summary(layout), {}),
        step_(b) {
    const auto fixed = static_cast<std::size_t>(run_.bodies().fixed_begin);
    std::vector<Real> inv_mass(part.id.size());
    for (std::size_t i = 0; i < fixed; ++i) inv_mass[i] = static_cast<Real>(1 / mass(i));
    upload(b, inv_mass, inv_mass_);
    upload(b, std::vector<std::uint8_t>(part.id.size()), material_);
    upload(b, part.id, id_);
  }

  double mass(std::size_t i) const {
    const double r = part_.scene.radius[i];
    return kDensity * 4 / 3 * 3.14159265358979 * r * r * r;
  }
  BodyView<Real> bodies() {
    BodyView<Real> v = run_.bodies();
    v.inv_mass = inv_mass_.view();
    v.material = material_.view();
    v.id = id_.view();
    return v;
  }
  CollisionRun<B, Real>& run() { return run_; }
  const Part<Real>& part() const { return part_; }
  ContactLayout layout() const { return layout_; }

  const ContactProblem<Real>& assemble() {
    const auto contacts = run_.detect();
    names_ = by_name(contacts, run_.detector().keys(), part_);
    SteppingSettings stepping;
    stepping.time_step = part_.scene.h;
    const Vec3<Real> gravity_step(part_.scene.h * part_.scene.gravity);
    const ContactView<Real> view = run_.detector().contacts();
    step_ = assembly_.assemble(*b_, bodies(), bodies(), bodies(), view, stepping, 0, gravity_step);
    return step_.problem;
  }
  const ContactProblem<Real>& problem() const { return step_.problem; }
  const std::multimap<ContactName, NamedContact>& names() const { return names_; }

 private:
  static Scene scene(ContactLayout layout) {
    Scene s;
    if (layout == ContactLayout::rolling) s.materials[0].rolling_friction = 1e-3;
    return s;
  }
  static SceneSummary summary(ContactLayout layout) {
    SceneSummary s;
    s.layout = layout;
    s.solid_spheres = s.radial_bodies = layout != ContactLayout::mixed;
    return s;
  }

  B* b_;
  Part<Real> part_;
  ContactLayout layout_;
  CollisionRun<B, Real> run_;
  Buffer<B, Index> id_;
  Buffer<B, std::uint8_t> material_;
  Buffer<B, Real> inv_mass_;
  ProblemAssembly<B, Real> assembly_;
  StepProblem<B, Real> step_;
  std::multimap<ContactName, NamedContact> names_;
};

template <class Real>
class GhostStepTest : public BackendTest<Real> {
 protected:
  using B = TestBackend;
  using World = WorldOfPart<Real>;
  using Vectors = std::vector<Vec3<Real>>;

  /// Spheres that do not turn about an axis have general contacts, also with those that do.
  static bool has_locks(ContactLayout layout) { return layout == ContactLayout::mixed; }
  static constexpr std::uint8_t kLockTurnX = 1 << 3;

  static Bed<Real> bed(ContactLayout layout, unsigned seed) {
    auto bed = bed_of_spheres<Real>(1200, 0.05, 0.1, seed);
    bed.settings.settings.layout = layout;
    bed.settings.gravity = {0, 0, -9.81};
    if (has_locks(layout))
      for (std::size_t i = 0; i < bed.free.size(); i += 5) bed.free[i].locks = kLockTurnX;
    bed.add_fixed = [layout](auto& s) {
      s.add_half_space({0, 0, 0}, {0, 0, 1});
      s.add({0.5, 0.5, 0.1}, 0.1);
      if (layout != ContactLayout::radial) s.angular_velocity.back() = {0, 0, 3};
    };
    return bed;
  }

  /// Spheres on a grid, with gaps that some close within the step: ghosts that keep their velocity
  /// do not jam those between them.
  static Bed<Real> grid(ContactLayout layout, unsigned seed) {
    constexpr double kRadius = 0.025, kSpacing = 0.0512;
    auto bed = bed_of_spheres<Real>(18 * 8 * 4, 2 * kRadius, 2 * kRadius, seed);
    bed.settings.settings.layout = layout;
    bed.settings.gravity = {0, 0, -9.81};
    for (std::size_t i = 0; i < bed.free.size(); ++i) {
      const Vec3<double> site(static_cast<double>(i % 18), static_cast<double>(i / 18 % 8),
                              static_cast<double>(i / 144));
      const Vec3<double> moved = bed.free[i].x - Vec3<double>{0.5, 0.5, 0.15};
      bed.free[i].x = kSpacing * site + 1e-3 * moved + Vec3<double>{0.03, 0.03, 0.027};
    }
    bed.divide();
    bed.add_fixed = [layout](auto& s) {
      s.add_half_space({0, 0, 0}, {0, 0, 1});
      s.add({0.4, 0.2, 0.027 + 3 * kSpacing + kRadius + 0.1}, 0.1);
      if (layout != ContactLayout::radial) s.angular_velocity.back() = {0, 0, 3};
    };
    return bed;
  }

  /// Calls test(layout) for what contacts may be.
  template <class Test>
  static void for_each_layout(Test&& test) {
    for (const ContactLayout layout : {ContactLayout::radial, ContactLayout::general,
                                       ContactLayout::rolling, ContactLayout::mixed}) {
      SCOPED_TRACE(static_cast<int>(layout));
      test(layout);
    }
  }

  static Real sign_of(const NamedContact& c, const NamedContact& in_whole) {
    return c.is_turned == in_whole.is_turned ? Real(1) : Real(-1);
  }
  static std::vector<Index> place_of_id(const Part<Real>& part, std::size_t ids) {
    std::vector<Index> place(ids, -1);
    for (std::size_t i = 0; i < part.id.size(); ++i)
      if (part.id[i] >= 0) place[static_cast<std::size_t>(part.id[i])] = static_cast<Index>(i);
    return place;
  }
  static std::array<Real, 4> numbers(const Quat<Real>& q) { return {q.w, q.x, q.y, q.z}; }
  static void expect_near(const Vec3<Real>& a, const Vec3<Real>& b, double tolerance) {
    EXPECT_LE(norm(Vec3<double>(a) - Vec3<double>(b)), tolerance * (1 + norm(Vec3<double>(b))));
  }
};
TYPED_TEST_SUITE(GhostStepTest, Reals);

/// N gamma + r of a bed is that of its halves, when ghosts get the velocities that their owners
/// found: one exchange of six numbers a body for each application.
TYPED_TEST(GhostStepTest, OperatorOfTwoHalves) {
  using Real = TypeParam;
  auto& b = this->backend();
  this->for_each_layout([&](ContactLayout layout) {
    const Bed<Real> bed = this->bed(layout, 3);
    WorldOfPart<Real> whole(b, bed.whole(), layout), left(b, bed.half(0, 0.2), layout),
        right(b, bed.half(1, 0.2), layout);
    WorldOfPart<Real>* world[3] = {&left, &right, &whole};
    std::vector<Twist<Real>> velocity[3];
    std::vector<Vec3<Real>> u[3], gamma[3];
    std::vector<ContactMetric<Real>> metric[3];
    double energy[3] = {};
    const int vectors = vectors_per_contact(layout);
    for (auto* w : world) w->assemble();
    ASSERT_GT(whole.names().size(), 1000u);

    // Impulses by the names of contacts.
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int k = 0; k < 3; ++k)
      gamma[k].resize(static_cast<std::size_t>(world[k]->problem().contact_count * vectors));
    for (const auto& [name, in_whole] : whole.names()) {
      for (int v = 0; v < vectors; ++v) {
        const Vec3<Real> g(0.01 * Vec3<double>{uniform(random), uniform(random), uniform(random)});
        for (int k = 0; k < 3; ++k) {
          const auto found = world[k]->names().find(name);
          if (found == world[k]->names().end()) continue;
          const NamedContact& c = found->second;
          gamma[k][static_cast<std::size_t>(c.index * vectors + v)] =
              this->sign_of(c, in_whole) * g;
        }
      }
    }

    with_rows<Real>(layout, [&](auto rows) {
      using R = decltype(rows);
      for (int k = 0; k < 3; ++k) {
        const ContactProblem<Real>& p = world[k]->problem();
        Buffer<TestBackend, Vec3<Real>> impulse(b);
        upload(b, gamma[k], impulse);
        Buffer<TestBackend, Twist<Real>> v(b, p.bodies.count);
        Buffer<TestBackend, Sums<1>> sum(b, 1);
        Buffer<TestBackend, ContactMetric<Real>> weights(b, p.contact_count);
        for_each(b, p.bodies.count, StartVelocity<Real>{p, v.view()});
        for_each(b, p.bodies.owned_count, BodyVelocity<R, Real>{p, impulse.view(), v.view()});
        reduce<Sums<1>>(b, p.bodies.owned_count, ImpulseEnergy<R, Real>{p, v.view()},
                        StoreResult<Sums<1>>{sum.data()});
        for_each(b, p.contact_count, StoreBlockMetric<R, Real>{p, weights.view()});
        energy[k] = fetch(b, sum.data()).value[0];
        velocity[k] = download(b, v.view());
        metric[k] = download(b, weights.view());
      }
      const auto in_whole = this->place_of_id(whole.part(), whole.part().id.size());
      for (int k = 0; k < 2; ++k) {
        const BodyRanges bodies = world[k]->problem().bodies;
        const auto place = this->place_of_id(world[1 - k]->part(), whole.part().id.size());
        ASSERT_GT(bodies.moving_count, bodies.owned_count + 100);
        for (Index i = 0; i < bodies.moving_count; ++i) {
          const auto at = static_cast<std::size_t>(i);
          const auto id = static_cast<std::size_t>(world[k]->part().id[at]);
          if (!bodies.is_owned(i))
            velocity[k][at] = velocity[1 - k][static_cast<std::size_t>(place[id])];
          const Twist<Real>& expected = velocity[2][static_cast<std::size_t>(in_whole[id])];
          this->expect_near(velocity[k][at].linear, expected.linear, this->tolerance(1e-13));
          this->expect_near(velocity[k][at].angular, expected.angular, this->tolerance(1e-13));
        }
      }
      for (int k = 0; k < 3; ++k) {
        const ContactProblem<Real>& p = world[k]->problem();
        Buffer<TestBackend, Twist<Real>> v(b);
        upload(b, velocity[k], v);
        Buffer<TestBackend, Vec3<Real>> out(b, static_cast<Offset>(gamma[k].size()));
        for_each(b, p.contact_count, ContactVelocity<R, Real>{p, v.view(), out.view()});
        u[k] = download(b, out.view());
      }
    });

    EXPECT_NEAR(energy[0] + energy[1], energy[2], this->tolerance(1e-12) * energy[2]);
    for (const auto& [name, in_whole] : whole.names()) {
      for (int k = 0; k < 2; ++k) {
        const auto found = world[k]->names().find(name);
        if (found == world[k]->names().end()) continue;
        const NamedContact& c = found->second;
        for (int v = 0; v < vectors; ++v) {
          const auto at = static_cast<std::size_t>(c.index * vectors + v);
          const auto whole_at = static_cast<std::size_t>(in_whole.index * vectors + v);
          this->expect_near(this->sign_of(c, in_whole) * u[k][at], u[2][whole_at],
                            this->tolerance(1e-11, 2e-4));
        }
        const auto& own = metric[k][static_cast<std::size_t>(c.index)];
        const auto& expected = metric[2][static_cast<std::size_t>(in_whole.index)];
        EXPECT_NEAR(own.normal, expected.normal, this->tolerance(1e-11, 1e-5) * expected.normal);
        EXPECT_NEAR(own.tangential, expected.tangential,
                    this->tolerance(1e-11, 1e-5) * expected.tangential);
      }
    }
  });
}

/// Before contacts act, a ghost has the velocity of the body that it is a copy of, bit by bit.
TYPED_TEST(GhostStepTest, VelocityBeforeContacts) {
  using Real = TypeParam;
  auto& b = this->backend();
  this->for_each_layout([&](ContactLayout layout) {
    const Bed<Real> bed = this->bed(layout, 4);
    WorldOfPart<Real> left(b, bed.half(0, 0.2), layout), right(b, bed.half(1, 0.2), layout);
    std::vector<Twist<Real>> velocity[2];
    for (auto* w : {&left, &right}) {
      const ContactProblem<Real>& p = w->assemble();
      Buffer<TestBackend, Twist<Real>> v(b, p.bodies.count);
      for_each(b, p.bodies.count, StartVelocity<Real>{p, v.view()});
      velocity[w == &right] = download(b, v.view());
    }
    const BodyRanges bodies = left.problem().bodies;
    const auto owner = this->place_of_id(right.part(), bed.free.size() + 2);
    for (Index i = bodies.owned_count; i < bodies.moving_count; ++i) {
      const Twist<Real>& ghost = velocity[0][static_cast<std::size_t>(i)];
      const auto id = static_cast<std::size_t>(left.part().id[static_cast<std::size_t>(i)]);
      const Twist<Real>& own = velocity[1][static_cast<std::size_t>(owner[id])];
      EXPECT_EQ(ghost.linear, own.linear);
      EXPECT_EQ(ghost.angular, own.angular);
      EXPECT_LT(ghost.linear.z, static_cast<Real>(bed.free[id].v.z));  // it falls
    }
  });
}

/// A solver moves owned bodies; ghosts keep their velocity, like bodies that nothing can push. As
/// such they are in a stored problem.
TYPED_TEST(GhostStepTest, SolversKeepGhostsAtTheirVelocity) {
  using Real = TypeParam;
  auto& b = this->backend();
  this->for_each_layout([&](ContactLayout layout) {
    const Bed<Real> bed = this->grid(layout, 5);
    WorldOfPart<Real> world(b, bed.half(0, 0.2), layout);
    const ContactProblem<Real>& assembled = world.assemble();
    const BodyRanges bodies = assembled.bodies;
    const Offset n = static_cast<Offset>(assembled.contact_count) * vectors_per_contact(layout);
    Buffer<TestBackend, Vec3<Real>> gamma(b, n);
    Buffer<TestBackend, Twist<Real>> start(b, bodies.count);
    Buffer<TestBackend, Index> mark(b, assembled.contact_count);
    for_each(b, bodies.count, StartVelocity<Real>{assembled, start.view()});
    const auto before = download(b, start.view());

    fill(b, gamma.view(), Vec3<Real>{});
    BodyProblem stored = download_any_problem<TestBackend, Real>(b, assembled, gamma.view(),
                                                                 world.part().id, world.bodies());
    stored.source.time_step = bed.settings.h;
    EXPECT_NO_THROW(validate(stored));
    EXPECT_EQ(stored.free_count, bodies.owned_count);
    EXPECT_EQ(stored.body_count(), bodies.present_count());
    UploadedProblem<TestBackend, Real> uploaded(b, stored);

    const double tolerance = std::is_same_v<Real, double> ? 1e-9 : 2e-5;
    for (const std::string& name : solver_names(TestBackend::kIsDevice)) {
      SCOPED_TRACE(name);
      const SolverParams params{.max_iterations = 20000, .check_every = 20};
      ContactProblem<Real> p = assembled;
      fill(b, gamma.view(), Vec3<Real>{});
      fill(b, mark.view(), Index(-1));
      const auto solver = make_solver<TestBackend, Real>(name, params);
      if (solver->keeps_marks()) p.mark = mark.view();
      const SolveStats stats = solver->solve(b, p, gamma.view(), tolerance);
      EXPECT_TRUE(stats.converged) << stats.residual.rms;
      const auto after = download(b, solver->velocity());
      Index pushed = 0;
      for (Index i = 0; i < bodies.count; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const bool is_same = after[at].linear == before[at].linear;
        if (bodies.is_owned(i)) {
          pushed += is_same ? 0 : 1;
        } else {
          EXPECT_TRUE(is_same && after[at].angular == before[at].angular) << i;
        }
      }
      EXPECT_GT(pushed, bodies.owned_count / 4);

      const auto impulse = download(b, gamma.view());
      const auto body_b = download(b, p.body_b);
      int by_ghosts = 0;
      for (std::size_t c = 0; c < body_b.size(); ++c) {
        const Vec3<Real> g = impulse[c * static_cast<std::size_t>(vectors_per_contact(layout))];
        if (!bodies.is_owned(body_b[c]) && bodies.moves(body_b[c]) && norm2(g) > 0) ++by_ghosts;
      }
      EXPECT_GT(by_ghosts, 5);

      fill(b, uploaded.impulses(), Vec3<Real>{});
      const auto again = make_solver<TestBackend, Real>(name, params);
      EXPECT_TRUE(again->solve(b, uploaded.problem(), uploaded.impulses(), tolerance).converged);
      const auto plain = download(b, again->velocity());
      double difference = 0, size = 0;
      for (Index i = 0; i < bodies.owned_count; ++i) {
        const auto at = static_cast<std::size_t>(i);
        difference += norm2(Vec3<double>(after[at].linear) - Vec3<double>(plain[at].linear));
        size += norm2(Vec3<double>(plain[at].linear));
      }
      EXPECT_LE(std::sqrt(difference / size), 1e3 * tolerance);
    }
  });
}

/// Integration moves owned bodies and counts their energy; not a bit of the others changes.
TYPED_TEST(GhostStepTest, IntegrationLeavesGhostsAlone) {
  using Real = TypeParam;
  auto& b = this->backend();
  this->for_each_layout([&](ContactLayout layout) {
    for (const bool has_box : {false, true}) {  // a box wall guards ways
      Bed<Real> bed = this->bed(layout, 6);
      if (has_box) {
        const auto others = bed.add_fixed;
        bed.add_fixed = [others](auto& s) {
          others(s);
          s.add_box_wall({0.5, 0.5, 0.6}, {0.1, 0.1, 0.1});
        };
      }
      double energy[3] = {};
      for (int k = 0; k < 3; ++k) {
        WorldOfPart<Real> world(b, k < 2 ? bed.half(k, 0.2) : bed.whole(), layout);
        world.assemble();
        BodyView<Real> bodies = world.bodies();
        const auto x = download(b, bodies.position);
        const auto v = download(b, bodies.velocity), w = download(b, bodies.angular_velocity);
        const auto q = download(b, bodies.orientation);
        std::vector<Twist<Real>> solved(x.size());
        double expected = 0;
        for (std::size_t i = 0; i < solved.size(); ++i) {
          const Index id = world.part().id[i];
          const Real r = world.part().scene.radius[i];
          const auto& locks = world.part().scene.locks;
          const bool turns = i >= locks.size() || locks[i] == 0;
          const bool has_length =
              layout == ContactLayout::radial || (layout == ContactLayout::mixed && turns);
          const Vec3<Real> spin{static_cast<Real>(id % 7), Real(1), Real(0)};
          solved[i] = {{Real(1), static_cast<Real>(id % 5), Real(0)}, has_length ? r * spin : spin};
          if (!bodies.is_owned(static_cast<Index>(i))) continue;
          const double m = world.mass(i);
          expected += 0.5 * m * norm2(Vec3<double>(solved[i].linear)) +
                      0.2 * m * r * r * norm2(Vec3<double>(spin));
        }
        Buffer<TestBackend, Twist<Real>> rates(b);
        upload(b, solved, rates);
        const WallView<Real> walls = world.run().detector().walls();
        EXPECT_EQ(walls.solids.size > 0, has_box);
        const IntegrateSums sums = Integration<TestBackend, Real>(b).run(
            b, bodies, rates.view(), layout, 1e-3, {}, walls, {}, bodies, {});
        EXPECT_NEAR(sums.kinetic_energy, expected, this->tolerance(1e-12, 1e-5) * expected);
        EXPECT_EQ(sums.bad_body, -1);
        energy[k] = sums.kinetic_energy;
        const auto x_after = download(b, bodies.position);
        const auto v_after = download(b, bodies.velocity);
        const auto w_after = download(b, bodies.angular_velocity);
        const auto q_after = download(b, bodies.orientation);
        for (std::size_t i = 0; i < x.size(); ++i) {
          if (bodies.is_owned(static_cast<Index>(i))) {
            EXPECT_NE(x_after[i], x[i]);
            EXPECT_EQ(v_after[i], solved[i].linear);
          } else {
            EXPECT_EQ(x_after[i], x[i]);
            EXPECT_EQ(v_after[i], v[i]);
            EXPECT_EQ(w_after[i], w[i]);
            EXPECT_EQ(this->numbers(q_after[i]), this->numbers(q[i]));
          }
        }
      }
      EXPECT_NEAR(energy[0] + energy[1], energy[2], this->tolerance(1e-12, 1e-5) * energy[2]);
    }
  });
}

}  // namespace
}  // namespace scree
