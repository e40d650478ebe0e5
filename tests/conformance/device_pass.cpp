// The device pass, run on the host: every plugin's embedded functor text is composed with a small kernel and compiled
// with no system headers at all, as a GPU's run-time compiler would; the result must be what the plugin's own scalar
// entry gives. Where NVRTC is installed the same text is compiled with it too.

#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "conformance/support.hpp"
#include "plugin/registry.hpp"
#include "support/catch.hpp"
#include "support/temporary_folder.hpp"

#ifndef MPM_CXX_COMPILER
#define MPM_CXX_COMPILER "c++"
#endif
#ifndef MPM_SOURCE_DIR
#define MPM_SOURCE_DIR "."
#endif

namespace {

using mpm::Plugin;
using mpm::conformance::ParameterSample;
using mpm::conformance::Random;

constexpr int particles = 64;
constexpr double step = 0x1p-6;

// ---- the text around a functor -------------------------------------------------------------------------------------

/// The text before a functor. Arrays are [component][64] of S; `state` and all that a functor fills are in `out`.
constexpr const char* prologue = R"(#include "functor.hpp"
struct Task { const void* parameters; const void* in[13]; void* out[8]; int count; double dt; };
namespace mpm {
template <int N, class S> MPM_HD void load(const void* array, int lane, S* to) {
  for (int k = 0; k < N; ++k) to[k] = static_cast<const S*>(array)[k * 64 + lane];
}
template <int N, class S> MPM_HD void store(void* array, int lane, const S* from) {
  for (int k = 0; k < N; ++k) static_cast<S*>(array)[k * 64 + lane] = from[k];
}
template <class State, class S> constexpr int scalars = static_cast<int>(sizeof(State) / sizeof(S));
)";

constexpr const char* shape_body = R"(
template <int D, class S> MPM_HD void run(const Task& t, int lane) {
  const auto& p = *static_cast<const Functor::Parameters*>(t.parameters);
  for (int axis = 0; axis < D; ++axis) {
    S x, base, w[Functor::width], g[Functor::width];
    load<1>(t.in[0], axis * 64 + lane, &x);
    Functor::evaluate(p, x, base, w, g);
    store<1>(t.out[0], axis * 64 + lane, &base);
    store<Functor::width>(t.out[1], axis * Functor::width * 64 + lane, w);
    store<Functor::width>(t.out[2], axis * Functor::width * 64 + lane, g);
  }
}
)";

constexpr const char* sized_shape_body = R"(
template <int D, class S> MPM_HD void run(const Task& t, int lane) {
  const auto& p = *static_cast<const Functor::Parameters*>(t.parameters);
  for (int axis = 0; axis < D; ++axis) {
    S x, half_size, base, w[Functor::width], g[Functor::width];
    load<1>(t.in[0], axis * 64 + lane, &x);
    load<1>(t.in[1], axis * 64 + lane, &half_size);
    Functor::evaluate(p, x, half_size, base, w, g);
    store<1>(t.out[0], axis * 64 + lane, &base);
    store<Functor::width>(t.out[1], axis * Functor::width * 64 + lane, w);
    store<Functor::width>(t.out[2], axis * Functor::width * 64 + lane, g);
  }
}
)";

constexpr const char* deformed_shape_body = R"(
template <int D, class S> MPM_HD void run(const Task& t, int lane) {
  const auto& p = *static_cast<const Functor::Parameters*>(t.parameters);
  Mat<D, S> domain;
  load<D * D>(t.in[1], lane, domain.m);
  const Vec<D, S> half_length = Functor::template half_lengths<D, S>(p, domain);
  for (int axis = 0; axis < D; ++axis) {
    S x, base, w[Functor::width], g[Functor::width];
    load<1>(t.in[0], axis * 64 + lane, &x);
    Functor::evaluate(p, x, half_length[axis], base, w, g);
    store<1>(t.out[0], axis * 64 + lane, &base);
    store<Functor::width>(t.out[1], axis * Functor::width * 64 + lane, w);
    store<Functor::width>(t.out[2], axis * Functor::width * 64 + lane, g);
  }
}
)";

/// The text of what a list shape takes beside the position, and gives to `evaluate`.
constexpr const char* domain_of_list = R"(
template <int D, class S> struct Domain {
  Mat<D, S> sides;
  MPM_HD Domain(const void* array, int lane) { load<D * D>(array, lane, sides.m); }
  MPM_HD const Mat<D, S>& get() const { return sides; }
};
)";
constexpr const char* corners_of_list = R"(
template <int D, class S> struct Domain {
  Vec<D, S> corners[1 << D];
  MPM_HD Domain(const void* array, int lane) { load<(1 << D) * D>(array, lane, corners[0].v); }
  MPM_HD const Vec<D, S>* get() const { return corners; }
};
)";

/// The text that follows one of the two. Entries beyond a particle's count are stored as zero, so that whole arrays
/// compare.
constexpr const char* list_shape_body = R"(
template <int D, class S> MPM_HD void run(const Task& t, int lane) {
  const auto& p = *static_cast<const Functor::Parameters*>(t.parameters);
  Vec<D, S> x;
  load<D>(t.in[0], lane, x.v);
  const Domain<D, S> domain(t.in[1], lane);
  NodeList<D, S, Functor::template capacity<D>> list;
  Functor::evaluate(p, x, domain.get(), list);
  for (int k = 0; k < Functor::template capacity<D>; ++k) {
    const bool used = k < list.count;
    S node[D], w = used ? list.weight[k] : S(0), g[D];
    for (int a = 0; a < D; ++a) node[a] = used ? static_cast<S>(list.node[k][a]) : S(0), g[a] = used ? list.gradient[k][a] : S(0);
    store<D>(t.out[0], k * D * 64 + lane, node);
    store<1>(t.out[1], k * 64 + lane, &w);
    store<D>(t.out[2], k * D * 64 + lane, g);
  }
  const S count = static_cast<S>(list.count);
  store<1>(t.out[3], lane, &count);
}
)";

