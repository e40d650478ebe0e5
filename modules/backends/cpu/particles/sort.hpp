#pragma once
// A sort puts particles into blocks. Where each goes is found first, from positions alone. Particles that change their
// block travel in rows and take the places of those that left; the others stay where they are. A block is put in the
// order of its cells at first, and later where that will last: it is made anew, layer by layer, in chunks that blocks
// before it have left, so that a sort needs little memory beside the particles. Nothing depends on which thread does
// what.

#include <algorithm>
#include <array>
#include <bit>
#include <mutex>
#include <numeric>
#include <tuple>
#include <vector>

#include "backends/cpu/particles/sort_rows.hpp"

namespace mpm::cpu {

/// The place where one particle belongs: its stencil's first node and its position, from the old block's first node,
/// after wrapping.
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
      const double x = origin + static_cast<double>(position[axis * chunk_size<T> + lane]);
      to.wrap[axis] = -cells * static_cast<int>(std::floor(x / cells));
    }
    to.node[axis] = origin + base[axis * chunk_size<T> + lane] + to.wrap[axis];
    to.block[axis] = to.node[axis] >> block_bits<D>;
  }
  return to;
}

template <int D>
constexpr BlockCoordinates neighbour_at(BlockCoordinates at, int index) {
  for (int axis = D - 1; axis >= 0; --axis, index /= 3) at[axis] += index % 3 - 1;
  return at;
}

template <int D, class T>
class Sorter {
 public:
  Sorter(Particles<D, T>& particles, SortSpace& space, const Scene<D, T>& scene, bool with_motion,
         const Foresight<T>& foresight)
      : particles_(particles),
        space_(space),
        scene_(scene),
        foresight_(foresight),
        threads_(particles.blocks.size() < 32 ? 1 : scene.threads),
        row_(particles, with_motion),
        row_bytes_(row_.bytes()) {}

  bool run() {
    if (particles_.blocks.empty()) return false;  // emitters may have given the body nothing yet, sinks taken all
    space_.key.resize(std::max(space_.key.size(), std::size_t(particles_.chunks) * chunk_size<T>));
    space_.leaving.resize(std::max(space_.leaving.size(), std::size_t(particles_.chunks)));
    sources_.resize(particles_.blocks.size());
    find_keys();
    first_ = !in_units();
    if (!first_ && nothing_to_do()) return false;
    find_targets();
    const bool same = order_targets();
    move();
    finish();
    return !same;
  }

 private:
  static constexpr int here = neighbour_count<D> / 2;  ///< the block itself among its neighbours
  static constexpr std::uint16_t far_key = 0xffff;

  using Fetching = typename RowFormat<D, T>::Fetching;

  /// A block before the sort.
  struct Source {
    std::array<std::uint32_t, neighbour_count<D>> leavers{}, first_row{};
    std::uint32_t leaving = 0, far = 0;
    std::uint32_t changes = 0;  ///< particles in another cell than the one before
    int rows = 0;               ///< which rows its leavers are among
  };
  /// A block after the sort: the old ones have their old numbers, then come those that only receive.
  struct Target {
    BlockCoordinates at{};
    std::array<std::int32_t, neighbour_count<D>> around{};  ///< targets; -1 where there is none
    std::int32_t number = -1;                               ///< number among the blocks; -1 where it is empty
    std::uint32_t count = 0, incoming = 0;
    std::uint32_t first_far = 0, last_far = 0;
  };
  /// A particle that goes farther than to a neighbour, or round a periodic domain.
  struct Far {
    std::uint32_t slot, source, cell;
    std::int32_t target;
    BlockCoordinates to;
    int shift[D];
  };
  /// The change that the sort makes to a block.
  enum class Change { nothing, mended, anew };
  /// False before the first sort: the blocks of seeding have no units yet, though their particles may be in order.
  bool in_units() const {
    return std::any_of(particles_.units.begin(), particles_.units.end(), [](const auto& u) { return !u.empty(); });
  }

  /// Calls use(component) for each component that travels with a particle.
  template <class Use>
  void for_each_component(Use&& use) const {
    constexpr int gap = Particles<D, T>::velocity;
    for (int c = 0; c < gap; ++c) use(c);
    for (int c = gap + row_.left_behind(); c < particles_.components; ++c) use(c);
  }

  /// Calls visit(i, thread) for first <= i < last, `grain` neighbours at a time.
  template <class Visit>
  void for_each(std::size_t first, std::size_t last, std::size_t grain, Visit&& visit) {
    if (threads_ > 1) {
      scene_.team->for_each(last - first, grain, [&](std::size_t i, int thread) { visit(first + i, thread); });
    } else {
      for (std::size_t i = first; i < last; ++i) visit(i, 0);
    }
  }

