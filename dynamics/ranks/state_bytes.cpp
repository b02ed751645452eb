#include "dynamics/ranks/state_bytes.h"

#include <cstring>
#include <type_traits>
#include <variant>

#include "host/error.h"

namespace scree {
namespace {

class Writer {
 public:
  template <class T>
  void put(const T& value) {
    put(&value, 1);
  }
  template <class T>
  void put(const T* values, std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* first = reinterpret_cast<const unsigned char*>(values);
    bytes.insert(bytes.end(), first, first + count * sizeof(T));
  }
  void put_text(const std::string& text) {
    put(static_cast<std::uint64_t>(text.size()));
    put(text.data(), text.size());
  }
  Bytes bytes;
};

class Reader {
 public:
  explicit Reader(const Bytes& bytes) : bytes_(bytes) {}

  template <class T>
  T take() {
    T value{};
    take(&value, 1);
    return value;
  }
  template <class T>
  void take(T* values, std::size_t count) {
    if (count > (bytes_.size() - at_) / sizeof(T))
      throw RunError("a state from another rank is cut");
    if (count > 0) std::memcpy(static_cast<void*>(values), bytes_.data() + at_, count * sizeof(T));
    at_ += count * sizeof(T);
  }
  std::string take_text() {
    std::string text(count_of(1), ' ');
    take(text.data(), text.size());
    return text;
  }
  /// Reads how many values of a size follow.
  std::size_t count_of(std::size_t size) {
    const auto count = take<std::uint64_t>();
    if (count > (bytes_.size() - at_) / size) throw RunError("a state from another rank is cut");
    return count;
  }

 private:
  const Bytes& bytes_;
  std::size_t at_ = 0;
};

/// Reads the values of the alternative with this number.
template <std::size_t kNumber = 0>
StateValues take_values(Reader& reader, std::size_t number) {
  if constexpr (kNumber < std::variant_size_v<StateValues>) {
    if (number != kNumber) return take_values<kNumber + 1>(reader, number);
    using Values = std::variant_alternative_t<kNumber, StateValues>;
    Values values(reader.count_of(sizeof(typename Values::value_type)));
    reader.take(values.data(), values.size());
    return values;
  } else {
    throw RunError("a state from another rank has values of an unknown type");
  }
}

}  // namespace

Bytes to_bytes(const WorldState& state) {
  Writer writer;
  writer.put_text(state.dynamics);
  writer.put(state.step);
  writer.put(state.time);
  writer.put(state.insertions_done);
  writer.put(static_cast<std::uint64_t>(state.arrays.size()));
  for (const StateArray& array : state.arrays) {
    writer.put_text(array.name);
    writer.put(static_cast<std::uint64_t>(array.values.index()));
    std::visit(
        [&](const auto& values) {
          writer.put(static_cast<std::uint64_t>(values.size()));
          writer.put(values.data(), values.size());
        },
        array.values);
  }
  return std::move(writer.bytes);
}

WorldState state_from(const Bytes& bytes) {
  Reader reader(bytes);
  WorldState state;
  state.dynamics = reader.take_text();
  state.step = reader.take<std::int64_t>();
  state.time = reader.take<double>();
  state.insertions_done = reader.take<std::uint64_t>();
  const auto count = reader.take<std::uint64_t>();
  for (std::uint64_t k = 0; k < count; ++k) {
    StateArray array;
    array.name = reader.take_text();
    const auto number = reader.take<std::uint64_t>();
    array.values = take_values(reader, number);
    state.arrays.push_back(std::move(array));
  }
  return state;
}

}  // namespace scree
