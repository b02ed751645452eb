// What the program does with streams that are closed, broken or full, and with signals.

#include <cstring>

#include "host/io/checkpoint.h"
#include "tests/cli/program.h"
#include "tests/steps_file.h"

namespace scree::test {
namespace {

class CliStreams : public testing::Test {
 protected:
  /// A run that does not end by itself, and is so slow to write that only its end does.
  Arguments endless(const std::string& out) {
    return run_arguments(scene, scratch / out,
                         {"--set", "duration=1000", "--set", "output.checkpoint_interval=0",
                          "--set", "output.frame_interval=0", "--set", "output.picture=false"});
  }
  bool has_steps(const std::string& out) {
    return eventually([&] { return line_count(contents(scratch / out / "steps.csv")) > 1; });
  }
  void expect_interrupted(const std::string& out) {
    EXPECT_EQ(json_file(scratch / out / "run.json").at("status"), "interrupted");
    const std::vector<StepReport> steps = read_steps_csv(scratch / out / "steps.csv");
    ASSERT_FALSE(steps.empty());
    EXPECT_EQ(steps.back().step, read_checkpoint(scratch / out / "checkpoint.h5").state.step);
  }

  Scratch scratch;
  fs::path scene = put_scene(scratch, small_scene());
};

/// A pipe on one stream of the program, of which the test holds the other end.
class ReadEnd {
 public:
  ReadEnd() {
    if (::pipe2(ends_, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  }
  ~ReadEnd() { close(); }
  /// In the program's process.
  void connect(int stream) const { ::dup2(ends_[1], stream); }
  void close() {
    for (int& end : ends_) {
      if (end >= 0) ::close(end);
      end = -1;
    }
  }

 private:
  int ends_[2] = {-1, -1};
};

TEST_F(CliStreams, ARunGoesOnWhenNobodyReadsItsMessages) {
  ReadEnd pipe;
  Program program(scratch.path(), run_arguments(scene, scratch / "a"), 0,
                  [&] { pipe.connect(STDERR_FILENO); });
  pipe.close();
  const Result result = program.wait();
  EXPECT_EQ(result.signal, 0);
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(json_file(scratch / "a/run.json").at("status"), "done");
  EXPECT_EQ(read_steps_csv(scratch / "a/steps.csv").size(), 20u);
}

TEST_F(CliStreams, BadInputIsExitTwoWhenNobodyReadsTheMessage) {
  ReadEnd pipe;
  Program program(scratch.path(), run_arguments(scratch / "missing.json", scratch / "a"), 0,
                  [&] { pipe.connect(STDERR_FILENO); });
  pipe.close();
  EXPECT_EQ(program.wait().code, 2);
}

/// Ctrl-C reaches all programs of `scree run 2>&1 | tee log`: the reader is gone when the run ends.
TEST_F(CliStreams, AnInterruptThatEndsTheReaderTooEndsTheRunCleanly) {
  ReadEnd pipe;
  Program program(scratch.path(), endless("a"), 0, [&] {
    pipe.connect(STDOUT_FILENO);
    pipe.connect(STDERR_FILENO);
  });
  ASSERT_TRUE(has_steps("a"));
  pipe.close();
  program.send(SIGINT);
  const Result result = program.wait();
  EXPECT_EQ(result.signal, 0);
  EXPECT_EQ(result.code, 0);
  expect_interrupted("a");
}

TEST_F(CliStreams, TerminationAndAClosedTerminalEndWithACheckpoint) {
  for (const int signal : {SIGTERM, SIGHUP}) {
    const std::string out = std::to_string(signal);
    Program program(scratch.path(), endless(out));
    ASSERT_TRUE(has_steps(out));
    program.send(signal);
    if (signal == SIGHUP) program.send(SIGHUP);  // shell and system each send one
    const Result result = program.wait();
    EXPECT_EQ(result.code, 0) << strsignal(signal) << ": " << result.err;
    expect_interrupted(out);
  }
}

TEST_F(CliStreams, ASignalThatIsIgnoredFromTheStartStaysIgnored) {
  Program program(scratch.path(), endless("a"), 0, [] {
    std::signal(SIGINT, SIG_IGN);  // as for jobs in the background
    std::signal(SIGHUP, SIG_IGN);  // as under nohup
  });
  ASSERT_TRUE(has_steps("a"));
  const std::size_t before = line_count(contents(scratch / "a/steps.csv"));
  program.send(SIGINT);
  program.send(SIGHUP);
  EXPECT_TRUE(
      eventually([&] { return line_count(contents(scratch / "a/steps.csv")) > before + 1; }));
  program.send(SIGTERM);
  EXPECT_EQ(program.wait().code, 0);
  expect_interrupted("a");
}

/// Without the standard streams the first files that are opened would get their numbers.
TEST_F(CliStreams, ClosedStreamsLeaveTheFilesAlone) {
  ASSERT_EQ(scree(scratch, run_arguments(scene, scratch / "whole")).code, 0);
  for (const std::vector<int>& closed :
       {std::vector<int>{0}, {1}, {2}, {0, 1}, {1, 2}, {0, 1, 2}}) {
    std::string out = "closed";
    for (const int stream : closed) out += std::to_string(stream);
    const auto close_them = [&] {
      for (const int stream : closed) ::close(stream);
    };
    Program first(scratch.path(), run_arguments(scene, scratch / out, {"--steps", "10"}), 0,
                  close_them);
    EXPECT_EQ(first.wait().code, 0) << out;
    Program second(scratch.path(), run_arguments(scene, scratch / out, {"--resume"}), 0,
                   close_them);
    EXPECT_EQ(second.wait().code, 0) << out;
    EXPECT_EQ(steps_without_times(scratch / out / "steps.csv"),
              steps_without_times(scratch / "whole/steps.csv"))
        << out;
  }
}

/// The limit of `ulimit -f` sends a signal that ends programs which do not ignore it.
TEST_F(CliStreams, ALimitOnFileSizesIsAMessage) {
  const Result result =
      scree(scratch, run_arguments(scene, scratch / "a", {"--quiet"}), /*file_limit=*/20'000);
  EXPECT_EQ(result.signal, 0);
  EXPECT_EQ(result.code, 1);
  EXPECT_EQ(line_count(result.err), 1u) << result.err;
  EXPECT_NE(result.err.find((scratch / "a").string()), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("File too large"), std::string::npos) << result.err;
}

/// Results that do not arrive are a failure, whichever command prints them.
TEST_F(CliStreams, ResultsThatCannotBePrintedAreAFailure) {
  ASSERT_EQ(
      scree(scratch, run_arguments(scene, scratch / "a", {"--steps", "20", "--dump-problem", "20"}))
          .code,
      0);
  const std::string problem = (scratch / "a/problem_20.hdf5").string();
  const std::vector<Arguments> commands{
      {"--help"},
      {"--version"},
      {"info"},
      {"info", "--json"},
      {"check", scene.string()},
      {"check", scene.string(), "--json"},
      {"solve", problem, "--backend", "cpu", "--solver", "apgd"},
      {"solve", problem, "--backend", "cpu", "--solver", "apgd", "--json"},
      {"convert", problem, (scratch / "b.hdf5").string()},
      {"bench", scene.string(), "--backend", "cpu", "--warmup", "1", "--steps", "1"},
      {"bench", scene.string(), "--backend", "cpu", "--warmup", "1", "--steps", "1", "--json"},
  };
  for (const Arguments& command : commands) {
    const std::string name = command.front() + " " + command.back();
    Program full(scratch.path(), command, 0,
                 [] { Program::redirect(STDOUT_FILENO, "/dev/full", O_WRONLY); });
    const Result result = full.wait();
    EXPECT_EQ(result.code, 1) << name;
    EXPECT_NE(result.err.find("cannot write standard output"), std::string::npos)
        << name << ": " << result.err;
    if (command.size() > 1) {  // the library that prints help and version loses the reason
      EXPECT_NE(result.err.find("No space left on device"), std::string::npos)
          << name << ": " << result.err;
    }
    fs::remove(scratch / "b.hdf5");
    Program closed(scratch.path(), command, 0, [] { ::close(STDOUT_FILENO); });
    EXPECT_EQ(closed.wait().code, 1) << name;
    fs::remove(scratch / "b.hdf5");
  }
}

}  // namespace
}  // namespace scree::test
