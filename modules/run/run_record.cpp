#include "run/run_record.hpp"

#include <algorithm>
#include <cmath>

namespace mpm::app {

RunRecord::RunRecord(const Simulation& simulation, const Metrics& metrics)
    : simulation_(simulation), latest_(metrics.initial()), watch_(simulation), clamps_(simulation), gases_(simulation) {
  extremes_.energy = metrics.initial().total_energy();
}

void RunRecord::take(const Totals& totals, std::span<const double> chosen) {
  latest_ = totals;
  extremes_.energy = std::max(extremes_.energy, totals.total_energy());
  extremes_.smallest_J = std::min(extremes_.smallest_J, totals.smallest_volume_ratio);
  extremes_.largest_J = std::max(extremes_.largest_J, totals.largest_volume_ratio);
  extremes_.momentum = std::max(extremes_.momentum, totals.momentum_scale);
  extremes_.angular_momentum = std::max(extremes_.angular_momentum, totals.angular_momentum_scale);
  const ContactRecord& contact = simulation_.backend().contact_record();
  const double force = std::hypot(contact.force[0], contact.force[1], contact.force[2]);
  extremes_.contact_force = std::max(extremes_.contact_force, force);
  if (std::isnan(extremes_.first_contact) && force > 0) extremes_.first_contact = totals.time;
  extremes_.penetration = std::max(extremes_.penetration, contact.largest_penetration);
  extremes_.contact_nodes = std::max(extremes_.contact_nodes, contact.nodes);
  if (chosen_.empty())
    for (const double value : chosen) chosen_.push_back({value, value, value, value});
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    Range& range = chosen_[k];
    range.latest = chosen[k];
    range.smallest = std::fmin(range.smallest, chosen[k]);
    range.largest = std::fmax(range.largest, chosen[k]);
  }
  watch_.look();
  clamps_.look();
  gases_.look();
}

void RunRecord::save(ArchiveWriter& archive) const {
  archive.put("latest", latest_);
  archive.put("extremes", extremes_);
  archive.put("chosen", chosen_);
  archive.put("seen", watch_.seen());
  clamps_.save(archive);
  gases_.save(archive);
}

void RunRecord::restore(ArchiveReader& archive) {
  archive.get("latest", latest_);
  archive.get("extremes", extremes_);
  archive.get("chosen", chosen_);
  archive.get("seen", watch_.seen());
  clamps_.restore(archive);
  gases_.restore(archive);
}

}  // namespace mpm::app