  // ---- where to

  void find_keys() {
    for_each(0, sources_.size(), 8, [&](std::size_t b, int) {
      Source& source = sources_[b];
      source = {};
      for_each_chunk<T>(particles_.blocks[b],
                        [&](std::uint32_t chunk, int count) { find_keys_of(b, chunk, count, source); });
      source.leaving = std::accumulate(source.leavers.begin(), source.leavers.end(), 0u);
    });
  }

  void find_keys_of(int b, std::uint32_t chunk, int count, Source& source) {
    alignas(64) std::int32_t base[D * chunk_size<T>], around[chunk_size<T>], cell[chunk_size<T>], out[chunk_size<T>];
    const int end = padded(count);
    if (chunk + 1 < particles_.chunks) fetch(chunk + 1, 0, Particles<D, T>::velocity);
    first_nodes(particles_.blocks[b], chunk, count, base);
    for (int p = 0; p < end; ++p) around[p] = cell[p] = out[p] = 0;
    for (int axis = 0; axis < D; ++axis) {
      const std::int32_t* const node = base + axis * chunk_size<T>;
      for (int p = 0; p < end; ++p) {
        const std::int32_t d = (node[p] >> block_bits<D>)+1;
        out[p] |= (d < 0) | (d > 2);
        around[p] = around[p] * 3 + d;
        cell[p] = (cell[p] << block_bits<D>) | (node[p] & (block_side<D> - 1));
      }
      if (!scene_.domain.periodic(axis)) continue;
      const double origin = particles_.blocks[b].at[axis] * block_side<D>, cells = scene_.domain.cells[axis];
      const T* const x = particles_.chunk(chunk) + axis * chunk_size<T>;
      for (int p = 0; p < end; ++p) {
        const double from_corner = origin + static_cast<double>(x[p]);
        out[p] |= (from_corner < 0) | (from_corner >= cells);
      }
    }
    std::uint16_t* const key = space_.key.data() + std::size_t(chunk) * chunk_size<T>;
    std::int32_t elsewhere = 0, changes = 0;
    for (int p = 0; p < count; ++p) {
      key[p] = out[p] ? far_key : static_cast<std::uint16_t>(around[p] * block_nodes + cell[p]);
      elsewhere |= key[p] / block_nodes != here;
    }
    for (int p = 1; p < count; ++p) changes += key[p] != key[p - 1];
    source.changes += changes;
    std::uint64_t& leaving = space_.leaving[chunk];
    leaving = 0;
    if (!elsewhere) return;
    for (int p = 0; p < count; ++p) leaving |= std::uint64_t(key[p] / block_nodes != here) << p;
    for_each_leaver(chunk,
                    [&](int lane) { ++(key[lane] == far_key ? source.far : source.leavers[key[lane] / block_nodes]); });
  }

  /// Calls use(lane) for each particle of a chunk that leaves its block.
  template <class Use>
  void for_each_leaver(std::uint32_t chunk, Use&& use) const {
    for (std::uint64_t left = space_.leaving[chunk]; left != 0; left &= left - 1) use(std::countr_zero(left));
  }

  /// Finds where a chunk's particles, inside the domain as now, will be in the middle of their way; see Foresight.
  void look_ahead(const Block<D>& block, const T* position, int count, T* ahead) const {
    using L = Lanes<T>;
    alignas(64) std::int32_t around[chunk_size<T>], node[chunk_size<T>];
    const int end = padded(count);
    for (int p = 0; p < end; ++p) around[p] = node[p] = 0;
    for (int axis = 0; axis < D; ++axis)
      for (int p = 0; p < end; ++p) {
        const std::int32_t nearest = static_cast<std::int32_t>(std::floor(position[axis * chunk_size<T> + p] + T(0.5)));
        around[p] = around[p] * 3 + (nearest >> block_bits<D>)+1;
        node[p] = (node[p] << block_bits<D>) | (nearest & (block_side<D> - 1));
      }
    for (int p = 0; p < end; ++p) {
      const T* const v = foresight_.velocities + (std::size_t(block.neighbours[around[p]]) * block_nodes + node[p]) * 4;
      for (int axis = 0; axis < D; ++axis) ahead[axis * chunk_size<T> + p] = v[axis];
    }
    const L least(-foresight_.farthest), most(foresight_.farthest);
    for (int axis = 0; axis < D; ++axis) {
      const T origin = static_cast<T>(block.at[axis] * block_side<D>);
      const L lower(-origin), upper(scene_.domain.cells[axis] - origin);
      for (int p = 0; p < end; p += L::width) {
        const L x = L::load(position + axis * chunk_size<T> + p);
        T* const to = ahead + axis * chunk_size<T> + p;
        const L way = max(least, min(most, foresight_.cells_a_velocity * L::load(to)));
        max(min(x, lower), min(max(x, upper), x + way)).store(to);
      }
    }
  }

