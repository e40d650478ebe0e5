#include "run/rim_steps.hpp"

#include <cmath>
#include <limits>

#include "support/numbers.hpp"

namespace mpm::app {

std::string warning_of_rim_steps(const Experiment& experiment) {
  if (!experiment.contact || experiment.contact->plugin->contact().traits & MPM_BYPASSES_DETECTION) return "";
  const BodySpecification* coarsest = nullptr;
  double fewest = std::numeric_limits<double>::infinity();
  for (const BodySpecification& body : experiment.bodies) {
    const SeedingKind kind = body.seeding.kind;
    if (kind != SeedingKind::lattice && kind != SeedingKind::fitted) continue;  // others have no rows
    const double rows = body.geometry->smallest_radius() * body.particles_per_cell_axis / experiment.grid.cell_size;
    if (rows < fewest) fewest = rows, coarsest = &body;
  }
  if (coarsest == nullptr || fewest >= enough_rows_a_radius) return "";
  const double radius = coarsest->geometry->smallest_radius(), step = radius / fewest;
  return "the curved surface of body \"" + coarsest->name + "\" (radius " + support::three_digits(radius) +
         " m) is built of steps of " + support::three_digits(step) +
         " m, one particle's spacing: where it touches, a contact less than " +
         support::three_digits(2 * std::sqrt(2 * radius * step)) +
         " m wide feels single steps, which change its peak force by up to a third and the rolling of a wheel by some "
         "per cent; take particles " +
         support::three_digits(enough_rows_a_radius / fewest) +
         " times as close, by /grid/cell_size or particles_per_cell_axis (docs/contact.md)";
}

}  // namespace mpm::app
