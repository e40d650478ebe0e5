#pragma once
// The protocol of every comparison: contenders are built first, warmed up, then run in turns, so that what disturbs the
// machine disturbs all of them alike.

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace mpm::bench {

/// Middle of the values (mean of the two middle ones); NaN for none.
double median(std::vector<double> values);

/// What a run of steps took.
struct Seconds {
  double wall = 0;
  double processor = 0;  ///< processor time of all threads together
};

/// Something that advances particles step by step.
class Contender {
 public:
  virtual ~Contender() = default;
  virtual void step() = 0;
  virtual Seconds run(int steps);
  virtual int threads() const { return 1; }
  virtual std::size_t particle_count() const = 0;
  /// Number of steps after which the cost repeats; a window holds as many or more.
  virtual int steps_a_cycle() const { return 1; }
};

struct Protocol {
  int repeats = 5;               ///< rounds
  int warm_up = 4;               ///< steps of each contender before the first round
  double window_seconds = 0.35;  ///< length of a contender's window in a round, about
  bool processor_time = false;   ///< rates of contenders of one thread by the processor's time instead of the wall's
  bool whole_cycles =
      true;  ///< windows hold whole cycles (Contender::steps_a_cycle), the same steps for all that have any
};

/// Rates of each contender, particle-steps/s, one a round.
struct Rates {
  std::vector<std::vector<double>> by_contender;
  std::vector<int> steps;  ///< steps of a contender in each round
  double given = 1;        ///< share of the processor time wanted that the machine gave; far below 1: it was busy

  double rate(std::size_t contender) const { return median(by_contender[contender]); }
  /// Median of the ratios a / b of each round: a disturbance that both suffered in a round cancels.
  double ratio(std::size_t a, std::size_t b) const;
  /// How far the rounds disagree: the median distance of the rounds from their median, over that median.
  double spread(std::size_t contender) const;
};

/// Runs round by round: in each, every contender runs its steps once. The order turns from round to round.
Rates run_in_turns(const std::vector<Contender*>& contenders, const Protocol& protocol);

}  // namespace mpm::bench
