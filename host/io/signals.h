#pragma once
// Ctrl-C and termination as a polite request first.

#include <csignal>

namespace scree {

/// While one exists, the first SIGINT or SIGTERM only sets a flag, which the stepping loop looks at
/// to end the run cleanly; the second one kills the process as usual. At most one at a time.
class SignalGuard {
 public:
  SignalGuard();
  ~SignalGuard();  ///< puts the earlier handlers back
  SignalGuard(const SignalGuard&) = delete;
  SignalGuard& operator=(const SignalGuard&) = delete;

  /// Number of the signal that came, 0 when none has.
  int received() const;

 private:
  struct sigaction old_interrupt_ {};
  struct sigaction old_terminate_ {};
};

}  // namespace scree
