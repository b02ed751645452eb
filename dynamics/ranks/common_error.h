#pragma once
// Errors that all ranks have.

#include <new>
#include <string>

#include "host/error.h"
#include "kernels/backend/ranks.h"

namespace scree {

/// A run that cannot go on, on every rank and for the same reason: they all got here, and may say so together.
class CommonError : public RunError {
 public:
  using RunError::RunError;
};

/// When any rank failed, throws on all of them the message of the lowest that did.
/// @param ranks  null: there are none  @param fail  throws a std::exception
/// @throws CommonError
template <class F>
void throw_on_all(Ranks* ranks, bool has_failed, F&& fail) {
  if (ranks == nullptr) {
    if (has_failed) fail();
    return;
  }
  if (!any(*ranks, has_failed)) return;
  std::string message;
  try {
    if (has_failed) fail();
  } catch (const std::exception& error) {
    message = error.what();
  }
  for (const std::string& text : gather_texts(*ranks, message))
    if (!text.empty()) throw CommonError(text);
}

/// Calls work() on all ranks, none of which waits in it for another. When it fails on any, throws on all of them what
/// the lowest has to say. @param ranks  null: there are none  @throws CommonError
template <class F>
void on_all_ranks(Ranks* ranks, F&& work) {
  if (ranks == nullptr) return work();
  std::string fault;
  try {
    work();
  } catch (const std::bad_alloc&) {
    fault = "host memory exhausted";
  } catch (const std::exception& error) {
    fault = error.what();
  }
  throw_on_all(ranks, !fault.empty(), [&] { throw RunError(fault); });
}

}  // namespace scree