  void first_nodes(const Block<D>& block, std::uint32_t chunk, int count, std::int32_t* base) const {
    if (scene_.list) {  // the middle of the list's nodes comes to the middle of the tile
      for (int axis = 0; axis < D; ++axis)
        for (int p = 0; p < padded(count); ++p)
          base[axis * chunk_size<T> + p] =
              static_cast<std::int32_t>(std::floor(particles_.chunk(chunk)[axis * chunk_size<T> + p] - T(0.5)));
      return;
    }
    alignas(64) T offset[D * chunk_size<T>], weight[D * 4 * chunk_size<T>], ahead[D * chunk_size<T>];
    if (foresight_.velocities) look_ahead(block, particles_.chunk(chunk), count, ahead);
    const T* const domain =
        particles_.domain < 0 ? nullptr : particles_.chunk(chunk) + particles_.domain * chunk_size<T>;
    const mpm_shape_batch batch{static_cast<std::uint32_t>(padded(count)),
                                chunk_size<T>,
                                D,
                                0,
                                foresight_.velocities ? ahead : particles_.chunk(chunk),
                                scene_.half_size ? particles_.half_size.data() : nullptr,
                                domain,
                                base,
                                offset,
                                weight,
                                nullptr,
                                nullptr};
    scene_.evaluate_shape(scene_.shape_parameters, &batch);
  }

  bool nothing_to_do() const {
    for (std::uint32_t b = 0; b < sources_.size(); ++b)
      if (sources_[b].leaving + sources_[b].far > 0 || wants_order(b, 0)) return false;
    return true;
  }

  // ---- blocks

  void find_targets() {
    const std::uint32_t old = static_cast<std::uint32_t>(sources_.size());
    targets_.resize(old);
    table_ = BlockTable(old + old / 8);
    for (std::uint32_t b = 0; b < old; ++b) {
      const Block<D>& block = particles_.blocks[b];
      targets_[b].at = block.at;
      targets_[b].count = block.count - sources_[b].leaving - sources_[b].far;
      targets_[b].around.fill(-1);
      table_.insert(block.at, static_cast<int>(b));
    }
    first_ ? look_around_by_place() : look_around_by_slot();
    for (std::uint32_t b = 0; b < old; ++b) {
      if (sources_[b].leaving == 0) continue;
      for (int k = 0; k < neighbour_count<D>; ++k) {
        const std::uint32_t leavers = sources_[b].leavers[k];
        if (leavers == 0) continue;
        std::int32_t to = targets_[b].around[k];
        if (to < 0) to = target_at(neighbour_at<D>(targets_[b].at, k));
        targets_[to].count += leavers;
        targets_[to].incoming += leavers;
      }
    }
    find_far();
    for (std::size_t b = old; b < targets_.size(); ++b)
      for (int k = 0; k < neighbour_count<D>; ++k)
        targets_[b].around[k] = table_.find(neighbour_at<D>(targets_[b].at, k));
  }

  /// Finds neighbours by the slots of the grid, which has been built around the blocks as they are.
  void look_around_by_slot() {
    const int old = static_cast<int>(sources_.size());
    std::int32_t slots = 0;
    for (const Block<D>& block : particles_.blocks) slots = std::max(slots, block.neighbours[here] + 1);
    std::vector<std::int32_t> in_slot(slots, -1);
    for (int b = 0; b < old; ++b) in_slot[particles_.blocks[b].neighbours[here]] = b;
    for (int b = 0; b < old; ++b)
      for (int k = 0; k < neighbour_count<D>; ++k) {
        const std::int32_t slot = particles_.blocks[b].neighbours[k];
        if (slot < slots) targets_[b].around[k] = in_slot[slot];
      }
  }

  /// Finds neighbours before there is a grid, two at once: each entry is written by one thread.
  void look_around_by_place() {
    for_each(0, sources_.size(), 8, [&](std::size_t b, int) {
      targets_[b].around[here] = b;
      for (int k = 0; k < here; ++k) {
        const int found = table_.find(neighbour_at<D>(targets_[b].at, k));
        targets_[b].around[k] = found;
        if (found >= 0) targets_[found].around[neighbour_count<D> - 1 - k] = b;
      }
    });
  }

  int target_at(const BlockCoordinates& at) {
    const int next = static_cast<int>(targets_.size()), number = table_.insert(at, next);
    if (number == next) targets_.emplace_back().at = at;
    return number;
  }

