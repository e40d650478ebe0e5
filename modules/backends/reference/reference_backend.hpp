#pragma once
// The reference backend is the material point method of the textbook in plain double precision: one pass after another,
// every particle and node spelled out. It is slow on purpose, and every faster backend is tested against it.
//  transfers.cpp: particles to grid and back; grid_step.cpp: momenta, conditions and forces; contact.cpp: pairs of
//  fields; filter.cpp: velocity filters; temperature.cpp: heat; dilation.cpp: averages against locking; reference_backend.cpp: the rest.

#include <array>
#include <deque>
#include <optional>
#include <string_view>
#include <vector>

#include "backends/reference/particles.hpp"
#include "simulation/contact_impulse.hpp"
#include "simulation/contact_pair.hpp"
#include "simulation/loads.hpp"
#include "simulation/rigid_bodies.hpp"

namespace mpm::reference {

class ReferenceBackend final : public Backend {
 public:
  ReferenceBackend(const Experiment& experiment, const Plan& plan, const std::vector<SeededBody>& seeded);

  std::string_view name() const override { return "reference"; }
  void execute(const Pass& pass, const StepInfo& step) override;
  TimeStepLimit time_step_limit() const override { return limit_; }
  BodyState body_state(int body) const override { return bodies_[body].state(); }
  const Ledger& ledger() const override { return ledger_; }
  HeatLedger heat_ledger() const override { return heat_ledger_; }
  const ContactRecord& contact_record() const override { return contact_; }
  const std::vector<PairRecord>& contact_pairs() const override { return impulse_.pairs(); }
  const std::vector<ContactNode>& contact_nodes() const override { return impulse_.nodes(); }
  const FilterRecord& filter_record() const override { return filter_; }
  const std::vector<Reaction>& reactions() const override { return reactions_.reactions(); }
  const std::vector<RigidState>& rigid_bodies() const override { return rigid_.states(); }
  bool scattered() const override { return false; }
  void save(ArchiveWriter& archive) const override;
  void restore(ArchiveReader& archive) override;
  std::uint64_t grid_bytes() const override { return grid_.bytes(); }
  std::uint64_t particle_bytes() const override;

 private:
  void estimate_time_step();
  void move(const StepInfo& step);
  template <int D>
  Vector move_corners(Particles& body, int index, std::size_t p) const;
  /// Wraps periodic axes; throws RunFailure where a particle is not a number or beyond a wall.
  void keep_inside(Vector& x, int body, std::size_t p) const;
  // ---- transfers.cpp
  void scatter(const Pass& pass, const StepInfo& step);
  void scatter_momentum(Particles& body, double time, bool remap);
  void scatter_affine(Particles& body, VectorField& momentum);
  void scatter_force(Particles& body);
  void scatter_loads(Particles& body, const BodyLoads& loads, double time);
  void scatter_contact_fields(Particles& body);
  void scatter_grips(Particles& body, double time);
  Vector velocity_of_gripped(Particles& body, std::size_t p, double time) const;
  void move_gripped(Particles& body, const StepInfo& step);
  void gather(const Pass& pass, const StepInfo& step);
  void gather_moments(Particles& body, const VectorField& velocities);
  void strain(const Pass& pass, const StepInfo& step);
  void strain(Particles& body, double dt);
  void gather_corners(Particles& body, const StepInfo& step);
  void gather_higher(Particles& body, const VectorField& velocities);

  // ---- grid_step.cpp
  void momentum_to_velocity(const Pass& pass, const StepInfo& step);
  /// Sets the momenta that conditions give.
  void impose_conditions(double time);
  void note_held(const std::vector<Held>& all, std::size_t i, const Vector& given);
  void record_reactions(const StepInfo& step);
  void damp(const StepInfo& step);
  void keep_free_velocity(bool after_forces);
  void measure_constraints();
  void apply_forces(const StepInfo& step);
  /// A node without mass has no velocity.
  Vector over_mass(const Vector& momentum, std::size_t i) const {
    return mass_[i] > 0 ? Vector(momentum / mass_[i]) : Vector(Vector::Zero());
  }

