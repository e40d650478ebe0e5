#pragma once
// Temperature: particles give nodes heat and heat capacity as they give momentum and mass, conduct what the gradient of
// the nodes' temperature drives, and take the temperature back by their transfer, which is called for the first
// component of a velocity. The formulas are those of operators/heat.hpp and operators/edges.hpp. This file is compiled
// only for scenes with temperature.

#include "backends/device/kernels/conditions.hpp"
#include "backends/device/kernels/grid.hpp"
#include "backends/device/kernels/material.hpp"
#include "backends/device/kernels/scatter.hpp"
#include "backends/device/kernels/sums.hpp"
#include "operators/heat.hpp"

namespace mpm::device {

// ---- particles to nodes ------------------------------------------------------------------------------------------

/// The heat capacity m c of a particle, J/K.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD T capacity_of_particle(const ParticleArrays<T>& particles, int p) {
  return of_size<Scene>(particles, particles.mass, p) * heat_capacity_of<Scene>(particles, p);
}

/// The conductivity k of a particle, W/(m K).
template <class Scene, class T = typename Scene::Scalar>
MPM_HD T conductivity_of(const ParticleArrays<T>& particles, int p) {
  return particles.heat.conductivity[has_melted<Scene>(particles, p) ? 1 : 0];
}

/// Loads what a particle keeps of its transfer for the temperature.
template <class Scene, class T = typename Scene::Scalar>
MPM_HD auto temperature_state(const ParticleArrays<T>& particles, int p) {
  typename Scene::Transfer::template State<Scene::dimension, T> state{};
  [[maybe_unused]] T* const flat = reinterpret_cast<T*>(&state);
  Scene::for_each_temperature_state([&](auto field) {
    using F = decltype(field);
    for (int k = 0; k < F::components; ++k) flat[F::scalar + k] = particles.field[F::number][k * particles.stride + p];
  });
  return state;
}
template <class Scene, class State, class T = typename Scene::Scalar>
MPM_HD void store_temperature_state(const ParticleArrays<T>& particles, int p, const State& state) {
  [[maybe_unused]] const T* const flat = reinterpret_cast<const T*>(&state);
  Scene::for_each_temperature_state([&](auto field) {
    using F = decltype(field);
    for (int k = 0; k < F::components; ++k) particles.field[F::number][k * particles.stride + p] = flat[F::scalar + k];
  });
}

/// The channels: heat, heat capacity and, where heat comes through walls, volume, that times conductivity, and places.
template <class Scene>
inline constexpr int heat_channels = (Scene::Node::heated_volume >= 0 ? 4 : 2) +
                                     (Scene::Node::capacity_position >= 0 ? Scene::dimension : 0);
template <class Scene>
inline constexpr int scatter_heat_scalars = heat_channels<Scene>* Tile<Scene::dimension>::nodes;

/// Scatters w (b + A d) of the temperature and w m c; where heat comes through walls also w J V0 of the section, that
/// times k, and -w m c d.
template <class Scene>
MPM_HD void scatter_heat(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using Transfer = typename Scene::Transfer;
  using N = typename Scene::Node;
  using P = typename Scene::Particle;
  constexpr int D = Scene::dimension, channels = heat_channels<Scene>;
  T* channel[channels];
  channel[0] = a.grid.field[N::heat], channel[1] = a.grid.field[N::heat_capacity];
  if constexpr (N::heated_volume >= 0)
    channel[2] = a.grid.field[N::heated_volume], channel[3] = a.grid.field[N::volume_conductivity];
  if constexpr (N::capacity_position >= 0)
    for (int c = 0; c < D; ++c) channel[4 + c] = a.grid.field[N::capacity_position] + c * a.node_count;
  scatter_blocks<Scene, channels>(team, a, channel, [&](int p, auto add) {
    const Stencil<Scene> stencil(a, p);
    if (!stencil.inside()) return report(a, p);
    const ParticleArrays<T>& particles = a.particles;
    const T capacity = capacity_of_particle<Scene>(particles, p);
    Vec<D, T> temperature{}, b{};
    Mat<D, T> A{};
    temperature[0] = particles.field[P::temperature][p];
    Transfer::scatter(parameters_of<Transfer>(a.transfer_parameters), capacity, temperature,
                      temperature_state<Scene>(particles, p), b, A);
    [[maybe_unused]] T section = T(0);
    if constexpr (N::heated_volume >= 0) {
      section = volume_of_particle<Scene>(particles, p);
      if constexpr (Scene::axisymmetric) section /= T(6.283185307179586) * particles.field[P::position][p];
    }
    stencil.for_each_node(a, [&](const StencilNode<D, T>& s) {
      T heat = b[0];
      if constexpr (Scene::scatters_affine)
        for (int j = 0; j < D; ++j) heat += A(0, j) * s.distance[j];
      T values[channels];
      values[0] = s.weight * heat, values[1] = s.weight * capacity;
      if constexpr (N::heated_volume >= 0)
        values[2] = s.weight * section, values[3] = s.weight * section * conductivity_of<Scene>(particles, p);
      if constexpr (N::capacity_position >= 0)
        for (int c = 0; c < D; ++c) values[4 + c] = -s.weight * capacity * s.distance[c];
      add(s.node, values);
    });
  });
}

