#pragma once
// A place in a JSON document that knows its path, so that every fault names it.

#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/error.h"
#include "host/scene_reader/json_text.h"
#include "host/scene_reader/keys.h"
#include "kernels/math/quat.h"

namespace scree::reader {

/// Where the document came from.
struct Source {
  std::string file_name;                 ///< as messages name it
  std::filesystem::path base_directory;  ///< files named in the scene are relative to this
  std::vector<std::string> overridden;   ///< paths set by overrides; messages say so
};

/// "<file>: <path>", with " (overridden)" where an override gave the value, or something around it or inside it.
std::string place_in(const Source& source, const std::string& path);

/// What was found wrong with a scene that is read, as a Node says it. @param fault  "<path>: ..."
std::string placed_fault(const Source& source, const std::string& fault);

/// Numbers a key accepts, and how a message says it.
struct Range {
  double low;
  double high;
  bool low_open;   ///< low itself is not allowed
  bool high_open;  ///< high itself is not allowed
  const char* text;
};
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr Range kFinite{-kInfinity, kInfinity, true, true, "must be a finite number"};
inline constexpr Range kPositive{0, kInfinity, true, true, "must be positive"};
inline constexpr Range kNonNegative{0, kInfinity, false, true, "must be zero or positive"};
inline constexpr Range kFraction{0, 1, false, false, "must be from 0 to 1"};

/// Text of the known name nearest to the wrong one, as "; did you mean \"x\"?", or nothing.
std::string nearest_hint(const std::string& wrong, const std::vector<std::string>& known);

class Node {
 public:
  Node(const Json& json, std::string path, const Source& source)
      : json_(&json), path_(std::move(path)), source_(&source) {}

  const Json& json() const { return *json_; }
  const std::string& path() const { return path_; }
  const Source& source() const { return *source_; }

  /// "<file>: <path>: <value> is not allowed: <expected>"
  [[noreturn]] void refuse(const std::string& expected) const;
  /// "<file>: <path>: <text>"
  [[noreturn]] void fail(const std::string& text) const;
  /// "<file>: <path>.<key>: missing: <expected>"
  [[noreturn]] void fail_missing(const std::string& key, const std::string& expected) const;

  /// fail(why) at the first of the keys that the object has.
  void refuse_keys(const std::vector<std::string>& keys, const std::string& why) const;

  /// The value must be an object holding known keys only.
  void check_keys(const KeyTable& table) const;

  bool has(const std::string& key) const { return json_->is_object() && json_->contains(key); }
  std::optional<Node> find(const std::string& key) const;
  Node at(const std::string& key, const std::string& expected) const;
  std::vector<Node> elements() const;                         ///< of an array
  std::vector<std::pair<std::string, Node>> members() const;  ///< of an object, in file order

  double number(const Range& range, const char* unit) const;
  long long integer(long long low, long long high) const;  ///< also takes 1e6
  bool boolean() const;
  std::string text() const;
  Vec3<double> vector(const char* unit) const;  ///< [x, y, z]
  Vec3<double> direction() const;               ///< any length but zero; returned with length 1
  Quat<double> orientation() const;             ///< [w, x, y, z] of length 1 (to 0.1 %)
  std::pair<double, double> interval(const char* unit) const;  ///< [low, high], low < high
  std::filesystem::path file() const;  ///< relative to the scene file; must exist
  /// What read(file()) makes of the file: faults in it name the place here too.
  template <class F>
  auto from_file(const F& read) const {
    const std::filesystem::path path = file();
    try {
      return read(path);
    } catch (const InputError& error) {
      fail(error.what());
    }
  }

  /// One of the named values.
  template <class E>
  E choice(const std::vector<std::pair<std::string, E>>& named) const {
    std::vector<std::string> names;
    for (const auto& [name, value] : named) {
      if (json_->is_string() && json_->get_ref<const std::string&>() == name) return value;
      names.push_back(name);
    }
    refuse_choice(names);
  }
  /// Refuses the value, naming what is allowed and the nearest of it.
  [[noreturn]] void refuse_choice(const std::vector<std::string>& names) const;

  // "When the key is there, read it into the field; otherwise the field keeps its default."
  void read(const char* key, double& field, const Range& range, const char* unit) const {
    if (const auto node = find(key)) field = node->number(range, unit);
  }
  void read(const char* key, int& field, int low, int high) const {
    if (const auto node = find(key)) field = static_cast<int>(node->integer(low, high));
  }
  void read(const char* key, bool& field) const {
    if (const auto node = find(key)) field = node->boolean();
  }
  void read(const char* key, Vec3<double>& field, const char* unit) const {
    if (const auto node = find(key)) field = node->vector(unit);
  }

 private:
  std::string place() const;  // "<file>: <path>"

  const Json* json_;
  std::string path_;
  const Source* source_;
};

}  // namespace scree::reader
