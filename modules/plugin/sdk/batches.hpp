#pragma once
// The concepts that a functor must meet, and the loops that turn it into the C entry points of abi.h, for lanes and
// for plain double.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "kernel/functor.hpp"
#include "kernel/lanes.hpp"
#include "kernel/tensor.hpp"
#include "plugin/extensions.h"
#include "plugin/sdk/points.hpp"
#include "plugin/tables.hpp"

namespace mpm::sdk {

// ---- concepts: what a functor must offer -------------------------------------------------------------------------

/// What a shape needs of the particle (mpm_need); none when the functor does not say.
template <class F>
constexpr std::uint32_t needs_of() {
  if constexpr (requires { F::needs; })
    return F::needs;
  else
    return 0;
}

/// A shape with width, second moment and the weights of one axis. `base` is the first node; x and base are in cells.
template <class F>
concept PlainShapeFunctor = requires(const typename F::Parameters& p, double x, double& base, double* w, double* g) {
  { F::width } -> std::convertible_to<int>;
  F::second_moment_kind;
  F::evaluate(p, x, base, w, g);
};
/// A shape whose particles have a size: `half_size` of the undeformed box along the axis, in cells.
template <class F>
concept SizedShapeFunctor = (needs_of<F>() == MPM_NEEDS_HALF_SIZE) &&
                            requires(const typename F::Parameters& p, double x, double half_size, double& base,
                                     double* w, double* g) {
  { F::width } -> std::convertible_to<int>;
  F::second_moment_kind;
  F::evaluate(p, x, half_size, base, w, g);
};
/// A shape whose particles' boxes follow their deformation: `half_lengths` of the box along the axes, in cells, from
/// the semi-side vectors of its domain (the columns, see mpm_list_batch). The first node depends on x alone. Where the
/// stencil does not hold the box, weights are zero and the run stops.
template <class F, int D>
concept DeformedShapeFunctorIn = requires(const typename F::Parameters& p, const Mat<D, double>& domain) {
  { F::template half_lengths<D, double>(p, domain) } -> std::same_as<Vec<D, double>>;
};
template <class F>
concept HalfLengthsFunctor = (needs_of<F>() == MPM_NEEDS_DOMAIN) &&
                             DeformedShapeFunctorIn<F, 1>&& DeformedShapeFunctorIn<F, 2>&& DeformedShapeFunctorIn<F, 3>;
template <class F>
concept DeformedShapeFunctor = HalfLengthsFunctor<F> &&
    requires(const typename F::Parameters& p, double x, double half_length, double& base, double* w, double* g) {
  { F::width } -> std::convertible_to<int>;
  F::second_moment_kind;
  F::evaluate(p, x, half_length, base, w, g);
};
template <class F>
concept ShapeFunctor = PlainShapeFunctor<F> || SizedShapeFunctor<F> || DeformedShapeFunctor<F>;

/// The nodes of one particle whose domain has the columns of `domain` as semi-side vectors, all in cells.
template <class F, int D>
concept ListShapeFunctorIn = requires(const typename F::Parameters& p, const Vec<D, double>& x,
                                      const Mat<D, double>& domain, NodeList<D, double, F::template capacity<D>>& out) {
  { F::reach } -> std::convertible_to<double>;
  F::evaluate(p, x, domain, out);
};
/// The nodes of one particle whose domain is a quadrilateral or hexahedron with these corners, given from the particle.
template <class F, int D>
concept SampledShapeFunctorIn = requires(const typename F::Parameters& p, const Vec<D, double>& x,
                                         const Vec<D, double>* corners,
                                         NodeList<D, double, F::template capacity<D>>& out) {
  { F::reach } -> std::convertible_to<double>;
  { F::template sample_points<D> } -> std::convertible_to<int>;
  F::evaluate(p, x, corners, out);
};
template <class F>
concept SampledShapeFunctor = SampledShapeFunctorIn<F, 2> && SampledShapeFunctorIn<F, 3>;
template <class F>
concept ListShapeFunctor = (ListShapeFunctorIn<F, 2> && ListShapeFunctorIn<F, 3>) || SampledShapeFunctor<F>;
/// The nodes of a list as a box of `extent` nodes an axis from `base` (mpm_box_batch), over lanes: `box` returns the
/// extent, 0 where the list must be taken. Rows of W nodes, the last axis along the row, come from what `prepare_rows`
/// computes once; they are undefined in lanes of other extents than 1 to W. The second moment is the matrix sum w d
/// d^T.
template <class F, int D>
concept BoxShapeFunctorIn = requires(const typename F::Parameters& p, const Vec<D, double>& x,
                                     const Mat<D, double>& domain, Vec<D, double>& base,
                                     typename F::template Rows<4, D, double>& rows, double* w, double (*g)[4]) {
  { F::template box<D, double>(p, x, domain, true, base) } -> std::convertible_to<double>;
  F::template prepare_rows<4, D, double>(p, x, domain, base, true, rows);
  F::template row_in_box<4, D, true, double>(rows, 0, 0, w, g);
  { F::template moment_of_box<4, D, double>(rows, domain) } -> std::same_as<Mat<D, double>>;
};
template <class F>
concept BoxShapeFunctor = ListShapeFunctor<F> && BoxShapeFunctorIn<F, 2> && BoxShapeFunctorIn<F, 3>;

/// How one pass of the filter's loop changes a node (mpm_filter in abi.h).
template <class F, int D>
concept FilterFunctorIn = requires(const typename F::Parameters& p, const Vec<D, double>& projected,
                                   Vec<D, double>& increment, Vec<D, double>& velocity) {
  { F::traits } -> std::convertible_to<unsigned>;
  { F::iterations(p) } -> std::convertible_to<int>;
  F::update(p, 1, projected, increment, velocity);
};
template <class F>
concept FilterFunctor = FilterFunctorIn<F, 2> && FilterFunctorIn<F, 3>;

template <class F, int D>
concept TransferFunctorIn = requires(const typename F::Parameters& p, const Vec<D, double>& v, Vec<D, double>& out,
                                     Mat<D, double>& A, typename F::template State<D, double>& state,
                                     const GatheredMoments<D, double>& moments) {
  { F::traits } -> std::convertible_to<unsigned>;
  F::scatter(p, 1.0, v, state, out, A);
  F::gather(p, moments, 1.0, out, state, out);
};
template <class F>
concept TransferFunctor = TransferFunctorIn<F, 2> && TransferFunctorIn<F, 3>;

template <class F, int D>
concept ContactFunctorIn = requires(const typename F::Parameters& p, const ContactPair<D, double>& pair,
                                    ContactResult<D, double>& result) {
  { F::traits } -> std::convertible_to<unsigned>;
  F::apply(p, pair, result);
};
template <class F>
concept ContactFunctor = ContactFunctorIn<F, 2> && ContactFunctorIn<F, 3>;

/// A normal that follows from sums over a node.
template <class F, int D>
concept SumsNormalFunctorIn = requires(const typename F::Parameters& p, const NormalPair<D, double>& pair,
                                       NormalResult<D, double>& result) {
  { F::traits } -> std::convertible_to<unsigned>;
  F::find(p, pair, result);
};
template <class F>
concept SumsNormalFunctor = SumsNormalFunctorIn<F, 2> && SumsNormalFunctorIn<F, 3>;
/// A normal that looks at the particles near a node, in clouds of any kind (kernel/points.hpp). Returns whether there is one.
template <class F, int D>
concept PointsNormalFunctorIn = requires(const typename F::Parameters& p, const PointsOfPair<CloudInLanes>& points,
                                         double* normal) {
  { F::traits } -> std::convertible_to<unsigned>;
  { F::template find<D>(p, points, normal) } -> std::same_as<bool>;
};
template <class F>
concept PointsNormalFunctor = PointsNormalFunctorIn<F, 2> && PointsNormalFunctorIn<F, 3>;

/// Returns the gap between the surfaces of a pair, in cells.
template <class F>
concept DetectionFunctor = requires(const typename F::Parameters& p, const DetectionPair<double>& pair) {
  { F::traits } -> std::convertible_to<unsigned>;
  { F::gap(p, pair) } -> std::same_as<double>;
};

template <class F, int D>
concept MaterialFunctorIn = requires(const typename F::template Constants<double>& c, const Mat<D, double>& L,
                                     typename F::template State<D, double>& s) {
  { F::traits } -> std::convertible_to<unsigned>;
  { F::advance(c, L, 1.0, s) } -> std::convertible_to<double>;
  { F::kirchhoff_stress(c, s) } -> std::same_as<Sym<D, double>>;
  { F::stored_energy(c, s) } -> std::convertible_to<double>;
  { F::wave_speed(c, s) } -> std::convertible_to<double>;
  { F::volume_ratio(s) } -> std::convertible_to<double>;
};
template <class F>
concept MaterialFunctor = MaterialFunctorIn<F, 2> && MaterialFunctorIn<F, 3>;
/// A material of axisymmetric scenes: `advance` takes L with its zz, and the state keeps zz where it is not 1.
template <class F>
concept AxisymmetricMaterialFunctor = MaterialFunctor<F> &&
    requires(const typename F::template Constants<double>& c, const Deformation<2, double>& L,
             typename F::template AxisymmetricState<double>& s) {
  { F::advance(c, L, 1.0, s) } -> std::convertible_to<double>;
  { F::kirchhoff_stress(c, s) } -> std::same_as<Sym<2, double>>;
  { F::stored_energy(c, s) } -> std::convertible_to<double>;
  { F::wave_speed(c, s) } -> std::convertible_to<double>;
  { F::volume_ratio(s) } -> std::convertible_to<double>;
};

// ---- loading and storing components ------------------------------------------------------------------------------

template <class S>
struct Access {  // plain scalar
  static constexpr int width = 1;
  static S load(const S* p) { return *p; }
  static void store(S* p, S x) { *p = x; }
  static void store_index(std::int32_t* p, S x) { *p = static_cast<std::int32_t>(x); }
};
template <class T>
struct Access<Lanes<T>> {
  static constexpr int width = Lanes<T>::width;
  static Lanes<T> load(const T* p) { return Lanes<T>::load(p); }
  static void store(T* p, Lanes<T> x) { x.store(p); }
  static void store_index(std::int32_t* p, Lanes<T> x) {
    for (int i = 0; i < width; ++i) p[i] = static_cast<std::int32_t>(x[i]);
  }
};

/// Number of scalars in a struct of S, zero for an empty one.
template <class Struct, class S>
inline constexpr int scalars_in = std::is_empty_v<Struct> ? 0 : static_cast<int>(sizeof(Struct) / sizeof(S));

template <int N, class S, class T>
MPM_HD void load_components(const void* array, std::uint32_t stride, std::uint32_t lane, T* out) {
  const scalar_of<S>* p = static_cast<const scalar_of<S>*>(array);
  for (int k = 0; k < N; ++k) out[k] = Access<S>::load(p + k * stride + lane);
}
template <int N, class S, class T>
MPM_HD void store_components(void* array, std::uint32_t stride, std::uint32_t lane, const T* in) {
  scalar_of<S>* p = static_cast<scalar_of<S>*>(array);
  for (int k = 0; k < N; ++k) Access<S>::store(p + k * stride + lane, in[k]);
}

/// Where each scalar of a State struct lies in the declared fields: field index and component within it.
template <int Count>
struct StateLayout {
  int field[Count ? Count : 1]{};
  int component[Count ? Count : 1]{};
};
constexpr int components_of(std::uint32_t shape, int D, bool axisymmetric = false) {
  if (shape == MPM_STATE_PLANE_DEFORMATION) return axisymmetric ? 5 : D * D;
  return shape == MPM_STATE_SCALAR        ? 1
         : shape == MPM_STATE_VECTOR      ? D
         : shape == MPM_STATE_MATRIX      ? D * D
         : shape == MPM_STATE_DEFORMATION ? (D == 2 ? 5 : 9)
                                          : (D == 2 ? 4 : 6);
}
template <class F, int D>
constexpr int declared_components(bool axisymmetric) {
  int total = 0;
  for (const mpm_state& field : F::state) total += components_of(field.shape, D, axisymmetric);
  return total;
}
template <class F>
concept HasState = requires {
  F::state[0].shape;
};
/// A functor whose State ends in a member `temperature`, K, beyond the declared fields. The temperature is the host's,
/// who hands it over in the batch; `reference_temperature` stands where a batch has none.
template <class F>
concept TemperatureFunctor = requires(typename F::template State<2, double> s) {
  s.temperature;
  { F::reference_temperature } -> std::convertible_to<double>;
};
template <class F, int D, int Count, bool Axisymmetric>
constexpr StateLayout<Count> state_layout() {
  StateLayout<Count> layout;
  if constexpr (HasState<F>) {
    static_assert(declared_components<F, D>(Axisymmetric) == Count,
                  "the State struct must hold exactly the declared state fields, in order");
    int k = 0, f = 0;
    for (const mpm_state& field : F::state) {
      for (int c = 0; c < components_of(field.shape, D, Axisymmetric); ++c, ++k)
        layout.field[k] = f, layout.component[k] = c;
      ++f;
    }
  } else {
    static_assert(Count == 0, "a State struct with members needs a `state` table");
  }
  return layout;
}

/// The functor's State, or its AxisymmetricState.
template <class F, int D, class S, bool Axisymmetric>
struct StateOf {
  using type = typename F::template State<D, S>;
};
template <class F, class S>
struct StateOf<F, 2, S, true> {
  using type = typename F::template AxisymmetricState<S>;
};
template <class F, int D, class S, bool Axisymmetric = false>
struct StateAccess {
  using State = typename StateOf<F, D, S, Axisymmetric>::type;
  static constexpr int count = scalars_in<State, S> - (TemperatureFunctor<F> ? 1 : 0);
  static constexpr StateLayout<count> layout = state_layout<F, D, count, Axisymmetric>();

