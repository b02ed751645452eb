#include "host/cli/bench/bed_options.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "host/error.h"

namespace scree {
namespace {

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
