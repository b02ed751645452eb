// What crashes or hangs does so in a child process.
#include "host/io/trial.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>

namespace scree {
namespace {

TEST(Trial, WhatComesBackIsFine) {
  EXPECT_EQ(trial([] {}, 5), "");
  EXPECT_EQ(trial([] { throw std::runtime_error("refused"); }, 5), "");
}

TEST(Trial, CrashesAreTold) {
  EXPECT_EQ(trial([] { std::raise(SIGSEGV); }, 5), "it crashes (signal 11)");
  EXPECT_EQ(trial([] { std::abort(); }, 5), "it crashes (signal 6)");
  EXPECT_EQ(trial([] { std::_Exit(3); }, 5), "it crashes (exit code 3)");
}

TEST(Trial, EndlessOnesAreStopped) {
  volatile bool forever = true;
  EXPECT_EQ(trial(
                [&] {
                  while (forever) continue;
                },
                1),
            "it takes more than 1 s or the memory that there is");
}

TEST(Trial, ChangesNothingHere) {
  int value = 1;
  EXPECT_EQ(trial([&] { value = 2; }, 5), "");
  EXPECT_EQ(value, 1);
}

}  // namespace
}  // namespace scree
