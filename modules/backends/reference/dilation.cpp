// Mean dilation, against locking: nodes average by volume how much a step dilates the particles around them, and each
// particle is strained by what it gathers of that instead of its own dilation.

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

/// Scales I + dt L so that its determinant is 1 + dt times the mean dilation: in the plane where z cannot strain, else
/// in all three directions.
void Particles::take_mean_dilation(double dt) {
  const int directions = dimension_ == 2 && !axisymmetric() ? 2 : 3;
  for (std::size_t p = 0; p < count_; ++p) {
    const double own = dilation(p, dt), change = dt * (mean_dilation(0, p) - own) / (1 + dt * own);
    if (!(change > -1)) continue;  // the material refuses a particle without volume
    const double stretch = std::expm1(std::log1p(change) / directions);  // the scale less 1
    const Matrix L = matrix(velocity_gradient, p);
    set(velocity_gradient, p, Matrix(L + stretch * L + stretch / dt * Matrix::Identity()));
    if (axisymmetric()) hoop_rate(0, p) += stretch * hoop_rate(0, p) + stretch / dt;
  }
  pad(velocity_gradient);
  if (axisymmetric()) pad(hoop_rate);
}

// ---- nodes --------------------------------------------------------------------------------------------------------

/// Sums w V and w V times the dilation of each particle, V its current volume.
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

void ReferenceBackend::average_dilation() {
  grid_.fold_as(volume_rate_, AtWall::even, {});
  grid_.fold_as(strained_volume_, AtWall::even, {});
  for_each_node([&](std::size_t i) {
    dilation_[i] = strained_volume_[i] > 0 ? volume_rate_[i] / strained_volume_[i] : 0;
  });
  grid_.fill_ghosts(dilation_, AtWall::even);
}

void ReferenceBackend::gather_dilation(Particles& body) {
  for (std::size_t p = 0; p < body.count(); ++p) {
    double mean = 0;
    for (const StencilNode& s : body.stencil(p)) mean += s.weight * dilation_[grid_.at(body.field(), s.index)];
    body.mean_dilation(0, p) = mean;
  }
}

}  // namespace mpm::reference
