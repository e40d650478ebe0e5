#pragma once
// Emitters, sinks and changes of material between the steps of a run. They are rare: where something is due, the state
// that the backend saves is edited and handed to a new backend, so that no backend and no kernel knows of them.

#include <memory>
#include <string>
#include <vector>

#include "metrics/totals.hpp"
#include "simulation/emitters.hpp"
#include "simulation/particle_state.hpp"

namespace mpm {

/// What particles brought, took or changed since the run began, as metrics count it.
struct Exchange {
  double particles = 0;
  double mass = 0;     ///< kg
  double energy = 0;   ///< J, kinetic, stored and potential
  double heat = 0;     ///< J, heat content and latent heat
  Vector3 momentum{};  ///< kg m/s

  void add(const Totals& totals, double count, double sign = 1);
};

class ParticleChanges {
 public:
  /// Adds what is emitted at the start to the seeds; of that no book is kept, as it is there from the start. Throws
  /// InputError.
  ParticleChanges(const Experiment& experiment, const Plan& plan, std::vector<SeededBody>& seeds);

  /// Whether anything may change after the step that ends at `time` (s), the run's `steps`-th.
  bool due(double time, long steps) const;
  /// The largest speed, m/s, at which anything is emitted between two times, s.
  double emitted_speed(double from, double until) const { return emitters_.speed_between(from, until); }
  /// Makes the changes that are due. Returns the backend that goes on, or null where no particle has changed. Throws
  /// RunFailure, and then nothing has been counted.
  std::unique_ptr<Backend> make(const Backend& backend, const BackendFactory& make_backend, double time, long steps);

  const Exchange& emitted() const { return emitted_; }
  const Exchange& removed() const { return removed_; }
  /// Momentum and mass stay; energy and heat are what they gained.
  const Exchange& changed() const { return changed_; }
  Ledger ledger() const;
  HeatLedger heat_ledger() const;
  std::vector<std::string> warnings() const { return emitters_.warnings(); }

  void save(ArchiveWriter& archive, const Backend& backend) const;
  /// Reads what `save` has saved, and returns a backend with as many particles as the archive goes on with: it is to be
  /// restored from there. Throws ArchiveError.
  std::unique_ptr<Backend> restore(ArchiveReader& archive, const Backend& begun, const BackendFactory& make_backend);

 private:
  struct Work;
  void take_out(Work& work);
  void change_materials(Work& work);
  void stop_beyond_memory(const Work& work) const;
  void build(Work& work, const BackendFactory& make_backend);
  Totals totals_of(const Backend& backend, int body, const std::vector<std::size_t>& particles) const;
  std::unique_ptr<Backend> backend_for(const ParticleState& state, const std::vector<Newcomers>& newcomers,
                                       const BackendFactory& make_backend) const;

  const Experiment& experiment_;
  const Plan& plan_;
  std::vector<SeededBody> of_start_;  ///< volume and mass of a particle of size 1
  Emitters emitters_;
  Exchange emitted_, removed_, changed_;
};

}  // namespace mpm
