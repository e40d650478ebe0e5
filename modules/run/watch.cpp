#include "run/watch.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "run/particle_cells.hpp"

namespace mpm::app {
namespace {

double length(const std::array<double, 3>& v) {
  return std::hypot(v[0], v[1], v[2]);
}

}  // namespace

const BodySpecification* finite_block(const Experiment& experiment) {
  if (!experiment.contact || experiment.contact_normal->plugin->id() != "average_volume_gradient") return nullptr;
  if (!experiment.shape.plugin->id().starts_with("bspline")) return nullptr;
  for (const BodySpecification& body : experiment.bodies) {
    if (body.takes_particles_in || std::isfinite(body.geometry->smallest_radius())) continue;
    const auto [lower, upper] = body.geometry->bounds();
    int free_axes = 0;
    for (int axis = 0; axis < experiment.dimension; ++axis) {
      const double margin = 0.5 * experiment.grid.cell_size;
      free_axes +=
          lower[axis] > experiment.grid.lower[axis] + margin && upper[axis] < experiment.grid.upper[axis] - margin;
    }
    if (free_axes == experiment.dimension) return &body;
  }
  return nullptr;
}

Watch::Watch(const Simulation& simulation)
    : simulation_(simulation),
      watches_(simulation.experiment().contact && !(simulation.experiment().contact->plugin->contact().traits &
                                                    (MPM_BYPASSES_DETECTION | MPM_COMPLIANT | MPM_READS_TRACTION))),
      watches_slide_(watches_ && simulation.experiment().field_count == 2 && finite_block(simulation.experiment())) {}

void Watch::look() {
  if (!watches_ || simulation_.steps() == 0) return;
  const ContactRecord& contact = simulation_.backend().contact_record();
  const double force = length(contact.force);
  // In a filter's loop contact acts once more after the nodes were counted.
  if (contact.nodes == 0 && !simulation_.plan().filters()) seen_.apart_force = std::max(seen_.apart_force, force);
  if (force > 0 && !seen_.met) {
    const double gap = gap_between_fields(simulation_);
    seen_.met = gap <= open_gap * simulation_.experiment().grid.cell_size;
    if (!seen_.met && force > seen_.early_force) seen_.early_force = force, seen_.early_gap = gap;
  }
  seen_.largest_force = std::max(seen_.largest_force, force);
  if (watches_slide_ && seen_.met && force > 0 && seen_.in_contact)
    seen_.slide += (simulation_.time() - seen_.time) * sliding_speed();
  seen_.in_contact = force > 0;
  seen_.time = simulation_.time();
}

/// The relative speed of the two fields across the direction of the force between them, m/s.
double Watch::sliding_speed() const {
  const Experiment& experiment = simulation_.experiment();
  const auto D = static_cast<std::size_t>(experiment.dimension);
  std::array<std::array<double, 3>, 2> momentum{};
  std::array<double, 2> mass{};
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
    const BodyState state = simulation_.backend().body_state(body);
    const auto field = static_cast<std::size_t>(experiment.bodies[body].field);
    for (std::size_t p = 0; p < state.velocity.size() / D; ++p) {
      const double m = state.mass * state.size_of(p);
      mass[field] += m;
      for (std::size_t c = 0; c < D; ++c) momentum[field][c] += m * state.velocity[p * D + c];
    }
  }
  std::array<double, 3> relative{}, normal = simulation_.backend().contact_record().force;
  double across = 0;
  const double size = length(normal);
  for (std::size_t c = 0; c < 3; ++c) {
    relative[c] = momentum[1][c] / mass[1] - momentum[0][c] / mass[0];
    across += relative[c] * normal[c] / size;
  }
  for (std::size_t c = 0; c < 3; ++c) relative[c] -= across * normal[c] / size;
  return length(relative);
}

}  // namespace mpm::app
