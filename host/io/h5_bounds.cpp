#include "host/io/h5_bounds.h"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace scree::h5 {
namespace {

constexpr std::uint64_t max_bytes = std::numeric_limits<std::uint64_t>::max();

std::uint64_t product(std::uint64_t a, std::uint64_t b) {
  return b != 0 && a > max_bytes / b ? max_bytes : a * b;
}

/// Called before HDF5 opens the file of an external link.
herr_t refuse_other_file(const char*, const char*, const char*, const char*, unsigned*, hid_t,
                         void*) {
  return -1;
}

/// The file that a link names, printable.
std::string file_of_link(hid_t group, const std::string& path, std::size_t length) {
  std::vector<char> value(length + 1, '\0');
  const char* file = nullptr;
  if (H5Lget_val(group, path.c_str(), value.data(), length, H5P_DEFAULT) < 0 ||
      H5Lunpack_elink_val(value.data(), length, nullptr, &file, nullptr) < 0)
    return "another file";
  return fmt::format("the file {:?}", file);
}

/// Bytes that the values of a dataset take as it declares them.
std::uint64_t declared_bytes(hid_t dataset) {
  const Handle space(H5Dget_space(dataset), H5Sclose);
  const Handle type(H5Dget_type(dataset), H5Tclose);
  std::uint64_t bytes = H5Tget_size(type.id());
  if (H5Sget_simple_extent_type(space.id()) == H5S_NULL) return 0;
  const int rank = H5Sget_simple_extent_ndims(space.id());
  if (rank <= 0) return bytes;
  std::vector<hsize_t> size(static_cast<std::size_t>(rank), 0);
  H5Sget_simple_extent_dims(space.id(), size.data(), nullptr);
  for (const hsize_t n : size) {
    if (n == 0) return 0;
    bytes = product(bytes, n);
  }
  return bytes;
}

}  // namespace

std::string Bounds::add(Handle::Id dataset, std::uint64_t bytes) {
  // Values that were never written take memory and no room in the file.
  const std::uint64_t stored = H5Dget_storage_size(dataset);
  if (stored > 0) bytes = std::min(bytes, stored);
  if (bytes > product(2, file_bytes) - bytes_read)
    return fmt::format("the arrays read so far are more than the {} bytes of the file, twice over",
                       file_bytes);
  bytes_read += bytes;
  return {};
}

Handle access_within_file(Handle::Id property_class) {
  Handle properties(H5Pcreate(property_class), H5Pclose);
  H5Pset_elink_cb(properties.id(), refuse_other_file, nullptr);
  return properties;
}

Search search(Handle::Id group, const std::string& path) {
  const Handle access = access_within_file(H5P_LINK_ACCESS);
  for (std::size_t end = 0; end != std::string::npos;) {
    end = path.find('/', end + 1);
    const std::string part = path.substr(0, end);
    if (H5Lexists(group, part.c_str(), access.id()) <= 0) return {};
    H5L_info_t link;
    if (H5Lget_info(group, part.c_str(), &link, access.id()) < 0) return {};
    if (link.type == H5L_TYPE_HARD) continue;
    if (link.type == H5L_TYPE_EXTERNAL)
      return {true, fmt::format("{} is an external link to {}, expected all data in this file",
                                part, file_of_link(group, part, link.u.val_size))};
    if (link.type != H5L_TYPE_SOFT)
      return {true, fmt::format("{} is a link of an unknown type, expected an object", part)};
    if (H5Oexists_by_name(group, part.c_str(), access.id()) <= 0)
      return {true,
              fmt::format("{} is a soft link that leads to nothing in this file, or around in a "
                          "circle",
                          part)};
  }
  return {true, {}};
}

std::string storage_fault(Handle::Id dataset, std::uint64_t file_bytes) {
  const Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  if (H5Pget_layout(properties.id()) == H5D_VIRTUAL)
    return "is a virtual dataset, made of others; expected all data in this file";
  if (H5Pget_external_count(properties.id()) > 0)
    return "is stored in other files (external storage), expected all data in this file";
  if (file_bytes == 0) return {};
  // Without being written, values are zeros: FCLIB's own files have such solutions.
  const std::uint64_t declared = declared_bytes(dataset);
  if (declared <= file_bytes) return {};
  const std::uint64_t stored = std::min<std::uint64_t>(H5Dget_storage_size(dataset), file_bytes);
  const bool packed = H5Pget_nfilters(properties.id()) > 0;
  if (packed && declared <= product(most_expansion, stored)) return {};
  return fmt::format("declares {} bytes of values, but the file of {} bytes stores {} of them{}",
                     declared, file_bytes, stored,
                     packed ? fmt::format(" and may expand them {} times", most_expansion) : "");
}

}  // namespace scree::h5
