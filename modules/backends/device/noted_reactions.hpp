#pragma once
// The host looks at the nodes before and after phases that fold and hold, and notes what supports give by them.

#include <vector>

#include "backends/device/conditions.hpp"
#include "backends/device/device_arrays.hpp"
#include "backends/device/kernels/grid.hpp"
#include "simulation/reaction_impulse.hpp"

namespace mpm::device {

template <class T>
class NotedReactions {
 public:
  /// `scene` is that of the run, where walls and boxes point to what they give as it was evaluated last, on the host.
  NotedReactions(const Experiment& experiment, const Arguments<T>& scene, ReactionImpulse& reactions, int fields)
      : experiment_(experiment), scene_(scene), reactions_(reactions) {
    if (reactions.asked()) folded_mass_.resize(fields, std::vector<T>(scene.node_count));
  }

  /// Repeats on copies of its momenta and masses how a field was folded along an axis: ghosts come in the same order.
  void fold_momenta(int field, NodesOnHost<T>& now, int axis, std::vector<T> momentum, std::vector<T> mass) {
    for_each_fold(now, axis, false, [&](const Fold& fold) {
      folded_mass_[field][fold.ghost] = mass[fold.ghost];
      reactions_.mirror(places(fold), vector(momentum, fold.ghost), image(momentum, fold, mass[fold.ghost], false));
      add_image(momentum, fold, mass[fold.ghost], false);
      mass[fold.mirror] += mass[fold.ghost], mass[fold.ghost] = T(0);
    });
  }
  /// The same of the sum of all forces.
  void fold_forces(NodesOnHost<T>& now, int axis, std::vector<T> force) {
    for_each_fold(now, axis, false, [&](const Fold& fold) {
      reactions_.mirror_force(places(fold), vector(force, fold.ghost), image(force, fold, T(0), true));
      add_image(force, fold, T(0), true);
    });
  }
  /// The same of a filter's projection.
  void fold_projection(int field, NodesOnHost<T>& now, int axis, std::vector<T> projection, bool at_rest) {
    for_each_fold(now, axis, false, [&](const Fold& fold) {
      const T mass = folded_mass_[field][fold.ghost];
      reactions_.mirror_projection(places(fold), vector(projection, fold.ghost),
                                   image(projection, fold, mass, at_rest));
      add_image(projection, fold, mass, at_rest);
    });
  }
  /// Notes what particles gather from the ghosts of an increment, by walls along an axis.
  void gather_increment(int field, NodesOnHost<T>& now, int axis) {
    const T* const increment = now.of("increment");
    for_each_fold(now, axis, true, [&](const Fold& fold) {
      const double mass = folded_mass_[field][fold.ghost];
      reactions_.beyond_projection(places(fold), vector(increment, fold.mirror, mass),
                                   vector(increment, fold.ghost, mass));
    });
  }
  /// Notes the same of the velocity, and of its change by the forces.
  void gather(int field, NodesOnHost<T>& now, int axis) {
    const T *const velocity = now.of("velocity"), *const before = now.of("velocity_before");
    for_each_fold(now, axis, true, [&](const Fold& fold) {
      const double mass = folded_mass_[field][fold.ghost];
      const auto change = [&](int node) {
        Vector3 of_node = vector(velocity, node, mass);
        const Vector3 old = vector(before, node, mass);
        for (int c = 0; c < 3; ++c) of_node[c] -= old[c];
        return of_node;
      };
      reactions_.beyond(places(fold), vector(velocity, fold.mirror, mass), vector(velocity, fold.ghost, mass));
      reactions_.beyond_increment(places(fold), change(fold.mirror), change(fold.ghost));
    });
  }

  /// Notes what each support is about to give a field's nodes: they hold one after another, walls before boxes, and the
  /// last counts; all decide by the velocity as it is. `supports` are those of the scene's boxes.
  void hold(NodesOnHost<T>& now, const std::vector<int>& supports, bool at_end) {
    const std::vector<GripArrays<T>> grips = now.grips(experiment_);
    const int count = static_cast<int>(grips.size());
    experiment_.dimension == 2 ? hold_in<2>(now, supports, grips.data(), count, at_end)
                               : hold_in<3>(now, supports, grips.data(), count, at_end);
  }