  MPM_HD static State load(const void* const* fields, std::uint32_t stride, std::uint32_t lane) {
    State state{};
    S* flat = reinterpret_cast<S*>(&state);
    for (int k = 0; k < count; ++k)
      flat[k] = Access<S>::load(static_cast<const scalar_of<S>*>(fields[layout.field[k]]) +
                                layout.component[k] * stride + lane);
    return state;
  }
  /// Loads the temperatures of a batch too, in states that take one; a null pointer stands for the reference
  /// temperature.
  MPM_HD static State load(const void* const* fields, const void* temperature, std::uint32_t stride,
                           std::uint32_t lane) {
    State state = load(fields, stride, lane);
    if constexpr (TemperatureFunctor<F>) {
      static_assert(offsetof(State, temperature) == count * sizeof(S), "`temperature` stands at the end of the State");
      state.temperature = temperature ? Access<S>::load(static_cast<const scalar_of<S>*>(temperature) + lane)
                                      : S(real<S>(F::reference_temperature));
    }
    return state;
  }
  MPM_HD static void store(void* const* fields, std::uint32_t stride, std::uint32_t lane, const State& state) {
    const S* flat = reinterpret_cast<const S*>(&state);
    for (int k = 0; k < count; ++k)
      Access<S>::store(static_cast<scalar_of<S>*>(fields[layout.field[k]]) + layout.component[k] * stride + lane,
                       flat[k]);
  }
};

// ---- batch loops -------------------------------------------------------------------------------------------------

/// The block as the functor's own struct. A functor without parameters gets no block: the pointer may then be null.
template <class F>
const typename F::Parameters& parameters_of(const void* block) {
  if constexpr (std::is_empty_v<typename F::Parameters>) {
    static constexpr typename F::Parameters none{};
    return none;
  } else {
    return *static_cast<const typename F::Parameters*>(block);
  }
}

/// Evaluates one axis of one pack of particles; `half_length`, for shapes that take one, is that of their boxes along
/// the axis.
template <class F, class S>
inline __attribute__((always_inline)) void shape_axis(const typename F::Parameters& p, const mpm_shape_batch& q,
                                                      std::uint32_t axis, std::uint32_t lane, S half_length) {
  using T = scalar_of<S>;
  S base, w[F::width], g[F::width];
  const std::uint32_t at = axis * q.stride + lane;
  const S x = Access<S>::load(static_cast<const T*>(q.position) + at);
  S* const slopes = q.gradient ? g : static_cast<S*>(nullptr);
  if constexpr (SizedShapeFunctor<F> || DeformedShapeFunctor<F>)
    F::evaluate(p, x, half_length, base, w, slopes);
  else
    F::evaluate(p, x, base, w, slopes);
  const S offset = x - base;
  Access<S>::store_index(q.base + at, base);
  Access<S>::store(static_cast<T*>(q.offset) + at, offset);
  const std::uint32_t first = axis * F::width * q.stride + lane;
  for (int k = 0; k < F::width; ++k) Access<S>::store(static_cast<T*>(q.weight) + first + k * q.stride, w[k]);
  if (q.gradient)
    for (int k = 0; k < F::width; ++k) Access<S>::store(static_cast<T*>(q.gradient) + first + k * q.stride, g[k]);
  if (!q.second_moment) return;
  S moment = S(real<S>(0));
  for (int k = 0; k < F::width; ++k) {
    const S d = real<S>(k) - offset;
    moment = moment + w[k] * d * d;
  }
  Access<S>::store(static_cast<T*>(q.second_moment) + at, moment);
}

template <class F, class S, int D>
void deformed_shape_batch(const typename F::Parameters& p, const mpm_shape_batch& q) {
  for (std::uint32_t lane = 0; lane < q.count; lane += Access<S>::width) {
    Mat<D, S> domain;
    load_components<D * D, S>(q.domain, q.stride, lane, domain.m);
    const Vec<D, S> half_length = F::template half_lengths<D, S>(p, domain);
    for (int axis = 0; axis < D; ++axis) shape_axis<F, S>(p, q, axis, lane, half_length[axis]);
  }
}

template <class F, class S>
void shape_batch(const void* parameters, const mpm_shape_batch* request) {
  const mpm_shape_batch q = *request;  // a copy of its own: nothing that is stored changes it
  const auto& p = parameters_of<F>(parameters);
  if constexpr (DeformedShapeFunctor<F>) {
    if (q.dimension == 1) return deformed_shape_batch<F, S, 1>(p, q);
    if (q.dimension == 2) return deformed_shape_batch<F, S, 2>(p, q);
    return deformed_shape_batch<F, S, 3>(p, q);
  } else {
    for (std::uint32_t axis = 0; axis < q.dimension; ++axis)
      for (std::uint32_t lane = 0; lane < q.count; lane += Access<S>::width) {
        S half_length{};
        if constexpr (SizedShapeFunctor<F>)
          half_length = Access<S>::load(static_cast<const scalar_of<S>*>(q.half_size) + axis * q.stride + lane);
        shape_axis<F, S>(p, q, axis, lane, half_length);
      }
  }
}

/// Evaluates lists particle by particle: the number of nodes differs from one to the next.
template <class F, int D, class T>
void list_batch(const void* parameters, const mpm_list_batch* request) {
  const mpm_list_batch q = *request;  // a copy of its own: nothing that is stored changes it
  using List = NodeList<D, T, F::template capacity<D>>;
  const auto& p = parameters_of<F>(parameters);
  for (std::uint32_t i = 0; i < q.count; ++i) {
    Vec<D, T> x;
    List list;
    load_components<D, T>(q.position, q.stride, i, x.v);
    if constexpr (SampledShapeFunctor<F>) {
      Vec<D, T> corners[F::template sample_points<D>];
      load_components<F::template sample_points<D> * D, T>(q.samples, q.stride, i, corners[0].v);
      F::evaluate(p, x, corners, list);
    } else {
      Mat<D, T> domain{};
      load_components<D * D, T>(q.domain, q.stride, i, domain.m);
      F::evaluate(p, x, domain, list);
    }
    q.node_count[i] = list.count;
    Mat<D, T> moment{};
    for (int k = 0; k < list.count; ++k) {
      static_cast<T*>(q.weight)[k * q.stride + i] = list.weight[k];
      Vec<D, T> d;
      for (int a = 0; a < D; ++a) {
        q.node[(k * D + a) * q.stride + i] = list.node[k][a];
        if (q.gradient) static_cast<T*>(q.gradient)[(k * D + a) * q.stride + i] = list.gradient[k][a];
        d[a] = static_cast<T>(list.node[k][a]) - x[a];
      }
      if (!q.second_moment) continue;
      for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b) moment(a, b) += list.weight[k] * d[a] * d[b];
    }
    if (q.second_moment) store_components<D * D, T>(q.second_moment, q.stride, i, moment.m);
  }
}