constexpr const char* filter_body = R"(
template <int D, class S> MPM_HD void run(const Task& t, int lane) {
  const auto& p = *static_cast<const Functor::Parameters*>(t.parameters);
  Vec<D, S> projected, increment, velocity;
  load<D>(t.in[0], lane, projected.v);
  load<D>(t.out[0], lane, increment.v);
  load<D>(t.out[1], lane, velocity.v);
  Functor::update(p, 2, projected, increment, velocity);
  store<D>(t.out[0], lane, increment.v);
  store<D>(t.out[1], lane, velocity.v);
  const S passes = static_cast<S>(Functor::iterations(p));
  store<1>(t.out[2], lane, &passes);
}
)";

constexpr const char* transfer_body = R"(
template <int D, class S> MPM_HD void run(const Task& t, int lane) {
  const auto& p = *static_cast<const Functor::Parameters*>(t.parameters);
  using State = typename Functor::template State<D, S>;
  State state{};
  load<scalars<State, S>>(t.out[0], lane, reinterpret_cast<S*>(&state));
  S mass;
  Vec<D, S> v, b, advection;
  Mat<D, S> A{};
  load<1>(t.in[0], lane, &mass);
  load<D>(t.in[1], lane, v.v);
  Functor::scatter(p, mass, v, state, b, A);
  GatheredMoments<D, S> moments;
  load<D>(t.in[2], lane, moments.velocity.v);
  load<D>(t.in[3], lane, moments.velocity_increment.v);
  load<D * D>(t.in[4], lane, moments.affine.m);
  load<D * D>(t.in[5], lane, moments.velocity_gradient.m);
  moments.second_moment = Mat<D, S>::identity();  // as for a batch without one
  Functor::gather(p, moments, real<S>(t.dt), v, state, advection);
  store<scalars<State, S>>(t.out[0], lane, reinterpret_cast<const S*>(&state));
  store<D>(t.out[1], lane, b.v);
  store<D * D>(t.out[2], lane, A.m);
  store<D>(t.out[3], lane, v.v);
  store<D>(t.out[4], lane, advection.v);
}
)";

constexpr const char* contact_body = R"(
template <int D, class S> MPM_HD void run(const Task& t, int lane) {
  const auto& p = *static_cast<const Functor::Parameters*>(t.parameters);
  ContactPair<D, S> pair;
  ContactResult<D, S> result;
  load<1>(t.in[0], lane, &pair.mass_a);
  load<1>(t.in[1], lane, &pair.mass_b);
  load<D>(t.in[2], lane, pair.momentum_a.v);
  load<D>(t.in[3], lane, pair.momentum_b.v);
  load<D>(t.in[4], lane, pair.normal.v);
  load<1>(t.in[5], lane, &pair.separation);
  load<1>(t.in[6], lane, &pair.area);
  load<D>(t.in[7], lane, pair.displacement.v);
  load<D>(t.in[8], lane, pair.traction.v);
  load<2>(t.in[9], lane, pair.state_a.v);
  load<2>(t.in[10], lane, pair.state_b.v);
  load<2>(t.in[11], lane, pair.gained_a.v);
  load<2>(t.in[12], lane, pair.gained_b.v);
  pair.dt = real<S>(t.dt), pair.cell_size = real<S>(1);
  result.stored = S(0), result.reached = {};
  Functor::apply(p, pair, result);
  store<D>(t.out[0], lane, result.impulse.v);
  store<1>(t.out[1], lane, &result.dissipated);
  store<1>(t.out[2], lane, &result.status);
  store<1>(t.out[3], lane, &result.stored);
  store<2>(t.out[4], lane, result.reached.v);
}
)";

constexpr const char* normal_body = R"(
template <int D, class S> MPM_HD void run(const Task& t, int lane) {
  const auto& p = *static_cast<const Functor::Parameters*>(t.parameters);
  NormalPair<D, S> pair;
  NormalResult<D, S> result{};
  load<D>(t.in[0], lane, pair.mass_gradient_a.v);
  load<D>(t.in[1], lane, pair.mass_gradient_b.v);
  load<D>(t.in[2], lane, pair.volume_gradient_a.v);
  load<D>(t.in[3], lane, pair.volume_gradient_b.v);
  Functor::find(p, pair, result);
  store<D>(t.out[0], lane, result.normal.v);
  store<D>(t.out[1], lane, result.own_a.v);
  store<D>(t.out[2], lane, result.own_b.v);
  store<1>(t.out[3], lane, &result.found);
}
)";

constexpr const char* detection_body = R"(
template <int D, class S> MPM_HD void run(const Task& t, int lane) {
  DetectionPair<S> pair;
  load<1>(t.in[0], lane, &pair.mean_a);
  load<1>(t.in[1], lane, &pair.mean_b);
  load<1>(t.in[2], lane, &pair.edge_a);
  load<1>(t.in[3], lane, &pair.edge_b);
  load<1>(t.in[4], lane, &pair.surface_a);
  load<1>(t.in[5], lane, &pair.surface_b);
  const S gap = Functor::gap(*static_cast<const Functor::Parameters*>(t.parameters), pair);
  store<1>(t.out[0], lane, &gap);
}
)";

