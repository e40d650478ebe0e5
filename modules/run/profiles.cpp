#include "run/profiles.hpp"

#include "output/checkpoint_file.hpp"
#include "support/files.hpp"

namespace mpm::app {

Profiles::Profiles(const Simulation& simulation, const Metrics& metrics, std::filesystem::path folder)
    : simulation_(simulation), metrics_(metrics), folder_(std::move(folder)) {
  for (const ProbeSpecification& probe : simulation.experiment().output.probes)
    if (probe.kind == ProbeKind::line) lines_.push_back({&probe, folder_ / (probe.name + ".csv")});
}

void Profiles::start() {
  if (lines_.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) throw support::MachineError::from_errno("create the folder", folder_, error.value());
  for (Line& line : lines_) line.csv.emplace(line.file, metrics_.chosen().profile(*line.probe).columns);
}

/// Profile k belongs to the first step at or after k / (profiles - 1) of the end time, as frames do.
bool Profiles::due(const Line& line, double time) const {
  const auto wanted = static_cast<std::size_t>(line.probe->profiles);
  const double next = wanted == 1 ? 0.0
                                  : simulation_.experiment().solver.end_time * static_cast<double>(line.taken) /
                                        static_cast<double>(wanted - 1);
  return line.taken < wanted && time >= next * (1 - 1e-12);
}

bool Profiles::due(double time) const {
  for (const Line& line : lines_)
    if (due(line, time)) return true;
  return false;
}

void Profiles::record() {
  for (Line& line : lines_) {
    if (!due(line, simulation_.time())) continue;
    write(line, metrics_.chosen().profile(*line.probe));
    ++line.taken;
  }
}

/// Writes all rows of a profile or, where the disk fails, none.
void Profiles::write(Line& line, const Profile& profile) {
  const std::size_t before = line.csv->bytes();
  try {
    for (const std::vector<double>& row : profile.rows) line.csv->row(row);
  } catch (const support::MachineError&) {
    line.csv.reset();
    support::cut_to(line.file, before);
    line.csv.emplace(line.file, profile.columns);
    throw;
  }
}

void Profiles::save(ArchiveWriter& archive) {
  for (Line& line : lines_) {
    line.csv->sync();
    archive.put("profiles_taken", line.taken);
    archive.put("profile_bytes", line.csv->bytes());
  }
}

void Profiles::check(ArchiveReader& archive) {
  for (Line& line : lines_) {
    archive.get("profiles_taken", line.taken);
    archive.get("profile_bytes", line.bytes);
    if (!support::holds_whole_lines(line.file, line.bytes))
      throw output::CheckpointDamaged(line.file, "does not hold the profiles written before the checkpoint");
  }
}

void Profiles::restore() {
  for (const Line& line : lines_) support::cut_to(line.file, line.bytes);
  start();
}

}  // namespace mpm::app