/// Puts rows of W nodes into their places in the widest box.
template <class F, int W, int D, bool Gradients, class S>
void box_rows(const mpm_box_batch* q, std::uint32_t lane, const typename F::template Rows<W, D, S>& rows) {
  using T = scalar_of<S>;
  constexpr std::uint32_t width = MPM_BOX_WIDTH, places = D == 2 ? width * width : width * width * width;
  for (int i = 0; i < W; ++i)
    for (int j = 0; j < (D == 2 ? 1 : W); ++j) {
      S w[W], g[D][W];
      F::template row_in_box<W, D, Gradients, S>(rows, i, j, w, g);
      const std::uint32_t first = (D == 2 ? i * width : (i * width + j) * width) * q->stride + lane;
      MPM_UNROLL
      for (int k = 0; k < W; ++k) Access<S>::store(static_cast<T*>(q->weight) + first + k * q->stride, w[k]);
      if constexpr (Gradients) MPM_UNROLL
      for (int a = 0; a < D; ++a) MPM_UNROLL
      for (int k = 0; k < W; ++k)
        Access<S>::store(static_cast<T*>(q->gradient) + first + (a * places + k) * q->stride, g[a][k]);
    }
}
template <class F, int W, int D, class S>
void box_lanes(const void* parameters, const mpm_box_batch* q, std::uint32_t lane, const Vec<D, S>& x,
               const Mat<D, S>& domain, const Vec<D, S>& base) {
  typename F::template Rows<W, D, S> rows;
  F::template prepare_rows<W, D, S>(parameters_of<F>(parameters), x, domain, base, q->gradient != nullptr, rows);
  if (q->gradient)
    box_rows<F, W, D, true, S>(q, lane, rows);
  else
    box_rows<F, W, D, false, S>(q, lane, rows);
  if (q->second_moment)
    store_components<D * D, S>(q->second_moment, q->stride, lane, F::template moment_of_box<W, D, S>(rows, domain).m);
}

