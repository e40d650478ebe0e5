// Checks of contact laws: symmetry of the pair, restriction to approach, friction bound, energy and frame invariance.

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "conformance/support.hpp"
#include "plugin/extension_of.hpp"

namespace mpm::conformance {
namespace {

/// m: pairs that touch overlap by up to half of it, those that are apart are so by more than two of it.
constexpr double cell_size = 0.2;

/// One node where two velocity fields meet.
struct Pair {
  double mass_a, mass_b, separation, area;
  Vector3 velocity_a, velocity_b, normal, displacement{}, traction{};
  double dt;
  /// What each body's particles keep, and what they have gained, for laws with a state.
  std::array<double, MPM_CONTACT_STATES> state_a{}, state_b{}, gained_a{}, gained_b{};

  double reduced_mass() const { return mass_a * mass_b / (mass_a + mass_b); }
};
using Pairs = std::array<Pair, full>;

/// Random pairs by lane % 4: 0 presses, 1 parts while it touches, 2 approaches at a distance, 3 parts at a distance.
Pairs random_pairs(Random& random, int dimension) {
  Pairs pairs;
  for (int lane = 0; lane < full; ++lane) {
    Pair& p = pairs[lane];
    p.mass_a = random.logarithmic(1e-2, 1e2);
    p.mass_b = random.logarithmic(1e-2, 1e2);
    p.normal = random.direction(dimension);
    p.separation = lane % 4 < 2 ? random.uniform(-0.1, -0.001) : random.uniform(0.5, 1);
    p.area = random.logarithmic(1e-3, 1);
    p.dt = 0x1p-10;
    const Vector3 tangent = random.direction(dimension), pull = random.direction(dimension);
    const double size = random.logarithmic(1e-2, 1e8);
    for (int i = 0; i < 3; ++i) p.traction[i] = size * pull[i];
    const double approach = (lane % 4 == 1 || lane % 4 == 3 ? -1 : 1) * random.uniform(0.1, 1),
                 slide = random.uniform(0, 1);
    const double along = dot(tangent, p.normal);
    for (int i = 0; i < 3; ++i) p.velocity_a[i] = p.velocity_b[i] = 0;
    for (int i = 0; i < dimension; ++i) {
      p.velocity_b[i] = random.uniform(-1, 1);
      p.displacement[i] = random.uniform(-p.dt, p.dt);
      p.velocity_a[i] = p.velocity_b[i] + approach * p.normal[i] + slide * (tangent[i] - along * p.normal[i]);
    }
  }
  for (Pair& p : pairs)
    for (std::size_t k = 0; k < MPM_CONTACT_STATES; ++k)
      for (auto* values : {&p.state_a, &p.state_b, &p.gained_a, &p.gained_b}) (*values)[k] = random.uniform(0, 1);
  return pairs;
}

struct ContactBatch {
  Variant variant;
  int count;
  double dt;
  std::uint32_t stage = MPM_AFTER_FORCES;
  std::uint32_t first_step = 0;
  Array mass_a, mass_b, momentum_a, momentum_b, normal, separation, area, displacement, traction;
  Array state_a, state_b, gained_a, gained_b;
  Array impulse, dissipated, stored, status, reached;

  ContactBatch(const Variant& v, const Pairs& pairs, int entries) : variant(v), count(entries), dt(pairs[0].dt) {
    const Element element = element_of(v);
    const std::uint32_t n = static_cast<std::uint32_t>(entries);
    for (Array* scalar : {&mass_a, &mass_b, &separation, &area, &dissipated, &stored}) *scalar = Array(element, 1, n);
    for (Array* vector : {&momentum_a, &momentum_b, &normal, &displacement, &traction, &impulse})
      *vector = Array(element, v.dimension, n);
    for (Array* state : {&state_a, &state_b, &gained_a, &gained_b, &reached})
      *state = Array(element, MPM_CONTACT_STATES, n);
    status = Array(Element::index, 1, n);
    for (int lane = 0; lane < entries; ++lane) {
      const Pair& p = pairs[lane];
      mass_a.set(0, lane, p.mass_a);
      mass_b.set(0, lane, p.mass_b);
      separation.set(0, lane, p.separation);
      area.set(0, lane, p.area);
      for (std::size_t k = 0; k < MPM_CONTACT_STATES; ++k) {
        const int row = static_cast<int>(k);
        state_a.set(row, lane, p.state_a[k]), gained_a.set(row, lane, p.gained_a[k]);
        state_b.set(row, lane, p.state_b[k]), gained_b.set(row, lane, p.gained_b[k]);
      }
      for (int i = 0; i < v.dimension; ++i) {
        momentum_a.set(i, lane, p.mass_a * p.velocity_a[i]);
        momentum_b.set(i, lane, p.mass_b * p.velocity_b[i]);
        normal.set(i, lane, p.normal[i]);
        displacement.set(i, lane, p.displacement[i]);
        traction.set(i, lane, p.traction[i]);
      }
    }
  }

