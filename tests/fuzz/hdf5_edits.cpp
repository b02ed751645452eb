#include "tests/fuzz/hdf5_edits.h"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "host/io/h5.h"

namespace scree::fuzz {
namespace {

using h5::Handle;

constexpr std::size_t edit_bytes = 6;
constexpr std::uint64_t most_values = 4096;

struct Edit {
  unsigned object, action, place, value, count;
};

double special(unsigned k) {
  using Limits = std::numeric_limits<double>;
  static constexpr std::array values{0.0,
                                     -0.0,
                                     1.0,
                                     -1.0,
                                     2.0,
                                     3.0,
                                     5.0,
                                     1e-3,
                                     -1e-3,
                                     1e-300,
                                     1e300,
                                     -1e300,
                                     1e30,
                                     -1e30,
                                     1e15,
                                     -2.0,
                                     -3.0,
                                     1e9,
                                     2147483647.0,
                                     -2147483648.0,
                                     4294967296.0,
                                     9.2e18,
                                     -9.2e18,
                                     Limits::quiet_NaN(),
                                     Limits::infinity(),
                                     -Limits::infinity(),
                                     0.5};
  return values[k % values.size()];
}

std::int64_t special_integer(unsigned k) {
  const double x = special(k);
  if (!(x > -9e18)) return std::numeric_limits<std::int64_t>::min();
  return x < 9e18 ? static_cast<std::int64_t>(x) : std::numeric_limits<std::int64_t>::max();
}

herr_t list_object(hid_t, const char* name, const H5L_info_t*, void* out) {
  static_cast<std::vector<std::string>*>(out)->emplace_back(name);
  return 0;
}

herr_t list_attribute(hid_t, const char* name, const H5A_info_t*, void* out) {
  static_cast<std::vector<std::string>*>(out)->emplace_back(name);
  return 0;
}

/// Values of a dataset or an attribute as bytes of its own native type.
struct Values {
  hid_t type = H5T_NATIVE_DOUBLE;
  std::vector<hsize_t> size;
  std::vector<std::uint64_t> bits;  ///< of doubles or 64-bit integers
  bool is_integer = false;

  std::uint64_t count() const {
    std::uint64_t n = 1;
    for (const hsize_t k : size) n *= k;
    return n;
  }
};

/// Writes one value into the bits.
void set(Values& v, std::size_t at, unsigned value) {
  if (v.is_integer) {
    v.bits[at] = static_cast<std::uint64_t>(special_integer(value));
  } else {
    const double x = special(value);
    static_assert(sizeof x == sizeof v.bits[at]);
    std::copy_n(reinterpret_cast<const char*>(&x), sizeof x, reinterpret_cast<char*>(&v.bits[at]));
  }
}

/// @return whether it holds numbers, and not too many
bool describe(Handle::Id type, Handle::Id space, Values& v) {
  const H5T_class_t kind = H5Tget_class(type);
  if (kind != H5T_INTEGER && kind != H5T_FLOAT) return false;
  v.is_integer = kind == H5T_INTEGER;
  v.type = v.is_integer ? H5T_NATIVE_INT64 : H5T_NATIVE_DOUBLE;
  v.size.resize(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space))));
  if (!v.size.empty()) H5Sget_simple_extent_dims(space, v.size.data(), nullptr);
  if (v.count() > most_values) return false;
  v.bits.resize(std::max<std::uint64_t>(1, v.count()));
  return true;
}

/// Changes numbers as an edit says. @return the type to store them with
hid_t change(Values& v, const Edit& e, hid_t stored) {
  switch (e.action % 4) {
    case 0:
      if (v.count() > 0) set(v, e.place % v.count(), e.value);
      return stored;
    case 1:
      if (v.size.empty()) v.size = {1};
      v.size[e.place % v.size.size()] = e.count % 40;
      v.bits.resize(std::max<std::uint64_t>(1, v.count()), v.bits.empty() ? 0 : v.bits.back());
      return stored;
    case 2: {
      const std::array types{H5T_NATIVE_INT8,  H5T_NATIVE_INT32,  H5T_NATIVE_INT64,
                             H5T_NATIVE_FLOAT, H5T_NATIVE_UINT64, H5T_NATIVE_DOUBLE};
      return types[e.value % types.size()];
    }
    default:
      for (std::size_t k = 0; k < v.count(); ++k) set(v, k, e.value);
      return stored;
  }
}

void edit_dataset(Handle::Id file, const std::string& name, const Edit& e) {
  if (e.action % 16 == 15) {
    H5Ldelete(file, name.c_str(), H5P_DEFAULT);
    return;
  }
  Values v;
  hid_t stored = -1;
  {
    const Handle dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (dataset.id() < 0) return;
    const Handle type(H5Dget_type(dataset.id()), H5Tclose);
    const Handle space(H5Dget_space(dataset.id()), H5Sclose);
    if (!describe(type.id(), space.id(), v)) return;
    H5Dread(dataset.id(), v.type, H5S_ALL, H5S_ALL, H5P_DEFAULT, v.bits.data());
    stored = H5Tcopy(type.id());
  }
  const Handle kept(stored, H5Tclose);
  const hid_t type = change(v, e, stored);
  H5Ldelete(file, name.c_str(), H5P_DEFAULT);
  const Handle space(
      v.size.empty() ? H5Screate(H5S_SCALAR)
                     : H5Screate_simple(static_cast<int>(v.size.size()), v.size.data(), nullptr),
      H5Sclose);
  const Handle dataset(
      H5Dcreate2(file, name.c_str(), type, space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose);
  if (v.count() > 0) H5Dwrite(dataset.id(), v.type, H5S_ALL, H5S_ALL, H5P_DEFAULT, v.bits.data());
}

void edit_attribute(Handle::Id file, const std::string& name, const Edit& e) {
  if (e.action % 16 == 15) {
    H5Adelete(file, name.c_str());
    return;
  }
  const Handle attribute(H5Aopen(file, name.c_str(), H5P_DEFAULT), H5Aclose);
  const Handle type(H5Aget_type(attribute.id()), H5Tclose);
  const Handle space(H5Aget_space(attribute.id()), H5Sclose);
  Values v;
  if (!describe(type.id(), space.id(), v)) return;
  set(v, 0, e.value);
  H5Awrite(attribute.id(), v.type, v.bits.data());
}

}  // namespace

void edit_hdf5(const std::filesystem::path& path, std::string_view edits) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  for (; edits.size() >= edit_bytes; edits.remove_prefix(edit_bytes)) {
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(edits[k]); };
    const Edit e{byte(0), byte(1), byte(2) * 256u + byte(3), byte(4), byte(5)};
    std::vector<std::string> objects, attributes;
    H5Lvisit_by_name(file.id(), "/", H5_INDEX_NAME, H5_ITER_INC, list_object, &objects,
                     H5P_DEFAULT);
    H5Aiterate2(file.id(), H5_INDEX_NAME, H5_ITER_INC, nullptr, list_attribute, &attributes);
    if (objects.empty()) return;
    const std::size_t which = e.object % (objects.size() + attributes.size());
    if (which < objects.size()) {
      edit_dataset(file.id(), objects[which], e);
    } else {
      edit_attribute(file.id(), attributes[which - objects.size()], e);
    }
  }
}

}  // namespace scree::fuzz
