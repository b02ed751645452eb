#pragma once
// A number or a choice that some solvers of steps take from a scene, beside what all of them take.

#include <array>
#include <map>
#include <span>
#include <string>

namespace scree {

/// Values of such parameters by key; one that is missing has its default.
using ParameterValues = std::map<std::string, double>;

struct SolverParameter {
  const char* key;          ///< in "solver" of a scene
  const char* description;  ///< one sentence, with the unit
  double standard = 0;      ///< the default
  double low = 0;           ///< range of a number, both ends excluded
  double high = 0;
  bool is_low_allowed = false;                ///< the lower end of the range is in it
  bool is_whole = false;                      ///< a whole number
  std::span<const char* const> choices = {};  ///< names of the values 0, 1, ...; empty: a number

  double of(const ParameterValues& values) const {
    const auto found = values.find(key);
    return found == values.end() ? standard : found->second;
  }
  bool allows(double value) const;
  bool takes_as(const SolverParameter& other) const;  ///< the same values, with the same default
  std::string text(double value) const;               ///< the value as messages show it
  std::string expected() const;                       ///< "must be ...", for messages
};

/// Parameter that several solvers have.
inline constexpr SolverParameter kRelaxation{.key = "relaxation",
                                             .description = "over-relaxation [-], below 2.",
                                             .standard = 1,
                                             .low = 0,
                                             .high = 2};
/// Of those that have no other.
inline constexpr std::array kRelaxationParameters{kRelaxation};

}  // namespace scree
