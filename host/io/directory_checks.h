#pragma once
// Whether a folder can be written to, before anything is.

#include <filesystem>
#include <string>

namespace scree {

/// What keeps files from being made in a folder, which is there or would be created with its
/// parents: "it is not a directory", "it cannot be created, ... is not a directory", and so on.
/// Empty when nothing does. Changes nothing.
std::string why_not_writable(const std::filesystem::path& folder);

/// What an error number of the system says.
std::string reason_of(int error_number);

}  // namespace scree
