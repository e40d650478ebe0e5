#include "backends/device/fields.hpp"

#include <algorithm>

#include "backends/device/particle_formulas.hpp"

namespace mpm::device {
namespace {

/// Makes a field that holds nothing between steps.
Field working_field(const std::string& id, const std::string& unit, int components) {
  Field field;
  field.id = field.name = id, field.unit = unit;
  field.components = components;
  field.lifetime = Lifetime::step;
  return field;
}

}  // namespace

std::vector<Field> node_fields(const Experiment& experiment, const Plan& plan) {
  std::vector<Field> fields;
  std::copy_if(plan.fields.begin(), plan.fields.end(), std::back_inserter(fields),
               [](const Field& field) { return field.owner == Owner::node; });
  // A projection is folded as the masses were, and walls give by what was folded, which is no longer there.
  if (plan.node_field("projection") || experiment.notes_reactions())
    fields.push_back(working_field("folded_mass", "kg", 1)), fields.back().owner = Owner::node;
  if (plan.has_ledger()) {
    for (const char* id : {"work_of_folds", "work_beyond_walls"}) {
      fields.push_back(working_field(id, "J", 1)), fields.back().owner = Owner::node;
      fields.back().cleared = true;
    }
  }
  if (plan.has_heat_ledger())
    fields.push_back(working_field("folded_capacity", "J/K", 1)), fields.back().owner = Owner::node;
  return fields;
}

std::vector<Field> particle_fields(const Experiment& experiment, const Plan& plan, int body) {
  const int D = experiment.dimension;
  std::vector<Field> fields, material;
  for (const Field& field : plan.fields) {
    if (!field.of_particles_of(body) || field.lifetime == Lifetime::seeded) continue;
    if (field.origin == Origin::host && (field.id == "melted_fraction" || field.id == "deformation" ||
                                         field.id == "size" || field.id == "artificial_pressure"))
      continue;  // they come below
    (field.origin == Origin::material ? material : fields).push_back(field);
  }
  const auto work = [&](const char* id, const char* unit, int components) {
    fields.push_back(working_field(id, unit, components));
    fields.back().body = body;
  };
  work("stress", "Pa", D == 2 ? 4 : 6);  // symmetric Kirchhoff stress
  work("volume_ratio", "", 1);
  if (plan.advance != Advance::at_once) {
    work("velocity_gradient", "1/s", D * D);
    if (experiment.axisymmetric()) work("hoop_rate", "1/s", 1);  // hoop_rate is v_r / r
  }
  work("wave_speed", "m/s", 1);
  if (plan.has_ledger())
    for (const char* id : {"dissipated", "stress_power", "stored"}) work(id, "J/m^3", 1);
  if (plan.does(Act::average_dilation)) work("mean_dilation", "1/s", 1);
  if (!experiment.grips.empty())
    for (const char* id : {"told_velocity", "gathered_velocity"}) work(id, "m/s", D);
  const bool loaded = !experiment.loaded_at_points().empty();
  // All bodies have the same numbers, those too that no formula or load needs these of.
  if (plan.node_field("mass_displacement") || ParticleFormulas(experiment).use_initial_position()) {
    if (const Field* const start = plan.particle_field(body, "initial_position"))
      fields.push_back(*start);
    else
      work("initial_position", "m", D);
  }
  if (const Field* const deformation = plan.particle_field(body, "deformation"))
    fields.push_back(*deformation);
  else if (loaded)
    work("deformation", "", D * D);
  if (plan.stencil.second_moment) work("second_moment", "cells^2", D * D);
  // All bodies have the same numbers: those whose particles are equal have the size 1, and those that cannot melt are
  // solid all along.
  if (const Field* const size = plan.particle_field(body, "size"))
    fields.push_back(*size);
  else if (std::any_of(plan.fields.begin(), plan.fields.end(), [](const Field& f) { return f.id == "size"; }))
    work("size", "", 1), fields.back().first = First::one;
  if (const Field* const melted = plan.particle_field(body, "melted_fraction"))
    fields.push_back(*melted);
  else if (std::any_of(plan.fields.begin(), plan.fields.end(),
                       [](const Field& f) { return f.id == "melted_fraction"; }))
    work("melted_fraction", "", 1);
  if (experiment.has_artificial_viscosity()) {
    if (const Field* const pressure = plan.particle_field(body, "artificial_pressure"))
      fields.push_back(*pressure);
    else
      work("artificial_pressure", "Pa", 1);  // without coefficients it stays zero
    if (plan.has_ledger()) work("artificial_work", "J/m^3", 1);
  }
  fields.insert(fields.end(), material.begin(), material.end());
  return fields;
}

int number_of(const std::vector<Field>& fields, std::string_view id, Origin origin) {
  const auto found = std::find_if(fields.begin(), fields.end(),
                                  [&](const Field& field) { return field.origin == origin && field.id == id; });
  return found == fields.end() ? -1 : static_cast<int>(found - fields.begin());
}

int first_of(const std::vector<Field>& fields, Origin origin) {
  const auto found =
      std::find_if(fields.begin(), fields.end(), [&](const Field& field) { return field.origin == origin; });
  return found == fields.end() ? -1 : static_cast<int>(found - fields.begin());
}

}  // namespace mpm::device
