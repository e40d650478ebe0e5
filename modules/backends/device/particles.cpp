#include "backends/device/device_backend.hpp"

#include <cmath>

namespace mpm::device {

template <class T>
void DeviceBackend<T>::estimate_time_step() {
  limit_ = {};
  for (std::size_t index = 0; index < bodies_.size(); ++index) {
    const Body<T>& body = bodies_[index];
    run_material("wave_speed", body);
    const std::size_t at = place(3);
    join("largest_speed", arguments_of(body), body.count, 3, at, 0, "largest_of_teams");
    results_.later([this, index, at](const double* sums) {
      const double *const found = sums + at, speed = found[0];
      if (speed > limit_.speed) limit_ = {speed, found[1], static_cast<int>(index), static_cast<std::size_t>(found[2])};
    });
  }
  look();
}

template <class T>
void DeviceBackend<T>::sort(const Body<T>& body) {
  const Arguments<T> a = arguments_of(body);
  const BlockArrays& blocks = body.blocks.table();
  if (!prepared_) find_blocks(body);
  launch("clear_counts", a, blocks.table);
  launch("count_particles", a, body.count);
  launch_teams("sum_chunks", a, body.blocks.chunks());
  launch_teams("scan_chunks", a, 1);
  launch_teams("number_blocks", a, body.blocks.chunks());
  launch("place_particles", a, body.count);
  launch_blocks("order_blocks", a, body);
  launch_teams("end_sort", a, 1);
}

template <class T>
void DeviceBackend<T>::scatter(const Pass& pass, const StepInfo& step) {
  const bool enters = pass.has(Act::scatter_momentum) && !pass.remap();  // the step begins
  const bool force = pass.has(Act::scatter_force);
  if (pass.remap()) for_each_field("clear", nodes(), {true});
  const bool heat = pass.has(Act::scatter_heat);
  const Tally<1> energy = tally<1>(), of_heat = tally<1>();
  const Tally<4> unbalanced = tally<4>();  // momentum and mass
  for (Body<T>& body : bodies_) {
    if (enters) sort(body);
    const bool asks = force || heat || pass.has(Act::scatter_contact);
    if (asks && !prepared_) run_material("stress", body);  // with the volume ratio
    Arguments<T> a = arguments_of(body);
    if (force && plan_.does(Act::average_mean_stress)) run("take_mean_stress", a, body, Checks::stencil);
    a.momentum = pass.has(Act::scatter_momentum), a.force = force;
    a.contact_fields = pass.has(Act::scatter_contact), a.remap = pass.remap();
    run_blocks("scatter", a, body);
    if (force) scatter_loads(body, a);
    if (heat) run_blocks("scatter_heat", a, body);
    if (enters && !experiment_.grips.empty()) scatter_grips(body);
    if (heat && plan_.has_heat_ledger()) sum_over_particles("heat_of_particles", body, of_heat);
    if (accounted_ && enters) sum_over_particles("energy_of_particles", body, energy);
    if (accounted_ && enters) sum<4>("momentum_of_particles", arguments_of(body), body.count, unbalanced);
  }
  if (heat) later([this, of_heat] { scattered_heat_ = (*of_heat)[0]; });
  if (!pass.has(Act::scatter_momentum)) return;
  for (VelocityField<T>& field : fields_)
    if (accounted_ && enters) sum<4>("momentum_of_nodes", arguments_of(field, {}), nodes(), unbalanced, -1);
  if (enters && experiment_.has_gravity()) {
    const Vector3 gravity = experiment_.gravity_at(step.time);
    for (std::size_t c = 0; c < 3; ++c) scene_.gravity[c] = static_cast<T>(gravity[c]);
    for_each_field("weigh", nodes());
  }
  for_each_axis("fold_masses", images_, {pass.remap()});
  if (!enters) return;
  if (folds_forces_) for_each_axis("fold_forces", images_);
  if (!accounted_) return;
  const Tally<1> scattered = sum_over_nodes("energy_of_momenta");
  later([this, energy, unbalanced, scattered] {
    const auto [x, y, z, mass] = *unbalanced;
    scattered_energy_ = (*scattered)[0];
    ledger_.scatter += scattered_energy_ - (*energy)[0];
    ledger_.mass_book += mass;
    ledger_.momentum_book += std::hypot(x, y, z);
    works_ = 0;
  });
}

/// Its parts have the numbers that they would have as launches: of each body gather and strain, and then all moves.
template <class T>
void DeviceBackend<T>::advance(const StepInfo& step) {
  const int before = launches_, count = static_cast<int>(bodies_.size());
  for (int b = 0; b < count; ++b) {
    const Body<T>& body = bodies_[static_cast<std::size_t>(b)];
    Arguments<T> a = arguments_of(body);
    a.update_particles = true, a.filtered = step.filtered;
    a.moves_by_mean = experiment_.filter_schedule.moves_by_mean;
    a.part_of_move = 2 * count - b;
    launches_ = before + 2 * b;
    launch("advance_" + std::to_string(body.material_number), a, body.count);
    watch(body, Checks::stencil);
    watch(body, Checks::deformation, part_of_strain);
    watch(body, Checks::position, a.part_of_move);
  }
  launches_ = before + 3 * count;
  prepared_ = true;
}

template <class T>
void DeviceBackend<T>::gather(const Pass& pass, const StepInfo& step) {
  if (plan_.advance != Advance::apart && !accounted_) return advance(step);
  prepared_ = false;
  if (accounted_ && step.filtered) {
    if (pass.has(Act::strain)) book_strain(&Ledger::filtered_strain, pass.share);
    const Tally<2> power = power_of_forces();
    later([this, power] { ledger_.filtered_gravity -= (*power)[1] - lumped_power_[1]; });
  }
  const Tally<1> energy = tally<1>(), heat = tally<1>(), gripped = tally<1>();
  for (Body<T>& body : bodies_) {
    Arguments<T> a = arguments_of(body);
    a.update_particles = true, a.filtered = step.filtered;
    a.moves_by_mean = experiment_.filter_schedule.moves_by_mean;
    run("gather", a, body, Checks::stencil);
    if (!experiment_.grips.empty()) note_gripped(body, step, gripped);
    if (pass.has(Act::gather_heat)) run("gather_heat", a, body, Checks::temperature);
    if (pass.has(Act::gather_heat) && plan_.has_heat_ledger()) sum_over_particles("heat_of_particles", body, heat);
    if (accounted_) sum_over_particles("energy_of_particles", body, energy);  // weights are still those of the step
    if (pass.has(Act::strain)) run_strain(pass, body);
  }
  if (accounted_)
    later([this, energy, gripped] {
      ledger_.gather += (*energy)[0] - energy_after_ - (*gripped)[0];
      ledger_.boundary += (*gripped)[0];
      ledger_.grid_book += energy_after_ - scattered_energy_ - works_;
      energy_before_move_ = (*energy)[0];
    });
  if (pass.has(Act::gather_heat) && plan_.has_heat_ledger())
    later([this, heat] { heat_ledger_.gather += (*heat)[0] - heat_after_; });
  if (pass.has(Act::move)) move();
  if (pass.has(Act::change_phase)) change_phase();
}

template <class T>
void DeviceBackend<T>::strain(const Pass& pass) {
  if (accounted_ && pass.remap()) book_strain(&Ledger::remapped_strain, pass.share);
  if (pass.stage == Stage::before_forces) early_share_ = pass.share;
  scene_.records = accounted_;
  prepared_ = false;
  for (Body<T>& body : bodies_) {
    run("gather", arguments_of(body), body, Checks::stencil);
    run_strain(pass, body);
  }
}

template <class T>
void DeviceBackend<T>::move() {
  for (Body<T>& body : bodies_) run("move", arguments_of(body), body, Checks::position);
  if (!accounted_) return;
  const Tally<1> energy = energy_of_particles();
  later([this, energy] { ledger_.second_moment += (*energy)[0] - energy_before_move_; });
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device
