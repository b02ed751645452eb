#include "dynamics/ranks/shareable.h"

#include <algorithm>
#include <string>

#include "host/error.h"
#include "shapes/compound.h"
#include "solvers/solver_card.h"

namespace scree {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw InputError(what + " on one rank only"); }

bool has_compounds(const std::vector<BodyDescription>& bodies,
                   const std::vector<ParticleSet>& sets) {
  for (const BodyDescription& body : bodies)
    if (body.shape.kind == shapes::Compound::kind) return true;
  for (const ParticleSet& set : sets)
    for (std::size_t i = 0; i < (set.shape.uniform() ? 1 : set.position.size()); ++i)
      if (set.shape[i].kind == shapes::Compound::kind) return true;
  return false;
}

bool has_compounds(const Scene& scene) {
  return has_compounds(scene.bodies, scene.particles) ||
         std::any_of(scene.insertions.begin(), scene.insertions.end(),
                     [](const Insertion& insertion) {
                       return has_compounds(insertion.bodies, insertion.particles);
                     });
}

}  // namespace

void require_shareable(const Scene& scene) {
  if (has_compounds(scene)) refuse("compounds are simulated");
  const SolverCard& solver = solver_card(scene.solver.name);
  if (!solver.over_ranks) {
    std::string known;
    for (const SolverCard& card : solver_cards())
      if (card.over_ranks) known += (known.empty() ? "\"" : ", \"") + std::string(card.name) + '"';
    throw InputError("solver.name \"" + scene.solver.name + "\" runs on one rank only; " + known +
                     " run on several");
  }
}

void throw_not_over_ranks(const char* call) {
  throw InputError(std::string(call) + " is for a World of one rank");
}

}  // namespace scree
