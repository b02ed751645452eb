#pragma once
// Doing first in a child process what may crash: HDF5 trusts the files that it reads.

#include <functional>
#include <string>

namespace scree {

/// Runs f in a child process, whose results and messages are lost. Exceptions of f are no failure.
/// It is no sandbox: the child may do whatever this process may.
/// @param seconds  of processor time that it may take
/// @return how the child ended, as "it crashes (signal 11)", when it did not come back from f;
///         empty when it did, and where no child can be had
std::string trial(const std::function<void()>& f, unsigned seconds);

}  // namespace scree
