#pragma once
// What the host-run device keeps: the particles of a body and the nodes of a velocity field, each as arrays by the field.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "backends/device/conditions.hpp"
#include "backends/device/field_arrays.hpp"
#include "backends/device/kernels/arrays.hpp"  // load_corners
#include "kernel/corner_domain.hpp"
#include "simulation/backend.hpp"

namespace mpm::device {

/// The particles of one body.
template <class T>
struct Body {
  const Component* material;
  const Thermal* thermal = nullptr;  ///< null in scenes without temperature
  HeatOfBody<T> heat{};
  int field = 0, material_number = 0, count = 0, dimension = 2;
  bool frozen = false;
  T mass = 0, volume = 0, half_size = 0;
  FieldArrays<T> arrays;
  std::vector<double> initial_position;  ///< particle-major; empty unless planned
  std::vector<int> block_cell, block_begin, order;

  Body(const Experiment& experiment, const Plan& plan, int index, const SeededBody& seeded)
      : dimension(experiment.dimension), arrays(particle_fields(experiment, plan, index), seeded.count()) {
    const BodySpecification& body = experiment.bodies[index];
    frozen = body.frozen;
    material = &experiment.materials[body.material].component;
    if (const auto& given = experiment.materials[body.material].thermal) {
      thermal = &*given;
      heat = heat_of(*thermal, material->parameter("density"));
    }
    field = body.field, material_number = body.material, count = static_cast<int>(seeded.count());
    mass = static_cast<T>(seeded.mass), volume = static_cast<T>(seeded.volume);
    const double half = 0.5 / body.particles_per_cell_axis;
    half_size = static_cast<T>(half);
    for (int number = 0; number < static_cast<int>(arrays.fields().size()); ++number)
      for (int k = 0; k < arrays.fields()[number].components; ++k)
        std::fill_n(arrays.of(number) + static_cast<std::size_t>(k) * arrays.count(), count,
                    static_cast<T>(first_value(arrays.fields()[number], k, dimension, half)));
    take(seeded);
    if (const Field* const place = plan.particle_field(index, "initial_position"))
      initial_position = seeded.values(*place);
  }

  /// Takes what seeding gives.
  void take(const SeededBody& seeded) {
    for (int number = 0; number < static_cast<int>(arrays.fields().size()); ++number)
      if (arrays.fields()[number].first == First::seeded) arrays.take(number, seeded.values(arrays.fields()[number]));
    const SeedArrays seeds = seeded.arrays();
    if (!seeds.velocity_gradient.empty())
      arrays.take(first_of(arrays.fields(), Origin::transfer), seeds.velocity_gradient);
    const int size = number("size");
    if (size < 0 || arrays.fields()[size].first != First::seeded || seeded.with_size) return;
    for (int p = 0; p < count; ++p)
      arrays.of(size)[p] =
          static_cast<T>(2 * std::numbers::pi * seeds.position[static_cast<std::size_t>(p) * dimension]);
  }
  int number(std::string_view id) const { return number_of(arrays.fields(), id); }

  static HeatOfBody<T> heat_of(const Thermal& thermal, double density) {
    const PhaseChange unchanged{0, 0, thermal.solid, {}, {}};
    const PhaseChange& change = thermal.phase_change ? *thermal.phase_change : unchanged;
    return {{static_cast<T>(thermal.solid.conductivity), static_cast<T>(change.melted.conductivity)},
            {static_cast<T>(thermal.solid.heat_capacity), static_cast<T>(change.melted.heat_capacity)},
            static_cast<T>(change.temperature),
            static_cast<T>(change.latent_heat),
            static_cast<T>(thermal.dissipation_to_heat / density)};
  }
  bool melts() const { return thermal && thermal->phase_change; }
  /// The parameters of the material's melted particles; for bodies that cannot melt, those of all particles.
  const double* melted_parameters() const {
    return melts() ? thermal->phase_change->melted_parameters.data() : material->parameters.data();
  }

  /// A component of a vector in its array.
  double component(const T* array, int p, int c) const { return array[static_cast<std::size_t>(c) * count + p]; }
  Vector3 vector(const T* array, int p) const {
    Vector3 v{};
    for (int c = 0; c < dimension; ++c) v[c] = component(array, p, c);
    return v;
  }

  /// Whether a particle's corners, if it has any, have passed one another; false for what is not a number.
  bool turned_inside_out(std::string_view corners, int p) const {
    const T* const array = arrays.of(corners);
    return array && (dimension == 2 ? turned_inside_out<2>(array, p) : turned_inside_out<3>(array, p));
  }
  template <int D>
  bool turned_inside_out(const T* array, int p) const {
    Vec<D, T> corner[1 << D];
    load_corners<D>(array, count, p, corner);
    const CornerDomain<D, T> domain = corner_domain<D, T>(corner);
    return !domain.upright && std::isfinite(domain.volume);
  }

  ParticleArrays<T> table() {
    ParticleArrays<T> table{count, count, mass, volume, half_size, frozen ? 1 : 0, {}, heat};
    arrays.point(table.field);
    return table;
  }

  /// Sorts particles into blocks of cells, blocks in order of their cells. A position that is no number goes to block
  /// 0, where the scatter reports it.
  void sort(const Arguments<T>& a) {
    const T* const position = arrays.of("position");
    std::map<std::array<int, 3>, std::vector<int>> blocks;
    for (int p = 0; p < count; ++p) {
      std::array<int, 3> cell{};
      for (int c = 0; c < dimension; ++c) {
        const T x = (position[static_cast<std::size_t>(c) * count + p] - a.lower[c]) * a.inverse_cell_size;
        if (std::abs(x) < T(1e9)) cell[c] = static_cast<int>(std::floor(x / block_cells)) * block_cells;
      }
      blocks[cell].push_back(p);
    }
    block_cell.clear(), order.clear(), block_begin = {0};
    for (const auto& [cell, particles] : blocks) {
      block_cell.insert(block_cell.end(), cell.begin(), cell.end());
      order.insert(order.end(), particles.begin(), particles.end());
      block_begin.push_back(static_cast<int>(order.size()));
    }
  }
  int blocks() const { return static_cast<int>(block_begin.size()) - 1; }
};

/// The nodes of one velocity field.
template <class T>
struct VelocityField {
  FieldArrays<T> arrays;
  std::vector<int> folded;

  VelocityField(const Experiment& experiment, const Plan& plan, std::size_t nodes)
      : arrays(node_fields(experiment, plan), nodes), folded(nodes) {}
  NodeArrays<T> table() {
    NodeArrays<T> table{{}, folded.data()};
    arrays.point(table.field);
    return table;
  }
  std::uint64_t bytes() const { return arrays.bytes() + folded.size() * sizeof(int); }
};

}  // namespace mpm::device
