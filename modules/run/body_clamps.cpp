#include "run/body_clamps.hpp"

#include <algorithm>

#include "metrics/particle_quantities.hpp"

namespace mpm::app {

BodyClamps::BodyClamps(const Simulation& simulation) : simulation_(simulation) {
  const auto add = [&](int material, bool melted, const Plugin& plugin, const std::vector<double>& parameters) {
    ClampWatch watch(plugin, parameters);
    if (watch.is_waiting()) watched_.push_back({material, melted, std::move(watch)});
  };
  const Experiment& experiment = simulation.experiment();
  for (std::size_t k = 0; k < experiment.materials.size(); ++k) {
    const MaterialSpecification& material = experiment.materials[k];
    add(static_cast<int>(k), false, *material.component.plugin, material.component.parameters);
    if (material.thermal && material.thermal->phase_change)
      add(static_cast<int>(k), true, *material.component.plugin, material.thermal->phase_change->melted_parameters);
  }
}

void BodyClamps::look() {
  const Experiment& experiment = simulation_.experiment();
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
    const auto waits = [&](const Watched& watched) {
      return watched.material == experiment.bodies[body].material && watched.watch.is_waiting();
    };
    if (std::none_of(watched_.begin(), watched_.end(), waits)) continue;
    const BodyState state = simulation_.backend().body_state(body);
    for (Watched& watched : watched_)
      if (waits(watched)) look_for_clamps(experiment, body, state, watched.melted, simulation_.time(), watched.watch);
  }
}

std::vector<std::string> BodyClamps::warnings() const {
  std::vector<std::string> all;
  for (const Watched& watched : watched_)
    for (const std::string& text : watched.watch.warnings(simulation_.experiment().materials[watched.material].name))
      all.push_back(watched.melted ? "molten " + text : text);
  return all;
}

void BodyClamps::save(ArchiveWriter& archive) const {
  for (const Watched& watched : watched_)
    archive.put("clamps", std::vector<ClampWatch::Seen>(watched.watch.seen().begin(), watched.watch.seen().end()));
}

void BodyClamps::restore(ArchiveReader& archive) {
  for (Watched& watched : watched_) {
    std::vector<ClampWatch::Seen> seen;
    archive.get("clamps", seen);
    watched.watch.set_seen(seen);
  }
}

}  // namespace mpm::app
