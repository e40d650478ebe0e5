#pragma once
// This part of GridStep lets velocity fields meet: pairs of a slot in batches, pair after pair, so three act in order.

#include <array>
#include <limits>
#include <vector>

#include "backends/cpu/grid/grid_step.hpp"
#include "operators/contact.hpp"

namespace mpm::cpu {

/// The sums that the pairs of one slot add to the ledger and the record.
template <int D, class T>
struct GridStep<D, T>::ContactSums {
  double friction = 0, stored = 0, largest_penetration = 0;
  double impulse[3]{}, change[3]{};
  long sticking = 0, slipping = 0;
  PairGiven* pairs = nullptr;  ///< one a pair of fields, where they are recorded apart
  std::vector<NodeGiven> nodes;
};

template <int D, class T>
struct GridStep<D, T>::ContactBatch {
  int count = 0;
  std::uint32_t node[block_nodes];
  bool valid[block_nodes];
  alignas(64) T mass_a[block_nodes], mass_b[block_nodes], separation[block_nodes], area[block_nodes],
      dissipated[block_nodes];
  alignas(64) T momentum_a[D * block_nodes],
      momentum_b[D * block_nodes], normal[D * block_nodes], impulse[D * block_nodes];
  // Where each body has a normal of its own, `normal` is that of a, and these are of b.
  alignas(64) T normal_of_b[D * block_nodes], impulse_of_b[D * block_nodes], dissipated_of_b[block_nodes];
  alignas(64) std::int32_t status_of_b[block_nodes];
  alignas(64) T traction[D * block_nodes];  // for laws that read it
  // These are for laws with springs.
  alignas(64) T displacement[D * block_nodes], stored[block_nodes], stored_of_b[block_nodes];
  alignas(64) std::int32_t status[block_nodes];
  // These are for laws with a state.
  static constexpr int state_values = MPM_CONTACT_STATES * block_nodes;
  alignas(64) T state_a[state_values], state_b[state_values], gained_a[state_values], gained_b[state_values];
  alignas(64) T reached[state_values], reached_of_b[state_values];

