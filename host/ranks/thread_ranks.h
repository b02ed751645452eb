#pragma once
// Ranks that are threads of one process: for tests, and for programs that give each device a thread.

#include <functional>
#include <memory>
#include <stdexcept>

#include "kernels/backend/ranks.h"

namespace scree {

/// What the other ranks get when one ended all of them.
class RankAborted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Runs `body` on `count` threads, each with its rank, and waits for all. An exception of one ends the others at their next
/// call; the one that came first is thrown again here.
void run_thread_ranks(int count, const std::function<void(const std::shared_ptr<Ranks>&)>& body);

}  // namespace scree
