#pragma once
// The JSON file of a benchmark: on which machine, of which program, and one entry per case.

#include <nlohmann/json.hpp>
#include <string>

#include "host/world.h"

namespace scree {

using Json = nlohmann::ordered_json;

/// Machine, backend, precision, program and date.
Json bench_header(const std::string& benchmark, const WorldOptions& options);

/// The header in one line of text.
std::string bench_title(const Json& header);

/// A word behind --json may have been meant for a scene. @throws InputError unless it is a file name, "-" or empty
void require_json_name(const std::string& path);

class BenchRecord {
 public:
  /// @param path  empty: nothing is written. @throws InputError when the file cannot be written
  BenchRecord(Json header, std::string path);
  /// Adds a case and rewrites the file, so that what is done is on disk when a later case fails.
  void add(Json result);
  /// The header and all cases so far.
  const Json& document() const { return document_; }

 private:
  Json document_;
  std::string path_;
};

}  // namespace scree
