#pragma once
// What a run needs to go on: arrays by name, as a model of dynamics saves and restores them.

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "host/scene.h"

namespace scree {

/// Rows that a state may have.
using StateValues = std::variant<std::vector<std::int32_t>, std::vector<std::uint64_t>,
                                 std::vector<double>, std::vector<Vec3d>, std::vector<Quatd>>;

struct StateArray {
  std::string name;  ///< path of its data set in a checkpoint
  StateValues values;
};

/// All that decides how a run goes on: a World made from the same Scene and restored from this
/// continues bit for bit. Values of float runs are stored as double, which is exact. The card of
/// the model says which arrays there are (dynamics/dynamics_card.h).
struct WorldState {
  std::string dynamics;  ///< name of the model
  std::int64_t step = 0;
  double time = 0;
  std::uint64_t insertions_done = 0;
  std::vector<StateArray> arrays;

  bool has(const std::string& name) const { return find(name) != nullptr; }

  /// The rows of an array. @throws InputError when it is not there, or of another type
  template <class T>
  const std::vector<T>& at(const std::string& name) const {
    const StateArray* found = find(name);
    const auto* rows = found != nullptr ? std::get_if<std::vector<T>>(&found->values) : nullptr;
    if (rows == nullptr) throw_no_array(name);
    return *rows;
  }
  template <class T>
  std::vector<T>& at(const std::string& name) {
    return const_cast<std::vector<T>&>(std::as_const(*this).template at<T>(name));
  }
  template <class T>
  void add(std::string name, std::vector<T> rows) {
    arrays.push_back({std::move(name), std::move(rows)});
  }

 private:
  const StateArray* find(const std::string& name) const {
    for (const StateArray& array : arrays)
      if (array.name == name) return &array;
    return nullptr;
  }
  [[noreturn]] static void throw_no_array(const std::string& name);
};

}  // namespace scree
