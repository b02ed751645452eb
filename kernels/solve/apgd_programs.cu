#include <stdexcept>

#include "kernels/solve/apgd_programs.h"
#include "kernels/solve/apgd_sweep.cuh"

namespace scree::apgd_sweep {
namespace {

[[noreturn]] void throw_no_program() { throw std::logic_error("APGD has no such program"); }

template <ContactLayout kLayout, Law kLaw>
const void* resident(bool has_own) {
  return has_own ? reinterpret_cast<const void*>(&run_resident_trials<kLayout, kLaw, true>)
                 : reinterpret_cast<const void*>(&run_resident_trials<kLayout, kLaw, false>);
}

template <ContactLayout kLayout>
const void* resident(Law law, bool has_own) {
  switch (law) {
    case Law::convex:
      return resident<kLayout, Law::convex>(has_own);
    case Law::coulomb:
      return resident<kLayout, Law::coulomb>(has_own);
    case Law::impact:
      if constexpr (kLayout != ContactLayout::general)
        return resident<kLayout, Law::impact>(has_own);
  }
  throw_no_program();
}

template <int kWeights, Law kLaw, bool kIsMixed, class Links = NoLinks>
const void* sweep() {
  return reinterpret_cast<const void*>(&run_trials<kWeights, kLaw, kIsMixed, Links, float>);
}

template <Law kLaw, bool kIsMixed>
const void* sweep(int weights) {
  switch (weights) {
    case 0:
      return sweep<0, kLaw, kIsMixed>();
    case 1:
      return sweep<1, kLaw, kIsMixed>();
    case 2:
      return sweep<2, kLaw, kIsMixed>();
    default:
      throw_no_program();
  }
}

template <bool kIsMixed>
const void* sweep(int weights, Law law) {
  switch (law) {
    case Law::convex:
      return sweep<Law::convex, kIsMixed>(weights);
    case Law::coulomb:
      return sweep<Law::coulomb, kIsMixed>(weights);
    case Law::impact:
      return sweep<Law::impact, kIsMixed>(weights);
  }
  throw_no_program();
}

template <bool kIsMixed>
const void* sweep_over_ranks(int weights) {
  if (weights == 1) return sweep<1, Law::convex, kIsMixed, GhostLinks>();
  if (weights == 2) return sweep<2, Law::convex, kIsMixed, GhostLinks>();
  throw_no_program();
}

}  // namespace

const void* resident_program(ContactLayout layout, Law law, bool has_own) {
  switch (layout) {
    case ContactLayout::radial:
      return resident<ContactLayout::radial>(law, has_own);
    case ContactLayout::mixed:
      return resident<ContactLayout::mixed>(law, has_own);
    case ContactLayout::general:
      return resident<ContactLayout::general>(law, has_own);
    default:
      throw_no_program();
  }
}

const void* sweep_program(int weights, Law law, bool is_mixed) {
  return is_mixed ? sweep<true>(weights, law) : sweep<false>(weights, law);
}

const void* sweep_program_over_ranks(int weights, bool is_mixed) {
  return is_mixed ? sweep_over_ranks<true>(weights) : sweep_over_ranks<false>(weights);
}

}  // namespace scree::apgd_sweep