/// A normal that looks at particles is given sixteen of each body.
constexpr const char* points_body = R"(
template <int D, class S> struct Cloud {
  S places[16 * D], weights[16];
  MPM_HD Cloud(const Task& t, int body, int lane) {
    load<16 * D>(t.in[body], lane, places);
    load<16>(t.in[2 + body], lane, weights);
  }
  MPM_HD Vec<3, double> place(int k) const {
    Vec<3, double> x{};
    for (int c = 0; c < D; ++c) x[c] = places[k * D + c];
    return x;
  }
  template <class Visit> MPM_HD void for_each(Visit visit) const {
    for (int k = 0; k < 16; ++k) visit(place(k), double(weights[k]));
  }
  template <int N, class Term> MPM_HD void add(Term term, double (&sums)[N]) const {
    for (int k = 0; k < 16; ++k) {
      double values[N];
      term(place(k), double(weights[k]), values);
      for (int n = 0; n < N; ++n) sums[n] += values[n];
    }
  }
  MPM_HD Vec<3, double> middle() const {
    Vec<3, double> sum{};
    for (int k = 0; k < 16; ++k)
      for (int c = 0; c < 3; ++c) sum[c] += place(k)[c] / 16;
    return sum;
  }
  MPM_HD Vec<3, double> farthest(const Vec<3, double>& along) const {
    const auto at = [&](int k) { return along[0] * place(k)[0] + along[1] * place(k)[1] + along[2] * place(k)[2]; };
    int best = 0;
    for (int k = 1; k < 16; ++k)
      if (at(k) > at(best)) best = k;
    return place(best);
  }
};
template <class Cloud> struct Points { Cloud a, b; };
template <int D, class S> MPM_HD void run(const Task& t, int lane) {
  double found[3] = {};
  const Points<Cloud<D, S>> points{{t, 0, lane}, {t, 1, lane}};
  const S any = Functor::template find<D>(*static_cast<const Functor::Parameters*>(t.parameters), points, found);
  S normal[D];
  for (int c = 0; c < D; ++c) normal[c] = static_cast<S>(found[c]);
  store<D>(t.out[0], lane, normal);
  store<1>(t.out[1], lane, &any);
}
)";

/// A state with a temperature ends with it: the host brings it, and here it is that of reference.
constexpr const char* material_body = R"(
template <class F, class State, class S> MPM_HD auto warm(State& state, S) -> decltype((void)(state.temperature), int()) {
  state.temperature = real<S>(F::reference_temperature);
  return 1;
}
template <class F, class State> MPM_HD int warm(State&, ...) { return 0; }
template <class State, class S, class = void> constexpr int declared = scalars<State, S>;
template <class State, class S> constexpr int declared<State, S, decltype((void)(State::temperature))> = scalars<State, S> - 1;
template <int D, class S> MPM_HD void run(const Task& t, int lane) {
  const Functor::Constants<S> constants(*static_cast<const Functor::Parameters*>(t.parameters));
  using State = typename Functor::template State<D, S>;
  State state{};
  load<declared<State, S>>(t.out[0], lane, reinterpret_cast<S*>(&state));
  warm<Functor>(state, S());
  Mat<D, S> L;
  load<D * D>(t.in[0], lane, L.m);
  const S heat = Functor::advance(constants, L, real<S>(t.dt), state);
  const Sym<D, S> tau = Functor::kirchhoff_stress(constants, state);
  const S energy = Functor::stored_energy(constants, state), speed = Functor::wave_speed(constants, state);
  const S J = Functor::volume_ratio(state);
  store<declared<State, S>>(t.out[0], lane, reinterpret_cast<const S*>(&state));
  store<Sym<D, S>::size>(t.out[1], lane, tau.s);
  store<1>(t.out[2], lane, &energy);
  store<1>(t.out[3], lane, &heat);
  store<1>(t.out[4], lane, &speed);
  store<1>(t.out[5], lane, &J);
}
)";

constexpr const char* epilogue = R"(
}
#if defined(__CUDACC_RTC__)
#define ENTRY(name, D, S) extern "C" __global__ void name(Task t) { \
  const int lane = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x); if (lane < t.count) mpm::run<D, S>(t, lane); }
#else
#define ENTRY(name, D, S) extern "C" void name(const Task& t) { for (int lane = 0; lane < t.count; ++lane) mpm::run<D, S>(t, lane); }
#endif
ENTRY(run_2_double, 2, double)
ENTRY(run_3_double, 3, double)
ENTRY(run_2_float, 2, float)
ENTRY(run_3_float, 3, float)
)";

bool by_points(const Plugin& plugin) {
  return plugin.descriptor->kind == MPM_NORMAL && (plugin.normal().traits & MPM_LOOKS_AT_POINTS);
}

bool is_list(const Plugin& plugin) {
  return plugin.descriptor->kind == MPM_SHAPE && plugin.shape().form == MPM_NODE_LIST;
}

bool is_sampled(const Plugin& plugin) {
  return is_list(plugin) && plugin.shape().sample_points[0] > 0;
}

bool is_deformed(const Plugin& plugin) {
  return !is_list(plugin) && (plugin.descriptor->needs & MPM_NEEDS_DOMAIN);
}

