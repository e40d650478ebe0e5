#pragma once
// This part of GridStep treats the edges of the domain: folding, ghosts, conditions (policy: simulation/boundary.hpp).

#include "backends/cpu/grid/grid_step.hpp"

namespace mpm::cpu {

template <int D, class T>
Quad<T> GridStep<D, T>::mirror_signs(const FaceNodes& face, AtWall rule) const {
  Q signs{1, 1, 1, 1};
  for (int c = 0; c < 3; ++c) signs[c] = static_cast<T>(mirror_sign(rule, *face.condition, face.axis, c));
  return signs;
}

/// Finds the velocities that a wall or a box gives at some places, all at once.
template <int D, class T>
void GridStep<D, T>::find_velocities(const std::optional<VectorExpression>& velocity, std::span<const Vector3> x,
                                     double time) {
  found_.resize(velocity ? x.size() : 0);
  if (velocity) velocity->evaluate(x, x, time, found_);
}

template <int D, class T>
void GridStep<D, T>::find_wall_velocities(const FaceNodes& face, double time) {
  feet_.clear();
  if (face.condition->velocity)
    for (const MirrorPair& pair : face.pairs) feet_.push_back(pair.foot);
  find_velocities(face.condition->velocity, feet_, time);
}

template <int D, class T>
Quad<T> GridStep<D, T>::found_velocity(std::size_t i) const {
  Q result{};
  for (int c = 0; !found_.empty() && c < D; ++c) result[c] = static_cast<T>(found_[i][c]);
  return result;
}

// ---- folding -----------------------------------------------------------------------------------------------------

/// Whether a pair of nodes approaches the wall, as momenta folded so far and forces as scattered predict.
template <int D, class T>
bool GridStep<D, T>::approaches(const FaceNodes& face, int field, const MirrorPair& pair, double dt) {
  const std::size_t edges = grid_.edge_nodes().size();
  T speed = 0;
  for (const auto& [node, edge] : {std::pair{pair.ghost, pair.ghost_edge}, std::pair{pair.mirror, pair.mirror_edge}}) {
    const Q motion_node = motion_at(field, node);
    if (!(motion_node[3] > 0)) continue;
    T forces = motion_node[3] * gravity_[face.axis];
    if (edge != ~0u && has_gravity_)
      forces += static_cast<T>(gravity_correction_[(field * edges + edge) * 4 + face.axis]);
    if (grid_.has(force)) forces += grid_.quad(force, field, node)[face.axis];
    for (const ExternalChannel& load : external)
      if (grid_.has(load.channel)) forces += grid_.quad(load.channel, field, node)[face.axis];
    speed += predicted_velocity(motion_node[face.axis], forces, motion_node[3], static_cast<T>(dt));
  }
  return mpm::approaches(face.side, speed);
}

/// Calls visit(field, pair) for the pairs of a face that this step folds, in order.
template <int D, class T>
template <class Visit>
void GridStep<D, T>::for_each_folded(const FaceNodes& face, Visit&& visit) {
  for (int field = 0; field < grid_.fields(); ++field)
    for (std::size_t i = 0; i < face.pairs.size(); ++i)
      if (face.pair_folds[field * face.pairs.size() + i]) visit(field, face.pairs[i]);
}

/// Folds a momentum with the mass beside it, which moves with the wall. Folded ghosts are cleared, so that folding
/// again does nothing.
template <int D, class T>
void GridStep<D, T>::fold_momentum(Channel channel, int field, const MirrorPair& pair, Q signs, Q wall_velocity) {
  Q& ghost = grid_.quad(channel, field, pair.ghost);
  const Q wall = ghost[3] * wall_velocity;
  grid_.quad(channel, field, pair.mirror) += mirrored(ghost, signs, wall);
  ghost = Q{};
}

/// Returns what the image of a ghost's momentum gains of energy, and what is lost as its mass joins the mirror's: that
/// of their relative velocity, with the reduced mass.
template <int D, class T>
double GridStep<D, T>::work_of_fold(int field, const MirrorPair& pair, Q signs, Q wall_velocity) {
  const Wide ghost = widen(motion_at(field, pair.ghost)), mirror = widen(motion_at(field, pair.mirror));
  const Wide image = mirrored(ghost, widen(signs), Wide(ghost[3] * widen(wall_velocity)));
  const double gained = 0.5 * sum_of_components((image - ghost) * (image + ghost)) / ghost[3];
  if (!(mirror[3] > 0)) return gained;
  const Wide apart = image / ghost[3] - mirror / mirror[3];
  return gained - 0.5 * ghost[3] * mirror[3] / (ghost[3] + mirror[3]) * sum_of_components(apart * apart);
}

/// Folds values as they are; folded ghosts are cleared here too.
template <int D, class T>
void GridStep<D, T>::fold_as_is(Channel channel, int field, const MirrorPair& pair, Q signs) {
  Q& ghost = grid_.quad(channel, field, pair.ghost);
  grid_.quad(channel, field, pair.mirror) += signs * ghost;
  ghost = Q{};
}

template <int D, class T>
void GridStep<D, T>::fold_pair(FaceNodes& face, std::size_t index, int field, bool remap, double time) {
  const MirrorPair& pair = face.pairs[index];
  if (!remap && has_gravity_ && !face.periodic()) {  // the weight stays where it was until forces are folded
    double* const correction = gravity_correction_.data() + field * grid_.edge_nodes().size() * 4;
    for (int c = 0; c < D; ++c) {
      const double weight = static_cast<double>(motion_at(field, pair.ghost)[3]) * gravity_[c];
      correction[pair.ghost_edge * 4 + c] += weight;
      correction[pair.mirror_edge * 4 + c] -= weight;
    }
  }
  const std::vector<Channel>& channels = folded_[static_cast<int>(Folded::with_mass)];
  for (std::size_t k = 0; k < channels.size(); ++k) {
    const Channel c = channels[k];
    if (!grid_.has(c) || (remap && c != motion)) continue;
    const AtWall rule = grid_.field(c).at_wall;
    if (rule == AtWall::momentum) {
      const Q wall = wall_velocity(face, pair);
      if (records_ && !face.periodic()) work_of_folds_ += work_of_fold(field, pair, signs_[k].of, wall);
      if (notes_reactions_ && !face.periodic()) note_mirror(face, index, field, signs_[k].of, wall);
      fold_momentum(c, field, pair, signs_[k].of, wall);
    } else if (rule == AtWall::heat)
      fold_heat(face, index, field, time);
    else if (c == heated_volume)  // the ghost keeps its own: the corners' temperatures are made of it
      grid_.quad(c, field, pair.mirror) += grid_.quad(c, field, pair.ghost);
    else if (rule == AtWall::slip)  // the ghost keeps its own: where MUSL's remap does not fold it again, contact looks
      grid_.quad(c, field, pair.mirror) += signs_[k].of * grid_.quad(c, field, pair.ghost);
    else
      fold_as_is(c, field, pair, signs_[k].of);
  }
}

/// Folds the nodes of a wall, which mirror themselves: the image takes away what of these channels points across it.
template <int D, class T>
void GridStep<D, T>::fold_wall_onto_itself(const FaceNodes& face, int field, double dt) {
  for (std::size_t i = 0; i < face.wall.size(); ++i) {
    const std::uint32_t node = face.wall[i], edge = face.wall_edge[i];
    if (face.condition->type == ConditionType::separate &&
        !approaches(face, field, {node, node, edge, edge, {}, 0}, dt))
      continue;
    for (const Channel c : slipping_) grid_.quad(c, field, node)[face.axis] = 0;
  }
}

/// Sums the images of periodic nodes.
template <int D, class T>
void GridStep<D, T>::fold_images(bool remap, const StepInfo& step) {
  if (!remap) heat_of_folds_ = 0;
  if (!remap) gravity_correction_.assign(has_gravity_ ? grid_.edge_nodes().size() * 4 * grid_.fields() : 0, 0.0);
  fold_faces(true, remap, step);
  if (!remap) fold_forces(true, step.time, step.dt);
}

/// Folds what lies beyond walls onto the material before them.
template <int D, class T>
void GridStep<D, T>::fold_walls(bool remap, const StepInfo& step) {
  fold_faces(false, remap, step);
  if (!remap) fold_forces(false, step.time, step.dt);
}

/// Folds the ghosts of the faces, those of one axis after the other. A wall folds onto itself after all ghosts of its axis:
/// in a domain of one cell, those of the other wall are added to its nodes.
template <int D, class T>
void GridStep<D, T>::fold_faces(bool periodic, bool remap, const StepInfo& step) {
  const double dt = remap ? 0.0 : step.dt;
  for (int axis = 0; axis < D; ++axis) {
    if (scene_.domain.periodic(axis) != periodic) continue;
    if (!periodic && !remap && grid_.has(heat)) find_gradients(axis, step.time);
    for (FaceNodes& face : grid_.faces())
      if (face.axis == axis && !(face.pairs.empty() && face.wall.empty())) fold_face(face, remap, step.time, dt);
    if (periodic || remap) continue;
    for (const FaceNodes& face : grid_.faces())
      for (int field = 0; face.axis == axis && field < grid_.fields(); ++field) {
        if (grid_.has(capacity_position) && passes_heat(*face.condition)) fold_heat_onto_itself(face, field);
        if (!slipping_.empty()) fold_wall_onto_itself(face, field, dt);
      }
  }
}

/// Decides which ghosts of a face fold in this step, and folds these.
template <int D, class T>
void GridStep<D, T>::fold_face(FaceNodes& face, bool remap, double time, double dt) {
  const bool separate = face.condition->type == ConditionType::separate;
  find_wall_velocities(face, time);
  signs_.clear();
  for (const Channel c : folded_[static_cast<int>(Folded::with_mass)])
    signs_.push_back({mirror_signs(face, grid_.field(c).at_wall)});
  for (int field = 0; field < grid_.fields(); ++field)
    for (std::size_t i = 0; i < face.pairs.size(); ++i) {
      const MirrorPair& pair = face.pairs[i];
      const bool folds = motion_at(field, pair.ghost)[3] > 0 && (!separate || approaches(face, field, pair, dt));
      face.pair_folds[field * face.pairs.size() + i] = folds;
      if (notes_reactions_) face.folded_mass[field * face.pairs.size() + i] = motion_at(field, pair.ghost)[3];
      if (folds) fold_pair(face, i, field, remap, time);
    }
}

/// Returns the work a second of a moving wall on what lies beyond it: a ghost moves at (1 - sign) times the wall's
/// velocity beside its mirror's, and particles are strained and lifted by that too.
template <int D, class T>
double GridStep<D, T>::work_beyond_wall(Q force_of_ghost, Q signs, Q wall_velocity) {
  return -sum_of_components(widen(force_of_ghost) * (1.0 - widen(signs)) * widen(wall_velocity));
}

/// Folds forces as fold_faces decided.
template <int D, class T>
void GridStep<D, T>::fold_forces(bool periodic, double time, double dt) {
  for (const FaceNodes& face : grid_.faces()) {
    if (face.periodic() != periodic) continue;
    if (ledger_on()) find_wall_velocities(face, time);
    if (face.pairs.empty()) continue;
    for (const Channel c : folded_[static_cast<int>(Folded::with_force)]) {
      if (!grid_.has(c)) continue;
      const Q signs = mirror_signs(face, grid_.field(c).at_wall);
      for_each_folded(face, [&](int field, const MirrorPair& pair) {
        if (c == heat_rate) rate_of_folds_ += (signs[0] - 1) * static_cast<double>(grid_.quad(c, field, pair.ghost)[0]);
        if (ledger_on() && c == force && face.condition->velocity)
          ledger_.boundary += dt * work_beyond_wall(grid_.quad(c, field, pair.ghost), signs, wall_velocity(face, pair));
        if (notes_reactions_ && !periodic && grid_.field(c).at_wall == AtWall::vector)
          note_mirrored_force(face, pair, widen(grid_.quad(c, field, pair.ghost)), signs);
        fold_as_is(c, field, pair, signs);
      });
    }
    if (!has_gravity_ || periodic) continue;
    const Q signs = mirror_signs(face, AtWall::vector);
    for_each_folded(face, [&](int field, const MirrorPair& pair) {
      double* const correction = gravity_correction_.data() + field * grid_.edge_nodes().size() * 4;
      if (ledger_on() && face.condition->velocity) {
        Q weight{};
        for (int c = 0; c < D; ++c)
          if (scene_.experiment.gravity_has_potential(c))
            weight[c] = static_cast<T>(correction[pair.ghost_edge * 4 + c]);
        ledger_.boundary += dt * work_beyond_wall(weight, signs, wall_velocity(face, pair));
      }
      if (notes_reactions_) {
        Wide weight{};
        for (int c = 0; c < D; ++c) weight[c] = correction[pair.ghost_edge * 4 + c];
        note_mirrored_force(face, pair, weight, signs);
      }
      for (int c = 0; c < D; ++c) {
        correction[pair.mirror_edge * 4 + c] += signs[c] * correction[pair.ghost_edge * 4 + c];
        correction[pair.ghost_edge * 4 + c] = 0;
      }
    });
  }
}

/// Gives ghosts the mirrored velocity (and increment), the last folded first.
template <int D, class T>
void GridStep<D, T>::fill_ghosts(double time, bool increments) {
  auto& faces = grid_.faces();
  for (auto face = faces.rbegin(); face != faces.rend(); ++face) {
    const Q signs = mirror_signs(*face, AtWall::vector);
    find_wall_velocities(*face, time);
    for_each_folded(*face, [&](int field, const MirrorPair& pair) {
      const Q wall = wall_velocity(*face, pair);
      Q& ghost = motion_at(field, pair.ghost);
      const T mass = ghost[3];
      ghost = mirrored(motion_at(field, pair.mirror), signs, wall);
      ghost[3] = mass;
      if (increments)
        grid_.quad(velocity_before, field, pair.ghost) = signs * grid_.quad(velocity_before, field, pair.mirror);
    });
  }
}

// ---- conditions --------------------------------------------------------------------------------------------------

/// Sets the velocities that walls and boxes give.
template <int D, class T>
void GridStep<D, T>::impose(double time) {
  holders_.clear(), before_.clear();
  for (const FaceNodes& face : grid_.faces()) {
    const int type = static_cast<int>(face.condition->type), support = support_of_wall(face.axis, face.side);
    find_velocities(face.condition->velocity, face.wall_position, time);
    for (std::size_t i = 0; i < face.wall.size(); ++i) {
      const Q velocity = found_velocity(i);
      for (int field = 0; field < grid_.fields(); ++field) {
        const T across = before_conditions(field, face.wall[i])[face.axis];
        for (int c = 0; c < D; ++c)
          if (wall_holds(type, face.axis, face.side, c, across))
            hold(field, face.wall[i], c, velocity[c], support, face.wall_position[i]);
      }
    }
  }
  for (const BoxNodes& box : grid_.boxes()) {
    const BoxCondition& condition = *box.condition;
    int given = 0;
    for (int c = 0; c < D; ++c) given |= int(condition.held[c]) << c;
    find_velocities(condition.velocity, box.position, time);
    for (std::size_t i = 0; i < box.nodes.size(); ++i) {
      const Q velocity = found_velocity(i);
      for (int field = 0; field < grid_.fields(); ++field)
        for (int c = 0; c < D; ++c)
          if (box_holds(static_cast<int>(condition.type), condition.axis, condition.side, given, c,
                        before_conditions(field, box.nodes[i])[c]))
            hold(field, box.nodes[i], c, velocity[c], box.support, box.position[i]);
    }
  }
  if (!gripped_.empty()) impose_grips();
}

/// The velocity of a node before the conditions that are imposed now, by which separating ones decide whether they hold.
template <int D, class T>
Quad<T> GridStep<D, T>::before_conditions(int field, std::uint32_t node) {
  if (keeps_before_conditions_)
    if (const auto found = before_.find(std::uint64_t(field) * grid_.nodes() + node); found != before_.end())
      return found->second.velocity;
  return motion_at(field, node);
}

/// Finds the nodes to which particles of a grip give half of the mass or more.
template <int D, class T>
void GridStep<D, T>::find_gripped_nodes() {
  gripped_.clear();
  for (std::size_t grip = 0; grip < scene_.experiment.grips.size(); ++grip) {
    const int field = scene_.experiment.bodies[scene_.experiment.grips[grip].body].field;
    const Channel channel = channel_of(scene_.plan, grip_field(grip));
    for (std::uint32_t node = 0; node < grid_.nodes(); ++node)
      if (grip_holds(grid_.quad(channel, field, node)[3], motion_at(field, node)[3]))
        gripped_.push_back({field, node, grip, grid_.position_of(node)});
  }
}

/// Sets the velocities that grips give, the means of their particles' by mass.
template <int D, class T>
void GridStep<D, T>::impose_grips() {
  for (const auto& [field, node, number, x] : gripped_) {
    const Grip& grip = scene_.experiment.grips[number];
    const T mass = grid_.quad(channel_of(scene_.plan, grip_field(number)), field, node)[3];
    const Q momentum =
        grid_.quad(channel_of(scene_.plan, grip_field(number) + (grips_at_end_ ? "" : "_before")), field, node);
    for (int c = 0; c < D; ++c)
      if (grip.held[c]) hold(field, node, c, momentum[c] / mass, scene_.experiment.support_of_grip(number), x);
  }
}

template <int D, class T>
void GridStep<D, T>::hold(int field, std::uint32_t node, int c, T velocity, int support, const Vector3& x) {
  Q& v = motion_at(field, node);
  if (!(v[3] > 0)) return;
  if (keeps_before_conditions_) before_.try_emplace(std::uint64_t(field) * grid_.nodes() + node, Before{v});
  if (records_ || notes_reactions_) {
    Vector3 impulse{};
    impulse[c] = double(v[3]) * (double(velocity) - double(v[c]));
    if (records_) record(boundary_impulse, standing_boundary, field, node, c, impulse[c]);
    if (notes_reactions_) note_held((std::uint64_t(field) * grid_.nodes() + node) * D + c, support, x, impulse);
  }
  v[c] = velocity;
}

/// Notes what a support gives a component of a node. It takes over what those before it have given.
template <int D, class T>
void GridStep<D, T>::note_held(std::uint64_t component, int support, const Vector3& x, const Vector3& impulse) {
  Holder& holder = holders_.try_emplace(component, Holder{support}).first->second;
  if (holder.support != support) {
    Vector3 back = holder.impulse;
    for (double& value : back) value = -value;
    reactions_.hold(holder.support, x, back);
    reactions_.hold(support, x, holder.impulse);
    holder.support = support;
  }
  for (int c = 0; c < 3; ++c) holder.impulse[c] += impulse[c];
  reactions_.hold(holder.support, x, impulse);
}

// ---- reactions of walls ------------------------------------------------------------------------------------------

template <int D, class T>
MirroredPlaces GridStep<D, T>::places(const FaceNodes& face, const MirrorPair& pair) const {
  MirroredPlaces at{support_of_wall(face.axis, face.side), pair.foot, pair.foot};
  const double inward = face.side == 0 ? pair.distance : -pair.distance;
  at.ghost[face.axis] -= inward, at.mirror[face.axis] += inward;
  return at;
}

/// Notes that a ghost's momentum is about to be folded.
template <int D, class T>
void GridStep<D, T>::note_mirror(const FaceNodes& face, std::size_t index, int field, Q signs, Q wall) {
  const MirrorPair& pair = face.pairs[index];
  const Q ghost = motion_at(field, pair.ghost);
  reactions_.mirror(places(face, pair), as_array(widen(ghost)),
                    as_array(mirrored(widen(ghost), widen(signs), Wide(double(ghost[3]) * widen(wall)))));
}

template <int D, class T>
void GridStep<D, T>::note_mirrored_force(const FaceNodes& face, const MirrorPair& pair, Wide ghost, Q signs) {
  reactions_.mirror_force(places(face, pair), as_array(ghost), as_array(widen(signs) * ghost));
}

/// Notes that particles have gathered an increment from a ghost, and that its projection is about to be folded.
template <int D, class T>
void GridStep<D, T>::note_projection(const FaceNodes& face, std::size_t index, int field, Q signs, Q wall) {
  const MirrorPair& pair = face.pairs[index];
  const MirroredPlaces at = places(face, pair);
  const double mass = face.folded_mass[field * face.pairs.size() + index];
  const auto momentum = [&](std::uint32_t node) {
    return as_array(mass * widen(grid_.quad(filter_increment, field, node)));
  };
  reactions_.beyond_projection(at, momentum(pair.mirror), momentum(pair.ghost));
  const Wide ghost = widen(grid_.quad(filter_projection, field, pair.ghost));
  reactions_.mirror_projection(at, as_array(ghost),
                               as_array(mirrored(ghost, widen(signs), Wide(ghost[3] * widen(wall)))));
}

/// Records what particles take from the supports when they gather the velocity as it is now. `increments`: its change
/// stands in velocity_before.
template <int D, class T>
void GridStep<D, T>::record_reactions(const StepInfo& step, bool increments) {
  if (!notes_reactions_) return;
  reactions_.apply_forces(step.dt);
  reactions_.begin_gather();
  for (const FaceNodes& face : grid_.faces()) {
    for (std::size_t index = 0; !face.periodic() && index < face.pair_folds.size(); ++index) {
      if (!face.pair_folds[index]) continue;
      const int field = static_cast<int>(index / face.pairs.size());
      const MirrorPair& pair = face.pairs[index % face.pairs.size()];
      const MirroredPlaces at = places(face, pair);
      const double mass = face.folded_mass[index];
      const auto momentum = [&](Channel c, std::uint32_t node) {
        return as_array(mass * widen(grid_.quad(c, field, node)));
      };
      reactions_.beyond(at, momentum(motion, pair.mirror), momentum(motion, pair.ghost));
      if (increments)
        reactions_.beyond_increment(at, momentum(velocity_before, pair.mirror), momentum(velocity_before, pair.ghost));
    }
  }
  reactions_.record(step);
}

}  // namespace mpm::cpu