template <class Scene>
inline constexpr int conduct_scalars = Tile<Scene::dimension>::nodes;

/// Scatters -J V0 k g . grad w with g = sum T grad w.
template <class Scene>
MPM_HD void conduct(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  constexpr int D = Scene::dimension;
  T* channel[1] = {a.grid.field[N::heat_rate]};
  scatter_blocks<Scene, 1>(team, a, channel, [&](int p, auto add) {
    const Stencil<Scene> stencil(a, p);
    if (!stencil.inside()) return report(a, p);
    const T* const temperature = a.grid.field[N::temperature];
    Vec<D, T> gradient{};
    stencil.for_each_node(a, [&](const StencilNode<D, T>& s) {
      const T of_node = temperature[node_index<D>(a, s.node)];
      for (int c = 0; c < D; ++c) gradient[c] += of_node * s.gradient[c];
    });
    const T conducted = conductivity_of<Scene>(a.particles, p) * volume_of_particle<Scene>(a.particles, p);
    stencil.for_each_node(a, [&](const StencilNode<D, T>& s) {
      T rate = T(0);
      for (int c = 0; c < D; ++c) rate -= gradient[c] * s.gradient[c];
      rate *= conducted;
      add(s.node, &rate);
    });
  });
}

// ---- nodes -------------------------------------------------------------------------------------------------------

/// Computes T- = H / C. A node without heat capacity has no temperature, which is 0.
template <class Scene>
MPM_HD void divide_heat(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  for_each_node(team, a, [&](int node) {
    const T capacity = a.grid.field[N::heat_capacity][node];
    a.grid.field[N::temperature][node] = capacity > T(0) ? temperature_of(a.grid.field[N::heat][node], capacity) : T(0);
  });
}

/// Sets the temperatures that walls and boxes hold. Where several do, the last of them counts, boxes after walls. Sums
/// the heat that walls, and that boxes, give by it.
template <class Scene>
MPM_HD void impose_temperature(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  constexpr int D = Scene::dimension;
  sum_over_nodes<2>(team, a, [&](int node, double* sums) {
    const T capacity = a.grid.field[N::heat_capacity][node];
    if (!(capacity > T(0))) return;
    T& temperature = a.grid.field[N::temperature][node];
    const auto set = [&](T value, double& sum) {
      sum += double(capacity) * (double(value) - double(temperature));
      temperature = value;
    };
    int at[D];
    coordinates_of_node<D>(a, node, at);
    for_each_wall_of_node<D>(a, node, at, [&](const Fold& foot) {
      if (holds_temperature(a, foot)) set(temperature_of_wall(a, foot), sums[0]);
    });
    for (int k = 0; k < a.heat_box_count; ++k) {
      const HeatBox<T>& box = a.heat_boxes[k];
      if (box.temperature && is_inside<D>(box, at)) set(box.temperature[index_in_box<D>(box, at)], sums[1]);
    }
  });
}

/// Gives ghosts along a.axis the mirrored temperatures, which go on beyond a wall that heat comes through. What was
/// folded belongs to the particles as it was, beyond the wall: the kernel sums how much more heat that is there than at
/// the mirrors, at walls that are held at a temperature and at others.
template <class Scene>
MPM_HD void fill_temperature(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  T* const temperature = a.grid.field[N::temperature];
  sum_over<2>(team, a, a.node_count / a.extent[a.axis], [&](int line, [[maybe_unused]] double* sums) {
    for_each_fold_of_line(a, line, false, false, [&](const Fold& fold) {
      if (!(a.grid.folded[fold.ghost] >> fold.axis & 1)) return;
      const bool held = holds_temperature(a, fold);
      const T sign = T(mirror_sign(rule_heat, fold.wall, held, fold.axis, 0)), of_mirror = temperature[fold.mirror];
      temperature[fold.ghost] =
          temperature_beyond_wall(mirrored(of_mirror, sign, temperature_of_wall(a, fold)),
                                  gradient_at_wall<Scene>(a, fold, true), a.cell_size * T(fold.beyond));
      if constexpr (N::folded_capacity >= 0)
        sums[held ? 0 : 1] += double(a.grid.field[N::folded_capacity][fold.ghost]) *
                              (double(temperature[fold.ghost]) - double(of_mirror));
    });
  });
}

