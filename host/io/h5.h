#pragma once
// A thin layer over the HDF5 C library: handles that close themselves, typed arrays of one or two
// dimensions, text, and exceptions in place of error codes. No HDF5 type is visible here.
//
// The library is not thread-safe in every build, so each call holds one process-wide lock.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace scree::h5 {

/// A call of the library failed; what() names the file, the object in it and the reason.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Element types that arrays and attributes may have.
enum class Type { float64, float32, int64, int32, uint64, uint8 };

template <class T>
struct TypeOf;
template <>
struct TypeOf<double> {
  static constexpr Type value = Type::float64;
};
template <>
struct TypeOf<float> {
  static constexpr Type value = Type::float32;
};
template <>
struct TypeOf<std::int64_t> {
  static constexpr Type value = Type::int64;
};
template <>
struct TypeOf<std::int32_t> {
  static constexpr Type value = Type::int32;
};
template <>
struct TypeOf<std::uint64_t> {
  static constexpr Type value = Type::uint64;
};
template <>
struct TypeOf<std::uint8_t> {
  static constexpr Type value = Type::uint8;
};

/// Dimensions of an array: (rows) when columns is 0, else (rows, columns).
struct Shape {
  std::uint64_t rows = 0;
  std::uint64_t columns = 0;
  std::uint64_t values_per_row() const { return columns == 0 ? 1 : columns; }
  std::uint64_t value_count() const { return rows * values_per_row(); }
  friend bool operator==(const Shape&, const Shape&) = default;
};

/// Rows of an array in a file beside this one.
struct RowsElsewhere {
  std::string file;  ///< name, without a folder
  std::string name;  ///< of the array, from the root group
  std::uint64_t first = 0;
  std::uint64_t count = 0;  ///< > 0
};

/// Owner of one HDF5 identifier.
class Handle {
 public:
  using Id = std::int64_t;
  using Close = int (*)(Id);
  Handle() = default;
  Handle(Id id, Close close) : id_(id), close_(close) {}
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept;
  Handle& operator=(Handle&& other) noexcept;
  Id id() const { return id_; }
  void reset() noexcept;
  Id release() noexcept;

 private:
  Id id_ = -1;
  Close close_ = nullptr;
};

struct Bounds;

/// A group of an open file. All names are relative to the group and may contain slashes.
/// Reading never leaves the file: links to others, external storage and virtual datasets are errors.
/// Every function throws Error.
class Group {
 public:
  Group create_group(const std::string& name);
  Group open_group(const std::string& name) const;
  bool has(const std::string& name) const;

  /// Writes a new array of fixed size. @param columns 0 for one dimension
  template <class T>
  void write(const std::string& name, std::span<const T> values, std::uint64_t columns = 0) {
    write_array(name, TypeOf<T>::value, values.data(), shape_for(name, values.size(), columns));
  }

  /// Writes an array whose rows are those of arrays in other files, one after the other: a virtual dataset. They need not be
  /// there. For other programs: read() does not follow it.
  template <class T>
  void write_virtual(const std::string& name, std::span<const RowsElsewhere> rows,
                     std::uint64_t columns = 0) {
    write_virtual_array(name, TypeOf<T>::value, rows, columns);
  }

  /// Makes an empty array that append() extends, stored in chunks of the given number of rows.
  template <class T>
  void create_growing(const std::string& name, std::uint64_t columns, std::uint64_t chunk_rows) {
    create_growing_array(name, TypeOf<T>::value, columns, chunk_rows);
  }
  template <class T>
  void append(const std::string& name, std::span<const T> values) {
    append_array(name, TypeOf<T>::value, values.data(), values.size());
  }
  /// Appends the rows that the array of that name in another group has beyond those of this one.
  void append_missing_rows(const Group& other, const std::string& name);
  /// Drops the rows from the given one on.
  void truncate(const std::string& name, std::uint64_t rows);

  Shape shape(const std::string& name) const;

  /// Reads whole rows, as many as out holds, from first_row on. The stored type must be T.
  template <class T>
  void read(const std::string& name, std::span<T> out, std::uint64_t first_row = 0) const {
    read_array(name, TypeOf<T>::value, out.data(), out.size(), first_row);
  }
  template <class T>
  std::vector<T> read(const std::string& name) const {
    std::vector<T> out(shape(name).value_count());
    read(name, std::span<T>(out));
    return out;
  }