 private:
  template <int D>
  void hold_in(NodesOnHost<T>& now, const std::vector<int>& supports, const GripArrays<T>* grips, int grip_count,
               bool at_end) {
    const T *const mass = now.of("mass"), *const velocities = now.of("velocity");
    for (int node = 0; node < scene_.node_count; ++node) {
      if (!(mass[node] > T(0))) continue;
      int at[D];
      coordinates_of_node<D>(scene_, node, at);
      const Vector3 before = vector(velocities, node);
      Vector3 velocity = before;
      const auto give = [&](int support, int c, T value) {
        Vector3 impulse{};
        impulse[c] = double(mass[node]) * (double(value) - velocity[c]);
        velocity[c] = value;
        reactions_.hold(support, position(node), impulse);
      };
      for_each_wall_of_node<D>(scene_, node, at, [&](const Fold& foot) {
        for (int c = 0; c < D; ++c)
          if (wall_holds(foot.wall, foot.axis, foot.side, c, T(before[foot.axis])))
            give(support_of_wall(foot.axis, foot.side), c, velocity_of_wall(scene_, foot, c));
      });
      for (int k = 0; k < scene_.box_count; ++k) {
        const Box<T>& box = scene_.boxes[k];
        if (!is_inside<D>(box, at)) continue;
        const int index = index_in_box<D>(box, at);
        for (int c = 0; c < D; ++c)
          if (box_holds(box.type, box.axis, box.side, box.given, c, T(before[c])))
            give(supports[k], c, box.velocity ? box.velocity[c * nodes_of_box<D>(box) + index] : T(0));
      }
      for (int k = 0; k < grip_count; ++k) {
        if (!grip_holds(grips[k].mass[node], mass[node])) continue;
        const T* const momentum = at_end ? grips[k].momentum : grips[k].before;
        for (int c = 0; c < D; ++c)
          if (grips[k].given >> c & 1)
            give(experiment_.support_of_grip(k), c, momentum[c * scene_.node_count + node] / grips[k].mass[node]);
      }
    }
  }

  /// Calls visit(fold) for the ghosts that walls along this axis have folded in this step.
  template <class Visit>
  void for_each_fold(NodesOnHost<T>& now, int axis, bool filling, Visit visit) const {
    Arguments<T> a = scene_;
    a.axis = axis;
    for (int line = 0; line < a.node_count / a.extent[axis]; ++line)
      for_each_fold_of_line(a, line, !filling, false, [&](const Fold& fold) {
        if (now.folded()[fold.ghost] >> axis & 1) visit(fold);
      });
  }
  T wall_momentum(const Fold& fold, int c, T mass, bool at_rest) const {
    return at_rest ? T(0) : mass * velocity_of_wall(scene_, fold, c);
  }
  Vector3 image(const std::vector<T>& values, const Fold& fold, T mass, bool at_rest) const {
    Vector3 result{};
    for (int c = 0; c < experiment_.dimension; ++c)
      result[c] = mirrored(values[static_cast<std::size_t>(c) * scene_.node_count + fold.ghost],
                           T(mirror_sign(fold.wall, fold.axis, c)), wall_momentum(fold, c, mass, at_rest));
    return result;
  }
  void add_image(std::vector<T>& values, const Fold& fold, T mass, bool at_rest) const {
    const Vector3 added = image(values, fold, mass, at_rest);
    for (int c = 0; c < experiment_.dimension; ++c) {
      T* const component = values.data() + static_cast<std::size_t>(c) * scene_.node_count;
      component[fold.mirror] += static_cast<T>(added[c]);
      component[fold.ghost] = T(0);
    }
  }
  Vector3 vector(const T* values, int node, double factor = 1) const {
    Vector3 result{};
    for (int c = 0; c < experiment_.dimension; ++c)
      result[c] = factor * values[static_cast<std::size_t>(c) * scene_.node_count + node];
    return result;
  }
  Vector3 vector(const std::vector<T>& values, int node) const { return vector(values.data(), node); }
  Vector3 position(int node) const {
    Vector3 x{};
    for (int c = 0; c < experiment_.dimension; node /= scene_.extent[c], ++c)
      x[c] = NodeRange::coordinate(experiment_, c, node % scene_.extent[c] - scene_.padding[c]);
    return x;
  }
  MirroredPlaces places(const Fold& fold) const {
    return {support_of_wall(fold.axis, fold.side), position(fold.ghost), position(fold.mirror)};
  }

  const Experiment& experiment_;
  const Arguments<T>& scene_;
  ReactionImpulse& reactions_;
  std::vector<std::vector<T>> folded_mass_;  ///< [velocity field][ghost], kg
};

}  // namespace mpm::device
