#pragma once
// GridStep executes the passes on nodes: folding at the domain's edges, conditions, forces, contact; and their ledger.

#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "backends/cpu/grid/contact_welds.hpp"
#include "backends/cpu/grid/grid.hpp"
#include "experiment/contact_settings.hpp"
#include "operators/edges.hpp"
#include "operators/filter.hpp"
#include "operators/motion.hpp"
#include "simulation/contact_impulse.hpp"
#include "simulation/contact_pair.hpp"
#include "simulation/loads.hpp"
#include "simulation/reaction_impulse.hpp"
#include "simulation/rigid_bodies.hpp"
#include "simulation/wall_heat.hpp"

namespace mpm::cpu {

template <int D, class T>
class GridStep : NamedChannels {
 public:
  GridStep(const Scene<D, T>& scene, Grid<D, T>& grid, Ledger& ledger, HeatLedger& heat_ledger, ContactRecord& record,
           FilterRecord& filter, ReactionImpulse& reactions);

  /// Folds what was scattered, divides by mass, imposes conditions and contact before the forces.
  void momentum_to_velocity(bool remap, const StepInfo& step);
  /// Computes v+ = v- + dt f / m with conditions, contact after the forces, increments, ghosts.
  void apply_forces(const StepInfo& step);
  /// Sets what adds the particles to nodes where bodies meet, in scenes whose contact looks at them.
  void show_particles_by(std::function<void(ContactPoints&)> show) { show_particles_ = std::move(show); }
  /// The records of pairs of fields, which go into checkpoints.
  std::vector<PairRecord>& contact_pairs() { return impulse_.pairs(); }
  const std::vector<PairRecord>& contact_pairs() const { return impulse_.pairs(); }
  const std::vector<ContactNode>& contact_nodes() const { return impulse_.nodes(); }
  /// The rigid bodies, which go into checkpoints.
  RigidBodies& rigid_bodies() { return rigid_; }
  const RigidBodies& rigid_bodies() const { return rigid_; }
  /// The largest component of the velocities after apply_forces, along any axis.
  T largest_component() const { return merges() ? largest_ : grid_.largest_component(motion); }

  /// Computes T- = H / C with the temperatures that walls and boxes hold.
  void heat_to_temperature(const StepInfo& step);
  /// Computes T+ = T- + dt R / C, with what comes through walls and into boxes.
  void apply_heat(const StepInfo& step);
  /// The ledger's heat of the particles when they scattered it, and of the nodes when particles take it, J.
  void set_particle_heat(double sum) { particle_heat_ = sum; }
  double heat_after() const { return heat_after_; }

  /// Divides what particles have summed by their volumes in a channel.
  void average(Channel channel);

  /// These passes make the filter's loop (see Act). project_increment takes what the particles have scattered.
  void begin_filter(const Pass& pass);
  void project_increment(const Pass& pass, const StepInfo& step);
  void update_filter(const Pass& pass, const StepInfo& step);
  void end_filter(const Pass& pass, const StepInfo& step);
  void restore_velocity(const Pass& pass, const StepInfo& step);
  void add_correction(const Pass& pass, const StepInfo& step);

  void set_accounted(bool accounted) { accounted_ = accounted; }
  /// Sets what the ledger knows of the particles when they scattered.
  void set_scattered(const Scattered& scattered) { particles_ = scattered; }
  /// Books the gather: the particles' kinetic energy after it, and what the nodes did since the scatter.
  void book_gather(double kinetic_energy);
  void book_filtered_gravity(double dt);
  /// Books what strain by the velocity of now stores less than by v+ before any filter: by a share of the step.
  void book_strain(double Ledger::*row, double share, double dt);

