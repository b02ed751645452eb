#pragma once
// A seal in front of an HDF5 file: what it is, how long it is, and a checksum of all the rest.
//
// HDF5 trusts what it reads: a damaged file can crash the library, and damaged numbers pass
// unnoticed. The seal is checked first, so that only whole files are given to the library. It
// lies in the user block, which HDF5 leaves to programs; other readers of HDF5 do not notice it.

#include <cstdint>
#include <filesystem>
#include <string>

namespace scree {

/// Size of the user block that a file to be sealed must be created with [bytes].
inline constexpr std::uint64_t seal_bytes = 512;

/// Writes the seal of a finished file. @throws RunError naming the file and the reason
void write_seal(const std::filesystem::path& path, const std::string& kind, int version);

/// Whether the file begins with the seal of a kind; whether it is whole is for check_seal to say.
bool has_seal(const std::filesystem::path& path, const std::string& kind);

/// What is wrong with the file, as half a sentence; empty when it is whole, of that kind and of
/// that version, or of an earlier one from `first_version` on when that is given.
std::string check_seal(const std::filesystem::path& path, const std::string& kind, int version,
                       int first_version = 0);

}  // namespace scree