  /// Lets the law see the last pair as one of which a grip holds a body as a whole.
  void hold(bool holds_a, const Quad<T>& a, const Quad<T>& b) {
    const int last = count - 1;
    const T mass = mass_beside_held(holds_a, T(a[3]), T(b[3]));
    mass_a[last] = mass, mass_b[last] = std::numeric_limits<T>::infinity();
    for (int c = 0; c < D; ++c) {
      momentum_a[c * block_nodes + last] = momentum_beside(T(a[c]), T(b[c]), mass);
      momentum_b[c * block_nodes + last] = 0;
    }
  }
  void add(std::uint32_t at, const Quad<T>& a, const Quad<T>& b, const ContactGeometry& geometry, bool own) {
    const double* const of_a = own ? geometry.own_a : geometry.normal;
    node[count] = at;
    valid[count] = geometry.valid;
    mass_a[count] = a[3], mass_b[count] = b[3];
    separation[count] = static_cast<T>(geometry.separation), area[count] = static_cast<T>(geometry.area);
    for (int c = 0; c < D; ++c) {
      momentum_a[c * block_nodes + count] = momentum_of(a[c], a[3]);
      momentum_b[c * block_nodes + count] = momentum_of(b[c], b[3]);
      normal[c * block_nodes + count] = geometry.valid ? static_cast<T>(of_a[c]) : T(0);
      if (own) normal_of_b[c * block_nodes + count] = static_cast<T>(geometry.own_b[c]);
    }
    ++count;
  }
  /// Says of the last pair how far b has moved beside a.
  void displace(const ContactFieldNode& a, const ContactFieldNode& b) {
    for (int c = 0; c < D; ++c)
      displacement[c * block_nodes + count - 1] = static_cast<T>(displacement_of_pair(a, b, c));
  }
  /// Says of the last pair what particles keep, and what they have gained, as means by mass.
  void keep(const ContactField& a, const ContactField& b, std::uint32_t at, int states) {
    for (int k = 0; k < states; ++k) {
      const int i = k * block_nodes + count - 1;
      state_a[i] = a.state[at][k] / a.motion[at][3], gained_a[i] = a.gain[at][k] / a.motion[at][3];
      state_b[i] = b.state[at][k] / b.motion[at][3], gained_b[i] = b.gain[at][k] / b.motion[at][3];
    }
  }
  /// What a weld would give a pair.
  WeldOfPair weld(int i) const {
    WeldOfPair weld;
    weld.area = area[i];
    for (int c = 0; c < D; ++c) {
      const T p_a = momentum_a[c * block_nodes + i], p_b = momentum_b[c * block_nodes + i];
      weld.impulse[c] = welding_impulse(p_a / mass_a[i], p_b / mass_b[i], mass_a[i], mass_b[i]);
    }
    return weld;
  }
  /// Says which traction would hold a pair together.
  void set_traction(int i, const WeldOfPair& welds, double dt) {
    for (int c = 0; c < D; ++c) traction[c * block_nodes + i] = static_cast<T>(welds.traction(c, dt));
  }
  /// Takes the share of each impulse that changes no velocity by more than `most`, m/s.
  void cap(T most) {
    for (int i = 0; i < count; ++i) {
      T square = 0, across = 0, sliding = 0, approach = 0;
      for (int at = i; at < D * block_nodes; at += block_nodes) {
        const T velocity = momentum_a[at] / mass_a[i] - momentum_b[at] / mass_b[i];
        square += impulse[at] * impulse[at], across += impulse[at] * normal[at];
        sliding += impulse[at] * velocity, approach += normal[at] * velocity;
      }
      const T share = share_under_cap(square, mass_a[i], mass_b[i], most);
      if (!(share < 1)) continue;
      for (int at = i; at < D * block_nodes; at += block_nodes) impulse[at] *= share;
      dissipated[i] = dissipated_by_share(dissipated[i], share, sliding - across * approach, square - across * across,
                                          mass_a[i], mass_b[i]);
    }
  }
  /// Adds what the law did to its pair; with `own` each body has taken an impulse of its own.
  void add_to(PairGiven& pair, bool own) const {
    for (int i = 0; i < count; ++i) {
      for (int c = 0; c < D; ++c) {
        const double taken = impulse[c * block_nodes + i];
        pair.impulse[c] += taken;
        if (own) pair.unbalanced[c] += taken - impulse_of_b[c * block_nodes + i];
      }
      add_normal_part(impulse + i, normal + i, block_nodes, D, pair.along.data(), pair.pressing);
      pair.count(status[i], separation[i], area[i], valid[i]);
    }
  }
  /// Copies the last pair so that whole lanes may be computed.
  int pad(bool own, bool compliant, bool reads_traction, int states) {
    const int last = count - 1, end = padded(count);
    for (int i = count; i < end; ++i) {
      mass_a[i] = mass_a[last], mass_b[i] = mass_b[last], separation[i] = separation[last], area[i] = area[last];
      for (int c = 0; c < D; ++c)
        for (T* array : {momentum_a, momentum_b, normal, normal_of_b, displacement, traction})
          if ((array != normal_of_b || own) && (array != displacement || compliant) &&
              (array != traction || reads_traction))
            array[c * block_nodes + i] = array[c * block_nodes + last];
      for (int k = 0; k < states; ++k)
        for (T* array : {state_a, state_b, gained_a, gained_b})
          array[k * block_nodes + i] = array[k * block_nodes + last];
    }
    return end;
  }
};

/// What contact looks at of one velocity field, from a slot's first node on.
template <int D, class T>
struct GridStep<D, T>::ContactField {
  const Q *motion, *gradient;
  const Q *position, *mass_gradient, *displacement, *state, *gain;  ///< null where not summed