template <class F, int D, class S>
void box_batch(const void* parameters, const mpm_box_batch* q) {
  for (std::uint32_t lane = 0; lane < q->count; lane += Access<S>::width) {
    Vec<D, S> x, base, offset;
    Mat<D, S> domain;
    load_components<D, S>(q->position, q->stride, lane, x.v);
    load_components<D * D, S>(q->domain, q->stride, lane, domain.m);
    const S extent = F::template box<D, S>(parameters_of<F>(parameters), x, domain, q->gradient != nullptr, base);
    for (int a = 0; a < D; ++a) {
      Access<S>::store_index(q->base + a * q->stride + lane, base[a]);
      offset[a] = x[a] - base[a];
    }
    store_components<D, S>(q->offset, q->stride, lane, offset.v);
    Access<S>::store_index(q->extent + lane, extent);
    // Most boxes are narrow; a pack that holds a wider one takes rows of the widest.
    if (any(extent > real<S>(3)))
      box_lanes<F, 4, D, S>(parameters, q, lane, x, domain, base);
    else
      box_lanes<F, 3, D, S>(parameters, q, lane, x, domain, base);
  }
}

template <class F>
std::int32_t filter_iterations(const void* parameters) {
  return static_cast<std::int32_t>(F::iterations(parameters_of<F>(parameters)));
}

