#include "mpm/stop_on_signal.hpp"

#include <atomic>

namespace mpm::app {
namespace {

std::atomic<bool> requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set from a signal handler");

extern "C" void request_stop(int) {
  requested = true;
}

}  // namespace

bool stop_requested() {
  return requested;
}

StopOnSignal::StopOnSignal() {
  requested = false;
  struct sigaction action {};
  sigemptyset(&action.sa_mask);
  for (std::size_t k = 0; k < signals.size(); ++k) {
    action.sa_handler = signals[k] == SIGPIPE ? SIG_IGN : request_stop;
    action.sa_flags = SA_RESTART | (signals[k] == SIGPIPE ? 0 : static_cast<int>(SA_RESETHAND));
    sigaction(signals[k], nullptr, &before_[k]);
    if (before_[k].sa_handler != SIG_IGN) sigaction(signals[k], &action, nullptr);
  }
}

StopOnSignal::~StopOnSignal() {
  for (std::size_t k = 0; k < signals.size(); ++k) sigaction(signals[k], &before_[k], nullptr);
}

}  // namespace mpm::app
