#pragma once
// What a device keeps: the particles of a body and the nodes of a velocity field, each as arrays by the field.

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "backends/device/field_arrays.hpp"
#include "backends/device/kernels/arrays.hpp"  // load_corners
#include "backends/device/load_arrays.hpp"
#include "backends/device/sorting.hpp"
#include "kernel/corner_domain.hpp"
#include "simulation/backend.hpp"

namespace mpm::device {

/// The particles of one body.
template <class T>
struct Body {
  const Component* material;
  const Thermal* thermal = nullptr;  ///< null in scenes without temperature
  HeatOfBody<T> heat{};
  double Ledger::*dissipation = nullptr;  ///< the row of what the material dissipates
  ArtificialViscosity<T> viscosity{};     ///< zeros where the material has none
  int number_of_body = 0, field = 0, material_number = 0, count = 0, dimension = 2;
  bool frozen = false;
  T mass = 0, volume = 0, half_size = 0;
  FieldArrays<T> arrays;
  std::vector<double> initial_position;               ///< particle-major; empty unless planned
  DeviceArray<double> parameters, melted_parameters;  ///< of all particles, and of the melted ones where it melts
  Blocks blocks;
  CarriedLoads<T> carried;

  /// `scene` holds cells and padding.
  Body(Device& device, const Experiment& experiment, const Plan& plan, const Arguments<T>& scene, int index,
       const SeededBody& seeded, const BodyLoads& loads)
      : dimension(experiment.dimension),
        arrays(device, "the particles of " + experiment.bodies[index].name, particle_fields(experiment, plan, index),
               seeded.count()),
        parameters(device, "the parameters of a material"),
        melted_parameters(device, "the parameters of a melted material"),
        blocks(device, experiment.bodies[index].name, scene, experiment.dimension, seeded.count()),
        carried(device, experiment.bodies[index].name, loads) {
    const BodySpecification& body = experiment.bodies[index];
    number_of_body = index, frozen = body.frozen;
    material = &experiment.materials[body.material].component;
    dissipation = dissipation_of(*material->plugin);
    if (const auto& given = experiment.materials[body.material].thermal) {
      thermal = &*given;
      heat = heat_of(*thermal, material->parameter("density"));
    }
    if (const auto& given = experiment.materials[body.material].artificial_viscosity) {
      const double h = experiment.grid.cell_size;
      viscosity = {static_cast<T>(material->parameter("density")), static_cast<T>(given->linear * h),
                   static_cast<T>(given->quadratic * h * h)};
    }
    field = body.field, material_number = body.material, count = static_cast<int>(seeded.count());
    mass = static_cast<T>(seeded.mass), volume = static_cast<T>(seeded.volume);
    const double half = 0.5 / body.particles_per_cell_axis;
    half_size = static_cast<T>(half);
    begin(half);
    take(seeded);
    parameters.upload(material->parameters);
    if (melts()) melted_parameters.upload(thermal->phase_change->melted_parameters);
    if (const Field* const place = plan.particle_field(index, "initial_position"))
      initial_position = seeded.values(*place);
  }

  /// Gives fields the values that they start with, where these are not zero.
  void begin(double half) {
    for (int number = 0; number < static_cast<int>(arrays.fields().size()); ++number) {
      const Field& field = arrays.fields()[static_cast<std::size_t>(number)];
      std::vector<T> values(arrays.size(number));
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<T>(first_value(field, static_cast<int>(i / arrays.count()), dimension, half));
      if (field.first != First::zero && field.first != First::seeded) arrays.write(number, values);
    }
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
    std::vector<double> around(seeded.count());
    for (std::size_t p = 0; p < around.size(); ++p)
      around[p] = 2 * std::numbers::pi * seeds.position[p * static_cast<std::size_t>(dimension)];
    arrays.take(size, around);
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
  /// The parameters of the melted particles on the device; for bodies that cannot melt, those of all.
  const double* of_melted() const { return melts() ? melted_parameters.data() : parameters.data(); }

  // What follows looks at values that were read from the device.

  /// A component of a vector among the values of its field.
  double component(const std::vector<T>& values, std::size_t p, std::size_t c) const {
    return values[c * arrays.count() + p];
  }
  Vector3 vector(const std::vector<T>& values, std::size_t p) const {
    Vector3 v{};
    for (std::size_t c = 0; c < static_cast<std::size_t>(dimension); ++c) v[c] = component(values, p, c);
    return v;
  }

  /// Whether a particle's corners, if it has any, have passed one another; false for what is not a number.
  bool turned_inside_out(std::string_view corners, int p) const {
    const std::vector<T> values = arrays.read(corners);
    if (values.empty()) return false;
    return dimension == 2 ? turned_inside_out<2>(values.data(), p) : turned_inside_out<3>(values.data(), p);
  }
  template <int D>
  bool turned_inside_out(const T* array, int p) const {
    Vec<D, T> corner[1 << D];
    load_corners<D>(array, count, p, corner);
    const CornerDomain<D, T> domain = corner_domain<D, T>(corner);
    return !domain.upright && std::isfinite(domain.volume);
  }

  ParticleArrays<T> table() const {
    ParticleArrays<T> table{count,          count, mass, volume,    half_size,      number_of_body,
                            frozen ? 1 : 0, {},    heat, viscosity, carried.table()};
    arrays.point(table.field);
    return table;
  }
};

/// The nodes of one velocity field.
template <class T>
struct VelocityField {
  FieldArrays<T> arrays;
  DeviceArray<int> folded;
  DeviceArray<unsigned char> active;
  DeviceArray<GripArrays<T>> grips;  ///< what the particles of grips give these nodes

  VelocityField(Device& device, const Experiment& experiment, const Plan& plan, std::size_t nodes)
      : arrays(device, "the nodes", node_fields(experiment, plan), nodes),
        folded(device, "the nodes", nodes),
        active(device, "the nodes", runs_of(nodes)),
        grips(device, "the grips") {
    folded.clear();
    active.clear();
    std::vector<GripArrays<T>> all;
    for (std::size_t k = 0; k < experiment.grips.size(); ++k) all.push_back(grip(experiment, k));
    grips.upload(all);
  }

  GripArrays<T> grip(const Experiment& experiment, std::size_t k) const {
    const auto array = [&](const std::string& id) { return arrays.of(std::string_view(id)); };
    const std::string id = grip_field(k);
    int given = 0;
    for (int c = 0; c < experiment.dimension; ++c) given |= int(experiment.grips[k].held[c]) << c;
    return {array(id + "_mass"), array(id), array(id + "_before"), given, experiment.support_of_grip(k)};
  }

  NodeArrays<T> table() const {
    NodeArrays<T> table{{}, folded.data(), active.data()};
    arrays.point(table.field);
    return table;
  }
  std::uint64_t bytes() const { return arrays.bytes() + folded.bytes() + active.bytes(); }
  /// How many runs of nodes are noted apart.
  static std::size_t runs_of(std::size_t nodes) { return (nodes + nodes_of_run - 1) / nodes_of_run; }
};

}  // namespace mpm::device
