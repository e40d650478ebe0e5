#include "backends/device/device_backend.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "backends/device/compose.hpp"
#include "backends/device/kernels/rigid.hpp"

namespace mpm::device {

template <class T>
Arguments<T> DeviceBackend<T>::pair_arguments(std::size_t a, std::size_t b, Stage stage, bool notes) const {
  const int first = static_cast<int>(a), second = static_cast<int>(b);
  Arguments<T> arguments = scene_;
  arguments.grid = fields_[a].table(), arguments.other = fields_[b].table();
  arguments.grips = fields_[a].grips.data(), arguments.other_grips = fields_[b].grips.data();
  arguments.grip_count = static_cast<int>(experiment_.grips.size());
  arguments.rigid.mass = std::numeric_limits<double>::infinity();  // as laws see what a grip holds
  arguments.edges[0] = edges_.of(a), arguments.edges[1] = edges_.of(b);
  arguments.after_forces = stage == Stage::after_forces;
  if (contact_sight_) arguments.seen = contact_sight_->of(first, second);
  if (notes) arguments.noted = contact_notes_->of(first, second);
  if (!welds_.empty()) arguments.welds = welds_[pair_index(first, second, experiment_.field_count)].data();
  return arguments;
}

template <class T>
void DeviceBackend<T>::keep_contact_state() {
  for (Body<T>& body : bodies_) run("keep_contact_state", arguments_of(body), body, Checks::stencil);
}

/// Positions do not move within a step: what is found before the forces holds for all of it.
template <class T>
void DeviceBackend<T>::look_at_particles() {
  if (experiment_.shape.plugin->shape().form == MPM_NODE_LIST) {
    contact_sight_->forget_reach();
    contact_sight_->for_each_body([&](std::size_t body, const SeenParticles<T>& seen) {
      Arguments<T> arguments = arguments_of(bodies_[body]);
      arguments.seen = seen;
      launch("find_reach", arguments, bodies_[body].count);
    });
  }
  for (std::size_t a = 0; a < fields_.size(); ++a)
    for (std::size_t b = a + 1; b < fields_.size(); ++b) {
      const Arguments<T> arguments = pair_arguments(a, b, Stage::before_forces, false);
      contact_sight_->forget_nodes();
      launch("find_meeting_nodes", arguments, nodes());
      launch_teams("look_at_particles", arguments, contact_sight_->teams());
    }
}

template <class T>
void DeviceBackend<T>::resolve_contact(const StepInfo& step, Recorded recorded, Stage stage, double time) {
  if (contact_sight_ && recorded == Recorded::before_forces) look_at_particles();
  const auto given = std::make_shared<ContactGiven>();
  const Tally<3> unbalanced = tally<3>();
  const bool after_forces = recorded == Recorded::after_forces;
  later([this, given, after_forces] {
    *given = {};
    if (after_forces) contact_ = {};
  });
  const bool notes = records_nodes(experiment_, step);
  const auto visit_pairs = [&](auto&& visit) {
    for (std::size_t a = 0; a < fields_.size(); ++a)
      for (std::size_t b = a + 1; b < fields_.size(); ++b) visit(pair_arguments(a, b, stage, notes));
  };
  if (experiment_.measures_traction())
    visit_pairs([&](const Arguments<T>& arguments) { launch("measure_welds", arguments, nodes()); });
  visit_pairs([&](Arguments<T> arguments) {
    arguments.first_step = step.step == 0, arguments.notes_reached = after_forces;
    const std::size_t at = place(contact_sums);
    join("contact", arguments, nodes(), contact_sums, at, contact_maxima);
    results_.later([this, at, given, unbalanced, after_forces](const double* sums) {
      const double* const found = sums + at;
      for (std::size_t c = 0; c < 3; ++c) (*unbalanced)[c] += found[contact_unbalanced + c];
      take_pair(found, *given, after_forces);
    });
  });
  if (notes) {
    look();
    contact_notes_->read(given->nodes);
  }
  meet_rigid_bodies(time, given, stage, /*record=*/after_forces);
  Ledger* const ledger = scene_.records ? &ledger_ : nullptr;
  later([this, recorded, given, ledger, filtered = step.filtered] {
    if (recorded == Recorded::before_forces) contact_impulse_.before_forces(*given, filtered, ledger);
    if (recorded == Recorded::filter)
      contact_impulse_.in_filter(*given, plan_.node_field("velocity_of_constraints") != nullptr, ledger);
    if (recorded != Recorded::after_forces) return;
    contact_impulse_.after_forces(*given, ledger);
    contact_impulse_.record_counts(*given);
  });
  if (!after_forces) return;
  record_force(step);
  later([this, unbalanced] {
    const auto [x, y, z] = *unbalanced;
    contact_.momentum_residual = std::hypot(x, y, z);
  });
}

template <class T>
void DeviceBackend<T>::meet_rigid_bodies(double time, const std::shared_ptr<ContactGiven>& all, Stage stage,
                                         bool record) {
  for (std::size_t body = 0; body < rigid_.bodies().count(); ++body) {
    const RigidArrays rigid = rigid_.of(body, time);
    for (std::size_t field = 0; rigid.count > 0 && field < fields_.size(); ++field) {
      Arguments<T> arguments = arguments_of(fields_[field], {});
      arguments.edges[0] = edges_.of(field), arguments.rigid = rigid;
      arguments.after_forces = stage == Stage::after_forces;
      arguments.contact_parameters = rigid_.parameters(body);
      const std::size_t at = place(rigid_sums);
      join("rigid_contact_" + std::to_string(number_of_law(experiment_, body)), arguments,
           static_cast<int>(rigid.count), rigid_sums, at, 1);
      results_.later([this, at, all, record, notes = notes_reactions_,
                      support = experiment_.support_of_rigid_body(body)](const double* sums) {
        const double* const found = sums + at;
        RigidGiven given{{found[0], found[1], found[2]},
                         {found[rigid_moment], found[rigid_moment + 1], found[rigid_moment + 2]},
                         found[rigid_dissipated],
                         found[rigid_driven],
                         std::lround(found[rigid_sticking]),
                         std::lround(found[rigid_slipping]),
                         found[rigid_penetration]};
        all->dissipated += given.dissipated, all->driven += given.driven;
        if (notes) reactions_.add(GivenBySupport::held, support, given.impulse, given.moment);
        if (record) given.add_to(contact_);
      });
    }
  }
}

template <class T>
void DeviceBackend<T>::take_pair(const double* sums, ContactGiven& given, bool record) {
  PairGiven pair;
  for (std::size_t c = 0; c < 3; ++c)
    pair.impulse[c] = sums[contact_impulse + c], pair.along[c] = sums[contact_along + c],
    pair.unbalanced[c] = sums[contact_unbalanced + c];
  pair.pressing = sums[contact_pressing];
  pair.sticking = std::lround(sums[contact_sticking]), pair.slipping = std::lround(sums[contact_slipping]);
  pair.area = sums[contact_touching], pair.largest_penetration = sums[contact_penetration];
  pair.largest_gap = sums[contact_gap];
  for (std::size_t c = 0; c < 3; ++c) given.impulse[c] += pair.impulse[c];
  given.dissipated += sums[contact_dissipated], given.stored += sums[contact_stored];
  if (!contact_impulse_.pairs().empty()) given.pairs.push_back(pair);
  if (!record) return;
  contact_.sticking += pair.sticking, contact_.slipping += pair.slipping;
  contact_.nodes += pair.sticking + pair.slipping;
  contact_.largest_penetration = std::max(contact_.largest_penetration, pair.largest_penetration);
}

template <class T>
void DeviceBackend<T>::record_force(const StepInfo& step) {
  later([this, filtered = step.filtered, dt = step.dt] {
    const Vector3 impulse = contact_impulse_.handed_over(filtered);
    for (std::size_t c = 0; c < 3; ++c) contact_.force[c] = impulse[c] / dt;
    contact_impulse_.record_forces(filtered, dt);
  });
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device
