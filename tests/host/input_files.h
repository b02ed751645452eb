#pragma once
// Small files for tests of readers, and the message of a refusal.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "host/error.h"

namespace scree::test {

/// Writes a file of the test that is running, in a directory of its own, and returns its path.
inline std::filesystem::path write_file(const std::string& name, const std::string& content) {
  const auto* info = testing::UnitTest::GetInstance()->current_test_info();
  std::string folder = std::string("scree_") + info->test_suite_name() + "_" + info->name();
  for (char& c : folder)
    if (c == '/') c = '_';
  const std::filesystem::path directory = std::filesystem::path(testing::TempDir()) / folder;
  std::filesystem::create_directories(directory);
  std::ofstream(directory / name, std::ios::binary) << content;
  return directory / name;
}

/// The message of the InputError that f throws, or "no error".
template <class F>
std::string refusal(F f) {
  try {
    f();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace scree::test
