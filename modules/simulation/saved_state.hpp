#pragma once
// What a checkpoint holds of a backend is the same for all of them: a run that one has begun goes on in another. Only
// how a backend keeps its particles in memory is its own, and stands behind that.

#include <vector>

#include "simulation/backend.hpp"

namespace mpm {

/// What a backend has recorded so far.
struct SavedRecords {
  Ledger ledger;
  HeatLedger heat_ledger;
  ContactRecord contact;
  std::vector<PairRecord> contact_pairs;
  FilterRecord filter;
  std::vector<Reaction> reactions;
  std::vector<RigidState> rigid_bodies;
  TimeStepLimit limit;
};

/// Saves what the backend says of its records.
void save_records(ArchiveWriter& archive, const Backend& backend);
/// Reads the records for a backend of the same experiment and plan. Throws ArchiveError.
SavedRecords restore_records(ArchiveReader& archive, const Backend& backend);

/// Calls visit(field) for what later steps depend on of a body's particles, in the plan's order. The position is not
/// among them, as backends keep it in units of their own, nor the index of seeding, by which all of it is ordered.
template <class Visit>
void for_each_saved_field(const Plan& plan, int body, Visit visit) {
  for (const Field& field : plan.fields)
    if (field.of_particles_of(body) && field.lifetime == Lifetime::saved &&
        !(field.origin == Origin::host && (field.id == "position" || field.id == "identity")))
      visit(field);
}

/// Saves the particles of a body in the order of seeding, [particle][component]: `position` in m, and of each saved
/// field values(field), a vector of the experiment's precision in the plan's units (domains and corners in cells).
template <class Values>
void save_particles(ArchiveWriter& archive, const Plan& plan, int body, const std::vector<double>& position,
                    Values values) {
  archive.put("position", position);
  for_each_saved_field(plan, body, [&](const Field& field) { archive.put(field.id, values(field)); });
}

/// Restores what save_particles has saved of `count` particles: hands their positions to place(position), then every
/// field to take(field, values). Throws ArchiveError for another number, precision or list of fields.
template <class T, class Place, class Take>
void restore_particles(ArchiveReader& archive, const Plan& plan, int body, std::size_t count, std::size_t dimension,
                       Place place, Take take) {
  std::vector<double> position(count * dimension);
  archive.get("position", position.data(), position.size());
  place(position);
  for_each_saved_field(plan, body, [&](const Field& field) {
    std::vector<T> values(count * static_cast<std::size_t>(field.components));
    archive.get(field.id, values.data(), values.size());
    take(field, values);
  });
}

/// Saves how a backend keeps its particles in memory, whose sums depend on that: its own next part goes on bit for bit.
/// It stands before the particles. `name` says whose it is; a backend that keeps the order of seeding saves none.
void save_arrangement(ArchiveWriter& archive, const std::string& name = "", const std::vector<char>& bytes = {});
/// The arrangement that was saved under this name; empty where another backend wrote the state. Throws ArchiveError.
std::vector<char> restore_arrangement(ArchiveReader& archive, const std::string& name = "");

}  // namespace mpm
