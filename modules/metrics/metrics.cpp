#include "metrics/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "metrics/particle_quantities.hpp"
#include "metrics/polynomial_energy.hpp"
#include "simulation/contact_impulse.hpp"

namespace mpm {
namespace {

std::array<double, 3> cross(const double* a, const double* b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The smaller or larger of two numbers, or what is not a number where one is.
double smallest_of(double a, double b) {
  return std::isnan(b) || b < a ? b : a;
}
double largest_of(double a, double b) {
  return std::isnan(b) || b > a ? b : a;
}

/// Entry (a, b) of the shape's second moment at particle p, m^2: the particle's own, or on the diagonal the constant,
/// or f(1 - f) h^2 for the linear shape.
double second_moment(const Experiment& experiment, const BodyState& state, std::size_t p, int a, int b) {
  const mpm_shape& shape = experiment.shape.plugin->shape();
  const int D = experiment.dimension;
  const double h = experiment.grid.cell_size;
  if (!state.second_moment.empty()) return state.second_moment[p * D * D + a * D + b];
  if (a != b) return 0;
  if (shape.second_moment_kind != MPM_MOMENT_IS_GRADIENT) return shape.second_moment * h * h;
  const double cell = (state.position[p * D + a] - experiment.grid.lower[a]) / h, f = cell - std::floor(cell);
  return f * (1 - f) * h * h;
}

constexpr std::string_view book_suffix = " book";
bool is_book(const ValueRow& row) {
  return row.name.ends_with(book_suffix);
}

/// Whether the kinetic energy of a particle depends on its place in a cell.
bool moves_second_moment(const Experiment& experiment, const Plan& plan) {
  const bool carries = experiment.transfer.plugin->transfer().traits & MPM_AFFINE_CARRIES_ENERGY;
  const bool varies = experiment.shape.plugin->shape().second_moment_kind != MPM_MOMENT_CONSTANT;
  return (carries && varies) || plan.basis_functions > 0;
}

/// Adds the affine part C of a velocity over the nodes of a particle: m sum w |C d|^2 / 2 and m sum w d x (C d).
void add_affine(const Experiment& experiment, const BodyState& state, const double* C, std::size_t p, Totals& totals) {
  const int D = experiment.dimension;
  const double m = state.mass * state.ring(p);
  for (int a = 0; a < D; ++a)
    for (int b = 0; b < D; ++b) {
      const double moment = second_moment(experiment, state, p, a, b);
      if (moment == 0) continue;
      double d[3] = {}, column_a[3] = {}, column_b[3] = {};
      d[a] = 1;
      for (int c = 0; c < D; ++c) column_a[c] = C[c * D + a], column_b[c] = C[c * D + b];
      const auto spin = cross(d, column_b);
      for (int c = 0; c < 3; ++c) {
        totals.kinetic += 0.5 * m * moment * column_a[c] * column_b[c];
        totals.angular_momentum[c] += m * moment * spin[c];
      }
    }
}

}  // namespace

RecordedAxes recorded_axes(const Experiment& experiment) {
  if (experiment.axisymmetric()) return {1, 3};
  return {0, experiment.dimension == 2 ? 2 : 0};
}

Metrics::Metrics(const Simulation& simulation) : simulation_(simulation) {
  const Experiment& experiment = simulation.experiment();
  if (experiment.exact)
    for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body)
      start_.push_back(simulation.backend().body_state(body));
  initial_ = measure();
}

Totals Metrics::measure() const {
  Totals totals;
  totals.time = simulation_.time();
  totals.time_step = simulation_.last_time_step();
  totals.step = simulation_.steps();
  totals.smallest_volume_ratio = std::numeric_limits<double>::infinity();
  totals.largest_volume_ratio = -std::numeric_limits<double>::infinity();
  if (simulation_.experiment().has_temperature()) {
    totals.lowest_temperature = std::numeric_limits<double>::infinity();
    totals.highest_temperature = -std::numeric_limits<double>::infinity();
  }
  for (int body = 0; body < static_cast<int>(simulation_.experiment().bodies.size()); ++body) add_body(body, totals);
  for (double& x : totals.centre_of_mass) x /= totals.mass;
  const auto orbital = cross(totals.centre_of_mass.data(), totals.momentum.data());
  for (int c = 0; c < 3; ++c) totals.angular_momentum[c] -= orbital[c];
  const double count = static_cast<double>(simulation_.particle_count());
  totals.position_error_rms = std::sqrt(totals.position_error_rms / count);
  totals.velocity_error_rms = std::sqrt(totals.velocity_error_rms / count);
  return totals;
}

void Metrics::add_body(int body, Totals& totals) const {
  const Experiment& experiment = simulation_.experiment();
  const int D = experiment.dimension;
  const BodyState state = simulation_.backend().body_state(body);
  const MaterialQuantities material = material_quantities(experiment, body, state);
  const bool affine = experiment.transfer.plugin->transfer().traits & MPM_AFFINE_CARRIES_ENERGY;
  const double* C = affine ? state.transfer_state.at(experiment.transfer.plugin->state()[0].name).data() : nullptr;
  const std::vector<double> polynomials = polynomial_energy(experiment, simulation_.plan(), body, state);
  for (std::size_t p = 0; p < state.position.size() / D; ++p) {
    const double m = state.mass * state.ring(p);
    double x[3] = {}, v[3] = {};
    std::copy_n(&state.position[p * D], D, x);
    std::copy_n(&state.velocity[p * D], D, v);
    const double speed_squared = v[0] * v[0] + v[1] * v[1] + v[2] * v[2], speed = std::sqrt(speed_squared);
    totals.mass += m;
    totals.kinetic += 0.5 * m * speed_squared;
    totals.strain += state.volume * state.ring(p) * material.stored_energy[p];
    totals.largest_speed = largest_of(totals.largest_speed, speed);
    totals.momentum_scale += m * speed;
    totals.angular_momentum_scale += m * speed * std::hypot(x[0], x[1], x[2]);
    totals.smallest_volume_ratio = smallest_of(totals.smallest_volume_ratio, material.volume_ratio[p]);
    totals.largest_volume_ratio = largest_of(totals.largest_volume_ratio, material.volume_ratio[p]);
    const auto L = cross(x, v);
    for (int c = 0; c < 3; ++c) {
      totals.momentum[c] += m * v[c];
      totals.angular_momentum[c] += m * L[c];
      totals.centre_of_mass[c] += m * x[c];
      if (experiment.gravity_has_potential(c)) totals.gravitational -= m * experiment.gravity[c] * x[c];
    }
    if (C) add_affine(experiment, state, &C[p * D * D], p, totals);
    if (!polynomials.empty()) totals.kinetic += m * polynomials[p];
  }
  if (experiment.has_temperature()) add_heat(body, state, totals);
  if (!start_.empty()) add_errors(body, state, totals);
}

void Metrics::add_heat(int body, const BodyState& state, Totals& totals) const {
  const Experiment& experiment = simulation_.experiment();
  const Thermal& thermal = *experiment.materials[experiment.bodies[body].material].thermal;
  const std::vector<double>& temperature = state.host_state.at("temperature");
  for (std::size_t p = 0; p < temperature.size(); ++p) {
    const double m = state.mass * state.ring(p), T = temperature[p];
    const bool melted = has_melted(experiment, body, state, p);
    const double c = melted ? thermal.phase_change->melted.heat_capacity : thermal.solid.heat_capacity;
    totals.heat_content += m * c * (T - (thermal.phase_change ? thermal.phase_change->temperature : 0));
    if (thermal.phase_change)
      totals.latent_heat += m * thermal.phase_change->latent_heat * state.host_state.at("melted_fraction")[p];
    totals.lowest_temperature = smallest_of(totals.lowest_temperature, T);
    totals.highest_temperature = largest_of(totals.highest_temperature, T);
  }
}

void Metrics::add_errors(int body, const BodyState& state, Totals& totals) const {
  const Experiment& experiment = simulation_.experiment();
  const int D = experiment.dimension;
  const auto exact = make_exact_solution(experiment, simulation_.last_time_step());
  const BodyState& start = start_[body];
  for (std::size_t p = 0; p < state.position.size() / D; ++p) {
    Vector3 X{}, V{};
    std::copy_n(&start.position[p * D], D, X.begin());
    std::copy_n(&start.velocity[p * D], D, V.begin());
    const Vector3 x = exact->position(X, V, simulation_.time()), v = exact->velocity(X, V, simulation_.time());
    double dx = 0, dv = 0;
    for (int c = 0; c < D; ++c) {
      dx += std::pow(state.position[p * D + c] - x[c], 2);
      dv += std::pow(state.velocity[p * D + c] - v[c], 2);
    }
    totals.position_error_rms += dx;
    totals.velocity_error_rms += dv;
    totals.position_error_max = largest_of(totals.position_error_max, std::sqrt(dx));
    totals.velocity_error_max = largest_of(totals.velocity_error_max, std::sqrt(dv));
  }
}

double Metrics::ledger_residual(const Totals& now) const {
  if (!simulation_.plan().has_ledger()) return 0;
  return now.total_energy() - initial_.total_energy() - simulation_.ledger().explained();
}

double Metrics::heat_residual(const Totals& now) const {
  if (!simulation_.plan().has_heat_ledger()) return 0;
  const double gained = now.heat_content - initial_.heat_content + (now.latent_heat - initial_.latent_heat);
  return gained - simulation_.backend().heat_ledger().sum();
}

std::vector<ValueRow> Metrics::ledger_rows(const Totals& now) const {
  const Plan& plan = simulation_.plan();
  if (!plan.has_ledger()) return {};
  std::vector<ValueRow> rows = rows_of(simulation_.ledger());
  const bool takes_back = plan.resolves_contact() && gather_shares(simulation_.experiment()).of_velocity < 1;
  bool periodic_gravity = false, falls = false;
  for (int axis = 0; axis < simulation_.experiment().dimension; ++axis)
    if (simulation_.experiment().gravity[axis] != 0)
      (simulation_.experiment().gravity_has_potential(axis) ? falls : periodic_gravity) = true;
  const bool remaps = simulation_.experiment().solver.stress_update == StressUpdate::modified_last;
  std::erase_if(rows, [&](const ValueRow& row) {
    return is_book(row) || (!plan.filters() && (row.name == "filter" || row.name == "filtered strain")) ||
           (!(plan.filters() && falls) && row.name == "filtered gravity") ||
           (!remaps && row.name == "remapped strain") ||
           (!moves_second_moment(simulation_.experiment(), plan) && row.name == "second moment") ||
           (!periodic_gravity && row.name == "periodic gravity") || (!takes_back && row.name == "friction taken back");
  });
  rows.push_back({"residual", "J", ledger_residual(now)});
  return rows;
}

std::vector<ValueRow> Metrics::book_rows() const {
  if (!simulation_.plan().has_ledger()) return {};
  std::vector<ValueRow> rows = rows_of(simulation_.ledger());
  std::erase_if(rows, [&](const ValueRow& row) {
    return !is_book(row) || (!simulation_.plan().filters() && row.name == "filter book");
  });
  for (ValueRow& row : rows) row.name.resize(row.name.size() - book_suffix.size());
  return rows;
}

std::vector<ValueRow> Metrics::heat_ledger_rows(const Totals& now) const {
  if (!simulation_.plan().has_heat_ledger()) return {};
  std::vector<ValueRow> rows = rows_of(simulation_.backend().heat_ledger());
  rows.push_back({"residual", "J", heat_residual(now)});
  return rows;
}

std::vector<ValueRow> Metrics::rows(const Totals& t) const {
  const Experiment& experiment = simulation_.experiment();
  const Plan& plan = simulation_.plan();
  const bool flat = experiment.dimension == 2 && !experiment.axisymmetric();
  const std::string energy = flat ? "J/m" : "J", momentum = flat ? "kg/s" : "kg m/s",
                    spin = flat ? "kg m/s" : "kg m²/s", force = flat ? "N/m" : "N",
                    norm = std::string("kg^0.5 m/s") + (flat ? " per m^0.5" : "");
  const auto [first, first_spin] = recorded_axes(experiment);
  std::vector<ValueRow> rows;
  const auto add = [&](const std::string& name, const std::string& unit, double value) {
    rows.push_back({name, unit, value});
  };
  const auto add_components = [&](const std::string& name, const std::string& unit, const std::array<double, 3>& values,
                                  int begin, int end) {
    for (int c = begin; c < end; ++c) add(name + " " + "xyz"[c], unit, values[static_cast<std::size_t>(c)]);
  };
  const auto add_ledger = [&](const std::string& ledger, const std::vector<ValueRow>& entries) {
    for (const auto& [entry, unit, value] : entries)
      add(ledger + " " + entry,
          unit == "J"            ? energy
          : unit == "kg" && flat ? "kg/m"
          : unit == "kg"         ? unit
                                 : momentum,
          value);
  };
  add("time", "s", t.time);
  add("step", "", static_cast<double>(t.step));
  add("time step", "s", t.time_step);
  add("kinetic energy", energy, t.kinetic);
  add("strain energy", energy, t.strain);
  add("gravitational energy", energy, t.gravitational);
  add("total energy", energy, t.total_energy());
  add_ledger("ledger", ledger_rows(t));
  add_ledger("book", book_rows());
  add_components("momentum", momentum, t.momentum, first, experiment.dimension);
  add_components("angular momentum", spin, t.angular_momentum, first_spin, 3);
  add_components("centre of mass", "m", t.centre_of_mass, first, experiment.dimension);
  add("smallest volume ratio", "", t.smallest_volume_ratio);
  add("largest volume ratio", "", t.largest_volume_ratio);
  add("largest speed", "m/s", t.largest_speed);
  if (plan.resolves_contact()) {
    const ContactRecord& contact = simulation_.backend().contact_record();
    add_components("contact force", force, contact.force, first, experiment.dimension);
    add("contact nodes", "", static_cast<double>(contact.nodes));
    add("sticking nodes", "", static_cast<double>(contact.sticking));
    add("slipping nodes", "", static_cast<double>(contact.slipping));
    add("largest penetration", "m", contact.largest_penetration);
  }
  if (plan.filters()) {
    const FilterRecord& filter = simulation_.backend().filter_record();
    add("filter increment norm", norm, filter.last_norm);
    add("filter iterations", "", static_cast<double>(filter.iterations));
  }
  if (experiment.has_temperature()) {
    add("heat content", energy, t.heat_content);
    add("latent heat", energy, t.latent_heat);
    add("lowest temperature", "K", t.lowest_temperature);
    add("highest temperature", "K", t.highest_temperature);
  }
  add_ledger("heat ledger", heat_ledger_rows(t));
  if (experiment.exact) {
    add("position error rms", "m", t.position_error_rms);
    add("position error max", "m", t.position_error_max);
    add("velocity error rms", "m/s", t.velocity_error_rms);
    add("velocity error max", "m/s", t.velocity_error_max);
  }
  return rows;
}

std::vector<std::string> Metrics::columns() const {
  std::vector<std::string> names;
  for (const ValueRow& row : rows(initial_)) names.push_back(heading(row));
  return names;
}

std::vector<double> Metrics::row(const Totals& totals) const {
  std::vector<double> values;
  for (const ValueRow& row : rows(totals)) values.push_back(row.value);
  return values;
}

}  // namespace mpm
