#pragma once
// Sorting particles into blocks: where each goes (parallel), counting (serial, in the old order, so the sort is stable
// and the same for any number of threads), moving (parallel).

#include <numeric>

#include "particles.hpp"

namespace mpm::cpu {

/// Where one particle belongs: its stencil's first node and its position, from the old block's first node, after
/// wrapping.
template <int D, class T>
struct Destination {
  std::array<int, 3> node{};  ///< absolute
  BlockCoordinates block{};
  int wrap[D];  ///< cells to add to the position
};
template <int D, class T>
Destination<D, T> destination(const Domain& domain, const Block<D>& from, const std::int32_t* base, const T* position,
                              int lane) {
  Destination<D, T> to;
  for (int axis = 0; axis < D; ++axis) {
    const int origin = from.at[axis] * block_side<D>;
    to.wrap[axis] = 0;
    if (domain.periodic(axis)) {
      const int cells = domain.cells[axis];
      const double x = origin + static_cast<double>(position[axis * chunk_size + lane]);
      to.wrap[axis] = -cells * static_cast<int>(std::floor(x / cells));
    }
    to.node[axis] = origin + base[axis * chunk_size + lane] + to.wrap[axis];
    to.block[axis] = to.node[axis] >> block_bits<D>;
  }
  return to;
}

template <int D, class T>
class Sorter {
 public:
  Sorter(Particles<D, T>& from, Particles<D, T>& to, const Scene<D, T>& scene) : from_(from), to_(to), scene_(scene) {}

  void run() {
    slots_ = std::size_t(from_.chunks) * chunk_size;
    cell_.resize(slots_);
    target_.resize(slots_);
    find_targets();
    count_cells();
    order_blocks();
    assign_places();
    move();
    std::swap(from_.data, to_.data);
    std::swap(from_.id, to_.id);
    from_.blocks.swap(blocks_);
    from_.chunks = chunks_;
    fill_tails(from_);
  }

 private:
  /// Block among the neighbours of the old one (or `far`) and cell in it.
  static constexpr std::int32_t far = -1;

  void find_targets() {
    const int n = static_cast<int>(from_.blocks.size());
#pragma omp parallel for num_threads(scene_.threads) schedule(static)
    for (int b = 0; b < n; ++b) {
      alignas(64) std::int32_t base[D * chunk_size];
      const Block<D>& block = from_.blocks[b];
      for_each_chunk(block, [&](std::uint32_t chunk, int count) {
        first_nodes(chunk, count, base);
        for (int lane = 0; lane < count; ++lane) {
          const auto to = destination<D, T>(scene_.domain, block, base, from_.chunk(chunk), lane);
          int d[3]{};
          bool near = true;
          for (int a = 0; a < D; ++a) {
            d[a] = to.block[a] - block.at[a];
            near = near && d[a] >= -1 && d[a] <= 1 && to.wrap[a] == 0;
          }
          target_[std::size_t(chunk) * chunk_size + lane] = near ? neighbour_index<D>(d[0], d[1], d[2]) : far;
          cell_[std::size_t(chunk) * chunk_size + lane] = node_in_block<D>(to.node);
        }
      });
    }
  }

  void first_nodes(std::uint32_t chunk, int count, std::int32_t* base) const {
    if (scene_.list) {  // the middle of the list's nodes comes to the middle of the tile
      for (int axis = 0; axis < D; ++axis)
        for (int p = 0; p < count; ++p)
          base[axis * chunk_size + p] =
              static_cast<std::int32_t>(std::floor(from_.chunk(chunk)[axis * chunk_size + p] - T(0.5)));
      return;
    }
    alignas(64) T offset[D * chunk_size], weight[D * 4 * chunk_size];
    const mpm_shape_batch batch{static_cast<std::uint32_t>(padded(count)),
                                chunk_size,
                                D,
                                0,
                                from_.chunk(chunk),
                                scene_.half_size ? from_.half_size.data() : nullptr,
                                nullptr,
                                base,
                                offset,
                                weight,
                                nullptr,
                                nullptr};
    scene_.evaluate_shape(scene_.shape_parameters, &batch);
  }

