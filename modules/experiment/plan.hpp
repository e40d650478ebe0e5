#pragma once
// What a run holds and does, and which line of the experiment asked for it. Backends allocate and execute exactly this.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"

namespace mpm {

/// One field every particle of a body carries.
struct PlannedAttribute {
  int body = 0;
  std::string name;  ///< "position", "velocity", or a state field of the transfer or material
  int components = 1;
  std::uint64_t bytes_per_particle = 0;
  std::string because;  ///< JSON pointer of what asked for it, and why
};

/// One group of values every node of a velocity field carries.
struct PlannedChannel {
  std::string name;
  int components = 1;
  int copies = 1;                    ///< velocity fields
  std::uint64_t bytes_per_node = 0;  ///< of all copies
  std::string because;
};

enum class PassKind {
  estimate_time_step,    ///< wave and particle speeds -> dt, the limiting particle named
  sort,                  ///< particles into blocks of cells, when they have moved
  reset_grid,            ///< all channels to zero
  scatter,               ///< particles -> grid, what `momentum`, `force`, `contact_fields` say
  momentum_to_velocity,  ///< fold walls and periodic images, v- = p / m, contact before the forces
  apply_forces,          ///< p+ = p + dt f with boundary conditions, contact after the forces, v+
  gather,                ///< grid -> particle velocity (and strain, move as said)
  strain,                ///< grid velocity -> velocity gradient -> material state
  move                   ///< x += dt times the advection velocity kept by the gather
};

struct Pass {
  PassKind kind = PassKind::reset_grid;
  bool momentum = false;        ///< scatter: mass and momentum
  bool force = false;           ///< scatter: internal (and body) force
  bool contact_fields = false;  ///< scatter: volume gradient and surface position
  bool strain = false;          ///< gather: also advance the material with the gathered velocity gradient
  bool move = false;            ///< gather: also move the particles
  bool remap = false;           ///< scatter and momentum_to_velocity of MUSL: updated velocities, no forces follow
  int every_steps = 1;
  std::string because;

  std::string name() const;
};

struct Plan {
  std::vector<PlannedAttribute> attributes;
  std::vector<PlannedChannel> channels;
  std::vector<Pass> passes;

  bool weight_gradients = false;    ///< a pass reads grad w
  bool affine_moment = false;       ///< a pass gathers C
  bool separate_force = false;      ///< force has a channel of its own (else it is merged into momentum as dt f)
  bool velocity_increment = false;  ///< v+ - v- is kept and gathered
  bool contact = false;
  bool ledger = false;
  bool initial_position = false;  ///< particles keep X
  bool kept_advection = false;    ///< MUSL: the advection velocity waits for `move`

  std::uint64_t particles = 0, nodes = 0;  ///< estimates before seeding
  std::uint64_t particle_bytes = 0, grid_bytes = 0;

  std::uint64_t bytes_per_particle(int body) const;
  std::uint64_t bytes_per_node() const;
  nlohmann::ordered_json to_json() const;
  std::string to_text() const;
};

/// Throws InputError when shape, transfer, contact and material cannot be combined, naming both and the reason,
/// and when the scene needs more memory than the machine has (before anything is allocated).
Plan make_plan(const Experiment& experiment);

}  // namespace mpm
