#pragma once
// This file includes all kernels and makes their entries. The composer defines Scene, and Scene0, Scene1 ... with a
// material each, in this namespace, and RigidScene0, RigidScene1 ... with the law of a rigid body. Then it says
// MPM_DEVICE_ENTRIES and those of the other groups below that the scene needs (backends/device/compose.cpp), those with
// an argument for each material or law.

#include "backends/device/kernels/advance.hpp"
#include "backends/device/kernels/conditions.hpp"
#include "backends/device/kernels/contact.hpp"
#include "backends/device/kernels/dilation.hpp"
#include "backends/device/kernels/filter.hpp"
#include "backends/device/kernels/gather.hpp"
#include "backends/device/kernels/grid.hpp"
#include "backends/device/kernels/grips.hpp"
#include "backends/device/kernels/heat.hpp"
#include "backends/device/kernels/ledger.hpp"
#include "backends/device/kernels/loads.hpp"
#include "backends/device/kernels/material.hpp"
#include "backends/device/kernels/rigid.hpp"
#include "backends/device/kernels/scatter.hpp"
#include "backends/device/kernels/sorting.hpp"
#include "backends/device/kernels/totals.hpp"

#define MPM_DEVICE_ENTRIES                                                                \
  MPM_DEVICE_PHASE(mpm_forget, forget<Scene>, 1)                                          \
  MPM_DEVICE_PHASE(mpm_clear, clear<Scene>, 1)                                            \
  MPM_DEVICE_PHASE(mpm_scatter, scatter<Scene>, mpm::device::scatter_scalars<Scene>)      \
  MPM_DEVICE_PHASE(mpm_weigh, weigh<Scene>, 1)                                            \
  MPM_DEVICE_PHASE(mpm_fold_masses, fold_masses<Scene>, mpm::device::line_scalars<Scene>) \
  MPM_DEVICE_PHASE(mpm_fold_forces, fold_forces<Scene>, mpm::device::line_scalars<Scene>) \
  MPM_DEVICE_PHASE(mpm_fill_velocities, fill_velocities<Scene>, 1)                        \
  MPM_DEVICE_PHASE(mpm_divide, divide<Scene>, 1)                                          \
  MPM_DEVICE_PHASE(mpm_impose_conditions, impose_conditions<Scene>, 1)                    \
  MPM_DEVICE_PHASE(mpm_keep_velocity, keep_velocity<Scene>, 1)                            \
  MPM_DEVICE_PHASE(mpm_accelerate, accelerate<Scene>, 1)                                  \
  MPM_DEVICE_PHASE(mpm_damp, damp<Scene>, 1)                                              \
  MPM_DEVICE_PHASE(mpm_second_moments, second_moments<Scene>, 1)

#define MPM_DEVICE_APART_ENTRIES                 \
  MPM_DEVICE_PHASE(mpm_gather, gather<Scene>, 1) \
  MPM_DEVICE_PHASE(mpm_move, move<Scene>, 1)

#define MPM_DEVICE_STRAIN_ENTRIES(n) MPM_DEVICE_PHASE(mpm_strain_##n, strain<Scene##n>, 1)

#define MPM_DEVICE_ADVANCE_ENTRIES(n) MPM_DEVICE_PHASE(mpm_advance_##n, advance<Scene##n>, 1)

#define MPM_DEVICE_SUM_ENTRIES                                                                                 \
  MPM_DEVICE_PHASE(mpm_add_teams, add_teams<Scene>, (mpm::device::sum_scalars<Scene, mpm::device::most_sums>)) \
  MPM_DEVICE_PHASE(mpm_largest_of_teams, largest_of_teams<Scene>, (mpm::device::sum_scalars<Scene, 3>))        \
  MPM_DEVICE_PHASE(mpm_largest_speed, largest_speed<Scene>, (mpm::device::sum_scalars<Scene, 3>))

#define MPM_DEVICE_TOTALS_ENTRIES                                               \
  MPM_DEVICE_PHASE(mpm_totals_of_motion, totals_of_motion<Scene>,               \
                   (mpm::device::sum_scalars<Scene, mpm::device::motion_sums>)) \
  MPM_DEVICE_PHASE(mpm_add_particles, add_particles<Scene>, (mpm::device::sum_scalars<Scene, mpm::device::motion_sums>))

