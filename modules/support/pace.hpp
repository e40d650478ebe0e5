#pragma once
// How many threads are fastest is found by trying: it depends on the work, and on what else the machine has to do.

#include <functional>

namespace mpm::support {

/// How often other work has taken a processor from this process, since its start.
long preemptions();

/// Finds the number of threads with which steps are fastest, while they are made. Steps are counted over windows of
/// some time. After several windows with one number another is tried for a window (the next lower, the next higher,
/// half or twice as many, in turn), and kept where it is faster by more than chance. Trials that fail become rare; where
/// the process begins to lose its processors to others, or steps become slower, they become frequent again.
class Pace {
 public:
  /// Begins with `first` threads and stays between `least` and `most`. `count_preemptions` is called at the end of each
  /// window.
  Pace(int least, int most, int first, std::function<long()> count_preemptions = preemptions);

  /// The number of threads for the next step.
  int threads() const { return trial_ > 0 ? trial_ : threads_; }
  /// Whether other work takes processors from this process.
  bool disturbed() const { return disturbed_; }
  /// Tells that a step took so long, s.
  void step_took(double seconds);

 private:
  void end_window(double rate);
  void end_trial(double rate);
  void begin_trial();
  int candidate() const;

  const int least_, most_;
  const std::function<long()> count_preemptions_;
  int threads_;
  int trial_ = 0;  ///< number of threads that is tried; 0: none
  int way_ = 0;    ///< direction of the next trial: 0 lower, 1 higher, 2 half, 3 twice as many
  int steps_ = 0;  ///< steps of the window so far
  double seconds_ = 0;
  long preempted_;          ///< preemptions at the beginning of the window
  bool disturbed_ = false;  ///< the process was preempted in the last window
  double rate_ = 0;         ///< steps/s with the present number; 0: not known yet
  int pause_;               ///< windows between trials
  int left_;                ///< windows until the next trial
};

}  // namespace mpm::support