 private:
  using Q = Quad<T>;
  using L = Lanes<T>;
  using Wide = Quad<double>;  ///< sums of the ledger
  bool ledger_on() const { return accounted_; }
  bool merges() const { return may_merge_ && !grid_.has(force); }
  Q& motion_at(int field, std::uint32_t node) { return grid_.quad(motion, field, node); }
  Q mirror_signs(const FaceNodes& face, AtWall rule) const;
  void find_velocities(const std::optional<VectorExpression>& velocity, std::span<const Vector3> x, double time);
  void find_wall_velocities(const FaceNodes& face, double time);
  Q found_velocity(std::size_t i) const;
  /// The velocity of a wall at the foot of one of its ghosts, of those that find_wall_velocities found.
  Q wall_velocity(const FaceNodes& face, const MirrorPair& pair) const {
    return found_velocity(static_cast<std::size_t>(&pair - face.pairs.data()));
  }
  template <class Visit>
  void for_each_block(Visit&& visit);
  template <class Visit>
  void visit_blocks(Visit&& visit);
  template <class Change>
  static bool for_each_pack(Q* nodes, Change&& change);
  static L pack_of(const Q* nodes) { return L::load(reinterpret_cast<const T*>(nodes)); }
  double sum_partials(int which) const;
  static Wide widen(Q quad) { return __builtin_convertvector(quad, Wide); }
  static double sum_of_components(Wide quad) { return quad[0] + quad[1] + (D == 3 ? quad[2] : 0.0); }
  double kinetic_energy();
  double kinetic_energy_of_edges();

  void fold_images(bool remap, const StepInfo& step);
  void fold_walls(bool remap, const StepInfo& step);
  void fold_faces(bool periodic, bool remap, const StepInfo& step);
  template <class Visit>
  void for_each_folded(const FaceNodes& face, Visit&& visit);
  void fold_momentum(Channel channel, int field, const MirrorPair& pair, Q signs, Q wall_velocity);
  void fold_as_is(Channel channel, int field, const MirrorPair& pair, Q signs);
  void fold_pair(FaceNodes& face, std::size_t pair, int field, bool remap, double time);
  void fold_face(FaceNodes& face, bool remap, double time, double dt);
  void fold_wall_onto_itself(const FaceNodes& face, int field, double dt);
  bool approaches(const FaceNodes& face, int field, const MirrorPair& pair, double dt);
  void fold_forces(bool periodic, double time, double dt);
  double work_beyond_wall(Q ghost, Q signs, Q wall_velocity);
  void fill_ghosts(double time, bool increments);

  void impose(double time);
  void hold(int field, std::uint32_t node, int component, T velocity, int support, const Vector3& x);
  Q before_conditions(int field, std::uint32_t node);
  void note_held(std::uint64_t component, int support, const Vector3& x, const Vector3& impulse);
  void find_gripped_nodes();
  void impose_grips();
  MirroredPlaces places(const FaceNodes& face, const MirrorPair& pair) const;
  static Vector3 as_array(Wide values) { return {values[0], values[1], D == 3 ? values[2] : 0.0}; }
  void note_mirror(const FaceNodes& face, std::size_t pair, int field, Q signs, Q wall);
  void note_mirrored_force(const FaceNodes& face, const MirrorPair& pair, Wide force, Q signs);
  void note_projection(const FaceNodes& face, std::size_t pair, int field, Q signs, Q wall);
  void record_reactions(const StepInfo& step, bool increments);
  double work_of_fold(int field, const MirrorPair& pair, Q signs, Q wall_velocity);
  double divide_by_mass(bool keeps_before, bool accounted);
  void book_scattered_sums();
  void begin_stage(bool records);
  void record(Channel impulse, Channel standing, int field, std::uint32_t node, int component, double given);
  void take_back(int field, std::uint32_t first);
  void book(double Ledger::*row, double work);
  void book_impulses();
  void book_filter();
  double power_of_forces(double dt);
  double power_of_weight(double dt);
  void book_filtered_strain(double dt);
  void find_constrained_slots();
  void copy_constrained_velocity();
  void add_gravity_corrections(double dt);
  double gravity_corrections_at(int field, std::size_t edge, int component) const;
  void account_gravity_corrections(double dt);
  void take_gravity(double time);
  void accelerate(double dt);
  void damp(const StepInfo& step);
  void divide_and_accelerate(double dt);
  void extend_largest_by_edges();
  void account_for_impulses(double dt);
  void account_for_block(int field, std::uint32_t first, double dt, bool with_impulses, double* partial);
  void subtract_velocity_before();