  // ---- contact.cpp
  /// The effect of the law on one pair of velocity fields at one node.
  struct PairResult {
    Vector impulse = Vector::Zero();    ///< added to a, kg m/s
    Vector returned = Vector::Zero();   ///< taken from b: the same, unless each has a normal of its own
    double dissipated = 0, stored = 0;  ///< J
    std::int32_t status = MPM_APART;
    ContactGeometry geometry{};
    Vector reached = Vector::Zero();  ///< by state of the law, where it has some
  };
  /// What the particles of a field keep for the law, and what the last step has added, as means by mass at a node.
  struct KeptAtNode {
    Vector state = Vector::Zero(), gained = Vector::Zero();
  };
  KeptAtNode kept_at(std::size_t i) const;
  /// Notes at a node of one field what its pair has reached.
  void note_reached(std::size_t i, const Vector& reached);
  void keep_contact_state();
  ContactGiven nothing_given() const;
  /// Adds what the law did at a node to all pairs, to its own where pairs are recorded apart, and to the recorded nodes.
  void count(const PairResult& result, std::size_t a, std::size_t b, bool notes_node, ContactGiven& given) const;
  /// Returns nothing when a pair is skipped: a field is absent or too light, or has no normal (and the law is no weld).
  std::optional<PairResult> resolve_pair(std::size_t a, std::size_t b, const Vector& momentum_a,
                                         const Vector& momentum_b, const StepInfo& step) const;
  ContactFieldNode contact_view(std::size_t i) const;
  /// Two fields that meet at a node, with how they lie there; nothing when a pair is skipped.
  std::optional<MetPair> meet_pair(std::size_t a, std::size_t b) const;
  template <class MomentumOf>
  void measure_welds(MomentumOf momentum);
  Vector traction_at(std::size_t a, std::size_t b, double dt) const;
  /// What a law is told of a pair.
  struct LawInput {
    double mass_a, mass_b;
    Vector momentum_a, momentum_b;
    ContactGeometry geometry;
    const double* normal;  ///< from a to b, along which the law acts
    double dt;
    Vector displacement = Vector::Zero();  ///< of b beside a, m, where the law reads it
    Vector traction = Vector::Zero();      ///< on a, Pa, where the law reads it
    KeptAtNode kept_a{}, kept_b{};         ///< where the law has a state
    bool first_step = false;
  };
  PairResult apply_law(const Component& law, const LawInput& input) const;
  /// Whether grips hold a body of a pair as a whole.
  bool held_in_pair(std::size_t i, std::size_t other) const;
  /// A pair as laws see it.
  struct SeenPair {
    double mass_a, mass_b;
    Vector momentum_a, momentum_b;
  };
  /// Where grips hold one body alone, as a whole, what a law would give it goes to the grip: the law sees it as a body b of
  /// infinite mass at rest, and the other one moves beside it.
  SeenPair seen_pair(std::size_t a, std::size_t b, const Vector& momentum_a, const Vector& momentum_b) const;
  PairResult capped(PairResult result, const SeenPair& seen, double dt) const;
  /// Lets the material of all fields meet rigid bodies, whose velocities are those of a time, s. velocity(i) is that of a
  /// node and give(i, impulse) changes it.
  template <class VelocityOf, class Give>
  void meet_rigid_bodies(double time, double dt, VelocityOf velocity, Give give, ContactGiven& all,
                         ContactRecord* record);
  void find_contact_points();
  /// Applies the law to all pairs of fields in order; conditions are imposed again and win.
  void resolve_contact(const StepInfo& step, bool after_forces, bool remap = false);
  Vector resolve_pairs(const StepInfo& step, bool after_forces, ContactGiven& given);
  ContactGiven resolve_contact_of_velocity(double time, const StepInfo& step);
  /// Records the force that particles take when they gather the velocity as it is now.
  void record_force(const StepInfo& step);

  // ---- filter.cpp
  void begin_filter(const Pass& pass);
  void project(const Pass& pass, const StepInfo& step);
  void update_filter(const Pass& pass, const StepInfo& step);
  void call_filter(int field);
  void end_filter(const Pass& pass, const StepInfo& step);
  void restore_velocity(const Pass& pass, const StepInfo& step);
  void add_correction(const Pass& pass, const StepInfo& step);
  void constrain_free_velocity(const Pass& pass, const StepInfo& step);
  void constrain_velocity(const Pass& pass, const StepInfo& step);
  void impose_on_velocity(double time);