  ContactFieldNode at(std::uint32_t node) const;
};

template <int D, class T>
inline ContactFieldNode GridStep<D, T>::ContactField::at(std::uint32_t node) const {
  ContactFieldNode result;
  const Q gradient = this->gradient[node];
  result.mass = motion[node][3];
  for (int c = 0; c < 3; ++c) {
    result.volume_gradient[c] = gradient[c];
    if (position) result.mass_position[c] = position[node][c];
    if (mass_gradient) result.mass_gradient[c] = mass_gradient[node][c];
    if (displacement) result.mass_displacement[c] = displacement[node][c];
  }
  return result;
}

template <int D, class T>
void GridStep<D, T>::call_law(const Component& law, ContactBatch& batch, std::uint32_t end, double dt,
                              bool of_b) const {
  const bool compliant = law.plugin->contact().traits & MPM_COMPLIANT, keeps = !law.plugin->state().empty();
  const mpm_contact_batch request{end,
                                  block_nodes,
                                  D,
                                  law_stage_,
                                  dt,
                                  batch.mass_a,
                                  batch.mass_b,
                                  batch.momentum_a,
                                  batch.momentum_b,
                                  of_b ? batch.normal_of_b : batch.normal,
                                  batch.separation,
                                  batch.area,
                                  of_b ? batch.impulse_of_b : batch.impulse,
                                  of_b ? batch.dissipated_of_b : batch.dissipated,
                                  of_b ? batch.status_of_b : batch.status,
                                  compliant ? batch.displacement : nullptr,
                                  compliant ? (of_b ? batch.stored_of_b : batch.stored) : nullptr,
                                  reads_traction(law) ? batch.traction : nullptr,
                                  scene_.experiment.grid.cell_size,
                                  keeps ? batch.state_a : nullptr,
                                  keeps ? batch.state_b : nullptr,
                                  keeps ? batch.gained_a : nullptr,
                                  keeps ? batch.gained_b : nullptr,
                                  keeps ? (of_b ? batch.reached_of_b : batch.reached) : nullptr,
                                  first_step_,
                                  0};
  law.plugin->contact().apply[lane_precision<T>][D - 2](law.parameters.data(), &request);
}

template <int D, class T>
void GridStep<D, T>::apply_law(ContactBatch& batch, int a, int b, const StepInfo& step, ContactSums& sums) {
  const Component& law = *scene_.experiment.contact;
  const bool own = own_normals_;
  const bool compliant = mass_displacement >= 0;
  const int states = static_cast<int>(law.plugin->state().size());
  const std::uint32_t end = static_cast<std::uint32_t>(batch.pad(own, compliant, reads_traction(law), states));
  call_law(law, batch, end, step.dt, false);
  if (own) {
    call_law(law, batch, end, step.dt, true);
    for (int i = 0; i < batch.count; ++i) {
      batch.dissipated[i] = T(0.5) * (batch.dissipated[i] + batch.dissipated_of_b[i]);
      batch.status[i] = std::max(batch.status[i], batch.status_of_b[i]);
      if (compliant) batch.stored[i] = T(0.5) * (batch.stored[i] + batch.stored_of_b[i]);
      for (int k = 0; k < states; ++k) {
        T& reached = batch.reached[k * block_nodes + i];
        reached = std::max(reached, batch.reached_of_b[k * block_nodes + i]);
      }
    }
  }
  if (states > 0 && notes_reached_) note_reached(batch, a, b, states);
  if (strain_cap_ > 0) batch.cap(static_cast<T>(strain_cap_ * scene_.experiment.grid.cell_size / step.dt));
  const T* const returned = own ? batch.impulse_of_b : batch.impulse;
  const bool records = records_;  // the compiler need not ask again after each store
  for (int i = 0; i < batch.count; ++i) {
    Q &va = motion_at(a, batch.node[i]), &vb = motion_at(b, batch.node[i]);
#pragma GCC unroll 3
    for (int c = 0; c < D; ++c) {
      const T impulse = batch.impulse[c * block_nodes + i], opposite = returned[c * block_nodes + i];
      T of_a = va[c], of_b = vb[c];
      sums.change[c] +=
          strike_pair<double>(of_a, of_b, T(va[3]), T(vb[3]), impulse, opposite, [&](bool second, T given) {
            if (records) record(contact_impulse, standing_contact, second ? b : a, batch.node[i], c, given);
          });
      va[c] = of_a, vb[c] = of_b;
      sums.impulse[c] += impulse;
    }
    sums.friction += batch.dissipated[i];
    if (compliant) sums.stored += batch.stored[i];
    sums.sticking += batch.status[i] == MPM_STICKS;
    sums.slipping += batch.status[i] == MPM_SLIPS;
    if (batch.status[i] != MPM_APART && batch.valid[i])
      sums.largest_penetration = std::max(sums.largest_penetration, -static_cast<double>(batch.separation[i]));
  }
}

/// Writes down what the pairs of a batch have reached; a node of three fields keeps the most of both pairs.
template <int D, class T>
void GridStep<D, T>::note_reached(const ContactBatch& batch, int a, int b, int states) {
  for (int i = 0; i < batch.count; ++i)
    for (const int field : {a, b}) {
      Q& of_node = grid_.quad(reached, field, batch.node[i]);
      for (int k = 0; k < states; ++k) of_node[k] = std::max<T>(of_node[k], batch.reached[k * block_nodes + i]);
      of_node[3] = 1;
    }
}

/// Notes where a batch meets, and what the law gave its nodes.
template <int D, class T>
void GridStep<D, T>::note_nodes(const ContactBatch& batch, int a, int b, std::vector<NodeGiven>& nodes) const {
  for (int i = 0; i < batch.count; ++i) {
    NodeGiven& given = nodes.emplace_back();
    given.node.node = grid_.coordinates_of(batch.node[i]);
    given.node.a = a, given.node.b = b;
    for (std::size_t c = 0; c < D; ++c) {
      given.node.normal[c] = batch.normal[c * block_nodes + i];
      given.impulse[c] = batch.impulse[c * block_nodes + i];
    }
    given.node.separation = batch.separation[i], given.node.area = batch.area[i];
    given.node.status = batch.status[i];
  }
}

/// Whether grips hold all components of a node: their particles are half of this mass, kg.
template <int D, class T>
inline bool GridStep<D, T>::held_by_grips(int field, std::uint32_t node, T mass) {
  unsigned held = 0;
  for (std::size_t k = 0; k < grip_channels_.size(); ++k) {
    const Grip& grip = scene_.experiment.grips[k];
    if (scene_.experiment.bodies[grip.body].field != field ||
        !grip_holds(T(grid_.quad(grip_channels_[k], field, node)[3]), mass))
      continue;
    for (int c = 0; c < D; ++c) held |= unsigned(grip.held[c]) << c;
  }
  return held == (1u << D) - 1;
}

/// Calls visit(a, b, batch) for each pair of fields that meets in a slot, with the nodes where it does.
template <int D, class T>
template <class Visit>
void GridStep<D, T>::visit_pairs(std::uint32_t slot, Visit&& visit) {
  const bool weld = (scene_.experiment.contact->plugin->contact().traits & MPM_BYPASSES_DETECTION) != 0;
  const int states = static_cast<int>(scene_.experiment.contact_state().size());
  const std::uint32_t first = slot * block_nodes;
  const auto contact_field = [&](int field) {
    return ContactField{&motion_at(field, first),
                        &grid_.quad(volume_gradient, field, first),
                        mass_position < 0 ? nullptr : &grid_.quad(mass_position, field, first),
                        mass_gradient < 0 ? nullptr : &grid_.quad(mass_gradient, field, first),
                        mass_displacement < 0 ? nullptr : &grid_.quad(mass_displacement, field, first),
                        mass_state < 0 ? nullptr : &grid_.quad(mass_state, field, first),
                        mass_gain < 0 ? nullptr : &grid_.quad(mass_gain, field, first)};
  };
  static_assert(block_nodes <= MPM_BATCH);
  static thread_local std::array<MetPair, block_nodes> met;  // its memory is kept from slot to slot
  std::array<std::uint32_t, block_nodes> nodes;
  for (int a = 0; a < grid_.fields(); ++a)
    for (int b = a + 1; b < grid_.fields(); ++b) {
      const ContactField of_a = contact_field(a), of_b = contact_field(b);
      std::size_t count = 0;
      for (std::uint32_t node = 0; node < block_nodes; ++node) {
        if (!meet(T(of_a.motion[node][3]), T(of_b.motion[node][3]), weld)) continue;
        nodes[count] = node;
        met[count++] = {grid_.coordinates_of(first + node), of_a.at(node), of_b.at(node), {}};
      }
      pair_geometry_.find(contact_points_, a, b, {met.data(), count});
      ContactBatch batch;
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t node = nodes[i];
        const ContactGeometry& geometry = met[i].geometry;
        if (!geometry.valid && !weld) continue;
        const Q &motion_a = of_a.motion[node], &motion_b = of_b.motion[node];
        batch.add(first + node, motion_a, motion_b, geometry, own_normals_);
        if (!grip_channels_.empty()) {
          const T mass_a = motion_a[3], mass_b = motion_b[3];
          const bool holds_a = held_by_grips(a, first + node, held_mass(mass_a, mass_b, weld));
          if (holds_a != held_by_grips(b, first + node, held_mass(mass_b, mass_a, weld)))
            batch.hold(holds_a, motion_a, motion_b);
        }
        if (mass_displacement >= 0) batch.displace(met[i].a, met[i].b);
        if (mass_state >= 0) batch.keep(of_a, of_b, node, states);
      }
      if (batch.count > 0) visit(a, b, batch);
    }
}

