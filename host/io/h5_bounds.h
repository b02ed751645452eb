#pragma once
// What keeps reading within one file and its size: HDF5 files may name other files as the place
// of their data, and declare arrays that they do not hold. Functions on HDF5's identifiers;
// they hold no lock.

#include <cstdint>
#include <string>

#include "host/io/h5.h"

namespace scree::h5 {

/// How many times the bytes that a file stores its arrays may have [-]: what deflate, the strongest
/// of the common filters, can reach.
inline constexpr std::uint64_t most_expansion = 1100;

/// What was read from a file so far, against its size: one array under many names
/// is read many times.
struct Bounds {
  std::uint64_t file_bytes = 0;
  std::uint64_t bytes_read = 0;

  /// Counts so many bytes of a dataset, about to be read, as they are stored.
  /// @return what is wrong, or nothing
  std::string add(Handle::Id dataset, std::uint64_t bytes);
};

/// Access properties with which no link leaves the file, for a class such as H5P_GROUP_ACCESS.
Handle access_within_file(Handle::Id property_class);

/// Where a path of links ends.
struct Search {
  bool found = false;
  std::string fault;  ///< a link that leads out of the file or nowhere; empty: none
};

/// Follows a path from a group, link by link.
Search search(Handle::Id group, const std::string& path);

/// What is wrong with the place of a dataset's values, or nothing.
/// @param file_bytes  of the file; 0: declared sizes are not compared with it
std::string storage_fault(Handle::Id dataset, std::uint64_t file_bytes);

}  // namespace scree::h5