/// Keeps T- <- T, at ghosts too.
template <class Scene>
MPM_HD void keep_temperature(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  if constexpr (N::temperature_before >= 0)
    for_each_node(team, a,
                  [&](int node) { a.grid.field[N::temperature_before][node] = a.grid.field[N::temperature][node]; });
}

/// Takes heat through the walls that a node stands on, an axis at a time, a lane a line: the node shares what comes
/// through its area with the next nodes inward, by the shape's shares. Sums the rates of fluxes and of convection.
template <class Scene>
MPM_HD void exchange_at_walls(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  const int axis = a.axis, extent = a.extent[axis];
  int stride = 1;
  for (int c = 0; c < axis; ++c) stride *= a.extent[c];
  sum_over<2>(team, a, a.node_count / extent, [&](int line, double* sums) {
    if constexpr (N::heated_volume >= 0) {  // NVRTC 13 loses its way where the loop stands here without braces
      for (int side = 0; side < 2; ++side) {
        const WallHeat<T>& wall = a.wall_heat[axis][side];
        if (!wall.value) continue;
        const int foot = line / stride * stride * extent + line % stride +
                         (a.padding[axis] + (side == 0 ? 0 : a.cells[axis])) * stride;
        const Fold fold{foot, foot, axis, side, a.walls[axis][side], line, foot, side == 0 ? stride : -stride, 0};
        const T volume = a.grid.field[N::heated_volume][foot];
        if (!(volume > T(0))) continue;
        T circumference = T(1);
        if constexpr (Scene::axisymmetric)
          circumference = T(6.283185307179586) * (a.lower[0] + a.cell_size * T(foot % a.extent[0] - a.padding[0]));
        const T heat = flux_through_wall<Scene>(a, fold, true) * area_of_wall_node(volume, a.cell_size, circumference);
        for (int k = 0; k < a.wall_share_count; ++k) {
          const int node = foot + k * fold.inward;
          if (!(a.grid.field[N::heat_capacity][node] > T(0))) continue;
          const T rate = heat * a.wall_shares[k];
          a.grid.field[N::heat_rate][node] += rate;
          sums[wall.coefficient > T(0) ? 1 : 0] += rate;
        }
      }
    }
  });
}

/// Sums the mass of the nodes of the box that is warmed.
template <class Scene>
MPM_HD void mass_of_box(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  constexpr int D = Scene::dimension;
  sum_over_nodes<1>(team, a, [&](int node, double* sum) {
    int at[D];
    coordinates_of_node<D>(a, node, at);
    if (is_inside<D>(a.heat_boxes[a.heat_box], at)) sum[0] += a.grid.field[Scene::Node::mass][node];
  });
}

/// Gives the power of a box to its nodes by their share of its mass, and sums what they take.
template <class Scene>
MPM_HD void warm_box(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  constexpr int D = Scene::dimension;
  sum_over_nodes<1>(team, a, [&](int node, double* sum) {
    const HeatBox<T>& box = a.heat_boxes[a.heat_box];
    int at[D];
    coordinates_of_node<D>(a, node, at);
    if (!is_inside<D>(box, at)) return;
    double mass_of_box = 0;
    for (int k = 0; k < a.mass_count; ++k) mass_of_box += a.masses_of_box[k];
    if (!(mass_of_box > 0)) return;
    const T rate = box.power[index_in_box<D>(box, at)] * (a.grid.field[N::mass][node] / static_cast<T>(mass_of_box));
    a.grid.field[N::heat_rate][node] += rate;
    sum[0] += rate;
  });
}

/// Computes T+ = T- + dt R / C.
template <class Scene>
MPM_HD void warm(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using N = typename Scene::Node;
  for_each_node(team, a, [&](int node) {
    const T capacity = a.grid.field[N::heat_capacity][node];
    T& temperature = a.grid.field[N::temperature][node];
    temperature = capacity > T(0) ? warmed(temperature, a.grid.field[N::heat_rate][node], capacity, a.dt) : T(0);
  });
}

// ---- nodes to particles ------------------------------------------------------------------------------------------

