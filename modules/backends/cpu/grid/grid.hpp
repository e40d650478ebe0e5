#pragma once
// The sparse grid holds blocks of nodes near particles, planned channels of one quad a node, and the lists of nodes at
// the edges.

#include <cstdint>
#include <vector>

#include "backends/cpu/aligned_array.hpp"
#include "backends/cpu/grid/channels.hpp"
#include "backends/cpu/particles/particles.hpp"
#include "backends/cpu/scene.hpp"

namespace mpm::cpu {

/// A node beyond a wall (or an image of a periodic node) and the node it is folded onto.
struct MirrorPair {
  std::uint32_t ghost, mirror;
  std::uint32_t ghost_edge, mirror_edge;  ///< the same nodes among the edge nodes
  Vector3 foot;                           ///< foot of the ghost on the wall, m
  double distance;                        ///< distance of the ghost from the wall, m
};

/// The nodes that one face of the domain concerns.
struct FaceNodes {
  int axis = 0, side = 0;
  const FaceCondition* condition = nullptr;
  std::vector<MirrorPair> pairs;
  std::vector<std::uint32_t> wall;
  std::vector<std::uint32_t> wall_edge;  ///< the same among the edge nodes, or ~0
  std::vector<Vector3> wall_position;
  std::vector<std::uint8_t> pair_folds;  ///< decided in each step: [field * pairs + i]
  std::vector<double> folded_mass;       ///< kg, of the ghosts when folded, indexed likewise; for reactions only
  std::vector<double> folded_capacity;   ///< J/K, of the ghosts when folded, indexed likewise; with temperature only

  bool periodic() const { return condition->type == ConditionType::periodic; }
};
struct BoxNodes {
  const BoxCondition* condition = nullptr;
  int support = 0;
  std::vector<std::uint32_t> nodes;
  std::vector<Vector3> position;
};

template <int D, class T>
class Grid {
 public:
  explicit Grid(const Scene<D, T>& scene)
      : scene_(scene), fields_(scene.experiment.field_count), next_motion_(channel_of(scene.plan, "next_momentum")) {
    for (const Field* const field : channel_fields(scene.plan)) channels_.emplace_back().field = field;
  }

  Channel channels() const { return static_cast<Channel>(channels_.size()); }
  const Field& field(Channel channel) const { return *channels_[channel].field; }
  bool has(Channel channel) const { return channel >= 0 && !channels_[channel].rests; }
  /// Lets what only the ledger reads rest or wake: at rest it keeps its memory, but nothing writes or reads it.
  void let_ledger_rest(bool rests) {
    if (rests == ledger_rests_) return;
    ledger_rests_ = rests;
    for (Stored& channel : channels_) channel.rests = rests && channel.field->for_ledger;
  }
  bool ledger_rests() const { return ledger_rests_; }
  int fields() const { return fields_; }
  std::uint32_t slots() const { return static_cast<std::uint32_t>(found_.size()); }
  std::uint32_t nodes() const { return slots() * block_nodes; }

  T* channel(Channel c, int field) { return channels_[c].data.data() + std::size_t(field) * nodes() * 4; }
  Quad<T>& quad(Channel c, int field, std::uint32_t node) {
    return reinterpret_cast<Quad<T>*>(channel(c, field))[node];
  }

  /// Finds the active blocks: those of particles, their neighbours (and what their lists reach), and what folding
  /// needs; field_bits of a slot says which velocity fields may have mass there.
  /// With `keeps`, what a gather may read keeps its values where blocks stay, and gets zeros elsewhere; all else holds
  /// anything afterwards.
  void rebuild(std::vector<Particles<D, T>>& bodies, const std::vector<int>& field_of_body, bool keeps = false);
  /// Whether a slot's nodes may have mass of a velocity field. Where they have none all channels hold zero.
  bool may_have_mass(int field, std::size_t slot) const { return (field_bits_[slot] >> field & 1) != 0; }
  /// Sets to zero what is scattered in a step.
  void clear();
  void clear(Channel c);
  /// The largest component of all nodes and fields, along any axis.
  T largest_component(Channel c) const;
  void swap(Channel a, Channel b) { std::swap(channels_[a].data, channels_[b].data); }

  /// The number of a node from its coordinates; -1 where no block is active.
  std::int32_t find(const std::array<int, 3>& node) const {
    BlockCoordinates at{};
    for (int a = 0; a < D; ++a) at[a] = node[a] >> block_bits<D>;
    const int slot = table_.find(at);
    return slot < 0 ? -1 : slot * block_nodes + node_in_block<D>(node);
  }

