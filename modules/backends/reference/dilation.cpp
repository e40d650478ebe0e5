// Averages against locking. Nodes average by volume how much a step dilates the particles around them, and each particle
// is strained by what it gathers of that instead of its own dilation. They average the mean normal stress likewise before it
// becomes force: the average is symmetric by volume, so that the forces do the work that the strain takes.

#include <Eigen/LU>
#include <cmath>

#include "backends/reference/reference_backend.hpp"

namespace mpm::reference {

// ---- particles ----------------------------------------------------------------------------------------------------

Matrix Particles::whole_gradient(std::size_t p) const {
  Matrix L = matrix(velocity_gradient, p);
  if (axisymmetric()) L(2, 2) = hoop_rate(0, p);
  return L;
}

/// By the invariants of L, as det(I + dt L) is 1 + dt I1 + dt^2 I2 + dt^3 I3.
double Particles::dilation(std::size_t p, double dt) const {
  const Matrix L = whole_gradient(p);
  const double first = L.trace(), second = 0.5 * (first * first - (L * L).trace());
  return first + dt * (second + dt * L.determinant());
}

void Particles::find_hoop_rate() {
  if (axisymmetric()) hoop_rate = gathered_velocity.row(0).array() / position.row(0).array(), pad(hoop_rate);
}

/// Scales I + dt L so that its determinant is 1 + dt times the mean dilation.
void Particles::take_mean_dilation(double dt) {
  for (std::size_t p = 0; p < count_; ++p) {
    const double own = dilation(p, dt), change = dt * (mean_dilation(0, p) - own) / (1 + dt * own);
    if (!(change > -1)) continue;  // the material refuses a particle without volume
    const double stretch = std::expm1(std::log1p(change) / dilated_directions());  // the scale less 1
    const Matrix L = matrix(velocity_gradient, p);
    set(velocity_gradient, p, Matrix(L + stretch * L + stretch / dt * Matrix::Identity()));
    if (axisymmetric()) hoop_rate(0, p) += stretch * hoop_rate(0, p) + stretch / dt;
  }
  pad(velocity_gradient);
  if (axisymmetric()) pad(hoop_rate);
}

double Particles::mean_stress(std::size_t p) const {
  double sum = 0;  // xx, yy, zz stand first
  for (int k = 0; k < dilated_directions(); ++k) sum += stress(k, p);
  return sum / dilated_directions();
}

void Particles::take_mean_stress(const Array& cauchy) {
  for (std::size_t p = 0; p < count_; ++p) {
    const double change = volume_ratio(0, p) * cauchy(0, p) - mean_stress(p);
    for (int k = 0; k < dilated_directions(); ++k) stress(k, p) += change;
  }
}

// ---- nodes --------------------------------------------------------------------------------------------------------

/// Sums w V and w V times the mean Cauchy stress of each particle, V its current volume.
void ReferenceBackend::scatter_mean_stress() {
  for_each_node([&](std::size_t i) { volume_stress_[i] = stressed_volume_[i] = 0; });
  for (Particles& body : bodies_) {
    body.evaluate_stress();
    for (std::size_t p = 0; p < body.count(); ++p)
      for (const StencilNode& s : body.stencil(p)) {
        const std::size_t i = grid_.at(body.field(), s.index);
        stressed_volume_[i] += s.weight * body.volume(p) * body.volume_ratio(0, p);
        volume_stress_[i] += s.weight * body.volume(p) * body.mean_stress(p);
      }
  }
}

/// Does the same with the dilation.
void ReferenceBackend::scatter_dilation(const Pass& pass, const StepInfo& step) {
  for_each_node([&](std::size_t i) { volume_rate_[i] = strained_volume_[i] = 0; });
  for (Particles& body : bodies_) {
    gather_moments(body, velocity_);
    body.find_hoop_rate();
    body.evaluate_stress();
    for (std::size_t p = 0; p < body.count(); ++p) {
      const double volume = body.volume(p) * body.volume_ratio(0, p);
      const double dilation = body.dilation(p, pass.share * step.dt);
      for (const StencilNode& s : body.stencil(p)) {
        const std::size_t i = grid_.at(body.field(), s.index);
        strained_volume_[i] += s.weight * volume;
        volume_rate_[i] += s.weight * volume * dilation;
      }
    }
  }
}

void ReferenceBackend::average(ScalarField& sum, ScalarField& volume, ScalarField& mean) {
  grid_.fold_as(sum, AtWall::even, {});
  grid_.fold_as(volume, AtWall::even, {});
  for_each_node([&](std::size_t i) { mean[i] = volume[i] > 0 ? sum[i] / volume[i] : 0; });
  grid_.fill_ghosts(mean, AtWall::even);
}

Array ReferenceBackend::gathered(Particles& body, const ScalarField& of_nodes) {
  Array values = Array::Zero(1, body.velocity.cols());
  for (std::size_t p = 0; p < body.count(); ++p)
    for (const StencilNode& s : body.stencil(p))
      values(0, static_cast<Eigen::Index>(p)) += s.weight * of_nodes[grid_.at(body.field(), s.index)];
  return values;
}

}  // namespace mpm::reference
