#pragma once
// What a phase is given: plain pointers and numbers, the same struct for the host that launches and the text that runs.
// Arrays are laid out [component][particle] and [component][node]. No system headers.

namespace mpm::device {

/// Cells of a block along each axis: the particles of one block are one team's work.
inline constexpr int block_cells = 4;

/// Arrays that a table has room for; the host checks it.
inline constexpr int most_fields = 32;

/// One velocity field.
template <class T>
struct NodeArrays {
  T* field[most_fields];  ///< numbered as Scene::Node
  int* folded;            ///< bit a: this ghost was folded along axis a in this step
  int* held;              ///< bit c: a condition gives component c after the forces; null without a ledger
};

/// The particles of one body and material.
template <class T>
struct ParticleArrays {
  int count, stride;
  T mass, volume;         ///< of each, kg and m^3; in axisymmetric scenes per metre of circumference
  T half_size;            ///< cells, of its undeformed box
  int frozen;             ///< 1: particles and domains stay as they are
  T* field[most_fields];  ///< numbered as Scene::Particle; the fields of one plugin's state lie one behind another
};

/// Pairs of fields, one a node: geometry in, impulse out.
template <class T>
struct ContactArrays {
  const int* active;    ///< 1 where the pair is to be resolved
  const T* normal;      ///< [D], from the field `grid` to the field `other`
  const T* separation;  ///< m
  const T* area;        ///< m^2
  T* impulse;           ///< [D], kg m/s
  T* unbalanced;        ///< [D], kg m/s: change of the pair's momentum, zero to rounding
  T* work;              ///< J, of both impulses at the mean velocities
  T* dissipated;        ///< J
  int* status;          ///< mpm_contact_status
};

/// Nodes under a condition: all between two corners.
template <class T>
struct Box {
  int lower[3], upper[3];  ///< coordinates of nodes, both included
  int type, axis, side;    ///< Wall; as in box_holds
  int given;               ///< bit c: component c is prescribed
  const T* velocity;       ///< [D][node of the box, x first], m/s; null at rest
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
  int walls[3][2];               ///< Wall
  const T* wall_velocity[3][2];  ///< [D][line of the axis], m/s, as evaluated last; null at rest
  const Box<T>* boxes;
  int box_count;
  const double *shape_parameters, *transfer_parameters, *filter_parameters, *contact_parameters, *material_parameters;
  // What this phase works on.
  ParticleArrays<T> particles;
  NodeArrays<T> grid, other;
  ContactArrays<T> contact;
  BlockArrays blocks;
  double* partial_sums;  ///< [team][sum]
  int* first_failed;     ///< smallest index of a particle that cannot go on; count if there is none
  // How.
  T dt;
  int axis;                             ///< of folds and ghosts
  int iteration;                        ///< of the filter, from 1
  bool momentum, force, contact_fields; /**< scatter: as in Pass */
  bool remap;                           ///< clear, fold: of MUSL
  bool after_forces;                    ///< v+ is made, not v-; conditions mark what they hold
  bool walls_at_rest;                   ///< what is folded or filled is a difference of velocities
  bool update_particles;                ///< gather: velocity and state too, not only the velocity gradient
  bool filtered;                        ///< gather: the filtered velocity replaces the particle's
};

}  // namespace mpm::device
