#pragma once
// The passes that work on particles, chunk by chunk: scatter, gather, strain, move, time step. A chunk is loaded once
// and goes through shape, material and transfer plugins in batches; tiles of nodes are private to a thread.

#include <atomic>
#include <deque>
#include <exception>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "backends/cpu/grid/grid.hpp"
#include "backends/cpu/phase_clock.hpp"
#include "backends/cpu/tiles/box_kernels.hpp"
#include "backends/cpu/tiles/higher_kernels.hpp"
#include "kernel/artificial_viscosity.hpp"
#include "simulation/failure.hpp"
#include "simulation/grips.hpp"
#include "simulation/loads.hpp"

namespace mpm::cpu {

/// The lists of nodes of one chunk, made from batches of MPM_LANES particles.
template <int D, class T>
struct ListWork {
  static constexpr int lanes = MPM_LANES;
  // These arrays hold one batch, as the shape takes and gives it.
  alignas(64) T position[D * lanes], half_size[D * lanes], domain[D * D * lanes], second_moment[D * D * lanes];
  alignas(64) T corners[(1 << D) * D * lanes];
  alignas(64) std::int32_t count[lanes];
  AlignedArray<std::int32_t> coordinates;
  AlignedArray<T> weight, gradient;
  // A particle's entries begin at first[p], and end at near_end[p] in its tile or at far_end[p] on the grid.
  std::int32_t first[chunk_size<T>], near_end[chunk_size<T>], far_end[chunk_size<T>];
  AlignedArray<std::int32_t> node;
  AlignedArray<T> values;  ///< see NodeLists
  int lowest[3], highest[3];
  int far = 0, far_of_chunk = 0;  ///< particles with a node outside the tile, with the tail's lanes and without
  bool any = false;               ///< false: no particle of the chunk has a list, and the above is not filled

