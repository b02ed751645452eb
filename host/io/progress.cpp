#include "host/io/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace scree {
namespace {

constexpr double terminal_interval = 0.2;  // [s]
constexpr double rate_window = 10;  // wall time over which the speed is measured, at least [s]

double seconds(std::chrono::steady_clock::duration d) {
  return std::chrono::duration<double>(d).count();
}

// A closed or full output must not end the run, so failures are ignored; prepare_streams() in
// main() keeps a closed pipe from killing it.
void put(std::FILE* out, const std::string& text) {
  std::fputs(text.c_str(), out);
  std::fflush(out);
}

int columns_of(std::FILE* out) {
  winsize size{};
  if (::ioctl(::fileno(out), TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
  return size.ws_col;
}

}  // namespace

ProgressOptions progress_options(bool quiet) {
  ProgressOptions options;
  options.quiet = quiet;
  options.terminal = ::isatty(::fileno(options.out)) == 1;
  return options;
}

std::string duration_text(double duration) {
  if (!std::isfinite(duration) || duration < 0 || duration > 1e9) return "?";
  const auto total = static_cast<std::int64_t>(std::ceil(duration));
  const std::int64_t days = total / 86400;
  const std::int64_t hours = total / 3600 % 24;
  const std::int64_t minutes = total / 60 % 60;
  if (days > 0) return fmt::format("{} d {}:{:02}:{:02}", days, hours, minutes, total % 60);
  if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, minutes, total % 60);
  return fmt::format("{}:{:02}", minutes, total % 60);
}

Progress::Progress(ProgressOptions options, double start_time, double end_time)
    : options_(options),
      end_time_(end_time),
      first_simulated_(start_time),
      first_wall_(Clock::now()),
      last_shown_(first_wall_) {}

Progress::~Progress() { finish(); }

void Progress::update(const StepReport& report) {
  if (options_.quiet) return;
  if (first_step_ < 0) first_step_ = report.step - 1;
  last_ = report;
  const Clock::time_point now = Clock::now();
  const double interval = options_.terminal ? terminal_interval : options_.plain_interval;
  if (seconds(now - last_shown_) < interval) return;
  show(now);
  // The window moves on, so that the speed is that of now and not that of the run's start.
  if (seconds(now - first_wall_) > 2 * std::max(rate_window, interval)) {
    const double share = 0.5;
    first_wall_ += std::chrono::duration_cast<Clock::duration>((now - first_wall_) * share);
    first_step_ +=
        static_cast<std::int64_t>(share * static_cast<double>(report.step - first_step_));
    first_simulated_ += share * (report.time - first_simulated_);
  }
}

std::string Progress::line(Clock::time_point now) const {
  const double wall = seconds(now - first_wall_);
  const double rate = wall > 0 ? static_cast<double>(last_.step - first_step_) / wall : 0.0;
  const double simulated_rate = wall > 0 ? (last_.time - first_simulated_) / wall : 0.0;
  const double left = std::max(end_time_ - last_.time, 0.0);
  const double eta = left == 0            ? 0.0
                     : simulated_rate > 0 ? left / simulated_rate
                                          : std::numeric_limits<double>::infinity();
  const std::string contacts =
      options_.has_contacts
          ? fmt::format("contacts {}  residual {:.2e} m/s  iterations {}{}  ", last_.contact_count,
                        last_.residual_rms, last_.iterations, last_.converged ? "" : " (cap)")
          : "";
  return fmt::format("step {}  t {:.5g}/{:.5g} s  bodies {}  {}{:.3g} steps/s  ETA {}", last_.step,
                     last_.time, end_time_, last_.body_count, contacts, rate, duration_text(eta));
}

void Progress::show(Clock::time_point now) {
  std::string text = line(now);
  if (options_.terminal) {
    // A line that wraps could not be rewritten in place.
    const auto width = static_cast<std::size_t>(std::max(columns_of(options_.out) - 1, 1));
    if (text.size() > width) text.resize(width);
    put(options_.out, "\r" + text + "\x1b[K");
    line_open_ = true;
  } else {
    put(options_.out, text + "\n");
  }
  last_shown_ = now;
  shown_step_ = last_.step;
}

void Progress::erase() {
  if (line_open_) put(options_.out, "\r\x1b[K");
  line_open_ = false;
}

void Progress::note(const std::string& message) {
  erase();
  put(options_.out, message + "\n");
}

void Progress::finish() {
  if (!options_.quiet && first_step_ >= 0 && shown_step_ != last_.step) show(Clock::now());
  if (line_open_) put(options_.out, "\n");
  line_open_ = false;
}

}  // namespace scree
