#include "simulation/failure.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <tuple>

#include "experiment/diagnostics.hpp"
#include "simulation/boundary.hpp"
#include "simulation/formula_problem.hpp"

namespace mpm {
namespace {

/// The checks of a pass, in their order.
enum class Looks { at_domain, at_force, at_temperature, at_deformation, at_position, at_speed, at_number };

constexpr const char* smaller_step =
    "a smaller /solver/courant or /solver/time_step, a transfer with more damping, or a material that is stiffer when "
    "crushed";
constexpr const char* finite_expressions =
    "check the expressions of the file (velocities, /body_force, /loads, moving walls) at that place and time; where "
    "they are finite, a smaller /solver/courant or /solver/time_step";
constexpr const char* finite_force =
    "check that expression: wherever a particle comes and up to /solver/end_time it has to give a finite number; "
    "comparisons and ? : leave points out (x > 0 ? log(x) : 0), max(x, 1e-9) bounds a term";
constexpr const char* finite_heat =
    "check the expressions that warm or cool (temperatures, fluxes, heating) at that place and time; where they are "
    "finite, a smaller /solver/courant or /solver/time_step";

struct Entry {
  Cause cause;
  Looks looks;
  const char *name, *remedy;
};
constexpr std::array entries{
    Entry{Cause::domain_outgrew_stencil, Looks::at_domain, "its domain has grown too long",
          "/shape/type \"cpdi\", or more particles a cell (particles_per_cell_axis of the body), so that a longer "
          "stretch fits the stencil; a smaller step changes nothing where the stretch is meant"},
    Entry{Cause::domain_inside_out, Looks::at_domain, "its domain is turned inside out",
          "a smaller /solver/courant or /solver/time_step, or a shape that follows the deformation gradient "
          "(/shape/type \"cpdi\")"},
    Entry{Cause::domain_beyond_grid, Looks::at_domain, "its domain reaches too far",
          "a larger /grid/domain, more particles a cell (particles_per_cell_axis of the body), so that a domain is "
          "shorter, or a shape whose domain does not follow the deformation (\"gimp\"); a smaller step changes nothing "
          "where the stretch is meant"},
    Entry{Cause::force_not_a_number, Looks::at_force, "not a number", finite_force},
    Entry{Cause::temperature_not_a_number, Looks::at_temperature, "not a number", finite_heat},
    Entry{Cause::deformation_not_a_number, Looks::at_deformation, "not a number", finite_expressions},
    Entry{Cause::inverted, Looks::at_deformation, "inverted", smaller_step},
    Entry{Cause::position_not_a_number, Looks::at_position, "not a number", finite_expressions},
    Entry{Cause::reached_axis, Looks::at_position, "reached the axis r = 0",
          "a smaller /solver/courant or /solver/time_step, or a transfer whose particles move with the velocity of the "
          "grid (\"apic\"), which is zero across the axis"},
    Entry{Cause::left_domain, Looks::at_position, "left the domain",
          "a larger /grid/domain, or a wall that holds the material (/grid/boundaries); where a particle flew off that "
          "should not have, a smaller /solver/courant or /solver/time_step"},
    Entry{Cause::speed_not_a_number, Looks::at_speed, "not a number", finite_expressions},
    Entry{Cause::too_many_particles, Looks::at_number, "too many particles",
          "a larger max_particles of the emitter, where the memory holds them; an earlier \"until\", a sink where the "
          "material leaves the scene, larger cells or fewer particles a cell"},
    Entry{Cause::no_particle_left, Looks::at_number, "no particle is left",
          "a /solver/end_time before the sinks have taken everything, or an emitter that goes on"}};

constexpr auto causes = [] {
  std::array<Cause, entries.size()> all{};
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = entries[k].cause;
  return all;
}();
static_assert([] {
  for (std::size_t k = 0; k < causes.size(); ++k)
    if (static_cast<std::size_t>(causes[k]) != k) return false;
  return causes.back() == Cause::no_particle_left;
}());

const Entry& entry_of(Cause cause) {
  return entries[static_cast<std::size_t>(cause)];
}

std::string axis_name(const Failure& failure) {
  return std::string(1, "xyz"[failure.axis]);
}

std::string shape_text(const Experiment& experiment) {
  return "shape " + in_quotes(experiment.shape.plugin->id());
}

}  // namespace

std::span<const Cause> all_causes() {
  return causes;
}

const char* name_of(Cause cause) {
  return entry_of(cause).name;
}

bool represents(Precision precision, double value) {
  const double most =
      precision == Precision::single ? std::numeric_limits<float>::max() : std::numeric_limits<double>::max();
  return std::abs(value) <= most;
}

bool gives_numbers(const Experiment& experiment, const VectorExpression& formula, const Vector3& x, const Vector3& X,
                   double time) {
  const Vector3 given = formula(x, X, time);
  for (int c = 0; c < experiment.dimension; ++c)
    if (!represents(experiment.precision, given[c])) return false;
  if (experiment.precision != Precision::single) return true;
  float at[6], values[3];
  PointArrays<float> point;
  for (int c = 0; c < 3; ++c) {
    at[c] = static_cast<float>(x[c]), at[3 + c] = static_cast<float>(X[c]);
    point.x[c] = at + c, point.X[c] = at + 3 + c;
  }
  return formula.evaluate(1, point, time, {values, values + 1, values + 2}) == 1;
}

Failure force_failure(const Experiment& experiment, const Load* load, int body, std::size_t particle, const Vector3& x,
                      const Vector3& X, double time) {
  const LoadValue value = value_of(load ? load->type : LoadType::body_force);
  const VectorExpression& expression = load ? load->value : *experiment.body_force;
  const std::optional<NotFinite> found = expression.not_finite(x, X, time);
  Failure failure{Cause::force_not_a_number, body, particle, found ? found->component : 0};
  if (found) {
    failure.value = found->value;
  } else {
    const Vector3 given = expression(x, X, time);
    for (int c = experiment.dimension - 1; c >= 0; --c) {
      if (represents(experiment.precision, given[c])) continue;
      failure.axis = c, failure.value = std::copysign(std::numeric_limits<double>::infinity(), given[c]);
    }
  }
  failure.name = value.name + (value.is_vector ? " along " + axis_name(failure) : "");
  failure.unit = value.unit;
  const std::string pointer = load ? load->pointer + "/" + value.key : experiment.body_force_pointer;
  failure.formula = problem_at(experiment, pointer_of(pointer, value.is_vector, failure.axis),
                               not_finite_text("t = " + number_text(time) + " s", found ? found->why : ""))
                        .text();
  return failure;
}

bool comes_before(const Failure& a, const Failure& b) {
  const auto key = [](const Failure& f) {
    return std::tuple(entry_of(f.cause).looks, f.body, f.particle, f.axis, f.cause);
  };
  return key(a) < key(b);
}

std::string cause_text(const Failure& failure, const Experiment& experiment) {
  std::ostringstream text;
  text << name_of(failure.cause);
  switch (failure.cause) {
    case Cause::domain_outgrew_stencil:
      text << " for the " << experiment.shape.plugin->shape().width << " nodes an axis of " << shape_text(experiment);
      break;
    case Cause::domain_inside_out:
      text << ": the corners that " << shape_text(experiment) << " moves with the grid have passed one another";
      break;
    case Cause::domain_beyond_grid:
      text.str("");
      text << "its domain reaches more than " << grid_padding_of(experiment.shape.plugin->shape())
           << " cells beyond the domain's edge";
      break;
    case Cause::force_not_a_number:
      text << ": " << failure.formula;
      break;
    case Cause::temperature_not_a_number:
      text << ": its temperature is no longer finite";
      break;
    case Cause::deformation_not_a_number:
      text << ": its deformation is no longer finite";
      break;
    case Cause::inverted:
      text << ": its volume ratio J is not positive";
      break;
    case Cause::position_not_a_number:
      text << ": its position is no longer finite";
      break;
    case Cause::reached_axis:
      text << ", where its ring has no circumference";
      break;
    case Cause::left_domain:
      text << " at " << axis_name(failure) << " = " << failure.value << " m";
      break;
    case Cause::speed_not_a_number:
      text << ": its wave or particle speed gives no time step";
      break;
    case Cause::too_many_particles:
      text << ": ";
      if (failure.formula.empty())
        text << "body " << in_quotes(experiment.bodies[failure.body].name) << " may have " << failure.value
             << ", as its emitter says";
      text << failure.formula;
      break;
    case Cause::no_particle_left:
      text << ": sinks have taken all of the scene";
      break;
  }
  return text.str();
}

std::string point_text(std::span<const double> position) {
  std::string text = "(";
  for (std::size_t c = 0; c < position.size(); ++c) {
    char number[32];
    std::snprintf(number, sizeof number, "%s%.6g", c ? ", " : "", position[c]);
    text += number;
  }
  return text + ") m";
}

std::string place_text(const Failure& failure, const FailurePlace& place, const Experiment& experiment) {
  if (!is_of_a_particle(failure.cause))
    return "after step " + std::to_string(place.step) + ", t = " + number_text(place.time) + " s";
  return "step " + std::to_string(place.step) + ", t = " + number_text(place.time) + " s: particle " +
         std::to_string(failure.particle) + " of body " + in_quotes(experiment.bodies[failure.body].name) + " at " +
         point_text(place.position);
}

std::string remedy_for(const Failure& failure, const Experiment& experiment) {
  if (failure.cause == Cause::inverted && experiment.shape.plugin->id() == "linear")
    return "another shape (/shape/type \"bspline_quadratic\"): with the linear one a particle near a node or between "
           "cells inverts at any step, and smaller steps do not help; where nothing moves far, stiffer material or "
           "more particles a cell";
  return entry_of(failure.cause).remedy;
}

std::vector<ValueRow> values_of(const Failure& failure, const Experiment& experiment) {
  switch (failure.cause) {
    case Cause::domain_outgrew_stencil:
      return {{"nodes an axis", "", static_cast<double>(experiment.shape.plugin->shape().width)}};
    case Cause::domain_inside_out:
    case Cause::deformation_not_a_number:
      return {};
    case Cause::domain_beyond_grid:
      return {{"longest reach", "cells", static_cast<double>(grid_padding_of(experiment.shape.plugin->shape()))}};
    case Cause::force_not_a_number:
      return {{failure.name, failure.unit, failure.value}};
    case Cause::temperature_not_a_number:
      return {{"temperature", "K", failure.value}};
    case Cause::inverted:
      return {{"volume ratio", "", failure.value}};
    case Cause::position_not_a_number:
      return {{axis_name(failure), "m", failure.value}};
    case Cause::reached_axis:
      return {{"r", "m", failure.value}};
    case Cause::left_domain:
      return {{axis_name(failure), "m", failure.value},
              {"lower end", "m", experiment.grid.lower[failure.axis]},
              {"upper end", "m", experiment.grid.upper[failure.axis]}};
    case Cause::speed_not_a_number:
      return {{"speed", "m/s", failure.value}};
    case Cause::too_many_particles:
      return {{"max_particles", "", failure.value}};
    case Cause::no_particle_left:
      return {};
  }
  return {};
}

}  // namespace mpm
