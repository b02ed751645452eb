#pragma once
// Changes of HDF5 files that leave them whole for the library: foreign numbers, sizes, types and
// missing parts, which are this program's to find.

#include <filesystem>
#include <string_view>

namespace scree::fuzz {

/// Applies edits, six bytes each: which object or attribute of the root, what to do with it
/// (another value at a place, another number of values, another type, none), the place (two bytes),
/// the value, and how many. Any bytes are edits.
void edit_hdf5(const std::filesystem::path& file, std::string_view edits);

}  // namespace scree::fuzz
