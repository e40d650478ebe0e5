#include "backends/reference/particles.hpp"

#include <cmath>
#include <numbers>

#include "plugin/extension_of.hpp"
#include "simulation/saved_state.hpp"

namespace mpm::reference {

Particles::Particles(const Experiment& experiment, const Plan& plan, int body, const SeededBody& seeded)
    : experiment_(experiment),
      plan_(plan),
      transfer_(experiment.transfer),
      material_(experiment.materials[experiment.bodies[body].material].component),
      thermal_(experiment.materials[experiment.bodies[body].material].thermal),
      dissipation_(dissipation_of(*experiment.materials[experiment.bodies[body].material].component.plugin)),
      viscosity_(experiment.materials[experiment.bodies[body].material].artificial_viscosity),
      body_(body),
      field_(experiment.bodies[body].field),
      dimension_(experiment.dimension),
      count_(seeded.count()),
      padded_((count_ + MPM_LANES - 1) / MPM_LANES * MPM_LANES),
      mass_(seeded.mass),
      volume_(seeded.volume),
      frozen_(experiment.bodies[body].frozen),
      shape_(experiment, plan) {
  seeded.for_each_batch([this](const SeedBatch& batch) { seed(batch); });
  if (size_ && !seeded.with_size) values("size") = 2 * std::numbers::pi * position.topRows(1);
  for (Stored& stored : fields_) pad(stored.values);
}

Array Particles::make(int components) const {
  return Array::Zero(components, static_cast<Eigen::Index>(padded_));
}

double Particles::half_size() const {
  return 0.5 / experiment_.bodies[body_].particles_per_cell_axis;
}

std::deque<Particles::Stored> Particles::start_fields() const {
  std::deque<Stored> fields;
  for (const Field& declared : plan_.fields) {
    if (!declared.of_particles_of(body_)) continue;
    Array& values = fields.emplace_back(Stored{&declared, make(declared.components)}).values;
    for (int k = 0; k < declared.components; ++k)
      values.row(k).setConstant(first_value(declared, k, dimension_, half_size()));
  }
  return fields;
}

void Particles::seed(const SeedBatch& batch) {
  const auto take = [&](Array& values, const double* first) {
    for (std::size_t p = 0; first && p < batch.count; ++p)
      for (Eigen::Index k = 0; k < values.rows(); ++k) values(k, batch.first + p) = first[p * values.rows() + k];
  };
  for (Stored& stored : fields_)
    if (stored.declared->first == First::seeded) take(stored.values, batch.values(*stored.declared));
  if (batch.velocity_gradient)
    take(values(transfer_.plugin->state()[0].name, Origin::transfer), batch.velocity_gradient);
}

const Array& Particles::values(std::string_view id, Origin origin) const {
  for (const Stored& stored : fields_)
    if (stored.declared->origin == origin && stored.declared->id == id) return stored.values;
  throw std::logic_error("the plan has no field \"" + std::string(id) + "\" of the particles");
}

Array& Particles::values(std::string_view id, Origin origin) {
  return const_cast<Array&>(std::as_const(*this).values(id, origin));
}

std::vector<void*> Particles::state_of(Origin plugin) {
  std::vector<void*> list;
  for (Stored& stored : fields_)
    if (stored.declared->origin == plugin) list.push_back(stored.values.data());
  return list;
}

std::uint64_t Particles::bytes() const {
  Eigen::Index scalars = 0;
  for (const Stored& stored : fields_) scalars += stored.values.size();
  for (const Array& array : work_) scalars += array.size();
  return static_cast<std::uint64_t>(scalars) * sizeof(double);
}

Vector Particles::column(const Array& array, std::size_t p) const {
  Vector v = Vector::Zero();
  for (int c = 0; c < dimension_; ++c) v[c] = array(c, p);
  return v;
}

Matrix Particles::matrix(const Array& array, std::size_t p) const {
  Matrix m = Matrix::Zero();
  for (int i = 0; i < dimension_; ++i)
    for (int j = 0; j < dimension_; ++j) m(i, j) = array(i * dimension_ + j, p);
  return m;
}

Matrix Particles::symmetric(const Array& array, std::size_t p) const {
  Matrix m = Matrix::Zero();
  for (int i = 0; i < dimension_; ++i)
    for (int j = 0; j < dimension_; ++j) m(i, j) = array(i == j ? i : (dimension_ == 2 ? 3 : 6 - i - j), p);
  return m;
}

Vector Particles::hoop_force(std::size_t p) const {
  if (!axisymmetric()) return Vector::Zero();
  return {-volume(p) * stress(2, p) / position(0, p), 0, 0};
}

void Particles::set(Array& array, std::size_t p, const Vector& v) {
  for (int c = 0; c < dimension_; ++c) array(c, p) = v[c];
}

void Particles::set(Array& array, std::size_t p, const Matrix& m) {
  for (int i = 0; i < dimension_; ++i)
    for (int j = 0; j < dimension_; ++j) array(i * dimension_ + j, p) = m(i, j);
}

void Particles::pad(Array& array) const {
  for (std::size_t p = count_; count_ > 0 && p < padded_; ++p) array.col(p) = array.col(count_ - 1);
}

ShapeArguments Particles::shape_arguments() const {
  ShapeArguments at{make(dimension_), make(dimension_), {}, {}};
  if (plan_.particle_field(0, "domain")) at.domain = values("domain");
  if (plan_.sample_points > 0) at.corners = values("corners");
  for (int c = 0; c < dimension_; ++c)
    at.position.row(c) = (position.row(c).array() - experiment_.grid.lower[c]) / experiment_.grid.cell_size;
  at.half_size.setConstant(half_size());
  return at;
}

void Particles::find_stencils(const Grid& grid) {
  const ShapeArguments at = shape_arguments();
  const ShapeValues values = shape_.evaluate(at);
  stencils_.clear(), second_moments_.clear(), higher_bases_.clear();
  for (std::size_t p = 0; p < count_; ++p) {
    stencils_.push_back(shape_.stencil(values, at, p, grid, body_));
    second_moments_.push_back(shape_.second_moment(values, at, p));
    if (plan_.basis_functions > 0) higher_bases_.push_back(shape_.higher_basis(values, p));
  }
}

void Particles::find_second_moments() {
  const ShapeArguments at = shape_arguments();
  const ShapeValues values = shape_.evaluate(at);
  second_moments_.clear(), higher_bases_.clear();
  for (std::size_t p = 0; p < count_; ++p) {
    second_moments_.push_back(shape_.second_moment(values, at, p));
    if (plan_.basis_functions > 0) higher_bases_.push_back(shape_.higher_basis(values, p));
  }
}

void Particles::scatter_coefficients() {
  Array mass = make(1);
  mass.setConstant(mass_);
  if (size_) mass = mass_ * *size_;
  scatter_by_transfer(mass, velocity, state_of(Origin::transfer));
  if (plan_.basis_functions == 0) return;
  higher = values(polynomial_coefficients, Origin::transfer);
  for (std::size_t p = 0; p < count_; ++p) higher.col(static_cast<Eigen::Index>(p)) *= mass(p);
}

/// Computes b and A of particles that have this mass, velocity and state.
void Particles::scatter_by_transfer(const Array& mass, const Array& of_velocity, const std::vector<void*>& state) {
  const mpm_transfer& transfer = transfer_.plugin->transfer();
  const auto n = static_cast<std::uint32_t>(padded_);
  const mpm_scatter_batch batch{n,
                                n,
                                static_cast<std::uint32_t>(dimension_),
                                0,
                                mass.data(),
                                of_velocity.data(),
                                state.data(),
                                b.data(),
                                transfer.traits & MPM_SCATTERS_AFFINE ? A.data() : nullptr};
  transfer.scatter[MPM_SCALAR_DOUBLE][dimension_ - 2](transfer_.parameters.data(), &batch);
}

void Particles::project_coefficients(double dt) {
  const std::deque<Stored> kept = fields_;
  velocity.setZero(), advection.setZero();
  for (Stored& stored : fields_)
    if (stored.declared->origin == Origin::transfer) stored.values.setZero();
  gathered_increment = gathered_velocity;  // the particles were at rest
  gather(dt);
  scatter_coefficients();
  for (std::size_t k = 0; k < fields_.size(); ++k) fields_[k].values = kept[k].values;
}

std::int32_t Particles::update_material(const mpm_material_batch& request) {
  std::vector<Eigen::Index> solid, liquid;
  for (std::size_t p = 0; p < padded_; ++p) (melted(p) ? liquid : solid).push_back(static_cast<Eigen::Index>(p));
  std::int32_t failed = solid.empty() ? -1 : update_material(request, material_.parameters, solid);
  if (liquid.empty()) return failed;
  const std::int32_t other = update_material(request, thermal_->phase_change->melted_parameters, liquid);
  return failed < 0 || (other >= 0 && other < failed) ? other : failed;
}

/// Updates only some particles, with these parameters: their values are taken out and put back.
std::int32_t Particles::update_material(const mpm_material_batch& request, const std::vector<double>& parameters,
                                        const std::vector<Eigen::Index>& particles) {
  std::vector<Eigen::Index> which = particles;
  which.resize((which.size() + MPM_LANES - 1) / MPM_LANES * MPM_LANES, which.back());
  struct Part {
    Eigen::Map<Array> all;
    Array values;
  };
  std::deque<Part> outputs;
  std::deque<Array> inputs;
  const auto all = [&](const void* values, int components) {
    return Eigen::Map<Array>(static_cast<double*>(const_cast<void*>(values)), components,
                             static_cast<Eigen::Index>(padded_));
  };
  const auto input = [&](const void* values, int components) -> const void* {
    return values ? inputs.emplace_back(all(values, components)(Eigen::all, which)).data() : nullptr;
  };
  const auto output = [&](void* values, int components) -> void* {
    if (!values) return nullptr;
    const Eigen::Map<Array> whole = all(values, components);
    return outputs.emplace_back(Part{whole, whole(Eigen::all, which)}).values.data();
  };

  mpm_material_batch batch = request;
  batch.count = batch.stride = static_cast<std::uint32_t>(which.size());
  batch.dimension = static_cast<std::uint32_t>(dimension_);
  std::vector<void*> state;
  for (Stored& stored : fields_)
    if (stored.declared->origin == Origin::material)
      state.push_back(output(stored.values.data(), static_cast<int>(stored.values.rows())));
  batch.state = state.data();
  batch.velocity_gradient = input(request.velocity_gradient, dimension_ * dimension_);
  if (axisymmetric()) batch.velocity_gradient_zz = input(hoop_rate.data(), 1);
  if (thermal_ && extension_of<mpm_material_temperature>(*material_.plugin)) {
    Array& temperature = values("temperature");
    pad(temperature);
    batch.temperature = input(temperature.data(), 1);
  }
  batch.kirchhoff_stress = output(request.kirchhoff_stress, dimension_ == 2 ? 4 : 6);
  for (void** scalar : {&batch.stored_energy, &batch.dissipated_energy, &batch.wave_speed, &batch.volume_ratio})
    *scalar = output(*scalar, 1);
  const std::int32_t failed =
      material_.plugin->material().update[MPM_SCALAR_DOUBLE][dimension_ - 2](parameters.data(), &batch);
  for (Part& part : outputs) part.all(Eigen::all, which) = part.values;
  return failed < 0 ? failed : static_cast<std::int32_t>(which[static_cast<std::size_t>(failed)]);
}

void Particles::refuse_inverted(std::int32_t particle) {
  if (particle < 0) return;
  const std::size_t p = std::min(static_cast<std::size_t>(particle), count_ - 1);
  for (const Stored& stored : fields_)
    if (stored.declared->origin == Origin::material && !stored.values.col(static_cast<Eigen::Index>(p)).allFinite())
      throw RunFailure({Cause::deformation_not_a_number, body_, p});
  mpm_material_batch batch{};
  batch.volume_ratio = volume_ratio.data();
  update_material(batch);
  throw RunFailure({Cause::inverted, body_, p, -1, volume_ratio(0, static_cast<Eigen::Index>(p))});
}

void Particles::evaluate_stress() {
  mpm_material_batch batch{};
  batch.kirchhoff_stress = stress.data();
  batch.volume_ratio = volume_ratio.data();
  refuse_inverted(update_material(batch));
  if (viscosity_)
    for (int k = 0; k < 3; ++k) stress.row(k) -= values("artificial_pressure").row(0);
}

/// Artificial viscosity: q = rho h r (C1 c + C2 h r), where the logarithm of the volume falls at the rate r. Its work is
/// taken by the trapezoidal rule, since the forces before the strain had the old pressure and those after it have the new.
Array Particles::strain_artificially(double dt, const Array& wave) {
  const double h = experiment_.grid.cell_size, density = material_.parameter("density");
  Array work = make(1);
  Array& pressure = values("artificial_pressure");
  for (std::size_t p = 0; p < count_; ++p) {
    const double shrinking = -std::log1p(dt * dilation(p, dt)), rate = std::max(shrinking / dt, 0.0);
    const double before = pressure(0, p);
    pressure(0, p) = density * h * rate * (viscosity_->linear * wave(0, p) + viscosity_->quadratic * h * rate);
    work(0, p) = 0.5 * (before + pressure(0, p)) * shrinking;
  }
  pad(pressure);
  return work;
}

double Particles::work_of_stress(double dt, bool after) {
  evaluate_stress();
  double sum = 0;
  for (std::size_t p = 0; p < count_; ++p) {
    Matrix L = matrix(velocity_gradient, p), tau = symmetric(stress, p);
    if (axisymmetric()) L(2, 2) = hoop_rate(0, p), tau(2, 2) = stress(2, p);
    if (after) L -= dt * L * L;
    sum += dt * volume(p) * tau.cwiseProduct(L).sum();
  }
  return sum;
}

StrainEnergies Particles::strain(double dt, bool booked) {
  pad(velocity_gradient);
  find_hoop_rate();
  StrainEnergies energies;
  if (mean_dilation.rows() > 0) take_mean_dilation(dt);
  if (booked) energies.power = 0.5 * work_of_stress(dt, false), energies.stored = -stored_energy();
  Array dissipated = make(1);
  mpm_material_batch batch{};
  batch.dt = dt;
  batch.velocity_gradient = velocity_gradient.data();
  batch.dissipated_energy = dissipated.data();
  Array wave = make(1);
  if (viscosity_) batch.wave_speed = wave.data();
  refuse_inverted(update_material(batch));
  if (viscosity_) {
    Array artificial = strain_artificially(dt, wave);
    dissipated += artificial;
    if (size_) artificial.array() *= size_->array();
    energies.artificial = volume_ * artificial.leftCols(count_).sum();
  }
  if (booked) energies.power += 0.5 * work_of_stress(dt, true), energies.stored += stored_energy();
  if (plan_.particle_field(0, "domain") && !frozen_) {
    Array& domain = values("domain");  // the domain becomes (I + dt L) domain, like F
    for (std::size_t p = 0; p < padded_; ++p)
      set(domain, p, Matrix((Matrix::Identity() + dt * matrix(velocity_gradient, p)) * matrix(domain, p)));
  }
  if (plan_.particle_field(body_, "deformation") && !frozen_) {
    Array& F = values("deformation");
    for (std::size_t p = 0; p < padded_; ++p)
      set(F, p, Matrix((Matrix::Identity() + dt * matrix(velocity_gradient, p)) * matrix(F, p)));
  }
  if (thermal_ && thermal_->dissipation_to_heat > 0)
    for (std::size_t p = 0; p < count_; ++p)
      values("temperature")(0, p) += thermal_->dissipation_to_heat * dissipated(0, p) /
                                     (material_.parameter("density") * thermal(p).heat_capacity);
  if (size_) dissipated.array() *= size_->array();
  energies.dissipated = volume_ * dissipated.leftCols(count_).sum();
  return energies;
}

Array Particles::moments_for_transfer() const {
  const bool constant = experiment_.shape.plugin->shape().second_moment_kind == MPM_MOMENT_CONSTANT;
  if (constant || !(transfer_.plugin->transfer().traits & MPM_READS_SECOND_MOMENT)) return {};
  const double h = experiment_.grid.cell_size;
  Array moments = make(dimension_ * dimension_);
  for (std::size_t p = 0; p < count_; ++p)
    for (int i = 0; i < dimension_; ++i)
      for (int j = 0; j < dimension_; ++j) moments(i * dimension_ + j, p) = second_moments_[p](i, j) / (h * h);
  pad(moments);
  return moments;
}

void Particles::gather(double dt) {
  const Moments moments{gathered_velocity, gathered_increment, gathered_affine, gathered_gradient};
  gather_by_transfer(dt, moments, velocity, state_of(Origin::transfer), advection);
  if (plan_.basis_functions > 0) values(polynomial_coefficients, Origin::transfer) = gathered_higher;
}

/// Updates velocity and state by what the transfer makes of the moments.
void Particles::gather_by_transfer(double dt, const Moments& moments, Array& of_velocity,
                                   const std::vector<void*>& state, Array& advected) {
  const mpm_transfer& transfer = transfer_.plugin->transfer();
  for (Array* array : {&moments.velocity, &moments.increment, &moments.affine, &moments.gradient}) pad(*array);
  const Array second_moments = moments_for_transfer();
  const auto n = static_cast<std::uint32_t>(padded_);
  const mpm_gather_batch batch{n,
                               n,
                               static_cast<std::uint32_t>(dimension_),
                               0,
                               dt,
                               moments.velocity.data(),
                               moments.increment.data(),
                               moments.affine.data(),
                               moments.gradient.data(),
                               of_velocity.data(),
                               state.data(),
                               advected.data(),
                               second_moments.size() ? second_moments.data() : nullptr};
  transfer.gather[MPM_SCALAR_DOUBLE][dimension_ - 2](transfer_.parameters.data(), &batch);
}

void Particles::take_gathered_velocity(const Array& before, bool moves_by_mean) {
  velocity = advection = gathered_velocity;
  if (moves_by_mean) advection = (before + gathered_velocity) / 2;
}

TimeStepLimit Particles::time_step_limit() {
  Array wave = make(1);
  mpm_material_batch batch{};
  batch.wave_speed = wave.data();
  refuse_inverted(update_material(batch));
  TimeStepLimit limit;
  limit.body = body_;
  for (std::size_t p = 0; p < count_; ++p) {
    if (viscosity_) {  // a damped oscillator's longest step, its damping that of waves of one cell
      const double h = experiment_.grid.cell_size, c = wave(0, p);
      const double q = values("artificial_pressure")(0, p) / material_.parameter("density");
      const double nu = h * std::sqrt(std::pow(viscosity_->linear * c, 2) + 4 * viscosity_->quadratic * q);
      wave(0, p) = std::sqrt(3.0) * nu / h + std::hypot(c, std::sqrt(3.0) * nu / h);
    }
    const double speed = wave(0, p) + column(velocity, p).norm();
    if (speed > limit.speed) limit = {speed, wave(0, p), body_, p};
  }
  return limit;
}

double Particles::kinetic_energy() const {
  const bool affine = transfer_.plugin->transfer().traits & MPM_AFFINE_CARRIES_ENERGY;
  const Array* C = affine ? &values(transfer_.plugin->state()[0].name, Origin::transfer) : nullptr;
  const Array* beyond = plan_.basis_functions > 0 ? &values(polynomial_coefficients, Origin::transfer) : nullptr;
  double sum = 0;
  for (std::size_t p = 0; p < count_; ++p) {
    sum += 0.5 * mass(p) * column(velocity, p).squaredNorm();
    if (C) sum += 0.5 * mass(p) * (matrix(*C, p) * second_moments_[p] * matrix(*C, p).transpose()).trace();
    for (int k = 0; k < plan_.basis_functions; ++k)
      for (int c = 0; c < dimension_; ++c)
        sum += 0.5 * mass(p) * higher_bases_[p].norm[k] * std::pow((*beyond)(k * dimension_ + c, p), 2);
  }
  return sum;
}

std::vector<double> Particles::particle_major(const Array& array) const {
  std::vector<double> values(count_ * array.rows());
  for (std::size_t p = 0; p < count_; ++p)
    for (Eigen::Index c = 0; c < array.rows(); ++c) values[p * array.rows() + c] = array(c, p);
  return values;
}

BodyState Particles::state() const {
  BodyState result;
  for (const Stored& stored : fields_) {
    const Field& declared = *stored.declared;
    const bool cells = declared.origin == Origin::host && declared.unit == "cells";
    if (declared.lifetime != Lifetime::step)
      result.of(declared) = particle_major((cells ? experiment_.grid.cell_size : 1.0) * stored.values);
  }
  if (plan_.stencil.second_moment) {
    const double h = experiment_.grid.cell_size;
    result.second_moment = particle_major(h * h * shape_.evaluate(shape_arguments()).second_moment);
  }
  result.volume = volume_;
  result.mass = mass_;
  return result;
}

void Particles::save(ArchiveWriter& archive) const {
  save_particles(archive, plan_, body_, particle_major(position),
                 [&](const Field& field) { return particle_major(values(field.id, field.origin)); });
}

void Particles::restore(ArchiveReader& archive) {
  const auto take = [&](Array& array, const std::vector<double>& particle_major) {
    for (std::size_t p = 0; p < count_; ++p)
      for (Eigen::Index c = 0; c < array.rows(); ++c) array(c, p) = particle_major[p * array.rows() + c];
    pad(array);
  };
  restore_particles<double>(
      archive, plan_, body_, count_, static_cast<std::size_t>(dimension_),
      [&](const std::vector<double>& found) { take(position, found); },
      [&](const Field& field, const std::vector<double>& found) { take(values(field.id, field.origin), found); });
}

}  // namespace mpm::reference
