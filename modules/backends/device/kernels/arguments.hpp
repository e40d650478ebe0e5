#pragma once
// A phase is given plain pointers and numbers, in the same struct for the host that launches and the text that runs.
// Arrays are laid out [component][particle] and [component][node]. No system headers are included.

#include "kernel/artificial_viscosity.hpp"
#include "operators/contact_geometry.hpp"
#include "operators/loads.hpp"

namespace mpm::device {

/// The cells of a block along each axis: the particles of one block are one team's work.
inline constexpr int block_cells = 4;

/// The number of arrays that a table has room for; the host checks it.
inline constexpr int most_fields = 64;

/// The nodes, one index after another, that are active together (kernels/active_nodes.hpp).
inline constexpr int nodes_of_run = 16;

/// The arrays of one velocity field.
template <class T>
struct NodeArrays {
  T* field[most_fields];  ///< numbered as Scene::Node
  int* folded;            ///< bit a: this ghost was folded along axis a in this step
  unsigned char* active;  ///< [run of nodes] 1 where anything has reached them
};

/// How a body's particles conduct and store heat: [0] as solids, [1] when melted, the same where nothing melts.
template <class T>
struct HeatOfBody {
  T conductivity[2];                   ///< W/(m K)
  T heat_capacity[2];                  ///< J/(kg K)
  T melting_temperature, latent_heat;  ///< K, J/kg
  T warming;                           ///< share of the dissipated energy that warms, over the density, m^3/kg
};

/// How a load acts on the share of it that a particle carries.
enum LoadAction { load_of_force, load_of_pressure, load_of_follower, load_of_spring };

template <class T>
struct LoadLaw {
  int action;  ///< LoadAction
  int gives;   ///< bit k: it is of kind k (ExternalForce)
  T stiffness[3], damping[3];
};

/// What the particles of one body carry of loads at points: particle p has the shares first[p] to first[p + 1].
template <class T>
struct LoadsOfBody {
  const int* first;
  const LoadShare<T>* shares;
};

/// The particles of one body and material.
template <class T>
struct ParticleArrays {
  int count, stride;
  T mass, volume;         ///< values of a particle, kg and m^3; of size 1
  T half_size;            ///< half a side of the undeformed particle's box, cells
  int body;               ///< its number, by which formulas know it
  int frozen;             ///< 1 where particles and domains stay as they are
  T* field[most_fields];  ///< numbered as Scene::Particle; the fields of one plugin's state lie one behind another
  HeatOfBody<T> heat;     ///< filled in scenes with temperature
  ArtificialViscosity<T> viscosity;  ///< filled where the material has any
  LoadsOfBody<T> loads;              ///< null where nothing acts at points
};

/// The nodes under a condition: all between two corners.
template <class T>
struct Box {
  int lower[3], upper[3];  ///< coordinates of nodes, both included
  int type, axis, side;    ///< Wall; axis and side as in box_holds
  int given;               ///< bit c: component c is prescribed
  int support;             ///< its number (Experiment::supports)
  const T* velocity;       ///< [D][node of the box, x first], m/s; null for rest
};

/// What the particles of a grip give the nodes of one velocity field, and bit c where component c is held.
template <class T>
struct GripArrays {
  T *mass, *momentum, *before;  ///< [node], [D][node] at the end of the step, and as it begins
  int given;
  int support;  ///< its number
};

/// Heat through a wall: `value` is a flux, W/m^2, or, with a coefficient, the temperature beyond the wall, K.
template <class T>
struct WallHeat {
  const T* value;  ///< [line of the axis]; null where no heat comes
  T coefficient;   ///< coefficient of convection, W/(m^2 K), else 0
};

/// Nodes that are warmed or held at a temperature: all between two corners.
template <class T>
struct HeatBox {
  int lower[3], upper[3];  ///< coordinates of nodes, both included
  const T* temperature;    ///< [node of the box, x first], K; null where none is held
  const T* power;          ///< [node of the box, x first], W, that its nodes share by their mass; null where none comes
};

/// The blocks of cells that a body's particles are in. The particles of the k-th block that has any are
/// order[begin[k] .. begin[k + 1]), in the order of their indices (kernels/sorting.hpp).
struct BlockArrays {
  int lower[3], extent[3], table;  ///< all blocks that the grid has, ghosts too: the first one, how many, their product
  int* block;                      ///< [particle] number in the table
  int *count, *next;               ///< [table] particles, and where the next one of them goes
  int *chunk, *before_chunk;       ///< [chunk of the table][2] particles and blocks with any, in it and before it
  int* in_order;                   ///< [1] 0 where a particle has left its block since the last sort
  int* active;                     ///< [1] blocks with particles
  int *cell, *begin, *order;       ///< [block with particles][3] first cell; [blocks with particles + 1]; [particle]
};

/// A body as nodes look at its particles where fields meet.
template <class T>
struct SeenBody {
  const T *position, *sides, *size;  ///< sides: a matrix whose columns make the semi-sides; null where nobody asks
  int stride;
  double half_side;  ///< what makes semi-sides in cells of `sides`, of a particle of size 1
  int* nearest;      ///< [1] how far the particles' lists reach, in whole cells, with the other sign
  BlockArrays blocks;
};

/// How nodes look at the particles of the pair `grid` and `other`, and what they find (kernels/contact_points.hpp).
template <class T>
struct SeenParticles {
  const SeenBody<T>* bodies[2];  ///< of each field
  int count[2];
  double lower[3], cell_size;    ///< m
  double reach;                  ///< how far from a node its particles lie at most, beside the domains of lists, cells
  int *meeting_count, *meeting;  ///< [1], and the nodes at which the fields meet, in any order
  double* rows;                  ///< [particle][D][lane] places that each lane keeps, cells from its node
  int row_length, lanes;         ///< particles that a row has room for; how many lanes look at the same time
  int* valid;                    ///< [node]
  T* values;                     ///< [node] separation, then area, then [D][node] normal (ContactGeometry)
};

/// What contact does to a pair at each node, for the host to read; null in steps that record no nodes.
template <class T>
struct NotedContact {
  int* met;   ///< [node] -1 where the pair does not meet, else the law's ContactStatus
  T* values;  ///< [node] separation, then area, then [D][node] normal, then [D][node] impulse on the first field
};

/// The nodes near a rigid body, as the host found them for the step, and how it moves in this stage of it.
struct RigidArrays {
  const int* node;       ///< [count] index of the node
  const double* values;  ///< [2 + 2 D][count] distance and cell, then normal and arm (simulation/rigid_bodies.hpp)
  double velocity[3], spin[3], mass;  ///< m/s, rad/s, and the infinite mass, kg
  long long count;
};

template <class T>
struct Arguments {
  // These describe the scene; they are the same for all phases.
  T cell_size, inverse_cell_size, lower[3], gravity[3];
  int cells[3], extent[3], padding[3], node_count;
  int walls[3][2];               ///< Wall
  const T* wall_velocity[3][2];  ///< [D][line of the axis], m/s, as evaluated last; null for rest
  const Box<T>* boxes;
  const GripArrays<T>* grips;        ///< of the velocity field `grid`
  const GripArrays<T>* other_grips;  ///< of the velocity field `other`
  int box_count, grip_count;
  const double *shape_parameters, *transfer_parameters, *filter_parameters, *contact_parameters, *normal_parameters,
      *detection_parameters, *material_parameters;
  const double* melted_parameters;  ///< parameters of the material's melted particles
  const T* wall_temperature[3][2];  ///< [line of the axis], K, as evaluated last; null where none is held
  WallHeat<T> wall_heat[3][2];      ///< as evaluated last
  const T* wall_shares;             ///< shares of heat through a wall: that of its node, of the next one inward ...
  const HeatBox<T>* heat_boxes;
  int wall_share_count, heat_box_count;
  const T* formula_numbers;     ///< what formulas at particles take, for the step's time (ParticleFormulas)
  const LoadLaw<T>* load_laws;  ///< of each load of the experiment
  T strain_cap;                 ///< of contact (experiment/contact_settings.hpp), 0 for none
  T wall_beyond;  ///< m, how far the nodes beyond the wall make the temperature there differ (WallWeights)
  bool gravity_has_potential[3];
  // These are what this phase works on.
  ParticleArrays<T> particles;
  NodeArrays<T> grid, other;
  EdgeTable edges[2];     ///< contact: of `grid` and of `other`
  SeenParticles<T> seen;  ///< contact: in scenes that look at particles
  NotedContact<T> noted;  ///< contact: in scenes that record nodes
  double* welds;          ///< contact: [D + 1][node] impulse and area of WeldOfPair, where the law reads the traction
  RigidArrays rigid;      ///< rigid_contact
  BlockArrays blocks;
  int teams;                             ///< that share the blocks with particles
  int launch;                            ///< number of this launch in the step
  double* partial_sums;                  ///< [team][sum]
  int sum_teams, sum_count, sum_maxima;  ///< add_teams: how many there are, and how many of them are largest values
  int exact_phase;                       ///< of a scatter with exact sums
  double* sums;                          ///< where add_teams leaves them
  const double* masses_of_box;           ///< masses of its nodes in each velocity field, kg
  int* exponents;                        ///< [channel] of a scatter, and its sums [channel][node][2]
  unsigned long long* exact_sums;        ///< (kernels/exact_sums.hpp)
  unsigned long long* stop;              ///< see kernels/stopping.hpp
  // These say how it works.
  T dt;
  T local_damping, left_of_velocity, left_of_change;  ///< damp: see `damped`
  int axis;                                           ///< axis of folds and ghosts
  int iteration;                                      ///< number of the filter's pass, from 1
  int load_field, load_kind;                          ///< scatter_load: field of nodes, and kind of ExternalForce
  bool dashpots;                                      ///< scatter_load: springs give their damping, not their stiffness
  int heat_box;                                       ///< number of the box that is warmed
  int mass_count;                                     ///< velocity fields that a box has mass in
  bool momentum, force, contact_fields;               /**< scatter: as in Pass */
  int support;                                        ///< held: number of the support
  int beyond;                                         ///< gathered_beyond: what particles gather
  bool remap;                                         ///< clear, fold: the remap of MUSL
  int grip;                                           ///< scatter_grip: which
  bool grips_at_end;                                  ///< nodes are held as particles are told for the end of the step
  bool after_forces;                                  ///< v+ is made, not v-
  bool first_step, notes_reached;                     ///< contact: see first_step and reached of mpm_contact_batch
  bool records;                                       ///< impulses are noted for the ledger
  bool walls_at_rest;                                 ///< what is folded or filled is a difference of velocities
  bool update_particles;  ///< gather: velocity and state change too, not only the velocity gradient
  bool filtered;          ///< gather: the filtered velocity replaces the particle's
  bool moves_by_mean;     ///< gather: the mean of both moves the particle then
  int part_of_move;       ///< advance: by how much the number of its move is above that of its launch
};

/// A particle beyond a wall by more than this share of the domain has left it; a separating wall lets half a cell
/// through.
template <class T>
inline constexpr T position_tolerance = sizeof(T) == 4 ? T(1e-6) : T(1e-9);

}  // namespace mpm::device
