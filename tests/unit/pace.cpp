// The number of threads that is found while steps are made, on machines that are made up: what a step takes follows
// from a formula and a series of random numbers, so that nothing depends on the machine that runs the test.
#include "support/pace.hpp"

#include <algorithm>
#include <functional>
#include <random>

#include "support/catch.hpp"

using mpm::support::Pace;

namespace {

/// Steps a second as a function of the number of threads.
using Speed = std::function<double(int)>;

class Machine {
 public:
  Machine(int processors, int first)
      : most_(processors), pace(1, processors, first, [this] { return long(preempted_); }) {}

  void become(Speed speed, double preemptions_a_second, double noise = 0) {
    speed_ = std::move(speed);
    preemptions_ = preemptions_a_second;
    noise_ = noise;
  }
  /// Makes steps for so long, s. Returns how many a second, over what the best number of threads would have made.
  double share_of_best(double seconds) {
    double best = 0, took = 0;
    for (int threads = 1; threads <= most_; ++threads) best = mpm::test::larger(best, speed_(threads));
    long steps = 0;
    for (; took < seconds; ++steps) {
      REQUIRE(pace.threads() >= 1);
      REQUIRE(pace.threads() <= most_);
      const double step = (1 + noise_ * uniform_(random_)) / speed_(pace.threads());
      took += step;
      preempted_ += preemptions_ * step;
      pace.step_took(step);
    }
    return static_cast<double>(steps) / took / best;
  }

 private:
  int most_;
  Speed speed_;
  double preemptions_ = 0, preempted_ = 0, noise_ = 0;
  std::mt19937 random_{7};
  std::uniform_real_distribution<double> uniform_{-1, 1};

 public:
  Pace pace;
};

Speed table(std::vector<double> speeds) {
  return [speeds = std::move(speeds)](int threads) { return speeds.at(static_cast<std::size_t>(threads - 1)); };
}

}  // namespace

TEST_CASE("on a quiet machine all threads go on where all are fastest") {
  for (const double steps_a_second : {10., 60., 1000.}) {
    CAPTURE(steps_a_second);
    Machine machine(2, 2);
    machine.become(table({steps_a_second, 1.9 * steps_a_second}), 0, 0.05);
    CHECK(machine.share_of_best(60) > 0.98);
    CHECK(machine.share_of_best(600) > 0.99);
  }
  Machine large(16, 16);
  large.become([](int threads) { return 20. * threads; }, 1, 0.05);
  CHECK(large.share_of_best(60) > 0.98);
}

TEST_CASE("a small scene begins with one thread, and ends with as many as help") {
  Machine alone(2, 1), both(2, 1), many(64, 1);
  alone.become(table({3300, 2500}), 0, 0.05);
  CHECK(alone.share_of_best(0.2) > 0.95);
  CHECK(alone.share_of_best(10) > 0.98);
  CHECK(alone.pace.threads() == 1);
  both.become(table({3300, 6000}), 0, 0.05);
  CHECK(both.share_of_best(1) > 0.94);
  CHECK(both.share_of_best(10) > 0.98);
  many.become([](int threads) { return 1000. * std::min(threads, 30) - 20. * threads; }, 0, 0.05);
  CHECK(many.share_of_best(2) > 0.6);
  CHECK(many.share_of_best(20) > 0.9);
}

TEST_CASE("beside other work the number follows what is fastest") {
  for (const int first : {1, 2})
    for (const auto& speeds : {std::vector<double>{3000, 1200}, {3000, 2900}, {2000, 3000}}) {
      CAPTURE(first, speeds);
      Machine machine(2, first);
      machine.become(table(speeds), 400, 0.5);
      machine.share_of_best(0.5);
      CHECK(machine.share_of_best(5) > 0.88);
      CHECK(machine.share_of_best(60) > 0.9);
    }
  for (const int busy : {1, 8}) {
    CAPTURE(busy);
    // Threads beyond the processors that are left wait for one another's slices.
    Machine machine(16, 16);
    machine.become([busy](int threads) { return 50. * (threads <= 16 - busy ? threads : threads / 3.); }, 300, 0.3);
    machine.share_of_best(5);
    CHECK(machine.share_of_best(60) > 0.8);
  }
}

TEST_CASE("work that comes and goes is noticed") {
  Machine machine(2, 2);
  for (int time = 0; time < 3; ++time) {
    CAPTURE(time);
    machine.become(table({60, 115}), 0, 0.05);
    machine.share_of_best(5);
    CHECK(machine.share_of_best(20) > 0.96);
    machine.become(table({55, 20}), 300, 0.3);
    machine.share_of_best(3);
    CHECK(machine.share_of_best(20) > 0.88);
  }
}

TEST_CASE("one processor leaves nothing to try") {
  Machine machine(1, 5);
  machine.become(table({1000}), 500, 0.5);
  CHECK(machine.share_of_best(10) > 0.95);
  CHECK(machine.pace.threads() == 1);
}

TEST_CASE("a number that is given stays, and who takes processors away is noticed") {
  long preempted = 0;
  Pace pace(3, 3, 1, [&] { return preempted; });
  const auto steps_for = [&](double seconds, double preemptions_a_second) {
    for (double took = 0; took < seconds; took += 0.001) {
      preempted += static_cast<long>(preemptions_a_second * 0.001);
      pace.step_took(0.001 * (1 + 2 * (took > seconds / 2)));
      CHECK(pace.threads() == 3);
    }
  };
  steps_for(5, 0);
  CHECK_FALSE(pace.disturbed());
  steps_for(5, 1000);
  CHECK(pace.disturbed());
  steps_for(5, 0);
  CHECK_FALSE(pace.disturbed());
}
