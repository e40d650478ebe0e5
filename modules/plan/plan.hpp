#pragma once
// What a run holds and does, and which line of the experiment asked for it. Backends allocate and execute exactly this.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/experiment.hpp"
#include "plan/field.hpp"

namespace mpm {

/// Name of the coefficients of polynomials beyond affine among a particle's transfer state: [function][D], m/s per
/// power of a cell.
inline constexpr const char* polynomial_coefficients = "polynomial_coefficients";

enum class PassKind {
  estimate_time_step,    ///< wave and particle speeds -> dt, the limiting particle named
  sort,                  ///< particles into blocks of cells, when they have moved (or will have, see keeps_grid)
  reset_grid,            ///< all channels to zero
  scatter,               ///< particles -> grid, what `momentum`, `force`, `contact_fields` say
  momentum_to_velocity,  ///< fold walls and periodic images, v- = p / m, contact before the forces
  apply_forces,          ///< p+ = p + dt f with boundary conditions, contact after the forces, v+
  gather,                ///< grid -> particle velocity (and strain, move as said)
  strain,                ///< grid velocity -> velocity gradient -> material state
  move,                  ///< x += dt times the advection velocity kept by the gather
  gather_scatter,    ///< gather, strain, move, and the next step's reset_grid and scatter in one visit of a particle
  begin_filter,      ///< increment <- grid velocity (kept aside as well where `restores`)
  project,           ///< projected <- S+ S increment, by the transfer's own gather and scatter
  update_filter,     ///< the plugin's update at every node; conditions and contact; the increment's mass norm
  end_filter,        ///< constraints where they act at the end only; the ledger's entry; ghosts
  restore_velocity,  ///< grid velocity <- what begin_filter kept aside
  add_correction,    ///< grid velocity += the correction kept aside; conditions and contact: what the particles take
  group,             ///< children, under `condition`
  repeat             ///< children up to `times`, until |increment| <= tolerance |first|
};

/// What decides whether a group is executed in a step.
enum class PassCondition {
  always,
  unless_scattered,  ///< the previous step's gather_scatter has not filled the grid already
  when_filtered      ///< the schedule says that this step is filtered
};

struct Pass {
  PassKind kind = PassKind::reset_grid;
  bool momentum = false;          ///< scatter: mass and momentum
  bool force = false;             ///< scatter: internal (and body) force
  bool contact_fields = false;    ///< scatter: volume gradient and surface position
  bool strain = false;            ///< gather: also advance the material with the gathered velocity gradient
  bool move = false;              ///< gather: also move the particles
  double strain_share = 1;        ///< strain: of the step
  bool strains_again = false;     ///< strain: the second one of the step
  bool remap = false;             ///< scatter and momentum_to_velocity of MUSL: updated velocities, no forces follow
  bool before_forces = false;     ///< filter passes: they act on v-, before the forces
  bool restores = false;          ///< begin_filter: restore_velocity follows
  bool keeps_grid = false;        ///< sort: the grid holds this step's velocities, which the gather reads next
  bool keeps_correction = false;  ///< restore_velocity: what the filter added is kept for add_correction
  int every_steps = 1;
  PassCondition condition = PassCondition::always;
  int times = 0;  ///< of repeat
  std::string because;
  std::vector<Pass> children;  ///< of group and repeat

  std::string name() const;
};

struct Plan {
  std::vector<Field> fields;
  int velocity_fields = 1;   ///< that a node holds all its fields for
  std::vector<Pass> passes;  ///< a tree: see Pass::children

  bool weight_gradients = false;    ///< a pass reads grad w
  bool affine_moment = false;       ///< a pass gathers C
  bool separate_force = false;      ///< force has a channel of its own (else it is merged into momentum as dt f)
  bool velocity_increment = false;  ///< v+ - v- is kept and gathered
  bool contact = false;
  bool ledger = false;
  int ledger_every = 1;                   ///< steps between entries of the ledger
  bool force_for_ledger = false;          ///< nothing but the ledger asks for separate_force
  bool initial_position = false;          ///< particles keep X
  bool kept_advection = false;            ///< MUSL: the advection velocity waits for `move`
  bool filter = false;                    ///< the grid keeps an increment and its projection
  bool kept_velocity = false;             ///< the grid keeps the unfiltered velocity (a pass restores it)
  bool constrained_velocity = false;      ///< and what one-sided laws have added: an increment may take it back
  bool particle_domain = false;           ///< particles carry their domain, advanced with L where the material is
  int sample_points = 0;                  ///< corners of a particle's domain that the grid's velocity moves
  bool strained_domain = false;           ///< and its strained copy: a later pass of the step needs the old weights
  int basis_order = 0;                    ///< highest power along an axis of the polynomials beyond affine; 0: none
  int basis_functions = 0;                ///< how many a particle carries (kernel/polynomial_basis.hpp)
  bool second_moment = false;             ///< the shape's second moment is evaluated a particle
  bool velocity_gradient_moment = false;  ///< the transfer gathers L
  bool sorts_before_gather = false;       ///< velocities that the gather replaces need not travel with the particles
  bool fused = false;                     ///< a pass is gather_scatter
  std::string why_not_fused;              ///< empty when fused

  std::uint64_t particles = 0, nodes = 0;  ///< estimates before seeding
  std::uint64_t particle_bytes = 0, grid_bytes = 0;

  /// Whether the ledger takes its entries from this step (counted from 0): the first, where bodies meet what they were
  /// put on, counts for itself; each other in the middle of those that it counts for.
  bool accounts_at(long step) const { return ledger && (step == 0 || (step - 1) % ledger_every == ledger_every / 2); }
  /// How many of the first `steps` steps those are.
  long accounts_within(long steps) const {
    return ledger && steps > 0 ? 1 + (steps - 1 + (ledger_every - 1) / 2) / ledger_every : 0;
  }

  /// The field of nodes with this id; null where the scene has none.
  const Field* node_field(std::string_view id) const;
  /// The field of a body's particles that a table of this origin declares by this id; null where there is none.
  const Field* particle_field(int body, std::string_view id, Origin origin = Origin::host) const;

  std::uint64_t bytes_per_particle(int body) const;
  std::uint64_t bytes_per_node() const;
  nlohmann::ordered_json to_json() const;
  std::string to_text() const;
};

/// How a backend works, as far as it changes what a step holds and does.
struct BackendNeeds {
  bool sorts = false;               ///< particles are put in order, and must stay so
  bool fuses = false;               ///< a gather may scatter for the next step in one visit of a particle
  bool forgets_stencils = false;    ///< weights are evaluated anew in every pass
  bool keeps_all_apart = false;     ///< nothing is merged or shares memory
  bool keeps_weight_apart = false;  ///< gravity has a field of its own among the forces
};
BackendNeeds backend_needs(std::string_view backend);

/// Throws InputError when shape, transfer, contact and material cannot be combined, naming both and the reason,
/// and when the scene needs more memory than the machine has (before anything is allocated).
Plan make_plan(const Experiment& experiment);

}  // namespace mpm
