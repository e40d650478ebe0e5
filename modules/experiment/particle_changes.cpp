#include "experiment/particle_changes.hpp"

#include <algorithm>
#include <cmath>

#include "experiment/experiment.hpp"

namespace mpm {

long Emitter::batches_until(double time) const {
  constexpr double rounding = 1e-12;  // a batch that is due at the end of a step belongs to that step
  if (time < from * (1 - rounding)) return 0;
  const double passed = (time - from) / period, in_all = (until - from) / period;
  const double batches = std::floor(passed * (1 + rounding) + rounding) + 1;
  return static_cast<long>(std::min(batches, std::ceil(in_all * (1 - rounding) - rounding)));
}

bool Experiment::gains_particles(int body) const {
  return std::any_of(emitters.begin(), emitters.end(), [&](const Emitter& emitter) { return emitter.body == body; }) ||
         std::any_of(bodies.begin(), bodies.end(),
                     [&](const BodySpecification& other) { return other.becomes && other.becomes->body == body; });
}

bool Experiment::loses_particles(int body) const {
  return bodies[static_cast<std::size_t>(body)].becomes ||
         std::any_of(sinks.begin(), sinks.end(), [&](const Sink& sink) { return sink.takes_from(body); });
}

std::string Experiment::changer_of_particles(int body) const {
  for (const Emitter& emitter : emitters)
    if (body < 0 || emitter.body == body) return emitter.pointer;
  for (const Sink& sink : sinks)
    if (body < 0 || sink.takes_from(body)) return sink.pointer;
  for (std::size_t k = 0; k < bodies.size(); ++k)
    if (bodies[k].becomes && (body < 0 || body == static_cast<int>(k) || bodies[k].becomes->body == body))
      return bodies[k].becomes->pointer;
  return "";
}

}  // namespace mpm