  void clear() {
    far = far_of_chunk = 0;
    any = false;
    for (int a = 0; a < 3; ++a) lowest[a] = 1 << 20, highest[a] = -(1 << 20);
  }
  void require(int capacity) {
    coordinates.require(std::size_t(capacity) * D * lanes);
    weight.require(std::size_t(capacity) * lanes);
    gradient.require(std::size_t(capacity) * D * lanes);
    node.require(std::size_t(capacity) * chunk_size<T>);
    values.require(std::size_t(capacity) * chunk_size<T> * 8);
  }
  NodeLists<T> near_lists() const { return {first, near_end, node.data(), values.data()}; }
  NodeLists<T> far_lists() const { return {first, far_end, node.data(), values.data()}; }
};

/// The boxes of nodes of one chunk.
template <int D, class T>
struct BoxWork {
  alignas(64) std::int32_t base[D * chunk_size<T>], width[chunk_size<T>], tile_node[chunk_size<T>];
  AlignedArray<T> weight, gradient;
  Boxes<T> boxes() const { return {width, tile_node, weight.data(), gradient.data()}; }
  void require() {
    weight.require(std::size_t(box_nodes<D>) * chunk_size<T>);
    gradient.require(std::size_t(box_nodes<D>) * D * chunk_size<T>);
  }
};

/// How far particles have moved, in cells.
struct Moved {
  double distance = 0;  ///< largest distance of any particle along an axis
  double outside = 0;   ///< farthest way from its own block, see drift; where that is measured
  void extend(const Moved& other) {
    distance = std::max(distance, other.distance), outside = std::max(outside, other.outside);
  }
};

/// The work space of one thread. Whatever threads write for each chunk belongs here: a line of the cache that two of
/// them write costs each chunk a journey from one processor to the other.
template <int D, class T>
struct alignas(page) Workspace {
  static constexpr int symmetric = Sym<D, T>::size;
  alignas(64) std::int32_t base[D * chunk_size<T>];
  alignas(64) std::int32_t first[chunk_size<T>];  ///< row of each stencil, see Stencils
  alignas(64) T offset[D * chunk_size<T>], weight[D * 4 * chunk_size<T>], gradient[D * 4 * chunk_size<T>];
  alignas(64) T mass[chunk_size<T>], b[D * chunk_size<T>];
  alignas(64) T stress[symmetric * chunk_size<T>], volume_ratio[chunk_size<T>], scalar[chunk_size<T>];
  alignas(64) T velocity[D * chunk_size<T>], increment[D * chunk_size<T>];
  // What is gathered is used up before anything is scattered: a place for both stays in the first-level cache.
  union {
    alignas(64) T affine[D * D * chunk_size<T>];
    alignas(64) T A[D * D * chunk_size<T>];
  };
  union {
    alignas(64) T gradient_of_velocity[D * D * chunk_size<T>];
    alignas(64) T S[D * D * chunk_size<T>];
  };
  alignas(64) T advection[D * chunk_size<T>];
  alignas(64) T mean[chunk_size<T>];  ///< an average of the nodes at the particles: of the dilation or the stress
  /// Moments of particles that have their own, cells^2, and inverses in 1/m^2: [D] of a product, [D * D] of a list.
  alignas(64) T second_moment[D * D * chunk_size<T>], inverse_moment[D * D * chunk_size<T>];
  /// The moment that the transfer reads, unless it is second_moment; beside its diagonal it is zero and stays so.
  alignas(64) T transfer_moment[D * D * chunk_size<T>];
  using Integers = typename Lanes<float>::Mask;
  static constexpr int integers = Lanes<float>::width;
  Integers lowest[3], highest[3];  ///< first nodes of a block's stencils, lane by lane
  ListWork<D, T> lists;
  BoxWork<D, T> boxes;
  alignas(64) T quads[(1 + 2 * D) * 4 * chunk_size<T>];
  /// Tiles are zero between uses, so that the scatter may add.
  std::vector<AlignedArray<T>> tile;  ///< [channel], for those that particles add to
  /// From these tiles a block gathers; only what it reaches is valid.
  AlignedArray<T> velocity_tile, increment_tile, mean_tile;
  AlignedArray<T> passing_motion;  ///< velocity and the transfer's state on their way from gather to scatter
  AlignedArray<T> scratch_velocity, scratch_state;  ///< for the filter's projections
  AlignedArray<T> moved_corners;                    ///< [corner][D][chunk_size] cells, from the particle
  AlignedArray<T> higher;  ///< [function][D][chunk_size], gathered coefficients of polynomials beyond affine, m/s
  Moved moved;
  PhaseClock clock;
  bool shared_stencils = false;  ///< see Stencils
  bool far_only = false;         ///< only particles whose lists leave the tile scatter, to the grid itself

