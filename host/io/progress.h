#pragma once
// The line that says how far a run is.

#include <chrono>
#include <cstdio>
#include <string>

#include "host/world.h"

namespace scree {

struct ProgressOptions {
  std::FILE* out = stderr;
  bool quiet = false;
  bool terminal = false;      ///< rewrite one line in place, at most five times a second
  double plain_interval = 5;  ///< not a terminal: wall time between lines [s]
  bool has_contacts = true;   ///< lines tell of contacts and their residual
};

/// Options for the process: stderr, and whether it is a terminal.
ProgressOptions progress_options(bool quiet);

class Progress {
 public:
  /// @param start_time  simulated time at the start, not zero when resumed [s]
  /// @param end_time    simulated time at the end [s]
  Progress(ProgressOptions options, double start_time, double end_time);
  ~Progress();  ///< as finish()
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Shows the state after a step when it is time to; cheap otherwise.
  void update(const StepReport& report);

  /// A message on a line of its own, also when quiet (warnings and errors are never hidden).
  void note(const std::string& message);

  /// Shows the last state and ends the line.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  std::string line(Clock::time_point now) const;
  void show(Clock::time_point now);
  void erase();

  ProgressOptions options_;
  double end_time_;
  double first_simulated_;  ///< start of the rate window: simulated time, steps and wall time
  std::int64_t first_step_ = -1;
  Clock::time_point first_wall_;
  Clock::time_point last_shown_;
  StepReport last_;
  std::int64_t shown_step_ = -1;
  bool line_open_ = false;
};

/// "0:07", "12:34", "3:21:09" or "2 d 3:00:00"; "?" when not finite.
std::string duration_text(double seconds);

}  // namespace scree