template <class F, int D, class S>
void filter_batch(const void* parameters, const mpm_filter_batch* request) {
  const mpm_filter_batch q = *request;  // a copy of its own: nothing that is stored changes it
  const auto& p = parameters_of<F>(parameters);
  for (std::uint32_t lane = 0; lane < q.count; lane += Access<S>::width) {
    Vec<D, S> projected, increment, velocity;
    load_components<D, S>(q.projected, q.stride, lane, projected.v);
    load_components<D, S>(q.increment, q.stride, lane, increment.v);
    load_components<D, S>(q.velocity, q.stride, lane, velocity.v);
    F::update(p, static_cast<int>(q.iteration), projected, increment, velocity);
    store_components<D, S>(q.increment, q.stride, lane, increment.v);
    store_components<D, S>(q.velocity, q.stride, lane, velocity.v);
  }
}

template <class F, int D, class S>
void scatter_batch(const void* parameters, const mpm_scatter_batch* request) {
  const mpm_scatter_batch q = *request;  // a copy of its own: nothing that is stored changes it
  const auto& p = parameters_of<F>(parameters);
  for (std::uint32_t lane = 0; lane < q.count; lane += Access<S>::width) {
    S mass;
    Vec<D, S> v, b;
    Mat<D, S> A;
    load_components<1, S>(q.mass, q.stride, lane, &mass);
    load_components<D, S>(q.velocity, q.stride, lane, v.v);
    F::scatter(p, mass, v, StateAccess<F, D, S>::load(q.state, q.stride, lane), b, A);
    store_components<D, S>(q.b, q.stride, lane, b.v);
    if constexpr ((F::traits & MPM_SCATTERS_AFFINE) != 0) store_components<D * D, S>(q.A, q.stride, lane, A.m);
  }
}