  static bool reads_traction(const Plugin& plugin) { return plugin.contact().traits & MPM_READS_TRACTION; }
  static bool compliant(const Plugin& plugin) { return plugin.contact().traits & MPM_COMPLIANT; }
  static int states(const Plugin& plugin) { return static_cast<int>(plugin.state().size()); }
  void apply(const Plugin& plugin, const ParameterSample& parameters) {
    const bool keeps = states(plugin) > 0;
    const mpm_contact_batch batch{static_cast<std::uint32_t>(count),
                                  mass_a.stride(),
                                  static_cast<std::uint32_t>(variant.dimension),
                                  stage,
                                  dt,
                                  mass_a.data(),
                                  mass_b.data(),
                                  momentum_a.data(),
                                  momentum_b.data(),
                                  normal.data(),
                                  separation.data(),
                                  area.data(),
                                  impulse.data(),
                                  dissipated.data(),
                                  static_cast<std::int32_t*>(status.data()),
                                  compliant(plugin) ? displacement.data() : nullptr,
                                  compliant(plugin) ? stored.data() : nullptr,
                                  reads_traction(plugin) ? traction.data() : nullptr,
                                  cell_size,
                                  keeps ? state_a.data() : nullptr,
                                  keeps ? state_b.data() : nullptr,
                                  keeps ? gained_a.data() : nullptr,
                                  keeps ? gained_b.data() : nullptr,
                                  keeps ? reached.data() : nullptr,
                                  first_step,
                                  0};
    plugin.contact().apply[variant.precision][variant.dimension - 2](parameters.data(), &batch);
  }