  std::array<int, 3> coordinates_of(std::uint32_t node) const {
    return node_at<D>(found_[node / block_nodes], static_cast<int>(node % block_nodes));
  }
  Vector3 position_of(std::uint32_t node) const { return scene_.domain.node_position(coordinates_of(node), D); }

  std::vector<FaceNodes>& faces() { return faces_; }
  const std::vector<BoxNodes>& boxes() const { return boxes_; }
  /// The ghosts and the nodes they are folded onto.
  const std::vector<std::uint32_t>& edge_nodes() const { return edge_nodes_; }
  /// The slots where two fields or more may meet.
  const std::vector<std::uint32_t>& shared_slots() const { return shared_; }
  std::uint64_t bytes() const {
    std::uint64_t total = renumbered_.bytes();
    for (const Stored& channel : channels_) total += channel.data.bytes();
    return total;
  }

 private:
  struct Stored {
    const Field* field = nullptr;
    AlignedArray<T> data;
    bool rests = false;
  };
  int activate(const BlockCoordinates& at, std::uint64_t field_bits);
  template <class Visit>
  static void for_each_block_around(const BlockCoordinates& at, const std::array<int, 3>& low,
                                    const std::array<int, 3>& high, Visit&& visit);
  template <class Visit>
  void for_each_image(std::size_t slot, Visit&& visit) const;
  void activate_mirrors();
  void mark_blocks_that_may_meet(std::vector<Particles<D, T>>& bodies);
  void spread(std::vector<char>& marked, bool to_images) const;
  void clear_where_no_field_is();
  /// Whether nodes that no two bodies are near hold zero. Weight beyond walls corrects forces, wherever these are kept.
  static bool is_near_others_alone(const Field& field) {
    return field.for_contact && field.folded == Folded::with_mass;
  }
  void renumber(Channel channel, const std::vector<BlockCoordinates>& blocks_before,
                const std::vector<std::int32_t>& slot_now);
  void list_faces();
  void number_edge_nodes();
  void list_boxes();
  bool may_touch(const BoxCondition& box, const BlockCoordinates& at) const;
  int image(int axis, int node) const {
    return image_of(node, scene_.domain.cells[axis], scene_.domain.periodic(axis));
  }
  /// Whether no node of such a block is on or beyond a wall of this axis.
  bool inside(int axis, int block) const {
    return block > 0 && (block + 1) * block_side<D> <= scene_.domain.cells[axis];
  }
  /// On periodic axes lists may reach a cell farther, as particles are wrapped only when they are sorted.
  int padding(int axis) const { return scene_.padding + (scene_.list && scene_.domain.periodic(axis) ? 2 : 0); }
  bool folded_axis(int axis, int side) const { return has_images(scene_.domain.faces[axis][side]); }

  const Scene<D, T>& scene_;
  int fields_;
  Channel next_motion_;
  bool ledger_rests_ = false;
  std::vector<Stored> channels_;
  AlignedArray<T> renumbered_;  ///< work space of renumber
  BlockTable table_;
  std::vector<BlockCoordinates> found_;
  std::vector<std::uint64_t> field_bits_;
  std::vector<std::uint32_t> shared_;
  std::vector<char> near_shared_;  ///< by slot, whether particles that may meet others scatter there
  std::vector<FaceNodes> faces_;
  std::vector<BoxNodes> boxes_;
  std::vector<std::uint32_t> edge_nodes_;
};

// ---- implementation ----------------------------------------------------------------------------------------------

/// Calls visit(block) for the blocks from low to high, counted from one of them.
template <int D, class T>
template <class Visit>
void Grid<D, T>::for_each_block_around(const BlockCoordinates& at, const std::array<int, 3>& low,
                                       const std::array<int, 3>& high, Visit&& visit) {
  for (int x = low[0]; x <= high[0]; ++x)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int z = D == 3 ? low[2] : 0; z <= (D == 3 ? high[2] : 0); ++z)
        visit(BlockCoordinates{at[0] + x, at[1] + y, at[2] + z});
}

template <int D, class T>
int Grid<D, T>::activate(const BlockCoordinates& at, std::uint64_t field_bits) {
  const int next = static_cast<int>(found_.size()), slot = table_.insert(at, next);
  if (slot == next) {
    found_.push_back(at);
    field_bits_.push_back(0);
  }
  field_bits_[slot] |= field_bits;
  return slot;
}