  /// Numbers the new blocks in order of appearance and counts their cells. target_ becomes the number.
  void count_cells() {
    alignas(64) std::int32_t base[D * chunk_size];
    for (const Block<D>& block : from_.blocks) {
      std::array<int, neighbour_count<D>> known;
      known.fill(-1);
      for_each_chunk(block, [&](std::uint32_t chunk, int count) {
        bool have_base = false;
        for (int lane = 0; lane < count; ++lane) {
          std::int32_t& target = target_[std::size_t(chunk) * chunk_size + lane];
          if (target == far) {
            if (!have_base) first_nodes(chunk, count, base), have_base = true;
            target = number_of(destination<D, T>(scene_.domain, block, base, from_.chunk(chunk), lane).block);
          } else {
            int& number = known[target];
            if (number < 0) number = number_of(neighbour_at(block.at, target));
            target = number;
          }
          ++histogram_[std::size_t(target) * block_nodes + cell_[std::size_t(chunk) * chunk_size + lane]];
        }
      });
    }
  }

  static BlockCoordinates neighbour_at(BlockCoordinates at, int index) {
    for (int axis = D - 1; axis >= 0; --axis, index /= 3) at[axis] += index % 3 - 1;
    return at;
  }

  int number_of(const BlockCoordinates& at) {
    const int next = static_cast<int>(found_.size()), number = table_.insert(at, next);
    if (number == next) {
      found_.push_back(at);
      histogram_.resize(histogram_.size() + block_nodes, 0);
    }
    return number;
  }

  /// Columns of two blocks along x (and of two along y in 3-D), one colour in each direction out of two.
  static std::array<int, 4> order_key(const BlockCoordinates& at) {
    if constexpr (D == 2) return {(at[0] >> 1) & 1, at[0] >> 1, 0, at[1] * 2 + (at[0] & 1)};
    return {((at[0] >> 1) & 1) | ((at[1] >> 1) & 1) * 2, at[0] >> 1, at[1] >> 1,
            at[2] * 4 + (at[0] & 1) * 2 + (at[1] & 1)};
  }

  void order_blocks() {
    std::vector<std::pair<std::array<int, 4>, int>> order;
    for (int i = 0; i < static_cast<int>(found_.size()); ++i) order.push_back({order_key(found_[i]), i});
    std::sort(order.begin(), order.end());
    for (auto& units : from_.units) units.clear();
    const std::array<int, 4>* last = nullptr;
    for (const auto& [key, number] : order) {
      auto& units = from_.units[key[0]];
      const std::uint32_t index = static_cast<std::uint32_t>(blocks_.size());
      if (!last || !std::equal(key.begin(), key.begin() + 3, last->begin())) units.push_back({index, index});
      units.back().last = index + 1;
      last = &key;

      Block<D> block;
      block.at = found_[number];
      block.first_chunk = chunks_;
      std::uint32_t place = chunks_ * chunk_size;
      for (int cell = 0; cell < block_nodes; ++cell) {
        std::uint32_t& entry = histogram_[std::size_t(number) * block_nodes + cell];
        const std::uint32_t here = entry;
        entry = place;
        place += here;
        block.count += here;
      }
      chunks_ += (block.count + chunk_size - 1) / chunk_size;
      blocks_.push_back(block);
    }
  }

  /// cell_ becomes the particle's new place.
  void assign_places() {
    for (const Block<D>& block : from_.blocks)
      for_each_chunk(block, [&](std::uint32_t chunk, int count) {
        const std::size_t first = std::size_t(chunk) * chunk_size;
        for (std::size_t i = first; i < first + count; ++i)
          cell_[i] = static_cast<std::int32_t>(histogram_[std::size_t(target_[i]) * block_nodes + cell_[i]]++);
      });
  }