std::string body_of(const Plugin& plugin) {
  switch (plugin.descriptor->kind) {
    case MPM_SHAPE:
      if (is_list(plugin)) return std::string(is_sampled(plugin) ? corners_of_list : domain_of_list) + list_shape_body;
      if (is_deformed(plugin)) return deformed_shape_body;
      return plugin.descriptor->needs & MPM_NEEDS_HALF_SIZE ? sized_shape_body : shape_body;
    case MPM_TRANSFER:
      return transfer_body;
    case MPM_FILTER:
      return filter_body;
    case MPM_CONTACT:
      return contact_body;
    case MPM_NORMAL:
      return by_points(plugin) ? points_body : normal_body;
    case MPM_DETECTION:
      return detection_body;
    default:
      return material_body;
  }
}

std::string kernel_text(const Plugin& plugin) {
  return std::string(prologue) + "typedef " + plugin.descriptor->functor_name + " Functor;\n" + body_of(plugin) +
         epilogue;
}

// ---- inputs and the plugin's own answer ----------------------------------------------------------------------------

using Column = std::vector<double>;  ///< [component][64]

/// A call: what both sides are given and what they fill; `scale` is the size by which an error in each output is
/// judged.
struct Call {
  std::vector<Column> in, out;
  std::vector<Column> scale;  ///< of each entry of `out`
};

Column random_column(Random& random, int components, double low, double high) {
  Column column(static_cast<std::size_t>(components) * particles);
  for (double& value : column) value = random.uniform(low, high);
  return column;
}

Column zeros(int components) {
  return Column(static_cast<std::size_t>(components) * particles);
}

/// The initial state: all state fields one after the other, as the functor's State holds them.
Column initial_state(const Plugin& plugin, int D) {
  Column state;
  for (const mpm_state& field : plugin.state()) {
    const int components = mpm::state_components(static_cast<mpm_state_shape>(field.shape), D);
    for (int c = 0; c < components; ++c)
      state.insert(state.end(), particles, mpm::conformance::initial_value(field, c, D));
  }
  return state;
}

std::vector<void*> state_pointers(const Plugin& plugin, int D, Column& state) {
  std::vector<void*> pointers;
  double* at = state.data();
  for (const mpm_state& field : plugin.state()) {
    pointers.push_back(at);
    at += mpm::state_components(static_cast<mpm_state_shape>(field.shape), D) * particles;
  }
  return pointers;
}

/// Domains of a cell or so, turned and stretched; in cells.
Column domains(Random& random, int D) {
  Column domain = random_column(random, D * D, -0.4, 0.4);
  for (int i = 0; i < D; ++i)
    for (int lane = 0; lane < particles; ++lane)
      domain[static_cast<std::size_t>(i * (D + 1)) * particles + static_cast<std::size_t>(lane)] +=
          lane % 2 ? 0.75 : 1.5;
  return domain;
}

/// Bent boxes of half a cell or so around the particle.
Column corners(Random& random, int D) {
  Column column = random_column(random, (1 << D) * D, -0.1, 0.1);
  for (int k = 0; k < (1 << D) * D; ++k)
    for (int lane = 0; lane < particles; ++lane)
      column[static_cast<std::size_t>(k) * particles + lane] += k / D >> k % D & 1 ? 0.5 : -0.5;
  return column;
}

/// Sixteen places on one side of the plane x = 0, [place][D], of as few digits as float has.
Column beside_plane(Random& random, int D, double side) {
  Column column = random_column(random, 16 * D, -1.4, 1.4);
  for (int k = 0; k < 16; ++k)
    for (int lane = 0; lane < particles; ++lane)
      column[static_cast<std::size_t>(k * D) * particles + lane] = side * random.uniform(0.1, 1.4);
  for (double& value : column) value = static_cast<float>(value);
  return column;
}

Call inputs(const Plugin& plugin, int D, Random& random) {
  Call call;
  const int width = plugin.descriptor->kind == MPM_SHAPE ? static_cast<int>(plugin.shape().width) : 0;
  switch (plugin.descriptor->kind) {
    case MPM_SHAPE:
      if (is_list(plugin)) {
        const int capacity = static_cast<int>(plugin.shape().capacity[D - 2]);
        call.in = {random_column(random, D, -10, 30), is_sampled(plugin) ? corners(random, D) : domains(random, D)};
        call.out = {zeros(capacity * D), zeros(capacity), zeros(capacity * D), zeros(1)};
        break;
      }
      call.in = {random_column(random, D, -10, 30),
                 is_deformed(plugin) ? domains(random, D) : random_column(random, D, 0.1, 0.5)};
      call.out = {zeros(D), zeros(D * width), zeros(D * width)};
      break;
    case MPM_TRANSFER:
      call.in = {random_column(random, 1, 0.1, 10),   random_column(random, D, -1, 1),
                 random_column(random, D, -1, 1),     random_column(random, D, -1, 1),
                 random_column(random, D * D, -1, 1), random_column(random, D * D, -1, 1)};
      call.out = {initial_state(plugin, D), zeros(D), zeros(D * D), zeros(D), zeros(D)};
      break;
    case MPM_FILTER:
      call.in = {random_column(random, D, -1, 1)};
      call.out = {random_column(random, D, -1, 1), random_column(random, D, -1, 1), zeros(1)};
      break;
    case MPM_CONTACT: {
      call.in = {random_column(random, 1, 0.1, 10),
                 random_column(random, 1, 0.1, 10),
                 random_column(random, D, -1, 1),
                 random_column(random, D, -1, 1),
                 zeros(D),
                 random_column(random, 1, -0.1, 0.05),
                 random_column(random, 1, 0.1, 1),
                 random_column(random, D, -step, step),
                 random_column(random, D, -2, 2)};
      for (int lane = 0; lane < particles; ++lane) {
        const mpm::conformance::Vector3 n = random.direction(D);
        for (int i = 0; i < D; ++i)
          call.in[4][static_cast<std::size_t>(i) * particles + lane] = static_cast<float>(n[i]);
      }
      for (int k = 0; k < 4; ++k) call.in.push_back(random_column(random, 2, 0, 1));
      call.out = {zeros(D), zeros(1), zeros(1), zeros(1), zeros(2)};
      break;
    }
    case MPM_NORMAL:
      if (by_points(plugin)) {
        call.in = {beside_plane(random, D, -1), beside_plane(random, D, 1), random_column(random, 16, 0.1, 1),
                   random_column(random, 16, 0.1, 1)};
        call.out = {zeros(D), zeros(1)};
        break;
      }
      for (int k = 0; k < 4; ++k) call.in.push_back(random_column(random, D, k % 2 ? -2 : 0.5, k % 2 ? -0.5 : 2));
      call.out = {zeros(D), zeros(D), zeros(D), zeros(1)};
      break;
    case MPM_DETECTION:
      for (int k = 0; k < 6; ++k) call.in.push_back(random_column(random, 1, k % 2 ? 0 : -1, k % 2 ? 1 : 0));
      call.out = {zeros(1)};
      break;
    default:
      call.in = {random_column(random, D * D, -0.2 / step, 0.2 / step)};
      call.out = {initial_state(plugin, D), zeros(D == 2 ? 4 : 6), zeros(1), zeros(1), zeros(1), zeros(1)};
  }
  return call;
}