  void clear(Channel c, int scalars) { std::memset(tile[c].data(), 0, std::size_t(scalars) * sizeof(T)); }
};

/// A body with what the plugins need of it.
template <int D, class T>
struct Body {
  int index = 0, field = 0;
  double mass = 0, volume = 0;  ///< values of a particle; of size 1
  bool frozen = false;          ///< particles and domains stay as they are
  const Component* material = nullptr;
  std::int32_t (*update_material)(const void*, const mpm_material_batch*) = nullptr;
  const BodyLoads* loads = nullptr;       ///< null where nothing acts from outside
  bool dissipates = false;                ///< the law does, or its artificial viscosity
  double Ledger::*dissipation = nullptr;  ///< the row of what the law dissipates
  ArtificialViscosity<T> viscosity{};
  const Thermal* thermal = nullptr;  ///< null where particles have no temperature
  bool warms_itself = false;         ///< a share of what it dissipates becomes heat
  bool reads_temperature = false;    ///< particles have a temperature and the material asks for it
  bool may_melt() const;
  /// Values of fields that never change, by id; they are particle-major, by index of seeding.
  std::map<std::string, std::vector<double>> seeded;
  const double* initial_position = nullptr;  ///< m, among them; null where nobody reads it
  std::array<T, D> first_place{};  ///< lowest place in a block of particles whose first node is the block's, cells
};

/// Plugins as they were loaded, called through their tables. Another type with these members may call functors that
/// were compiled in (modules/bench, which measures the price of the tables).
template <int D, class T>
struct LoadedComponents {
  static void evaluate_shape(const Scene<D, T>& scene, const mpm_shape_batch& batch) {
    scene.evaluate_shape(scene.shape_parameters, &batch);
  }
  static void scatter(const Scene<D, T>& scene, const mpm_scatter_batch& batch) {
    scene.transfer_scatter(scene.transfer_parameters, &batch);
  }
  static void gather(const Scene<D, T>& scene, const mpm_gather_batch& batch) {
    scene.transfer_gather(scene.transfer_parameters, &batch);
  }
  static std::int32_t update_material(const Body<D, T>& body, const mpm_material_batch& batch) {
    return body.update_material(body.material->parameters.data(), &batch);
  }
};

template <int D, class T, class Components = LoadedComponents<D, T>>
class ParticleStep : NamedChannels {
 public:
  static constexpr std::size_t max_state_fields = 16;
  ParticleStep(const Scene<D, T>& scene, Grid<D, T>& grid, std::vector<Particles<D, T>>& particles,
               std::vector<Body<D, T>> bodies);

  /// Returns the sums of the particles when momenta are scattered with the ledger on, else zeros.
  Scattered scatter(const Pass& pass, const StepInfo& step);
  struct Gathered {
    double kinetic_energy = 0;                 ///< J, with the ledger on
    Ledger strained;                           ///< what the strain and changes of phase enter in it
    double heat = 0, heat_of_dissipation = 0;  ///< J, with temperature
  };
  /// What a grip gave its particles in the last gather.
  GivenToGripped given_to_gripped(std::size_t grip) const;
  /// The sum of the heat that the last scatter of momenta took along, J.
  double scattered_heat() const;
  void conduct();
  /// Scatters the particles' mean normal stresses by their volumes.
  void scatter_mean_stress();
  /// Scatters how the grid's velocity changes the particles' volumes.
  void scatter_dilation(const Pass& pass, const StepInfo& step);
  /// Gives particles what a law of contact has reached at the nodes around them.
  void keep_contact_state();
  /// Returns the energy that the ledger calls dissipated, J.
  double change_phases(const StepInfo& step);
  Gathered gather(const Pass& pass, const StepInfo& step);
  struct Fused {
    Gathered gathered;
    bool scattered = false;  ///< next_motion and the forces are those of the following step
    Scattered particles;     ///< as `scatter` returns it
  };
  /// Gathers, strains, moves, and scatters for the following step `next` while the chunk is at hand.
  Fused gather_scatter(const Pass& pass, const StepInfo& step, const StepInfo& next);
  /// Gathers the filter's increment and scatters its momentum into filter_projection.
  void project(const StepInfo& step);
  Gathered strain(const Pass& pass, const StepInfo& step);  ///< returns only the material's energies
  /// Whether the kinetic energy of a particle depends on its place; that of all of them where they are now, J.
  bool energy_moves() const {
    const bool varies = scene_.moment_of_particle || scene_.moment_is_gradient;
    return (scene_.has(MPM_AFFINE_CARRIES_ENERGY) && varies) || scene_.plan.basis_functions > 0;
  }
  double kinetic_energy_now();
  void move(const StepInfo& step);
  TimeStepLimit time_step_limit();

