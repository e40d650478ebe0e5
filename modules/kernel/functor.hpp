#pragma once
// The arguments that the host hands to functors, and what several functors share. Device-safe.

#include "kernel/tensor.hpp"

namespace mpm {

/// What a particle takes back from the grid. Only the moments a transfer declares are filled.
template <int D, class S>
struct GatheredMoments {
  Vec<D, S> velocity;            ///< sum w v+, m/s
  Vec<D, S> velocity_increment;  ///< sum w (v+ - v-), m/s
  Mat<D, S> affine;              ///< sum v+ (x) w D^-1 d, 1/s
  Mat<D, S> velocity_gradient;   ///< sum v+ (x) grad w, 1/s
  Mat<D, S> second_moment;       ///< D = sum w d d^T, cells^2, or any multiple of the identity that it is
};

/// The nodes of one particle, each once; lengths in cells. `T` is a plain scalar: lists are made particle by particle.
template <int D, class T, int Capacity>
struct NodeList {
  static constexpr int capacity = Capacity;
  int count;
  int node[Capacity][D];
  T weight[Capacity];
  T gradient[Capacity][D];  ///< derivative by the particle's position
};

/// Two velocity fields that meet at a node.
template <int D, class S>
struct ContactPair {  // NOLINT(clang-analyzer-optin.performance.Padding): in the order of the batch, for readers
  S mass_a, mass_b;   ///< kg
  Vec<D, S> momentum_a, momentum_b;  ///< kg m/s
  Vec<D, S> normal;                  ///< unit, from a to b
  S separation;                      ///< m, negative when the surfaces overlap
  S area;                            ///< m^2
  scalar_of<S> dt;                   ///< s
  bool after_forces = true;          ///< asked about v+, not about the v- that particles bring
  Vec<D, S> displacement{};          ///< m, how far b has moved beside a; only laws with MPM_COMPLIANT have it
  Vec<D, S> traction{};              ///< Pa, what would hold a to b; only laws with MPM_READS_TRACTION have it
  scalar_of<S> cell_size;            ///< m
  bool first_step = false;           ///< nothing has moved yet
  // These are for laws with a state: what the particles of each body keep, and what the step before has added to it.
  Vec<2, S> state_a{}, state_b{}, gained_a{}, gained_b{};
};

template <int D, class S>
struct ContactResult {
  Vec<D, S> impulse;  ///< added to a and taken from b, kg m/s
  S dissipated;       ///< J
  S status;           ///< 0 apart, 1 sticks, 2 slips
  S stored;           ///< J, taken up by springs; only laws with MPM_COMPLIANT fill it
  Vec<2, S> reached;  ///< what particles keep if they have less; only laws with a state fill it
};

/// What two bodies that meet at a node have there, as far as the normal says that it reads it; the rest is zero. Both
/// gradients are by the particles' positions and point out of the body.
template <int D, class S>
struct NormalPair {
  Vec<D, S> mass_gradient_a, mass_gradient_b;      ///< sum m grad w, kg/m
  Vec<D, S> volume_gradient_a, volume_gradient_b;  ///< sum V grad w, m^2
};

template <int D, class S>
struct NormalResult {
  Vec<D, S> normal;        ///< unit, from a to b
  Vec<D, S> own_a, own_b;  ///< of each body alone, unit, from a to b; only normals with MPM_OWN_NORMALS fill them
  S found;                 ///< 1 where there is a normal, else 0
};

/// Where two bodies that meet at a node are along their normal, in cells from the node, as far as the detection says that
/// it reads it; the rest is zero. Body a is on the near side.
template <class S>
struct DetectionPair {
  S mean_a, mean_b;        ///< the mean places of the mass that the node sees
  S edge_a, edge_b;        ///< the faces whose rows of particles have these means
  S surface_a, surface_b;  ///< how far the outermost particles extend
};

/// State of solids that keep F alone, declared as MPM_STATE_PLANE_DEFORMATION: `Gradient` is a Mat, or in axisymmetric
/// scenes a Deformation.
template <class Gradient>
struct ElasticState {
  Gradient deformation_gradient;
};
/// Base of the functors of solids that keep F alone and in which no strain turns to heat.
struct ElasticSolid {
  template <int D, class S>
  using State = ElasticState<Mat<D, S>>;
  template <class S>
  using AxisymmetricState = ElasticState<Deformation<2, S>>;

  /// Advances F <- (I + dt L) F. Returns the energy dissipated, J/m^3, which is none.
  template <class Constants, class G, class S = typename G::Scalar>
  MPM_HD static S advance(const Constants&, const G& L, scalar_of<S> dt, ElasticState<G>& state) {
    state.deformation_gradient = advanced(state.deformation_gradient, L, dt);
    return S(real<S>(0));
  }

  template <class G, class S = typename G::Scalar>
  MPM_HD static S volume_ratio(const ElasticState<G>& state) {
    return determinant(state.deformation_gradient);
  }
};

}  // namespace mpm
