#pragma once
// JSON text to a document: comments allowed, faults named by line, column and key path; overrides.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace scree::reader {

using Json = nlohmann::ordered_json;  ///< keeps the order of the file: the first material is first

/// Parses JSON with // and /* */ comments. Keys given twice and numbers beyond the range of double
/// are refused as well. @throws InputError naming file, line, column and key path.
Json parse_json(const std::string& text, const std::string& file_name);

/// Sets the value at `key.path` from `key.path=value`. Elements of arrays are named by number:
/// `particles.0.count` or `particles[0].count`. The value is JSON, or else a bare string.
/// @return the path as messages spell it. @throws InputError naming the override.
std::string apply_override(Json& document, const std::string& override_text);

}  // namespace scree::reader