#define MPM_DEVICE_SORT_ENTRIES                                                               \
  MPM_DEVICE_PHASE(mpm_find_blocks, find_blocks<Scene>, 1)                                    \
  MPM_DEVICE_PHASE(mpm_clear_counts, clear_counts<Scene>, 1)                                  \
  MPM_DEVICE_PHASE(mpm_count_particles, count_particles<Scene>, 1)                            \
  MPM_DEVICE_PHASE(mpm_sum_chunks, sum_chunks<Scene>, mpm::device::scan_scalars<Scene>)       \
  MPM_DEVICE_PHASE(mpm_scan_chunks, scan_chunks<Scene>, mpm::device::scan_scalars<Scene>)     \
  MPM_DEVICE_PHASE(mpm_number_blocks, number_blocks<Scene>, mpm::device::scan_scalars<Scene>) \
  MPM_DEVICE_PHASE(mpm_place_particles, place_particles<Scene>, 1)                            \
  MPM_DEVICE_PHASE(mpm_order_blocks, order_blocks<Scene>, 1)                                  \
  MPM_DEVICE_PHASE(mpm_end_sort, end_sort<Scene>, 1)

#define MPM_DEVICE_BODY_FORCE_ENTRIES \
  MPM_DEVICE_PHASE(mpm_scatter_body_force, scatter_body_force<Scene>, mpm::device::load_scalars<Scene>)

#define MPM_DEVICE_LOAD_ENTRIES \
  MPM_DEVICE_PHASE(mpm_scatter_load, scatter_load<Scene>, mpm::device::load_scalars<Scene>)

#define MPM_DEVICE_LEDGER_ENTRIES                                                                               \
  MPM_DEVICE_PHASE(mpm_energy_of_momenta, energy_of_momenta<Scene>, (mpm::device::sum_scalars<Scene, 1>))       \
  MPM_DEVICE_PHASE(mpm_energy_of_velocities, energy_of_velocities<Scene>, (mpm::device::sum_scalars<Scene, 1>)) \
  MPM_DEVICE_PHASE(mpm_work_of_forces, work_of_forces<Scene>, (mpm::device::sum_scalars<Scene, 11>))            \
  MPM_DEVICE_PHASE(mpm_energy_of_particles, energy_of_particles<Scene>, (mpm::device::sum_scalars<Scene, 1>))   \
  MPM_DEVICE_PHASE(mpm_energy_dissipated, energy_dissipated<Scene>, (mpm::device::sum_scalars<Scene, 3>))       \
  MPM_DEVICE_PHASE(mpm_clear_work_of_folds, clear_work_of_folds<Scene>, 1)                                      \
  MPM_DEVICE_PHASE(mpm_clear_impulses, clear_impulses<Scene>, 1)                                                \
  MPM_DEVICE_PHASE(mpm_work_of_impulses, work_of_impulses<Scene>, (mpm::device::sum_scalars<Scene, 3>))         \
  MPM_DEVICE_PHASE(mpm_power_of_forces, power_of_forces<Scene>, (mpm::device::sum_scalars<Scene, 2>))           \
  MPM_DEVICE_PHASE(mpm_power_of_filter, power_of_filter<Scene>, (mpm::device::sum_scalars<Scene, 1>))           \
  MPM_DEVICE_PHASE(mpm_work_of_folds, work_of_folds<Scene>, (mpm::device::sum_scalars<Scene, 2>))               \
  MPM_DEVICE_PHASE(mpm_momentum_of_nodes, momentum_of_nodes<Scene>, (mpm::device::sum_scalars<Scene, 4>))       \
  MPM_DEVICE_PHASE(mpm_momentum_of_particles, momentum_of_particles<Scene>, (mpm::device::sum_scalars<Scene, 4>))

#define MPM_DEVICE_VISCOSITY_LEDGER_ENTRIES \
  MPM_DEVICE_PHASE(mpm_artificial_work, artificial_work<Scene>, (mpm::device::sum_scalars<Scene, 1>))

#define MPM_DEVICE_REACTION_ENTRIES                                                               \
  MPM_DEVICE_PHASE(mpm_gathered_beyond, gathered_beyond<Scene>, mpm::device::line_scalars<Scene>) \
  MPM_DEVICE_PHASE(mpm_held, held<Scene>, (mpm::device::sum_scalars<Scene, mpm::device::support_sums>))

