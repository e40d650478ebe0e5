#pragma once
// The memory that a run takes on a device, by the list of its fields.

#include "backends/device/device.hpp"
#include "backends/device/kernels/totals_list.hpp"
#include "simulation/backend.hpp"

namespace mpm::device {

/// What a field, or what is kept beside the fields, takes on a device.
struct TakenMemory {
  std::string field;
  int body = -1;  ///< whose particles; of_nodes or of_run where it is no body's
  int components = 1;
  double bytes = 0;
  bool working = false;  ///< holds nothing between steps

  static constexpr int of_nodes = -1, of_run = -2;
};

/// The sums over one body of which its totals are made.
inline constexpr int count_of_totals = int{motion_sums} + state_sums + heat_sums;

/// How large a scene is on a device.
struct SceneSize {
  std::vector<std::size_t> particles;  ///< of each body
  std::size_t nodes = 0;               ///< of the grid
  int blocks = 0;                      ///< of the grid, ghosts too (table_of_blocks)
  int lanes = 1;                       ///< of a team
  std::vector<std::size_t>
      load_shares{};  ///< of each body: what its particles carry of loads at points; empty for none
};

/// What one particle of each body and one node of the grid take, for all velocity fields; not the shares of loads at points,
/// whose number is known when particles are seeded.
std::vector<TakenMemory> taken_by_one(const Experiment& experiment, const Plan& plan);

/// All that grows with the particles, the nodes and the blocks of a scene, for all velocity fields, and what a run sums.
/// Beside it there are tables of a fixed length, as of parameters, the edges of bodies and what walls and boxes give, and
/// the nodes near rigid bodies.
std::vector<TakenMemory> taken_memory(const Experiment& experiment, const Plan& plan, const SceneSize& size);

/// How many partial sums there is room for: all that teams of so many lanes make of the particles of the largest body, or
/// of the nodes.
std::size_t room_for_sums(const SceneSize& size);

/// Throws DeviceError where the device has less memory free than the scene will take; the message says how much is asked
/// and free, and what takes most.
void refuse_what_does_not_fit(const Device& device, const Experiment& experiment, const Plan& plan,
                              const SceneSize& size);

}  // namespace mpm::device
