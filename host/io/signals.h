#pragma once
// Ctrl-C, termination and a closed terminal as a polite request first.

#include <array>
#include <csignal>
#include <cstddef>

namespace scree {

/// While one exists, the first SIGINT, SIGTERM or SIGHUP only sets a flag, which the stepping
/// loop reads to end the run cleanly. A second SIGINT or SIGTERM kills the process as usual;
/// a second SIGHUP does not, since shell and system each send one when a terminal closes.
/// A signal that the process was started to ignore (nohup, a job in the background) stays ignored.
/// At most one guard at a time.
class SignalGuard {
 public:
  SignalGuard();
  ~SignalGuard();  ///< puts the earlier handlers back
  SignalGuard(const SignalGuard&) = delete;
  SignalGuard& operator=(const SignalGuard&) = delete;

  /// Number of the signal that came, 0 when none has.
  int received() const;

 private:
  static constexpr std::array requests{SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, requests.size()> old_{};
};

/// From now on SIGINT, SIGTERM and SIGHUP, however many come, only set a flag: another process decides for this one. Those
/// that the process was started to ignore stay ignored.
void note_requests_to_end();
/// Whether one has come.
bool is_requested_to_end();

}  // namespace scree
