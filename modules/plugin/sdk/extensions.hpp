#pragma once
// The extensions of extensions.h as the SDK makes them from a functor. Some every functor gets for nothing (costs, a
// material's trial and tangent); others come with a member of the functor: `box` and its fellows, `basis_order`,
// `courant_limits`, `step_limit`, `projects`, `makes_energy`, `dissipates_by`, `clamps`, `refusal`, a `temperature` at the end of State, a
// `cell_size` at the end of Parameters.

#include <cmath>
#include <cstring>

#include "kernel/counted.hpp"
#include "kernel/dual.hpp"
#include "plugin/sdk/batches.hpp"

namespace mpm::sdk {

// ---- concepts: what a functor may offer --------------------------------------------------------------------------

/// Compares two texts. (The library's headers that would do it take longer to read than the rest of the SDK.)
constexpr bool same_text(const char* a, const char* b) {
  for (; *a == *b; ++a, ++b)
    if (*a == 0) return true;
  return false;
}

template <class F>
constexpr bool declares_parameter(const char* name) {
  if constexpr (requires { F::parameters[0].name; })
    for (const mpm_parameter& row : F::parameters)
      if (same_text(row.name, name)) return true;
  return false;
}
/// Parameters that end in a `cell_size` beyond the declared ones, m: the host writes that of the grid.
template <class F>
concept CellSizeFunctor = requires(const typename F::Parameters& p) {
  p.cell_size;
}
&&!declares_parameter<F>("cell_size");

template <class F>
concept PolynomialFunctor = requires(const typename F::Parameters& p) {
  { F::basis_order(p) } -> std::convertible_to<int>;
};

/// The largest Courant numbers that a scene stands on the shape, by dimension and by what strains (see
/// mpm_shape_courant_limit): `static constexpr double courant_limits[2][3]`.
template <class F>
concept CourantLimitFunctor = requires {
  F::courant_limits[1][MPM_STRAIN_VELOCITIES - 1];
};

/// The longest stable step with the filter, s, from the longest without.
template <class F>
concept StepLimitFunctor = requires(const typename F::Parameters& p) {
  { F::step_limit(p, 1.0) } -> std::convertible_to<double>;
};

/// The longest step of a contact law, s, from the density of the lighter body and the cell size.
template <class F>
concept ContactStepLimitFunctor = requires(const typename F::Parameters& p) {
  { F::step_limit(p, 1.0, 1.0) } -> std::convertible_to<double>;
};

/// A functor whose `advance` without strain takes any state to the nearest admissible one says so: `static constexpr
/// bool projects = true`.
template <class F>
constexpr bool projects_by_update() {
  if constexpr (requires { F::projects; })
    return F::projects;
  else
    return false;
}

/// A functor that no dual number can go through says why: `static constexpr const char* no_tangent = "..."`.
template <class F>
concept RefusesTangent = requires {
  { F::no_tangent } -> std::convertible_to<const char*>;
};

/// A material whose law can dissipate less than nothing says where: `static constexpr const char* makes_energy =
/// "..."`.
template <class F>
concept MakesEnergy = requires {
  { F::makes_energy } -> std::convertible_to<const char*>;
};

/// A material that dissipates says by what: `static constexpr mpm_dissipation_cause dissipates_by = MPM_PLASTIC_WORK`.
template <class F>
concept NamesDissipation = requires {
  { F::dissipates_by } -> std::convertible_to<mpm_dissipation_cause>;
};

/// A material that is clamped somewhere names its clamps: `static constexpr mpm_clamp clamps[]`, with `static void
/// clamp_bounds(const Parameters&, double* bound)` and, of a State or AxisymmetricState of double, `static unsigned
/// acting_clamps(const double* bound, const State&)` with bit k where clamp k acts.
template <class F>
concept Clamped = requires {
  F::clamps[0].what;
};

/// A functor some of whose parameters do not fit one another, or the scene, says which: `static mpm_refusal
/// refusal(const Parameters&, const mpm_refusal_case&)`, with a null `parameter` for those that do.
template <class F>
concept RefusesParameters = requires(const typename F::Parameters& p, const mpm_refusal_case& of) {
  { F::refusal(p, of) } -> std::same_as<mpm_refusal>;
};

/// A functor that only runs over float, double and lanes says so: `static constexpr bool counted = false`.
template <class F>
constexpr bool is_counted() {
  if constexpr (requires { F::counted; })
    return F::counted;
  else
    return true;
}

// ---- costs -------------------------------------------------------------------------------------------------------

/// Number of places in a cell, spread by an additive sequence (Roberts 2018, R_d), over which a list's cost is
/// averaged.
inline constexpr int cost_samples = 64;
inline double cost_sample(int k, int axis) {
  const double u = 0.5 + (k + 1) * (axis == 0   ? 0.8191725133961645
                                    : axis == 1 ? 0.6710436067037893
                                                : 0.5497004779019703);
  return 5 + u - std::floor(u);
}

template <ShapeFunctor F, int D, class T>
mpm_cost cost_of(const typename F::Parameters& p, const mpm_cost_case& of) {
  using S = Counted<T>;
  S base, w[F::width], g[F::width];
  const long axis = count_operations([&] {
    if constexpr (SizedShapeFunctor<F> || DeformedShapeFunctor<F>)
      F::evaluate(p, S(5.2), S(of.half_size), base, w, of.gradients ? g : static_cast<S*>(nullptr));
    else
      F::evaluate(p, S(5.2), base, w, of.gradients ? g : static_cast<S*>(nullptr));
  });
  long lengths = 0;  // operations for the lengths of the box that follows the domain, which are found once for all axes
  if constexpr (DeformedShapeFunctor<F>) {
    Mat<D, S> domain{};
    for (int a = 0; a < D; ++a) domain(a, a) = S(of.half_size);
    lengths = count_operations([&] { F::template half_lengths<D, S>(p, domain); });
  }
  return {static_cast<double>(D * axis + lengths), 0};
}

template <ListShapeFunctor F, int D, class T>
mpm_cost cost_of(const typename F::Parameters& p, const mpm_cost_case& of) {
  using S = Counted<T>;
  mpm_cost cost{0, 0};
  for (int k = 0; k < cost_samples; ++k) {
    Vec<D, S> x;
    for (int a = 0; a < D; ++a) x[a] = S(cost_sample(k, a));
    NodeList<D, S, F::template capacity<D>> list;
    long evaluation;
    if constexpr (SampledShapeFunctor<F>) {
      Vec<D, S> corners[1 << D];
      for (int c = 0; c < 1 << D; ++c)
        for (int a = 0; a < D; ++a) corners[c][a] = S(c >> a & 1 ? of.half_size : -of.half_size);
      evaluation = count_operations([&] { F::evaluate(p, x, corners, list); });
    } else {
      Mat<D, S> domain{};
      for (int a = 0; a < D; ++a) domain(a, a) = S(of.half_size);
      evaluation = count_operations([&] { F::evaluate(p, x, domain, list); });
    }
    cost.operations += static_cast<double>(evaluation) / cost_samples;
    cost.nodes += static_cast<double>(list.count) / cost_samples;
  }
  return cost;
}

template <TransferFunctor F, int D, class T>
mpm_cost cost_of(const typename F::Parameters& p, const mpm_cost_case&) {
  using S = Counted<T>;
  Vec<D, S> v{}, out{};
  Mat<D, S> A{};
  typename F::template State<D, S> state{};
  GatheredMoments<D, S> moments{};
  const long operations = count_operations([&] {
    F::gather(p, moments, S(1e-4), v, state, out);
    F::scatter(p, S(1), v, state, out, A);
  });
  return {static_cast<double>(operations), 0};
}

template <FilterFunctor F, int D, class T>
mpm_cost cost_of(const typename F::Parameters& p, const mpm_cost_case&) {
  using S = Counted<T>;
  Vec<D, S> projected{}, increment{}, velocity{};
  const long operations = count_operations([&] { F::update(p, 1, projected, increment, velocity); });
  return {static_cast<double>(operations), 0};
}

/// What a new particle holds in one component of a declared field.
constexpr double initial_component(const mpm_state& field, int component, int D) {
  if (field.initial != MPM_INITIAL_IDENTITY) return field.initial == MPM_INITIAL_ONE ? 1 : 0;
  if (field.shape == MPM_STATE_SYMMETRIC) return component < 3 ? 1 : 0;
  if (field.shape == MPM_STATE_DEFORMATION && component == 4) return 1;  // zz in 2-D, yy in 3-D
  return component < D * D && component % (D + 1) == 0 ? 1 : 0;
}
template <class F, int D, class S>
typename F::template State<D, S> initial_state() {
  using Access = StateAccess<F, D, S>;
  typename F::template State<D, S> state{};
  if constexpr (Access::count > 0) {
    S* flat = reinterpret_cast<S*>(&state);
    for (int k = 0; k < Access::count; ++k)
      flat[k] = S(real<S>(initial_component(F::state[Access::layout.field[k]], Access::layout.component[k], D)));
  }
  if constexpr (TemperatureFunctor<F>) state.temperature = S(real<S>(F::reference_temperature));
  return state;
}

/// The cost of a strain with the check of J, and of the stress; the compiler is left to share a second J of the same
/// state.
template <MaterialFunctor F, int D, class T>
mpm_cost cost_of(const typename F::Parameters& p, const mpm_cost_case& of) {
  using S = Counted<T>;
  const typename F::template Constants<S> constants(p);
  auto state = initial_state<F, D, S>();
  Mat<D, S> L{};
  L(0, 1) = of.flows ? S(1) : S(0);  // a shear of 1: far beyond any yield stress that scenes use
  const long operations = count_operations([&] {
    F::advance(constants, L, S(1), state);
    F::volume_ratio(state);
    F::kirchhoff_stress(constants, state);
  });
  return {static_cast<double>(operations), 0};
}

template <class F>
void count_cost(const void* parameters, const mpm_cost_case* of, mpm_cost* cost) {
  const auto& p = parameters_of<F>(parameters);
  if (of->dimension == 2)
    *cost = of->single_precision ? cost_of<F, 2, float>(p, *of) : cost_of<F, 2, double>(p, *of);
  else
    *cost = of->single_precision ? cost_of<F, 3, float>(p, *of) : cost_of<F, 3, double>(p, *of);
}
template <class F>
inline constexpr mpm_costs costs_table{MPM_COSTS_VERSION, 0, &count_cost<F>};

// ---- refusal ----------------------------------------------------------------------------------------------------

template <RefusesParameters F>
inline constexpr mpm_refusals refusals_table{
    MPM_REFUSAL_VERSION, 0, [](const void* parameters, const mpm_refusal_case* of, mpm_refusal* refusal) {
      *refusal = F::refusal(parameters_of<F>(parameters), *of);
    }};
template <class F>
const void* refusal_extension(const char* id) {
  if constexpr (RefusesParameters<F>)
    if (same_text(id, MPM_REFUSAL_ID)) return &refusals_table<F>;
  return nullptr;
}

// ---- trial -------------------------------------------------------------------------------------------------------

/// Views of `rows` rows of `count` entries, each from entry `first` on.
template <class T>
void copy_rows(const void* from, std::uint32_t from_stride, std::uint32_t first, void* to, std::uint32_t to_stride,
               std::uint32_t to_first, int rows, std::uint32_t count) {
  for (int k = 0; k < rows; ++k)
    std::memcpy(static_cast<T*>(to) + static_cast<std::uint32_t>(k) * to_stride + to_first,
                static_cast<const T*>(from) + static_cast<std::uint32_t>(k) * from_stride + first, count * sizeof(T));
}

/// Updates a copy, a batch at a time: the entry of the core does the work, so that the bits are its own. Where there is
/// no velocity gradient, a zero one is taken if the return of the law is wanted (`returns`).
template <class F, int D, class S>
std::int32_t update_copy(const void* parameters, const mpm_trial_batch& q, bool axisymmetric, bool returns) {
  using T = scalar_of<S>;
  constexpr int symmetric = Sym<D, S>::size;
  constexpr std::uint32_t full = MPM_BATCH;
  constexpr int components = scalars_in<typename StateOf<F, D, S, D == 2 && AxisymmetricMaterialFunctor<F>>::type, S>;
  alignas(64) T gradient[D * D * full]{}, gradient_zz[full]{};
  alignas(64) T temperature[full], stress[symmetric * full], energy[full], state[(components + 1) * full];
  void* fields[components + 1];
  std::int32_t inadmissible = -1;
  for (std::uint32_t first = 0; first < q.count; first += full) {
    const std::uint32_t count = q.count - first < full ? q.count - first : full;
    const auto take = [&](const void* from, T* to, int rows) {
      if (from) copy_rows<T>(from, q.stride, first, to, full, 0, rows, count);
      return from ? to : nullptr;
    };
    const auto give = [&](const void* from, void* to, int rows) {
      if (to) copy_rows<T>(from, full, 0, to, q.stride, first, rows, count);
    };
    const auto for_each_field = [&](auto&& act) {
      if constexpr (HasState<F>) {
        int place = 0, f = 0;
        for (const mpm_state& field : F::state) {
          const int rows = components_of(field.shape, D, axisymmetric);
          act(f++, state + static_cast<std::uint32_t>(place) * full, rows);
          place += rows;
        }
      }
    };
    for_each_field([&](int f, T* copy, int rows) { fields[f] = take(q.state[f], copy, rows); });
    mpm_material_batch update{};
    update.count = count, update.stride = full, update.dimension = D, update.dt = q.dt;
    update.velocity_gradient = returns ? gradient : take(q.velocity_gradient, gradient, D * D);
    update.velocity_gradient_zz = axisymmetric ? gradient_zz : nullptr;
    if (q.velocity_gradient) take(q.velocity_gradient_zz, gradient_zz, 1);
    update.temperature = take(q.temperature, temperature, 1);
    update.state = fields;
    update.kirchhoff_stress = q.kirchhoff_stress ? stress : nullptr;
    update.stored_energy = q.stored_energy ? energy : nullptr;
    const std::int32_t index = material_batch<F, D, S>(parameters, &update);
    if (inadmissible < 0 && index >= 0) inadmissible = static_cast<std::int32_t>(first) + index;
    if (q.trial_state) for_each_field([&](int f, T* copy, int rows) { give(copy, q.trial_state[f], rows); });
    give(stress, q.kirchhoff_stress, symmetric);
    give(energy, q.stored_energy, 1);
  }
  return inadmissible;
}

template <class F, int D, class S>
std::int32_t trial_batch(const void* parameters, const mpm_trial_batch* request) {
  const mpm_trial_batch q = *request;  // its own copy: nothing that is stored changes it
  return update_copy<F, D, S>(parameters, q, q.velocity_gradient_zz != nullptr, false);
}

template <class F>
inline constexpr mpm_material_trial trial_table{MPM_MATERIAL_TRIAL_VERSION, 0, MPM_ENTRIES(trial_batch)};

// ---- tangent -----------------------------------------------------------------------------------------------------

/// One plain row of a matrix of velocity gradients, with zz where the functor's scene is axisymmetric.
template <int D, class S, bool Axisymmetric>
auto dual_gradient(const mpm_tangent_batch& q, std::uint32_t lane) {
  using X = Dual<S>;
  const auto load = [&](const void* array, int row) {
    return array ? Access<S>::load(static_cast<const scalar_of<S>*>(array) +
                                   static_cast<std::uint32_t>(row) * q.stride + lane)
                 : S(real<S>(0));
  };
  Mat<D, X> L;
  for (int k = 0; k < D * D; ++k) L.m[k] = X(load(q.velocity_gradient, k), load(q.direction, k));
  if constexpr (Axisymmetric) {
    const void* zz = q.velocity_gradient ? q.velocity_gradient_zz : nullptr;
    return Deformation<2, X>{L, X(load(zz, 0), load(q.direction_zz, 0))};
  } else {
    return L;
  }
}

template <class F, int D, class S, bool Axisymmetric>
std::int32_t tangent_batch_in(const void* parameters, const mpm_tangent_batch& q) {
  using X = Dual<S>;
  using State = typename StateOf<F, D, X, Axisymmetric>::type;
  using PlainAccess = StateAccess<F, D, S, Axisymmetric>;
  constexpr int scalars = scalars_in<State, X>;
  const typename F::template Constants<scalar_of<S>> constants(parameters_of<F>(parameters));
  std::int32_t inadmissible = -1;
  for (std::uint32_t lane = 0; lane < q.count; lane += Access<S>::width) {
    const auto plain = PlainAccess::load(q.state, q.temperature, q.stride, lane);
    State state{};
    for (int k = 0; k < scalars; ++k) reinterpret_cast<X*>(&state)[k] = X(reinterpret_cast<const S*>(&plain)[k]);
    F::advance(constants, dual_gradient<D, S, Axisymmetric>(q, lane), real<S>(q.dt), state);
    const S J = F::volume_ratio(state).value;
    if (inadmissible < 0) inadmissible = first_inadmissible(J, lane);
    const auto& prepared = prepared_of<F>(state);
    const Sym<D, X> tau = F::kirchhoff_stress(constants, prepared);
    Sym<D, S> change;
    for (int k = 0; k < Sym<D, S>::size; ++k) change.s[k] = tau.s[k].derivative;
    store_components<Sym<D, S>::size, S>(q.stress_change, q.stride, lane, change.s);
  }
  return inadmissible;
}
template <class F, int D, class S>
std::int32_t tangent_batch(const void* parameters, const mpm_tangent_batch* request) {
  const mpm_tangent_batch q = *request;  // its own copy: nothing that is stored changes it
  if constexpr (D == 2 && AxisymmetricMaterialFunctor<F>)
    if (q.direction_zz) return tangent_batch_in<F, D, S, true>(parameters, q);
  return tangent_batch_in<F, D, S, false>(parameters, q);
}

template <class F>
struct TangentTable {
  static constexpr mpm_material_tangent value{MPM_MATERIAL_TANGENT_VERSION, 0, nullptr, MPM_ENTRIES(tangent_batch)};
};
template <RefusesTangent F>
struct TangentTable<F> {
  static constexpr mpm_material_tangent value{MPM_MATERIAL_TANGENT_VERSION, 0, F::no_tangent, {}};
};

// ---- projection --------------------------------------------------------------------------------------------------

template <class F, int D, class S>
std::int32_t projection_batch(const void* parameters, const mpm_projection_batch* request) {
  mpm_trial_batch q{};
  q.count = request->count, q.stride = request->stride, q.dimension = D;
  q.temperature = request->temperature;
  q.state = request->state, q.trial_state = request->state;
  return update_copy<F, D, S>(parameters, q, request->axisymmetric != 0, true);
}

template <class F>
inline constexpr mpm_material_projection projection_table{MPM_MATERIAL_PROJECTION_VERSION, 0,
                                                          MPM_ENTRIES(projection_batch)};

// ---- the others --------------------------------------------------------------------------------------------------

template <BoxShapeFunctor F>
inline constexpr mpm_shape_boxes boxes_table{MPM_SHAPE_BOXES_VERSION, 0, MPM_ENTRIES(box_batch)};
#undef MPM_ENTRIES

template <PolynomialFunctor F>
inline constexpr mpm_transfer_polynomials polynomials_table{
    MPM_TRANSFER_POLYNOMIALS_VERSION, 0,
    [](const void* parameters) { return static_cast<std::int32_t>(F::basis_order(parameters_of<F>(parameters))); }};

template <CourantLimitFunctor F>
struct CourantLimitTable {
  static constexpr mpm_shape_courant_limit make() {
    mpm_shape_courant_limit table{MPM_SHAPE_COURANT_LIMIT_VERSION, 0, {}};
    for (int dimension = 0; dimension < 2; ++dimension)
      for (int velocity = 0; velocity < MPM_STRAIN_VELOCITIES; ++velocity)
        table.limit[dimension][velocity] = F::courant_limits[dimension][velocity];
    return table;
  }
  static constexpr mpm_shape_courant_limit value = make();
};

template <StepLimitFunctor F>
inline constexpr mpm_filter_step_limit step_limit_table{
    MPM_FILTER_STEP_LIMIT_VERSION, 0, [](const void* parameters, double unfiltered) {
      return static_cast<double>(F::step_limit(parameters_of<F>(parameters), unfiltered));
    }};

template <ContactStepLimitFunctor F>
inline constexpr mpm_contact_step_limit contact_step_limit_table{
    MPM_CONTACT_STEP_LIMIT_VERSION, 0, [](const void* parameters, double density, double cell_size) {
      return static_cast<double>(F::step_limit(parameters_of<F>(parameters), density, cell_size));
    }};

template <MakesEnergy F>
inline constexpr mpm_material_makes_energy makes_energy_table{MPM_MATERIAL_MAKES_ENERGY_VERSION, 0, F::makes_energy};

template <NamesDissipation F>
inline constexpr mpm_material_dissipation dissipation_table{MPM_MATERIAL_DISSIPATION_VERSION, F::dissipates_by};

template <Clamped F>
inline constexpr std::uint32_t clamp_count = sizeof(F::clamps) / sizeof(mpm_clamp);
template <class F, int D, bool Axisymmetric>
void find_clamps_in(const double* bound, const mpm_clamp_batch& q) {
  for (std::uint32_t lane = 0; lane < q.count; ++lane)
    q.acting[lane] =
        F::acting_clamps(bound, StateAccess<F, D, double, Axisymmetric>::load(q.state, q.temperature, q.stride, lane));
}
template <class F, int D>
void find_clamps(const void* parameters, const mpm_clamp_batch* request) {
  double bound[clamp_count<F>];
  F::clamp_bounds(parameters_of<F>(parameters), bound);
  if constexpr (D == 2 && AxisymmetricMaterialFunctor<F>)
    if (request->axisymmetric) return find_clamps_in<F, D, true>(bound, *request);
  find_clamps_in<F, D, false>(bound, *request);
}
template <Clamped F>
inline constexpr mpm_material_clamps clamps_table{
    MPM_MATERIAL_CLAMPS_VERSION,
    clamp_count<F>,
    F::clamps,
    [](const void* parameters, double* bound) { F::clamp_bounds(parameters_of<F>(parameters), bound); },
    {&find_clamps<F, 2>, &find_clamps<F, 3>}};

template <TemperatureFunctor F>
inline constexpr mpm_material_temperature temperature_table{MPM_MATERIAL_TEMPERATURE_VERSION, 0,
                                                            F::reference_temperature};

template <CellSizeFunctor F>
inline constexpr mpm_material_cell_size cell_size_table{MPM_MATERIAL_CELL_SIZE_VERSION,
                                                        offsetof(typename F::Parameters, cell_size)};

// ---- by id -------------------------------------------------------------------------------------------------------

template <class F>
const void* costs_extension(const char* id) {
  if constexpr (is_counted<F>())
    if (same_text(id, MPM_COSTS_ID)) return &costs_table<F>;
  return nullptr;
}
template <class F>
const void* costs_or_refusal(const char* id) {
  const void* refusal = refusal_extension<F>(id);
  return refusal ? refusal : costs_extension<F>(id);
}
template <class F>
const void* shape_extension(const char* id) {
  if constexpr (BoxShapeFunctor<F>)
    if (same_text(id, MPM_SHAPE_BOXES_ID)) return &boxes_table<F>;
  if constexpr (CourantLimitFunctor<F>)
    if (same_text(id, MPM_SHAPE_COURANT_LIMIT_ID)) return &CourantLimitTable<F>::value;
  return costs_or_refusal<F>(id);
}
template <class F>
const void* transfer_extension(const char* id) {
  if constexpr (PolynomialFunctor<F>)
    if (same_text(id, MPM_TRANSFER_POLYNOMIALS_ID)) return &polynomials_table<F>;
  return costs_or_refusal<F>(id);
}
template <class F>
const void* filter_extension(const char* id) {
  if constexpr (StepLimitFunctor<F>)
    if (same_text(id, MPM_FILTER_STEP_LIMIT_ID)) return &step_limit_table<F>;
  return costs_or_refusal<F>(id);
}
template <class F>
const void* contact_extension(const char* id) {
  if constexpr (ContactStepLimitFunctor<F>)
    if (same_text(id, MPM_CONTACT_STEP_LIMIT_ID)) return &contact_step_limit_table<F>;
  return refusal_extension<F>(id);
}
/// The extensions of a material that run its functor over scalars of their own.
#if defined(MPM_PLUGIN_PART) && MPM_PLUGIN_PART == 1
template <class F>
const void* extension_over_other_scalars(const char* id);  // stands in the other object of the plugin
#else
template <class F>
const void* extension_over_other_scalars(const char* id) {
  if (same_text(id, MPM_MATERIAL_TANGENT_ID)) return &TangentTable<F>::value;
  return costs_extension<F>(id);
}
#endif
template <class F>
const void* material_extension(const char* id) {
  if (same_text(id, MPM_MATERIAL_TRIAL_ID)) return &trial_table<F>;
  if constexpr (projects_by_update<F>())
    if (same_text(id, MPM_MATERIAL_PROJECTION_ID)) return &projection_table<F>;
  if constexpr (MakesEnergy<F>)
    if (same_text(id, MPM_MATERIAL_MAKES_ENERGY_ID)) return &makes_energy_table<F>;
  if constexpr (NamesDissipation<F>)
    if (same_text(id, MPM_MATERIAL_DISSIPATION_ID)) return &dissipation_table<F>;
  if constexpr (Clamped<F>)
    if (same_text(id, MPM_MATERIAL_CLAMPS_ID)) return &clamps_table<F>;
  if constexpr (TemperatureFunctor<F>)
    if (same_text(id, MPM_MATERIAL_TEMPERATURE_ID)) return &temperature_table<F>;
  if constexpr (CellSizeFunctor<F>)
    if (same_text(id, MPM_MATERIAL_CELL_SIZE_ID)) return &cell_size_table<F>;
  if (const void* refusal = refusal_extension<F>(id)) return refusal;
  return extension_over_other_scalars<F>(id);
}

}  // namespace mpm::sdk
