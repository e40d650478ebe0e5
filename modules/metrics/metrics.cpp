#include "metrics/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "metrics/particle_quantities.hpp"
#include "metrics/polynomial_energy.hpp"

namespace mpm {
namespace {

std::array<double, 3> cross(const double* a, const double* b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
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

std::vector<std::pair<std::string, double>> rows_of(const HeatLedger& l) {
  return {{"scatter", l.scatter}, {"images", l.images},         {"gather", l.gather}, {"walls", l.walls},
          {"flux", l.flux},       {"convection", l.convection}, {"boxes", l.boxes},   {"dissipation", l.dissipation}};
}

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
    totals.largest_speed = std::max(totals.largest_speed, speed);
    totals.momentum_scale += m * speed;
    totals.angular_momentum_scale += m * speed * std::hypot(x[0], x[1], x[2]);
    totals.smallest_volume_ratio = std::min(totals.smallest_volume_ratio, material.volume_ratio[p]);
    totals.largest_volume_ratio = std::max(totals.largest_volume_ratio, material.volume_ratio[p]);
    const auto L = cross(x, v);
    for (int c = 0; c < 3; ++c) {
      totals.momentum[c] += m * v[c];
      totals.angular_momentum[c] += m * L[c];
      totals.centre_of_mass[c] += m * x[c];
      totals.gravitational -= m * experiment.gravity[c] * x[c];
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
    totals.lowest_temperature = std::min(totals.lowest_temperature, T);
    totals.highest_temperature = std::max(totals.highest_temperature, T);
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
    totals.position_error_max = std::max(totals.position_error_max, std::sqrt(dx));
    totals.velocity_error_max = std::max(totals.velocity_error_max, std::sqrt(dv));
  }
}

double Metrics::ledger_residual(const Totals& now) const {
  if (!simulation_.plan().ledger) return 0;
  const Ledger ledger = simulation_.ledger();
  const double explained = ledger.scatter + ledger.gather + ledger.filter + ledger.boundary + ledger.contact +
                           ledger.body_force - ledger.material;
  return now.total_energy() - initial_.total_energy() - explained;
}

double Metrics::heat_residual(const Totals& now) const {
  if (!simulation_.plan().heat_ledger) return 0;
  const double gained = now.heat_content - initial_.heat_content + (now.latent_heat - initial_.latent_heat);
  return gained - simulation_.backend().heat_ledger().sum();
}

std::vector<std::string> Metrics::columns() const {
  const Experiment& experiment = simulation_.experiment();
  const bool flat = experiment.dimension == 2 && !experiment.axisymmetric();
  const std::string energy = flat ? " (J/m)" : " (J)", momentum = flat ? " (kg/s)" : " (kg m/s)",
                    spin = flat ? " (kg m/s)" : " (kg m²/s)";
  std::vector<std::string> names{"time (s)", "step", "time step (s)"};
  for (const char* name : {"kinetic energy", "strain energy", "gravitational energy", "total energy"})
    names.push_back(name + energy);
  if (simulation_.plan().ledger) {
    for (const char* name : {"scatter", "gather", "internal force", "gravity", "body force", "boundary", "contact",
                             "friction", "material dissipation"})
      names.push_back(std::string("ledger ") + name + energy);
    if (simulation_.plan().filter) names.push_back("ledger filter" + energy);
    names.push_back("ledger residual" + energy);
  }
  const auto [first, first_spin] = recorded_axes(experiment);
  for (int c = first; c < experiment.dimension; ++c) names.push_back(std::string("momentum ") + "xyz"[c] + momentum);
  for (int c = first_spin; c < 3; ++c) names.push_back(std::string("angular momentum ") + "xyz"[c] + spin);
  for (int c = first; c < experiment.dimension; ++c)
    names.push_back(std::string("centre of mass ") + "xyz"[c] + " (m)");
  for (const char* name : {"smallest volume ratio", "largest volume ratio", "largest speed (m/s)"})
    names.emplace_back(name);
  if (simulation_.plan().contact) {
    for (int c = first; c < experiment.dimension; ++c)
      names.push_back(std::string("contact force ") + "xyz"[c] + (flat ? " (N/m)" : " (N)"));
    for (const char* name : {"contact nodes", "sticking nodes", "slipping nodes", "largest penetration (m)"})
      names.emplace_back(name);
  }
  if (simulation_.plan().filter) {
    names.push_back(std::string("filter increment norm (kg^0.5 m/s") + (flat ? " per m^0.5)" : ")"));
    names.emplace_back("filter iterations");
  }
  if (experiment.has_temperature()) {
    names.insert(names.end(), {"heat content" + energy, "latent heat" + energy});
    names.insert(names.end(), {"lowest temperature (K)", "highest temperature (K)"});
  }
  if (simulation_.plan().heat_ledger) {
    for (const auto& [name, heat] : rows_of({})) names.push_back("heat ledger " + name + energy);
    names.push_back("heat ledger residual" + energy);
  }
  if (experiment.exact)
    for (const char* name :
         {"position error rms (m)", "position error max (m)", "velocity error rms (m/s)", "velocity error max (m/s)"})
      names.emplace_back(name);
  return names;
}

std::vector<double> Metrics::row(const Totals& t) const {
  const Experiment& experiment = simulation_.experiment();
  std::vector<double> values{
      t.time, static_cast<double>(t.step), t.time_step, t.kinetic, t.strain, t.gravitational, t.total_energy()};
  if (simulation_.plan().ledger) {
    const Ledger l = simulation_.ledger();
    values.insert(values.end(), {l.scatter, l.gather, l.internal_force, l.gravity, l.body_force, l.boundary, l.contact,
                                 l.friction, l.material});
    if (simulation_.plan().filter) values.push_back(l.filter);
    values.push_back(ledger_residual(t));
  }
  const auto [first, first_spin] = recorded_axes(experiment);
  values.insert(values.end(), t.momentum.begin() + first, t.momentum.begin() + experiment.dimension);
  values.insert(values.end(), t.angular_momentum.begin() + first_spin, t.angular_momentum.end());
  values.insert(values.end(), t.centre_of_mass.begin() + first, t.centre_of_mass.begin() + experiment.dimension);
  values.insert(values.end(), {t.smallest_volume_ratio, t.largest_volume_ratio, t.largest_speed});
  if (simulation_.plan().contact) {
    const ContactRecord& c = simulation_.backend().contact_record();
    values.insert(values.end(), c.force.begin() + first, c.force.begin() + experiment.dimension);
    values.insert(values.end(), {static_cast<double>(c.nodes), static_cast<double>(c.sticking),
                                 static_cast<double>(c.slipping), c.largest_penetration});
  }
  if (simulation_.plan().filter) {
    const FilterRecord& f = simulation_.backend().filter_record();
    values.insert(values.end(), {f.last_norm, static_cast<double>(f.iterations)});
  }
  if (experiment.has_temperature())
    values.insert(values.end(), {t.heat_content, t.latent_heat, t.lowest_temperature, t.highest_temperature});
  if (simulation_.plan().heat_ledger) {
    for (const auto& [name, heat] : rows_of(simulation_.backend().heat_ledger())) values.push_back(heat);
    values.push_back(heat_residual(t));
  }
  if (experiment.exact)
    values.insert(values.end(),
                  {t.position_error_rms, t.position_error_max, t.velocity_error_rms, t.velocity_error_max});
  return values;
}

}  // namespace mpm