#define MPM_DEVICE_GRIP_ENTRIES                                                                     \
  MPM_DEVICE_PHASE(mpm_tell_gripped, tell_gripped<Scene>, 1)                                        \
  MPM_DEVICE_PHASE(mpm_scatter_grip, scatter_grip<Scene>, mpm::device::scatter_grip_scalars<Scene>) \
  MPM_DEVICE_PHASE(mpm_given_to_gripped, given_to_gripped<Scene>, (mpm::device::sum_scalars<Scene, 7>))

#define MPM_DEVICE_CONTACT_ENTRIES \
  MPM_DEVICE_PHASE(mpm_contact, contact<Scene>, (mpm::device::sum_scalars<Scene, mpm::device::contact_sums>))

// The composer includes contact_points.hpp in scenes that have these.
#define MPM_DEVICE_CONTACT_POINTS_ENTRIES                                \
  MPM_DEVICE_PHASE(mpm_find_meeting_nodes, find_meeting_nodes<Scene>, 1) \
  MPM_DEVICE_PHASE(mpm_look_at_particles, look_at_particles<Scene>, 1)

#define MPM_DEVICE_CONTACT_REACH_ENTRIES MPM_DEVICE_PHASE(mpm_find_reach, find_reach<Scene>, 1)

#define MPM_DEVICE_CONTACT_STATE_ENTRIES MPM_DEVICE_PHASE(mpm_keep_contact_state, keep_contact_state<Scene>, 1)

#define MPM_DEVICE_TRACTION_ENTRIES MPM_DEVICE_PHASE(mpm_measure_welds, measure_welds<Scene>, 1)

#define MPM_DEVICE_RIGID_ENTRIES(n)                                     \
  MPM_DEVICE_PHASE(mpm_rigid_contact_##n, rigid_contact<RigidScene##n>, \
                   (mpm::device::sum_scalars<Scene, mpm::device::rigid_sums>))

#define MPM_DEVICE_FILTER_ENTRIES                                          \
  MPM_DEVICE_PHASE(mpm_begin_filter, begin_filter<Scene>, 1)               \
  MPM_DEVICE_PHASE(mpm_keep_unfiltered, keep_unfiltered<Scene>, 1)         \
  MPM_DEVICE_PHASE(mpm_keep_correction, keep_correction<Scene>, 1)         \
  MPM_DEVICE_PHASE(mpm_add_correction, add_correction<Scene>, 1)           \
  MPM_DEVICE_PHASE(mpm_restore_velocity, restore_velocity<Scene>, 1)       \
  MPM_DEVICE_PHASE(mpm_keep_free_velocity, keep_free_velocity<Scene>, 1)   \
  MPM_DEVICE_PHASE(mpm_take_free_velocity, take_free_velocity<Scene>, 1)   \
  MPM_DEVICE_PHASE(mpm_measure_constraints, measure_constraints<Scene>, 1) \
  MPM_DEVICE_PHASE(mpm_increment_norm, increment_norm<Scene>, (mpm::device::sum_scalars<Scene, 1>))

#define MPM_DEVICE_FILTER_LOOP_ENTRIES                                                            \
  MPM_DEVICE_PHASE(mpm_clear_projection, clear_projection<Scene>, 1)                              \
  MPM_DEVICE_PHASE(mpm_project, project<Scene>, mpm::device::project_scalars<Scene>)              \
  MPM_DEVICE_PHASE(mpm_fold_projection, fold_projection<Scene>, mpm::device::line_scalars<Scene>) \
  MPM_DEVICE_PHASE(mpm_update_filter, update_filter<Scene>, 1)                                    \
  MPM_DEVICE_PHASE(mpm_correct_increment, correct_increment<Scene>, 1)                            \
  MPM_DEVICE_PHASE(mpm_fill_increments, fill_increments<Scene>, 1)

