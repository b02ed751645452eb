#include "host/io/signals.h"

#include <atomic>

namespace scree {
namespace {

// A signal handler can reach nothing but static storage.
std::atomic<int> received_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);

extern "C" void note_signal(int number) {
  received_signal = number;
  for (const int request : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction now {};
    if (sigaction(request, nullptr, &now) == 0 && now.sa_handler == note_signal)
      std::signal(request, request == SIGHUP ? SIG_IGN : SIG_DFL);
  }
}

extern "C" void keep_signal(int number) { received_signal = number; }

}  // namespace

SignalGuard::SignalGuard() {
  received_signal = 0;
  struct sigaction action {};
  action.sa_handler = note_signal;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (const int request : requests) sigaddset(&action.sa_mask, request);
  for (std::size_t k = 0; k < requests.size(); ++k) {
    sigaction(requests[k], nullptr, &old_[k]);
    if (old_[k].sa_handler != SIG_IGN) sigaction(requests[k], &action, nullptr);
  }
}

SignalGuard::~SignalGuard() {
  for (std::size_t k = 0; k < requests.size(); ++k) sigaction(requests[k], &old_[k], nullptr);
}

int SignalGuard::received() const { return received_signal; }

void note_requests_to_end() {
  received_signal = 0;
  struct sigaction action {};
  action.sa_handler = keep_signal;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (const int request : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction now {};
    if (sigaction(request, nullptr, &now) == 0 && now.sa_handler != SIG_IGN)
      sigaction(request, &action, nullptr);
  }
}

bool is_requested_to_end() { return received_signal != 0; }

}  // namespace scree