  // ---- ledger.cpp
  /// Notes an impulse on a node where conditions or contact apply it.
  void record(VectorField& impulse, VectorField& standing, std::size_t i, const Vector& given);
  void take_back(std::size_t i);
  void book(double Ledger::*row, double work);
  void book_scattered_sums();
  void book_scatter();
  void book_impulses();
  void book_filter();
  void book_forces(double dt);
  void book_gather(const Pass& pass, double dt);
  void book_filtered_strain(double dt);
  double power_of_forces(double dt);
  double power_of_weight(double dt);
  double particle_kinetic_energy() const;
  Ledger* ledger_to_book() { return records_ ? &ledger_ : nullptr; }

  // ---- temperature.cpp
  void scatter_heat(Particles& body);
  void divide_heat(const StepInfo& step);
  void conduct();
  void heat(const StepInfo& step);
  void heat_through_walls(const StepInfo& step);
  void heat_through_wall(const FaceCondition& face, int axis, int side, const StepInfo& step);
  void heat_boxes(const StepInfo& step);
  void impose_temperatures(double time, double& from_walls, double& from_boxes);
  void hold_temperature(std::size_t i, double value, double& ledger);
  void gather_heat(Particles& body, const StepInfo& step);
  void change_phase();
  /// Adds to an entry of the heat ledger, where there is one.
  void account(double& row, double heat) const {
    if (plan_.has_heat_ledger()) row += heat;
  }
  double heat_of_particles() const;
  double sum(const ScalarField& field);
  double heat_of_temperature();

  // ---- dilation.cpp
  void scatter_mean_stress();
  void scatter_dilation(const Pass& pass, const StepInfo& step);
  /// Computes the mean of what was summed by volume, as masses were folded.
  void average(ScalarField& sum, ScalarField& volume, ScalarField& mean);
  /// The sum of w times a value of the nodes, at each particle.
  Array gathered(Particles& body, const ScalarField& of_nodes);

  /// Calls `visit(i)` for every node of every velocity field.
  template <class Visit>
  void for_each_node(Visit visit) {
    for (std::size_t i = 0; i < grid_.size(); ++i) visit(i);
  }
  /// Calls `visit(a, b)` for every two velocity fields at every node.
  template <class Visit>
  void for_each_pair(Visit visit) {
    for (int a = 0; a < grid_.velocity_fields(); ++a)
      for (int b = a + 1; b < grid_.velocity_fields(); ++b)
        for (std::size_t node = 0; node < grid_.node_count(); ++node) visit(grid_.at(a, node), grid_.at(b, node));
  }

  /// What a weld would give a pair at a node: the impulse on its first field, kg m/s, and the area, m^2.
  struct Weld {
    Vector impulse = Vector::Zero();
    double area = 0;
  };
  /// By the numbers of both fields and the coordinates of the node, where the law reads the traction.
  std::map<std::pair<int, int>, std::map<std::array<int, 3>, Weld>> welds_;