  /// How far any particle is out of the block that it was sorted into (or rather its stencil's first node), or a bound
  /// of that, in cells.
  double drift() const { return drift_; }
  double last_drift() const { return last_drift_; }
  void set_drift(double drift) { drift_ = drift; }
  void set_drift(double drift, double last) { drift_ = drift, last_drift_ = last; }
  /// Forgets forces of a step that does not follow.
  void forget_failed_forces() { failed_forces_ = {}; }
  /// Sets the reach of particles that have just been sorted: first nodes lie in their own block, or (`ahead`) up to a
  /// cell beside it.
  void reach_own_cells(bool ahead);
  /// How far ahead of their positions particles may be sorted so that several moves like the last stay within tiles, in
  /// cells; 0 where only bounds of their drift are known.
  double foresight() const { return measures_drift_ ? std::clamp(0.95 - 1.25 * last_drift_, 0.0, 0.55) : 0.0; }
  /// Whether particles, for which tiles have a margin of one cell, have moved too far since they were sorted.
  bool must_sort() const { return drift_ > 0.99; }
  /// Whether they must be sorted after a move like the last: what is scattered at once would be scattered again.
  bool must_sort_soon() const { return drift_ + last_drift_ > 0.99; }
  /// Whether they need not be after a move of at most `cells`. The move may be measured longer by the part of a cell to which
  /// places are known (find_first_places).
  bool stays_within_tiles(double cells) const {
    const double part = measures_drift_ ? 1.0 / chunk_size<T> : 0;
    return drift_ + part + cells * (1 + 1e-6) < 0.99;
  }
  /// Widens the range of grid blocks that the lists of each block of particles may reach; returns whether any grew.
  bool widen_active_blocks();
  /// The second moment of every particle at its position, n*D*D, m^2, by index of seeding.
  std::vector<double> second_moments(int body);
  const std::vector<Body<D, T>>& bodies() const { return bodies_; }

  void measure_phases(bool on);
  std::map<std::string, double> phase_seconds() const;

 private:
  using Work = Workspace<D, T>;
  /// A chunk under work.
  struct Chunk {
    Particles<D, T>& particles;
    Body<D, T>& body;
    Block<D>& block;
    T* values;
    T* motion;  ///< velocity and the transfer's state, in the chunk or (see `passing`) the work space
    const std::int32_t* ids;
    int count, end;    ///< `end` is `count` padded to whole lanes
    const char* next;  ///< the chunk that follows
    /// Brings what is read of the next chunk into the cache, one half with a gather, the other with a scatter.
    Ahead ahead(bool gather) const {
      const bool passes = motion != at(Particles<D, T>::velocity);
      const int left_out = passes ? particles.motion_components : 0;
      const std::size_t half = (particles.components - left_out) * sizeof(T) / 2 * chunk_size<T>;
      return {next, gather ? half : 0, (half + end - 1) / end,
              passes ? Particles<D, T>::velocity * chunk_size<T> * sizeof(T) : ~std::size_t(0),
              left_out * chunk_size<T> * sizeof(T)};
    }
    T* at(int component) const { return values + component * chunk_size<T>; }
    /// The coefficients of the polynomials beyond affine, which are the last field of the transfer's state.
    T* higher() const { return motion_at(particles.transfer_state.back().first); }
    T* motion_at(int component) const { return motion + (component - Particles<D, T>::velocity) * chunk_size<T>; }
  };
  struct States {
    void* fields[max_state_fields];
  };

  template <class Visit>
  void for_each_block(int body, bool coloured, Visit&& visit);
  void fetch_nodes_of_next(int body, const Block<D>& block, int share);
  template <class Visit>
  void for_each_chunk_of(int body, Block<D>& block, Visit&& visit, T* motion = nullptr);
  States material_states(const Chunk& chunk) const;
  States transfer_states(const Chunk& chunk) const;
  void note(Cause cause, const Chunk& chunk, int p, int axis = -1,
            double value = std::numeric_limits<double>::quiet_NaN());
  void note_forces(const FirstFailure& found);

