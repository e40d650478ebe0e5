#pragma once
// Ctrl-C and a polite kill as a question that long work asks itself.

#include <array>
#include <csignal>

namespace mpm::app {

/// Whether a signal asked to stop since the last StopOnSignal was made.
bool stop_requested();

/// While it lives, Ctrl-C and a polite kill end the work at its next boundary; a second one ends the program at once. A
/// signal that the caller ignores stays ignored. A reader of the progress lines that goes away does not end the work.
class StopOnSignal {
 public:
  StopOnSignal();
  ~StopOnSignal();
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

 private:
  static constexpr std::array signals{SIGINT, SIGTERM, SIGPIPE};
  std::array<struct sigaction, signals.size()> before_{};
};

}  // namespace mpm::app