  const Experiment& experiment_;
  const Plan& plan_;
  Grid grid_;
  // These references name fields of the nodes as the text of the method does.
  ScalarField& mass_ = grid_.scalar("mass");
  VectorField& momentum_ = grid_.vector("momentum");
  VectorField& velocity_before_ = grid_.vector("velocity_before");  ///< v-
  VectorField& velocity_ = grid_.vector("velocity");                ///< v+ (or v- until the forces are applied)
  VectorField& internal_force_ = grid_.vector("force");
  VectorField& weight_ = grid_.vector("weight");
  /// A kind of force from outside, its field of the nodes and its entry of the ledger.
  struct External {
    ExternalForce kind;
    VectorField* force;
    double Ledger::*row;
  };
  std::vector<External> external_forces_;                           ///< those that the scene has
  std::vector<BodyLoads> loads_;                                    ///< of each body
  VectorField& volume_gradient_ = grid_.vector("volume_gradient");  ///< sum V grad w
  VectorField& mass_gradient_ = grid_.vector("mass_gradient");      ///< sum m grad w
  const bool sums_mass_gradients_ = plan_.node_field("mass_gradient") != nullptr;
  VectorField& mass_displacement_ = grid_.vector("mass_displacement");  ///< sum w m (x_p - X_p)
  const bool sums_displacements_ = plan_.node_field("mass_displacement") != nullptr;
  VectorField &mass_state_ = grid_.vector("mass_state"), &mass_gain_ = grid_.vector("mass_gain");
  VectorField& reached_ = grid_.vector("reached");  ///< what the law says of its state
  ScalarField& met_ = grid_.scalar("met");          ///< 1 where the field has met another
  const int contact_states_ = static_cast<int>(experiment_.contact_state().size());
  std::uint32_t law_stage_ = MPM_BEFORE_FORCES;                 ///< what laws are asked about now (mpm_contact_stage)
  VectorField& mass_position_ = grid_.vector("mass_position");  ///< sum w m (x_p - x_node)
  const bool sums_mass_positions_ = plan_.node_field("mass_position") != nullptr;
  VectorField& increment_ = grid_.vector("increment");    ///< v* of the filter
  VectorField& projection_ = grid_.vector("projection");  ///< S+ S v*, a momentum until over_mass divides it
  VectorField& trial_velocity_ = grid_.vector("trial_velocity");
  VectorField& unfiltered_ = grid_.vector("unfiltered_velocity");
  /// The velocities that conditions and contact have added in this step.
  VectorField& constrained_ = grid_.vector("velocity_of_constraints");
  const bool keeps_constraints_ = plan_.node_field("velocity_of_constraints") != nullptr;
  VectorField& unfiltered_constrained_ = grid_.vector("unfiltered_velocity_of_constraints");
  // Impulses of the stage under way, and of all stages where a filter's loop may take them back.
  VectorField &boundary_impulse_ = grid_.vector("boundary_impulse"),
              &contact_impulse_ = grid_.vector("contact_impulse"), &filter_impulse_ = grid_.vector("filter_impulse"),
              &standing_boundary_impulse_ = grid_.vector("standing_boundary_impulse"),
              &standing_contact_impulse_ = grid_.vector("standing_contact_impulse"),
              &damping_impulse_ = grid_.vector("damping_impulse");
  ScalarField &heat_ = grid_.scalar("heat"), &heat_capacity_ = grid_.scalar("heat_capacity");
  ScalarField& temperature_before_ = grid_.scalar("temperature_before");  ///< T-
  ScalarField& temperature_ = grid_.scalar("temperature");                ///< T+ (or T- until it is heated)
  ScalarField &heat_rate_ = grid_.scalar("heat_rate"), &heated_volume_ = grid_.scalar("heated_volume");
  ScalarField& volume_conductivity_ = grid_.scalar("volume_conductivity");
  VectorField& capacity_position_ = grid_.vector("capacity_position");
  ScalarField &volume_rate_ = grid_.scalar("volume_rate"), &strained_volume_ = grid_.scalar("strained_volume");
  ScalarField& dilation_ = grid_.scalar("dilation");  ///< mean by volume of the particles', 1/s
  ScalarField &volume_stress_ = grid_.scalar("volume_stress"), &stressed_volume_ = grid_.scalar("stressed_volume");
  ScalarField& mean_stress_ = grid_.scalar("mean_stress");  ///< the same of their mean normal stress, Pa
  const WallWeights wall_weights_ = plan_.node_field("heated_volume") ? wall_weights(experiment_) : WallWeights();
  std::deque<Particles> bodies_;
  const PairGeometry pair_geometry_{experiment_, MPM_SCALAR_DOUBLE};
  ContactPoints contact_points_{experiment_};
  const std::vector<EdgeModel> edges_ = edge_models(experiment_);  ///< of each velocity field
  TimeStepLimit limit_;
  Ledger ledger_;
  HeatLedger heat_ledger_;
  bool accounted_ = false;       ///< the ledger takes its entries from the step under way
  bool records_ = false;         ///< the pass under way notes its impulses
  double scattered_energy_ = 0;  ///< kinetic energy of the grid as it was scattered, J
  double works_ = 0;             ///< works on the grid since the scatter, J
  double energy_after_ = 0;      ///< kinetic energy of the grid after the forces or the last filter, J
  double lumped_power_ = 0;      ///< work of the stresses' forces at v+ before any filter, J
  double lumped_lift_ = 0;       ///< the same of gravity, J
  double early_share_ = 0;       ///< share of the step's strain that came before the forces
  double given_to_gripped_ = 0;  ///< energy that grips have given their particles after the gather, J
  ContactRecord contact_;
  ContactImpulse impulse_;
  ReactionImpulse reactions_;
  RigidBodies rigid_{experiment_};
  bool notes_reactions_ = false;  ///< the pass under way notes what supports give
  FilterRecord filter_;
  double held_beyond_ = 0, others_beyond_ = 0;  ///< heat of Grid::heat_beyond_walls before the forces
  double heat_after_ = 0;                       ///< heat of the grid when particles gather from it, J
};

}  // namespace mpm::reference
