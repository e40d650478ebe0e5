#pragma once
// What laws with a rate share: the rate of deformation of a step, Newtonian stress, the exponential relaxation of a
// Maxwell element in closed form, and what viscosity asks of the time step.

#include "kernel/elasticity.hpp"
#include "kernel/unimodular.hpp"

namespace mpm {

// ---- rates -------------------------------------------------------------------------------------------------------

/// (f f^T - I)/dt of the step f = I + dt L: L + L^T + dt L L^T. It turns with f where frames turn, and no digits are
/// lost by subtracting I.
template <int D, class S>
MPM_HD Sym<D, S> strain_rate(const Mat<D, S>& L, scalar_of<S> dt) {
  Sym<D, S> r{};
  for (int i = 0; i < D; ++i)
    for (int j = i; j < D; ++j) {
      S t = L(i, 0) * L(j, 0);
      for (int k = 1; k < D; ++k) t = t + L(i, k) * L(j, k);
      r(i, j) = L(i, j) + L(j, i) + dt * t;
    }
  return r;
}
template <class S>
MPM_HD Sym<2, S> strain_rate(const Deformation<2, S>& L, scalar_of<S> dt) {
  Sym<2, S> r = strain_rate(L.plane, dt);
  r.s[2] = L.zz + L.zz + dt * (L.zz * L.zz);
  return r;
}

/// The product of two symmetric tensors that commute, which is symmetric.
template <int D, class S>
MPM_HD Sym<D, S> commuting_product(const Sym<D, S>& a, const Sym<D, S>& b) {
  Sym<D, S> r;
  r.s[2] = a.s[2] * b.s[2];  // zz in 2-D; written over below in 3-D
  for (int i = 0; i < D; ++i)
    for (int j = i; j < D; ++j) {
      S t = a(i, 0) * b(0, j);
      for (int k = 1; k < D; ++k) t = t + a(i, k) * b(k, j);
      r(i, j) = t;
    }
  return r;
}

/// a : b over the full tensors (off-diagonals counted twice).
template <int D, class S>
MPM_HD S contraction(const Sym<D, S>& a, const Sym<D, S>& b) {
  S r = a.s[0] * b.s[0] + a.s[1] * b.s[1] + a.s[2] * b.s[2];
  for (int k = 3; k < Sym<D, S>::size; ++k) r = r + real<S>(2) * a.s[k] * b.s[k];
  return r;
}

/// The rate of deformation d of a step from its strain rate e: ln(f f^T)/(2 dt) = e (2 I + dt e)^-1 up to terms of (dt
/// d)^3 (Cayley's transform; Hughes & Winget, Int. J. Numer. Methods Engrg. 15 (1980) 1862, in midpoint form). A rigid
/// turn has d = 0, however large.
template <int D, class S>
MPM_HD Sym<D, S> rate_of_deformation(const Sym<D, S>& e, scalar_of<S> dt) {
  Sym<D, S> sum;
  for (int k = 0; k < Sym<D, S>::size; ++k) sum.s[k] = dt * e.s[k];
  for (int i = 0; i < 3; ++i) sum.s[i] = sum.s[i] + real<S>(2);
  const S inverse = real<S>(1) / determinant(sum);
  Sym<D, S> d = commuting_product(e, cofactors(sum));
  for (int k = 0; k < Sym<D, S>::size; ++k) d.s[k] = inverse * d.s[k];
  return d;
}

/// J times a Cauchy stress.
template <int D, class S>
MPM_HD Sym<D, S> kirchhoff_of(const Sym<D, S>& cauchy, const S& J) {
  Sym<D, S> tau;
  for (int k = 0; k < Sym<D, S>::size; ++k) tau.s[k] = J * cauchy.s[k];
  return tau;
}

/// Cauchy stress 2 shear dev d + bulk tr(d) I of a Newtonian fluid; viscosities in Pa s.
template <int D, class S>
MPM_HD Sym<D, S> newtonian_stress(scalar_of<S> shear, scalar_of<S> bulk, const Sym<D, S>& d) {
  Sym<D, S> stress = deviator(d);
  const S pressure = bulk * trace(d);
  for (int k = 0; k < Sym<D, S>::size; ++k) stress.s[k] = real<S>(2) * shear * stress.s[k];
  for (int i = 0; i < 3; ++i) stress.s[i] = stress.s[i] + pressure;
  return stress;
}

/// The speed, m/s, by which a step of `courant` cells over speed stands viscosity besides waves of speed c: of the
/// oscillator w = 2 sqrt(3) c/h with the damping rate nu (2 sqrt(3)/h)^2, whose force is that of the velocity one step
/// before, the longest step is 2/(w (z + sqrt(1 + z^2))), z = sqrt(3) nu/(c h). 2 sqrt(3)/h is the largest wave number
/// that tents see with mass spread over them; nu is the kinematic viscosity of the longitudinal motion, m^2/s.
template <class S>
MPM_HD S damped_wave_speed(S squared_speed, S nu, scalar_of<S> inverse_cell_size) {
  const S damping = real<S>(1.7320508075688772) * inverse_cell_size * nu;
  return damping + sqrt(squared_speed + damping * damping);
}

// ---- Maxwell elements --------------------------------------------------------------------------------------------

/// What a step of y = dt/relaxation time leaves of a Maxwell element, y the same for all particles: `lost` = 1 - e^-y,
/// and `fed` = (1 - e^-y)/y - e^-y, the mean over the step of what the strain since then counts at its end. Series
/// below y = 1/2, as the differences lose digits there.
template <class T>
struct Relaxation {
  T steps, lost, fed;  ///< `steps` is y
  MPM_HD explicit Relaxation(T y) : steps(y) {
    T lost_series = T(0), fed_series = T(0);
    for (int k = 13; k >= 1; --k) {  // y/k (1 - ...) and y/(k + 1) (k/...)
      lost_series = y / T(k) * (T(1) - lost_series);
    }
    T term = y;
    for (int k = 0; k < 14; ++k) fed_series = fed_series + term / T(k + 2), term = -(term * y) / T(k + 1);
    const auto is_short = y < T(0.5);
    lost = select(is_short, lost_series, T(1) - exp(-y));
    fed = select(is_short, fed_series, lost / max(y, T(0.5)) - T(1) + lost);
  }
};

/// The conformation A of a Maxwell element, dA/dt = L A + A L^T - (A - I)/time, at the end of a step that took it to A*
/// = f A f^T and has the strain f f^T - I:
///   A = I + e^-y (A* - I) + fed (f f^T - I).
/// That is Lodge's integral of what is lost and reformed (Trans. Faraday Soc. 52 (1956) 120), the strain since then
/// taken as linear in time. It is a mean of A*, I and f f^T with weights that are not negative, so A stays positive
/// definite; it is exact in relaxation, and for the shear stress of simple shear, and of second order else. Steps longer
/// than the relaxation time end at the viscous stress.
template <int D, class S>
MPM_HD Sym<D, S> relaxed(const Sym<D, S>& convected, const Sym<D, S>& strain, const Relaxation<scalar_of<S>>& r) {
  Sym<D, S> A;
  for (int k = 0; k < Sym<D, S>::size; ++k) {
    const S from_rest = k < 3 ? convected.s[k] - real<S>(1) : convected.s[k];
    A.s[k] = convected.s[k] - r.lost * from_rest + r.fed * strain.s[k];
  }
  return A;
}

/// tr A - 3 - ln det A: twice the energy over the modulus of a network of chains with conformation A.
template <int D, class S>
MPM_HD S network_energy(const Sym<D, S>& A) {
  return trace(A) - real<S>(3) - log(determinant(A));
}

/// tr(A + A^-1 - 2 I) = tr((A - I) A^-1 (A - I)), which is not negative: twice the rate of dissipation times relaxation
/// time over modulus.
template <int D, class S>
MPM_HD S network_dissipation(const Sym<D, S>& A) {
  Sym<D, S> X = A;
  for (int i = 0; i < 3; ++i) X.s[i] = X.s[i] - real<S>(1);
  return contraction(commuting_product(X, X), cofactors(A)) / determinant(A);
}

/// Heat of the step over half the modulus: the trapezoidal rule of the rate of dissipation from one conformation to the
/// next, with what the first can still give, (1 - e^-y)/2 instead of y/2, where the step is long.
template <int D, class S>
MPM_HD S network_heat(const Sym<D, S>& before, const Sym<D, S>& after, const Relaxation<scalar_of<S>>& r) {
  const scalar_of<S> first = real<S>(0.5) * r.lost;
  return first * network_dissipation(before) + (r.steps - first) * network_dissipation(after);
}

}  // namespace mpm