template <int D, class T>
void GridStep<D, T>::resolve_slot(std::uint32_t slot, const StepInfo& step, ContactSums& sums) {
  const bool traction = scene_.experiment.measures_traction();
  visit_pairs(slot, [&](int a, int b, ContactBatch& batch) {
    const std::size_t pair = pair_index(a, b, grid_.fields());
    for (int i = 0; traction && i < batch.count; ++i)
      batch.set_traction(i, welds_.around(pair, grid_.coordinates_of(batch.node[i])), step.dt);
    apply_law(batch, a, b, step, sums);
    if (records_nodes(scene_.experiment, step)) note_nodes(batch, a, b, sums.nodes);
    if (sums.pairs) batch.add_to(sums.pairs[pair], own_normals_);
  });
}

/// Sums up what a weld would give at all nodes where fields meet, for laws that read the traction around a node.
template <int D, class T>
void GridStep<D, T>::measure_welds() {
  const auto& slots = grid_.shared_slots();
  std::vector<std::vector<ContactWelds::Entry>> found(slots.size());
  scene_.team->for_each(slots.size(), 4, [&](std::size_t k, int) {
    visit_pairs(slots[k], [&](int a, int b, ContactBatch& batch) {
      for (int i = 0; i < batch.count; ++i)
        found[k].push_back({pair_index(a, b, grid_.fields()), grid_.coordinates_of(batch.node[i]), batch.weld(i)});
    });
  });
  welds_.begin(grid_.fields());
  for (const auto& of_slot : found)
    for (const ContactWelds::Entry& entry : of_slot) welds_.add(entry);
}

