#pragma once
// What a run of rigid bodies needs to go on bit for bit: bodies, contacts, memory of the solver.

#include "collision/contact_detector.h"
#include "dynamics/rigid/body_store.h"
#include "host/world.h"
#include "solvers/solver.h"

namespace scree {

template <class B, class Real>
void save_state(B& b, BodyStore<B, Real>& store, const ContactDetector<B, Real>& detector,
                const Solver<B, Real>& solver, WorldState& s) {
  detector.save(b, s.contact_key, s.contact_impulse);  // first: needs room to convert
  store.save_free(s);
  s.solver_memory = solver.memory();
  const std::vector<Index> marks = detector.save_marks(b);
  s.solver_memory.insert(s.solver_memory.end(), marks.begin(), marks.end());
}

/// @param memory  of the solver, then what it left at each contact; the latter is missing in a
///                checkpoint written with another solver
template <class B, class Real>
void restore_solver(B& b, std::vector<double> memory, std::size_t contact_count,
                    ContactDetector<B, Real>& detector, Solver<B, Real>& solver) {
  if (solver.keeps_marks() && memory.size() >= contact_count) {
    const auto is_mark = [](double value) { return value >= 0 && value < 1 << 30; };
    const std::size_t own = memory.size() - contact_count;
    std::vector<Index> marks(contact_count);
    for (std::size_t c = 0; c < contact_count; ++c)
      marks[c] = is_mark(memory[own + c]) ? static_cast<Index>(memory[own + c]) : -1;
    detector.restore_marks(b, marks);
    memory.resize(own);
  }
  solver.restore_memory(memory);
}

/// @param vectors  of an impulse  @throws InputError when the state is not one of these bodies
template <class B, class Real>
void restore_state(B& b, const WorldState& s, int vectors, BodyStore<B, Real>& store,
                   ContactDetector<B, Real>& detector, Solver<B, Real>& solver) {
  const auto n = static_cast<std::size_t>(store.free_count());
  if (s.id.size() != n) throw_wrong_body_count(s.id.size(), n);
  require_contacts(s, vectors, n);
  store.arrange(s.id);
  store.restore_free(s);
  detector.restore(b, s.contact_key, s.contact_impulse);
  restore_solver(b, s.solver_memory, s.contact_key.size(), detector, solver);
}

}  // namespace scree