Column as_column(const std::vector<std::int32_t>& indices) {
  return {indices.begin(), indices.end()};
}

/// Lists the nodes of every particle through the C boundary; entries beyond a particle's count are left zero.
void run_list(const Plugin& plugin, int D, const ParameterSample& parameters, Call& call) {
  const std::size_t capacity = plugin.shape().capacity[D - 2], n = particles, dimension = static_cast<std::size_t>(D);
  std::vector<std::int32_t> count(n), node(capacity * dimension * n);
  Column weight(capacity * n), gradient(capacity * dimension * n);
  mpm_list_batch batch{};
  batch.count = batch.stride = particles;
  batch.dimension = static_cast<std::uint32_t>(D);
  batch.capacity = static_cast<std::uint32_t>(capacity);
  batch.position = call.in[0].data();
  (plugin.shape().sample_points[D - 2] > 0 ? batch.samples : batch.domain) = call.in[1].data();
  batch.node_count = count.data(), batch.node = node.data();
  batch.weight = weight.data(), batch.gradient = gradient.data();
  plugin.shape().evaluate_list[MPM_SCALAR_DOUBLE][D - 2](parameters.data(), &batch);
  for (std::size_t lane = 0; lane < n; ++lane) {
    call.out[3][lane] = count[lane];
    for (std::size_t k = 0; k < static_cast<std::size_t>(count[lane]); ++k) {
      call.out[1][k * n + lane] = weight[k * n + lane];
      for (std::size_t a = 0; a < dimension; ++a) {
        call.out[0][(k * dimension + a) * n + lane] = node[(k * dimension + a) * n + lane];
        call.out[2][(k * dimension + a) * n + lane] = gradient[(k * dimension + a) * n + lane];
      }
    }
  }
}

/// Updates a material through the C boundary, scalar double; without a velocity gradient it evaluates alone.
void run_material(const Plugin& plugin, int D, const ParameterSample& parameters, const void* velocity_gradient,
                  std::vector<Column>& out) {
  const std::vector<void*> state = state_pointers(plugin, D, out[0]);
  mpm_material_batch batch{};
  batch.count = batch.stride = particles;
  batch.dimension = static_cast<std::uint32_t>(D);
  batch.dt = step;
  batch.velocity_gradient = velocity_gradient;
  batch.state = state.data();
  batch.kirchhoff_stress = out[1].data(), batch.stored_energy = out[2].data();
  batch.dissipated_energy = out[3].data(), batch.wave_speed = out[4].data(), batch.volume_ratio = out[5].data();
  plugin.material().update[MPM_SCALAR_DOUBLE][D - 2](parameters.data(), &batch);
}

/// Finds normals of points through the C boundary, a call a particle's lane.
void run_normal_by_points(const Plugin& plugin, int D, const ParameterSample& parameters, Call& call) {
  const auto gathered = [&](const Column& column, int components, int lane) {
    Column values(static_cast<std::size_t>(components) * 16);  // [component][place]
    const auto of_point = static_cast<std::size_t>(components);
    for (std::size_t k = 0; k < 16; ++k)
      for (std::size_t c = 0; c < of_point; ++c)
        values[c * 16 + k] = column[(k * of_point + c) * particles + static_cast<std::size_t>(lane)];
    values.resize(components == 1 ? 16 : 48, 0.0);
    return values;
  };
  for (int lane = 0; lane < particles; ++lane) {
    const Column a = gathered(call.in[0], D, lane), b = gathered(call.in[1], D, lane),
                 weight_a = gathered(call.in[2], 1, lane), weight_b = gathered(call.in[3], 1, lane);
    double normal[3];
    const mpm_normal_points points{16, 16, 16, 16, a.data(), b.data(), weight_a.data(), weight_b.data(), normal};
    call.out[1][lane] = plugin.normal().from_points[D - 2](parameters.data(), &points);
    for (int c = 0; c < D; ++c) call.out[0][static_cast<std::size_t>(c) * particles + lane] = normal[c];
  }
}

