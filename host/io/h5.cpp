#include "host/io/h5.h"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <limits>
#include <mutex>
#include <string_view>
#include <type_traits>
#include <utility>

#include "host/io/h5_bounds.h"

namespace scree::h5 {
namespace {

static_assert(std::is_same_v<hid_t, Handle::Id>, "HDF5 1.10 or newer has 64-bit identifiers");

// Holds the library for one call and keeps it from printing its error stack.
class Guard {
 public:
  Guard() : lock_(mutex()) {
    // Handles close themselves. Its own clean-up at exit would only complain, in letters of its
    // own, about files it could not write or that are damaged.
    [[maybe_unused]] static const herr_t once = H5dont_atexit();
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Guard() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;

 private:
  static std::recursive_mutex& mutex() {
    static std::recursive_mutex instance;
    return instance;
  }
  std::lock_guard<std::recursive_mutex> lock_;
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

herr_t take_first(unsigned n, const H5E_error2_t* entry, void* out) {
  if (n == 0 && entry->desc != nullptr) *static_cast<std::string*>(out) = entry->desc;
  return 0;
}

// The innermost entry of the error stack; of a failed system call only the system's message.
std::string last_reason() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_first, &text);
  H5Eclear2(H5E_DEFAULT);
  constexpr std::string_view key = "error message = '";
  const std::size_t begin = text.find(key);
  if (begin == std::string::npos) return text.empty() ? "HDF5 gave no reason" : text;
  const std::size_t end = text.find('\'', begin + key.size());
  std::string reason = text.substr(begin + key.size(), end - begin - key.size());
  if (text.find("errno = 28,") != std::string::npos) reason += " (the disk is full)";
  return reason;
}

hid_t native(Type type) {
  switch (type) {
    case Type::float64:
      return H5T_NATIVE_DOUBLE;
    case Type::float32:
      return H5T_NATIVE_FLOAT;
    case Type::int64:
      return H5T_NATIVE_INT64;
    case Type::int32:
      return H5T_NATIVE_INT32;
    case Type::uint64:
      return H5T_NATIVE_UINT64;
    case Type::uint8:
      return H5T_NATIVE_UINT8;
  }
  return H5I_INVALID_HID;
}

const char* name_of(Type type) {
  switch (type) {
    case Type::float64:
      return "64-bit float";
    case Type::float32:
      return "32-bit float";
    case Type::int64:
      return "64-bit integer";
    case Type::int32:
      return "32-bit integer";
    case Type::uint64:
      return "64-bit unsigned integer";
    case Type::uint8:
      return "8-bit unsigned integer";
  }
  return "unknown";
}

// Same class, size and sign; the byte order may differ, the library converts it exactly.
bool is_type(hid_t stored, Type type) {
  const hid_t wanted = native(type);
  if (H5Tget_class(stored) != H5Tget_class(wanted)) return false;
  if (H5Tget_size(stored) != H5Tget_size(wanted)) return false;
  return H5Tget_class(wanted) != H5T_INTEGER || H5Tget_sign(stored) == H5Tget_sign(wanted);
}

Handle space_of(Shape shape, bool growing = false) {
  const std::array<hsize_t, 2> size{shape.rows, shape.columns};
  const std::array<hsize_t, 2> most{growing ? H5S_UNLIMITED : shape.rows, shape.columns};
  return {H5Screate_simple(shape.columns == 0 ? 1 : 2, size.data(), most.data()), H5Sclose};
}

// Selects rows [first, first + count) of the file's dataspace.
bool select_rows(hid_t space, Shape shape, std::uint64_t first, std::uint64_t count) {
  const std::array<hsize_t, 2> start{first, 0};
  const std::array<hsize_t, 2> size{count, shape.values_per_row()};
  return H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr) >=
         0;
}

// Shape of a dataset; false when it has no such shape.
bool get_shape(hid_t dataset, Shape* shape) {
  const Handle space(H5Dget_space(dataset), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space.id());
  if (rank < 1 || rank > 2) return false;
  std::array<hsize_t, 2> size{0, 0};
  if (H5Sget_simple_extent_dims(space.id(), size.data(), nullptr) < 0) return false;
  if (rank == 2 && size[1] > 0 && size[0] > std::numeric_limits<hsize_t>::max() / size[1])
    return false;
  *shape = {size[0], rank == 2 ? size[1] : 0};
  return true;
}

Handle text_type(std::size_t length, H5T_cset_t character_set) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), std::max<std::size_t>(length, 1));
  H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
  H5Tset_cset(type.id(), character_set);
  return type;
}