/// Shows the particles to all nodes where fields meet.
template <int D, class T>
void GridStep<D, T>::find_contact_points() {
  contact_points_.begin();
  for (const std::uint32_t slot : grid_.shared_slots())
    for (std::uint32_t node = slot * block_nodes; node < (slot + 1) * block_nodes; ++node) {
      int present = 0;
      for (int field = 0; field < grid_.fields(); ++field) present += motion_at(field, node)[3] > 0;
      if (present > 1) contact_points_.open(grid_.coordinates_of(node));
    }
  show_particles_(contact_points_);
  scene_.team->for_each(contact_points_.node_count(), 4, [&](std::size_t i, int) { contact_points_.find(i, i + 1); });
}

/// Lets all pairs of fields meet, each slot with sums of its own.
template <int D, class T>
void GridStep<D, T>::resolve_pairs(const StepInfo& step, std::vector<ContactSums>& sums, ContactGiven& given) {
  if (!scene_.experiment.contact) return;
  if (scene_.experiment.measures_traction()) measure_welds();
  const auto& slots = grid_.shared_slots();
  const std::size_t pairs = impulse_.pairs().size();
  sums.resize(slots.size());
  std::vector<PairGiven> pairs_of_slots(pairs * slots.size());
  for (std::size_t i = 0; pairs > 0 && i < slots.size(); ++i) sums[i].pairs = &pairs_of_slots[i * pairs];
  scene_.team->for_each(slots.size(), 4, [&](std::size_t i, int) { resolve_slot(slots[i], step, sums[i]); });
  for (const ContactSums& s : sums) {
    for (int c = 0; c < D; ++c) given.impulse[c] += s.impulse[c];
    given.dissipated += s.friction, given.stored += s.stored;
    given.nodes.insert(given.nodes.end(), s.nodes.begin(), s.nodes.end());
  }
  given.pairs.resize(pairs);
  for (std::size_t k = 0; k < pairs_of_slots.size(); ++k) given.pairs[k % pairs].add(pairs_of_slots[k]);
}

