#include "host/ranks/launch.h"

#include <charconv>
#include <cstdlib>
#include <optional>
#include <string_view>

namespace scree {
namespace {

std::optional<int> number(const char* variable) {
  const char* value = std::getenv(variable);
  if (value == nullptr) return std::nullopt;
  const std::string_view text = value;
  int out = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  if (error != std::errc{} || end != text.data() + text.size() || out < 0) return std::nullopt;
  return out;
}

struct Variables {
  const char* rank;
  const char* count;
};
// Open MPI; MPICH, its relatives and Slurm with PMI; Slurm with PMIx.
constexpr Variables kLaunchers[] = {{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
                                    {"PMI_RANK", "PMI_SIZE"},
                                    {"PMIX_RANK", "SLURM_STEP_NUM_TASKS"}};

}  // namespace

Launch launch_of_environment() {
  for (const Variables& variables : kLaunchers)
    if (const std::optional<int> rank = number(variables.rank))
      return {*rank, number(variables.count).value_or(0)};
  return {};
}

}  // namespace scree