  /// Finds particles that go far, by target and each in the old order.
  void find_far() {
    alignas(64) std::int32_t base[D * chunk_size<T>];
    for (std::uint32_t b = 0; b < sources_.size(); ++b) {
      if (sources_[b].far == 0) continue;
      const Block<D>& block = particles_.blocks[b];
      for_each_chunk<T>(block, [&](std::uint32_t chunk, int count) {
        const std::uint32_t first = chunk * chunk_size<T>;
        first_nodes(block, chunk, count, base);
        for (int lane = 0; lane < count; ++lane) {
          if (space_.key[first + lane] != far_key) continue;
          const auto to = destination<D, T>(scene_.domain, block, base, particles_.chunk(chunk), lane);
          Far far{first + lane,        b,        static_cast<std::uint32_t>(node_in_block<D>(to.node)),
                  target_at(to.block), to.block, {}};
          for (int a = 0; a < D; ++a) far.shift[a] = (block.at[a] - to.block[a]) * block_side<D> + to.wrap[a];
          far_.push_back(far);
        }
      });
    }
    std::sort(far_.begin(), far_.end(),
              [](const Far& a, const Far& b) { return std::tie(a.target, a.slot) < std::tie(b.target, b.slot); });
    for (std::uint32_t i = 0; i < far_.size(); ++i) {
      Target& target = targets_[far_[i].target];
      if (target.last_far == 0) target.first_far = i;
      target.last_far = i + 1;
      ++target.count, ++target.incoming;
    }
  }

  /// Orders blocks by columns of two along x (and of two along y in 3-D), one colour in each direction out of two.
  static std::array<int, 4> order_key(const BlockCoordinates& at) {
    if constexpr (D == 2) return {(at[0] >> 1) & 1, at[0] >> 1, 0, at[1] * 2 + (at[0] & 1)};
    return {((at[0] >> 1) & 1) | ((at[1] >> 1) & 1) * 2, at[0] >> 1, at[1] >> 1,
            at[2] * 4 + (at[0] & 1) * 2 + (at[1] & 1)};
  }

  /// Numbers the blocks; returns whether they are the old ones.
  bool order_targets() {
    const std::size_t old = sources_.size();
    std::vector<std::pair<std::array<int, 4>, std::uint32_t>> order;
    order.reserve(targets_.size());
    for (std::uint32_t i = 0; i < targets_.size(); ++i)
      if (targets_[i].count > 0) order.push_back({order_key(targets_[i].at), i});
    // Old blocks are in order already, except those of seeding.
    if (!std::is_sorted(order.begin(), order.end())) std::sort(order.begin(), order.end());
    bool same = order.size() == old;
    for (auto& units : particles_.units) units.clear();
    const std::array<int, 4>* last = nullptr;
    for (const auto& [key, number] : order) {
      auto& units = particles_.units[key[0]];
      const std::uint32_t index = static_cast<std::uint32_t>(blocks_.size());
      if (!last || !std::equal(key.begin(), key.begin() + 3, last->begin())) units.push_back({index, index});
      units.back().last = index + 1;
      last = &key;

      same = same && number == index;
      Block<D>& block = blocks_.emplace_back();
      block.at = targets_[number].at;
      block.first_chunk = chunks_;
      block.count = targets_[number].count;
      if (number < old) {
        block.neighbours = particles_.blocks[number].neighbours;
        block.may_meet = particles_.blocks[number].may_meet;  // where no block comes or goes the grid is not built anew
      }
      targets_[number].number = static_cast<std::int32_t>(index);
      chunks_ += chunks_of(block.count);
    }
    particles_.order = ordered_units<D>(particles_.units, blocks_, scene_.threads);
    return same;
  }
  static std::uint32_t chunks_of(std::uint32_t particles) { return (particles + chunk_size<T> - 1) / chunk_size<T>; }

  // ---- moving

  /// Whether a block is worth the order of its cells: its particles lie scattered, cells hold so many that neighbours
  /// will share their stencils (ParticleStep::number_stencils), and few come and go, so that the order will last.
  bool wants_order(std::uint32_t b, std::uint32_t incoming) const {
    const Source& source = sources_[b];
    const std::uint32_t count = particles_.blocks[b].count;
    if (4 * source.changes <= count || 8 * (source.leaving + source.far + incoming) > count) return false;
    std::uint64_t cells = 0;
    for_each_chunk<T>(particles_.blocks[b], [&](std::uint32_t chunk, int lanes) {
      const std::uint16_t* const key = space_.key.data() + std::size_t(chunk) * chunk_size<T>;
      for (int lane = 0; lane < lanes; ++lane) cells |= std::uint64_t(1) << key[lane] % block_nodes;
    });
    return 4 * static_cast<std::uint32_t>(std::popcount(cells)) <= count;
  }