  void fold_heat(FaceNodes& face, std::size_t pair, int field, double time);
  void fold_heat_onto_itself(const FaceNodes& face, int field);
  void find_gradients(int axis, double time);
  double gradient_before_folds(const FaceNodes& face, int field, const Vector3& x) const;
  std::uint32_t node_at_place(const Vector3& x, int axis, int cells) const;
  double flux_through(const FaceNodes& face, int field, const Vector3& x, double time, bool divided);
  double gradient_at(const FaceNodes& face, int field, const Vector3& x, double time, bool divided);
  double capacity_inward(const FaceNodes& face, int field, std::uint32_t node);
  template <class Change>
  double for_each_temperature(Change&& change);
  void heat_through(const FaceNodes& face, double time, double dt);
  void heat_box(const BoxNodes& box, double time, double dt);
  void impose_temperatures(double time, double& from_walls, double& from_boxes);
  struct Beyond {
    double held = 0, others = 0;  ///< J
  };
  Beyond fill_temperature_ghosts(double time);

  static double time_of(const Pass& pass, const StepInfo& step) {
    return pass.stage == Stage::after_forces ? step.time + step.dt : step.time;
  }
  void copy_velocity(Channel from, Channel to);
  void restore(Channel channel, Channel kept_channel, bool keeps_correction);
  void add(Channel correction, Channel channel);
  double mass_norm_of_increment();
  void keep_free_velocity(bool after_forces);
  void measure_constraints();
  void constrain_free(const Pass& pass, const StepInfo& step);
  void constrain(const Pass& pass, const StepInfo& step);
  void update_block(int field, std::uint32_t first, std::uint32_t iteration);

  /// The occasion for which contact is recorded: in a filter's loop the force alone is.
  enum class Recorded { before_forces, after_forces, remap, filter };
  struct ContactSums;
  struct ContactBatch;
  struct ContactField;
  struct RigidChunk;
  void resolve_contact(const StepInfo& step, Recorded recorded, Stage stage, double time);
  void resolve_pairs(const StepInfo& step, std::vector<ContactSums>& sums, ContactGiven& given);
  static ContactRecord record_of(const std::vector<ContactSums>& sums);
  void find_contact_points();
  /// Records the force that particles take when they gather the velocity as it is now.
  void record_force(const StepInfo& step);
  template <class Visit>
  void visit_pairs(std::uint32_t slot, Visit&& visit);
  bool held_by_grips(int field, std::uint32_t node, T mass);
  void resolve_slot(std::uint32_t slot, const StepInfo& step, ContactSums& sums);
  void measure_welds();
  static bool reads_traction(const Component& law) { return (law.plugin->contact().traits & MPM_READS_TRACTION) != 0; }
  /// Calls the law along the pairs' normals, or along those of the second body's own.
  void call_law(const Component& law, ContactBatch& batch, std::uint32_t end, double dt, bool of_b) const;
  void apply_law(ContactBatch& batch, int a, int b, const StepInfo& step, ContactSums& sums);
  void note_reached(const ContactBatch& batch, int a, int b, int states);
  void note_nodes(const ContactBatch& batch, int a, int b, std::vector<NodeGiven>& nodes) const;
  void see_rigid_body(const RigidChunk& chunk, int field, ContactBatch& batch, std::size_t* listed);
  void meet_rigid_body(const RigidChunk& chunk, const StepInfo& step, RigidGiven& given);
  void meet_rigid_bodies(double time, const StepInfo& step, ContactGiven& all, ContactRecord& record);

