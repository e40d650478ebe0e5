#include "backends/reference/particles.hpp"

#include <cmath>
#include <numbers>

namespace mpm::reference {

Particles::Particles(const Experiment& experiment, const Plan& plan, int body, const SeededBody& seeded)
    : experiment_(experiment),
      plan_(plan),
      transfer_(experiment.transfer),
      material_(experiment.materials[experiment.bodies[body].material].component),
      body_(body),
      field_(experiment.bodies[body].field),
      dimension_(experiment.dimension),
      count_(seeded.count()),
      padded_((count_ + MPM_LANES - 1) / MPM_LANES * MPM_LANES),
      mass_(seeded.mass),
      volume_(seeded.volume),
      frozen_(experiment.bodies[body].frozen),
      shape_(experiment, plan) {
  const int D = dimension_;
  position = make(D), velocity = make(D), advection = make(D);
  const SeedArrays seeds = seeded.arrays();
  for (std::size_t p = 0; p < count_; ++p)
    for (int c = 0; c < D; ++c) {
      position(c, p) = seeds.position[p * D + c];
      velocity(c, p) = seeds.velocity[p * D + c];
    }
  pad(position), pad(velocity);
  if (plan.initial_position) initial_position = position;
  if (experiment.axisymmetric()) circumference_ = 2 * std::numbers::pi * position.topRows(1), hoop_rate_ = make(1);
  b = make(D), A = make(D * D), stress = make(D == 2 ? 4 : 6), volume_ratio = make(1);
  gathered_velocity = make(D), gathered_increment = make(D), gathered_affine = make(D * D),
  gathered_gradient = make(D * D), velocity_gradient = make(D * D);
  if (plan.particle_domain) {
    domain_ = make(D * D);
    for (int a = 0; a < D; ++a)
      domain_.row(a * (D + 1)).setConstant(0.5 / experiment.bodies[body].particles_per_cell_axis);
  }
  if (plan.sample_points > 0) {
    corners = moved_corners = make(plan.sample_points * D);
    for (int corner = 0; corner < plan.sample_points; ++corner)
      for (int a = 0; a < D; ++a)
        corners.row(corner * D + a)
            .setConstant((corner >> a & 1 ? 0.5 : -0.5) / experiment.bodies[body].particles_per_cell_axis);
  }
  initialise(transfer_state_, *transfer_.plugin);
  if (plan.basis_functions > 0)
    transfer_state_[polynomial_coefficients] = gathered_higher = higher = make(plan.basis_functions * D);
  initialise(material_state_, *material_.plugin);
  if (!seeds.velocity_gradient.empty()) {
    Array& affine = transfer_state_.at(transfer_.plugin->state()[0].name);
    for (std::size_t p = 0; p < count_; ++p)
      for (int k = 0; k < D * D; ++k) affine(k, p) = seeds.velocity_gradient[p * D * D + k];
    pad(affine);
  }
}

Array Particles::make(int components) const {
  return Array::Zero(components, static_cast<Eigen::Index>(padded_));
}

void Particles::initialise(Fields& fields, const Plugin& plugin) {
  for (const mpm_state& declared : plugin.state()) {
    const mpm_state_shape shape = kept_shape(declared, experiment_.axisymmetric());
    const int components = state_components(shape, dimension_);
    Array& field = fields[declared.name] = make(components);
    if (declared.initial == MPM_INITIAL_ONE) field.setOnes();
    if (declared.initial == MPM_INITIAL_IDENTITY)
      for (int i = 0; i < (declared.shape == MPM_STATE_SYMMETRIC ? 3 : dimension_); ++i)
        field.row(declared.shape == MPM_STATE_SYMMETRIC ? i : i * (dimension_ + 1)).setOnes();
    const bool plane_strain = shape == MPM_STATE_DEFORMATION && dimension_ == 2;  // xx xy yx yy zz
    if (declared.initial == MPM_INITIAL_IDENTITY && plane_strain) field.row(4).setOnes();
  }
}

std::vector<void*> Particles::pointers(Fields& fields, const Plugin& plugin) {
  std::vector<void*> list;
  for (const mpm_state& declared : plugin.state()) list.push_back(fields.at(declared.name).data());
  return list;
}

std::uint64_t Particles::bytes() const {
  Eigen::Index scalars = 0;
  for (const Array* array : {&position,
                             &velocity,
                             &initial_position,
                             &advection,
                             &b,
                             &A,
                             &stress,
                             &volume_ratio,
                             &gathered_velocity,
                             &gathered_increment,
                             &gathered_affine,
                             &gathered_gradient,
                             &velocity_gradient,
                             &domain_,
                             &circumference_,
                             &hoop_rate_,
                             &gathered_higher,
                             &higher,
                             &corners,
                             &moved_corners})
    scalars += array->size();
  for (const auto* fields : {&transfer_state_, &material_state_})
    for (const auto& [name, array] : *fields) scalars += array.size();
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
  for (std::size_t p = count_; p < padded_; ++p) array.col(p) = array.col(count_ - 1);
}

ShapeArguments Particles::shape_arguments() const {
  ShapeArguments at{make(dimension_), make(dimension_), domain_, corners};
  for (int c = 0; c < dimension_; ++c)
    at.position.row(c) = (position.row(c).array() - experiment_.grid.lower[c]) / experiment_.grid.cell_size;
  at.half_size.setConstant(0.5 / experiment_.bodies[body_].particles_per_cell_axis);
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

void Particles::call_scatter(const Array& velocities, Fields& states) {
  const mpm_transfer& transfer = transfer_.plugin->transfer();
  Array mass = make(1);
  mass.setConstant(mass_);
  if (axisymmetric()) mass = mass_ * circumference_;
  const auto state = pointers(states, *transfer_.plugin);
  const auto n = static_cast<std::uint32_t>(padded_);
  const mpm_scatter_batch batch{n,
                                n,
                                static_cast<std::uint32_t>(dimension_),
                                0,
                                mass.data(),
                                velocities.data(),
                                state.data(),
                                b.data(),
                                transfer.traits & MPM_SCATTERS_AFFINE ? A.data() : nullptr};
  transfer.scatter[MPM_SCALAR_DOUBLE][dimension_ - 2](transfer_.parameters.data(), &batch);
  if (plan_.basis_functions == 0) return;
  higher = states.at(polynomial_coefficients);
  for (std::size_t p = 0; p < count_; ++p) higher.col(static_cast<Eigen::Index>(p)) *= mass(p);
}

void Particles::scatter_coefficients() {
  call_scatter(velocity, transfer_state_);
}

void Particles::project_coefficients(double dt) {
  Array velocities = make(dimension_), advections = make(dimension_);
  Fields states = transfer_state_;
  for (auto& [name, field] : states) field.setZero();
  call_gather(dt, gathered_velocity, velocities, states, advections);
  call_scatter(velocities, states);
}

std::int32_t Particles::update_material(const mpm_material_batch& request) {
  mpm_material_batch batch = request;
  const auto state = pointers(material_state_, *material_.plugin);
  batch.count = batch.stride = static_cast<std::uint32_t>(padded_);
  batch.dimension = static_cast<std::uint32_t>(dimension_);
  batch.state = state.data();
  if (axisymmetric()) batch.velocity_gradient_zz = hoop_rate_.data();
  return material_.plugin->material().update[MPM_SCALAR_DOUBLE][dimension_ - 2](material_.parameters.data(), &batch);
}

void Particles::refuse_inverted(std::int32_t particle) const {
  if (particle < 0) return;
  const std::size_t p = std::min(static_cast<std::size_t>(particle), count_ - 1);
  for (const auto& [name, field] : material_state_)
    if (!field.col(static_cast<Eigen::Index>(p)).allFinite())
      throw RunFailure("not a number: its deformation is no longer finite", body_, p);
  throw RunFailure("inverted: its volume ratio J is not positive", body_, p);
}

void Particles::evaluate_stress() {
  mpm_material_batch batch{};
  batch.kirchhoff_stress = stress.data();
  batch.volume_ratio = volume_ratio.data();
  refuse_inverted(update_material(batch));
}

double Particles::strain(double dt) {
  pad(velocity_gradient);
  if (axisymmetric()) hoop_rate_ = gathered_velocity.row(0).array() / position.row(0).array(), pad(hoop_rate_);
  Array dissipated = make(1);
  mpm_material_batch batch{};
  batch.dt = dt;
  batch.velocity_gradient = velocity_gradient.data();
  batch.dissipated_energy = dissipated.data();
  refuse_inverted(update_material(batch));
  if (plan_.particle_domain && !frozen_)  // (I + dt L) domain, as F
    for (std::size_t p = 0; p < padded_; ++p)
      set(domain_, p, Matrix((Matrix::Identity() + dt * matrix(velocity_gradient, p)) * matrix(domain_, p)));
  if (axisymmetric()) dissipated.array() *= circumference_.array();
  return volume_ * dissipated.leftCols(count_).sum();
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

void Particles::call_gather(double dt, const Array& increments, Array& velocities, Fields& states, Array& advections) {
  const mpm_transfer& transfer = transfer_.plugin->transfer();
  for (Array* array : {&gathered_velocity, &gathered_increment, &gathered_affine, &gathered_gradient}) pad(*array);
  const Array moments = moments_for_transfer();
  const auto state = pointers(states, *transfer_.plugin);
  const auto n = static_cast<std::uint32_t>(padded_);
  const mpm_gather_batch batch{n,
                               n,
                               static_cast<std::uint32_t>(dimension_),
                               0,
                               dt,
                               gathered_velocity.data(),
                               increments.data(),
                               gathered_affine.data(),
                               gathered_gradient.data(),
                               velocities.data(),
                               state.data(),
                               advections.data(),
                               moments.size() ? moments.data() : nullptr};
  transfer.gather[MPM_SCALAR_DOUBLE][dimension_ - 2](transfer_.parameters.data(), &batch);
  if (plan_.basis_functions > 0) states.at(polynomial_coefficients) = gathered_higher;
}

void Particles::gather(double dt) {
  call_gather(dt, gathered_increment, velocity, transfer_state_, advection);
}

void Particles::take_gathered_velocity() {
  velocity = advection = gathered_velocity;
}

TimeStepLimit Particles::time_step_limit() {
  Array wave = make(1);
  mpm_material_batch batch{};
  batch.wave_speed = wave.data();
  refuse_inverted(update_material(batch));
  TimeStepLimit limit;
  limit.body = body_;
  for (std::size_t p = 0; p < count_; ++p) {
    const double speed = wave(0, p) + column(velocity, p).norm();
    if (speed > limit.speed) limit = {speed, wave(0, p), body_, p};
  }
  return limit;
}

double Particles::kinetic_energy() const {
  const bool affine = transfer_.plugin->transfer().traits & MPM_AFFINE_CARRIES_ENERGY;
  const Array* C = affine ? &transfer_state_.at(transfer_.plugin->state()[0].name) : nullptr;
  double sum = 0;
  for (std::size_t p = 0; p < count_; ++p) {
    sum += 0.5 * mass(p) * column(velocity, p).squaredNorm();
    if (C) sum += 0.5 * mass(p) * (matrix(*C, p) * second_moments_[p] * matrix(*C, p).transpose()).trace();
    for (int k = 0; k < plan_.basis_functions; ++k)
      for (int c = 0; c < dimension_; ++c)
        sum += 0.5 * mass(p) * higher_bases_[p].norm[k] *
               std::pow(transfer_state_.at(polynomial_coefficients)(k * dimension_ + c, p), 2);
  }
  return sum;
}

BodyState Particles::state() const {
  const auto particle_major = [&](const Array& array) {
    std::vector<double> values(count_ * array.rows());
    for (std::size_t p = 0; p < count_; ++p)
      for (Eigen::Index c = 0; c < array.rows(); ++c) values[p * array.rows() + c] = array(c, p);
    return values;
  };
  BodyState result;
  result.position = particle_major(position);
  result.velocity = particle_major(velocity);
  if (initial_position.size()) result.initial_position = particle_major(initial_position);
  for (const auto& [name, array] : transfer_state_) result.transfer_state[name] = particle_major(array);
  for (const auto& [name, array] : material_state_) result.material_state[name] = particle_major(array);
  if (plan_.sample_points > 0) result.corners = particle_major(experiment_.grid.cell_size * corners);
  if (plan_.particle_domain) result.domain = particle_major(experiment_.grid.cell_size * domain_);
  if (plan_.second_moment) {
    const double h = experiment_.grid.cell_size;
    result.second_moment = particle_major(h * h * shape_.evaluate(shape_arguments()).second_moment);
  }
  result.volume = volume_;
  result.mass = mass_;
  if (axisymmetric()) result.circumference = particle_major(circumference_);
  return result;
}

template <class Self, class Visit>
void Particles::visit_saved(Self& self, Visit visit) {
  visit("position", self.position);
  visit("velocity", self.velocity);
  visit("initial_position", self.initial_position);
  visit("circumference", self.circumference_);
  visit("domain", self.domain_);
  visit("corners", self.corners);
  for (auto& [name, field] : self.transfer_state_) visit(name, field);
  for (auto& [name, field] : self.material_state_) visit(name, field);
}

void Particles::save(ArchiveWriter& archive) const {
  visit_saved(*this, [&](const std::string& name, const Array& array) {
    archive.put(name, array.data(), static_cast<std::size_t>(array.size()));
  });
}

void Particles::restore(ArchiveReader& archive) {
  visit_saved(*this, [&](const std::string& name, Array& array) {
    archive.get(name, array.data(), static_cast<std::size_t>(array.size()));
  });
}

}  // namespace mpm::reference
