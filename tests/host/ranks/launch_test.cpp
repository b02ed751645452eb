// Which process of a launch this is, by what launchers leave in the environment.

#include "host/ranks/launch.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <string>

namespace scree {
namespace {

/// The launch as a process of its own with these variables sees it, and without those of other launchers.
Launch launched(const std::map<std::string, std::string>& variables) {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", "PMI_RANK", "PMI_SIZE",
                           "PMIX_RANK", "SLURM_STEP_NUM_TASKS"})
    ::unsetenv(name);
  for (const auto& [name, value] : variables) ::setenv(name.c_str(), value.c_str(), 1);
  const Launch launch = launch_of_environment();
  for (const auto& [name, value] : variables) ::unsetenv(name.c_str());
  return launch;
}

void expect_launch(const std::map<std::string, std::string>& variables, int rank, int count) {
  const Launch launch = launched(variables);
  EXPECT_EQ(launch.rank, rank);
  EXPECT_EQ(launch.count, count);
}

TEST(RankLaunch, AProcessThatNobodyLaunchedIsAlone) { expect_launch({}, 0, 1); }

TEST(RankLaunch, LaunchersTellRankAndCount) {
  expect_launch({{"OMPI_COMM_WORLD_RANK", "2"}, {"OMPI_COMM_WORLD_SIZE", "4"}, {"PMIX_RANK", "2"}},
                2, 4);
  expect_launch({{"PMI_RANK", "0"}, {"PMI_SIZE", "1"}}, 0, 1);
  expect_launch({{"PMIX_RANK", "3"}, {"SLURM_STEP_NUM_TASKS", "8"}}, 3, 8);
}

TEST(RankLaunch, ACountThatIsNotToldIsUnknown) { expect_launch({{"PMIX_RANK", "1"}}, 1, 0); }

TEST(RankLaunch, WhatIsNoNumberIsNoLaunch) {
  for (const char* value : {"", "x", "1x", "-1", "99999999999"})
    expect_launch({{"PMI_RANK", value}, {"PMI_SIZE", "4"}}, 0, 1);
}

}  // namespace
}  // namespace scree
