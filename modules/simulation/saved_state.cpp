#include "simulation/saved_state.hpp"

namespace mpm {
namespace {

/// Reads as many values as the backend has of them.
template <class Record>
std::vector<Record> get_all(ArchiveReader& archive, const char* tag, const std::vector<Record>& present) {
  std::vector<Record> records(present.size());
  archive.get(tag, records.data(), records.size());
  return records;
}

}  // namespace

void save_records(ArchiveWriter& archive, const Backend& backend) {
  const TimeStepLimit limit = backend.time_step_limit();
  archive.put("ledger", backend.ledger());
  archive.put("heat_ledger", backend.heat_ledger());
  archive.put("contact", backend.contact_record());
  archive.put("contact_pairs", backend.contact_pairs());
  archive.put("filter", backend.filter_record());
  archive.put("reactions", backend.reactions());
  archive.put("rigid_bodies", backend.rigid_bodies());
  archive.put("speed", limit.speed);
  archive.put("wave_speed", limit.wave_speed);
  archive.put("limiting_body", limit.body);
  archive.put("limiting_particle", limit.particle);
}

SavedRecords restore_records(ArchiveReader& archive, const Backend& backend) {
  SavedRecords records;
  archive.get("ledger", records.ledger);
  archive.get("heat_ledger", records.heat_ledger);
  archive.get("contact", records.contact);
  records.contact_pairs = get_all(archive, "contact_pairs", backend.contact_pairs());
  archive.get("filter", records.filter);
  records.reactions = get_all(archive, "reactions", backend.reactions());
  records.rigid_bodies = get_all(archive, "rigid_bodies", backend.rigid_bodies());
  archive.get("speed", records.limit.speed);
  archive.get("wave_speed", records.limit.wave_speed);
  archive.get("limiting_body", records.limit.body);
  archive.get("limiting_particle", records.limit.particle);
  return records;
}

void save_arrangement(ArchiveWriter& archive, const std::string& name, const std::vector<char>& bytes) {
  archive.put("arranged_by", name);
  archive.put("arrangement", bytes);
}

std::vector<char> restore_arrangement(ArchiveReader& archive, const std::string& name) {
  std::string arranged_by;
  std::vector<char> bytes;
  archive.get("arranged_by", arranged_by);
  archive.get("arrangement", bytes);
  return arranged_by == name ? bytes : std::vector<char>();
}

}  // namespace mpm
