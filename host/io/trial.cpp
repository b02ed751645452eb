#include "host/io/trial.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

namespace scree {
namespace {

constexpr int came_back = 0;

[[noreturn]] void run_child(const std::function<void()>& f, unsigned seconds) {
  const rlimit no_dump{0, 0}, time{seconds, seconds + 1};
  ::setrlimit(RLIMIT_CORE, &no_dump);
  ::setrlimit(RLIMIT_CPU, &time);
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU})
    std::signal(signal, SIG_DFL);
  const int nowhere = ::open("/dev/null", O_WRONLY);  // for what libraries say when they crash
  if (nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
  try {
    f();
  } catch (...) {
    // This process says what is wrong with a file when it reads it itself.
  }
  ::_exit(came_back);
}

}  // namespace

std::string trial(const std::function<void()>& f, unsigned seconds) {
  const pid_t child = ::fork();
  if (child < 0) return {};
  if (child == 0) run_child(f, seconds);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return {};
  if (WIFEXITED(status) && WEXITSTATUS(status) == came_back) return {};
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL))
    return fmt::format("it takes more than {} s or the memory that there is", seconds);
  return WIFSIGNALED(status) ? fmt::format("it crashes (signal {})", WTERMSIG(status))
                             : fmt::format("it crashes (exit code {})", WEXITSTATUS(status));
}

}  // namespace scree