/// Fills `call.out` through the C boundary, scalar double.
void run_plugin(const Plugin& plugin, int D, const ParameterSample& parameters, Call& call) {
  const std::uint32_t n = particles, dimension = static_cast<std::uint32_t>(D);
  const int axis = D - 2;
  auto& in = call.in;
  auto& out = call.out;
  std::vector<std::int32_t> indices(static_cast<std::size_t>(D) * particles);
  switch (plugin.descriptor->kind) {
    case MPM_SHAPE: {
      if (is_list(plugin)) return run_list(plugin, D, parameters, call);
      Column offset = zeros(D);
      const mpm_shape_batch batch{n,
                                  n,
                                  dimension,
                                  0,
                                  in[0].data(),
                                  is_deformed(plugin) ? nullptr : in[1].data(),
                                  is_deformed(plugin) ? in[1].data() : nullptr,
                                  indices.data(),
                                  offset.data(),
                                  out[1].data(),
                                  out[2].data(),
                                  nullptr};
      plugin.shape().evaluate[MPM_SCALAR_DOUBLE](parameters.data(), &batch);
      out[0] = as_column(indices);
      break;
    }
    case MPM_TRANSFER: {
      const std::vector<void*> state = state_pointers(plugin, D, out[0]);
      out[3] = in[1];
      const mpm_scatter_batch scatter{
          n, n, dimension, 0, in[0].data(), in[1].data(), state.data(), out[1].data(), out[2].data()};
      const mpm_gather_batch gather{n,
                                    n,
                                    dimension,
                                    0,
                                    step,
                                    in[2].data(),
                                    in[3].data(),
                                    in[4].data(),
                                    in[5].data(),
                                    out[3].data(),
                                    state.data(),
                                    out[4].data(),
                                    nullptr};
      plugin.transfer().scatter[MPM_SCALAR_DOUBLE][axis](parameters.data(), &scatter);
      plugin.transfer().gather[MPM_SCALAR_DOUBLE][axis](parameters.data(), &gather);
      break;
    }
    case MPM_FILTER: {
      const mpm_filter_batch batch{n, n, dimension, 2, in[0].data(), out[0].data(), out[1].data()};
      plugin.filter().update[MPM_SCALAR_DOUBLE][axis](parameters.data(), &batch);
      out[2].assign(particles, plugin.filter().iterations(parameters.data()));
      break;
    }
    case MPM_CONTACT: {
      indices.resize(particles);
      const bool compliant = plugin.contact().traits & MPM_COMPLIANT, keeps = !plugin.state().empty();
      const mpm_contact_batch batch{n,
                                    n,
                                    dimension,
                                    MPM_AFTER_FORCES,
                                    step,
                                    in[0].data(),
                                    in[1].data(),
                                    in[2].data(),
                                    in[3].data(),
                                    in[4].data(),
                                    in[5].data(),
                                    in[6].data(),
                                    out[0].data(),
                                    out[1].data(),
                                    indices.data(),
                                    compliant ? in[7].data() : nullptr,
                                    compliant ? out[3].data() : nullptr,
                                    plugin.contact().traits & MPM_READS_TRACTION ? in[8].data() : nullptr,
                                    1.0,
                                    keeps ? in[9].data() : nullptr,
                                    keeps ? in[10].data() : nullptr,
                                    keeps ? in[11].data() : nullptr,
                                    keeps ? in[12].data() : nullptr,
                                    keeps ? out[4].data() : nullptr,
                                    0,
                                    0};
      plugin.contact().apply[MPM_SCALAR_DOUBLE][axis](parameters.data(), &batch);
      out[2] = as_column(indices);
      break;
    }
    case MPM_NORMAL: {
      if (by_points(plugin)) return run_normal_by_points(plugin, D, parameters, call);
      indices.resize(particles);
      const mpm_normal_batch batch{n,
                                   n,
                                   dimension,
                                   0,
                                   in[0].data(),
                                   in[1].data(),
                                   in[2].data(),
                                   in[3].data(),
                                   out[0].data(),
                                   out[1].data(),
                                   out[2].data(),
                                   indices.data()};
      plugin.normal().from_sums[MPM_SCALAR_DOUBLE][axis](parameters.data(), &batch);
      out[3] = as_column(indices);
      break;
    }
    case MPM_DETECTION: {
      const mpm_detection_batch batch{
          n, n, in[0].data(), in[1].data(), in[2].data(), in[3].data(), in[4].data(), in[5].data(), out[0].data()};
      plugin.detection().find[MPM_SCALAR_DOUBLE](parameters.data(), &batch);
      break;
    }
    default:
      run_material(plugin, D, parameters, in[0].data(), out);
  }
}

/// How far stress and energy change where each number of the state reached is turned by a small share of itself, over
/// that share: what rounding of the state makes of them.
double response_to_state(const Plugin& plugin, int D, const ParameterSample& parameters, const Call& reached) {
  constexpr double share = 0x1p-20;
  std::vector<Column> there = reached.out, turned = reached.out;
  Random random(20240613);
  for (double& value : turned[0]) value *= 1 + random.uniform(-share, share);
  run_material(plugin, D, parameters, nullptr, there);
  run_material(plugin, D, parameters, nullptr, turned);
  mpm::conformance::Worst worst;
  for (std::size_t k : {1, 2})
    for (std::size_t i = 0; i < there[k].size(); ++i) worst.add(std::abs(turned[k][i] - there[k][i]) / share);
  return worst.value;
}

