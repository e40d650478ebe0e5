#include "metrics/body_sums.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "metrics/polynomial_energy.hpp"
#include "support/numbers.hpp"

namespace mpm {
namespace {

using support::infinity;

std::array<double, 3> cross(const double* a, const double* b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Adds the affine part C of a velocity over the nodes of a particle: m sum w |C d|^2 / 2 and m sum w d x (C d).
void add_affine(const Experiment& experiment, const BodyState& state, const double* C, std::size_t p, Totals& totals) {
  const int D = experiment.dimension;
  const double m = state.mass * state.size_of(p);
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

double smallest_of(double a, double b) {
  return std::isnan(b) || b < a ? b : a;
}
double largest_of(double a, double b) {
  return std::isnan(b) || b > a ? b : a;
}

RecordedAxes recorded_axes(const Experiment& experiment) {
  if (experiment.axisymmetric()) return {1, 3};
  return {0, experiment.dimension == 2 ? 2 : 0};
}

RecordedUnits units_of(const Experiment& experiment) {
  if (experiment.dimension == 2 && !experiment.axisymmetric())
    return {true, "kg/m", "J/m", "kg/s", "kg m/s", "N/m", "N", "m", "kg m"};
  return {false, "kg", "J", "kg m/s", "kg m²/s", "N", "N m", "m²", "kg m²"};
}

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

BodyView::BodyView(const Experiment& scene, const Plan& plan, int index, BodyState of_body)
    : experiment(scene),
      body(index),
      state(std::move(of_body)),
      material(material_quantities(experiment, index, state)),
      polynomials(polynomial_energy(experiment, plan, index, state)),
      count(state.position.size() / static_cast<std::size_t>(experiment.dimension)) {
  const Plugin& transfer = *experiment.transfer.plugin;
  if (transfer.transfer().traits & MPM_AFFINE_CARRIES_ENERGY)
    affine_velocity = state.transfer_state.at(transfer.state()[0].name).data();
}

Totals no_totals(const Experiment& experiment) {
  Totals totals;
  totals.smallest_volume_ratio = infinity;
  totals.largest_volume_ratio = -infinity;
  if (!experiment.has_temperature()) return totals;
  totals.lowest_temperature = infinity;
  totals.highest_temperature = -infinity;
  return totals;
}

void add_particle(const BodyView& view, std::size_t p, Totals& totals) {
  const Experiment& experiment = view.experiment;
  const int D = experiment.dimension;
  const double m = view.mass(p);
  double x[3] = {}, v[3] = {};
  std::copy_n(&view.state.position[p * D], D, x);
  std::copy_n(&view.state.velocity[p * D], D, v);
  const double speed_squared = v[0] * v[0] + v[1] * v[1] + v[2] * v[2], speed = std::sqrt(speed_squared);
  totals.mass += m;
  totals.kinetic += 0.5 * m * speed_squared;
  totals.strain += view.initial_volume(p) * view.material.stored_energy[p];
  totals.largest_speed = largest_of(totals.largest_speed, speed);
  totals.momentum_scale += m * speed;
  totals.angular_momentum_scale += m * speed * std::hypot(x[0], x[1], x[2]);
  totals.smallest_volume_ratio = smallest_of(totals.smallest_volume_ratio, view.material.volume_ratio[p]);
  totals.largest_volume_ratio = largest_of(totals.largest_volume_ratio, view.material.volume_ratio[p]);
  const auto L = cross(x, v);
  for (int c = 0; c < 3; ++c) {
    totals.momentum[c] += m * v[c];
    totals.angular_momentum[c] += m * L[c];
    totals.centre_of_mass[c] += m * x[c];
    if (experiment.gravity_has_potential(c)) totals.gravitational -= m * experiment.gravity[c] * x[c];
  }
  if (view.affine_velocity) add_affine(experiment, view.state, view.affine_velocity + p * D * D, p, totals);
  if (!view.polynomials.empty()) totals.kinetic += m * view.polynomials[p];
}

void add_heat(const BodyView& view, std::size_t p, Totals& totals) {
  const Experiment& experiment = view.experiment;
  const Thermal& thermal = *experiment.materials[experiment.bodies[view.body].material].thermal;
  const double m = view.mass(p), T = view.state.host_state.at("temperature")[p];
  const bool melted = has_melted(experiment, view.body, view.state, p);
  const double c = melted ? thermal.phase_change->melted.heat_capacity : thermal.solid.heat_capacity;
  totals.heat_content += m * c * (T - (thermal.phase_change ? thermal.phase_change->temperature : 0));
  if (thermal.phase_change)
    totals.latent_heat += m * thermal.phase_change->latent_heat * view.state.host_state.at("melted_fraction")[p];
  totals.lowest_temperature = smallest_of(totals.lowest_temperature, T);
  totals.highest_temperature = largest_of(totals.highest_temperature, T);
}

void add_sums(const Totals& more, Totals& totals) {
  for (double Totals::*sum :
       {&Totals::mass, &Totals::kinetic, &Totals::strain, &Totals::gravitational, &Totals::momentum_scale,
        &Totals::angular_momentum_scale, &Totals::heat_content, &Totals::latent_heat})
    totals.*sum += more.*sum;
  for (std::array<double, 3> Totals::*vector : {&Totals::momentum, &Totals::angular_momentum, &Totals::centre_of_mass})
    for (std::size_t c = 0; c < 3; ++c) (totals.*vector)[c] += (more.*vector)[c];
  for (double Totals::*least : {&Totals::smallest_volume_ratio, &Totals::lowest_temperature})
    totals.*least = smallest_of(totals.*least, more.*least);
  for (double Totals::*most : {&Totals::largest_volume_ratio, &Totals::largest_speed, &Totals::highest_temperature})
    totals.*most = largest_of(totals.*most, more.*most);
}

void refer_to_centre_of_mass(Totals& totals) {
  for (double& x : totals.centre_of_mass) x /= totals.mass;
  const auto orbital = cross(totals.centre_of_mass.data(), totals.momentum.data());
  for (int c = 0; c < 3; ++c) totals.angular_momentum[c] -= orbital[c];
}

PartSums::PartSums(const Experiment& experiment)
    : totals(no_totals(experiment)), smallest_pressure(infinity), largest_pressure(-infinity) {}

void PartSums::add(const BodyView& view, std::size_t p) {
  const int D = view.experiment.dimension;
  add_particle(view, p, totals);
  if (view.experiment.has_temperature()) add_heat(view, p, totals);
  const double m = view.mass(p), *x = &view.state.position[p * D];
  for (int a = 0; a < D; ++a)
    for (int b = 0; b < D; ++b)
      mass_moment[a][b] +=
          m * (x[a] * x[b] + (view.affine_velocity ? second_moment(view.experiment, view.state, p, a, b) : 0.0));
  const double* tau = &view.material.stress[p * (D == 2 ? 4 : 6)];
  const double J = view.material.volume_ratio[p], pressure = -(tau[0] + tau[1] + tau[2]) / (3 * J);
  smallest_pressure = smallest_of(smallest_pressure, pressure);
  largest_pressure = largest_of(largest_pressure, pressure);
  largest_von_mises = largest_of(largest_von_mises, von_mises(tau, D) / J);
}

void PartSums::finish() {
  refer_to_centre_of_mass(totals);
  const auto& c = totals.centre_of_mass;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) mass_moment[a][b] -= totals.mass * c[a] * c[b];
}

void PartSums::forget_extremes() {
  for (double* extreme : {&totals.smallest_volume_ratio, &totals.largest_volume_ratio, &totals.lowest_temperature,
                          &totals.highest_temperature, &smallest_pressure, &largest_pressure, &largest_von_mises})
    *extreme = std::numeric_limits<double>::quiet_NaN();
}

std::array<std::array<double, 3>, 3> PartSums::inertia() const {
  std::array<std::array<double, 3>, 3> result{};
  const double trace = mass_moment[0][0] + mass_moment[1][1] + mass_moment[2][2];
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) result[a][b] = (a == b ? trace : 0.0) - mass_moment[a][b];
  return result;
}

std::array<double, 3> PartSums::angular_velocity(int dimension) const {
  constexpr double none = std::numeric_limits<double>::quiet_NaN(), rounding = 1e-12;
  const auto I = inertia();
  const auto& L = totals.angular_momentum;
  const double size = I[0][0] + I[1][1] + I[2][2];
  if (dimension == 2) return {none, none, size > 0 ? L[2] / I[2][2] : none};
  std::array<std::array<double, 3>, 3> rows;  // of the adjugate: I^-1 = rows / det
  for (int a = 0; a < 3; ++a) rows[a] = cross(I[(a + 1) % 3].data(), I[(a + 2) % 3].data());
  const double det = I[0][0] * rows[0][0] + I[0][1] * rows[0][1] + I[0][2] * rows[0][2];
  if (!(det > rounding * size * size * size)) return {none, none, none};
  std::array<double, 3> omega{};
  for (int a = 0; a < 3; ++a)  // I is symmetric, and so is its adjugate
    for (int b = 0; b < 3; ++b) omega[a] += rows[a][b] * L[b] / det;
  return omega;
}

}  // namespace mpm