void strip_padding(std::string* text) {
  while (!text->empty() && text->back() == '\0') text->pop_back();
}

}  // namespace

Handle::Handle(Handle&& other) noexcept : id_(other.release()), close_(other.close_) {}

Handle& Handle::operator=(Handle&& other) noexcept {
  if (this != &other) {
    reset();
    close_ = other.close_;
    id_ = other.release();
  }
  return *this;
}

void Handle::reset() noexcept {
  if (id_ < 0) return;
  const Guard guard;
  close_(release());
}

Handle::Id Handle::release() noexcept { return std::exchange(id_, -1); }

Group::Group(Handle handle, std::string file, std::string path, std::shared_ptr<Bounds> bounds)
    : handle_(std::move(handle)),
      file_(std::move(file)),
      path_(std::move(path)),
      bounds_(std::move(bounds)) {}

void Group::fail(const std::string& name, const std::string& what) const {
  const std::string reason = what.empty() ? last_reason() : what;
  throw Error(fmt::format("{}: {}/{}: {}", file_, path_, name, reason));
}

void Group::fail_attribute(const std::string& name, const std::string& what) const {
  const std::string reason = what.empty() ? last_reason() : what;
  const std::string of = path_.empty() ? "" : " of " + path_;
  throw Error(fmt::format("{}: attribute {}{}: {}", file_, name, of, reason));
}

Shape Group::shape_for(const std::string& name, std::uint64_t count, std::uint64_t columns) const {
  if (columns == 0) return {count, 0};
  if (count % columns != 0) fail(name, fmt::format("{} values are no rows of {}", count, columns));
  return {count / columns, columns};
}

