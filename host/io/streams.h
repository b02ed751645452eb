#pragma once
// The standard streams of the process, as a user may have left them: closed, a pipe whose reader is
// gone, a full disk.

#include <string_view>

namespace scree {

/// Makes failed writes errors that the program sees, not signals that end it: SIGPIPE and SIGXFSZ
/// are ignored. Standard streams that were closed are opened on /dev/null, so that no file of the
/// program gets their numbers and with them what is meant for a terminal; what goes to a closed
/// standard output fails. Call it first in main().
void prepare_streams() noexcept;

/// Writes a line to standard error. That it cannot be written is no reason to stop.
void say(std::string_view line) noexcept;

/// Writes out what standard output still holds.
/// @throws RunError when this, or a write before it, failed: the results are not complete
void finish_output();

}  // namespace scree
