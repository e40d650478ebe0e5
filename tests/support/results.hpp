// Everything a run leaves, to be compared bit by bit.
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "support/scene.hpp"

namespace mpm::test {

/// All results of a run: particles, ledgers, contact, filter, time. Without `with_host_state` the fields of the host
/// that have no member of their own are left out, for runs of which one carries more of them.
inline std::vector<double> all_results(const Simulation& simulation, bool with_host_state = true) {
  std::vector<double> all{simulation.time(), simulation.last_time_step()};
  const auto append = [&](const std::vector<double>& values) { all.insert(all.end(), values.begin(), values.end()); };
  const Backend& backend = simulation.backend();
  for (int body = 0; body < static_cast<int>(simulation.experiment().bodies.size()); ++body) {
    const BodyState state = backend.body_state(body);
    append(state.position), append(state.velocity), append(state.domain), append(state.corners);
    for (const auto* fields : {&state.transfer_state, &state.material_state, &state.host_state})
      if (fields != &state.host_state || with_host_state)
        for (const auto& [name, values] : *fields) append(values);
  }
  append(values_of(backend.ledger()));
  append(values_of(backend.heat_ledger()));
  const ContactRecord& c = backend.contact_record();
  append({c.force[0], c.force[1], c.force[2], static_cast<double>(c.nodes), static_cast<double>(c.sticking),
          c.largest_penetration, c.momentum_residual});
  const FilterRecord& f = backend.filter_record();
  append({static_cast<double>(f.iterations), f.first_norm, f.last_norm, f.largest_growth});
  return all;
}

/// Number of entries with different bits, NaN included.
inline std::size_t different(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return std::max(a.size(), b.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += std::memcmp(&a[i], &b[i], sizeof(double)) != 0;
  return count;
}

/// A run on the cpu backend with exactly this number of workers, however few its particles are.
class CpuRun {
 public:
  CpuRun(const std::string& text, const std::vector<std::string>& overrides, int threads)
      : experiment(experiment_from(text, overrides)),
        simulation(experiment, [threads](const Experiment& e, const Plan& plan, std::vector<SeededBody> bodies) {
          return make_cpu_backend(e, plan, std::move(bodies), threads);
        }) {}
  void steps(long count) {
    for (long k = 0; k < count; ++k) simulation.step();
  }
  const Experiment experiment;
  Simulation simulation;
};

}  // namespace mpm::test
