// Benchmarks of what functors call over lanes: rotations, singular values, logarithm, exponential, root.

#include "kernel/lanes.hpp"
#include "kernel/polar.hpp"
#include "micro.hpp"

namespace mpm::micro {
namespace {

using conformance::Random;

/// Data of a benchmark: 64 numbers around 1, and what the function makes of them.
template <class T, class Function>
struct ScalarCase {
  static constexpr int packs = batch / Lanes<T>::width;
  Lanes<T> in[packs], out[packs];

  ScalarCase() {
    Random random(1);
    for (Lanes<T>& pack : in)
      for (int lane = 0; lane < Lanes<T>::width; ++lane) pack.v[lane] = static_cast<T>(random.uniform(0.5, 2));
  }
  void run() {
    benchmark::DoNotOptimize(static_cast<void*>(in));
    for (int k = 0; k < packs; ++k) out[k] = Function()(in[k]);
    benchmark::DoNotOptimize(static_cast<void*>(out));
  }
  std::string problem() {
    for (const Lanes<T>& pack : out)
      for (int lane = 0; lane < Lanes<T>::width; ++lane)
        if (!std::isfinite(pack[lane])) return "a result is not a number";
    return {};
  }
};

/// Data of a benchmark: 64 turned matrices with strains of up to a tenth, and what the function makes of them.
template <int D, class T, class Function>
struct MatrixCase {
  static constexpr int packs = batch / Lanes<T>::width;
  Mat<D, Lanes<T>> in[packs], out[packs];

  MatrixCase() {
    Random random(1);
    for (auto& pack : in)
      for (int lane = 0; lane < Lanes<T>::width; ++lane) {
        const conformance::Matrix3 F =
            random.rotation(D) * conformance::sum(conformance::Matrix3::identity(), random.matrix(D, 0.1));
        for (int i = 0; i < D; ++i)
          for (int j = 0; j < D; ++j) pack(i, j).v[lane] = static_cast<T>(F(i, j));
      }
  }
  void run() {
    benchmark::DoNotOptimize(static_cast<void*>(in));
    for (int k = 0; k < packs; ++k) out[k] = Function()(in[k]);
    benchmark::DoNotOptimize(static_cast<void*>(out));
  }
  std::string problem() {
    for (const auto& pack : out)
      for (const Lanes<T>& entry : pack.m)
        for (int lane = 0; lane < Lanes<T>::width; ++lane)
          if (!std::isfinite(entry[lane])) return "a result is not a number";
    return {};
  }
};

struct Logarithm {
  template <class S>
  S operator()(S x) const {
    return log(x);
  }
};
struct Exponential {
  template <class S>
  S operator()(S x) const {
    return exp(x);
  }
};
struct Root {
  template <class S>
  S operator()(S x) const {
    return sqrt(x);
  }
};
struct NearestRotation {
  template <class M>
  M operator()(const M& F) const {
    return nearest_rotation(F);
  }
};
struct PolarRotation {
  template <class M>
  M operator()(const M& F) const {
    return polar_rotation(F);
  }
};
/// Puts U diag(values) V^T together, so that nothing of the decomposition is left out.
struct SingularValueDecomposition {
  template <class M>
  M operator()(const M& F) const {
    const auto parts = singular_value_decomposition(F);
    return composed(parts.U, parts.values, parts.V);
  }
};
struct LeftStretch {
  template <class M>
  M operator()(const M& F) const {
    const auto parts = left_stretches(F);
    return composed(parts.U, parts.stretch, parts.U);
  }
};

template <class T, class Function>
void add_scalar(const char* name) {
  add(std::string("function/") + name + (sizeof(T) == 4 ? "/float" : "/double"), "number",
      [] { return ScalarCase<T, Function>(); });
}

template <int D, class T, class Function>
void add_matrix(const char* name) {
  add(std::string("function/") + name + "/" + variant_name(D, sizeof(T) == 4), "matrix",
      [] { return MatrixCase<D, T, Function>(); });
}

template <class T>
void add_scalars() {
  add_scalar<T, Logarithm>("log");
  add_scalar<T, Exponential>("exp");
  add_scalar<T, Root>("sqrt");
}

template <int D, class T>
void add_matrices() {
  add_matrix<D, T, NearestRotation>("nearest_rotation");
  add_matrix<D, T, PolarRotation>("polar_rotation");
  add_matrix<D, T, SingularValueDecomposition>("singular_value_decomposition");
  add_matrix<D, T, LeftStretch>("left_stretches");
}

}  // namespace

void add_functions() {
  add_scalars<float>();
  add_scalars<double>();
  add_matrices<2, float>();
  add_matrices<2, double>();
  add_matrices<3, float>();
  add_matrices<3, double>();
}

}  // namespace mpm::micro
