#pragma once
// Formulas for particles that are strained by the mean dilation around them: a step multiplies a particle's volume by
// det(I + dt L), and the matrix I + dt L is scaled so that it multiplies it by the mean instead. S may be a pack of lanes.

#include "kernel/tensor.hpp"

namespace mpm {

/// The relative change of a volume in a step over its length, (det(I + dt L) - 1) / dt, 1/s, as a sum of invariants: no
/// digits are lost where it is small.
template <class S>
MPM_HD S dilation_of(const Mat<2, S>& L, S dt) {
  return L(0, 0) + L(1, 1) + dt * determinant(L);
}
template <class S>
MPM_HD S dilation_of(const Mat<3, S>& L, S dt) {
  S minors = L(0, 0) * L(1, 1) - L(0, 1) * L(1, 0);
  minors = minors + (L(1, 1) * L(2, 2) - L(1, 2) * L(2, 1));
  minors = minors + (L(2, 2) * L(0, 0) - L(2, 0) * L(0, 2));
  return L(0, 0) + L(1, 1) + L(2, 2) + dt * (minors + dt * determinant(L));
}
template <class S>
MPM_HD S dilation_of(const Deformation<2, S>& L, S dt) {
  const S plane = dilation_of(L.plane, dt);
  return plane + L.zz + dt * (plane * L.zz);
}

/// The s for which (1 + s)^n = (1 + dt mean) / (1 + dt own), so that lengths in `n` directions give the volume of the
/// mean dilation. Where no volume is left it is 0, and the material refuses the particle.
template <int n, class S>
MPM_HD S stretch_to_mean(S own, S mean, S dt) {
  const S one = S(scalar_of<S>(1)), change = dt * (mean - own) / (one + dt * own);
  S stretch;
  if constexpr (n == 2) {
    stretch = change / (one + sqrt(one + change));
  } else {
    stretch = change * real<S>(1.0 / 3);
    for (int k = 0; k < 3;
         ++k) {  // Newton's method; what it starts from is wrong by a ninth of the square of the change
      const S length = one + stretch, three = S(scalar_of<S>(3));
      stretch = stretch - (stretch * (three + stretch * (three + stretch)) - change) / (three * length * length);
    }
  }
  return select(change > scalar_of<S>(-1), stretch, S(scalar_of<S>(0)));
}

/// Sets L to what makes (1 + s) (I + dt L) of I + dt L, given s / dt.
template <int D, class S>
MPM_HD void stretch_step(Mat<D, S>& L, S stretch, S rate) {
  for (int i = 0; i < D; ++i) {
    for (int j = 0; j < D; ++j) L(i, j) = L(i, j) + stretch * L(i, j);
    L(i, i) = L(i, i) + rate;
  }
}

/// Sets the velocity gradient L of a step to that of the mean dilation.
template <class S>
MPM_HD void take_mean_dilation(Mat<2, S>& L, S mean, S dt) {
  const S stretch = stretch_to_mean<2>(dilation_of(L, dt), mean, dt);
  stretch_step(L, stretch, stretch / dt);
}
template <class S>
MPM_HD void take_mean_dilation(Mat<3, S>& L, S mean, S dt) {
  const S stretch = stretch_to_mean<3>(dilation_of(L, dt), mean, dt);
  stretch_step(L, stretch, stretch / dt);
}
template <class S>
MPM_HD void take_mean_dilation(Deformation<2, S>& L, S mean, S dt) {
  const S stretch = stretch_to_mean<3>(dilation_of(L, dt), mean, dt), rate = stretch / dt;
  stretch_step(L.plane, stretch, rate);
  L.zz = L.zz + stretch * L.zz + rate;
}

}  // namespace mpm