  void evaluate_shape(const Chunk& chunk, Work& work, bool gradients);
  void evaluate_lists(const Chunk& chunk, Work& work, bool gradients);
  void evaluate_list_batch(const Chunk& chunk, Work& work, int first_lane, bool gradients) const;
  void keep_moment(Work& work, int first_lane, int lane) const;
  void evaluate_boxes(const Chunk& chunk, Work& work, bool gradients);
  bool place_boxes(const Chunk& chunk, Work& work) const;
  int evaluate_lists_between_boxes(const Chunk& chunk, Work& work, int first_lane, int entry, bool gradients);
  int keep_list(const Chunk& chunk, Work& work, int first_lane, int lane, int entry, bool gradients);
  bool reaches_too_far(const Chunk& chunk, int particle, const int* low, const int* high);
  bool place_to_scatter(const Chunk& chunk, Work& work, bool extend_reach) const;
  bool stencils_hold(const Chunk& chunk, const Work& work) const;
  void note_too_long(const Chunk& chunk, const Work& work);
  static T weight_along(const Work& work, int width, int axis, int particle);
  void begin_reach(Block<D>& block, Work& work) const;
  void end_reach(Block<D>& block, const Work& work) const;
  void place_to_gather(const Chunk& chunk, Work& work) const;
  void number_stencils(Work& work, int count) const;
  void extend_bounds(const Chunk& chunk) const;
  bool place_lists(const Chunk& chunk, const Work& work, bool extend_reach) const;
  void invert_moments(const Chunk& chunk, Work& work) const;
  void update_material(const Chunk& chunk, mpm_material_batch request);
  void note_inverted(const Chunk& chunk);
  double kinetic_energy(const Chunk& chunk, const Work& work) const;

  const std::vector<Channel>& scattered_channels(const Pass& pass);
  bool scatter_chunk(const Pass& pass, const StepInfo& step, const Chunk& chunk, Work& work, Channel momentum,
                     bool evaluated);
  /// A fused pass asks its material for the strained state and for the stress that it scatters at once.
  static bool evaluates_for_scatter(const Pass& pass) { return pass.fused() && pass.has(Act::strain); }
  static bool scatters_contact(const Pass& pass, const Block<D>& block);
  bool wants_volume(const Pass& pass, const Block<D>& block) const;
  void want_of_material(const Pass& pass, const Block<D>& block, Work& work, mpm_material_batch& request) const;
  template <class Visit>
  void scatter_far(int body, Visit&& visit);
  void fill_masses(const Chunk& chunk, Work& work) const;
  Lanes<T> section(const Chunk& chunk, const Lanes<T>& volume, int p) const;
  const T* sizes(const Chunk& chunk) const;
  static T cells_from_axis(const Scene<D, T>& scene, const Block<D>& block);
  Lanes<T> radius(const Chunk& chunk, int p) const;
  void weigh_stress(const Chunk& chunk, Work& work) const;
  void add_hoop_force(const Chunk& chunk, Work& work, double factor) const;
  void momentum_coefficients(const Chunk& chunk, Work& work);
  T stress_scale(const Chunk& chunk, double factor) const;
  void stress_coefficients(const Chunk& chunk, Work& work, double factor, bool add);
  void add_to_tile(const Chunk& chunk, Work& work, Channel channel, const T* last, bool constant, bool affine,
                   bool gradient, T stress = T(0));
  template <bool Affine, bool Gradient, bool Stress>
  void pack_coefficients(Work& work, const T* last, bool constant, int count, T stress);
  void pack_coefficients(Work& work, const T* last, bool constant, bool affine, bool gradient, int count, T stress);
  void add_higher_to_tile(const Chunk& chunk, Work& work, Channel channel, const T* coefficients);
  void scatter_forces(const Chunk& chunk, Work& work, double time);
  double place_of(const Chunk& chunk, int p, int axis) const;
  bool is_pulled(const Chunk& chunk) const;
  void fetch_initial_positions(const Chunk& chunk) const;
  void add_body_force(const Chunk& chunk, Work& work, double time, double factor);
  void scatter_loads(const Chunk& chunk, Work& work, double time);
  void scatter_contact_fields(const Chunk& chunk, Work& work);
  void scatter_displacements(const Chunk& chunk, Work& work);
  void scatter_contact_state(const Chunk& chunk, Work& work, int values, Channel channel);
  void keep_contact_state(const Chunk& chunk, Work& work);