template <int D, class T>
ContactRecord GridStep<D, T>::record_of(const std::vector<ContactSums>& sums) {
  ContactRecord record;
  double change[3]{}, squared = 0;
  for (const ContactSums& s : sums) {
    for (int c = 0; c < D; ++c) change[c] += s.change[c];
    record.sticking += s.sticking;
    record.slipping += s.slipping;
    record.largest_penetration = std::max(record.largest_penetration, s.largest_penetration);
  }
  record.nodes = record.sticking + record.slipping;
  for (int c = 0; c < D; ++c) squared += change[c] * change[c];
  record.momentum_residual = std::sqrt(squared);
  return record;
}

/// Lets fields meet one another, and then rigid bodies, whose velocities are those of a time, s.
template <int D, class T>
void GridStep<D, T>::resolve_contact(const StepInfo& step, Recorded recorded, Stage stage, double time) {
  law_stage_ = stage == Stage::after_forces ? MPM_AFTER_FORCES : MPM_BEFORE_FORCES;
  first_step_ = step.step == 0, notes_reached_ = recorded == Recorded::after_forces;
  if (contact_points_.needed() && recorded == Recorded::before_forces) find_contact_points();
  std::vector<ContactSums> sums;
  ContactGiven given;
  resolve_pairs(step, sums, given);
  ContactRecord record = record_of(sums);
  meet_rigid_bodies(time, step, given, record);
  Ledger* const ledger = records_ ? &ledger_ : nullptr;
  if (recorded == Recorded::before_forces) return impulse_.before_forces(given, step.filtered, ledger);
  if (recorded == Recorded::filter) return impulse_.in_filter(given, grid_.has(constrained), ledger);
  if (recorded == Recorded::remap) return;
  impulse_.after_forces(given, ledger);
  impulse_.record_counts(given);
  record_ = record;
  record_force(step);
}

template <int D, class T>
void GridStep<D, T>::record_force(const StepInfo& step) {
  const Vector3 impulse = impulse_.handed_over(step.filtered);
  for (int c = 0; c < D; ++c) record_.force[c] = impulse[c] / step.dt;
  impulse_.record_forces(step.filtered, step.dt);
}

}  // namespace mpm::cpu
