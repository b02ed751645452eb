#include "host/cli/bench/bed_options.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "host/error.h"

namespace scree {
namespace {

constexpr int kMostSteps = 1'000'000;

/// The number a text holds, or NaN.
double number_of(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end ? value : std::nan("");
}

[[noreturn]] void refuse(const char* option, const std::string& text, const std::string& expected) {
  throw InputError(fmt::format("{}: \"{}\" is not allowed: expected {}", option, text, expected));
}

}  // namespace

void add_bed_options(CLI::App& command, BedOptions& options) {
  RunTarget& target = options.target;
  target.backend = "auto";
  target.precision = "float";
  add_backend_options(command, target, "auto", "float");
  command.add_option("--sizes", options.sizes, "numbers of bodies, such as 1e5,1e6")
      ->delimiter(',')
      ->type_name("N,...");
  command.add_option("--layers", options.layers, "height of the bed in layers of spheres")
      ->delimiter(',')
      ->type_name("N");
  command.add_option("--warmup", options.warmup, "steps before measuring (default: until settled)")
      ->check(CLI::Range(0, kMostSteps))
      ->take_last();
  command.add_option("--json", options.json, "write the results to this file")
      ->type_name("FILE")
      ->take_last();
}

void add_steps_options(CLI::App& command, BedOptions& options) {
  command.add_option("--steps", options.steps, "steps measured")
      ->check(CLI::Range(1, kMostSteps))
      ->take_last();
}

void add_sizes_option(CLI::App& command, BedOptions& options) {
  command.add_flag("--polydisperse", options.polydisperse, "diameters from 1 to 10");
}

std::vector<int> whole_numbers(const char* option, const std::vector<std::string>& texts,
                               int largest, const char* what) {
  std::vector<int> numbers;
  for (const std::string& text : texts) {
    const double value = number_of(text);
    if (!(value >= 1 && value <= largest) || value != std::floor(value))
      refuse(option, text, fmt::format("{} from 1 to {}", what, largest));
    numbers.push_back(static_cast<int>(value));
  }
  return numbers;
}

std::vector<double> positive_numbers(const char* option, const std::vector<std::string>& texts,
                                     const char* what) {
  std::vector<double> numbers;
  for (const std::string& text : texts) {
    const double value = number_of(text);
    if (!(value > 0) || !std::isfinite(value))
      refuse(option, text, fmt::format("{}, positive", what));
    numbers.push_back(value);
  }
  return numbers;
}

}  // namespace scree