  std::size_t grip_of(const Chunk& chunk, int p) const;
  Vector3 place_of(const Chunk& chunk, int p) const;
  Vector3 velocity_of_gripped(const Chunk& chunk, int p, std::size_t grip, double time) const;
  void scatter_grips(const Chunk& chunk, Work& work, double end);
  void move_gripped(const Chunk& chunk, T* advection, double end);
  void clear_given_to_gripped();

  bool melted(const Chunk& chunk, int p) const;
  T of_phase(const Chunk& chunk, int p, double ThermalProperties::*value) const;
  void fill_heat_capacities(const Chunk& chunk, Work& work) const;
  double heat_of(const Chunk& chunk, const Work& work) const;
  States temperature_as_motion(const Chunk& chunk, Work& work) const;
  void scatter_heat(const Chunk& chunk, Work& work);
  void scatter_heated_volume(const Chunk& chunk, Work& work);
  void conduct_chunk(const Chunk& chunk, Work& work);
  void gather_heat(int body, Block<D>& block, Work& work, const StepInfo& step);
  void gather_heat(const Chunk& chunk, Work& work, const StepInfo& step);
  void note_temperatures(const Chunk& chunk);
  void warm_by_dissipation(const Chunk& chunk, Work& work) const;
  void change_phases(const Chunk& chunk, Work& work);
  std::int32_t update_by_phase(const Chunk& chunk, const mpm_material_batch& request);

  void find_hoop_rates(const Chunk& chunk, const Work& work, T* hoop) const;
  int dilated_directions() const { return D == 2 && !scene_.axisymmetric ? 2 : 3; }
  Lanes<T> mean_normal_stress(const Work& work, int p) const;
  template <class Visit>
  void scatter_average(Channel channel, bool velocity, Visit&& visit);
  void scatter_sum_by_volume(const Chunk& chunk, Work& work, Channel channel);
  void scatter_mean_stress(const Chunk& chunk, Work& work);
  void scatter_dilation(const Chunk& chunk, Work& work, T dt);
  void load_mean(int body, const Block<D>& block, Work& work, Channel channel);
  void gather_mean(const Chunk& chunk, Work& work, Channel channel);
  void take_mean_stress(const Chunk& chunk, Work& work) const;
  void take_mean_dilations(const Chunk& chunk, const Work& work, T* gradient, T* hoop, T dt) const;

  // These are called for bodies with artificial viscosity alone, and kept out of the loops of all others.
  [[gnu::noinline]] void add_artificial_pressure(const Chunk& chunk, Work& work) const;
  [[gnu::noinline]] void strain_artificially(const Chunk& chunk, Work& work, const mpm_material_batch& strain) const;
  [[gnu::noinline]] void damp_wave_speeds(const Chunk& chunk, Work& work) const;