  /// Reads all values of an array of any shape. The stored type may be any of the same kind as T,
  /// integer or floating point; values outside of T's range become its nearest.
  template <class T>
  std::vector<T> read_converted(const std::string& name) const {
    std::vector<T> out(value_count(name));
    read_converted_array(name, TypeOf<T>::value, out.data(), out.size());
    return out;
  }

  /// Text of any length as one dataset; it must not end in a zero byte.
  void write_text(const std::string& name, const std::string& text);
  std::string read_text(const std::string& name) const;

  /// Attributes of the group; an existing one of the same type and size is overwritten.
  template <class T>
  void write_attribute(const std::string& name, T value) {
    write_attribute_array(name, TypeOf<T>::value, &value, 1, /*scalar=*/true);
  }
  template <class T>
  void write_attribute(const std::string& name, std::span<const T> values) {
    write_attribute_array(name, TypeOf<T>::value, values.data(), values.size(), /*scalar=*/false);
  }
  void write_text_attribute(const std::string& name, const std::string& text);
  bool has_attribute(const std::string& name) const;
  template <class T>
  T attribute(const std::string& name) const {
    T value{};
    read_attribute_array(name, TypeOf<T>::value, &value, 1);
    return value;
  }
  /// One integer of any width, as std::int64_t.
  std::int64_t integer_attribute(const std::string& name) const;
  std::string text_attribute(const std::string& name) const;

 private:
  friend class File;
  Group(Handle handle, std::string file, std::string path, std::shared_ptr<Bounds> bounds);

  [[noreturn]] void fail(const std::string& name, const std::string& what) const;
  [[noreturn]] void fail_attribute(const std::string& name, const std::string& what) const;
  Shape shape_for(const std::string& name, std::uint64_t count, std::uint64_t columns) const;
  Handle open_array(const std::string& name) const;
  void count_bytes(const std::string& name, const Handle& dataset, std::uint64_t bytes) const;
  void write_array(const std::string&, Type, const void*, Shape);
  void write_virtual_array(const std::string&, Type, std::span<const RowsElsewhere>,
                           std::uint64_t columns);
  void create_growing_array(const std::string&, Type, std::uint64_t columns, std::uint64_t rows);
  void append_array(const std::string&, Type, const void*, std::uint64_t count);
  void read_array(const std::string&, Type, void*, std::uint64_t count, std::uint64_t first) const;
  std::uint64_t value_count(const std::string& name) const;
  void read_converted_array(const std::string&, Type, void*, std::uint64_t count) const;
  void write_attribute_array(const std::string&, Type, const void*, std::uint64_t, bool scalar);
  void read_attribute_array(const std::string&, Type, void*, std::uint64_t) const;

  Handle handle_;
  std::string file_;                // for messages
  std::string path_;                // within the file, for messages; "" for the root group
  std::shared_ptr<Bounds> bounds_;  // what reading is held to; null: the program's own file
};

/// Whether it is a regular file that begins as HDF5 files do.
bool is_hdf5(const std::filesystem::path& path);

/// An open file. Groups and arrays of it must be gone before close().
class File {
 public:
  /// A new file; an old one of that name is emptied.
  /// @param user_block  bytes in front of it that HDF5 leaves alone: 0 or a power
  ///                    of two from 512 on
  static File create(const std::filesystem::path& path, std::uint64_t user_block = 0);
  static File open(const std::filesystem::path& path);
  /// A file that anybody may have made: sizes that it declares are compared with its own before
  /// memory is taken for them.
  static File open_foreign(const std::filesystem::path& path);
  static File open_for_append(const std::filesystem::path& path);

  Group root() const;

  /// Writes what is buffered and closes. The destructor closes too, but hides errors.
  /// @throws Error, for example when the disk is full
  void close();

 private:
  File(Handle handle, std::string path, std::shared_ptr<Bounds> bounds = nullptr);
  Handle handle_;
  std::string path_;
  std::shared_ptr<Bounds> bounds_;
};

}  // namespace scree::h5