  Vector3 vector(const Array& array, int lane) const {
    Vector3 r{};
    for (int i = 0; i < variant.dimension; ++i) r[i] = array(i, lane);
    return r;
  }
  /// Velocity of b seen from a, before (0) or after (1) the impulse.
  Vector3 jump(int lane, double after) const {
    const Vector3 pa = vector(momentum_a, lane), pb = vector(momentum_b, lane), J = vector(impulse, lane);
    Vector3 r;
    for (int i = 0; i < 3; ++i)
      r[i] = (pb[i] - after * J[i]) / mass_b(0, lane) - (pa[i] + after * J[i]) / mass_a(0, lane);
    return r;
  }
  double kinetic_energy(int lane, double after) const {
    const Vector3 pa = vector(momentum_a, lane), pb = vector(momentum_b, lane), J = vector(impulse, lane);
    double energy = 0;
    for (int i = 0; i < 3; ++i) {
      const double a = pa[i] + after * J[i], b = pb[i] - after * J[i];
      energy += a * a / (2 * mass_a(0, lane)) + b * b / (2 * mass_b(0, lane));
    }
    return energy;
  }
};

ContactBatch applied(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const Pairs& pairs,
                     int count = full, std::uint32_t stage = MPM_AFTER_FORCES) {
  ContactBatch batch(v, pairs, count);
  batch.stage = stage;
  batch.apply(plugin, parameters);
  return batch;
}

/// The difference of two impulses. Errors are counted in impulses of unit size: every jump of the random pairs is of
/// order 1 m/s.
double impulse_difference(const ContactBatch& x, const ContactBatch& y, int lane, double sign) {
  const Vector3 a = x.vector(x.impulse, lane), b = y.vector(y.impulse, lane);
  Vector3 difference;
  for (int i = 0; i < 3; ++i) difference[i] = a[i] - sign * b[i];
  return magnitude(difference);
}

bool is_weld(const Plugin& plugin) {
  return plugin.contact().traits & MPM_BYPASSES_DETECTION;
}
bool acts_over_time(const Plugin& plugin) {
  return plugin.contact().traits & MPM_ACTS_OVER_TIME;
}

/// Checks what must hold of every single pair: no pull at a distance, no approach left, energy and status.
void check_pairs(const Plugin& plugin, const ContactBatch& b, const Pairs& pairs, const std::string& where,
                 Findings& findings) {
  const Variant& v = b.variant;
  Worst apart, approach, dissipated, energy, lost, sticking;
  bool status = true, slips = true;
  for (int lane = 0; lane < full; ++lane) {
    const Vector3 n = b.vector(b.normal, lane), after = b.jump(lane, 1), J = b.vector(b.impulse, lane);
    const double m = pairs[lane].reduced_mass(), heat = b.dissipated(0, lane);
    const double gain = (b.kinetic_energy(lane, 1) - b.kinetic_energy(lane, 0)) / (b.kinetic_energy(lane, 0) + m);
    // What acts over time may drag a pair that touches and parts, and never pulls it.
    const double drawn = lane % 4 == 1 && acts_over_time(plugin) ? dot(J, n) : magnitude(J);
    if (!is_weld(plugin) && lane % 4 != 0) apart.add(drawn / m, lane);
    if (is_weld(plugin) || lane % 4 == 0) approach.add(-dot(after, n), lane);
    dissipated.add(-heat / m, lane);
    energy.add(gain, lane);
    lost.add(heat / (b.kinetic_energy(lane, 0) + m) + gain, lane);
    const int state = static_cast<int>(b.status(0, lane));
    status &= (state == MPM_APART) == (magnitude(J) == 0) && state >= MPM_APART && state <= MPM_SLIPS;
    if (state == MPM_STICKS) sticking.add(magnitude(after), lane);
    if (state == MPM_SLIPS) slips &= magnitude(after) > 4 * v.epsilon();
  }
  const double bound = 256 * v.epsilon();
  if (!is_weld(plugin) && !(plugin.contact().traits & MPM_PULLS))
    findings.at_most("no_pull", v, apart, acts_over_time(plugin) ? 4 * v.epsilon() : 0,
                     "impulse over reduced mass of pairs that part or are apart" + where);
  if (!b.compliant(plugin))
    findings.at_most("no_approach_after", v, approach, bound, "approach left after the impulse, m/s" + where);
  findings.at_most("dissipation_not_negative", v, dissipated, 0, "negative heat over reduced mass" + where);
  if (!b.compliant(plugin)) {  // springs give back what they have stored: see check_springs
    findings.at_most("energy_never_grows", v, energy, bound, "relative gain of kinetic energy" + where);
    findings.at_most("heat_below_loss", v, lost, bound,
                     "heat reported beyond the kinetic energy lost, relative" + where);
  }
  findings.at_most("sticking_pair_moves_as_one", v, sticking, bound, "relative velocity of pairs that stick" + where);
  findings.require("sliding_pair_slides [" + v.name() + "]", slips,
                   "pairs that slip are left with a relative velocity" + where);
  findings.require("status [" + v.name() + "]", status, "apart exactly where the impulse is zero; 0, 1 or 2" + where);
}

/// Checks |J_t| <= mu J_n with mu the largest coefficient of friction among the parameters, and that what a sliding pair
/// turns to heat is the work of its friction: J_t times the mean of the velocities before and after.
void check_friction(const Plugin& plugin, const ContactBatch& b, const ParameterSample& parameters, const Pairs& pairs,
                    const std::string& where, Findings& findings) {
  double mu = -1;
  for (const mpm_parameter& p : plugin.parameters())
    if (std::strstr(p.name, "friction")) mu = std::max(mu, parameter_value(plugin, parameters, p.name, 0));
  if (mu < 0) return;
  Worst excess, work;
  for (int lane = 0; lane < full; ++lane) {
    // What holds by a strength or by springs is not held by friction.
    if (b.compliant(plugin) && b.stored(0, lane) != 0) continue;
    if (b.reads_traction(plugin) && static_cast<int>(b.status(0, lane)) == MPM_STICKS) continue;
    const Vector3 n = b.vector(b.normal, lane), J = b.vector(b.impulse, lane);
    const double normal = -dot(J, n);
    Vector3 tangential;
    for (int i = 0; i < 3; ++i) tangential[i] = J[i] + normal * n[i];
    excess.add((magnitude(tangential) - mu * normal) / pairs[lane].reduced_mass(), lane);
    if (static_cast<int>(b.status(0, lane)) != MPM_SLIPS) continue;
    const double done = (dot(tangential, b.jump(lane, 0)) + dot(tangential, b.jump(lane, 1))) / 2;
    work.add(std::abs(b.dissipated(0, lane) - done) / pairs[lane].reduced_mass(), lane);
  }
  findings.at_most("friction_bound", b.variant, excess, 256 * b.variant.epsilon(),
                   "|J_t| - mu J_n over reduced mass" + where);
  findings.at_most("heat_is_work_of_friction", b.variant, work, 256 * b.variant.epsilon(),
                   "|heat - J_t . mean velocity| over reduced mass of pairs that slide" + where);
}

/// Checks that what acts over time acts once in a step: before the forces its impulse does not depend on the step's length;
/// nor does that of springs after them, where they say nothing of time.
void check_stages(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const Pairs& pairs,
                  const std::string& where, Findings& findings) {
  if (!acts_over_time(plugin) && !ContactBatch::compliant(plugin)) return;
  const std::uint32_t stage = acts_over_time(plugin) ? MPM_BEFORE_FORCES : MPM_AFTER_FORCES;
  Pairs longer = pairs, shorter = pairs;
  // Springs of all stiffnesses that are tried are soft in a microsecond: a stiffer one would hold the pair.
  if (ContactBatch::compliant(plugin) && acts_over_time(plugin))
    for (Pair& pair : longer) pair.dt = 0x1p-20;
  for (int lane = 0; lane < full; ++lane) shorter[lane].dt = longer[lane].dt * 0x1p-20;
  const ContactBatch whole = applied(plugin, v, parameters, longer, full, stage),
                     part = applied(plugin, v, parameters, shorter, full, stage);
  Worst change;
  for (int lane = 0; lane < full; ++lane)
    change.add(impulse_difference(whole, part, lane, 1) / pairs[lane].reduced_mass(), lane);
  findings.at_most(acts_over_time(plugin) ? "acts_once_a_step" : "acts_in_no_time", v, change, 256 * v.epsilon(),
                   std::string("|J - J in a step 2^20 times shorter| over reduced mass, ") +
                       (acts_over_time(plugin) ? "before" : "after") + " the forces" + where);
}

/// Checks that springs store what they take, in a step so short that neither speed nor displacement change much in it.
void check_springs(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const Pairs& pairs,
                   const std::string& where, Findings& findings) {
  if (!ContactBatch::compliant(plugin)) return;
  Pairs shorter = pairs;
  for (Pair& pair : shorter) pair.dt = 0x1p-40, pair.gained_a = pair.gained_b = {};
  const ContactBatch b = applied(plugin, v, parameters, shorter);
  Worst difference;
  for (int lane = 0; lane < full; ++lane) {
    if (b.states(plugin) > 0 && lane % 4 == 0) continue;  // springs that have gone leave bodies that press
    const Vector3 J = b.vector(b.impulse, lane), before = b.jump(lane, 0), after = b.jump(lane, 1);
    const double work = (dot(J, before) + dot(J, after)) / 2, size = magnitude(J) * magnitude(before);
    if (size > 0) difference.add(std::abs(b.stored(0, lane) - work) / size, lane);
  }
  findings.at_most("springs_store_their_work", v, difference, 0x1p-10 + 256 * v.epsilon(),
                   "|stored - J . mean velocity| over |J| |v| in a step of next to no length" + where);
}

/// Checks that swapping the bodies flips the impulse, that turning the frame turns it, and that a moving frame changes
/// nothing.
void check_symmetry(const Plugin& plugin, const ContactBatch& b, const ParameterSample& parameters, const Pairs& pairs,
                    const Matrix3& rotation, const std::string& where, Findings& findings) {
  Pairs swapped = pairs, turned = pairs, moving = pairs;
  for (int lane = 0; lane < full; ++lane) {
    std::swap(swapped[lane].mass_a, swapped[lane].mass_b);
    std::swap(swapped[lane].velocity_a, swapped[lane].velocity_b);
    std::swap(swapped[lane].state_a, swapped[lane].state_b);
    std::swap(swapped[lane].gained_a, swapped[lane].gained_b);
    swapped[lane].normal = product(scaled(Matrix3::identity(), -1), pairs[lane].normal);
    swapped[lane].displacement = product(scaled(Matrix3::identity(), -1), pairs[lane].displacement);
    swapped[lane].traction = product(scaled(Matrix3::identity(), -1), pairs[lane].traction);
    turned[lane].velocity_a = product(rotation, pairs[lane].velocity_a);
    turned[lane].velocity_b = product(rotation, pairs[lane].velocity_b);
    turned[lane].normal = product(rotation, pairs[lane].normal);
    turned[lane].displacement = product(rotation, pairs[lane].displacement);
    turned[lane].traction = product(rotation, pairs[lane].traction);
    for (int i = 0; i < b.variant.dimension; ++i)
      for (Vector3* velocity : {&moving[lane].velocity_a, &moving[lane].velocity_b}) (*velocity)[i] += i + 1;
  }
  const ContactBatch s = applied(plugin, b.variant, parameters, swapped),
                     t = applied(plugin, b.variant, parameters, turned);
  const ContactBatch g = applied(plugin, b.variant, parameters, moving);
  Worst swap, turn, move, heat, state;
  for (int lane = 0; lane < full; ++lane) {
    const double m = pairs[lane].reduced_mass();
    swap.add(impulse_difference(s, b, lane, -1) / m, lane);
    move.add(impulse_difference(g, b, lane, 1) / m, lane);
    const Vector3 back = product(transposed(rotation), t.vector(t.impulse, lane)), J = b.vector(b.impulse, lane);
    for (int i = 0; i < 3; ++i) turn.add(std::abs(back[i] - J[i]) / m, lane);
    // What a state gives up may be far more than the energy of the pair.
    const double scale = b.states(plugin) > 0 ? m + b.dissipated(0, lane) : m;
    for (const ContactBatch* other : {&s, &t, &g}) {
      heat.add(std::abs(other->dissipated(0, lane) - b.dissipated(0, lane)) / scale, lane);
      if (b.compliant(plugin)) heat.add(std::abs(other->stored(0, lane) - b.stored(0, lane)) / scale, lane);
      for (int k = 0; k < b.states(plugin); ++k)
        state.add(std::abs(other->reached(k, lane) - b.reached(k, lane)), lane);
    }
  }
  const double bound = 512 * b.variant.epsilon();
  findings.at_most("pair_symmetry", b.variant, swap, bound, "|J + J of the swapped pair| over reduced mass" + where);
  findings.at_most("rotation_of_frame", b.variant, turn, bound, "|Q^T J' - J| over reduced mass" + where);
  findings.at_most("moving_frame", b.variant, move, bound, "|J' - J| over reduced mass" + where);
  findings.at_most("heat_invariance", b.variant, heat, bound, "heat in swapped, turned and moving frames" + where);
  if (b.states(plugin) > 0)
    findings.at_most("state_invariance", b.variant, state, bound,
                     "state reached in swapped, turned and moving frames" + where);
}

/// Checks that where nothing moves a law says nothing of its state, whatever particles keep already: what it only hands on
/// would spread by a cell in every step.
void check_state(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const Pairs& pairs,
                 const std::string& where, Findings& findings) {
  if (ContactBatch::states(plugin) == 0) return;
  Pairs still = pairs;
  for (Pair& pair : still)
    pair.velocity_a = pair.velocity_b = pair.displacement = pair.traction = {}, pair.gained_a = pair.gained_b = {};
  Pairs far = pairs;
  for (Pair& pair : far) pair.displacement = product(scaled(Matrix3::identity(), 0x1p20), pair.displacement);
  const ContactBatch resting = applied(plugin, v, parameters, still), moving = applied(plugin, v, parameters, far);
  Worst given, negative;
  for (int lane = 0; lane < full; ++lane)
    for (int k = 0; k < ContactBatch::states(plugin); ++k) {
      given.add(std::abs(resting.reached(k, lane)), lane);
      negative.add(-moving.reached(k, lane), lane);
    }
  findings.at_most("state_not_handed_on", v, given, 0, "state reached where nothing moves" + where);
  findings.at_most("state_not_negative", v, negative, 0,
                   "negative state reached by pairs that have moved a kilometre" + where);
}

/// Checks that the longest step of a law is a time, and that smaller cells do not stand longer ones.
void check_step_limit(const Plugin& plugin, const ParameterSample& parameters, const std::string& where,
                      Findings& findings) {
  const auto* table = extension_of<mpm_contact_step_limit>(plugin);
  if (!table) return;
  const double whole = table->limit(parameters.data(), 1000, cell_size),
               half = table->limit(parameters.data(), 1000, cell_size / 2);
  findings.require("step_limit_positive", whole > 0 && half > 0, "longest step, s" + where);
  findings.require("step_limit_shortens", half <= whole, "longest step on cells of half the size" + where);
}

/// Checks that a partner of infinite mass, at rest, counts as one so heavy that its mass is lost in rounding.
void check_infinite_mass(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const Pairs& pairs,
                         const std::string& where, Findings& findings) {
  Pairs heavy = pairs;
  for (Pair& pair : heavy) {
    for (int i = 0; i < 3; ++i) pair.velocity_a[i] -= pair.velocity_b[i], pair.velocity_b[i] = 0;
    pair.mass_b = 0x1p60 * pair.mass_a;
  }
  ContactBatch infinite(v, heavy, full);
  for (int lane = 0; lane < full; ++lane) infinite.mass_b.set(0, lane, std::numeric_limits<double>::infinity());
  infinite.apply(plugin, parameters);
  const ContactBatch expected = applied(plugin, v, parameters, heavy);
  Worst impulse, heat;
  bool status = true;
  for (int lane = 0; lane < full; ++lane) {
    const double m = heavy[lane].mass_a;
    impulse.add(impulse_difference(infinite, expected, lane, 1) / m, lane);
    heat.add(std::abs(infinite.dissipated(0, lane) - expected.dissipated(0, lane)) / m, lane);
    status &= infinite.status(0, lane) == expected.status(0, lane);
  }
  const double bound = 256 * v.epsilon();
  findings.at_most("infinite_mass", v, impulse, bound,
                   "|J - J beside a body 2^60 times as heavy| over the mass of the other body" + where);
  findings.at_most("heat_beside_infinite_mass", v, heat, bound, "heat beside an infinite mass" + where);
  findings.require("status_beside_infinite_mass [" + v.name() + "]", status, "status of every pair" + where);
}

void check_agreement(const ContactBatch& b, const ContactBatch& oracle, bool compliant, int states, const Pairs& pairs,
                     const std::string& where, Findings& findings) {
  Worst impulse, heat;
  bool status = true;
  for (int lane = 0; lane < full; ++lane) {
    const double m = pairs[lane].reduced_mass();
    impulse.add(impulse_difference(b, oracle, lane, 1) / m, lane);
    const double scale = states > 0 ? m + oracle.dissipated(0, lane) : m;
    heat.add(std::abs(b.dissipated(0, lane) - oracle.dissipated(0, lane)) / scale, lane);
    if (compliant) heat.add(std::abs(b.stored(0, lane) - oracle.stored(0, lane)) / scale, lane);
    for (int k = 0; k < states; ++k) heat.add(std::abs(b.reached(k, lane) - oracle.reached(k, lane)), lane);
    status &= b.status(0, lane) == oracle.status(0, lane);
  }
  const double bound = 256 * b.variant.epsilon();
  findings.at_most("agrees_with_scalar", b.variant, impulse, bound,
                   "|J - J of scalar double| over reduced mass" + where);
  findings.at_most("heat_agrees_with_scalar", b.variant, heat, bound, "heat against scalar double" + where);
  findings.require("status_agrees_with_scalar [" + b.variant.name() + "]", status, "status of every pair" + where);
}

/// Checks that a pair's result does not depend on which pairs share its pack.
void check_neighbours(const Plugin& plugin, const ContactBatch& b, const ParameterSample& parameters,
                      const Pairs& pairs, const std::string& where, Findings& findings) {
  constexpr int shift = 5;
  Pairs moved = pairs;
  std::rotate(moved.begin(), moved.begin() + shift, moved.end());
  const ContactBatch m = applied(plugin, b.variant, parameters, moved);
  bool same = true;
  for (int lane = 0; lane < full; ++lane) {
    const int other = (lane + full - shift) % full;
    for (int i = 0; i < b.variant.dimension; ++i) same &= b.impulse(i, lane) == m.impulse(i, other);
    same &= b.dissipated(0, lane) == m.dissipated(0, other);
  }
  findings.require("independent_of_neighbours [" + b.variant.name() + "]", same,
                   "bit-equal results whichever pairs share the pack" + where);
}

void check_batches(const Plugin& plugin, const ContactBatch& reference, const ParameterSample& parameters,
                   const Pairs& pairs, const std::string& where, Findings& findings) {
  bool guards = true, written = true, same = true, inputs = true;
  for (int count = MPM_LANES; count <= full; count += MPM_LANES) {
    const ContactBatch untouched(reference.variant, pairs, count);
    const ContactBatch b = applied(plugin, reference.variant, parameters, pairs, count);
    for (const Array* out : {&b.impulse, &b.dissipated, &b.status})
      guards &= out->guards_intact(), written &= out->all_written();
    guards &= b.stored.guards_intact();
    if (b.compliant(plugin)) written &= b.stored.all_written();
    guards &= b.reached.guards_intact();
    if (b.states(plugin) == static_cast<int>(MPM_CONTACT_STATES)) written &= b.reached.all_written();
    inputs &= b.mass_a == untouched.mass_a && b.mass_b == untouched.mass_b && b.momentum_a == untouched.momentum_a &&
              b.momentum_b == untouched.momentum_b && b.normal == untouched.normal &&
              b.separation == untouched.separation && b.area == untouched.area &&
              b.displacement == untouched.displacement && b.traction == untouched.traction &&
              b.state_a == untouched.state_a && b.state_b == untouched.state_b && b.gained_a == untouched.gained_a &&
              b.gained_b == untouched.gained_b;
    for (int lane = 0; lane < count; ++lane)
      for (int i = 0; i < b.variant.dimension; ++i) same &= b.impulse(i, lane) == reference.impulse(i, lane);
  }
  const std::string variant = " [" + reference.variant.name() + "]";
  findings.require("writes_inside_arrays" + variant, guards, "guards around the outputs" + where);
  findings.require("writes_every_output" + variant, written, "no output element is left out" + where);
  findings.require("inputs_untouched" + variant, inputs,
                   "masses, momenta, normal, separation, area, displacement, traction, state" + where);
  findings.require("independent_of_batch" + variant, same, "counts of 16 to 64" + where);
}

}  // namespace

void check_contact(const Plugin& plugin, Findings& findings) {
  Random random(20240602);
  for (const ParameterSample& parameters : sample_parameters(plugin, random)) {
    const std::string where = parameters.text.empty() ? "" : "; " + parameters.text;
    check_step_limit(plugin, parameters, where, findings);
    for (const Variant& v : variants_of(*plugin.descriptor)) {
      const Pairs pairs = random_pairs(random, v.dimension);
      findings.running("pairs and friction", v, where);
      const ContactBatch b = applied(plugin, v, parameters, pairs);
      check_pairs(plugin, b, pairs, where, findings);
      check_friction(plugin, b, parameters, pairs, where, findings);
      check_stages(plugin, v, parameters, pairs, where, findings);
      check_springs(plugin, v, parameters, pairs, where, findings);
      check_state(plugin, v, parameters, pairs, where, findings);
      findings.running("symmetry and frames", v, where);
      check_symmetry(plugin, b, parameters, pairs, random.rotation(v.dimension), where, findings);
      findings.running("infinite mass", v, where);
      check_infinite_mass(plugin, v, parameters, pairs, where, findings);
      findings.running("neighbours", v, where);
      check_neighbours(plugin, b, parameters, pairs, where, findings);
      findings.running("batches", v, where);
      check_batches(plugin, b, parameters, pairs, where, findings);
      if (v.precision == MPM_SCALAR_DOUBLE || !(plugin.descriptor->precisions >> MPM_SCALAR_DOUBLE & 1)) continue;
      findings.running("agreement with scalar", v, where);
      check_agreement(b, applied(plugin, {MPM_SCALAR_DOUBLE, v.dimension}, parameters, pairs), b.compliant(plugin),
                      b.states(plugin), pairs, where, findings);
    }
  }
}

}  // namespace mpm::conformance