  Q gravity_{}, gravity_without_potential_{};  ///< all of it, and the part that has none, m/s^2
  const Scene<D, T>& scene_;
  Grid<D, T>& grid_;
  Ledger& ledger_;
  HeatLedger& heat_ledger_;
  ContactRecord& record_;
  ContactImpulse impulse_;
  FilterRecord& filter_;
  ReactionImpulse& reactions_;
  const PairGeometry pair_geometry_;
  const bool own_normals_;                                      ///< each body of a pair has its own
  const double strain_cap_ = strain_cap_of(scene_.experiment);  ///< of contact, 0 for none
  std::uint32_t law_stage_ = MPM_BEFORE_FORCES;                 ///< what laws are asked about now (mpm_contact_stage)
  bool first_step_ = false, notes_reached_ = false;             ///< whether what a law says of its state counts
  const std::vector<EdgeModel> edges_;                          ///< of each velocity field, beside rigid bodies
  RigidBodies rigid_;
  ContactPoints contact_points_;
  ContactWelds welds_;  ///< where the law reads the traction around a node
  std::function<void(ContactPoints&)> show_particles_;
  std::array<std::vector<Channel>, 3> folded_;  ///< [when]
  struct Signs {
    Q of;
  };
  /// A node that a grip holds in this step.
  struct GrippedNode {
    int field;
    std::uint32_t node;
    std::size_t grip;
    Vector3 x;  ///< m
  };
  std::vector<GrippedNode> gripped_;
  /// Who holds a component of a node in the imposition under way, and the impulse that it has given it.
  struct Holder {
    int support;
    Vector3 impulse{};  ///< kg m/s
  };
  /// The velocity of a node before the imposition under way. It has a name, as GCC warns of vectors as template arguments.
  struct Before {
    Q velocity;
  };
  std::unordered_map<std::uint64_t, Before>
      before_;                            ///< of nodes that the imposition holds, where conditions may overlap
  bool keeps_before_conditions_ = false;  ///< a separating condition may share nodes with one before it
  std::unordered_map<std::uint64_t, Holder> holders_;  ///< where reactions are noted
  std::vector<Channel> grip_channels_;                 ///< of the masses of their particles
  bool grips_at_end_ = false;      ///< nodes are held as particles are told for the end of the step, not as they were
  std::vector<Signs> signs_;       ///< signs of folded_[with_mass] at the face that is folded now
  std::vector<Channel> slipping_;  ///< channels that vanish across a wall on its nodes
  /// The partial sums of account_for_block.
  enum Partial {
    of_internal_force,
    of_external,  ///< the first of the kinds of ExternalForce
    of_gravity = of_external + external_force_count,
    of_gravity_without_potential,
    of_boundary,
    of_contact,
    of_damping,
    of_filter,
    of_motion,
    partial_count
  };
  std::vector<double> partials_;            ///< partial_count a block of a field, summed in order
  std::vector<std::uint8_t> constrained_;   ///< [slot], set by find_constrained_slots
  std::vector<double> gravity_correction_;  ///< N, [field][edge node][4]: weight folds like a force, not like a mass
  std::vector<Vector3> feet_, found_;       ///< places on a wall, m, and what it or a box gives there, m/s; empty: rest
  Scattered particles_;
  double scattered_energy_ = 0;      ///< kinetic energy of the grid as it was scattered, J
  double works_ = 0;                 ///< works on the grid since the scatter, J
  double kinetic_energy_after_ = 0;  ///< kinetic energy of the velocities after the last apply_forces or filter, J
  double lumped_power_ = 0;          ///< work of the stresses' forces at v+ before any filter, J
  double lumped_lift_ = 0;           ///< the same of gravity, J
  double work_of_folds_ = 0;         ///< energy that folding at walls gives the nodes in this step, J
  double early_share_ = 0;           ///< share of a step's strain that comes before the forces
  const WallWeights wall_weights_;   ///< empty where no heat comes through a wall
  double particle_heat_ = 0, heat_after_ = 0;
  std::vector<std::unordered_map<std::uint32_t, double>> gradients_;  ///< K/m, inward at nodes of walls, by field
  Beyond beyond_;                                                     ///< heat of the temperatures before the forces
  double heat_of_folds_ = 0, rate_of_folds_ = 0;  ///< J and W that nodes have since their ghosts were folded
  bool has_gravity_ = false;
  bool may_merge_ = false;        ///< see merges: momentum_to_velocity leaves the division to apply_forces
  bool accounted_ = false;        ///< the ledger takes its entries from the step under way
  bool records_ = false;          ///< the stage under way notes its impulses
  bool notes_reactions_ = false;  ///< supports note what they give in the stage under way
  T largest_ = 0;                 ///< see largest_component
};

}  // namespace mpm::cpu

/// What instantiation.cpp.in makes of this header and its parts for every dimension and scalar.
#define MPM_INSTANTIATE_GRID(D, T) \
  template class Grid<D, T>;       \
  template class GridStep<D, T>;
