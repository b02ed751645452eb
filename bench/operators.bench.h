// Both forms of the operator on one bed, in double: u = W gamma + q with W assembled, by the
// backend's product and by the element program, and matrix-free by bodies. The results must agree.

#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "bench/suite.h"
#include "host/problems/assembled_form.h"
#include "host/problems/download_problem.h"
#include "host/problems/matrix_form.h"
#include "kernels/contact/contact_operator.h"
#include "solvers/assembled/backend_problem.h"

namespace scree::bench {
namespace {

/// Spheres from which on W is not assembled: 13 blocks a contact, built on the host.
constexpr Index kMostAssembled = 100'000;

/// A bed with random impulses, matrix-free and with its velocities by that operator.
template <class B>
struct MatrixFreeBed {
  const BedProblem<B, double>& bed;
  Buffer<B, Vec3<double>> gamma, u;
  Buffer<B, Twist<double>> velocity;

  MatrixFreeBed(B& b, const BedProblem<B, double>& of)
      : bed(of),
        gamma(b, of.contact_count()),
        u(b, of.contact_count()),
        velocity(b, of.problem().bodies.count) {
    bed.random_impulses(b, 61, gamma.view());
    for_each(b, bed.problem().bodies.count, StartVelocity<double>{bed.problem(), velocity.view()});
  }
  void apply(B& b) {
    for_each(b, bed.owned_count(),
             BodyVelocity<RadialRows<double>, double>{
                 bed.problem(), std::as_const(gamma).view(gamma.capacity()), velocity.view()});
    for_each(b, bed.contact_count(),
             ContactVelocity<RadialRows<double>, double>{
                 bed.problem(), std::as_const(velocity).view(velocity.capacity()), u.view()});
  }
};

template <class B>
void run_matrix_free(Suite<B>& suite, benchmark::State& state, Index spheres) {
  B& b = suite.backend();
  const auto& bed = suite.template bed_problem<double>(spheres);
  MatrixFreeBed<B> at(b, bed);
  suite.poison(at.u.view());
  const Traffic traffic =
      body_velocity_traffic(sizeof(double)) + contact_velocity_traffic(sizeof(double));
  suite.measure(state, Suite<B>::contact_work(bed, traffic), [&] { at.apply(b); });
  Suite<B>::report_size(state, bed);
  suite.require_finite(state, std::as_const(at.u).view(bed.contact_count()));
}

/// @param by_program  the element program instead of the backend's own product
template <class B>
void run_assembled(Suite<B>& suite, benchmark::State& state, Index spheres, bool by_program) {
  B& b = suite.backend();
  const auto& bed = suite.template bed_problem<double>(spheres);
  MatrixFreeBed<B> reference(b, bed);
  reference.apply(b);
  const ContactProblem<double>& p = bed.problem();
  std::vector<Index> ids(static_cast<std::size_t>(p.bodies.count));
  std::iota(ids.begin(), ids.end(), 0);
  BodyProblem stored =
      download_problem<B, double>(b, p, std::as_const(reference.gamma).view(p.contact_count), ids);
  stored.source.time_step = BedProblem<B, double>::kTimeStep;
  const AssembledProblem problem = assembled_form(local_form(stored));

  const BlockProduct<B> product(b);
  const BackendProblem<B> assembled(b, product, problem);
  Buffer<B, double> x = assembled.vector(to_rows(stored, stored.impulse)), y = assembled.vector();
  const double contacts = p.contact_count, blocks = problem.block_count();
  Work work{contacts, "contact_iterations_per_s", 76 * blocks + 52 * contacts,
            100 * blocks + 28 * contacts};
  suite.measure(state, work, [&] {
    if (by_program) {
      for_each(b, p.contact_count, BlockRowProduct{assembled.rows(), x.view(), y.view()});
    } else {
      assembled.multiply(x, y);
    }
  });
  Suite<B>::report_size(state, bed);
  state.counters["blocks"] = blocks;

  std::vector<double> u = download(b, y.view());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] += problem.q[i];
  const std::vector<Vec3d> world = to_world(stored, u);
  const std::vector<Vec3d> expected = download(b, reference.u.view());
  double largest = 0, apart = 0;
  for (std::size_t c = 0; c < world.size(); ++c) {
    largest = std::max(largest, norm(expected[c]));
    apart = std::max(apart, norm(world[c] - expected[c]));
  }
  state.counters["difference"] = apart / largest;
  if (!(apart <= 1e-12 * largest)) state.SkipWithError("the operators differ");
}

}  // namespace

void add_operators(Suite<BenchBackend>& suite, Index spheres) {
  using S = Suite<BenchBackend>;
  suite.add("operator_matrix_free", "double", spheres,
            [spheres](S& s, benchmark::State& state) { run_matrix_free(s, state, spheres); });
  if (spheres > kMostAssembled) return;
  suite.add("operator_assembled", "double", spheres,
            [spheres](S& s, benchmark::State& state) { run_assembled(s, state, spheres, false); });
  if (BenchBackend::kIsDevice) {
    suite.add("operator_assembled_plain", "double", spheres,
              [spheres](S& s, benchmark::State& state) { run_assembled(s, state, spheres, true); });
  }
}

}  // namespace scree::bench
