// Single passes over a bed: those of an APGD iteration, the residual, the lists,
// the cone projection.

#include <utility>

#include "bench/apgd_arrays.h"
#include "bench/suite.h"

namespace scree::bench {
namespace {

/// The three components of every linear part, then of every angular part.
template <class Real>
Span<Vec3<Real>> vectors_of(Span<Twist<Real>> twists) {
  static_assert(sizeof(Twist<Real>) == 2 * sizeof(Vec3<Real>));
  return {&twists.data->linear, 2 * twists.size};
}

template <class B, class Real>
void run_contact_pass(Suite<B>& suite, benchmark::State& state, Index spheres,
                      ApgdMetricKind kind) {
  B& b = suite.backend();
  const auto& bed = suite.template bed_problem<Real>(spheres);
  ApgdArrays<B, Real> arrays(b, bed, kind);
  arrays.scramble(b, bed);
  const Span<Vec3<Real>> next = arrays.gamma.next(0);  // also read, as the previous iterate
  // The count of accepted iterations stays zero, so every run reads and writes the same arrays.
  suite.measure(state, Suite<B>::contact_work(bed, apgd_contact_pass_traffic(sizeof(Real), kind)),
                [&] { arrays.contact_pass(b); });
  Suite<B>::report_size(state, bed);
  suite.require_finite(state, Span<const Vec3<Real>>(next));
}

template <class B, class Real>
void run_body_pass(Suite<B>& suite, benchmark::State& state, Index spheres) {
  B& b = suite.backend();
  const auto& bed = suite.template bed_problem<Real>(spheres);
  ApgdArrays<B, Real> arrays(b, bed, apgd_metric({}));
  arrays.scramble(b, bed);
  const Span<Twist<Real>> iterate = arrays.velocity.of_iterate[1].first(spheres);
  const Span<Twist<Real>> extrapolated = arrays.velocity.of_extrapolated.first(spheres);
  suite.poison(vectors_of(iterate));
  Buffer<B, Sums<1>> energy(b, 1);
  suite.measure(state, Suite<B>::contact_work(bed, apgd_body_pass_traffic(sizeof(Real))),
                [&] { arrays.body_pass(b, energy.view()); });
  Suite<B>::report_size(state, bed);
  suite.require_finite(state, Span<const Vec3<Real>>(vectors_of(iterate)));
  suite.require_finite(state, Span<const Vec3<Real>>(vectors_of(extrapolated)));
}

template <class B, class Real>
void run_residual_pass(Suite<B>& suite, benchmark::State& state, Index spheres) {
  B& b = suite.backend();
  const auto& bed = suite.template bed_problem<Real>(spheres);
  ApgdArrays<B, Real> arrays(b, bed, apgd_metric({}));
  arrays.scramble(b, bed);
  Buffer<B, ApgdCheck> check(b, 1);
  suite.measure(state, Suite<B>::contact_work(bed, residual_traffic(sizeof(Real))),
                [&] { arrays.residual_pass(b, check.data()); });
  Suite<B>::report_size(state, bed);
  const ResidualSums sums = fetch(b, check.data()).residual;
  if (sums.bad_contact >= 0 || sums.max_contact < 0) state.SkipWithError("wrong residual");
}

template <class B, class Real>
void run_body_velocity(Suite<B>& suite, benchmark::State& state, Index spheres) {
  B& b = suite.backend();
  const auto& bed = suite.template bed_problem<Real>(spheres);
  ApgdArrays<B, Real> arrays(b, bed, apgd_metric({}));
  arrays.scramble(b, bed);
  const Span<Twist<Real>> velocity = arrays.velocity.of_iterate[1].first(spheres);
  suite.poison(vectors_of(velocity));
  suite.measure(state, Suite<B>::contact_work(bed, body_velocity_traffic(sizeof(Real))), [&] {
    for_each(
        b, bed.owned_count(),
        BodyVelocity<RadialRows<Real>, Real>{bed.problem(), arrays.gamma.current(0), velocity});
  });
  Suite<B>::report_size(state, bed);
  suite.require_finite(state, Span<const Vec3<Real>>(vectors_of(velocity)));
}

template <class B>
void run_body_contacts(Suite<B>& suite, benchmark::State& state, Index spheres) {
  B& b = suite.backend();
  const auto& bed = suite.template bed_problem<float>(spheres);
  BodyContacts<B> lists(b);
  ContactProblem<float> p = bed.problem();
  suite.measure(state, Suite<B>::contact_work(bed, body_contacts_traffic()),
                [&] { lists.build(b, p); });
  Suite<B>::report_size(state, bed);
  if (fetch(b, p.a_start.data + p.bodies.owned_count) != p.contact_count)
    state.SkipWithError("wrong lists");
}

/// From one array to another, so that every run meets the same mix of points in
/// and out of the cone.
template <class Real>
struct ProjectToCone {
  static constexpr const char* name = "project_to_cone";
  ContactProblem<Real> p;
  Span<const Vec3<Real>> from;
  Span<Vec3<Real>> to;
  SCREE_HD void operator()(Index c) const {
    using R = RadialRows<Real>;
    R::store(to, c, R::project(p, c, R::load(from, c), euclidean_metric<Real>()));
  }
};

template <class B, class Real>
void run_cone_projection(Suite<B>& suite, benchmark::State& state, Index spheres) {
  B& b = suite.backend();
  const auto& bed = suite.template bed_problem<Real>(spheres);
  const Index n = bed.contact_count();
  Buffer<B, Vec3<Real>> from(b, n), to(b, n);
  bed.random_impulses(b, 41, from.view(n));
  suite.poison(to.view(n));
  suite.measure(state, Suite<B>::contact_work(bed, cone_projection_traffic(sizeof(Real))), [&] {
    for_each(b, n, ProjectToCone<Real>{bed.problem(), from.view(n), to.view(n)});
  });
  Suite<B>::report_size(state, bed);
  suite.require_finite(state, std::as_const(to).view(n));
}

template <class B, class Real>
void add_typed_passes(Suite<B>& suite, Index n) {
  using S = Suite<B>;
  using State = benchmark::State;
  for (const ApgdMetricKind kind : metric_kinds<Real>()) {
    suite.add("apgd_contact_pass", variant_name<Real>(kind), n,
              [n, kind](S& s, State& state) { run_contact_pass<B, Real>(s, state, n, kind); });
  }
  const std::string real = variant_name<Real>(apgd_metric({}));
  suite.add("apgd_body_pass", real, n,
            [n](S& s, State& state) { run_body_pass<B, Real>(s, state, n); });
  suite.add("residual_pass", real, n,
            [n](S& s, State& state) { run_residual_pass<B, Real>(s, state, n); });
  suite.add("body_velocity", real, n,
            [n](S& s, State& state) { run_body_velocity<B, Real>(s, state, n); });
  suite.add("cone_projection", real, n,
            [n](S& s, State& state) { run_cone_projection<B, Real>(s, state, n); });
}

}  // namespace

void add_contact_passes(Suite<BenchBackend>& suite, Index spheres) {
  add_typed_passes<BenchBackend, float>(suite, spheres);
  add_typed_passes<BenchBackend, double>(suite, spheres);
  suite.add("body_contacts_build", "ids", spheres,
            [spheres](Suite<BenchBackend>& s, benchmark::State& state) {
              run_body_contacts(s, state, spheres);
            });
}

}  // namespace scree::bench