template <class F, int D, class S>
void gather_batch(const void* parameters, const mpm_gather_batch* request) {
  const mpm_gather_batch q = *request;  // a copy of its own: nothing that is stored changes it
  const auto& p = parameters_of<F>(parameters);
  for (std::uint32_t lane = 0; lane < q.count; lane += Access<S>::width) {
    GatheredMoments<D, S> moments{};
    load_components<D, S>(q.velocity, q.stride, lane, moments.velocity.v);
    if constexpr ((F::traits & MPM_GATHERS_INCREMENT) != 0)
      load_components<D, S>(q.velocity_increment, q.stride, lane, moments.velocity_increment.v);
    if constexpr ((F::traits & MPM_GATHERS_AFFINE) != 0)
      load_components<D * D, S>(q.affine, q.stride, lane, moments.affine.m);
    if constexpr ((F::traits & MPM_GATHERS_GRADIENT) != 0)
      load_components<D * D, S>(q.velocity_gradient, q.stride, lane, moments.velocity_gradient.m);
    if constexpr ((F::traits & MPM_READS_SECOND_MOMENT) != 0) {
      moments.second_moment = Mat<D, S>::identity();
      if (q.second_moment) load_components<D * D, S>(q.second_moment, q.stride, lane, moments.second_moment.m);
    }
    Vec<D, S> v, advection;
    load_components<D, S>(q.particle_velocity, q.stride, lane, v.v);
    auto state = StateAccess<F, D, S>::load(q.state, q.stride, lane);
    F::gather(p, moments, real<S>(q.dt), v, state, advection);
    store_components<D, S>(q.particle_velocity, q.stride, lane, v.v);
    StateAccess<F, D, S>::store(q.state, q.stride, lane, state);
    store_components<D, S>(q.advection_velocity, q.stride, lane, advection.v);
  }
}

template <class F, int D, class S>
void contact_batch(const void* parameters, const mpm_contact_batch* request) {
  const mpm_contact_batch q = *request;  // a copy of its own: nothing that is stored changes it
  const auto& p = parameters_of<F>(parameters);
  for (std::uint32_t lane = 0; lane < q.count; lane += Access<S>::width) {
    ContactPair<D, S> pair;
    ContactResult<D, S> result;
    load_components<1, S>(q.mass_a, q.stride, lane, &pair.mass_a);
    load_components<1, S>(q.mass_b, q.stride, lane, &pair.mass_b);
    load_components<D, S>(q.momentum_a, q.stride, lane, pair.momentum_a.v);
    load_components<D, S>(q.momentum_b, q.stride, lane, pair.momentum_b.v);
    load_components<D, S>(q.normal, q.stride, lane, pair.normal.v);
    load_components<1, S>(q.separation, q.stride, lane, &pair.separation);
    load_components<1, S>(q.area, q.stride, lane, &pair.area);
    pair.dt = real<S>(q.dt), pair.after_forces = q.stage == MPM_AFTER_FORCES;
    constexpr bool compliant = (F::traits & MPM_COMPLIANT) != 0;
    if constexpr (compliant) load_components<D, S>(q.displacement, q.stride, lane, pair.displacement.v);
    if constexpr ((F::traits & MPM_READS_TRACTION) != 0)
      load_components<D, S>(q.traction, q.stride, lane, pair.traction.v);
    pair.cell_size = real<S>(q.cell_size), pair.first_step = q.first_step != 0;
    if constexpr (HasState<F>) {
      constexpr int states = static_cast<int>(sizeof(F::state) / sizeof(mpm_state));
      static_assert(states <= static_cast<int>(MPM_CONTACT_STATES), "a contact law has room for two values");
      load_components<states, S>(q.state_a, q.stride, lane, pair.state_a.v);
      load_components<states, S>(q.state_b, q.stride, lane, pair.state_b.v);
      load_components<states, S>(q.gained_a, q.stride, lane, pair.gained_a.v);
      load_components<states, S>(q.gained_b, q.stride, lane, pair.gained_b.v);
    }
    F::apply(p, pair, result);
    if constexpr (HasState<F>)
      store_components<sizeof(F::state) / sizeof(mpm_state), S>(q.reached, q.stride, lane, result.reached.v);
    if constexpr (compliant) store_components<1, S>(q.stored, q.stride, lane, &result.stored);
    store_components<D, S>(q.impulse, q.stride, lane, result.impulse.v);
    store_components<1, S>(q.dissipated, q.stride, lane, &result.dissipated);
    Access<S>::store_index(q.status + lane, result.status);
  }
}

