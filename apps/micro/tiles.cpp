// Benchmarks of the cpu backend's scatter and gather between 64 particles and the tile of their block, for every width
// of stencil, with and without affine terms and gradients; and of the transposes around them.

#include "backends/cpu/tiles/quad.hpp"
#include "backends/cpu/tiles/tile.hpp"
#include "micro.hpp"

namespace mpm::micro {
namespace {

using conformance::Random;

template <class T>
constexpr Element element_of = sizeof(T) == 4 ? Element::single_precision : Element::double_precision;

template <class T>
Buffer filled(Random& random, int components, double low, double high) {
  Buffer result(element_of<T>, components);
  for (int c = 0; c < components; ++c)
    for (int lane = 0; lane < batch; ++lane) result.set(c, lane, random.uniform(low, high));
  return result;
}

/// Particles anywhere in the block, as after a sort: their order within it follows no axis.
template <int D, class T>
struct TileCase {
  cpu::TileKernels<D, T> kernels;
  bool gathers, affine, with_gradient;
  Buffer first{Element::index, 1}, weight, gradient, quads, tile;

  TileCase(int width, bool gather, bool is_affine, bool has_gradient)
      : kernels(cpu::tile_kernels<D, T>(width)), gathers(gather), affine(is_affine), with_gradient(has_gradient) {
    Random random(1);
    weight = filled<T>(random, D * width, 0, 1), gradient = filled<T>(random, D * width, -1, 1);
    // A quad holds four scalars: 64 of a component fill as many quads as sixteen components of a batch.
    quads = filled<T>(random, 4 * (1 + 2 * D) + 1, -1e-3, 1e-3);
    tile = filled<T>(random, (kernels.scalars + batch - 1) / batch, -1, 1);
    for (int lane = 0; lane < batch; ++lane) {
      int number = 0;
      for (int a = 0; a < D; ++a) {
        const int side = a == D - 1 ? kernels.first_nodes : kernels.side;
        number = number * side + 1 + static_cast<int>(random.uniform(0, cpu::block_side<D>)) % cpu::block_side<D>;
      }
      static_cast<std::int32_t*>(first.data())[lane] = number;
    }
  }
  void run() {
    cpu::Stencils<T> stencils{};
    stencils.first = static_cast<const std::int32_t*>(first.data());
    stencils.weight = static_cast<const T*>(weight.data()), stencils.gradient = static_cast<const T*>(gradient.data());
    T* const nodes = static_cast<T*>(tile.data());
    T* const particles = static_cast<T*>(quads.data());
    for (int done = 0; done < batch; done += cpu::chunk_size<T>)
      if (gathers)
        kernels.gather[affine][with_gradient](nodes, stencils, particles, cpu::chunk_size<T>);
      else
        kernels.scatter[affine][with_gradient](nodes, stencils, particles, cpu::chunk_size<T>);
  }
  std::string problem() { return tile.finite() && quads.finite() ? "" : "a result is not a number"; }
};

template <class T>
struct QuadCase {
  bool packs;
  alignas(64) T components[4 * batch];
  alignas(64) T quads[4 * batch];

  explicit QuadCase(bool pack) : packs(pack) {
    Random random(1);
    for (T& entry : components) entry = static_cast<T>(random.uniform(-1, 1));
    for (T& entry : quads) entry = static_cast<T>(random.uniform(-1, 1));
  }
  void run() {
    for (int p = 0; p < batch; p += Lanes<T>::width) {
      Lanes<T> lanes[4];
      if (packs) {
        for (int c = 0; c < 4; ++c) lanes[c] = Lanes<T>::load(components + c * batch + p);
        cpu::store_quads<T>(quads + 4 * p, lanes);
      } else {
        cpu::load_quads<T>(quads + 4 * p, lanes);
        for (int c = 0; c < 4; ++c) lanes[c].store(components + c * batch + p);
      }
    }
  }
  std::string problem() {
    for (int k = 0; k < 4 * batch; ++k)
      if (!std::isfinite(components[k]) || !std::isfinite(quads[k])) return "a result is not a number";
    return {};
  }
};

template <int D, class T>
void add_variant() {
  const std::string variant = variant_name(D, sizeof(T) == 4);
  for (const bool gather : {false, true})
    for (const int width : {2, 3, 4})
      for (const bool affine : {false, true})
        for (const bool gradient : {false, true})
          add(std::string("tile/") + (gather ? "gather" : "scatter") + "/" + variant + "/width_" +
                  std::to_string(width) + (affine ? "/affine" : "") + (gradient ? "/gradient" : ""),
              "particle", [=] { return TileCase<D, T>(width, gather, affine, gradient); });
  if (D == 2) return;
  for (const bool pack : {true, false})
    add(std::string("quads/") + (pack ? "pack/" : "unpack/") + (sizeof(T) == 4 ? "float" : "double"), "particle",
        [=] { return QuadCase<T>(pack); });
}

}  // namespace

void add_tiles() {
  add_variant<2, float>();
  add_variant<2, double>();
  add_variant<3, float>();
  add_variant<3, double>();
}

}  // namespace mpm::micro
