#pragma once
// Emitters at work: which batches of particles are due, and what they are.

#include <string>
#include <vector>

#include "simulation/particle_state.hpp"

namespace mpm {

/// The experiment with the body of an emitter in the emitter's region alone, whose seeds are then a batch.
Experiment filled_by(const Experiment& experiment, const Emitter& emitter);

class Emitters {
 public:
  /// Fills each region once, to know its batch. `seeds` are those of the bodies without what is emitted.
  Emitters(const Experiment& experiment, const std::vector<SeededBody>& seeds);

  /// Adds the batches that are due at the start to the seeds.
  void begin(std::vector<SeededBody>& seeds);
  /// The largest speed of those at work between two times (s), m/s.
  double speed_between(double from, double until) const;
  /// Whether a batch is due that was not emitted yet.
  bool due(double time) const;
  /// Adds the batches that are due, each moved on by the way since then, and notes what stands in their way. Throws
  /// RunFailure where a body would have more particles than its emitter may give it.
  void emit(double time, const ParticleState& present, std::vector<Newcomers>& newcomers);

  /// Sentences about emitters that filled regions in which particles were left.
  std::vector<std::string> warnings() const;
  void save(ArchiveWriter& archive) const;
  void restore(ArchiveReader& archive);

 private:
  struct Source {
    const Emitter* emitter;
    Newcomers batch;             ///< of the region as it is drawn
    long emitted = 0;            ///< batches so far
    double occupied = 0;         ///< largest share of a batch's number that was in its way
    double first_occupied = -1;  ///< s, when much was for the first time; -1: never
  };
  Newcomers moved(const Source& source, double way) const;
  std::size_t count_inside(const Source& source, double way, const double* position, std::size_t count) const;
  void note(Source& source, std::size_t inside, double time) const;

  const Experiment& experiment_;
  const std::size_t dimension_;
  std::vector<Source> sources_;
};

}  // namespace mpm
