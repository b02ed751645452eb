#pragma once
// Text of unknown origin in messages.

#include <cstddef>
#include <string>
#include <string_view>

namespace scree {

/// The text with control characters written as \xNN, so that it cannot steer a terminal, and cut
/// where it is long.
/// @param most  bytes that are kept
std::string printable(std::string_view text, std::size_t most);

}  // namespace scree
