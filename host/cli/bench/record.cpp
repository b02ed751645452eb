#include "host/cli/bench/record.h"

#include <fmt/format.h>
#include <unistd.h>

#include <ctime>
#include <filesystem>
#include <utility>

#include "host/error.h"
#include "host/io/atomic_file.h"
#include "host/io/checkpoint.h"
#include "host/version.h"

namespace scree {
namespace {

namespace fs = std::filesystem;

std::string date_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

/// Says so before hours of measurements rather than after.
void require_writable(const std::string& path) {
  const fs::path folder = fs::absolute(path).parent_path();
  const auto refuse = [&](const std::string& reason) {
    throw InputError(
        fmt::format("--json: \"{}\" cannot be written: {}; expected a file name", path, reason));
  };
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) refuse(fmt::format("no folder {}", folder.string()));
  if (::access(folder.c_str(), W_OK) != 0)
    refuse(fmt::format("the folder {} is read-only", folder.string()));
  if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored)) refuse("not a file");
}

}  // namespace

Json bench_header(const std::string& benchmark, const WorldOptions& options) {
  const DeviceInfo device = device_info(options.backend, options.device);
  return {{"benchmark", benchmark},
          {"program", "scree"},
          {"version", version()},
          {"commit", commit()},
          {"date", date_now()},
          {"device", device.name},
          {"device_memory_bytes", device.memory_bytes},
          {"backend", to_string(options.backend)},
          {"precision", to_string(options.precision)},
          {"threads", threads_of(options)}};
}

std::string bench_title(const Json& header) {
  const auto text = [&](const char* key) { return header.at(key).get<std::string>(); };
  return fmt::format("{} on {} ({}, {}, {} {}), commit {}", text("benchmark"), text("device"),
                     text("backend"), text("precision"), header.at("threads").get<int>(),
                     text("backend") == "cuda" ? "multiprocessors" : "threads", text("commit"));
}

void require_json_name(const std::string& path) {
  if (path.empty() || path == "-" || path.ends_with(".json")) return;
  throw InputError(fmt::format(
      "--json: \"{}\" is not allowed: expected a file name that ends in .json, or nothing", path));
}

BenchRecord::BenchRecord(Json header, std::string path)
    : document_(std::move(header)), path_(std::move(path)) {
  if (!path_.empty()) require_writable(path_);
  document_["results"] = Json::array();
}

void BenchRecord::add(Json result) {
  document_["results"].push_back(std::move(result));
  if (!path_.empty()) write_file_atomically(path_, document_.dump(2) + "\n");
}

}  // namespace scree
