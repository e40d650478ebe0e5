#pragma once
// What a phase is given: plain pointers and numbers, the same struct for the host that launches and the text that runs.
// Arrays are laid out [component][particle] and [component][node]. No system headers.

namespace mpm::device {

/// A wall's kind, in the order of ConditionType (compose.cpp checks it).
enum Wall : int { wall_free = 0, wall_stick, wall_slip, wall_separate, wall_prescribed, wall_periodic };

/// Cells of a block along each axis: the particles of one block are one team's work.
inline constexpr int block_cells = 4;

/// One velocity field. Channels that the plan does not ask for are null.
template <class T>
struct GridArrays {
  T* mass;              ///< kg
  T* momentum;          ///< [D], kg m/s
  T* force;             ///< [D], N: internal force and weight
  T* velocity_before;   ///< [D], m/s
  T* velocity;          ///< [D], m/s
  T* volume;            ///< m^3, of contact like the next two
  T* volume_gradient;   ///< [D], m^2
  T* mass_position;     ///< [D], kg m
  T* increment;         ///< [D], m/s, of the filter like the next three
  T* projected;         ///< [D], kg m/s, then m/s
  T* trial_velocity;    ///< [D], m/s: before conditions and contact act on an increment
  T* kept_velocity;     ///< [D], m/s
  T* constrained;       ///< [D], m/s: what conditions and contact have added in the step; null unless one-sided
  T* kept_constrained;  ///< [D], m/s: of kept_velocity
  int* folded;          ///< bit a: this ghost was folded along axis a in this step
};

/// The particles of one body and material.
template <class T>
struct ParticleArrays {
  int count, stride;
  T mass, volume;     ///< of each, kg and m^3
  T half_size;        ///< cells, of its undeformed box
  T* position;        ///< [D], m
  T* velocity;        ///< [D], m/s
  T* advection;       ///< [D], m/s: moves the particle
  T* domain;          ///< [D*D], cells; null unless the shape takes domains
  T* corners;         ///< [corner][D], cells from the particle; null unless the grid's velocity moves them
  T* moved_corners;   ///< where they go in this step, from the particle as it is yet
  T* stencil_domain;  ///< the same at the last scatter: weights do not change inside a step
  T* transfer_state;  ///< declared fields one after another
  T* material_state;
  T* stress;             ///< symmetric, Kirchhoff, Pa
  T* volume_ratio;       ///< J
  T* velocity_gradient;  ///< [D*D], 1/s
  T* wave_speed;         ///< m/s
  T* circumference;      ///< m, 2 pi r as seeded, which mass and volume are times; null unless axisymmetric
  T* hoop_rate;          ///< 1/s, v_r / r; null unless axisymmetric
  int frozen;            ///< 1: particles and domains stay as they are
};

/// Pairs of fields, one a node: geometry in, impulse out.
template <class T>
struct ContactArrays {
  const int* active;    ///< 1 where the pair is to be resolved
  const T* normal;      ///< [D], from the field `grid` to the field `other`
  const T* separation;  ///< m
  const T* area;        ///< m^2
  T* impulse;           ///< [D], kg m/s
  T* dissipated;        ///< J
  int* status;          ///< mpm_contact_status
};

/// A scatter's work: the particles of block k are order[block_begin[k] .. block_begin[k + 1]).
struct BlockArrays {
  const int* cell;   ///< [block][3], first cell
  const int* begin;  ///< [blocks + 1]
  const int* order;  ///< particle indices, block after block
};

template <class T>
struct Arguments {
  // The scene; the same for all phases.
  T cell_size, inverse_cell_size, lower[3], gravity[3];
  int cells[3], extent[3], padding[3], node_count;
  int walls[3][2];
  const double *shape_parameters, *transfer_parameters, *filter_parameters, *contact_parameters, *material_parameters;
  // What this phase works on.
  ParticleArrays<T> particles;
  GridArrays<T> grid, other;
  ContactArrays<T> contact;
  BlockArrays blocks;
  T* partial_sums;    ///< one a team
  int* first_failed;  ///< smallest index of a particle that cannot go on; count if there is none
  // How.
  T dt;
  int axis;                             ///< of folds and ghosts
  int iteration;                        ///< of the filter, from 1
  bool momentum, force, contact_fields; /**< scatter: as in Pass */
  bool remap;                           ///< clear, fold, velocity: of MUSL
  bool update_particles;                ///< gather: velocity and state too, not only the velocity gradient
  bool filtered;                        ///< gather: the filtered velocity replaces the particle's
};

}  // namespace mpm::device
