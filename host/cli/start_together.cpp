#include "host/cli/start_together.h"

#include <fmt/format.h>

#include <exception>
#include <memory>
#include <new>

#include "host/cli/command_line.h"
#include "host/error.h"
#include "host/ranks/launch.h"
#include "host/ranks/mpi_ranks.h"
#include "host/version.h"

namespace scree {

int start_together(Ranks& ranks, const std::function<void(RankReport& report)>& prepare) {
  RankReport own;
  own.program = fmt::format("{} ({})", version(), commit());
  const auto failed = [&](int code, const char* error) {
    own.code = code;
    own.error = error;
  };
  try {
    prepare(own);
  } catch (const InputError& error) {
    failed(2, error.what());
  } catch (const std::bad_alloc&) {
    failed(1, "host memory exhausted");
  } catch (const std::exception& error) {
    failed(1, error.what());
  }
  const Agreement agreement = agree(ranks, own);
  if (agreement.code == 0) return 0;
  if (ranks.rank() == 0) fail(agreement.message, agreement.code);
  any(ranks, true);  // it is said before a rank ends: a launcher may end the others then
  return agreement.code;
}

int fail_together(const std::string& what) {
  std::shared_ptr<Ranks> ranks;
  try {
    ranks = mpi_ranks();
  } catch (const std::exception&) {
    // The command line is what to tell.
  }
  if (ranks != nullptr) return start_together(*ranks, [&](RankReport&) { throw InputError(what); });
  return launch_of_environment().rank > 0 ? 0 : fail(what, 2);
}

}  // namespace scree