/// Calls visit(block) for the blocks that hold the images of a slot's nodes beyond a face.
template <int D, class T>
template <class Visit>
void Grid<D, T>::for_each_image(std::size_t slot, Visit&& visit) const {
  const BlockCoordinates at = found_[slot];
  for (int axis = 0; axis < D; ++axis) {
    if (inside(axis, at[axis])) continue;
    for (int k = 0; k < block_side<D>; ++k) {
      const int node = at[axis] * block_side<D> + k;
      if (image(axis, node) == node || !folded_axis(axis, node > 0)) continue;
      if (node < -padding(axis) || node > scene_.domain.cells[axis] + padding(axis)) continue;
      BlockCoordinates other = at;
      other[axis] = image(axis, node) >> block_bits<D>;
      visit(other);
    }
  }
}

/// Activates the images of slots beyond a face, which folding needs; images of images follow as the list grows.
template <int D, class T>
void Grid<D, T>::activate_mirrors() {
  for (bool grew = true; grew;) {  // bits must reach images of images even when those were active already
    grew = false;
    for (std::size_t slot = 0; slot < found_.size(); ++slot)
      for_each_image(slot, [&](const BlockCoordinates& image) {
        const int known = table_.find(image);
        if (known >= 0 && (field_bits_[known] | field_bits_[slot]) == field_bits_[known]) return;
        activate(image, field_bits_[slot]);
        grew = true;
      });
  }
}

/// Marks slots that have images among the marked ones, or the images of those, until there are no more.
template <int D, class T>
void Grid<D, T>::spread(std::vector<char>& marked, bool to_images) const {
  for (bool grew = true; grew;) {
    grew = false;
    for (std::size_t slot = 0; slot < found_.size(); ++slot)
      for_each_image(slot, [&](const BlockCoordinates& image) {
        char &of_slot = marked[slot], &of_image = marked[table_.find(image)];
        const char from = to_images ? of_slot : of_image;
        char& to = to_images ? of_image : of_slot;
        if (!from || to) return;
        to = 1;
        grew = true;
      });
  }
}

/// Contact looks at nodes of shared slots alone, and at those near rigid bodies, which move between two sorts. What is
/// folded onto a shared slot counts there.
template <int D, class T>
void Grid<D, T>::mark_blocks_that_may_meet(std::vector<Particles<D, T>>& bodies) {
  const bool anywhere = !scene_.experiment.rigid_bodies.empty();
  near_shared_.assign(found_.size(), anywhere);
  if (!scene_.plan.resolves_contact() || anywhere) return;
  std::vector<char> meets(found_.size(), 0);
  for (const std::uint32_t slot : shared_) meets[slot] = 1;
  spread(meets, /*to_images=*/false);
  for (Particles<D, T>& particles : bodies)
    for (Block<D>& block : particles.blocks) {
      const auto around = [&](auto&& visit) {
        for_each_block_around(block.at, block.first_active, block.last_active,
                              [&](const BlockCoordinates& at) { visit(table_.find(at)); });
      };
      block.may_meet = false;
      around([&](int slot) { block.may_meet |= meets[slot] != 0; });
      if (block.may_meet) around([&](int slot) { near_shared_[slot] = 1; });
    }
  spread(near_shared_, /*to_images=*/true);  // what folds add to a slot that no block reaches is cleared as well
}

template <int D, class T>
void Grid<D, T>::list_faces() {
  faces_.clear();
  // In a domain of few cells ghosts of both walls may have one mirror, which may be a ghost itself and is folded on
  // afterwards: such ghosts are folded by their distance from the wall, the outermost first.
  int first_face[3]{}, levels[3]{};
  for (const bool periodic : {true, false})  // images are folded before walls
    for (int axis = 0; axis < D; ++axis) {
      if (scene_.domain.periodic(axis) != periodic) continue;
      first_face[axis] = static_cast<int>(faces_.size());
      levels[axis] = !periodic && scene_.domain.cells[axis] < 2 * padding(axis) ? padding(axis) : 1;
      for (int level = levels[axis]; level > 0; --level)
        for (int side = 0; side < 2; ++side) {
          FaceNodes face;
          face.axis = axis, face.side = side;
          face.condition = &scene_.experiment.faces[axis][side];
          faces_.push_back(std::move(face));
        }
    }
  for (std::uint32_t slot = 0; slot < slots(); ++slot) {
    for (int axis = 0; axis < D; ++axis) {
      if (inside(axis, found_[slot][axis])) continue;
      const int cells = scene_.domain.cells[axis];
      for (int local = 0; local < block_nodes; ++local) {
        std::array<int, 3> node = node_at<D>(found_[slot], local);
        const int index = node[axis];
        if (index < -padding(axis) || index > cells + padding(axis)) continue;
        const std::uint32_t number = slot * block_nodes + local;
        const int side = index > 0;
        if (!folded_axis(axis, side)) continue;
        const int level = levels[axis] == 1 ? 1 : std::max({1, -index, index - cells});
        FaceNodes& face = faces_[first_face[axis] + 2 * (levels[axis] - level) + side];
        if (image(axis, index) != index) {
          node[axis] = image(axis, index);
          const std::uint32_t mirror = static_cast<std::uint32_t>(find(node));
          node[axis] = side ? cells : 0;
          const double distance = scene_.domain.cell_size * std::max(-index, index - cells);
          face.pairs.push_back({number, mirror, 0, 0, scene_.domain.node_position(node, D), distance});
        } else if (index == 0 || index == cells) {
          if (scene_.domain.periodic(axis)) continue;
          face.wall.push_back(number);
          face.wall_position.push_back(scene_.domain.node_position(node, D));
        }
      }
    }
  }
  for (FaceNodes& face : faces_) {
    face.pair_folds.assign(face.pairs.size() * fields_, 0);
    face.folded_mass.assign(scene_.experiment.notes_reactions() ? face.pairs.size() * fields_ : 0, 0);
    face.folded_capacity.assign(scene_.experiment.has_temperature() ? face.pairs.size() * fields_ : 0, 0);
  }
  number_edge_nodes();
}

