#pragma once
// The particles of a backend as lists that can be edited: read from what it saves, and handed to a new backend that has
// as many as there are then.

#include <map>
#include <string>
#include <vector>

#include "simulation/backend.hpp"

namespace mpm {

/// Particles that are still to be seeded.
struct Newcomers {
  std::size_t count = 0;
  std::vector<double> position, velocity, initial_position;  ///< particle-major, m, m/s, m
  std::map<std::string, std::vector<double>> others;         ///< fields that start as seeded, by seed_key

  /// What one of both does not say of a field is zero.
  void append(const Newcomers& more);
};

class ParticleState {
 public:
  /// The particles of one body in the order of seeding, particle-major.
  struct OfBody {
    std::size_t count = 0;
    std::vector<double> position;             ///< m
    std::vector<double> initial_position;     ///< m; empty unless planned
    std::vector<std::vector<double>> fields;  ///< of each saved field of the plan, in its order and units

    /// Leaves out the particles that are marked.
    void remove(const std::vector<bool>& gone, std::size_t dimension);
  };

  ParticleState(const Experiment& experiment, const Plan& plan);

  /// Reads what a backend of the same experiment has saved. Throws ArchiveError.
  void read(ArchiveReader& archive, const Backend& backend);
  /// Reads the particles that a backend has now.
  void read(const Backend& backend);
  /// Saves in the layout of a backend: with the records of `records`, and no arrangement.
  void write(ArchiveWriter& archive, const Backend& records) const;

  std::vector<OfBody>& bodies() { return bodies_; }
  const std::vector<OfBody>& bodies() const { return bodies_; }
  /// The plan's saved fields of a body, in the order of OfBody::fields.
  const std::vector<const Field*>& fields(std::size_t body) const { return fields_[body]; }
  /// The number of the saved field with this origin and id; -1 where the body has none.
  int number(std::size_t body, Origin origin, const std::string& id) const;
  bool keeps_initial_position(std::size_t body) const { return keeps_initial_position_[body]; }

  /// What seeds a body with its particles, and then with newcomers. `of_start` says what a particle of size 1 is.
  SeededBody seeds(std::size_t body, const SeededBody& of_start, const Newcomers& newcomers) const;

 private:
  template <class T>
  void read_bodies(ArchiveReader& archive);
  template <class T>
  void write_bodies(ArchiveWriter& archive) const;

  const Experiment& experiment_;
  const Plan& plan_;
  const std::size_t dimension_;
  const bool single_;  ///< the backend saves floats
  std::vector<std::vector<const Field*>> fields_;
  std::vector<bool> keeps_initial_position_;
  std::vector<OfBody> bodies_;
};

}  // namespace mpm
