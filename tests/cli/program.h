#pragma once
// Runs the program scree as a user would, and the small scenes that the tests give it.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace scree::test {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

inline bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

inline std::string contents(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline fs::path put(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

/// A fresh directory, removed with its contents at the end.
class Scratch {
 public:
  Scratch() {
    std::string pattern = (fs::path(testing::TempDir()) / "scree_cli_XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no scratch directory");
    path_ = pattern;
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  fs::path operator/(const std::string& name) const { return path_ / name; }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

struct Result {
  int code = -1;    ///< exit code, -1 after a signal
  int signal = 0;   ///< that ended the program
  std::string out;  ///< standard output
  std::string err;  ///< standard error
};

/// A started program. Its folder is where it runs and where its two output streams are kept.
class Program {
 public:
  /// @param file_limit  largest file it may write [bytes]; 0: no limit
  /// @param prepare     called in the process that becomes the program, just before it does
  /// @param program     the file
  Program(const fs::path& folder, const Arguments& arguments, rlim_t file_limit = 0,
          const std::function<void()>& prepare = {}, const char* program = SCREE_PROGRAM)
      : out_(folder / "stdout.txt"), err_(folder / "stderr.txt") {
    Arguments all{program};
    all.insert(all.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& argument : all) argv.push_back(argument.data());
    argv.push_back(nullptr);
    child_ = ::fork();
    if (child_ != 0) return;
    redirect(STDIN_FILENO, "/dev/null", O_RDONLY);
    redirect(STDOUT_FILENO, out_.c_str(), O_WRONLY | O_CREAT | O_TRUNC);
    redirect(STDERR_FILENO, err_.c_str(), O_WRONLY | O_CREAT | O_TRUNC);
    ::setenv("OMP_WAIT_POLICY", "passive", 1);
    if (::chdir(folder.c_str()) != 0) ::_exit(126);
    // As from a shell, whatever the tests were started by.
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXFSZ})
      std::signal(signal, SIG_DFL);
    if (file_limit > 0) {
      const rlimit limit{file_limit, file_limit};
      ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    if (prepare) prepare();
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  ~Program() {
    if (child_ <= 0) return;
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void send(int signal) const { ::kill(child_, signal); }

  Result wait() {
    int status = 0;
    ::waitpid(child_, &status, 0);
    child_ = -1;
    Result result;
    if (WIFEXITED(status)) result.code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
    result.out = contents(out_);
    result.err = contents(err_);
    return result;
  }

  static void redirect(int stream, const char* path, int flags) {
    const int descriptor = ::open(path, flags, 0666);
    if (descriptor < 0 || ::dup2(descriptor, stream) < 0) ::_exit(125);
    ::close(descriptor);
  }

 private:
  fs::path out_, err_;
  pid_t child_ = -1;
};

inline Result scree(const Scratch& scratch, const Arguments& arguments, rlim_t file_limit = 0) {
  return Program(scratch.path(), arguments, file_limit).wait();
}

/// `scree run` on one CPU thread, followed by further arguments.
inline Arguments run_arguments(const fs::path& scene, const fs::path& out,
                               const Arguments& more = {}) {
  Arguments all{"run", scene.string(), "--backend", "cpu", "--threads", "1", "--out", out.string()};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

/// Waits for a condition that another process brings about. @return whether it came within a minute
template <class Condition>
bool eventually(Condition condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

inline std::size_t line_count(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

/// The lines of steps.csv without the last columns, which hold times by the clock.
inline std::vector<std::string> steps_without_times(const fs::path& steps_csv) {
  constexpr int time_columns = 5;
  std::ifstream in(steps_csv);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    for (int k = 0; k < time_columns; ++k) line.resize(std::min(line.size(), line.rfind(',')));
    lines.push_back(line);
  }
  return lines;
}

inline nlohmann::json json_file(const fs::path& path) {
  return nlohmann::json::parse(contents(path));
}

/// About two hundred spheres: some fall on a floor and two moving boxes, the others rain in.
inline nlohmann::json small_scene() {
  return nlohmann::json::parse(R"({
    "name": "small", "time_step": 1e-3, "duration": 0.02,
    "materials": {"m": {"friction": 0.4, "restitution": 0.2}},
    "bodies": [
      {"shape": "container", "min": [-0.1, -0.1, 0], "max": [0.1, 0.1, 0.5], "open": ["+z"]},
      {"shape": "box", "kind": "kinematic", "size": [0.05, 0.05, 0.02], "position": [-0.04, 0, 0.01],
       "motion": {"type": "oscillating", "axis": [0, 0, 1], "amplitude": 0.004, "frequency": 30}},
      {"shape": "box", "kind": "kinematic", "size": [0.05, 0.05, 0.02], "position": [0.04, 0, 0.01],
       "motion": {"type": "rotating", "axis": [0, 0, 1], "center": [0.04, 0, 0], "rate": 5}}
    ],
    "particles": [
      {"layout": "lattice", "count": 150, "radius": {"min": 0.008, "max": 0.01}, "density": 2500,
       "velocity": [0, 0, -3], "jitter": 0.5,
       "region": {"min": [-0.1, -0.1, 0.026], "max": [0.1, 0.1, 0.2]}},
      {"layout": "rain", "count": 50, "radius": 0.01, "density": 2500, "velocity": [0, 0, -8],
       "region": {"min": [-0.1, -0.1, 0.25], "max": [0.1, 0.1, 0.28]}, "layers": 5, "interval": 0.004}
    ],
    "output": {"frame_interval": 0.005, "checkpoint_interval": 0.005,
               "picture": {"interval": 0.01, "width": 64, "height": 48}}
  })");
}

inline fs::path put_scene(const Scratch& scratch, const nlohmann::json& scene) {
  return put(scratch / "scene.json", scene.dump(1));
}

}  // namespace scree::test