template <int D, class T>
void Grid<D, T>::number_edge_nodes() {
  edge_nodes_.clear();
  if (std::all_of(faces_.begin(), faces_.end(), [](const FaceNodes& face) { return face.pairs.empty(); })) {
    for (FaceNodes& face : faces_) face.wall_edge.assign(face.wall.size(), ~0u);
    return;
  }
  std::vector<std::uint32_t> number(nodes(), ~0u);
  const auto number_of = [&](std::uint32_t node) {
    if (number[node] == ~0u) {
      number[node] = static_cast<std::uint32_t>(edge_nodes_.size());
      edge_nodes_.push_back(node);
    }
    return number[node];
  };
  for (FaceNodes& face : faces_)
    for (MirrorPair& pair : face.pairs) {
      pair.ghost_edge = number_of(pair.ghost);
      pair.mirror_edge = number_of(pair.mirror);
    }
  for (FaceNodes& face : faces_)
    for (const std::uint32_t node : face.wall) face.wall_edge.push_back(number[node]);
}

/// Returns false where a block is a cell or more away from a box.
template <int D, class T>
bool Grid<D, T>::may_touch(const BoxCondition& box, const BlockCoordinates& at) const {
  const double h = scene_.domain.cell_size;
  for (int a = 0; a < D; ++a) {
    const double first = scene_.domain.lower[a] + h * at[a] * block_side<D>;
    if (first > box.upper[a] + h || first + h * block_side<D> < box.lower[a] - h) return false;
  }
  return true;
}

template <int D, class T>
void Grid<D, T>::list_boxes() {
  boxes_.clear();
  const double tolerance = 1e-9 * scene_.domain.cell_size;
  for (const BoxCondition& condition : scene_.experiment.boxes) {
    BoxNodes box;
    box.condition = &condition;
    box.support = support_of_box(static_cast<int>(boxes_.size()));
    for (std::uint32_t slot = 0; slot < slots(); ++slot) {
      if (!may_touch(condition, found_[slot])) continue;
      for (int local = 0; local < block_nodes; ++local) {
        const Vector3 x = scene_.domain.node_position(node_at<D>(found_[slot], local), D);
        bool inside = true;
        for (int a = 0; a < D; ++a)
          inside = inside && x[a] >= condition.lower[a] - tolerance && x[a] <= condition.upper[a] + tolerance;
        if (!inside) continue;
        box.nodes.push_back(slot * block_nodes + local);
        box.position.push_back(x);
      }
    }
    boxes_.push_back(std::move(box));
  }
}

