#include "host/io/steps_csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "host/error.h"
#include "tests/host/io/output_fixtures.h"
#include "tests/steps_file.h"

namespace scree {
namespace {

using test::contents;
using test::ScratchDirectory;
using testing::HasSubstr;

StepReport report_of(std::int64_t step) {
  StepReport report;
  report.step = step;
  report.time = 0.1 * static_cast<double>(step);
  report.body_count = 17;
  report.contact_count = 2'000'000'000 * step;  // of many ranks
  report.iterations = 40;
  report.applications = 41;
  report.converged = step % 2 == 0;
  report.residual_rms = 1.0 / 3;
  report.residual_max = 1e-300;
  report.residual_max_body_a = 5;
  report.residual_relative = 0.01;
  report.exact_residual_rms = 2e-5;
  report.objective = -1.5;
  report.max_penetration = 1e-4;
  report.max_joint_error = 1e-7;
  report.max_joint_error_joint = 4;
  report.max_cone_violation = 1e-9;
  report.kinetic_energy = 12.25;
  report.ms = {1.5, 0.25, 3.125, 0.5, 5.375};
  return report;
}

class StepsCsvTest : public testing::Test {
 protected:
  std::int64_t line_count() {
    const std::string text = contents(file);
    return std::count(text.begin(), text.end(), '\n');
  }
  void write_steps(std::int64_t count) {
    StepsCsv csv(file, columns);
    for (std::int64_t step = 1; step <= count; ++step) csv.append(report_of(step));
  }
  std::span<const ReportColumn> columns = dynamics_card("rigid").report;
  ScratchDirectory directory;
  std::filesystem::path file = directory / "steps.csv";
};

TEST_F(StepsCsvTest, NoValueIsAnEmptyField) {
  StepReport report = report_of(1);
  report.max_penetration = kNoValue;
  StepsCsv(file, columns).append(report);
  const std::string text = contents(file);
  EXPECT_NE(text.find(",,"), std::string::npos) << text;
  EXPECT_EQ(text.find("inf"), std::string::npos) << text;
  EXPECT_EQ(read_steps_csv(file).at(0).max_penetration, kNoValue);
}

TEST_F(StepsCsvTest, EveryFieldComesBack) {
  write_steps(3);
  const std::vector<StepReport> reports = read_steps_csv(file);
  ASSERT_EQ(reports.size(), 3u);
  for (std::int64_t step = 1; step <= 3; ++step) {
    const StepReport& found = reports[static_cast<std::size_t>(step - 1)];
    const StepReport expected = report_of(step);
    EXPECT_EQ(found.step, expected.step);
    EXPECT_EQ(found.time, expected.time);
    EXPECT_EQ(found.body_count, expected.body_count);
    EXPECT_EQ(found.contact_count, expected.contact_count);
    EXPECT_EQ(found.iterations, expected.iterations);
    EXPECT_EQ(found.applications, expected.applications);
    EXPECT_EQ(found.converged, expected.converged);
    EXPECT_EQ(found.residual_rms, expected.residual_rms);
    EXPECT_EQ(found.residual_max, expected.residual_max);
    EXPECT_EQ(found.residual_max_body_a, 5);
    EXPECT_EQ(found.residual_max_body_b, -1);
    EXPECT_EQ(found.residual_relative, expected.residual_relative);
    EXPECT_EQ(found.exact_residual_rms, expected.exact_residual_rms);
    EXPECT_EQ(found.objective, expected.objective);
    EXPECT_EQ(found.max_penetration, expected.max_penetration);
    EXPECT_EQ(found.max_joint_error, expected.max_joint_error);
    EXPECT_EQ(found.max_joint_error_joint, 4);
    EXPECT_EQ(found.max_cone_violation, expected.max_cone_violation);
    EXPECT_EQ(found.kinetic_energy, expected.kinetic_energy);
    EXPECT_EQ(found.ms.collision, 1.5);
    EXPECT_EQ(found.ms.setup, 0.25);
    EXPECT_EQ(found.ms.solve, 3.125);
    EXPECT_EQ(found.ms.integrate, 0.5);
    EXPECT_EQ(found.ms.total, 5.375);
  }
}

TEST_F(StepsCsvTest, HasAHeaderWithUnits) {
  write_steps(0);
  EXPECT_EQ(line_count(), 1);
  EXPECT_THAT(contents(file), HasSubstr("step,time_s,bodies,contacts,"));
  EXPECT_THAT(contents(file), HasSubstr("residual_rms_m_per_s"));
  EXPECT_TRUE(read_steps_csv(file).empty());
}

TEST_F(StepsCsvTest, HoldsLinesBackButNotForLong) {
  StepsCsv csv(file, columns);
  for (std::int64_t step = 1; step <= 99; ++step) csv.append(report_of(step));
  const std::int64_t before = line_count();
  csv.append(report_of(100));
  EXPECT_LE(before, 100);
  csv.flush();
  EXPECT_EQ(line_count(), 101);
  std::this_thread::sleep_for(std::chrono::milliseconds(1050));
  csv.append(report_of(101));
  EXPECT_EQ(line_count(), 102);
}

TEST_F(StepsCsvTest, ResumeCutsAtTheCheckpointAndGoesOn) {
  for (const std::int64_t step : {0, 1, 3, 5, 9}) {
    write_steps(5);
    {
      StepsCsv csv(file, columns, step);
      csv.append(report_of(step + 1));
    }
    const std::vector<StepReport> reports = read_steps_csv(file);
    const std::int64_t kept = std::min<std::int64_t>(step, 5);
    ASSERT_EQ(std::ssize(reports), kept + 1);
    for (std::int64_t i = 0; i < kept; ++i)
      EXPECT_EQ(reports[static_cast<std::size_t>(i)].step, i + 1);
    EXPECT_EQ(reports.back().step, step + 1);
  }
}

TEST_F(StepsCsvTest, ResumeCutsATornLine) {
  write_steps(3);
  std::ofstream(file, std::ios::app) << "4,0.4,17,1";
  EXPECT_EQ(read_steps_csv(file).size(), 3u);
  {
    StepsCsv csv(file, columns, 9);
    csv.append(report_of(4));
  }
  EXPECT_EQ(read_steps_csv(file).size(), 4u);
}

TEST_F(StepsCsvTest, ResumeWithoutAFileStartsOne) {
  { StepsCsv csv(file, columns, 5); }
  EXPECT_EQ(line_count(), 1);
}

TEST_F(StepsCsvTest, RefusesOtherColumnsAndValues) {
  test::put(file, "step,time\n1,2\n");
  EXPECT_THROW(StepsCsv(file, columns, 1), InputError);
  EXPECT_EQ(contents(file), "step,time\n1,2\n");
  write_steps(2);
  std::string text = contents(file);
  text.replace(text.rfind("17"), 2, "x7");
  test::put(file, text);
  try {
    read_steps_csv(file);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("line 3: column bodies holds \"x7\""));
  }
}

TEST_F(StepsCsvTest, AFileOfAnEarlierVersionKeepsItsColumns) {
  test::put(file, "step,bodies\n1,17\n2,17\n3,17\n");
  check_steps_csv(file, columns, 2);
  EXPECT_EQ(line_count(), 4) << "the check changes nothing";
  {
    StepsCsv csv(file, columns, 2);
    csv.append(report_of(3));
  }
  EXPECT_EQ(contents(file), "step,bodies\n1,17\n2,17\n3,17\n");
  EXPECT_EQ(read_steps_csv(file).back().body_count, 17);
  for (const char* header : {"", "bodies,step", "step,step", "step,", "step,bodies,bodies"}) {
    test::put(file, std::string(header) + "\n1,1\n");
    EXPECT_THROW(check_steps_csv(file, columns, 1), InputError) << header;
  }
}

TEST_F(StepsCsvTest, AKillLeavesWholeLines) {
  for (int round = 0; round < 10; ++round) {
    const pid_t child = ::fork();
    if (child == 0) {
      StepsCsv csv(file, columns);
      for (std::int64_t step = 1;; ++step) csv.append(report_of(step));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5 + 3 * round));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    const std::string text = contents(file);
    if (text.find('\n') == std::string::npos) continue;  // killed before the header
    const std::vector<StepReport> reports = read_steps_csv(file);
    EXPECT_EQ(std::ssize(reports), line_count() - 1);
    for (std::size_t i = 0; i < reports.size(); ++i)
      ASSERT_EQ(reports[i].step, static_cast<std::int64_t>(i + 1));
    StepsCsv resumed(file, columns, std::ssize(reports));
    EXPECT_EQ(contents(file).back(), '\n');
    std::filesystem::remove(file);
  }
}

TEST_F(StepsCsvTest, AFullDiskLeavesWholeLines) {
  const int code = test::with_full_disk(10000, [&] {
    try {
      StepsCsv csv(file, columns);
      for (std::int64_t step = 1; step < 1000; ++step) csv.append(report_of(step));
    } catch (const RunError& error) {
      return std::string(error.what()).find(file.string()) != std::string::npos ? 1 : 3;
    }
    return 0;
  });
  EXPECT_EQ(code, 1);
  EXPECT_EQ(contents(file).back(), '\n');
  const auto steps = std::ssize(read_steps_csv(file));
  EXPECT_GT(steps, 20);
  EXPECT_EQ(steps, line_count() - 1);
}

}  // namespace
}  // namespace scree
