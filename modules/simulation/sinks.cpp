#include "simulation/sinks.hpp"

#include <algorithm>

namespace mpm {
namespace {

bool is_due(const Sink& sink, double time, long steps) {
  return steps % sink.every_steps == 0 && time >= sink.from && time <= sink.until;
}

}  // namespace

bool sinks_are_due(const Experiment& experiment, double time, long steps) {
  return std::any_of(experiment.sinks.begin(), experiment.sinks.end(),
                     [&](const Sink& sink) { return is_due(sink, time, steps); });
}

std::vector<std::vector<bool>> caught_by_sinks(const Experiment& experiment, const Backend& backend, double time,
                                               long steps) {
  const auto D = static_cast<std::size_t>(experiment.dimension);
  std::vector<std::vector<bool>> caught;
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
    std::vector<bool>& of_body = caught.emplace_back();
    std::vector<const Sink*> due;
    for (const Sink& sink : experiment.sinks)
      if (sink.takes_from(body) && is_due(sink, time, steps)) due.push_back(&sink);
    if (due.empty()) continue;
    const std::vector<double> position = backend.body_state(body).position;
    of_body.resize(position.size() / D);
    for (std::size_t p = 0; p < of_body.size(); ++p) {
      Vector3 x{};
      std::copy_n(&position[p * D], D, x.begin());
      of_body[p] = std::any_of(due.begin(), due.end(), [&](const Sink* sink) { return sink->geometry->contains(x); });
    }
  }
  return caught;
}

}  // namespace mpm