  void load_velocities(int body, const Block<D>& block, Work& work);
  void flush(int body, const Block<D>& block, Work& work, Channel channel);
  void flush(int body, const Block<D>& block, Work& work, const std::vector<Channel>& channels);
  Moved gather_one(const Pass& pass, const StepInfo& step, const Chunk& chunk, Work& work);
  Gathered sum_gathered(bool moved);
  /// The sums that gather_chunk makes: velocities for the transfer, for the material, or of the filter's increment.
  struct Wanted {
    bool transfer = false, strain = false;
    Channel channel = -1;
    Channel increments = -1;  ///< channel that transfers of increments take
    Channel dilation = -1;    ///< channel that a strain by the mean dilation takes
  };
  void gather_chunk(const Chunk& chunk, Work& work, const Wanted& wanted);
  void gather_moments(const Chunk& chunk, Work& work, const T* tile, Channel channel, bool moment, bool gradient);
  template <bool Moment, bool Gradient>
  void unpack_moments(Work& work, int count);
  void unpack_moments(Work& work, bool moment, bool gradient, int count);
  void keep_higher(const Chunk& chunk, const Work& work) const;
  void apply_inverse_moments(const Chunk& chunk, Work& work) const;
  void multiply_by_inverse_moments(const Chunk& chunk, Work& work) const;
  const T* moments_for_transfer(const Chunk& chunk, Work& work) const;
  void project_chunk(const StepInfo& step, const Chunk& chunk, Work& work);
  void advance_material(const Chunk& chunk, Work& work, double dt, const Pass& pass);
  void add_scattered(const Chunk& chunk) const;
  Scattered sum_scattered() const;
  void evaluate_moments(const Chunk& chunk, Work& work);
  void book_stress(const Chunk& chunk, const mpm_material_batch& now, const mpm_material_batch& strain, bool after);
  void advance_domain(const Chunk& chunk, const T* velocity_gradient, double dt, bool again) const;
  void advance_columns(const T* from, T* to, const T* velocity_gradient, double dt, int count) const;
  Moved advance_position(const Chunk& chunk, const T* advection, T scale);
  void account_for_move();
  /// Sets what the pass that begins sums for the ledger; `follows` says that its scatter wants the energy.
  void account_for(const StepInfo& step, bool follows = false) {
    accounted_ = scene_.plan.accounts_at(step.step);
    sums_energy_ = accounted_ || follows;
  }
  void find_first_places();
  void gather_corners(const Chunk& chunk, Work& work, const T* advection, double dt, T* moved) const;
  Vec<D, T> velocity_at_corner(const Chunk& chunk, const Work& work, int particle, const Vec<D, T>& corner) const;
  Moved move_with_corners(const Chunk& chunk, Work& work, const T* moved);
  double margin(int axis, int side) const;
  T least_place(const Block<D>& block, int axis) const;
  void note_outside(const Chunk& chunk);

  const Scene<D, T>& scene_;
  Grid<D, T>& grid_;
  std::vector<Particles<D, T>>& particles_;
  std::vector<Body<D, T>> bodies_;
  TileKernels<D, T> kernels_;
  ListKernels<D, T> list_kernels_;
  HigherKernels<D, T> higher_kernels_;
  /// The channels of each pass so far, by its acts and whether the ledger rests.
  std::deque<std::pair<std::uint64_t, std::vector<Channel>>> scattered_channels_;
  std::array<std::array<std::vector<Channel>, act_count>, 2> adds_;  ///< [in a fused pass][act]: channels to add to
  std::vector<std::array<Channel, 2>> grips_;  ///< channels of a grip's momentum at the end of the step, and before it
  std::vector<std::vector<GivenToGripped>> given_to_gripped_;  ///< [body][block * grips + grip]
  std::vector<std::unique_ptr<Work>> work_;
  std::vector<std::atomic<int>> units_;  ///< states of a pass: UnitPass::State
  bool measures_drift_ = false;
  bool accounted_ = false, sums_energy_ = false;  ///< see account_for
  double drift_ = 0, last_drift_ = 0;             ///< drift since the last sort, and by the last move, in cells
  FirstFailure failure_;
  FirstFailure failed_forces_;  ///< the fused pass leaves them to the step that they belong to, which scatters apart
  std::exception_ptr exception_;
  std::mutex mutex_;
  PhaseClock::Ticks measured_from_ = 0;
  std::chrono::steady_clock::time_point measured_since_;
  std::atomic<bool> abandoned_{false};  ///< the fused pass does not scatter any more
};

}  // namespace mpm::cpu

/// What instantiation.cpp.in makes of this header and its parts for every dimension and scalar.
#define MPM_INSTANTIATE_PARTICLE(D, T) template class ParticleStep<D, T>;