template <int D, class T>
void Grid<D, T>::rebuild(std::vector<Particles<D, T>>& bodies, const std::vector<int>& field_of_body, bool keeps) {
  const std::vector<BlockCoordinates> before = found_;
  table_.clear();
  found_.clear();
  field_bits_.clear();
  constexpr std::array<int, 3> below{-1, -1, -1}, above{1, 1, 1};
  std::vector<std::int32_t> slot_now(before.size(), -1);  // new slot of each old one
  const auto activate_again = [&](std::int32_t slot, std::uint64_t bits) {
    std::int32_t& now = slot_now[slot];
    if (now < 0) return now = activate(before[slot], bits);
    field_bits_[now] |= bits;
    return now;
  };
  for (std::size_t body = 0; body < bodies.size(); ++body)
    for (Block<D>& block : bodies[body].blocks) {
      const std::uint64_t bits = std::uint64_t{1} << field_of_body[body];
      if (block.has_neighbours())
        for (std::int32_t& slot : block.neighbours) slot = activate_again(slot, bits);
      else
        for_each_block_around(block.at, below, above, [&, k = 0](const BlockCoordinates& at) mutable {
          block.neighbours[k++] = activate(at, bits);
        });
      if (block.first_active != below || block.last_active != above)
        for_each_block_around(block.at, block.first_active, block.last_active,
                              [&](const BlockCoordinates& at) { activate(at, bits); });
    }
  activate_mirrors();
  shared_.clear();
  for (std::uint32_t slot = 0; slot < slots(); ++slot)
    if ((field_bits_[slot] & (field_bits_[slot] - 1)) != 0) shared_.push_back(slot);
  mark_blocks_that_may_meet(bodies);
  // Forces have been used when a gather follows, and the next step's momenta come after it.
  for (Channel c = 0; keeps && c < channels(); ++c)
    if (has(c) && c != next_motion_ && field(c).folded != Folded::with_force) renumber(c, before, slot_now);
  for (Stored& channel : channels_) channel.data.require(std::size_t(fields_) * nodes() * 4);
  clear_where_no_field_is();
  list_faces();
  list_boxes();
}

/// Brings a channel's values from the old numbers of their blocks to the new ones, as far as these are known.
template <int D, class T>
void Grid<D, T>::renumber(Channel channel, const std::vector<BlockCoordinates>& blocks_before,
                          const std::vector<std::int32_t>& slot_now) {
  AlignedArray<T>& now = channels_[channel].data;
  AlignedArray<T>& before = has(next_motion_) ? channels_[next_motion_].data : renumbered_;  // nothing reads it yet
  std::swap(now, before);
  now.require(std::size_t(fields_) * nodes() * 4);
  clear(channel);
  constexpr std::size_t scalars = block_nodes * 4;
  const std::size_t count = blocks_before.size();
  scene_.team->for_each(count, [&](std::size_t block) {
    const int slot = slot_now[block] >= 0 ? slot_now[block] : table_.find(blocks_before[block]);
    for (int field = 0; slot >= 0 && field < fields_; ++field)
      std::copy_n(before.data() + (std::size_t(field) * count + block) * scalars, scalars,
                  now.data() + (std::size_t(field) * slots() + slot) * scalars);
  });
}

template <int D, class T>
void Grid<D, T>::clear() {
  for (Channel c = 0; c < channels(); ++c)
    if (field(c).cleared && has(c)) clear(c);
}

template <int D, class T>
T Grid<D, T>::largest_component(Channel c) const {
  using L = Lanes<T>;
  const T* const nodes_of_all = channels_[c].data.data();
  return scene_.team->template largest<T>(std::size_t(fields_) * slots(), [&](std::size_t block) {
    L of_block(T(0));
    for (int s = 0; s < block_nodes * 4; s += L::width) {
      const L values = L::load(nodes_of_all + block * block_nodes * 4 + s);
      of_block = max(of_block, max(values, -values));
    }
    T largest = 0;
    for (int i = 0; i < L::width; ++i)
      if (i % 4 < D) largest = std::max(largest, of_block.v[i]);
    return largest;
  });
}

/// Only where scatters and folds may have added something.
template <int D, class T>
void Grid<D, T>::clear(Channel c) {
  T* const values = channels_[c].data.data();
  const bool near_alone = is_near_others_alone(field(c));
  const std::size_t count = slots();
  scene_.team->for_each(fields_ * count, [&](std::size_t block) {
    const std::size_t slot = block % count;
    if (may_have_mass(static_cast<int>(block / count), slot) && (!near_alone || near_shared_[slot]))
      std::memset(values + block * block_nodes * 4, 0, block_nodes * 4 * sizeof(T));
  });
}

/// Nothing is added there until the grid is built anew.
template <int D, class T>
void Grid<D, T>::clear_where_no_field_is() {
  if (fields_ == 1) return;
  const std::size_t count = slots();
  for (Stored& channel : channels_)
    scene_.team->for_each(fields_ * count, [&](std::size_t block) {
      const std::size_t slot = block % count;
      if (!may_have_mass(static_cast<int>(block / count), slot) ||
          (is_near_others_alone(*channel.field) && !near_shared_[slot]))
        std::memset(channel.data.data() + block * block_nodes * 4, 0, block_nodes * 4 * sizeof(T));
    });
}

}  // namespace mpm::cpu