template <class F, int D, class S>
void normal_batch(const void* parameters, const mpm_normal_batch* request) {
  const mpm_normal_batch q = *request;  // a copy of its own: nothing that is stored changes it
  const auto& p = parameters_of<F>(parameters);
  for (std::uint32_t lane = 0; lane < q.count; lane += Access<S>::width) {
    NormalPair<D, S> pair{};
    NormalResult<D, S> result{};
    if constexpr ((F::traits & MPM_READS_MASS_GRADIENT) != 0) {
      load_components<D, S>(q.mass_gradient_a, q.stride, lane, pair.mass_gradient_a.v);
      load_components<D, S>(q.mass_gradient_b, q.stride, lane, pair.mass_gradient_b.v);
    }
    if constexpr ((F::traits & MPM_READS_VOLUME_GRADIENT) != 0) {
      load_components<D, S>(q.volume_gradient_a, q.stride, lane, pair.volume_gradient_a.v);
      load_components<D, S>(q.volume_gradient_b, q.stride, lane, pair.volume_gradient_b.v);
    }
    F::find(p, pair, result);
    store_components<D, S>(q.normal, q.stride, lane, result.normal.v);
    if constexpr ((F::traits & MPM_OWN_NORMALS) != 0) {
      store_components<D, S>(q.own_a, q.stride, lane, result.own_a.v);
      store_components<D, S>(q.own_b, q.stride, lane, result.own_b.v);
    }
    Access<S>::store_index(q.found + lane, result.found);
  }
}

template <class F, int D>
std::int32_t normal_of_points(const void* parameters, const mpm_normal_points* points) {
  for (int c = 0; c < 3; ++c) points->normal[c] = 0;
  return F::template find<D>(parameters_of<F>(parameters), clouds_of(*points), points->normal);
}

template <class F, class S>
void detection_batch(const void* parameters, const mpm_detection_batch* request) {
  const mpm_detection_batch q = *request;  // a copy of its own: nothing that is stored changes it
  const auto& p = parameters_of<F>(parameters);
  for (std::uint32_t lane = 0; lane < q.count; lane += Access<S>::width) {
    DetectionPair<S> pair{};
    if constexpr ((F::traits & MPM_READS_MEAN_POSITION) != 0) {
      load_components<1, S>(q.mean_a, q.stride, lane, &pair.mean_a);
      load_components<1, S>(q.mean_b, q.stride, lane, &pair.mean_b);
    }
    if constexpr ((F::traits & MPM_READS_EDGES) != 0) {
      load_components<1, S>(q.edge_a, q.stride, lane, &pair.edge_a);
      load_components<1, S>(q.edge_b, q.stride, lane, &pair.edge_b);
    }
    if constexpr ((F::traits & MPM_READS_PARTICLE_SURFACES) != 0) {
      load_components<1, S>(q.surface_a, q.stride, lane, &pair.surface_a);
      load_components<1, S>(q.surface_b, q.stride, lane, &pair.surface_b);
    }
    const S gap = F::gap(p, pair);
    store_components<1, S>(q.gap, q.stride, lane, &gap);
  }
}

/// Index of the first particle whose J is not a positive number, or -1.
template <class S>
std::int32_t first_inadmissible(S J, std::uint32_t lane) {
  if constexpr (Access<S>::width == 1) {
    return J > 0 ? -1 : static_cast<std::int32_t>(lane);
  } else {
    if (!any_lane<scalar_of<S>>(~(J > real<S>(0)))) return -1;
    for (int i = 0; i < Access<S>::width; ++i)
      if (!(J[i] > 0)) return static_cast<std::int32_t>(lane) + i;
    return -1;
  }
}

/// What the outputs of a material share, computed once: F::prepared(state) where the functor has it (then it also takes
/// that in place of a state), else the state itself.
template <class F, class State>
decltype(auto) prepared_of(const State& state) {
  if constexpr (requires { F::prepared(state); })
    return F::prepared(state);
  else
    return (state);
}

/// L of one pack, with its zz in axisymmetric scenes.
template <int D, class S, bool Axisymmetric>
inline __attribute__((always_inline)) auto velocity_gradient_of(const void* gradient, const void* gradient_zz,
                                                                std::uint32_t stride, std::uint32_t lane) {
  Mat<D, S> L;
  load_components<D * D, S>(gradient, stride, lane, L.m);
  if constexpr (Axisymmetric) {
    S zz;
    load_components<1, S>(gradient_zz, stride, lane, &zz);
    return Deformation<2, S>{L, zz};
  } else {
    return L;
  }
}

template <class F, int D, class S, bool Axisymmetric>
std::int32_t material_batch_in(const void* parameters, const mpm_material_batch& q) {
  using T = scalar_of<S>;
  using StateAccess = StateAccess<F, D, S, Axisymmetric>;
  const typename F::template Constants<T> constants(parameters_of<F>(parameters));
  std::int32_t inadmissible = -1;
  const bool outputs = q.kirchhoff_stress || q.stored_energy || q.wave_speed;
  for (std::uint32_t lane = 0; lane < q.count; lane += Access<S>::width) {
    auto state = StateAccess::load(q.state, q.temperature, q.stride, lane);
    const auto store = [&](void* array, S value) {
      if (array) store_components<1, S>(array, q.stride, lane, &value);
    };
    if (q.velocity_gradient) {
      const auto L =
          velocity_gradient_of<D, S, Axisymmetric>(q.velocity_gradient, q.velocity_gradient_zz, q.stride, lane);
      store(q.dissipated_energy, F::advance(constants, L, real<S>(q.dt), state));
      StateAccess::store(q.state, q.stride, lane, state);
      if (outputs) {  // they are those of the rounded state, to the same bits as a call of their own gives
        __asm__ volatile("" ::: "memory");
        state = StateAccess::load(q.state, q.temperature, q.stride, lane);
      }
    } else {
      store(q.dissipated_energy, S(real<S>(0)));  // no advance, no heat
    }
    const S J = F::volume_ratio(state);
    if (inadmissible < 0) inadmissible = first_inadmissible(J, lane);
    const auto& prepared = prepared_of<F>(state);
    if (q.kirchhoff_stress)
      store_components<Sym<D, S>::size, S>(q.kirchhoff_stress, q.stride, lane,
                                           F::kirchhoff_stress(constants, prepared).s);
    if (q.stored_energy) store(q.stored_energy, F::stored_energy(constants, prepared));
    if (q.wave_speed) store(q.wave_speed, F::wave_speed(constants, prepared));
    store(q.volume_ratio, J);
  }
  return inadmissible;
}

