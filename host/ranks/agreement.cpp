#include "host/ranks/agreement.h"

#include <algorithm>

#include "host/io/checksum.h"

namespace scree {
namespace {

constexpr int kBadInput = 2;

/// The first rank that has another value than rank 0; 0: none.
template <class T>
std::size_t first_other(const std::vector<T>& values) {
  const auto other = std::find_if(values.begin(), values.end(),
                                  [&](const T& value) { return value != values.front(); });
  return other == values.end() ? 0 : static_cast<std::size_t>(other - values.begin());
}

std::string named(std::size_t rank) { return "rank " + std::to_string(rank); }

/// What the ranks have told, in their order.
struct Reports {
  std::vector<int> codes;
  std::vector<std::uint64_t> scenes;  ///< checksums
  std::vector<std::string> errors, programs, arithmetic, folders;
};

Agreement agreement_of(const Reports& all) {
  // Errors may come of another version, so it is what to tell.
  if (const std::size_t r = first_other(all.programs); r > 0)
    return {kBadInput, named(r) + " has another version of scree: " + all.programs[r] +
                           ", rank 0 has " + all.programs[0]};
  const auto failed =
      std::find_if(all.codes.begin(), all.codes.end(), [](int code) { return code != 0; });
  if (failed != all.codes.end()) {
    const auto r = static_cast<std::size_t>(failed - all.codes.begin());
    const bool is_everywhere =
        *failed == all.codes.front() && first_other(all.codes) == 0 && first_other(all.errors) == 0;
    return {*failed, is_everywhere ? all.errors[r] : named(r) + ": " + all.errors[r]};
  }
  if (const std::size_t r = first_other(all.scenes); r > 0)
    return {kBadInput, named(r) + " has another scene than rank 0"};
  if (const std::size_t r = first_other(all.arithmetic); r > 0)
    return {kBadInput, named(r) + " would compute with " + all.arithmetic[r] + ", rank 0 with " +
                           all.arithmetic[0]};
  if (const std::size_t r = first_other(all.folders); r > 0)
    return {kBadInput,
            named(r) + " would write to " + all.folders[r] + ", rank 0 to " + all.folders[0]};
  return {};
}

}  // namespace

Agreement agree(Ranks& ranks, const RankReport& own) {
  Checksum scene;
  scene.add(own.scene);
  Reports all;
  all.programs = gather_texts(ranks, own.program);
  all.codes = gather(ranks, own.code);
  all.errors = gather_texts(ranks, own.error);
  all.scenes = gather(ranks, scene.value());
  all.arithmetic = gather_texts(ranks, own.arithmetic);
  all.folders = gather_texts(ranks, own.folder);
  return agreement_of(all);
}

}  // namespace scree
