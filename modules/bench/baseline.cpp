#include "bench/baseline.hpp"

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "kernel/elasticity.hpp"
#include "simulation/seeding.hpp"

namespace mpm::bench {
namespace {

/// Makes denormal numbers count as zero while it lives: in a body at rest, products of rounding noise are denormal in
/// float and would slow the baseline by a third.
class FlushToZero {
 public:
#if defined(__SSE__)
  FlushToZero() : before_(_mm_getcsr()) {
    _mm_setcsr(before_ | 0x8040);
  }
  ~FlushToZero() {
    _mm_setcsr(before_);
  }
  FlushToZero(const FlushToZero&) = delete;
  FlushToZero& operator=(const FlushToZero&) = delete;

 private:
  unsigned before_;
#endif
};

template <int D, class T>
struct Particle {
  T x[D], v[D];        ///< cells from the domain's lower corner; m/s
  T C[D][D], F[D][D];  ///< C in 1/s; F is a pure number
};

template <int D, class T>
struct Node {
  T v[D];  ///< momentum, kg m/s, then velocity, m/s
  T m;     ///< kg
};

template <int D, class T>
T determinant_of(const T F[D][D]) {
  if constexpr (D == 2)
    return F[0][0] * F[1][1] - F[0][1] * F[1][0];
  else
    return F[0][0] * (F[1][1] * F[2][2] - F[1][2] * F[2][1]) - F[0][1] * (F[1][0] * F[2][2] - F[1][2] * F[2][0]) +
           F[0][2] * (F[1][0] * F[2][1] - F[1][1] * F[2][0]);
}

/// First node and weights of quadratic B-splines on every axis.
template <int D, class T>
struct Weights {
  int base[D];
  T offset[D], w[D][3];

  explicit Weights(const T x[D]) {
    for (int a = 0; a < D; ++a) {
      base[a] = static_cast<int>(std::floor(x[a] - T(0.5)));
      const T f = offset[a] = x[a] - static_cast<T>(base[a]);
      w[a][0] = T(0.5) * (T(1.5) - f) * (T(1.5) - f);
      w[a][1] = T(0.75) - (f - T(1)) * (f - T(1));
      w[a][2] = T(0.5) * (f - T(0.5)) * (f - T(0.5));
    }
  }
};

template <int D, class T>
class PlainMls final : public Baseline {
 public:
  PlainMls(const Experiment& experiment, const SeededBody& body);

  void step() override {
    [[maybe_unused]] const FlushToZero flush;
    std::fill(nodes_.begin(), nodes_.end(), Node<D, T>{});
    for (const auto& p : particles_) scatter(p);
    update_grid();
    for (auto& p : particles_) gather(p);
  }
  std::size_t particle_count() const override { return particles_.size(); }
  std::vector<double> positions() const override;
  std::vector<double> velocities() const override;

 private:
  void scatter(const Particle<D, T>& p);
  void gather(Particle<D, T>& p);
  void update_grid();
  template <class Visit>
  void for_each_of_layer(int axis, int index, Visit&& visit);

  /// Number of a node. Nodes run from -1 to cells + 1 on every axis, x the fastest; -1 and cells + 1 are ghosts.
  std::size_t number(const int* at) const {
    std::size_t n = 0;
    for (int a = 0; a < D; ++a) n += static_cast<std::size_t>(at[a] + 1) * stride_[a];
    return n;
  }
  /// Calls visit(node, weight, i, j, k) for the 3^D nodes of a particle.
  template <class Visit>
  void for_each_node(const Weights<D, T>& weights, Visit&& visit) {
    Node<D, T>* const corner = nodes_.data() + number(weights.base);
    for (int k = 0; k < (D == 3 ? 3 : 1); ++k)
      for (int j = 0; j < 3; ++j) {
        T w_row = weights.w[1][j];
        if constexpr (D == 3) w_row *= weights.w[2][k];
        Node<D, T>* const row = corner + static_cast<std::size_t>(j) * stride_[1] +
                                (D == 3 ? static_cast<std::size_t>(k) * stride_[D - 1] : 0);
        for (int i = 0; i < 3; ++i) visit(row[i], w_row * weights.w[0][i], i, j, k);
      }
  }

