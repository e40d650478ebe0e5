#pragma once
// What a run holds and does, and which line of the experiment asked for it. Backends allocate and execute exactly this.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/experiment.hpp"
#include "plan/field.hpp"
#include "plan/step.hpp"

namespace mpm {

/// Name of the coefficients of polynomials beyond affine among a particle's transfer state: [function][D], m/s per
/// power of a cell.
inline constexpr const char* polynomial_coefficients = "polynomial_coefficients";

/// What the id of a particle field begins with that is the transfer's state for the temperature: of a matrix its row 0.
inline constexpr const char* temperature_state = "temperature_of_";
inline std::string temperature_state_of(const std::string& state_of_transfer) {
  return temperature_state + state_of_transfer;
}

struct Plan {
  std::vector<Field> fields;
  int velocity_fields = 1;  ///< that a node holds all its fields for
  Step step;                ///< all that one step of time does

  bool weight_gradients = false;    ///< a pass reads grad w
  bool affine_moment = false;       ///< a pass gathers C
  bool separate_force = false;      ///< force has a channel of its own (else it is merged into momentum as dt f)
  bool velocity_increment = false;  ///< v+ - v- is kept and gathered
  bool contact = false;
  bool ledger = false;
  int ledger_every = 1;                   ///< steps between entries of the ledger
  bool force_for_ledger = false;          ///< nothing but the ledger asks for separate_force
  bool heat_ledger = false;               ///< the heat that comes and goes is recorded in every step
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
  bool divides_with_forces = false;       ///< nothing but the ledger reads velocities between divide and accelerate
  bool fused = false;                     ///< a gather scatters for the next step
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
  /// The step as a picture: operators, the fields that they use, loops and conditions, and who asked for each.
  std::string to_svg(const std::string& title) const;
};

/// How a backend works, as far as it changes what a step holds and does.
struct BackendNeeds {
  bool sorts = false;               ///< particles are put in order, and must stay so
  bool fuses = false;               ///< a gather may scatter for the next step in one visit of a particle
  bool forgets_stencils = false;    ///< weights are evaluated anew in every pass
  bool keeps_all_apart = false;     ///< nothing is merged or shares memory
  bool keeps_weight_apart = false;  ///< gravity's force has a field of its own, "weight"
};
BackendNeeds backend_needs(std::string_view backend);

}  // namespace mpm