Group Group::create_group(const std::string& name) {
  const Guard guard;
  Handle group(H5Gcreate2(handle_.id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
               H5Gclose);
  if (group.id() < 0) fail(name, "");
  return {std::move(group), file_, path_ + "/" + name, bounds_};
}

Group Group::open_group(const std::string& name) const {
  const Guard guard;
  if (!has(name)) fail(name, "no such group");
  const Handle access = access_within_file(H5P_GROUP_ACCESS);
  Handle group(H5Gopen2(handle_.id(), name.c_str(), access.id()), H5Gclose);
  if (group.id() < 0) fail(name, "");
  return {std::move(group), file_, path_ + "/" + name, bounds_};
}

bool Group::has(const std::string& name) const {
  const Guard guard;
  const Search result = search(handle_.id(), name);
  if (!result.fault.empty()) fail(name, result.fault);
  return result.found;
}

Handle Group::open_array(const std::string& name) const {
  if (!has(name)) fail(name, "no such dataset");
  const Handle access = access_within_file(H5P_DATASET_ACCESS);
  Handle dataset(H5Dopen2(handle_.id(), name.c_str(), access.id()), H5Dclose);
  if (dataset.id() < 0) fail(name, "");
  const std::string fault = storage_fault(dataset.id(), bounds_ ? bounds_->file_bytes : 0);
  if (!fault.empty()) fail(name, fault);
  return dataset;
}

void Group::count_bytes(const std::string& name, const Handle& dataset, std::uint64_t bytes) const {
  const std::string fault = bounds_ ? bounds_->add(dataset.id(), bytes) : "";
  if (!fault.empty()) fail(name, fault);
}

void Group::write_array(const std::string& name, Type type, const void* values, Shape shape) {
  const Guard guard;
  const Handle space = space_of(shape);
  const Handle dataset(H5Dcreate2(handle_.id(), name.c_str(), native(type), space.id(), H5P_DEFAULT,
                                  H5P_DEFAULT, H5P_DEFAULT),
                       H5Dclose);
  if (dataset.id() < 0) fail(name, "");
  if (shape.value_count() == 0) return;
  if (H5Dwrite(dataset.id(), native(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
    fail(name, "");
}

void Group::write_virtual_array(const std::string& name, Type type,
                                std::span<const RowsElsewhere> rows, std::uint64_t columns) {
  const Guard guard;
  Shape all{0, columns};
  for (const RowsElsewhere& part : rows) all.rows += part.count;
  const Handle space = space_of(all);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  std::uint64_t first = 0;
  for (std::size_t i = 0; i < rows.size();) {
    RowsElsewhere part = rows[i];
    // What follows in both files is one part: the fewer, the faster files are written and read.
    for (++i; i < rows.size() && rows[i].file == part.file && rows[i].name == part.name &&
              rows[i].first == part.first + part.count;
         ++i)
      part.count += rows[i].count;
    const Shape source{part.first + part.count, columns};
    const Handle from = space_of(source);
    if (!select_rows(space.id(), all, first, part.count) ||
        !select_rows(from.id(), source, part.first, part.count) ||
        H5Pset_virtual(properties.id(), space.id(), part.file.c_str(), part.name.c_str(),
                       from.id()) < 0)
      fail(name, "");
    first += part.count;
  }
  H5Sselect_all(space.id());
  const Handle dataset(H5Dcreate2(handle_.id(), name.c_str(), native(type), space.id(), H5P_DEFAULT,
                                  properties.id(), H5P_DEFAULT),
                       H5Dclose);
  if (dataset.id() < 0) fail(name, "");
}

void Group::create_growing_array(const std::string& name, Type type, std::uint64_t columns,
                                 std::uint64_t chunk_rows) {
  const Guard guard;
  const Handle space = space_of({0, columns}, /*growing=*/true);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const std::array<hsize_t, 2> chunk{chunk_rows, columns};
  if (H5Pset_chunk(properties.id(), columns == 0 ? 1 : 2, chunk.data()) < 0) fail(name, "");
  const Handle dataset(H5Dcreate2(handle_.id(), name.c_str(), native(type), space.id(), H5P_DEFAULT,
                                  properties.id(), H5P_DEFAULT),
                       H5Dclose);
  if (dataset.id() < 0) fail(name, "");
}

void Group::append_array(const std::string& name, Type type, const void* values,
                         std::uint64_t count) {
  const Guard guard;
  const Handle dataset = open_array(name);
  Shape shape;
  if (!get_shape(dataset.id(), &shape)) fail(name, "expected one or two dimensions");
  const std::uint64_t rows = shape_for(name, count, shape.columns).rows;
  if (rows == 0) return;
  const std::array<hsize_t, 2> size{shape.rows + rows, shape.columns};
  if (H5Dset_extent(dataset.id(), size.data()) < 0) fail(name, "");
  const Handle file_space(H5Dget_space(dataset.id()), H5Sclose);
  const Handle memory_space = space_of({rows, shape.columns});
  if (!select_rows(file_space.id(), shape, shape.rows, rows)) fail(name, "");
  if (H5Dwrite(dataset.id(), native(type), memory_space.id(), file_space.id(), H5P_DEFAULT,
               values) < 0)
    fail(name, "");
}

void Group::append_missing_rows(const Group& other, const std::string& name) {
  const Guard guard;
  const Handle source = other.open_array(name);
  const Shape from = other.shape(name);
  Shape to = shape(name);
  const Handle stored(H5Dget_type(source.id()), H5Tclose);
  const std::array all{Type::float64, Type::float32, Type::int64,
                       Type::int32,   Type::uint64,  Type::uint8};
  const auto type = std::find_if(all.begin(), all.end(),
                                 [&](Type candidate) { return is_type(stored.id(), candidate); });
  if (type == all.end()) other.fail(name, "unexpected element type");
  if (from.columns != to.columns) fail(name, "unexpected number of columns");

  const std::uint64_t value_bytes = H5Tget_size(native(*type));
  constexpr std::uint64_t block_bytes = 4 << 20;
  const std::uint64_t block_rows =
      std::max<std::uint64_t>(1, block_bytes / (value_bytes * from.values_per_row()));
  std::vector<char> block;
  while (to.rows < from.rows) {
    const std::uint64_t rows = std::min(block_rows, from.rows - to.rows);
    const std::uint64_t count = rows * from.values_per_row();
    block.resize(count * value_bytes);
    other.read_array(name, *type, block.data(), count, to.rows);
    append_array(name, *type, block.data(), count);
    to.rows += rows;
  }
}

void Group::truncate(const std::string& name, std::uint64_t rows) {
  const Guard guard;
  const Handle dataset = open_array(name);
  Shape shape;
  if (!get_shape(dataset.id(), &shape)) fail(name, "expected one or two dimensions");
  if (shape.rows <= rows) return;
  const std::array<hsize_t, 2> size{rows, shape.columns};
  if (H5Dset_extent(dataset.id(), size.data()) < 0) fail(name, "");
}

Shape Group::shape(const std::string& name) const {
  const Guard guard;
  const Handle dataset = open_array(name);
  Shape shape;
  if (!get_shape(dataset.id(), &shape)) fail(name, "expected one or two dimensions");
  return shape;
}

void Group::read_array(const std::string& name, Type type, void* out, std::uint64_t count,
                       std::uint64_t first) const {
  const Guard guard;
  const Handle dataset = open_array(name);
  const Handle stored(H5Dget_type(dataset.id()), H5Tclose);
  if (!is_type(stored.id(), type)) fail(name, fmt::format("expected {} values", name_of(type)));
  Shape shape;
  if (!get_shape(dataset.id(), &shape)) fail(name, "expected one or two dimensions");
  const std::uint64_t rows = shape_for(name, count, shape.columns).rows;
  if (first > shape.rows || rows > shape.rows - first)
    fail(name, fmt::format("expected at least {} rows, found {}", first + rows, shape.rows));
  if (rows == 0) return;
  count_bytes(name, dataset, count * H5Tget_size(native(type)));
  const Handle file_space(H5Dget_space(dataset.id()), H5Sclose);
  const Handle memory_space = space_of({rows, shape.columns});
  if (!select_rows(file_space.id(), shape, first, rows)) fail(name, "");
  if (H5Dread(dataset.id(), native(type), memory_space.id(), file_space.id(), H5P_DEFAULT, out) < 0)
    fail(name, "");
}

std::uint64_t Group::value_count(const std::string& name) const {
  const Guard guard;
  const Handle dataset = open_array(name);
  const Handle space(H5Dget_space(dataset.id()), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space.id());
  if (count < 0) fail(name, "");
  return static_cast<std::uint64_t>(count);
}

void Group::read_converted_array(const std::string& name, Type type, void* out,
                                 std::uint64_t count) const {
  const Guard guard;
  const Handle dataset = open_array(name);
  const Handle stored(H5Dget_type(dataset.id()), H5Tclose);
  if (H5Tget_class(stored.id()) != H5Tget_class(native(type)))
    fail(name, H5Tget_class(native(type)) == H5T_INTEGER ? "expected integers"
                                                         : "expected floating-point numbers");
  if (value_count(name) != count) fail(name, "the number of values changed");
  if (count == 0) return;
  count_bytes(name, dataset, count * H5Tget_size(stored.id()));
  if (H5Dread(dataset.id(), native(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, out) < 0) fail(name, "");
}

void Group::write_text(const std::string& name, const std::string& text) {
  const Guard guard;
  const Handle type = text_type(text.size(), H5T_CSET_UTF8);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle dataset(H5Dcreate2(handle_.id(), name.c_str(), type.id(), space.id(), H5P_DEFAULT,
                                  H5P_DEFAULT, H5P_DEFAULT),
                       H5Dclose);
  if (dataset.id() < 0) fail(name, "");
  if (H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()) < 0)
    fail(name, "");
}

std::string Group::read_text(const std::string& name) const {
  const Guard guard;
  const Handle dataset = open_array(name);
  const Handle type(H5Dget_type(dataset.id()), H5Tclose);
  const Handle space(H5Dget_space(dataset.id()), H5Sclose);
  if (H5Tget_class(type.id()) != H5T_STRING || H5Tis_variable_str(type.id()) > 0 ||
      H5Sget_simple_extent_npoints(space.id()) != 1)
    fail(name, "expected a text");
  count_bytes(name, dataset, H5Tget_size(type.id()));
  std::string text(H5Tget_size(type.id()), '\0');
  if (H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0)
    fail(name, "");
  strip_padding(&text);
  return text;
}

void Group::write_attribute_array(const std::string& name, Type type, const void* values,
                                  std::uint64_t count, bool scalar) {
  const Guard guard;
  const Handle space = scalar ? Handle(H5Screate(H5S_SCALAR), H5Sclose) : space_of({count, 0});
  const Handle attribute(has_attribute(name) ? H5Aopen(handle_.id(), name.c_str(), H5P_DEFAULT)
                                             : H5Acreate2(handle_.id(), name.c_str(), native(type),
                                                          space.id(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  if (attribute.id() < 0 || H5Awrite(attribute.id(), native(type), values) < 0)
    fail_attribute(name, "");
}

void Group::write_text_attribute(const std::string& name, const std::string& text) {
  const Guard guard;
  const Handle type = text_type(text.size(), H5T_CSET_ASCII);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  if (has_attribute(name)) H5Adelete(handle_.id(), name.c_str());
  const Handle attribute(
      H5Acreate2(handle_.id(), name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  if (attribute.id() < 0 || H5Awrite(attribute.id(), type.id(), text.c_str()) < 0)
    fail_attribute(name, "");
}

bool Group::has_attribute(const std::string& name) const {
  const Guard guard;
  return H5Aexists(handle_.id(), name.c_str()) > 0;
}

void Group::read_attribute_array(const std::string& name, Type type, void* out,
                                 std::uint64_t count) const {
  const Guard guard;
  if (!has_attribute(name)) fail_attribute(name, "no such attribute");
  const Handle attribute(H5Aopen(handle_.id(), name.c_str(), H5P_DEFAULT), H5Aclose);
  const Handle stored(H5Aget_type(attribute.id()), H5Tclose);
  const Handle space(H5Aget_space(attribute.id()), H5Sclose);
  if (!is_type(stored.id(), type))
    fail_attribute(name, fmt::format("expected a {}", name_of(type)));
  if (H5Sget_simple_extent_npoints(space.id()) != static_cast<hssize_t>(count))
    fail_attribute(name, fmt::format("expected {} values", count));
  if (H5Aread(attribute.id(), native(type), out) < 0) fail_attribute(name, "");
}

std::int64_t Group::integer_attribute(const std::string& name) const {
  const Guard guard;
  if (!has_attribute(name)) fail_attribute(name, "no such attribute");
  const Handle attribute(H5Aopen(handle_.id(), name.c_str(), H5P_DEFAULT), H5Aclose);
  const Handle stored(H5Aget_type(attribute.id()), H5Tclose);
  const Handle space(H5Aget_space(attribute.id()), H5Sclose);
  if (H5Tget_class(stored.id()) != H5T_INTEGER || H5Sget_simple_extent_npoints(space.id()) != 1)
    fail_attribute(name, "expected an integer");
  std::int64_t value = 0;
  if (H5Aread(attribute.id(), H5T_NATIVE_INT64, &value) < 0) fail_attribute(name, "");
  return value;
}

std::string Group::text_attribute(const std::string& name) const {
  const Guard guard;
  if (!has_attribute(name)) fail_attribute(name, "no such attribute");
  const Handle attribute(H5Aopen(handle_.id(), name.c_str(), H5P_DEFAULT), H5Aclose);
  const Handle type(H5Aget_type(attribute.id()), H5Tclose);
  const Handle space(H5Aget_space(attribute.id()), H5Sclose);
  if (H5Tget_class(type.id()) != H5T_STRING || H5Tis_variable_str(type.id()) > 0 ||
      H5Sget_simple_extent_npoints(space.id()) != 1)
    fail_attribute(name, "expected a text");
  if (bounds_ && H5Tget_size(type.id()) > bounds_->file_bytes)
    fail_attribute(name, fmt::format("declares a text of {} bytes, more than the file has",
                                     H5Tget_size(type.id())));
  std::string text(H5Tget_size(type.id()), '\0');
  if (H5Aread(attribute.id(), type.id(), text.data()) < 0) fail_attribute(name, "");
  strip_padding(&text);
  return text;
}

namespace {

/// Others than regular files may wait forever, as pipes do.
bool is_regular(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

void require_regular(const std::filesystem::path& path) {
  if (std::filesystem::exists(path) && !is_regular(path))
    throw Error(fmt::format("{}: it is not a regular file", path.string()));
}

}  // namespace

bool is_hdf5(const std::filesystem::path& path) {
  const Guard guard;
  return is_regular(path) && H5Fis_hdf5(path.c_str()) > 0;
}

File::File(Handle handle, std::string path, std::shared_ptr<Bounds> bounds)
    : handle_(std::move(handle)), path_(std::move(path)), bounds_(std::move(bounds)) {}

File File::create(const std::filesystem::path& path, std::uint64_t user_block) {
  const Guard guard;
  const Handle properties(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  if (H5Pset_userblock(properties.id(), user_block) < 0)
    throw Error(fmt::format("{}: {}", path.string(), last_reason()));
  Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, properties.id(), H5P_DEFAULT), H5Fclose);
  if (file.id() < 0) throw Error(fmt::format("{}: {}", path.string(), last_reason()));
  return {std::move(file), path.string()};
}

File File::open(const std::filesystem::path& path) {
  const Guard guard;
  require_regular(path);
  Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (file.id() < 0) throw Error(fmt::format("{}: {}", path.string(), last_reason()));
  return {std::move(file), path.string()};
}

File File::open_foreign(const std::filesystem::path& path) {
  File file = open(path);
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error) throw Error(fmt::format("{}: {}", path.string(), error.message()));
  file.bounds_ = std::make_shared<Bounds>(Bounds{bytes, 0});
  return file;
}

File File::open_for_append(const std::filesystem::path& path) {
  const Guard guard;
  require_regular(path);
  Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  if (file.id() < 0) throw Error(fmt::format("{}: {}", path.string(), last_reason()));
  return {std::move(file), path.string()};
}

Group File::root() const {
  const Guard guard;
  Handle group(H5Gopen2(handle_.id(), "/", H5P_DEFAULT), H5Gclose);
  if (group.id() < 0) throw Error(fmt::format("{}: {}", path_, last_reason()));
  return {std::move(group), path_, "", bounds_};
}

void File::close() {
  const Guard guard;
  // A failed flush is reported while the handle is still good; a failed close cannot be repeated.
  if (H5Fflush(handle_.id(), H5F_SCOPE_LOCAL) < 0)
    throw Error(fmt::format("{}: {}", path_, last_reason()));
  if (H5Fclose(handle_.release()) < 0) throw Error(fmt::format("{}: {}", path_, last_reason()));
}

}  // namespace scree::h5