  std::vector<Particle<D, T>> particles_;
  std::vector<Node<D, T>> nodes_;
  std::array<std::size_t, 3> stride_{};
  std::array<int, 3> cells_{};
  std::array<double, 3> lower_{};
  double cell_size_;
  T h_, dt_, mass_, volume_, mu_, lambda_, gravity_[D];
};

template <int D, class T>
PlainMls<D, T>::PlainMls(const Experiment& experiment, const SeededBody& body)
    : particles_(body.count()),
      cell_size_(experiment.grid.cell_size),
      h_(static_cast<T>(cell_size_)),
      dt_(static_cast<T>(*experiment.solver.time_step)),
      mass_(static_cast<T>(body.mass)),
      volume_(static_cast<T>(body.volume)) {
  const Component& material = experiment.materials[experiment.bodies[0].material].component;
  const double E = material.parameter("youngs_modulus"), nu = material.parameter("poisson_ratio");
  mu_ = static_cast<T>(shear_modulus(E, nu));
  lambda_ = static_cast<T>(lame_lambda(E, nu));
  std::size_t size = 1;
  for (int a = 0; a < D; ++a) {
    cells_[a] = experiment.grid.cells[a];
    lower_[a] = experiment.grid.lower[a];
    gravity_[a] = static_cast<T>(experiment.gravity[a]);
    stride_[a] = size;
    size *= static_cast<std::size_t>(cells_[a] + 3);
  }
  nodes_.resize(size);
  const SeedArrays seeds = body.arrays();
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    Particle<D, T>& p = particles_[i];
    for (int a = 0; a < D; ++a) {
      p.x[a] = static_cast<T>((seeds.position[i * D + a] - lower_[a]) / cell_size_);
      p.v[a] = static_cast<T>(seeds.velocity[i * D + a]);
      for (int b = 0; b < D; ++b) {
        p.C[a][b] = static_cast<T>(seeds.velocity_gradient[(i * D + a) * D + b]);
        p.F[a][b] = a == b ? T(1) : T(0);
      }
    }
  }
}

/// Scatters w (m v + A d) with A = m C - dt V0 tau D^-1, D = h^2 / 4 and tau = mu (b - I) + lambda ln J I.
template <int D, class T>
void PlainMls<D, T>::scatter(const Particle<D, T>& p) {
  const T pressure = lambda_ * std::log(determinant_of<D, T>(p.F)) - mu_;
  const T scale = -dt_ * volume_ * T(4) / (h_ * h_);
  T A[D][D];  // times h: distances are in cells
  for (int a = 0; a < D; ++a)
    for (int b = 0; b < D; ++b) {
      T tau = 0;
      for (int c = 0; c < D; ++c) tau += p.F[a][c] * p.F[b][c];
      tau = mu_ * tau + (a == b ? pressure : T(0));
      A[a][b] = h_ * (mass_ * p.C[a][b] + scale * tau);
    }
  const Weights<D, T> weights(p.x);
  T first[D];  // place of the stencil's first node
  for (int a = 0; a < D; ++a) {
    first[a] = mass_ * p.v[a];
    for (int b = 0; b < D; ++b) first[a] -= A[a][b] * weights.offset[b];
  }
  for_each_node(weights, [&](Node<D, T>& node, T w, int i, int j, int k) {
    for (int a = 0; a < D; ++a) {
      T momentum = first[a] + A[a][0] * static_cast<T>(i) + A[a][1] * static_cast<T>(j);
      if constexpr (D == 3) momentum += A[a][2] * static_cast<T>(k);
      node.v[a] += w * momentum;
    }
    node.m += w * mass_;
  });
}

template <int D, class T>
void PlainMls<D, T>::gather(Particle<D, T>& p) {
  const Weights<D, T> weights(p.x);
  T v[D]{}, B[D][D]{};
  for_each_node(weights, [&](const Node<D, T>& node, T w, int i, int j, int k) {
    const int at[3] = {i, j, k};
    for (int a = 0; a < D; ++a) {
      const T wv = w * node.v[a];
      v[a] += wv;
      for (int b = 0; b < D; ++b) B[a][b] += wv * static_cast<T>(at[b]);
    }
  });
  T C[D][D];
  for (int a = 0; a < D; ++a)
    for (int b = 0; b < D; ++b) C[a][b] = p.C[a][b] = (B[a][b] - v[a] * weights.offset[b]) * (T(4) / h_);
  for (int b = 0; b < D; ++b) {
    T column[D];
    for (int a = 0; a < D; ++a) {
      column[a] = p.F[a][b];
      for (int c = 0; c < D; ++c) column[a] += dt_ * C[a][c] * p.F[c][b];
    }
    for (int a = 0; a < D; ++a) p.F[a][b] = column[a];
  }
  for (int a = 0; a < D; ++a) {
    p.v[a] = v[a];
    p.x[a] += dt_ / h_ * v[a];
  }
}

/// Calls visit(at) for the nodes whose coordinate along `axis` is `index`, ghosts included.
template <int D, class T>
template <class Visit>
void PlainMls<D, T>::for_each_of_layer(int axis, int index, Visit&& visit) {
  int low[3]{-1, -1, 0}, high[3]{cells_[0] + 1, cells_[1] + 1, 0};
  if constexpr (D == 3) low[2] = -1, high[2] = cells_[2] + 1;
  low[axis] = high[axis] = index;
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) {
        int at[3] = {x, y, z};
        visit(at);
      }
}

