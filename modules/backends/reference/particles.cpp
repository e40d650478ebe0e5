#include "backends/reference/particles.hpp"

#include <cmath>

namespace mpm::reference {

Particles::Particles(const Experiment& experiment, const Plan& plan, int body, const SeededBody& seeded)
    : experiment_(experiment),
      transfer_(experiment.transfer),
      material_(experiment.materials[experiment.bodies[body].material].component),
      body_(body),
      field_(experiment.bodies[body].field),
      dimension_(experiment.dimension),
      count_(seeded.position.size() / experiment.dimension),
      padded_((count_ + MPM_LANES - 1) / MPM_LANES * MPM_LANES),
      mass_(seeded.mass),
      volume_(seeded.volume) {
  const int D = dimension_;
  position = make(D), velocity = make(D), advection = make(D);
  for (std::size_t p = 0; p < count_; ++p)
    for (int c = 0; c < D; ++c) {
      position(c, p) = seeded.position[p * D + c];
      velocity(c, p) = seeded.velocity[p * D + c];
    }
  pad(position), pad(velocity);
  if (plan.initial_position) initial_position = position;
  b = make(D), A = make(D * D), stress = make(D == 2 ? 4 : 6), volume_ratio = make(1);
  gathered_velocity = make(D), gathered_increment = make(D), gathered_affine = make(D * D),
  velocity_gradient = make(D * D);
  initialise(transfer_state_, *transfer_.plugin);
  initialise(material_state_, *material_.plugin);
  if (!seeded.velocity_gradient.empty()) {
    Array& affine = transfer_state_.at(transfer_.plugin->state()[0].name);
    for (std::size_t p = 0; p < count_; ++p)
      for (int k = 0; k < D * D; ++k) affine(k, p) = seeded.velocity_gradient[p * D * D + k];
    pad(affine);
  }
}

Array Particles::make(int components) const {
  return Array::Zero(components, static_cast<Eigen::Index>(padded_));
}

void Particles::initialise(std::map<std::string, Array>& fields, const Plugin& plugin) {
  for (const mpm_state& declared : plugin.state()) {
    const int components = state_components(static_cast<mpm_state_shape>(declared.shape), dimension_);
    Array& field = fields[declared.name] = make(components);
    if (declared.initial == MPM_INITIAL_ONE) field.setOnes();
    if (declared.initial == MPM_INITIAL_IDENTITY)
      for (int i = 0; i < (declared.shape == MPM_STATE_SYMMETRIC ? 3 : dimension_); ++i)
        field.row(declared.shape == MPM_STATE_SYMMETRIC ? i : i * (dimension_ + 1)).setOnes();
    const bool plane_strain = declared.shape == MPM_STATE_DEFORMATION && dimension_ == 2;  // xx xy yx yy zz
    if (declared.initial == MPM_INITIAL_IDENTITY && plane_strain) field.row(4).setOnes();
  }
}

std::vector<void*> Particles::pointers(std::map<std::string, Array>& fields, const Plugin& plugin) {
  std::vector<void*> list;
  for (const mpm_state& declared : plugin.state()) list.push_back(fields.at(declared.name).data());
  return list;
}

std::uint64_t Particles::bytes() const {
  Eigen::Index scalars = 0;
  for (const Array* array : {&position, &velocity, &initial_position, &advection, &b, &A, &stress, &volume_ratio,
                             &gathered_velocity, &gathered_increment, &gathered_affine, &velocity_gradient})
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

void Particles::find_stencils(const Grid& grid) {
  const mpm_shape& shape = experiment_.shape.plugin->shape();
  const int D = dimension_, K = static_cast<int>(shape.width);
  const double h = experiment_.grid.cell_size;
  Array cells = make(D), offset = make(D), w = make(D * K), g = make(D * K);
  std::vector<std::int32_t> base(D * padded_);
  for (int c = 0; c < D; ++c) cells.row(c) = (position.row(c).array() - experiment_.grid.lower[c]) / h;
  const mpm_shape_batch batch{static_cast<std::uint32_t>(padded_),
                              static_cast<std::uint32_t>(padded_),
                              static_cast<std::uint32_t>(D),
                              0,
                              cells.data(),
                              nullptr,
                              nullptr,
                              base.data(),
                              offset.data(),
                              w.data(),
                              g.data(),
                              nullptr};
  shape.evaluate[MPM_SCALAR_DOUBLE](experiment_.shape.parameters.data(), &batch);

  stencils_.assign(count_, {});
  for (std::size_t p = 0; p < count_; ++p)
    for (int k = 0; k < (D == 3 ? K : 1); ++k)
      for (int j = 0; j < K; ++j)
        for (int i = 0; i < K; ++i) {
          const int at[3] = {i, j, k};
          Eigen::Vector3i coordinates = Eigen::Vector3i::Zero();
          StencilNode node;
          node.weight = 1, node.gradient = Vector::Zero(), node.distance = Vector::Zero();
          for (int c = 0; c < D; ++c) {
            coordinates[c] = base[c * padded_ + p] + at[c];
            node.distance[c] = h * (at[c] - offset(c, p));
            node.weight *= w(c * K + at[c], p);
            node.gradient[c] = g(c * K + at[c], p) / h;
            for (int e = 0; e < D; ++e)
              if (e != c) node.gradient[c] *= w(e * K + at[e], p);
          }
          node.index = grid.index(coordinates);
          node.affine = shape.second_moment_kind == MPM_MOMENT_IS_GRADIENT
                            ? node.gradient
                            : Vector(node.weight * node.distance / (shape.second_moment * h * h));
          stencils_[p].push_back(node);
        }
}

void Particles::scatter_coefficients() {
  const mpm_transfer& transfer = transfer_.plugin->transfer();
  Array mass = make(1);
  mass.setConstant(mass_);
  const auto state = pointers(transfer_state_, *transfer_.plugin);
  const auto n = static_cast<std::uint32_t>(padded_);
  const mpm_scatter_batch batch{
      n, n, static_cast<std::uint32_t>(dimension_), 0, mass.data(), velocity.data(), state.data(), b.data(), A.data()};
  transfer.scatter[MPM_SCALAR_DOUBLE][dimension_ - 2](transfer_.parameters.data(), &batch);
}

std::int32_t Particles::update_material(const mpm_material_batch& request) {
  mpm_material_batch batch = request;
  const auto state = pointers(material_state_, *material_.plugin);
  batch.count = batch.stride = static_cast<std::uint32_t>(padded_);
  batch.dimension = static_cast<std::uint32_t>(dimension_);
  batch.state = state.data();
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
  Array dissipated = make(1);
  mpm_material_batch batch{};
  batch.dt = dt;
  batch.velocity_gradient = velocity_gradient.data();
  batch.dissipated_energy = dissipated.data();
  refuse_inverted(update_material(batch));
  return volume_ * dissipated.leftCols(count_).sum();
}

void Particles::gather(double dt) {
  const mpm_transfer& transfer = transfer_.plugin->transfer();
  for (Array* array : {&gathered_velocity, &gathered_increment, &gathered_affine}) pad(*array);
  const auto state = pointers(transfer_state_, *transfer_.plugin);
  const auto n = static_cast<std::uint32_t>(padded_);
  const mpm_gather_batch batch{n,
                               n,
                               static_cast<std::uint32_t>(dimension_),
                               0,
                               dt,
                               gathered_velocity.data(),
                               gathered_increment.data(),
                               gathered_affine.data(),
                               nullptr,
                               velocity.data(),
                               state.data(),
                               advection.data()};
  transfer.gather[MPM_SCALAR_DOUBLE][dimension_ - 2](transfer_.parameters.data(), &batch);
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
  const mpm_shape& shape = experiment_.shape.plugin->shape();
  const double h = experiment_.grid.cell_size;
  const bool affine = transfer_.plugin->transfer().traits & MPM_AFFINE_CARRIES_ENERGY;
  const Array* C = affine ? &transfer_state_.at(transfer_.plugin->state()[0].name) : nullptr;
  double sum = 0;
  for (std::size_t p = 0; p < count_; ++p) {
    sum += 0.5 * mass_ * column(velocity, p).squaredNorm();
    for (int a = 0; C && a < dimension_; ++a) {
      const double cell = (position(a, p) - experiment_.grid.lower[a]) / h, f = cell - std::floor(cell);
      const double moment =
          h * h * (shape.second_moment_kind == MPM_MOMENT_IS_GRADIENT ? f * (1 - f) : shape.second_moment);
      sum += 0.5 * mass_ * moment * matrix(*C, p).col(a).squaredNorm();
    }
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
  result.volume = volume_;
  result.mass = mass_;
  return result;
}

}  // namespace mpm::reference