/// How far all outputs of an advance change, over that share, where each number of the state that it starts from is
/// turned by a small share of itself, added up over these numbers: what rounding of the strain makes, at most, of a state
/// that grows with it, as damage does over a strain of a hundredth.
std::vector<Column> response_to_start(const Plugin& plugin, int D, const ParameterSample& parameters,
                                      const Call& start) {
  constexpr double share = 0x1p-20;
  const auto zeros_like = [](const std::vector<Column>& columns) {
    std::vector<Column> zeros;
    for (const Column& column : columns) zeros.emplace_back(column.size(), 0.0);
    return zeros;
  };
  std::vector<Column> there = start.out;
  run_material(plugin, D, parameters, start.in[0].data(), there);
  std::vector<Column> response = zeros_like(there);
  for (std::size_t row = 0; row < start.out[0].size(); row += particles) {  // a component of all particles
    std::vector<Column> larger = zeros_like(there);
    for (const double turn : {share, -share}) {  // a law may answer to one side alone
      std::vector<Column> turned = start.out;
      for (std::size_t lane = row; lane < row + particles; ++lane) turned[0][lane] *= 1 + turn;
      run_material(plugin, D, parameters, start.in[0].data(), turned);
      for (std::size_t k = 0; k < there.size(); ++k)
        for (std::size_t i = 0; i < there[k].size(); ++i)
          larger[k][i] = mpm::test::larger(larger[k][i], std::abs(turned[k][i] - there[k][i]) / share);
    }
    for (std::size_t k = 0; k < there.size(); ++k)
      for (std::size_t i = 0; i < there[k].size(); ++i) response[k][i] += larger[k][i];
  }
  return response;
}

// ---- the composed text, compiled and run ---------------------------------------------------------------------------

struct Task {
  const void* parameters;
  const void* in[13];
  void* out[8];
  int count;
  double dt;
};

/// Runs the compiled text over the same arrays, in float or double.
template <class T>
void run_composed(void* library, int D, const ParameterSample& parameters, Call& call) {
  const std::string name = "run_" + std::to_string(D) + (sizeof(T) == 4 ? "_float" : "_double");
  const auto run = reinterpret_cast<void (*)(const Task&)>(dlsym(library, name.c_str()));
  REQUIRE(run);
  std::vector<std::vector<T>> in, out;
  for (const Column& column : call.in) in.emplace_back(column.begin(), column.end());
  for (const Column& column : call.out) out.emplace_back(column.begin(), column.end());
  Task task{parameters.data(), {}, {}, particles, step};
  for (std::size_t k = 0; k < in.size(); ++k) task.in[k] = in[k].data();
  for (std::size_t k = 0; k < out.size(); ++k) task.out[k] = out[k].data();
  run(task);
  for (std::size_t k = 0; k < out.size(); ++k) call.out[k].assign(out[k].begin(), out[k].end());
}

/// An output may be off by 64 roundings of its size, or by 8 of the state: it is advanced by a sum of three products (3),
/// taken apart, put together by such sums again (3), and stored, and taken apart again for the stress. Snow needs 7.4.
constexpr double roundings_of_state = 8.0 / 64;

/// The size by which each output's error is judged: the output's own. Stress and energy of a material both have that of
/// the stress, or what rounding of the state makes of them where that is more. It is for laws that hold strains small:
/// F is about 1 and its rounding the larger a share of a strain the smaller that is (snow yields at a hundredth). Where
/// strains follow F, which is turned by a fifth here, the stress is more. A component of the state, and the stress,
/// energy and heat, have what rounding of the state before makes of them where that is more (damage grows over strains
/// of a hundredth).
std::vector<Column> scales(const Plugin& plugin, int D, const ParameterSample& parameters, const Call& start,
                           const Call& expected) {
  std::vector<Column> scale;
  for (const Column& column : expected.out) {
    double largest = 1e-300;
    for (double value : column) largest = mpm::test::larger(largest, std::abs(value));
    scale.emplace_back(column.size(), largest);
  }
  if (plugin.descriptor->kind != MPM_MATERIAL) return scale;
  const double response = roundings_of_state * response_to_state(plugin, D, parameters, expected);
  const double stress = std::max(scale[1][0], response);
  const std::vector<Column> grown = response_to_start(plugin, D, parameters, start);
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t i = 0; i < scale[k].size(); ++i) {
      if (k > 0) scale[k][i] = stress;
      const std::size_t row = i - i % particles;  // the same component of all particles
      for (std::size_t lane = row; lane < row + particles; ++lane)
        scale[k][i] = mpm::test::larger(scale[k][i], roundings_of_state * grown[k][lane]);
    }
  return scale;
}

/// Largest error of any output in units of `unit` times its scale.
double worst_error(const Call& got, const Call& expected, double unit) {
  mpm::conformance::Worst worst;
  for (std::size_t k = 0; k < expected.out.size(); ++k)
    for (std::size_t i = 0; i < expected.out[k].size(); ++i)
      worst.add(std::abs(got.out[k][i] - expected.out[k][i]) / (unit * expected.scale[k][i]));
  return worst.value;
}

std::string contents(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// Compiles without any system header and loads the result; null when the compiler refuses, with its words in `log`.
void* compiled(const Plugin& plugin, const std::filesystem::path& folder, std::string& log) {
  const std::string id = std::string(plugin.id()), source = (folder / (id + ".cpp")).string();
  std::ofstream(folder / "functor.hpp") << plugin.descriptor->source;
  std::ofstream(source) << kernel_text(plugin);
  const std::string library = (folder / (id + ".so")).string(), messages = (folder / "messages.txt").string();
  std::string flags =
      " -std=c++17 -DMPM_DEVICE_PASS=1 -nostdinc -nostdinc++ -O2 -fno-math-errno -fno-trapping-math"
      " -Wall -Wextra -Werror -shared -fPIC";
#if defined(__FMA__)
  flags += " -mfma -ffp-contract=fast";  // the same contraction as the plugins of a native build
#endif
  const std::string command = std::string(MPM_CXX_COMPILER) + flags + " -I '" + folder.string() + "' '" + source +
                              "' -o '" + library + "' -lm > '" + messages + "' 2>&1";
  const int status = std::system(command.c_str());
  log = contents(messages);
  return status == 0 ? dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL) : nullptr;
}