  void move() {
    to_.components = from_.components;
    to_.require_chunks(chunks_);
    const int n = static_cast<int>(from_.blocks.size());
#pragma omp parallel for num_threads(scene_.threads) schedule(static)
    for (int b = 0; b < n; ++b) {
      const Block<D>& block = from_.blocks[b];
      for_each_chunk(block, [&](std::uint32_t chunk, int count) {
        const T* const source = from_.chunk(chunk);
        for (int lane = 0; lane < count; ++lane) {
          const std::size_t i = std::size_t(chunk) * chunk_size + lane;
          const std::uint32_t place = static_cast<std::uint32_t>(cell_[i]), lane_to = place % chunk_size;
          T* const values = to_.chunk(place / chunk_size) + lane_to;
          for (int c = D; c < from_.components; ++c) values[c * chunk_size] = source[c * chunk_size + lane];
          move_position(block, found_[target_[i]], source + lane, values);
          to_.ids(place / chunk_size)[lane_to] = from_.ids(chunk)[lane];
        }
      });
    }
  }

  void move_position(const Block<D>& block, const BlockCoordinates& to, const T* source, T* values) const {
    for (int axis = 0; axis < D; ++axis) {
      const T x = source[axis * chunk_size];
      int shift = (block.at[axis] - to[axis]) * block_side<D>;
      if (scene_.domain.periodic(axis)) {
        const int cells = scene_.domain.cells[axis];
        shift -=
            cells * static_cast<int>(std::floor((block.at[axis] * block_side<D> + static_cast<double>(x)) / cells));
      }
      values[axis * chunk_size] = x + static_cast<T>(shift);
    }
  }

  Particles<D, T>&from_, &to_;
  const Scene<D, T>& scene_;
  std::size_t slots_ = 0;
  std::vector<std::int32_t> cell_, target_;
  BlockTable table_;
  std::vector<BlockCoordinates> found_;
  std::vector<std::uint32_t> histogram_;
  std::vector<Block<D>> blocks_;
  std::uint32_t chunks_ = 0;
};

template <int D, class T>
void sort_particles(Particles<D, T>& particles, Particles<D, T>& spare, const Scene<D, T>& scene) {
  Sorter<D, T>(particles, spare, scene).run();
}

template <int D, class T>
void seed_particles(Particles<D, T>& particles, const SeededBody& seeds, const Domain& domain) {
  const int n = static_cast<int>(seeds.position.size() / D);
  std::vector<double> cells(seeds.position.size());
  std::vector<BlockCoordinates> at(n);
  for (int p = 0; p < n; ++p) {
    at[p] = {};
    for (int a = 0; a < D; ++a) {
      cells[p * std::size_t(D) + a] = (seeds.position[p * std::size_t(D) + a] - domain.lower[a]) / domain.cell_size;
      at[p][a] = static_cast<int>(std::floor(cells[p * std::size_t(D) + a] / block_side<D>));
    }
  }
  std::vector<int> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return at[a] < at[b]; });

  std::vector<std::pair<std::uint32_t, int>> place(n);  // chunk and lane
  for (int i = 0; i < n; ++i) {
    if (i == 0 || at[order[i]] != at[order[i - 1]]) {
      Block<D> block;
      block.at = at[order[i]];
      block.first_chunk = particles.chunks;
      particles.blocks.push_back(block);
    }
    Block<D>& block = particles.blocks.back();
    if (block.count % chunk_size == 0) ++particles.chunks;
    place[i] = {particles.chunks - 1, static_cast<int>(block.count++ % chunk_size)};
  }
  particles.require_chunks(particles.chunks);
  for (int i = 0; i < n; ++i) {
    const int p = order[i];
    T* const values = particles.chunk(place[i].first) + place[i].second;
    particles.ids(place[i].first)[place[i].second] = p;
    for (int a = 0; a < D; ++a) {
      values[(Particles<D, T>::position + a) * chunk_size] =
          static_cast<T>(cells[p * std::size_t(D) + a] - at[p][a] * block_side<D>);
      values[(Particles<D, T>::velocity + a) * chunk_size] = static_cast<T>(seeds.velocity[p * std::size_t(D) + a]);
    }
  }
}

}  // namespace mpm::cpu
