#pragma once
// The textbook: the material point method in plain double precision, one pass after another, every particle and node
// spelled out. Slow on purpose; every faster backend is tested against it.
//  transfers.cpp: particles to grid and back; grid_step.cpp: momenta, conditions and forces; contact.cpp: pairs of
//  fields; filter.cpp: velocity filters; reference_backend.cpp: the rest.

#include <optional>
#include <string_view>
#include <vector>

#include "backends/reference/particles.hpp"
#include "simulation/contact_pair.hpp"

namespace mpm::reference {

class ReferenceBackend final : public Backend {
 public:
  ReferenceBackend(const Experiment& experiment, const Plan& plan, const std::vector<SeededBody>& seeded);

  std::string_view name() const override { return "reference"; }
  void execute(const Pass& pass, const StepInfo& step) override;
  TimeStepLimit time_step_limit() const override { return limit_; }
  BodyState body_state(int body) const override { return bodies_[body].state(); }
  const Ledger& ledger() const override { return ledger_; }
  const ContactRecord& contact_record() const override { return contact_; }
  const FilterRecord& filter_record() const override { return filter_; }
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
  /// Rows of particles a cell of the coarsest body in a field: its surface lags the most.
  int rows_per_cell(int field) const;
  double particle_kinetic_energy() const;

  // ---- transfers.cpp
  void scatter(const Pass& pass, const StepInfo& step);
  void scatter_momentum(Particles& body, bool remap);
  void scatter_force(Particles& body, double time);
  void scatter_contact_fields(Particles& body);
  void gather(const Pass& pass, const StepInfo& step);
  void gather_moments(Particles& body, Vector Node::*velocity);
  void strain(const Pass& pass, const StepInfo& step);
  void strain(Particles& body, double dt);
  void gather_corners(Particles& body, const StepInfo& step);
  void add_higher(const Particles& body, std::size_t p, Vector Node::*momentum);
  void gather_higher(Particles& body, Vector Node::*velocity_of);

  // ---- grid_step.cpp
  void momentum_to_velocity(const Pass& pass, const StepInfo& step);
  /// Sets the momenta that conditions give.
  void impose_conditions(double time);
  void keep_free_velocity(bool after_forces);
  void measure_constraints();
  void apply_forces(const StepInfo& step);
  void account_for_impulses(const Node& node, double dt);

  // ---- contact.cpp
  /// What the law does to one pair of fields at one node.
  struct PairResult {
    Vector impulse = Vector::Zero();  ///< added to a, taken from b, kg m/s
    double dissipated = 0;            ///< J
    std::int32_t status = MPM_APART;
    double separation = 0;  ///< m
    bool has_normal = false;
  };
  /// Nothing when the pair is skipped: a field is absent, too light, or there is no normal (and the law is no weld).
  std::optional<PairResult> resolve_pair(int a, int b, std::size_t node, const Vector& momentum_a,
                                         const Vector& momentum_b, double dt) const;
  /// All pairs of fields, in order; conditions are imposed again and win.
  void resolve_contact(const StepInfo& step, bool after_forces, bool remap = false);

  // ---- filter.cpp
  void begin_filter(const Pass& pass);
  void project(const Pass& pass, const StepInfo& step);
  void scatter_projection(Particles& body);
  void update_filter(const Pass& pass, const StepInfo& step);
  void call_filter(int field);
  void end_filter(const Pass& pass, const StepInfo& step);
  void restore_velocity(const Pass& pass);
  void add_correction(const Pass& pass, const StepInfo& step);
  void constrain_free_velocity(const Pass& pass, const StepInfo& step);
  void constrain_velocity(const Pass& pass, const StepInfo& step);
  void impose_on_velocity(double time);
  void resolve_contact_of_velocity(double dt);

  /// Calls `visit(node)` for every node of every field.
  template <class Visit>
  void for_each_node(Visit visit) {
    for (int field = 0; field < grid_.field_count(); ++field)
      for (std::size_t i = 0; i < grid_.node_count(); ++i) visit(grid_.node(field, i));
  }

  const Experiment& experiment_;
  const Plan& plan_;
  Grid grid_;
  std::vector<Particles> bodies_;
  std::vector<EdgeModel> edges_;
  TimeStepLimit limit_;
  Ledger ledger_;
  bool accounted_ = false;  ///< the ledger takes its entries from the step under way
  ContactRecord contact_;
  FilterRecord filter_;
  double kinetic_energy_after_ = 0;       ///< of the grid when particles gather from it, J
  double kinetic_energy_unfiltered_ = 0;  ///< of the grid when the filter began, J
};

}  // namespace mpm::reference