const mpm::Registry& registry() {
  static const mpm::Registry found = mpm::Registry::from_folders(mpm::Registry::default_folders());
  return found;
}

std::string title(const Plugin& plugin) {
  return std::string(mpm::kind_name(static_cast<mpm_kind>(plugin.descriptor->kind))) + " " + std::string(plugin.id());
}

}  // namespace

TEST_CASE("every functor compiles without system headers and gives the plugin's own results") {
  // The folder holds nothing to include but the functor and the kernel headers.
  const mpm::test::TemporaryFolder folder;
  std::filesystem::create_directory_symlink(std::filesystem::path(MPM_SOURCE_DIR) / "modules" / "kernel",
                                            folder / "kernel");
  REQUIRE_FALSE(registry().plugins().empty());
  for (const Plugin& plugin : registry().plugins()) {
    DYNAMIC_SECTION(title(plugin)) {
      std::string log;
      void* library = compiled(plugin, folder.path(), log);
      INFO(log);
      REQUIRE(library);
      Random random(20240605);
      for (const ParameterSample& parameters : mpm::conformance::sample_parameters(plugin, random))
        for (int D : {2, 3}) {
          INFO(D << "-D; " << parameters.text);
          const Call call = inputs(plugin, D, random);
          Call expected = call, doubles = call, singles = call;
          run_plugin(plugin, D, parameters, expected);
          run_composed<double>(library, D, parameters, doubles);
          run_composed<float>(library, D, parameters, singles);
          expected.scale = scales(plugin, D, parameters, call, expected);
          CHECK(worst_error(doubles, expected, 0x1p-52) <= 64);
          CHECK(worst_error(singles, expected, 0x1p-23) <= 64);
        }
      dlclose(library);
    }
  }
}

// ---- NVRTC ---------------------------------------------------------------------------------------------------------

namespace {

/// The few entries of NVRTC that are needed, by their C signatures; absent where the library is.
struct Nvrtc {
  using Program = void*;
  int (*create)(Program*, const char*, const char*, int, const char* const*, const char* const*) = nullptr;
  int (*compile)(Program, int, const char* const*) = nullptr;
  int (*log_size)(Program, std::size_t*) = nullptr;
  int (*log)(Program, char*) = nullptr;
  int (*cubin_size)(Program, std::size_t*) = nullptr;
  int (*destroy)(Program*) = nullptr;
  bool present = false;

  Nvrtc() {
    void* library = nullptr;
    for (const char* folder : {"", "/usr/local/cuda/lib64/"})
      for (const char* name : {"libnvrtc.so.13", "libnvrtc.so.12", "libnvrtc.so"})
        if (!library) library = dlopen((std::string(folder) + name).c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library) return;
    const auto find = [&](auto& function, const char* name) {
      function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(library, name));
      return function != nullptr;
    };
    present = find(create, "nvrtcCreateProgram") && find(compile, "nvrtcCompileProgram") &&
              find(log_size, "nvrtcGetProgramLogSize") && find(log, "nvrtcGetProgramLog") &&
              find(cubin_size, "nvrtcGetCUBINSize") && find(destroy, "nvrtcDestroyProgram");
  }
};

struct CubinResult {
  int status = -1;
  std::size_t size = 0;
  std::string log;
};

/// Compiles to machine code of compute capability 9.0, with all headers handed over in memory.
CubinResult cubin_of(const Nvrtc& nvrtc, const Plugin& plugin) {
  std::vector<std::string> names{"functor.hpp"}, texts{plugin.descriptor->source};
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(MPM_SOURCE_DIR) / "modules" / "kernel")) {
    names.push_back("kernel/" + entry.path().filename().string());
    texts.push_back(contents(entry.path()));
  }
  std::vector<const char*> name_pointers, text_pointers;
  for (const std::string& name : names) name_pointers.push_back(name.c_str());
  for (const std::string& text : texts) text_pointers.push_back(text.c_str());
  const std::string kernel = kernel_text(plugin);
  Nvrtc::Program program = nullptr;
  CubinResult result;
  if (nvrtc.create(&program, kernel.c_str(), "kernel.cu", static_cast<int>(names.size()), text_pointers.data(),
                   name_pointers.data()) != 0)
    return result;
  const char* const options[] = {"--gpu-architecture=sm_90", "-std=c++17", "-DMPM_DEVICE_PASS=1"};
  result.status = nvrtc.compile(program, 3, options);
  std::size_t length = 0;
  nvrtc.log_size(program, &length);
  result.log.resize(length);
  if (length) nvrtc.log(program, result.log.data());
  if (result.status == 0) nvrtc.cubin_size(program, &result.size);
  nvrtc.destroy(&program);
  return result;
}

}  // namespace

TEST_CASE("every functor compiles with NVRTC where it is installed") {
  static const Nvrtc nvrtc;
  if (!nvrtc.present) {
    WARN("NVRTC is not installed: the device text was compiled by the host compiler only");
    return;
  }
  for (const Plugin& plugin : registry().plugins()) {
    DYNAMIC_SECTION(title(plugin)) {
      const CubinResult result = cubin_of(nvrtc, plugin);
      INFO(result.log);
      CHECK(result.status == 0);
      CHECK(result.size > 0);
    }
  }
}
