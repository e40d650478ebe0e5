// Scenes in which particles come, go, and change their material on the way, for comparisons of backends.
#pragma once

#include "parity/parity.hpp"

namespace mpm::test {

/// A mix with an emitter of the first body, a sink of the second one, and particles of the first that go over to it. In
/// 14 steps of 0.009 s batches come at the start and after 0.05 s and 0.1 s; sinks look after 5 and 10 steps.
inline Mix with_particle_changes(Mix mix) {
  const bool flat = mix.dimension == 2;
  mix.more += std::string(R"(, "emitters": [{"body": "a", "geometry": {"type": "box", "lower": )") +
              (flat ? "[0.1, 0.7], \"upper\": [0.3, 0.8]}, \"velocity\": [4, 0.5]}]"
                    : "[0.1, 0.4, 0.1], \"upper\": [0.3, 0.5, 0.3]}, \"velocity\": [4, 0, 0.5]}]") +
              R"(, "sinks": [{"body": "b", "every_steps": 5, "geometry": {"type": "box", "lower": )" +
              (flat ? "[0.7, 0.1], \"upper\": [0.94, 0.33]}}]" : "[0.5, 0, 0], \"upper\": [0.7, 0.2, 0.6]}}]");
  mix.overrides.push_back(
      R"(/bodies/0/becomes={"body": "b", "when": {"quantity": "position_x", "above": 0.4712}, "every_steps": 4})");
  return mix;
}

}  // namespace mpm::test
