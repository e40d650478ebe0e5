#include "backends/reference/reference_backend.hpp"

#include "simulation/saved_state.hpp"

#include <cmath>

#include "backends/libraries/backend_library.hpp"
#include "kernel/corner_domain.hpp"

namespace mpm {
namespace reference {

ReferenceBackend::ReferenceBackend(const Experiment& experiment, const Plan& plan,
                                   const std::vector<SeededBody>& seeded)
    : experiment_(experiment), plan_(plan), grid_(experiment, plan), impulse_(experiment), reactions_(experiment) {
  for (std::size_t body = 0; body < seeded.size(); ++body) {
    bodies_.emplace_back(experiment, plan, static_cast<int>(body), seeded[body]);
    loads_.emplace_back(experiment, static_cast<int>(body), seeded[body]);
  }
  for (const ExternalForce kind : external_forces)
    if (plan.node_field(field_of(kind)))
      external_forces_.push_back({kind, &grid_.vector(field_of(kind)), row_of(kind)});
}

void ReferenceBackend::execute(const Pass& pass, const StepInfo& step) {
  const Act act = pass.operators.front().act;
  accounted_ = plan_.accounts_at(step.step);
  // What a filter does before the forces is undone again.
  records_ = accounted_ && (pass.stage == Stage::after_forces || (act == Act::divide && !pass.remap()));
  notes_reactions_ = reactions_.asked() && !pass.remap();
  grid_.note_in(notes_reactions_ ? &reactions_ : nullptr);
  switch (act) {
    case Act::estimate_time_step:
      return estimate_time_step();
    case Act::sort:
    case Act::sort_ahead:
      return;  // particles stay in the order of seeding
    case Act::clear:
      return grid_.reset();
    case Act::scatter_momentum:
    case Act::scatter_force:
      return scatter(pass, step);
    case Act::divide:
      return momentum_to_velocity(pass, step);
    case Act::accelerate:
      return apply_forces(step);
    case Act::divide_heat:
      return divide_heat(step);
    case Act::conduct:
      return conduct();
    case Act::heat:
      return heat(step);
    case Act::change_phase:
      return change_phase();
    case Act::keep_contact_state:
      return keep_contact_state();
    case Act::gather:
      return gather(pass, step);
    case Act::scatter_mean_stress:
      return scatter_mean_stress();
    case Act::average_mean_stress:
      return average(volume_stress_, stressed_volume_, mean_stress_);
    case Act::scatter_dilation:
      return scatter_dilation(pass, step);
    case Act::average_dilation:
      return average(volume_rate_, strained_volume_, dilation_);
    case Act::strain:
      return strain(pass, step);
    case Act::move:
      return move(step);
    case Act::begin_filter:
      return begin_filter(pass);
    case Act::project:
      return project(pass, step);
    case Act::update_filter:
      return update_filter(pass, step);
    case Act::end_filter:
      return end_filter(pass, step);
    case Act::restore_velocity:
      return restore_velocity(pass, step);
    case Act::add_correction:
      return add_correction(pass, step);
    default:  // the other acts share a visit with one of these
      throw std::logic_error("the reference backend does not execute pass \"" + pass.name() + "\"");
  }
}

std::uint64_t ReferenceBackend::particle_bytes() const {
  std::uint64_t sum = 0;
  for (const Particles& body : bodies_) sum += body.bytes();
  return sum;
}

void ReferenceBackend::estimate_time_step() {
  limit_ = {};
  for (Particles& body : bodies_) {
    const TimeStepLimit candidate = body.time_step_limit();
    if (candidate.speed > limit_.speed) limit_ = candidate;
  }
}

void ReferenceBackend::move(const StepInfo& step) {
  const double energy = accounted_ ? particle_kinetic_energy() : 0.0;
  for (std::size_t index = 0; index < bodies_.size(); ++index) {
    Particles& body = bodies_[index];
    if (body.frozen()) continue;
    for (std::size_t p = 0; p < body.count(); ++p) {
      Vector x = body.column(body.position, p);
      if (plan_.sample_points == 0)
        x += step.dt * body.column(body.advection, p);
      else
        x += experiment_.dimension == 2 ? move_corners<2>(body, static_cast<int>(index), p)
                                        : move_corners<3>(body, static_cast<int>(index), p);
      keep_inside(x, static_cast<int>(index), p);
      body.set(body.position, p, x);
    }
    body.pad(body.position);
    if (plan_.sample_points > 0) body.pad(body.values("corners"));
  }
  if (!accounted_) return;
  for (Particles& body : bodies_) body.find_second_moments();
  ledger_.second_moment += particle_kinetic_energy() - energy;
}

/// Moves the corners to where the grid's velocity takes them; returns the way to their domain's centroid, m.
template <int D>
Vector ReferenceBackend::move_corners(Particles& body, int index, std::size_t p) const {
  constexpr int points = 1 << D;
  Array& corners = body.values("corners");
  const Array& moved = body.values("moved_corners");
  Vec<D, double> corner[points];
  for (int c = 0; c < points; ++c)
    for (int a = 0; a < D; ++a) corner[c][a] = moved(c * D + a, p);
  const CornerDomain<D, double> domain = corner_domain<D, double>(corner);
  if (!domain.upright && std::isfinite(domain.volume))  // keep_inside reports what is not a number
    throw RunFailure({Cause::domain_inside_out, index, p});
  const Vec<D, double> centre = centroid(domain, corner);
  Vector way = Vector::Zero();
  for (int a = 0; a < D; ++a) {
    way[a] = experiment_.grid.cell_size * centre[a];
    for (int c = 0; c < points; ++c) corners(c * D + a, p) = corner[c][a] - centre[a];
  }
  return way;
}

void ReferenceBackend::keep_inside(Vector& x, int body, std::size_t p) const {
  const GridSpecification& grid = experiment_.grid;
  for (int c = 0; c < experiment_.dimension; ++c) {
    const double size = grid.upper[c] - grid.lower[c];
    if (!std::isfinite(x[c])) throw RunFailure({Cause::position_not_a_number, body, p, c, x[c]});
    if (c == 0 && experiment_.axisymmetric() && !(x[0] > 0)) throw RunFailure({Cause::reached_axis, body, p, c, x[c]});
    if (experiment_.faces[c][0].type == ConditionType::periodic) {
      x[c] -= size * std::floor((x[c] - grid.lower[c]) / size);
      continue;
    }
    for (int side = 0; side < 2; ++side) {
      // A separating wall lets the stencil's edge through: half a cell.
      const double margin =
          experiment_.faces[c][side].type == ConditionType::separate ? 0.5 * grid.cell_size : 1e-9 * size;
      if (side == 0 ? x[c] >= grid.lower[c] - margin : x[c] <= grid.upper[c] + margin) continue;
      throw RunFailure({Cause::left_domain, body, p, c, x[c]});
    }
  }
}

// ---- saving: the grid is scattered again --------------------------------------------------------------------------

void ReferenceBackend::save(ArchiveWriter& archive) const {
  save_records(archive, *this);
  save_arrangement(archive);
  for (const Particles& body : bodies_) body.save(archive);
}

void ReferenceBackend::restore(ArchiveReader& archive) {
  SavedRecords records = restore_records(archive, *this);
  ledger_ = records.ledger, heat_ledger_ = records.heat_ledger;
  contact_ = records.contact, impulse_.pairs() = std::move(records.contact_pairs);
  filter_ = records.filter, limit_ = records.limit;
  reactions_.resume(std::move(records.reactions)), rigid_.resume(std::move(records.rigid_bodies));
  restore_arrangement(archive);  // particles keep the order of seeding
  for (Particles& body : bodies_) body.restore(archive);
}

/// What the library of the backend makes.
// NOLINTNEXTLINE(performance-unnecessary-value-param): one signature for all backends
std::unique_ptr<Backend> make(BackendRequest request) {
  return std::make_unique<ReferenceBackend>(request.experiment, request.plan, request.bodies);
}

}  // namespace reference
}  // namespace mpm
