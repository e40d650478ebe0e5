// Temperature: particles give nodes their heat, nodes conduct it and exchange it at walls and in boxes, and particles
// take temperatures back, melt and freeze. The scene's transfer acts on T as it would on the velocity (T, 0, 0) of a
// particle whose mass is its heat capacity.

#include <cmath>
#include <numbers>

#include "backends/reference/reference_backend.hpp"
#include "simulation/wall_heat.hpp"

namespace mpm::reference {
namespace {

double at(const ScalarExpression& expression, const Vector& x, double time) {
  return expression({x[0], x[1], x[2]}, {x[0], x[1], x[2]}, time);
}

}  // namespace

// ---- particles ----------------------------------------------------------------------------------------------------

bool Particles::melted(std::size_t p) const {
  return thermal_ && thermal_->phase_change && values("melted_fraction")(0, p) >= 0.5;
}

const ThermalProperties& Particles::thermal(std::size_t p) const {
  return melted(p) ? thermal_->phase_change->melted : thermal_->solid;
}

double Particles::heat() const {
  double sum = 0;
  for (std::size_t p = 0; p < count_; ++p) sum += heat_capacity(p) * values("temperature")(0, p);
  return sum;
}

/// Puts the state that the plan keeps into row 0 of a matrix and into component 0 of a vector; the rest is zero.
std::vector<Array> Particles::state_of_temperature() const {
  std::vector<Array> states;
  for (const mpm_state& declared : transfer_.plugin->state()) {
    const Array& kept = values(temperature_state + std::string(declared.name));
    Array& state = states.emplace_back(make(state_components(kept_shape(declared, false), dimension_)));
    state.topRows(kept.rows()) = kept;
  }
  return states;
}

void Particles::heat_coefficients() {
  Array capacity = make(1), of_velocity = make(dimension_);
  for (std::size_t p = 0; p < count_; ++p) capacity(0, p) = heat_capacity(p);
  of_velocity.row(0) = values("temperature");
  pad(capacity), pad(of_velocity);
  std::vector<Array> states = state_of_temperature();
  std::vector<void*> pointers;
  for (Array& state : states) pad(state), pointers.push_back(state.data());
  scatter_by_transfer(capacity, of_velocity, pointers);
}

void Particles::gather_heat(double dt, const Moments& moments) {
  Array of_velocity = make(dimension_), advected = make(dimension_);
  of_velocity.row(0) = values("temperature");
  std::vector<Array> states = state_of_temperature();
  std::vector<void*> pointers;
  for (Array& state : states) pointers.push_back(state.data());
  gather_by_transfer(dt, moments, of_velocity, pointers, advected);
  for (std::size_t p = 0; p < count_; ++p)
    if (const double T = of_velocity(0, p); !std::isfinite(T))
      throw RunFailure({Cause::temperature_not_a_number, body_, p, -1, T});
  values("temperature") = of_velocity.row(0);
  for (std::size_t k = 0; k < states.size(); ++k) {
    Array& kept = values(temperature_state + std::string(transfer_.plugin->state()[k].name));
    kept = states[k].topRows(kept.rows());
  }
}

/// Keeps the enthalpy h = c (T - Tm) + L phi and recovers T and phi; where h lies between 0 and L the temperature is Tm
/// (Voller & Cross 1981, Int. J. Heat Mass Transf. 24:545).
double Particles::change_phase(bool accounted) {
  if (!thermal_ || !thermal_->phase_change) return 0;
  const PhaseChange& change = *thermal_->phase_change;
  const double stored = accounted ? stored_energy() : 0;
  Array &temperature = values("temperature"), &fraction = values("melted_fraction");
  Array kept = temperature;
  for (std::size_t p = 0; p < count_; ++p) {
    double& T = temperature(0, p);
    double& phi = fraction(0, p);
    const double h = thermal(p).heat_capacity * (T - change.temperature) + change.latent_heat * phi;
    phi = std::min(1.0, std::max(0.0, h / change.latent_heat));
    if (h <= 0)
      T = change.temperature + h / thermal_->solid.heat_capacity;
    else if (h < change.latent_heat)
      T = change.temperature;
    else
      T = change.temperature + (h - change.latent_heat) / change.melted.heat_capacity;
  }
  pad(temperature), pad(fraction);
  if (!accounted) return 0;
  temperature.swap(kept);  // both energies at one temperature
  const double relaxed = stored - stored_energy();
  temperature.swap(kept);
  return relaxed;
}

double Particles::stored_energy() {
  Array density = make(1);
  mpm_material_batch batch{};
  batch.stored_energy = density.data();
  refuse_inverted(update_material(batch));
  double sum = 0;
  for (std::size_t p = 0; p < count_; ++p) sum += volume(p) * density(0, p);
  return sum;
}

// ---- particles to nodes -------------------------------------------------------------------------------------------

double ReferenceBackend::heat_of_particles() const {
  double total = 0;
  for (const Particles& body : bodies_) total += body.heat();
  return total;
}

double ReferenceBackend::sum(const ScalarField& field) {
  double total = 0;
  for_each_node([&](std::size_t i) { total += field[i]; });
  return total;
}

/// Ghosts add nothing, as their heat capacity was folded.
double ReferenceBackend::heat_of_temperature() {
  double total = 0;
  for_each_node([&](std::size_t i) { total += heat_capacity_[i] * temperature_[i]; });
  return total;
}

/// Gives each node w m c, w (b + A d) of the temperature, and w V of the section where a wall's area counts.
void ReferenceBackend::scatter_heat(Particles& body) {
  const bool affine = experiment_.transfer.plugin->transfer().traits & MPM_SCATTERS_AFFINE;
  const bool measures_walls = plan_.node_field("heated_volume") != nullptr;
  if (measures_walls) body.evaluate_stress();
  body.heat_coefficients();
  for (std::size_t p = 0; p < body.count(); ++p) {
    const double b = body.b(0, p);
    const Vector A = affine ? Vector(body.matrix(body.A, p).row(0)) : Vector(Vector::Zero());
    const double volume = body.volume(p) * body.volume_ratio(0, p);
    const double section = body.axisymmetric() ? volume / (2 * std::numbers::pi * body.position(0, p)) : volume;
    for (const StencilNode& s : body.stencil(p)) {
      const std::size_t i = grid_.at(body.field(), s.index);
      heat_capacity_[i] += s.weight * body.heat_capacity(p);
      heat_[i] += s.weight * (b + A.dot(s.distance));
      if (!measures_walls) continue;
      heated_volume_[i] += s.weight * section;
      volume_conductivity_[i] += s.weight * section * body.conductivity(p);
      if (!affine) capacity_position_[i] -= s.weight * body.heat_capacity(p) * s.distance;
    }
  }
}

void ReferenceBackend::divide_heat(const StepInfo& step) {
  for_each_node([&](std::size_t i) { temperature_[i] = heat_capacity_[i] > 0 ? heat_[i] / heat_capacity_[i] : 0; });
  impose_temperatures(step.time, heat_ledger_.images, heat_ledger_.images);
  grid_.fill_temperature_ghosts(step.time);
  held_beyond_ = grid_.heat_beyond_walls(true), others_beyond_ = grid_.heat_beyond_walls(false);
  account(heat_ledger_.images, held_beyond_ + others_beyond_);
  for_each_node([&](std::size_t i) { temperature_before_[i] = temperature_[i]; });
}

/// Adds dH_i/dt = -V k grad T . grad w_i, with grad T = sum T- grad w at the particle.
void ReferenceBackend::conduct() {
  for (Particles& body : bodies_) {
    body.evaluate_stress();
    for (std::size_t p = 0; p < body.count(); ++p) {
      Vector gradient = Vector::Zero();
      for (const StencilNode& s : body.stencil(p))
        gradient += temperature_before_[grid_.at(body.field(), s.index)] * s.gradient;
      const Vector flux = -body.conductivity(p) * gradient;  // W/m^2
      const double volume = body.volume(p) * body.volume_ratio(0, p);
      for (const StencilNode& s : body.stencil(p))
        heat_rate_[grid_.at(body.field(), s.index)] += volume * flux.dot(s.gradient);
    }
  }
}

// ---- on nodes -----------------------------------------------------------------------------------------------------

void ReferenceBackend::heat(const StepInfo& step) {
  const double rate = sum(heat_rate_);
  grid_.fold_forces(step.time);  // of the rates alone: forces were folded with the momenta, or are not scattered yet
  account(heat_ledger_.walls, step.dt * (sum(heat_rate_) - rate));
  heat_through_walls(step);
  heat_boxes(step);
  for_each_node([&](std::size_t i) {
    if (heat_capacity_[i] > 0) temperature_[i] += step.dt * heat_rate_[i] / heat_capacity_[i];
  });
  impose_temperatures(step.time + step.dt, heat_ledger_.walls, heat_ledger_.boxes);
  grid_.fill_temperature_ghosts(step.time + step.dt);
  const double held = grid_.heat_beyond_walls(true), others = grid_.heat_beyond_walls(false);
  account(heat_ledger_.walls, held - held_beyond_);
  account(heat_ledger_.images, others - others_beyond_);
  heat_after_ = heat_of_temperature() + held + others;
}

void ReferenceBackend::heat_through_walls(const StepInfo& step) {
  for (int axis = 0; axis < experiment_.dimension; ++axis)
    for (int side = 0; side < 2; ++side)
      if (const FaceCondition& face = experiment_.faces[axis][side]; passes_heat(face))
        heat_through_wall(face, axis, side, step);
}

/// Shares q A among a wall node and the next ones inward by the shape's weights at the wall.
void ReferenceBackend::heat_through_wall(const FaceCondition& face, int axis, int side, const StepInfo& step) {
  double& row = face.thermal.exchange == HeatExchange::convection ? heat_ledger_.convection : heat_ledger_.flux;
  for_each_node([&](std::size_t i) {
    Eigen::Vector3i node = grid_.coordinates(i);
    if (node[axis] != (side == 0 ? 0 : experiment_.grid.cells[axis]) || heated_volume_[i] <= 0) return;
    const double flux = grid_.flux_through_wall(i, axis, side, step.time, true);
    const double around = experiment_.axisymmetric() ? 2 * std::numbers::pi * grid_.position(node)[0] : 1;
    const double area = heated_volume_[i] / (0.5 * experiment_.grid.cell_size) * around;
    for (const double share : wall_weights_.shares) {
      const std::size_t k = grid_.at(grid_.velocity_field_of(i), grid_.index(node));
      node[axis] += side == 0 ? 1 : -1;
      if (heat_capacity_[k] <= 0) continue;
      heat_rate_[k] += share * area * flux;
      account(row, step.dt * share * area * flux);
    }
  });
}

/// Shares the power of a box by the masses of its nodes.
void ReferenceBackend::heat_boxes(const StepInfo& step) {
  for (const BoxCondition& box : experiment_.boxes) {
    if (box.thermal.exchange != HeatExchange::heating) continue;
    double mass = 0;
    for_each_node([&](std::size_t i) { mass += grid_.inside(box, i) ? mass_[i] : 0; });
    for_each_node([&](std::size_t i) {
      if (mass_[i] <= 0 || !grid_.inside(box, i)) return;
      const double power = at(box.thermal.value, grid_.position(grid_.coordinates(i)), step.time) * mass_[i] / mass;
      heat_rate_[i] += power;
      account(heat_ledger_.boxes, step.dt * power);
    });
  }
}

/// Imposes walls first, then boxes, which win.
void ReferenceBackend::impose_temperatures(double time, double& from_walls, double& from_boxes) {
  for_each_node([&](std::size_t i) {
    if (heat_capacity_[i] <= 0) return;
    const Eigen::Vector3i& node = grid_.coordinates(i);
    const Vector x = grid_.position(node);
    for (int axis = 0; axis < experiment_.dimension; ++axis)
      for (int side = 0; side < 2; ++side) {
        const FaceCondition& face = experiment_.faces[axis][side];
        const bool on_wall = node[axis] == (side == 0 ? 0 : experiment_.grid.cells[axis]);
        if (on_wall && folds(face.type) && holds_temperature(face))
          hold_temperature(i, at(face.thermal.value, x, time), from_walls);
      }
    for (const BoxCondition& box : experiment_.boxes)
      if (box.thermal.exchange == HeatExchange::fixed_temperature && grid_.inside(box, i))
        hold_temperature(i, at(box.thermal.value, x, time), from_boxes);
  });
}

void ReferenceBackend::hold_temperature(std::size_t i, double value, double& ledger) {
  account(ledger, heat_capacity_[i] * (value - temperature_[i]));
  temperature_[i] = value;
}

// ---- nodes to particles -------------------------------------------------------------------------------------------

/// Gathers sum w T+, sum w (T+ - T-), sum T+ w D^-1 d and sum T+ grad w in row 0, like those of the velocity (T, 0, 0).
void ReferenceBackend::gather_heat(Particles& body, const StepInfo& step) {
  const int D = experiment_.dimension;
  Array velocity = Array::Zero(D, body.velocity.cols()), increment = velocity;
  Array affine = Array::Zero(D * D, body.velocity.cols()), gradient = affine;
  for (std::size_t p = 0; p < body.count(); ++p)
    for (const StencilNode& s : body.stencil(p)) {
      const std::size_t i = grid_.at(body.field(), s.index);
      velocity(0, p) += s.weight * temperature_[i];
      increment(0, p) += s.weight * (temperature_[i] - temperature_before_[i]);
      for (int c = 0; c < D; ++c) {
        affine(c, p) += temperature_[i] * s.affine[c];
        gradient(c, p) += temperature_[i] * s.gradient[c];
      }
    }
  body.gather_heat(step.dt, {velocity, increment, affine, gradient});
}

void ReferenceBackend::change_phase() {
  for (Particles& body : bodies_) {
    const double relaxed = body.change_phase(accounted_);
    if (accounted_) ledger_.enter_phase_change(relaxed);
  }
}

}  // namespace mpm::reference