template <class F, int D, class S>
std::int32_t material_batch(const void* parameters, const mpm_material_batch* request) {
  const mpm_material_batch q = *request;  // a copy of its own: nothing that is stored changes it
  if constexpr (D == 2 && AxisymmetricMaterialFunctor<F>)
    if (q.velocity_gradient_zz) return material_batch_in<F, D, S, true>(parameters, q);
  return material_batch_in<F, D, S, false>(parameters, q);
}

// ---- entry tables and descriptors --------------------------------------------------------------------------------

using LanesFloat = Lanes<float>;
using LanesDouble = Lanes<double>;

#define MPM_ENTRIES(batch)                                                                                          \
  {                                                                                                                 \
    {&batch<F, 2, LanesFloat>, &batch<F, 3, LanesFloat>}, {&batch<F, 2, LanesDouble>, &batch<F, 3, LanesDouble>}, { \
      &batch<F, 2, double>, &batch<F, 3, double>                                                                    \
    }                                                                                                               \
  }
template <class F>
constexpr double second_moment_of() {
  if constexpr (F::second_moment_kind == MPM_MOMENT_CONSTANT)
    return F::second_moment;
  else
    return 0;
}
template <class F>
struct ShapeTable;
template <ShapeFunctor F>
struct ShapeTable<F> {
  static constexpr mpm_shape value{MPM_TENSOR_PRODUCT,
                                   F::width,
                                   F::second_moment_kind,
                                   0,
                                   second_moment_of<F>(),
                                   {&shape_batch<F, LanesFloat>, &shape_batch<F, LanesDouble>, &shape_batch<F, double>},
                                   {0, 0},
                                   0,
                                   {},
                                   {0, 0}};
};
template <class F, int D>
constexpr std::uint32_t sample_points_of() {
  if constexpr (SampledShapeFunctor<F>)
    return F::template sample_points<D>;
  else
    return 0;
}
template <ListShapeFunctor F>
inline constexpr mpm_shape list_table{MPM_NODE_LIST,
                                      0,
                                      MPM_MOMENT_PER_PARTICLE,
                                      0,
                                      0,
                                      {},
                                      {F::template capacity<2>, F::template capacity<3>},
                                      F::reach,
                                      {{&list_batch<F, 2, float>, &list_batch<F, 3, float>},
                                       {&list_batch<F, 2, double>, &list_batch<F, 3, double>},
                                       {&list_batch<F, 2, double>, &list_batch<F, 3, double>}},
                                      {sample_points_of<F, 2>(), sample_points_of<F, 3>()}};
template <ListShapeFunctor F>
struct ShapeTable<F> {
  static constexpr mpm_shape value = list_table<F>;
};
template <FilterFunctor F>
inline constexpr mpm_filter filter_table{F::traits, 0, &filter_iterations<F>, MPM_ENTRIES(filter_batch)};
template <TransferFunctor F>
inline constexpr mpm_transfer transfer_table{F::traits, 0, MPM_ENTRIES(scatter_batch), MPM_ENTRIES(gather_batch)};
template <ContactFunctor F>
inline constexpr mpm_contact contact_table{F::traits, 0, MPM_ENTRIES(contact_batch)};
template <class F>
struct NormalTable;
template <SumsNormalFunctor F>
struct NormalTable<F> {
  static constexpr mpm_normal value{F::traits, 0, MPM_ENTRIES(normal_batch), {}};
};
template <PointsNormalFunctor F>
struct NormalTable<F> {
  static_assert((F::traits & MPM_LOOKS_AT_POINTS) != 0, "a normal that is found from points says so");
  static constexpr mpm_normal value{F::traits, 0, {}, {&normal_of_points<F, 2>, &normal_of_points<F, 3>}};
};
template <DetectionFunctor F>
inline constexpr mpm_detection detection_table{
    F::traits, 0, {&detection_batch<F, LanesFloat>, &detection_batch<F, LanesDouble>, &detection_batch<F, double>}};
template <MaterialFunctor F>
inline constexpr mpm_material material_table{
    F::traits | (AxisymmetricMaterialFunctor<F> ? unsigned{MPM_STRAINS_AROUND_AXIS} : 0u), 0,
    MPM_ENTRIES(material_batch)};

}  // namespace mpm::sdk
