#pragma once
// Fields: the values that particles and nodes hold. Whoever needs one declares it once, in the plan; backends allocate,
// clear, fold, sort, save, restore, export, price and print by going over the list.

#include <cstdint>
#include <string>

namespace mpm {

/// Who holds one value of a field each: every particle of a body, or every node for each velocity field.
enum class Owner { particle, node };

/// Whose table declares a field: state of plugins keeps the plugin's own names.
enum class Origin { host, transfer, material };

enum class Lifetime {
  seeded,  ///< never changes: kept in double precision by the index of seeding, so it neither travels nor needs saving
  saved,   ///< from one step to the next: travels with its particle, stands in checkpoints
  step,    ///< holds nothing that a later step reads
  pass     ///< holds nothing that another operator reads
};

/// What each component starts as. `seeded` values come from seeding itself; the identity is that of a row-major matrix
/// (of the five components of a plane deformation too), or of a symmetric tensor, which begins with its diagonal.
enum class First { zero, one, identity, symmetric_identity, half_size_diagonal, half_size_corners, seeded };

/// How a ghost's value is added to its mirror node's at walls (simulation/boundary.hpp). Periodic images are always
/// added as they are.
enum class AtWall {
  none,      ///< is not folded
  even,      ///< as it is
  momentum,  ///< each component with the sign of the wall's condition, relative to the wall's own motion
  vector,    ///< each component with the sign of the wall's condition
  heat,      ///< even, but with the other sign at walls of a fixed temperature, relative to what that temperature holds
  heat_rate,  ///< even, but with the other sign at walls of a fixed temperature
  slip        ///< the component across the wall changes its sign, whatever the condition; on the wall it vanishes
};

/// When a field's ghosts are folded.
enum class Folded { never, with_mass, with_force };

/// One field of one body's particles, or of the nodes.
struct Field {
  std::string id;    ///< unique among the fields of its owner, body and origin
  std::string name;  ///< for people
  std::string unit;
  Owner owner = Owner::particle;
  int body = -1;  ///< which body's particles; -1 for a field of nodes
  Origin origin = Origin::host;
  int components = 1;
  Lifetime lifetime = Lifetime::saved;
  First first = First::zero;
  AtWall at_wall = AtWall::none;
  Folded folded = Folded::never;
  bool cleared = false;     ///< nodes hold zero when a step's first scatter begins
  bool for_ledger = false;  ///< only the ledger reads it at nodes, so it may rest in the steps that have no entry
  /// Only contact reads it, or wants it apart, so that particles which no other body comes near need not give it.
  bool for_contact = false;
  std::string beside;       ///< nodes keep this scalar as the fourth of that vector's group of four
  std::string in_place_of;  ///< nodes keep it in the memory of that field, which nobody reads any more
  std::uint64_t bytes = 0;  ///< what a particle takes, or a node with all its velocity fields
  std::string because;      ///< JSON pointer of what asked for it, and why

  bool of_particles_of(int b) const { return owner == Owner::particle && body == b; }
};

/// What component k of a particle field starts as, unless it is seeded; `half_size` is that of the particle's
/// undeformed box, cells. Corner c of a domain lies at the upper end along axis k where bit k of c is set.
inline double first_value(const Field& field, int k, int dimension, double half_size) {
  switch (field.first) {
    case First::one:
      return 1;
    case First::identity:
      return k % (dimension + 1) == 0 || k == dimension * dimension ? 1 : 0;
    case First::symmetric_identity:
      return k < 3 ? 1 : 0;
    case First::half_size_diagonal:
      return k % (dimension + 1) == 0 ? half_size : 0;
    case First::half_size_corners:
      return k / dimension >> k % dimension & 1 ? half_size : -half_size;
    default:
      return 0;
  }
}

}  // namespace mpm