/// Applies gravity, then slip walls on all faces: what lies beyond is folded back with the normal component turned,
/// wall nodes have no normal velocity, ghosts take the mirrored velocity (docs/method.md, walls).
template <int D, class T>
void PlainMls<D, T>::update_grid() {
  for (Node<D, T>& node : nodes_)
    for (int a = 0; a < D; ++a) node.v[a] += dt_ * node.m * gravity_[a];
  for (int axis = 0; axis < D; ++axis)
    for (const int ghost : {-1, cells_[axis] + 1})
      for_each_of_layer(axis, ghost, [&](int* at) {
        const Node<D, T> from = nodes_[number(at)];
        at[axis] = ghost < 0 ? 1 : cells_[axis] - 1;
        Node<D, T>& to = nodes_[number(at)];
        for (int a = 0; a < D; ++a) to.v[a] += a == axis ? -from.v[a] : from.v[a];
        to.m += from.m;
      });
  for (Node<D, T>& node : nodes_)
    for (int a = 0; a < D; ++a) node.v[a] = node.m > 0 ? node.v[a] / node.m : T(0);
  for (int axis = D - 1; axis >= 0; --axis) {
    for (const int wall : {0, cells_[axis]})
      for_each_of_layer(axis, wall, [&](const int* at) { nodes_[number(at)].v[axis] = 0; });
    for (const int ghost : {-1, cells_[axis] + 1})
      for_each_of_layer(axis, ghost, [&](int* at) {
        Node<D, T>& to = nodes_[number(at)];
        at[axis] = ghost < 0 ? 1 : cells_[axis] - 1;
        const Node<D, T>& from = nodes_[number(at)];
        for (int a = 0; a < D; ++a) to.v[a] = a == axis ? -from.v[a] : from.v[a];
      });
  }
}

template <int D, class T>
std::vector<double> PlainMls<D, T>::positions() const {
  std::vector<double> result;
  for (const auto& p : particles_)
    for (int a = 0; a < D; ++a) result.push_back(lower_[a] + cell_size_ * static_cast<double>(p.x[a]));
  return result;
}

template <int D, class T>
std::vector<double> PlainMls<D, T>::velocities() const {
  std::vector<double> result;
  for (const auto& p : particles_)
    for (int a = 0; a < D; ++a) result.push_back(static_cast<double>(p.v[a]));
  return result;
}

}  // namespace

std::string baseline_refusal(const Experiment& experiment) {
  if (experiment.bodies.size() != 1) return "it knows one body";
  if (experiment.shape.plugin->id() != "bspline_quadratic") return "it knows quadratic B-splines";
  if (experiment.transfer.plugin->id() != "mls") return "it knows MLS";
  if (experiment.filter || experiment.contact || experiment.body_force || !experiment.loads.empty() ||
      !experiment.boxes.empty() || !experiment.rigid_bodies.empty())
    return "it knows no filter, contact, body force, load, rigid body or condition on a box";
  const Component& material = experiment.materials[experiment.bodies[0].material].component;
  if (material.plugin->id() != "neo_hookean" || material.parameter("form") != 0 ||
      material.parameter("volumetric_energy") != 0)
    return "it knows neo_hookean, coupled and logarithmic";
  if (!experiment.solver.time_step || experiment.solver.stress_update != StressUpdate::last)
    return "it knows a fixed time step and USL";
  for (int axis = 0; axis < experiment.dimension; ++axis)
    for (const FaceCondition& face : experiment.faces[axis])
      if (face.type != ConditionType::slip) return "it knows slip walls";
  return {};
}

std::unique_ptr<Baseline> make_baseline(const Experiment& experiment) {
  if (const std::string why = baseline_refusal(experiment); !why.empty())
    throw std::invalid_argument("the baseline cannot run " + experiment.file.string() + ": " + why);
  const SeededBody body = seed_body(experiment, 0);
  const bool single = experiment.precision == Precision::single;
  if (experiment.dimension == 2) {
    if (single) return std::make_unique<PlainMls<2, float>>(experiment, body);
    return std::make_unique<PlainMls<2, double>>(experiment, body);
  }
  if (single) return std::make_unique<PlainMls<3, float>>(experiment, body);
  return std::make_unique<PlainMls<3, double>>(experiment, body);
}

}  // namespace mpm::bench
