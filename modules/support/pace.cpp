#include "support/pace.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <utility>

namespace mpm::support {
namespace {

/// Lengths of a window. It holds several slices of time that the system gives to one process after another (some
/// milliseconds each), and steps of every kind: those that sort, and those that do not.
constexpr double window_seconds = 0.02, disturbed_window_seconds = 0.06, longest_window_seconds = 0.5;
constexpr int window_steps = 8;
/// The rate of preemptions from which a processor counts as shared; on a quiet machine there are a few a second.
constexpr double preemptions_a_second = 100;
/// Windows between two trials. Where all threads work and nobody disturbs them there is little to find; trials that have
/// failed again and again, of half the speed or so, cost less than a percent.
constexpr int shortest_pause = 2, pause_of_all = 32, longest_pause = 128, longest_disturbed_pause = 32;
constexpr double faster = 1.08, slower = 0.85, hopeless = 0.6;

}  // namespace

long preemptions() {
  rusage usage{};
  return ::getrusage(RUSAGE_SELF, &usage) == 0 ? usage.ru_nivcsw : 0;
}

Pace::Pace(int least, int most, int first, std::function<long()> count_preemptions)
    : least_(std::max(1, least)),
      most_(std::max(least_, most)),
      count_preemptions_(std::move(count_preemptions)),
      threads_(std::clamp(first, least_, most_)),
      preempted_(count_preemptions_()),
      pause_(threads_ < most_ ? shortest_pause : pause_of_all),
      left_(pause_) {}

void Pace::step_took(double seconds) {
  ++steps_;
  seconds_ += seconds;
  if (seconds_ < (disturbed_ ? disturbed_window_seconds : window_seconds)) return;
  const double rate = steps_ / seconds_;
  const bool fails = trial_ > 0 && steps_ > 1 && rate < hopeless * rate_;
  if (steps_ < window_steps && seconds_ < longest_window_seconds && !fails) return;
  const long preempted = count_preemptions_();
  const bool was_disturbed = disturbed_;
  disturbed_ = static_cast<double>(preempted - preempted_) > preemptions_a_second * seconds_;
  if (disturbed_ && !was_disturbed) pause_ = shortest_pause;
  preempted_ = preempted;
  steps_ = 0;
  seconds_ = 0;
  if (trial_ > 0)
    end_trial(rate);
  else
    end_window(rate);
}

void Pace::end_window(double rate) {
  const bool became_slower = rate < slower * rate_;
  rate_ = rate_ > 0 ? 0.5 * (rate_ + rate) : rate;
  if (became_slower) pause_ = shortest_pause;
  if (disturbed_) pause_ = std::min(pause_, longest_disturbed_pause);
  left_ = std::min(left_ - 1, pause_);
  if (left_ <= 0 && least_ < most_) begin_trial();
}

int Pace::candidate() const {
  switch (way_) {
    case 0:
      return std::max(least_, threads_ - std::max(1, threads_ / 5));
    case 1:
      return std::min(most_, threads_ + std::max(1, threads_ / 4));
    case 2:
      return std::max(least_, threads_ / 2);
    default:
      return std::min(most_, threads_ * 2);
  }
}

void Pace::begin_trial() {
  while (candidate() == threads_) way_ = (way_ + 1) % 4;
  trial_ = candidate();
}

void Pace::end_trial(double rate) {
  if (rate > faster * rate_) {
    threads_ = trial_;
    rate_ = rate;
    pause_ = shortest_pause;
    left_ = 1;  // the next trial goes farther in the same direction
  } else {
    way_ = (way_ + 1) % 4;
    pause_ = std::min(2 * pause_, disturbed_ ? longest_disturbed_pause : longest_pause);
    left_ = pause_;
  }
  trial_ = 0;
}

}  // namespace mpm::support