  Change change_of(std::uint32_t target) const {
    if (first_ || target >= sources_.size()) return Change::anew;
    const std::uint32_t incoming = targets_[target].incoming;
    if (wants_order(target, incoming)) return Change::anew;
    return sources_[target].leaving + sources_[target].far + incoming == 0 ? Change::nothing : Change::mended;
  }

  /// Divides blocks into layers across the axis along which there are most.
  void make_layers() {
    BlockCoordinates low = targets_[0].at, high = low;
    for (const Target& target : targets_)
      for (int a = 0; a < D; ++a) low[a] = std::min(low[a], target.at[a]), high[a] = std::max(high[a], target.at[a]);
    int axis = 0;
    for (int a = 1; a < D; ++a)
      if (high[a] - low[a] > high[axis] - low[axis]) axis = a;
    in_layers_.resize(targets_.size());
    std::iota(in_layers_.begin(), in_layers_.end(), 0u);
    std::stable_sort(in_layers_.begin(), in_layers_.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return targets_[a].at[axis] < targets_[b].at[axis]; });
    // Layers are few and thick, as threads meet after each and rows of three are held at once.
    const std::size_t thick = in_layers_.size() / 16;
    for (std::uint32_t i = 0; i < in_layers_.size(); ++i) {
      const bool begins = i == 0 || targets_[in_layers_[i]].at[axis] != targets_[in_layers_[i - 1]].at[axis];
      if (begins && (i == 0 || i - layers_.back() >= thick)) layers_.push_back(i);
    }
    layers_.push_back(static_cast<std::uint32_t>(in_layers_.size()));
  }

  /// Moves the particles: a layer takes what the three layers around it have sent, and leaves its old chunks.
  void move() {
    make_layers();
    reserve_chunks();
    places_.resize(chunks_);
    send_far();
    const int n = static_cast<int>(layers_.size()) - 1;
    send(0);
    for (int layer = 0; layer < n; ++layer) {
      if (layer + 1 < n) send(layer + 1);
      for_each(layers_[layer], layers_[layer + 1], 4,
               [&](std::size_t i, int thread) { receive(in_layers_[i], first_chunk(i + 1), thread); });
    }
  }

  /// Reserves chunks so that no thread allocates: within a layer blocks grow before others have shrunk, and threads
  /// keep chunks at hand.
  void reserve_chunks() {
    std::int64_t taken = 0, most = 0;
    std::size_t largest = 0;
    for (std::size_t layer = 0; layer + 1 < layers_.size(); ++layer) {
      std::int64_t left = 0;
      for (std::uint32_t i = layers_[layer]; i < layers_[layer + 1]; ++i) {
        const std::uint32_t target = in_layers_[i];
        const std::int64_t now = target < sources_.size() ? chunks_of(particles_.blocks[target].count) : 0;
        const std::int64_t then = chunks_of(targets_[target].count);
        (then > now ? taken : left) += std::abs(then - now);
        largest = std::max(largest, static_cast<std::size_t>(std::max(now, then)));
      }
      most = std::max(most, taken);
      taken -= left;
    }
    particles_.pool.reserve(static_cast<std::size_t>(most) + 4 * largest * threads_);
    space_.unused.resize(std::max(space_.unused.size(), std::size_t(threads_)));
    for (auto& unused : space_.unused) unused.reserve(4 * largest);
    at_hand_ = 2 * largest;
    space_.nowhere.resize(std::max(space_.nowhere.size(), std::size_t(threads_)));
    for (auto& chunk : space_.nowhere) chunk.require(particles_.chunk_bytes());
  }

  /// Writes the rows of a layer's blocks, those for one neighbour side by side.
  void send(int layer) {
    AlignedArray<std::byte>& rows = space_.rows[layer % 3];
    std::size_t count = 0;
    const int first = static_cast<int>(layers_[layer]), last = static_cast<int>(layers_[layer + 1]);
    for (int i = first; i < last; ++i) {
      if (in_layers_[i] >= sources_.size()) continue;
      Source& source = sources_[in_layers_[i]];
      for (int k = 0; k < neighbour_count<D> && source.leaving > 0; ++k) {
        source.first_row[k] = static_cast<std::uint32_t>(count);
        count += source.leavers[k];
      }
      source.rows = layer % 3;
    }
    if (rows.bytes() < count * row_bytes_) rows.require(count * row_bytes_ * 9 / 8);
    for_each(first, last, 4, [&](std::size_t i, int) {
      if (in_layers_[i] < sources_.size() && sources_[in_layers_[i]].leaving > 0)
        send_block(in_layers_[i], rows.data(), first_chunk(i + 1));
    });
  }

  /// The first chunk of the old block at a place among the layers; beyond the last chunk where there is none.
  std::uint32_t first_chunk(int i) const {
    const bool exists = i < static_cast<int>(in_layers_.size()) && in_layers_[i] < sources_.size();
    return exists ? particles_.blocks[in_layers_[i]].first_chunk : particles_.chunks;
  }
  /// The chunk to fetch along with the work on a chunk of a block, after which `next_block` comes.
  Fetching fetch_after(const Block<D>& block, std::uint32_t chunk, std::uint32_t next_block) const {
    const std::uint32_t following = chunk + 1 < block.first_chunk + chunks_of(block.count) ? chunk + 1 : next_block;
    return following < particles_.chunks ? Fetching(row_, following, std::popcount(space_.leaving[chunk])) : Fetching();
  }

  void send_block(std::uint32_t b, std::byte* rows, std::uint32_t next_block) {
    std::array<std::uint32_t, neighbour_count<D>> next = sources_[b].first_row;
    for_each_chunk<T>(particles_.blocks[b], [&](std::uint32_t chunk, int) {
      const std::uint16_t* const key = space_.key.data() + std::size_t(chunk) * chunk_size<T>;
      Fetching following = fetch_after(particles_.blocks[b], chunk, next_block);
      for_each_leaver(chunk, [&](int lane) {
        following.go_on();
        if (key[lane] == far_key) return;
        const int k = key[lane] / block_nodes;
        const BlockCoordinates d = neighbour_at<D>({}, k);
        int shift[D];
        for (int a = 0; a < D; ++a) shift[a] = -d[a] * block_side<D>;
        row_.write(rows + next[k]++ * row_bytes_, chunk, lane, key[lane] % block_nodes, shift);
      });
    });
  }

  void send_far() {
    if (space_.far_rows.size() < far_.size() * row_bytes_) space_.far_rows.resize(far_.size() * row_bytes_);
    for (std::size_t i = 0; i < far_.size(); ++i)
      row_.write(space_.far_rows.data() + i * row_bytes_, far_[i].slot / chunk_size<T>,
                 static_cast<int>(far_[i].slot % chunk_size<T>), far_[i].cell, far_[i].shift);
  }

  /// The rows that a neighbour has sent to a target.
  struct Sent {
    std::int32_t source;
    const std::byte *first, *last;
  };
  struct Incoming {
    std::array<Sent, neighbour_count<D>> sent;  ///< in the order of their blocks; the block itself sends no rows
    int count = 0;
  };
  Incoming incoming(std::uint32_t target) const {
    Incoming all;
    for (int k = 0; k < neighbour_count<D>; ++k) {  // the neighbour on the other side sends towards k
      const std::int32_t from = targets_[target].around[neighbour_count<D> - 1 - k];
      if (from < 0 || from >= static_cast<std::int32_t>(sources_.size())) continue;
      const Source& source = sources_[from];
      if (k != here && source.leavers[k] == 0) continue;
      const std::byte* const rows = space_.rows[source.rows].data();
      const std::size_t first = source.first_row[k], last = first + source.leavers[k];
      all.sent[all.count++] =
          k == here ? Sent{from, nullptr, nullptr} : Sent{from, rows + first * row_bytes_, rows + last * row_bytes_};
    }
    std::sort(all.sent.begin(), all.sent.begin() + all.count,
              [](const Sent& a, const Sent& b) { return a.source < b.source; });
    return all;
  }

  void receive(std::uint32_t number, std::uint32_t next_block, int thread) {
    const Target& target = targets_[number];
    std::vector<std::byte*>& unused = space_.unused[thread];
    const bool existed = number < sources_.size();
    const std::uint32_t had = existed ? chunks_of(particles_.blocks[number].count) : 0;
    std::uint32_t kept = 0;  // number of chunks
    if (target.number >= 0) {
      const Block<D>& block = blocks_[target.number];
      const std::uint32_t has = chunks_of(block.count);
      std::byte** const places = places_.data() + block.first_chunk;
      const Change change = change_of(number);
      if (change != Change::anew) kept = std::min(had, has);
      for (std::uint32_t i = 0; i < has; ++i)
        places[i] = i < kept ? particles_.places[particles_.blocks[number].first_chunk + i] : take(unused);
      if (change == Change::mended) mend(number, next_block);
      if (change == Change::anew) fill(number, thread);
    }
    for (std::uint32_t i = kept; i < had; ++i)
      give(unused, particles_.places[particles_.blocks[number].first_chunk + i]);
  }

  std::byte* take(std::vector<std::byte*>& unused) {
    std::byte* chunk = nullptr;
    if (!unused.empty()) {
      chunk = unused.back();
      unused.pop_back();
    } else {
      const std::lock_guard lock(pool_mutex_);
      chunk = particles_.pool.take();
    }
    return chunk;
  }
  void give(std::vector<std::byte*>& unused, std::byte* chunk) {
    if (unused.size() < at_hand_) return unused.push_back(chunk);
    const std::lock_guard lock(pool_mutex_);
    particles_.pool.give(chunk);
  }

  /// Slots of a block that nobody holds any more, in order: those of its leavers, then those beyond its end.
  class Holes {
   public:
    Holes(const Sorter& sorter, const Block<D>& block, std::uint32_t next_block)
        : sorter_(sorter),
          block_(block),
          next_block_(next_block),
          end_(block.count),
          left_(sorter.space_.leaving[block.first_chunk]),
          following_(sorter.fetch_after(block, block.first_chunk, next_block)) {}
    std::uint32_t next() {
      while (left_ == 0) {
        if ((chunk_ + 1) * chunk_size<T> >= block_.count) return end_++;
        left_ = sorter_.space_.leaving[block_.first_chunk + ++chunk_];
        following_ = sorter_.fetch_after(block_, block_.first_chunk + chunk_, next_block_);
      }
      following_.go_on();
      const int lane = std::countr_zero(left_);
      left_ &= left_ - 1;
      return chunk_ * chunk_size<T> + lane;
    }

   private:
    const Sorter& sorter_;
    const Block<D>& block_;
    std::uint32_t next_block_, chunk_ = 0, end_;
    std::uint64_t left_;
    Fetching following_;
  };

  /// Puts particles that come into the places of those that left; where more leave than come, the last fill up.
  void mend(std::uint32_t number, std::uint32_t next_block) {
    const Target& target = targets_[number];
    const Block<D>&old = particles_.blocks[number], &block = blocks_[target.number];
    Holes holes(*this, old, next_block);
    const Incoming from = incoming(number);
    for (int i = 0; i < from.count; ++i)
      for (const std::byte* row = from.sent[i].first; row != from.sent[i].last; row += row_bytes_)
        read_row(block, row, holes.next());
    for (std::uint32_t i = target.first_far; i < target.last_far; ++i)
      read_row(block, space_.far_rows.data() + i * row_bytes_, holes.next());
    for (std::uint32_t slot = block.count; slot < old.count; ++slot) {
      const std::uint32_t chunk = old.first_chunk + slot / chunk_size<T>, lane = slot % chunk_size<T>;
      if (!(space_.leaving[chunk] >> lane & 1)) copy(chunk, static_cast<int>(lane), block, holes.next());
    }
    fill_tail(particles_, block.count, places_[block.first_chunk + (block.count - 1) / chunk_size<T>]);
  }

  void copy(std::uint32_t chunk, int lane, const Block<D>& block, std::uint32_t to) {
    std::byte* const place = places_[block.first_chunk + to / chunk_size<T>];
    const T* const values = particles_.chunk(chunk) + lane;
    T* const target = particles_.values_at(place) + to % chunk_size<T>;
    for_each_component([&](int c) { target[c * chunk_size<T>] = values[c * chunk_size<T>]; });
    particles_.ids_at(place)[to % chunk_size<T>] = particles_.ids(chunk)[lane];
  }

  /// Makes a block anew, in the order of (cell, old order).
  void fill(std::uint32_t number, int thread) {
    const Target& target = targets_[number];
    const Block<D>& block = blocks_[target.number];
    const Incoming from = incoming(number);
    const bool existed = number < sources_.size();
    std::uint32_t place[block_nodes + 1] = {};  // place of the next particle of a cell
    for (int i = 0; i < from.count; ++i)
      for (const std::byte* row = from.sent[i].first; row != from.sent[i].last; row += row_bytes_)
        ++place[row_.tail(row).cell + 1];
    for (std::uint32_t i = target.first_far; i < target.last_far; ++i) ++place[far_[i].cell + 1];
    if (existed) count_stayers(particles_.blocks[number], place + 1);
    for (int cell = 0; cell < block_nodes; ++cell) place[cell + 1] += place[cell];

    std::uint32_t far = target.first_far;
    const auto take_far_before = [&](std::uint32_t slot) {
      for (; far < target.last_far && far_[far].slot < slot; ++far)
        read_row_of_cell(block, space_.far_rows.data() + far * row_bytes_, place);
    };
    for (int i = 0; i < from.count; ++i) {
      const Sent& sent = from.sent[i];
      if (sent.source == static_cast<std::int32_t>(number))
        take_stayers(particles_.blocks[number], block, place, take_far_before, thread);
      for (const std::byte* row = sent.first; row != sent.last; row += row_bytes_) {
        take_far_before(row_.tail(row).slot);
        read_row_of_cell(block, row, place);
      }
    }
    take_far_before(~0u);
    fill_tail(particles_, block.count, places_[block.first_chunk + (block.count - 1) / chunk_size<T>]);
  }

  void count_stayers(const Block<D>& block, std::uint32_t* counts) const {
    for_each_chunk<T>(block, [&](std::uint32_t chunk, int count) {
      const std::uint16_t* const key = space_.key.data() + std::size_t(chunk) * chunk_size<T>;
      for (int lane = 0; lane < count; ++lane)
        if (key[lane] / block_nodes == here) ++counts[key[lane] % block_nodes];
    });
  }

  void read_row_of_cell(const Block<D>& block, const std::byte* row, std::uint32_t* place) {
    read_row(block, row, place[row_.tail(row).cell]++);
  }
  void read_row(const Block<D>& block, const std::byte* row, std::uint32_t to) {
    row_.read(row, places_[block.first_chunk + to / chunk_size<T>], to % chunk_size<T>);
  }

  /// Copies component by component, so that an old chunk is read in its own order; what leaves goes where nobody looks.
  template <class TakeFar>
  void take_stayers(const Block<D>& left, const Block<D>& block, std::uint32_t* place, TakeFar&& take_far_before,
                    int thread) {
    T* to[chunk_size<T>];
    std::int32_t* id_to[chunk_size<T>];
    std::byte* const nowhere = space_.nowhere[thread].data();
    for_each_chunk<T>(left, [&](std::uint32_t chunk, int count) {
      const std::uint16_t* const key = space_.key.data() + std::size_t(chunk) * chunk_size<T>;
      prefetch(chunk + 1);
      for (int lane = 0; lane < chunk_size<T>; ++lane) {
        std::byte* target = nowhere;
        std::uint32_t at = static_cast<std::uint32_t>(lane);
        if (lane < count && key[lane] / block_nodes == here) {
          take_far_before(chunk * chunk_size<T> + lane);
          at = place[key[lane] % block_nodes]++;
          target = places_[block.first_chunk + at / chunk_size<T>];
        }
        to[lane] = particles_.values_at(target) + at % chunk_size<T>;
        id_to[lane] = particles_.ids_at(target) + at % chunk_size<T>;
      }
      for_each_component([&](int c) {
        const T* const from = particles_.chunk(chunk) + c * chunk_size<T>;
#pragma GCC unroll 16
        for (int lane = 0; lane < chunk_size<T>; ++lane) to[lane][c * chunk_size<T>] = from[lane];
      });
      for (int lane = 0; lane < count; ++lane) *id_to[lane] = particles_.ids(chunk)[lane];
    });
  }
  void prefetch(std::uint32_t chunk) const {
    if (chunk >= particles_.chunks) return;
    fetch(chunk, 0, Particles<D, T>::velocity);
    fetch(chunk, Particles<D, T>::velocity + row_.left_behind(), particles_.components + 1);
  }
  /// Fetches components of a chunk, after the last of which its indices lie.
  void fetch(std::uint32_t chunk, int first, int last) const {
    constexpr std::size_t component = chunk_size<T> * sizeof(T);
    const std::size_t end = std::min(last * component, particles_.chunk_bytes());
    for (std::size_t byte = first * component; byte < end; byte += 64)
      __builtin_prefetch(particles_.places[chunk] + byte, 1, 2);
  }

  void finish() {
    for (auto& unused : space_.unused) {
      for (std::byte* const chunk : unused) particles_.pool.give(chunk);
      unused.clear();
    }
    particles_.places.swap(places_);
    particles_.blocks.swap(blocks_);
    particles_.chunks = chunks_;
  }

  Particles<D, T>& particles_;
  SortSpace& space_;
  const Scene<D, T>& scene_;
  const Foresight<T> foresight_;
  int threads_;
  std::mutex pool_mutex_;
  bool first_ = false;  ///< this is the first sort of these particles
  const RowFormat<D, T> row_;
  std::size_t row_bytes_, at_hand_ = 0;
  std::vector<Source> sources_;
  std::vector<Target> targets_;
  std::vector<Far> far_;
  BlockTable table_;
  std::vector<std::uint32_t> in_layers_, layers_;
  std::vector<Block<D>> blocks_;
  std::vector<std::byte*> places_;
  std::uint32_t chunks_ = 0;
};

template <int D, class T>
bool sort_particles(Particles<D, T>& particles, SortSpace& space, const Scene<D, T>& scene, bool with_motion,
                    const Foresight<T>& foresight) {
  return Sorter<D, T>(particles, space, scene, with_motion, foresight).run();
}

}  // namespace mpm::cpu

/// What instantiation.cpp.in makes of seeding.hpp and this header for every dimension and scalar.
#define MPM_INSTANTIATE_SORT(D, T)                                                        \
  template void seed_particles<D, T>(Particles<D, T>&, const SeededBody&, const Domain&); \
  template bool sort_particles<D, T>(Particles<D, T>&, SortSpace&, const Scene<D, T>&, bool, const Foresight<T>&);
