#pragma once
// Short scenes as text, to be read or refused.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "host/scene_reader.h"

namespace scree::test {

/// A scene with one free sphere and further keys of the document.
inline std::string with_sphere(const std::string& keys) {
  return R"({"time_step": 1e-3, "duration": 1, "bodies": [{"shape": "sphere", "radius": 0.1, "density": 1000}])" +
         (keys.empty() ? "" : ", " + keys) + "}";
}
/// A scene with one free sphere and another body.
inline std::string with_body(const std::string& body) {
  return R"({"time_step": 1e-3, "duration": 1, "bodies": [{"shape": "sphere", "radius": 0.1, "density": 1000}, )" +
         body + "]}";
}
inline std::string with_particles(const std::string& entry) {
  return R"({"time_step": 1e-3, "duration": 1, "particles": [)" + entry + "]}";
}
inline Scene parsed(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return parse_scene(text, "x.json", testing::TempDir(), overrides);
}

}  // namespace scree::test
