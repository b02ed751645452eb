#pragma once
// What is left of a run that one of its ranks ends.

#include <functional>
#include <string>
#include <utility>

#include "host/ranks/mpi_ranks.h"

namespace scree {

/// While one exists, run.json gets to know why this rank alone ends all.
class AbortRecord {
 public:
  /// @param ranks  or null
  AbortRecord(Ranks* ranks, std::function<void(const std::string& text)> write) : ranks_(ranks) {
    if (ranks_ != nullptr) set_before_abort(*ranks_, std::move(write));
  }
  ~AbortRecord() {
    if (ranks_ != nullptr) set_before_abort(*ranks_, {});
  }
  AbortRecord(const AbortRecord&) = delete;
  AbortRecord& operator=(const AbortRecord&) = delete;

 private:
  Ranks* ranks_;
};

}  // namespace scree