/// Gathers the temperature by the transfer's gather.
template <class Scene>
MPM_HD void gather_heat(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using Transfer = typename Scene::Transfer;
  using N = typename Scene::Node;
  using P = typename Scene::Particle;
  constexpr int D = Scene::dimension;
  for_each_index(team, a.particles.count, [&](int p) {
    const Stencil<Scene> stencil(a, p);
    if (!stencil.inside()) return report(a, p);
    GatheredMoments<D, T> moments{};
    if constexpr (Scene::reads_second_moment) moments.second_moment = stencil.second_moment();
    stencil.for_each_node(a, [&](const StencilNode<D, T>& s) {
      const int node = node_index<D>(a, s.node);
      const T temperature = a.grid.field[N::temperature][node];
      moments.velocity[0] += s.weight * temperature;
      if constexpr (Scene::gathers_increment)
        moments.velocity_increment[0] += s.weight * (temperature - a.grid.field[N::temperature_before][node]);
      for (int j = 0; j < D; ++j) {
        if constexpr (Scene::affine) moments.affine(0, j) += temperature * s.affine[j];
        moments.velocity_gradient(0, j) += temperature * s.gradient[j];
      }
    });
    Vec<D, T> temperature{}, advection{};
    temperature[0] = a.particles.field[P::temperature][p];
    auto state = temperature_state<Scene>(a.particles, p);
    Transfer::gather(parameters_of<Transfer>(a.transfer_parameters), moments, a.dt, temperature, state, advection);
    a.particles.field[P::temperature][p] = temperature[0];
    if (!(temperature[0] - temperature[0] == T(0))) report(a, p);  // it is infinite or not a number
    store_temperature_state<Scene>(a.particles, p, state);
  });
}

/// Melts and freezes. Where the material's parameters become those of the other phase, the stored energy that this
/// takes away is left as dissipated.
template <class Scene>
MPM_HD void change_phase(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using T = typename Scene::Scalar;
  using P = typename Scene::Particle;
  for_each_index(team, a.particles.count, [&](int p) {
    const HeatOfBody<T>& heat = a.particles.heat;
    [[maybe_unused]] const bool was_melted = has_melted<Scene>(a.particles, p);
    [[maybe_unused]] const auto state = load_material_state<Scene>(a.particles, p);  // at the temperature before
    ::mpm::change_phase(a.particles.field[P::temperature][p], a.particles.field[P::melted_fraction][p],
                        heat.melting_temperature, heat.latent_heat, heat.heat_capacity[0], heat.heat_capacity[1]);
    if constexpr (P::dissipated >= 0) {
      T& dissipated = a.particles.field[P::dissipated][p];
      dissipated = T(0);
      if (has_melted<Scene>(a.particles, p) == was_melted) return;
      using Material = typename Scene::Material;
      using Constants = typename Material::template Constants<T>;
      const T solid = Material::stored_energy(Constants(parameters_of<Material>(a.material_parameters)), state);
      const T melted = Material::stored_energy(Constants(parameters_of<Material>(a.melted_parameters)), state);
      dissipated = was_melted ? melted - solid : solid - melted;
    }
  });
}

// ---- what the heat ledger asks -----------------------------------------------------------------------------------

/// Sums H.
template <class Scene>
MPM_HD void heat_of_nodes(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  sum_over_nodes<1>(team, a, [&](int node, double* sum) { sum[0] += a.grid.field[Scene::Node::heat][node]; });
}
/// Sums R.
template <class Scene>
MPM_HD void heat_rate_of_nodes(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  sum_over_nodes<1>(team, a, [&](int node, double* sum) { sum[0] += a.grid.field[Scene::Node::heat_rate][node]; });
}
/// Sums C T.
template <class Scene>
MPM_HD void heat_of_temperatures(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  using N = typename Scene::Node;
  sum_over_nodes<1>(team, a, [&](int node, double* sum) {
    sum[0] += double(a.grid.field[N::heat_capacity][node]) * a.grid.field[N::temperature][node];
  });
}
/// Sums m c T.
template <class Scene>
MPM_HD void heat_of_particles(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  sum_over<1>(team, a, a.particles.count, [&](int p, double* sum) {
    sum[0] += double(capacity_of_particle<Scene>(a.particles, p)) * a.particles.field[Scene::Particle::temperature][p];
  });
}
/// Sums the heat that the last strain has made of what it dissipated.
template <class Scene>
MPM_HD void heat_of_dissipation(const Team& team, const Arguments<typename Scene::Scalar>& a) {
  sum_over<1>(team, a, a.particles.count, [&](int p, double* sum) {
    if constexpr (Scene::ledger)
      sum[0] += double(of_size<Scene>(a.particles, a.particles.mass, p)) * a.particles.heat.warming *
                a.particles.field[Scene::Particle::dissipated][p];
  });
}

}  // namespace mpm::device
