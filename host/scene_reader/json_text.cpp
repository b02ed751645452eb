#include "host/scene_reader/json_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_set>

#include "host/error.h"

namespace scree::reader {
namespace {

constexpr std::size_t kDepth = 100;  // a scene needs ten; the library's writer recurses

/// Builds the document and knows, unlike the library's own builder, where in it a fault lies.
class Builder {
 public:
  Builder(const std::string& text, std::string file_name)
      : text_(text), file_name_(std::move(file_name)) {}

  using number_integer_t = Json::number_integer_t;
  using number_unsigned_t = Json::number_unsigned_t;
  using number_float_t = Json::number_float_t;
  using string_t = Json::string_t;
  using binary_t = Json::binary_t;

  bool null() { return add(nullptr); }
  bool boolean(bool value) { return add(value); }
  bool number_integer(number_integer_t value) { return add(value); }
  bool number_unsigned(number_unsigned_t value) { return add(value); }
  bool number_float(number_float_t value, const string_t&) { return add(value); }
  bool string(string_t& value) { return add(value); }
  bool binary(binary_t&) { return false; }  // not part of JSON text
  bool start_object(std::size_t) { return open(Json::object()); }
  bool start_array(std::size_t) { return open(Json::array()); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool key(string_t& name) {
    key_ = name;
    const bool is_comment = !name.empty() && name[0] == '#';  // in scenes of other programs
    if (!keys_.back().insert(name).second && !is_comment)
      throw InputError(fmt::format("{}: {}: this key is given twice", file_name_, path()));
    return true;
  }

  /// Called for broken text (parse_error) and for numbers too large (out_of_range).
  bool parse_error(std::size_t position, const std::string& token,
                   const nlohmann::detail::exception& fault) {
    const std::size_t end = std::min(position, text_.size());
    const auto stop = text_.begin() + static_cast<std::ptrdiff_t>(end);
    const auto line = 1 + std::count(text_.begin(), stop, '\n');
    const std::size_t before = end == 0 ? std::string::npos : text_.rfind('\n', end - 1);
    const std::size_t column = before == std::string::npos ? end : end - before - 1;
    if (fault.id == 406)  // a number beyond the range of double
      throw InputError(fmt::format("{}: {}: {} is not allowed: must be a finite number (line {})",
                                   file_name_, path(), token, line));
    // Only the end of the library's message is for people: "...: syntax error while parsing
    // X - why". Newer versions say something of their own about an empty text.
    const std::string what = fault.what();
    const std::size_t start = what.find("syntax error");
    throw InputError(fmt::format(
        "{}: line {}, column {}: {}", file_name_, line, std::max<std::size_t>(column, 1),
        start == std::string::npos ? "syntax error: no JSON value found" : what.substr(start)));
  }

  Json take() { return std::move(root_); }

 private:
  template <class T>
  Json* place(T&& value) {
    if (open_.empty()) {
      root_ = std::forward<T>(value);
      return &root_;
    }
    Json& parent = *open_.back();
    if (parent.is_array()) {
      parent.push_back(std::forward<T>(value));
      return &parent.back();
    }
    // The key is new: no search through a long object.
    auto& members = parent.get_ref<Json::object_t&>();
    return &members.Json::object_t::Container::emplace_back(key_, std::forward<T>(value)).second;
  }
  template <class T>
  bool add(T&& value) {
    place(std::forward<T>(value));
    return true;
  }
  bool open(Json value) {
    if (open_.size() == kDepth)
      throw InputError(
          fmt::format("{}: more than {} lists or objects inside each other", file_name_, kDepth));
    Json* placed = place(std::move(value));
    // Addresses stay valid: a parent does not grow while a child of it is open.
    open_.push_back(placed);
    names_.push_back(key_);
    keys_.emplace_back();
    return true;
  }
  bool close() {
    key_ = names_.back();
    open_.pop_back();
    keys_.pop_back();
    names_.pop_back();
    return true;
  }

  /// Path of the value being read.
  std::string path() const {
    std::string result;
    for (std::size_t i = 0; i < open_.size(); ++i) {
      if (open_[i]->is_array()) {
        const bool last = i + 1 == open_.size();
        const std::size_t index = last ? open_[i]->size() : open_[i]->size() - 1;
        result += fmt::format("[{}]", index);
      } else {
        const std::string& name = i + 1 < names_.size() ? names_[i + 1] : key_;
        result += (result.empty() ? "" : ".") + name;
      }
    }
    return result.empty() ? "document" : result;
  }

  const std::string& text_;
  std::string file_name_;
  Json root_;
  std::vector<Json*> open_;         // objects and arrays around the value being read
  std::vector<std::string> names_;  // for each of them, the key under which it stands
  std::vector<std::unordered_set<std::string>> keys_;  // for each of them, its keys so far
  std::string key_;
};

/// Splits `a.0.b` and `a[0].b` alike.
std::vector<std::string> split_path(const std::string& path) {
  std::vector<std::string> parts;
  std::string part;
  for (const char c : path) {
    if (c == '.' || c == '[') {
      if (!part.empty()) parts.push_back(part);
      part.clear();
    } else if (c != ']') {
      part += c;
    }
  }
  if (!part.empty()) parts.push_back(part);
  return parts;
}

bool is_index(const std::string& part) {
  return !part.empty() && part.size() < 10 &&
         std::all_of(part.begin(), part.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

Json parse_json(const std::string& text, const std::string& file_name) {
  Builder builder(text, file_name);
  Json::sax_parse(text, &builder, nlohmann::detail::input_format_t::json, /*strict=*/true,
                  /*ignore_comments=*/true);
  return builder.take();
}

std::string apply_override(Json& document, const std::string& override_text) {
  const std::size_t equals = override_text.find('=');
  const auto fail = [&](const std::string& why) {
    throw InputError(fmt::format("override \"{}\": {}", override_text, why));
  };
  if (equals == std::string::npos) fail("must have the form key.path=value");
  const std::vector<std::string> parts = split_path(override_text.substr(0, equals));
  if (parts.empty()) fail("must have the form key.path=value, the path is empty");

  Json* place = &document;
  std::string path;
  for (const std::string& part : parts) {
    if (place->is_array()) {
      const std::size_t count = place->size();
      if (!is_index(part) || std::stoul(part) >= count)
        fail(fmt::format("{} has {} elements; \"{}\" must be a number from 0 to {}", path, count,
                         part, count == 0 ? 0 : count - 1));
      place = &(*place)[std::stoul(part)];
      path += "[" + part + "]";
    } else if (place->is_object() || place->is_null()) {
      place = &(*place)[part];  // a key that nobody knows is refused by the reader, like any other
      path += (path.empty() ? "" : ".") + part;
    } else {
      fail(fmt::format("{} is the value {}, it has no key \"{}\"", path,
                       place->dump(-1, ' ', false, Json::error_handler_t::replace), part));
    }
  }
  const std::string value = override_text.substr(equals + 1);
  Json parsed;
  try {
    parsed = Json::parse(value);
  } catch (const Json::exception&) {
    parsed = value;
  }
  *place = std::move(parsed);
  return path;
}

}  // namespace scree::reader
