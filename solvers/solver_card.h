#pragma once
// What a solver of steps says of itself. The record stands beside its class; scene check, schema,
// help, benchmarks and memory forecast read it, so that a solver is known everywhere by its own
// file and a line in the list of solvers/CMakeLists.txt.

#include <array>
#include <span>
#include <string>
#include <vector>

#include "kernels/contact/contact_fields.h"
#include "solvers/solver_parameter.h"
#include "solvers/traffic.h"

namespace scree {

/// What decides how much a solver holds and moves.
struct SolverCase {
  ContactLayout layout = ContactLayout::radial;
  double real = 4;         ///< size of a number [bytes]
  bool on_device = false;  ///< else on the CPU
  bool uniform = false;    ///< inverse masses come from the state of the bodies
  ParameterValues parameters = {};

  double vec() const { return 3 * real; }
  double twist() const { return 6 * real; }
  /// Bytes that a contact takes in arrays of its own.
  template <template <class> class Fields>
  double bytes_of(const ContactParts& parts) const {
    return real > 4 ? bytes_per_contact<Fields, double>(parts)
                    : bytes_per_contact<Fields, float>(parts);
  }
  double impulse() const { return vectors_per_contact(layout) * vec(); }
  bool is_radial() const { return layout == ContactLayout::radial; }
  bool is_mixed() const { return layout == ContactLayout::mixed; }
  bool has_groups() const { return is_mixed() || layout == ContactLayout::jointed; }
};

/// Bytes for each body and for each contact.
struct HeldBytes {
  double body = 0;
  double contact = 0;
  friend constexpr HeldBytes operator+(const HeldBytes& a, const HeldBytes& b) {
    return {a.body + b.body, a.contact + b.contact};
  }
};

inline constexpr std::array kAllLayouts{ContactLayout::radial, ContactLayout::general,
                                        ContactLayout::rolling, ContactLayout::mixed,
                                        ContactLayout::jointed};

/// Those of one group.
inline constexpr std::array kPlainLayouts{ContactLayout::radial, ContactLayout::general,
                                          ContactLayout::rolling};

/// Those without joints.
inline constexpr std::array kContactLayouts{ContactLayout::radial, ContactLayout::general,
                                            ContactLayout::rolling, ContactLayout::mixed};

struct SolverCard {
  const char* name;         ///< in scenes and on the command line: that of its file
  const char* description;  ///< what it is, in one line
  std::span<const SolverParameter> parameters = {};        ///< beside those that all solvers have
  std::span<const ContactLayout> layouts = kPlainLayouts;  ///< contacts that it knows
  /// Why it does not run on a device, and what does; null: it does.
  const char* cpu_only = nullptr;
  /// Takes all of ApgdLaw: exact friction begins with its own steps.
  bool steps_to_coulomb = false;
  bool over_ranks = false;   ///< solves problems that several ranks share
  bool keeps_marks = false;  ///< as Solver::keeps_marks(): 4 bytes a contact from step to step
  /// Velocities that it returns, and its working memory at the fullest.
  HeldBytes (*memory)(const SolverCase&);
  /// One application on spheres; null: not counted.
  Traffic (*traffic)(const SolverCase&) = nullptr;

  bool knows(ContactLayout layout) const;
  /// Why it does not run on a device; empty: it does.
  std::string device_fault() const;
};

/// The solvers that this program has, in the order of the list.
const std::vector<SolverCard>& solver_cards();

/// @throws InvalidParameter naming the known solvers when the name is none of them
const SolverCard& solver_card(const std::string& name);

/// Names of all solvers, or of those that run on a device.
std::vector<std::string> solver_names(bool on_device = false);

/// A parameter beside those that all solvers have, and the solvers that have it.
struct SharedParameter {
  SolverParameter parameter;
  std::vector<std::string> solvers;
};

/// The parameters of cards, each once.
/// @throws std::logic_error naming the key and two solvers when their parameters of that key differ
///         in what they take or in the default: one check is made of a value for all of them
std::vector<SharedParameter> shared_parameters(const std::vector<SolverCard>& cards);

/// Those of solver_cards().
const std::vector<SharedParameter>& solver_parameters();

}  // namespace scree
