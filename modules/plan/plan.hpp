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

/// The id of the field of nodes that holds what a grip's particles give them.
inline std::string grip_field(std::size_t grip) {
  return "grip_" + std::to_string(grip);
}

/// What a visit of a particle evaluates of its stencil, beside the weights.
struct StencilNeeds {
  bool gradients = false;      ///< of the weights
  bool affine_moment = false;  ///< of the velocities, which becomes C
  bool second_moment = false;  ///< of the shape, a particle
};

/// How particles go from one scatter to the next on a device, whose passes are launches.
enum class Advance {
  apart,             ///< gather, strain, move and stress are launches, between which values wait in memory
  unless_accounted,  ///< one launch does all of it, but in steps that the ledger takes
  at_once            ///< one launch does all of it, and nothing waits
};

struct Plan {
  std::vector<Field> fields;
  Step step;                ///< all that one step of time does
  std::uint32_t acts = 0;   ///< bit of each act of the step, see `does`
  int velocity_fields = 1;  ///< that a node holds all its fields for
  int ledger_every = 0;     ///< steps between entries of the ledger; 0: there is none
  int sample_points = 0;    ///< corners of a particle's domain that the grid's velocity moves
  int basis_order = 0;      ///< highest power along an axis of the polynomials beyond affine; 0: none
  int basis_functions = 0;  ///< how many a particle carries (kernel/polynomial_basis.hpp)
  StencilNeeds stencil;
  std::string why_not_fused;  ///< why no gather scatters for the next step; empty where one does
  Advance advance = Advance::apart;

  std::uint64_t particles = 0, nodes = 0;  ///< estimates before seeding
  std::uint64_t particle_bytes = 0, grid_bytes = 0;

  bool does(Act act) const { return (acts >> static_cast<int>(act) & 1) != 0; }
  bool fused() const { return why_not_fused.empty(); }
  bool filters() const { return does(Act::begin_filter); }
  bool resolves_contact() const { return does(Act::scatter_contact); }
  bool has_ledger() const { return ledger_every > 0; }
  /// Whether the heat that comes and goes is recorded, in every step.
  bool has_heat_ledger() const { return has_ledger() && does(Act::scatter_heat); }
  /// Whether nothing but the ledger reads velocities between v- = p / m and the forces.
  bool divides_with_forces() const;
  /// The first of the step's passes, and of its operators, with this act; null where none has it.
  const Pass* pass_of(Act act) const;
  const Operator* find(Act act) const;

  /// Whether the ledger takes its entries from this step (counted from 0): the first, where bodies meet what they were
  /// put on, counts for itself; each other in the middle of those that it counts for.
  bool accounts_at(long step) const {
    return has_ledger() && (step == 0 || (step - 1) % ledger_every == ledger_every / 2);
  }
  /// How many of the first `steps` steps those are.
  long accounts_within(long steps) const {
    return has_ledger() && steps > 0 ? 1 + (steps - 1 + (ledger_every - 1) / 2) / ledger_every : 0;
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
  bool sorts = false;             ///< particles are put in order, and must stay so
  bool fuses = false;             ///< a gather may scatter for the next step in one visit of a particle
  bool forgets_stencils = false;  ///< weights are evaluated anew in every pass
  bool keeps_all_apart = false;   ///< nothing is merged, and gravity's force always has a field of its own
  bool shares_memory = false;     ///< a field of nodes may take the place of one that nobody reads any more
  bool launches = false;          ///< passes are launches of a device, see Advance
};
BackendNeeds backend_needs(std::string_view backend);

}  // namespace mpm
