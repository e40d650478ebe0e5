#pragma once
// What happens at a node to two velocity fields that meet there, around the law's own formula (abi.h, mpm_contact). S is
// the scalar of the fields. Loops over pairs and nodes, and where the values lie, are the caller's.

#include "kernel/math.hpp"
#include "operators/motion.hpp"

namespace mpm {

/// What a law says of a pair, in the order of mpm_contact_status, which simulation/contact_impulse.hpp checks.
enum : int { contact_apart = 0, contact_sticks, contact_slips };

/// One component of the momentum that a law is told of.
template <class S>
MPM_HD S momentum_of(S velocity, S mass) {
  return mass * velocity;
}

/// Strikes one component of a pair with the law's impulses: field a takes `impulse`, field b the opposite of `returned`,
/// which is the same impulse unless each body has a normal of its own. Calls note(of_b, impulse) for what each is given,
/// for the ledger. Returns the momentum that the pair gains, kg m/s, zero to rounding where the normal is shared, in the
/// precision of `Sum`.
template <class Sum, class S, class Note>
MPM_HD Sum strike_pair(S& velocity_a, S& velocity_b, S mass_a, S mass_b, S impulse, S returned, Note&& note) {
  const Sum before_a = velocity_a, before_b = velocity_b;
  velocity_a = struck(velocity_a, impulse, mass_a);
  velocity_b = struck(velocity_b, -returned, mass_b);
  note(false, impulse);
  note(true, -returned);
  return mass_a * (velocity_a - before_a) + mass_b * (velocity_b - before_b);
}

/// How far around a node, in cells, welds are summed for the traction that a law is told of (MPM_READS_TRACTION). Splines
/// spread a face over up to four rows of nodes, whose shares of the force and of the area are unlike: only their sums make
/// the traction of the face.
inline constexpr int traction_reach = 2;

/// What a weld would give a pair at a node. Sums of them, over a step, make a traction.
struct WeldOfPair {
  double impulse[3] = {};  ///< on a, kg m/s
  double area = 0;         ///< m^2

  MPM_HD void add(const WeldOfPair& other) {
    for (int c = 0; c < 3; ++c) impulse[c] += other.impulse[c];
    area += other.area;
  }
  /// The traction along one axis, Pa; zero where nothing touches.
  MPM_HD double traction(int axis, double dt) const { return area > 0 ? impulse[axis] / (area * dt) : 0; }
};

/// The mass, kg, of which a grip's particles have to be half for it to hold a body of a pair at a node. In a weld that is
/// the mass of both, as if there were one field: a body of which a node sees next to nothing would hold the other there.
template <class S>
MPM_HD S held_mass(S own, S other, bool weld) {
  return weld ? own + other : own;
}

/// The mass, kg, with which a law sees a pair of which a grip holds one body as a whole. What it gives that body goes to the
/// grip, so that the body has an infinite mass: the law is told of the other mass for a, of a's velocity beside b
/// (momentum_beside), and of an infinite b at rest.
template <class S>
MPM_HD S mass_beside_held(bool holds_a, S mass_a, S mass_b) {
  return holds_a ? mass_b : mass_a;
}
template <class S>
MPM_HD S momentum_beside(S velocity_a, S velocity_b, S mass) {
  return mass * (velocity_a - velocity_b);
}

/// One component of the impulse on a with which both fields of a pair would move as one.
template <class S>
MPM_HD double welding_impulse(S velocity_a, S velocity_b, S mass_a, S mass_b) {
  return double(mass_a) / (1 + double(mass_a) / double(mass_b)) * (double(velocity_b) - double(velocity_a));
}

/// The share of a law's impulse that changes the velocity of neither body of a pair by more than `most`, m/s, given the
/// impulse's square: one factor for both, so that what one gives the other takes (Bardenhagen et al. 2001, CMES 2:509).
template <class S>
MPM_HD S share_under_cap(S square, S mass_a, S mass_b, S most) {
  const S change = sqrt(square) / min(mass_a, mass_b);
  return change > most ? most / change : S(1);
}

/// What a share of an impulse dissipates where the whole would dissipate `whole`, J: what it takes less of sliding at
/// their mean velocity. `work` is the impulse's part along the face times the velocity of a beside b before it, J, and
/// `square` the square of that part.
template <class S>
MPM_HD S dissipated_by_share(S whole, S share, S work, S square, S mass_a, S mass_b) {
  const S left = S(0.5) * square * (1 / mass_a + 1 / mass_b);
  return max(S(0), whole + (1 - share) * work + (1 - share * share) * left);
}

/// Adds to `along` the part of field a's impulse along the pair's unit normal, kg m/s, and to `pressing` how hard that
/// presses the fields together: positive where it pushes a back from b.
template <class Impulse, class Normal>
MPM_HD void add_normal_part(const Impulse& impulse, const Normal& normal, int stride, int dimension, double* along,
                            double& pressing) {
  double size = 0;
  for (int c = 0; c < dimension; ++c)
    size += static_cast<double>(impulse[c * stride]) * static_cast<double>(normal[c * stride]);
  for (int c = 0; c < dimension; ++c) along[c] += size * static_cast<double>(normal[c * stride]);
  pressing -= size;
}

}  // namespace mpm
