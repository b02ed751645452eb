#include "host/scene_reader/node.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "host/scene/scene_checks.h"

namespace scree::reader {
namespace {

/// Number of edits (insert, delete, replace) between two words.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row.back();
}

std::string joined(const std::vector<std::string>& words, const char* quote) {
  std::string list;
  for (const std::string& word : words)
    list += (list.empty() ? "" : ", ") + std::string(quote) + word + quote;
  return list;
}

std::string with_unit(const std::string& expected, const char* unit) {
  return *unit == '\0' ? expected : fmt::format("{} [{}]", expected, unit);
}

}  // namespace

std::string nearest_hint(const std::string& wrong, const std::vector<std::string>& known) {
  constexpr std::size_t kMaxWordLength = 64;  // comparing takes the product of both lengths
  if (wrong.size() > kMaxWordLength) return "";
  std::size_t best = 1 + std::max<std::size_t>(2, wrong.size() / 2);
  std::string name;
  for (const std::string& word : known) {
    if (word.size() > kMaxWordLength) continue;
    const std::size_t distance = edit_distance(wrong, word);
    // With nothing in common they are just two words.
    if (distance < best && distance < std::max(wrong.size(), word.size())) {
      best = distance;
      name = word;
    }
  }
  return name.empty() ? "" : "; did you mean \"" + name + "\"?";
}

std::string place_in(const Source& source, const std::string& path) {
  std::string result = source.file_name + ": " + (path.empty() ? "document" : path);
  for (const std::string& other : source.overridden) {
    const std::string& longer = path.size() > other.size() ? path : other;
    const std::size_t shared = std::min(path.size(), other.size());
    if (shared > 0 && path.compare(0, shared, other, 0, shared) == 0 &&
        (longer.size() == shared || longer[shared] == '.' || longer[shared] == '['))
      return result + " (overridden)";
  }
  return result;
}

std::string placed_fault(const Source& source, const std::string& fault) {
  const std::size_t end = fault.find(": ");
  if (end == std::string::npos) return source.file_name + ": " + fault;
  return place_in(source, fault.substr(0, end)) + fault.substr(end);
}

std::string Node::place() const { return place_in(*source_, path_); }

void Node::refuse(const std::string& expected) const {
  std::string value = json_->dump(-1, ' ', false, Json::error_handler_t::replace);
  if (value.size() > 80) value = value.substr(0, 77) + "...";
  throw InputError(fault_text(place(), value, expected));
}

void Node::fail(const std::string& text) const {
  throw InputError(fmt::format("{}: {}", place(), text));
}

void Node::refuse_keys(const std::vector<std::string>& keys, const std::string& why) const {
  for (const std::string& key : keys)
    if (const auto found = find(key)) found->fail(why);
}

void Node::fail_missing(const std::string& key, const std::string& expected) const {
  throw InputError(fmt::format("{}: {}{}{}: missing: {}", source_->file_name, path_,
                               path_.empty() ? "" : ".", key, expected));
}

void Node::check_keys(const KeyTable& table) const {
  if (!json_->is_object()) refuse("must be an object {...}");
  for (const auto& [key, node] : members()) {
    if (std::find(table.keys.begin(), table.keys.end(), key) != table.keys.end()) continue;
    const std::string hint = nearest_hint(key, table.keys);
    node.fail(fmt::format("unknown key{} Known keys: {}", hint.empty() ? "." : hint,
                          joined(table.keys, "")));
  }
}

std::optional<Node> Node::find(const std::string& key) const {
  if (!has(key)) return std::nullopt;
  return Node((*json_)[key], path_.empty() ? key : path_ + "." + key, *source_);
}

Node Node::at(const std::string& key, const std::string& expected) const {
  if (auto node = find(key)) return *node;
  fail_missing(key, expected);
}

std::vector<Node> Node::elements() const {
  if (!json_->is_array()) refuse("must be a list [...]");
  std::vector<Node> nodes;
  for (std::size_t i = 0; i < json_->size(); ++i)
    nodes.emplace_back((*json_)[i], fmt::format("{}[{}]", path_, i), *source_);
  return nodes;
}