#define MPM_DEVICE_HEAT_ENTRIES                                                                             \
  MPM_DEVICE_PHASE(mpm_scatter_heat, scatter_heat<Scene>, mpm::device::scatter_heat_scalars<Scene>)         \
  MPM_DEVICE_PHASE(mpm_divide_heat, divide_heat<Scene>, 1)                                                  \
  MPM_DEVICE_PHASE(mpm_impose_temperature, impose_temperature<Scene>, (mpm::device::sum_scalars<Scene, 2>)) \
  MPM_DEVICE_PHASE(mpm_fill_temperature, fill_temperature<Scene>, (mpm::device::sum_scalars<Scene, 2>))     \
  MPM_DEVICE_PHASE(mpm_keep_temperature, keep_temperature<Scene>, 1)                                        \
  MPM_DEVICE_PHASE(mpm_conduct, conduct<Scene>, mpm::device::conduct_scalars<Scene>)                        \
  MPM_DEVICE_PHASE(mpm_exchange_at_walls, exchange_at_walls<Scene>, (mpm::device::sum_scalars<Scene, 2>))   \
  MPM_DEVICE_PHASE(mpm_mass_of_box, mass_of_box<Scene>, (mpm::device::sum_scalars<Scene, 1>))               \
  MPM_DEVICE_PHASE(mpm_warm_box, warm_box<Scene>, (mpm::device::sum_scalars<Scene, 1>))                     \
  MPM_DEVICE_PHASE(mpm_warm, warm<Scene>, 1)                                                                \
  MPM_DEVICE_PHASE(mpm_gather_heat, gather_heat<Scene>, 1)                                                  \
  MPM_DEVICE_PHASE(mpm_totals_of_heat, totals_of_heat<Scene>, (mpm::device::sum_scalars<Scene, mpm::device::heat_sums>))

#define MPM_DEVICE_HEAT_LEDGER_ENTRIES                                                                          \
  MPM_DEVICE_PHASE(mpm_heat_of_nodes, heat_of_nodes<Scene>, (mpm::device::sum_scalars<Scene, 1>))               \
  MPM_DEVICE_PHASE(mpm_heat_rate_of_nodes, heat_rate_of_nodes<Scene>, (mpm::device::sum_scalars<Scene, 1>))     \
  MPM_DEVICE_PHASE(mpm_heat_of_temperatures, heat_of_temperatures<Scene>, (mpm::device::sum_scalars<Scene, 1>)) \
  MPM_DEVICE_PHASE(mpm_heat_of_particles, heat_of_particles<Scene>, (mpm::device::sum_scalars<Scene, 1>))       \
  MPM_DEVICE_PHASE(mpm_heat_of_dissipation, heat_of_dissipation<Scene>, (mpm::device::sum_scalars<Scene, 1>))

#define MPM_DEVICE_DILATION_ENTRIES                                                                       \
  MPM_DEVICE_PHASE(mpm_clear_mean_stress, clear_mean_stress<Scene>, 1)                                    \
  MPM_DEVICE_PHASE(mpm_scatter_mean_stress, scatter_mean_stress<Scene>, mpm::device::mean_scalars<Scene>) \
  MPM_DEVICE_PHASE(mpm_fold_mean_stress, fold_mean_stress<Scene>, 1)                                      \
  MPM_DEVICE_PHASE(mpm_divide_mean_stress, divide_mean_stress<Scene>, 1)                                  \
  MPM_DEVICE_PHASE(mpm_fill_mean_stress, fill_mean_stress<Scene>, 1)                                      \
  MPM_DEVICE_PHASE(mpm_take_mean_stress, take_mean_stress<Scene>, 1)                                      \
  MPM_DEVICE_PHASE(mpm_clear_dilation, clear_dilation<Scene>, 1)                                          \
  MPM_DEVICE_PHASE(mpm_scatter_dilation, scatter_dilation<Scene>, mpm::device::mean_scalars<Scene>)       \
  MPM_DEVICE_PHASE(mpm_fold_dilation, fold_dilation<Scene>, 1)                                            \
  MPM_DEVICE_PHASE(mpm_divide_dilation, divide_dilation<Scene>, 1)                                        \
  MPM_DEVICE_PHASE(mpm_fill_dilation, fill_dilation<Scene>, 1)                                            \
  MPM_DEVICE_PHASE(mpm_gather_dilation, gather_dilation<Scene>, 1)

#define MPM_DEVICE_MELTING_ENTRIES(n) MPM_DEVICE_PHASE(mpm_change_phase_##n, change_phase<Scene##n>, 1)

#define MPM_DEVICE_MATERIAL_ENTRIES(n)                                         \
  MPM_DEVICE_PHASE(mpm_stress_##n, stress<Scene##n>, 1)                        \
  MPM_DEVICE_PHASE(mpm_totals_of_state_##n, totals_of_state<Scene##n>,         \
                   (mpm::device::sum_scalars<Scene, mpm::device::state_sums>)) \
  MPM_DEVICE_PHASE(mpm_wave_speed_##n, wave_speed<Scene##n>, 1)
