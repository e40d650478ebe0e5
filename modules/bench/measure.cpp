#include "bench/measure.hpp"

#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace mpm::bench {
namespace {

using Clock = std::chrono::steady_clock;

double processor_seconds() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

Seconds Contender::run(int steps) {
  const auto start = Clock::now();
  const double before = processor_seconds();
  for (int s = 0; s < steps; ++s) step();
  return {std::chrono::duration<double>(Clock::now() - start).count(), processor_seconds() - before};
}

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

double Rates::ratio(std::size_t a, std::size_t b) const {
  std::vector<double> ratios;
  for (std::size_t r = 0; r < by_contender[a].size(); ++r) ratios.push_back(by_contender[a][r] / by_contender[b][r]);
  return median(std::move(ratios));
}

double Rates::spread(std::size_t contender) const {
  std::vector<double> distances;
  const double middle = rate(contender);
  for (const double value : by_contender[contender]) distances.push_back(std::abs(value - middle));
  return median(std::move(distances)) / middle;
}

Rates run_in_turns(const std::vector<Contender*>& contenders, const Protocol& protocol) {
  const std::size_t n = contenders.size();
  const auto seconds_of = [&](Contender& contender, int steps, Seconds& taken) {
    taken = contender.run(steps);
    return protocol.processor_time && contender.threads() == 1 ? taken.processor : taken.wall;
  };
  Rates rates;
  rates.by_contender.resize(n);
  Seconds taken;
  double given = 0, wanted = 0;
  for (Contender* contender : contenders) {
    const double seconds = seconds_of(*contender, protocol.warm_up, taken) / protocol.warm_up;
    const int cycle = protocol.whole_cycles ? contender->steps_a_cycle() : 1;
    const double cycles = std::max(1.0, std::round(protocol.window_seconds / (seconds * cycle)));
    rates.steps.push_back(cycle * static_cast<int>(cycles));
  }
  // Scenes with cycles change on their way, so a ratio compares the same steps of them.
  int most = 0;
  for (std::size_t c = 0; c < n; ++c)
    if (contenders[c]->steps_a_cycle() > 1) most = std::max(most, rates.steps[c]);
  for (std::size_t c = 0; c < n && protocol.whole_cycles; ++c)
    if (contenders[c]->steps_a_cycle() > 1) rates.steps[c] = most;
  for (int round = 0; round < protocol.repeats; ++round)
    for (std::size_t turn = 0; turn < n; ++turn) {
      const std::size_t c = (turn + static_cast<std::size_t>(round)) % n;
      const double seconds = seconds_of(*contenders[c], rates.steps[c], taken);
      rates.by_contender[c].push_back(rates.steps[c] * static_cast<double>(contenders[c]->particle_count()) / seconds);
      given += taken.processor;
      wanted += taken.wall * contenders[c]->threads();
    }
  rates.given = given / wanted;
  return rates;
}

}  // namespace mpm::bench