std::vector<std::pair<std::string, Node>> Node::members() const {
  if (!json_->is_object()) refuse("must be an object {...}");
  std::vector<std::pair<std::string, Node>> nodes;
  for (const auto& [key, value] : json_->items())
    nodes.emplace_back(key, Node(value, path_.empty() ? key : path_ + "." + key, *source_));
  return nodes;
}

double Node::number(const Range& range, const char* unit) const {
  const std::string expected = with_unit(range.text, unit);
  if (!json_->is_number())
    refuse(expected.find("number") == std::string::npos ? "must be a number; it " + expected
                                                        : expected);
  const double value = json_->get<double>();
  const bool above = range.low_open ? value > range.low : value >= range.low;
  const bool below = range.high_open ? value < range.high : value <= range.high;
  if (!above || !below) refuse(expected);
  return value;
}

long long Node::integer(long long low, long long high) const {
  std::string expected = fmt::format("must be a whole number from {} to {}", low, high);
  if (high >= std::numeric_limits<int>::max())
    expected = fmt::format("must be a whole number, {} or more", low);
  if (!json_->is_number()) refuse(expected);
  const double value = json_->get<double>();
  // The bound keeps the cast below defined; numbers up to 2^53 are exact in double.
  if (value != std::floor(value) || std::abs(value) > 9007199254740992.0) refuse(expected);
  const auto result =
      json_->is_number_float() ? static_cast<long long>(value) : json_->get<long long>();
  if (result < low || result > high) refuse(expected);
  return result;
}

bool Node::boolean() const {
  if (!json_->is_boolean()) refuse("must be true or false");
  return json_->get<bool>();
}

std::string Node::text() const {
  if (!json_->is_string()) refuse("must be a text in quotes");
  if (json_->get_ref<const std::string&>().empty()) refuse("must not be empty");
  return json_->get<std::string>();
}

Vec3<double> Node::vector(const char* unit) const {
  if (!json_->is_array() || json_->size() != 3)
    refuse(with_unit("must be three numbers [x, y, z]", unit));
  const std::vector<Node> parts = elements();
  return {parts[0].number(kFinite, unit), parts[1].number(kFinite, unit),
          parts[2].number(kFinite, unit)};
}

Vec3<double> Node::direction() const {
  const Vec3<double> v = vector("");
  const double length = norm(v);
  if (!(length > 0) || !std::isfinite(length)) refuse("must be a direction, not of zero length");
  return v * (1 / length);
}

Quat<double> Node::orientation() const {
  const char* expected = "must be a unit quaternion [w, x, y, z]";
  if (!json_->is_array() || json_->size() != 4) refuse(expected);
  const std::vector<Node> parts = elements();
  const Quat<double> q{parts[0].number(kFinite, ""), parts[1].number(kFinite, ""),
                       parts[2].number(kFinite, ""), parts[3].number(kFinite, "")};
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  if (!(std::abs(length - 1) <= 1e-3)) refuse(expected);
  return normalized(q);
}

std::pair<double, double> Node::interval(const char* unit) const {
  const std::string expected = with_unit("must be two numbers [low, high], low below high", unit);
  if (!json_->is_array() || json_->size() != 2) refuse(expected);
  const std::vector<Node> parts = elements();
  const double low = parts[0].number(kFinite, unit);
  const double high = parts[1].number(kFinite, unit);
  if (!(low < high)) refuse(expected);
  return {low, high};
}

std::filesystem::path Node::file() const {
  std::filesystem::path path = source_->base_directory / text();
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    refuse("must be a file, and is a folder (" + path.string() + ")");
  if (!std::filesystem::is_regular_file(path, error))
    refuse("no such file (looked for " + path.string() + ")");
  return path;
}

void Node::refuse_choice(const std::vector<std::string>& names) const {
  const std::string hint = json_->is_string() ? nearest_hint(json_->get<std::string>(), names) : "";
  refuse("must be one of " + joined(names, "\"") + hint);
}

}  // namespace scree::reader
