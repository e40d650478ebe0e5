// The suite must catch wrong plugins: each functor here has one planted mistake, and the check that names it must fail.

#include <limits>

#include "contacts/breakable_glue/breakable_glue.hpp"
#include "contacts/coulomb/coulomb.hpp"
#include "contacts/linear_interface/linear_interface.hpp"
#include "contacts/liquid_contact/liquid_contact.hpp"
#include "contacts/stick/stick.hpp"
#include "detections/approach_and_position/approach_and_position.hpp"
#include "detections/fixed_offset/fixed_offset.hpp"
#include "detections/particle_surfaces/particle_surfaces.hpp"
#include "faults/failed_checks.hpp"
#include "faults/lying_metal.hpp"
#include "filters/fmpm/fmpm.hpp"
#include "materials/neo_hookean/neo_hookean.hpp"
#include "materials/prony/prony.hpp"
#include "normals/average_volume_gradient/average_volume_gradient.hpp"
#include "normals/own_gradient/own_gradient.hpp"
#include "normals/widest_gap/widest_gap.hpp"
#include "plugin/extension_of.hpp"
#include "plugin/sdk.hpp"
#include "shapes/bspline_quadratic/bspline_quadratic.hpp"
#include "shapes/cpdi/cpdi.hpp"
#include "shapes/gimp/gimp.hpp"
#include "shapes/gimp_contiguous/gimp_contiguous.hpp"
#include "support/catch.hpp"
#include "transfers/aflip/aflip.hpp"
#include "transfers/apic/apic.hpp"
#include "transfers/asflip/asflip.hpp"
#include "transfers/flip/flip.hpp"
#include "transfers/rpic/rpic.hpp"
#include "transfers/tpic/tpic.hpp"

namespace mpm {  // so that functors find mpm::floor and its like, as those of the modules do
namespace {

using test::check_caught;
using test::failures;

constexpr sdk::Manual manual{"wrong", "1.0.0", "a wrong one", "none", "for tests", "Wrong"};
constexpr const char* source = "struct Wrong {};";

struct WrongGradientSign : BsplineQuadratic {
  template <class S>
  MPM_HD static void evaluate(const Parameters& p, S x, S& base, S* w, S* g) {
    BsplineQuadratic::evaluate(p, x, base, w, g);
    for (int k = 0; g && k < width; ++k) g[k] = -g[k];
  }
};

struct WrongPartition : BsplineQuadratic {
  template <class S>
  MPM_HD static void evaluate(const Parameters& p, S x, S& base, S* w, S* g) {
    BsplineQuadratic::evaluate(p, x, base, w, g);
    w[1] = w[1] * real<S>(1.0001);
  }
};

struct WrongSecondMoment : BsplineQuadratic {
  static constexpr double second_moment = 1.0 / 3;
};

struct WrongBase : BsplineQuadratic {  // floor(x) covers only half of the positions
  template <class S>
  MPM_HD static void evaluate(const Parameters& p, S x, S& base, S* w, S* g) {
    BsplineQuadratic::evaluate(p, x, base, w, g);
    base = floor(x);
  }
};

// ---- lists of nodes

struct RepeatsNode : Cpdi {  // the first node's weight comes in two halves
  template <int D>
  static constexpr int capacity = Cpdi::capacity<D> + 1;
  template <int D, class T>
  MPM_HD static void evaluate(const Parameters& p, const Vec<D, T>& x, const Mat<D, T>& domain,
                              NodeList<D, T, capacity<D>>& out) {
    Cpdi::List<D, T> list;
    Cpdi::evaluate(p, x, domain, list);
    out.count = list.count + 1;
    for (int k = 0; k < out.count; ++k) {
      const int from = k < list.count ? k : 0;
      const T share = from == 0 ? T(0.5) : T(1);
      out.weight[k] = share * list.weight[from];
      for (int a = 0; a < D; ++a)
        out.node[k][a] = list.node[from][a], out.gradient[k][a] = share * list.gradient[from][a];
    }
  }
};

struct MissesNode : Cpdi {
  template <int D, class T>
  MPM_HD static void evaluate(const Parameters& p, const Vec<D, T>& x, const Mat<D, T>& domain, List<D, T>& out) {
    Cpdi::evaluate(p, x, domain, out);
    if (out.count > 1) --out.count;
  }
};

struct TurnsListGradient : Cpdi {  // takes R^-1 where R^-T belongs
  template <int D, class T>
  MPM_HD static void evaluate(const Parameters& p, const Vec<D, T>& x, const Mat<D, T>& domain, List<D, T>& out) {
    Mat<D, T> turned;
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) turned(i, j) = domain(j, i);
    List<D, T> other;
    Cpdi::evaluate(p, x, turned, other);
    Cpdi::evaluate(p, x, domain, out);
    for (int k = 0; k < out.count && k < other.count; ++k)
      for (int a = 0; a < D; ++a) out.gradient[k][a] = other.gradient[k][a];
  }
};

struct OutOfReach : Cpdi {
  static constexpr double reach = 0.5;
};

struct BoxLosesWeight : Cpdi {
  template <int W, int D, bool Gradients, class S>
  MPM_HD static void row_in_box(const Rows<W, D, S>& rows, int i, int j, S* w, S (*g)[W]) {
    Cpdi::row_in_box<W, D, Gradients, S>(rows, i, j, w, g);
    w[1] = w[1] * real<S>(0.999);
  }
};

struct BoxTurnsGradient : Cpdi {
  template <int W, int D, bool Gradients, class S>
  MPM_HD static void row_in_box(const Rows<W, D, S>& rows, int i, int j, S* w, S (*g)[W]) {
    Cpdi::row_in_box<W, D, Gradients, S>(rows, i, j, w, g);
    for (int k = 0; Gradients && k < W; ++k) {
      const S first = g[0][k];
      g[0][k] = g[1][k], g[1][k] = first;
    }
  }
};

struct BoxCutsNodes : Cpdi {  // says three nodes where there are four
  template <int D, class S>
  MPM_HD static S box(const Parameters& p, const Vec<D, S>& x, const Mat<D, S>& domain, bool gradients,
                      Vec<D, S>& base) {
    return min(Cpdi::box<D, S>(p, x, domain, gradients, base), S(real<S>(3)));
  }
};

struct BoxTakesAll : Cpdi {  // says three nodes where there is no box
  template <int D, class S>
  MPM_HD static S box(const Parameters& p, const Vec<D, S>& x, const Mat<D, S>& domain, bool gradients,
                      Vec<D, S>& base) {
    return max(Cpdi::box<D, S>(p, x, domain, gradients, base), S(real<S>(3)));
  }
};

struct BoxTooWide : Cpdi {
  template <int D, class S>
  MPM_HD static S box(const Parameters& p, const Vec<D, S>& x, const Mat<D, S>& domain, bool gradients,
                      Vec<D, S>& base) {
    const S extent = Cpdi::box<D, S>(p, x, domain, gradients, base);
    return select(extent > real<S>(3), S(real<S>(5)), extent);
  }
};

struct BoxLosesMoment : Cpdi {  // leaves the tents' own width out
  template <int W, int D, class S>
  MPM_HD static Mat<D, S> moment_of_box(const Rows<W, D, S>&, const Mat<D, S>& domain) {
    Mat<D, S> moment{};
    for (int a = 0; a < D; ++a)
      for (int b = 0; b < D; ++b)
        for (int k = 0; k < D; ++k) moment(a, b) = moment(a, b) + domain(a, k) * domain(b, k);
    return moment;
  }
};

struct BoxRoundsCells : Cpdi {  // rounds differently on both sides of zero
  template <int D, class S>
  MPM_HD static S box(const Parameters& p, const Vec<D, S>& x, const Mat<D, S>& domain, bool gradients,
                      Vec<D, S>& base) {
    const S extent = Cpdi::box<D, S>(p, x, domain, gradients, base);
    return select(x[0] > real<S>(0), extent, S(real<S>(0)));
  }
};

/// A box's weights depend on the particle before, as far as there is one.
template <int D, class S>
void leaning_box(const void* parameters, const mpm_box_batch* q) {
  using T = scalar_of<S>;
  sdk::box_batch<Cpdi, D, S>(parameters, q);
  T* const weight = static_cast<T*>(q->weight);
  for (std::uint32_t lane = 1; lane < q->count; ++lane)
    if (q->extent[lane - 1] == MPM_BOX_WIDTH) weight[lane] += std::numeric_limits<T>::epsilon();
}
/// Writes a base for one particle more than there are.
template <int D, class S>
void long_box(const void* parameters, const mpm_box_batch* q) {
  sdk::box_batch<Cpdi, D, S>(parameters, q);
  q->base[q->count] = 0;
}
constexpr mpm_shape_boxes leaning_boxes{MPM_SHAPE_BOXES_VERSION,
                                        0,
                                        {{&leaning_box<2, Lanes<float>>, &leaning_box<3, Lanes<float>>},
                                         {&leaning_box<2, Lanes<double>>, &leaning_box<3, Lanes<double>>},
                                         {&leaning_box<2, double>, &leaning_box<3, double>}}};
constexpr mpm_shape_boxes long_boxes{MPM_SHAPE_BOXES_VERSION,
                                     0,
                                     {{&long_box<2, Lanes<float>>, &long_box<3, Lanes<float>>},
                                      {&long_box<2, Lanes<double>>, &long_box<3, Lanes<double>>},
                                      {&long_box<2, double>, &long_box<3, double>}}};

struct CutsLongBoxes : GimpContiguous {  // keeps half of the weight of a box that its nodes do not hold
  template <class S>
  MPM_HD static void evaluate(const Parameters& p, S x, S l, S& base, S* w, S* g) {
    const S one(real<S>(1)), kept = select(l > real<S>(1), S(real<S>(0.5)), one);
    GimpContiguous::evaluate(p, x, min(l, one), base, w, g);
    for (int k = 0; k < width; ++k) w[k] = kept * w[k];
  }
};

struct BaseFollowsBox : GimpContiguous {
  template <class S>
  MPM_HD static void evaluate(const Parameters& p, S x, S l, S& base, S* w, S* g) {
    GimpContiguous::evaluate(p, x, l, base, w, g);
    base = base - select(l > real<S>(0.3), S(real<S>(1)), S(real<S>(0)));
  }
};

struct HoldsNarrowBoxes : GimpContiguous {
  template <class S>
  MPM_HD static void evaluate(const Parameters& p, S x, S l, S& base, S* w, S* g) {
    GimpContiguous::evaluate(p, x, select(l > real<S>(0.3), S(real<S>(2)), l), base, w, g);
  }
};

/// Makes the exported second moment of a box 1 % too large.
template <class S>
void large_moment(const void* parameters, const mpm_shape_batch* q) {
  sdk::shape_batch<Gimp, S>(parameters, q);
  if (!q->second_moment) return;
  for (std::uint32_t axis = 0; axis < q->dimension; ++axis)
    for (std::uint32_t lane = 0; lane < q->count; ++lane)
      static_cast<scalar_of<S>*>(q->second_moment)[axis * q->stride + lane] *= real<S>(1.01);
}
constexpr mpm_shape large_moment_table{
    MPM_TENSOR_PRODUCT,
    3,
    MPM_MOMENT_PER_PARTICLE,
    0,
    0,
    {&large_moment<Lanes<float>>, &large_moment<Lanes<double>>, &large_moment<double>},
    {0, 0},
    0,
    {},
    {0, 0}};

/// Leaves the off-diagonal of a list's second moment out.
template <int D, class T>
void diagonal_moment(const void* parameters, const mpm_list_batch* q) {
  sdk::list_batch<Cpdi, D, T>(parameters, q);
  if (!q->second_moment) return;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j)
      for (std::uint32_t lane = 0; lane < q->count && i != j; ++lane)
        static_cast<T*>(q->second_moment)[static_cast<std::uint32_t>(i * D + j) * q->stride + lane] = 0;
}
constexpr mpm_shape diagonal_moment_table{MPM_NODE_LIST,
                                          0,
                                          MPM_MOMENT_PER_PARTICLE,
                                          0,
                                          0,
                                          {},
                                          {16, 64},
                                          1,
                                          {{&diagonal_moment<2, float>, &diagonal_moment<3, float>},
                                           {&diagonal_moment<2, double>, &diagonal_moment<3, double>},
                                           {&diagonal_moment<2, double>, &diagonal_moment<3, double>}},
                                          {0, 0}};

// ---- filters

struct FilterMakesNaN : Fmpm {
  template <int D, class S>
  MPM_HD static void update(const Parameters& p, int iteration, const Vec<D, S>& projected, Vec<D, S>& increment,
                            Vec<D, S>& velocity) {
    Fmpm::update(p, iteration, projected, increment, velocity);
    velocity[0] = velocity[0] + (sqrt(projected[0]) - sqrt(projected[0]));  // root of a negative number
  }
};

struct FilterSlowsDown : Fmpm {
  template <int D, class S>
  MPM_HD static void update(const Parameters& p, int iteration, const Vec<D, S>& projected, Vec<D, S>& increment,
                            Vec<D, S>& velocity) {
    Fmpm::update(p, iteration, projected, increment, velocity);
    for (int i = 0; i < D; ++i) velocity[i] = real<S>(0.99) * velocity[i];
  }
};

struct FilterRunsBackwards : Fmpm {
  MPM_HD static int iterations(const Parameters& p) { return -static_cast<int>(p.order); }
};

/// A filter that reads the node after each: the last reads beyond the batch.
template <int D, class S>
void reads_beyond(const void* parameters, const mpm_filter_batch* q) {
  using T = scalar_of<S>;
  sdk::filter_batch<Fmpm, D, S>(parameters, q);
  T* velocity = static_cast<T*>(q->velocity);
  const T* projected = static_cast<const T*>(q->projected);
  for (std::uint32_t lane = 0; lane < q->count; ++lane) velocity[lane] += projected[lane + 1] - projected[lane];
}
/// A filter that writes the velocity of one node more than there are.
template <int D, class S>
void writes_beyond(const void* parameters, const mpm_filter_batch* q) {
  sdk::filter_batch<Fmpm, D, S>(parameters, q);
  static_cast<scalar_of<S>*>(q->velocity)[q->count] = 0;
}
constexpr mpm_filter reads_beyond_table{0,
                                        0,
                                        &sdk::filter_iterations<Fmpm>,
                                        {{&reads_beyond<2, Lanes<float>>, &reads_beyond<3, Lanes<float>>},
                                         {&reads_beyond<2, Lanes<double>>, &reads_beyond<3, Lanes<double>>},
                                         {&reads_beyond<2, double>, &reads_beyond<3, double>}}};
constexpr mpm_filter writes_beyond_table{0,
                                         0,
                                         &sdk::filter_iterations<Fmpm>,
                                         {{&writes_beyond<2, Lanes<float>>, &writes_beyond<3, Lanes<float>>},
                                          {&writes_beyond<2, Lanes<double>>, &writes_beyond<3, Lanes<double>>},
                                          {&writes_beyond<2, double>, &writes_beyond<3, double>}}};

/// The descriptor of a right plugin over another table.
template <class Table>
mpm_descriptor with_table(mpm_descriptor descriptor, const Table& table) {
  descriptor.kind_table = &table;
  return descriptor;
}

/// A copy of a descriptor with another table as its one extension.
template <const auto& table>
mpm_descriptor with_extension(mpm_descriptor descriptor) {
  using Table = std::remove_cvref_t<decltype(table)>;
  descriptor.extension = [](const char* id) -> const void* {
    return std::string_view(id) == extension_info<Table>.id ? &table : nullptr;
  };
  return descriptor;
}

struct HalvesGradient : Tpic {
  template <int D, class S>
  MPM_HD static void gather(const Parameters& p, const GatheredMoments<D, S>& moments, scalar_of<S> dt, Vec<D, S>& v,
                            State<D, S>& state, Vec<D, S>& advection) {
    Tpic::gather(p, moments, dt, v, state, advection);
    for (S& entry : state.velocity_gradient.m) entry = real<S>(0.5) * entry;
  }
};

struct HalvesSpin : Rpic {
  template <int D, class S>
  MPM_HD static void gather(const Parameters& p, const GatheredMoments<D, S>& moments, scalar_of<S> dt, Vec<D, S>& v,
                            State<D, S>& state, Vec<D, S>& advection) {
    Rpic::gather(p, moments, dt, v, state, advection);
    for (S& entry : state.spin.m) entry = real<S>(0.5) * entry;
  }
};

/// Moves with all of the particle's own velocity, as if nothing had been given to the grid.
struct AdvectsByTwice : Asflip {
  template <int D, class S>
  MPM_HD static void gather(const Parameters& p, const GatheredMoments<D, S>& moments, scalar_of<S> dt, Vec<D, S>& v,
                            State<D, S>& state, Vec<D, S>& advection) {
    Asflip::gather(p, moments, dt, v, state, advection);
    for (int i = 0; i < D; ++i) advection[i] = moments.velocity[i] + v[i];
  }
};

struct LosesMomentum : Apic {
  template <int D, class S>
  MPM_HD static void scatter(const Parameters& p, S mass, const Vec<D, S>& v, const State<D, S>& state, Vec<D, S>& b,
                             Mat<D, S>& A) {
    Apic::scatter(p, mass, v, state, b, A);
    b[0] = b[0] * real<S>(0.999);
  }
};

struct TransposesAffine : Apic {
  template <int D, class S>
  MPM_HD static void gather(const Parameters& p, const GatheredMoments<D, S>& moments, scalar_of<S> dt, Vec<D, S>& v,
                            State<D, S>& state, Vec<D, S>& advection) {
    Apic::gather(p, moments, dt, v, state, advection);
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) state.affine_velocity(i, j) = moments.affine(j, i);
  }
};

struct KeepsMotionSecretly : Flip {
  static constexpr unsigned traits = Flip::traits | MPM_REPLACES_MOTION;
};

struct MovesTwiceAsFar : Apic {
  template <int D, class S>
  static void gather(const Parameters& p, const GatheredMoments<D, S>& moments, scalar_of<S> dt, Vec<D, S>& v,
                     State<D, S>& state, Vec<D, S>& advection) {
    Apic::gather(p, moments, dt, v, state, advection);
    for (int i = 0; i < D; ++i) advection[i] = advection[i] + advection[i];
  }
};

struct ForgetsVelocity : Flip {
  template <int D, class S>
  MPM_HD static void gather(const Parameters&, const GatheredMoments<D, S>& moments, scalar_of<S>, Vec<D, S>& v,
                            State<D, S>&, Vec<D, S>& advection) {
    v = moments.velocity;
    advection = moments.velocity;
  }
};

struct GainsEnergy : Coulomb {
  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    Coulomb::apply(p, pair, result);
    for (int i = 0; i < D; ++i) result.impulse[i] = real<S>(2.5) * result.impulse[i];
  }
};

struct OneSided : Coulomb {  // stops the pair as if body b had no mass
  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    Coulomb::apply(p, pair, result);
    const S share = pair.mass_a / (pair.mass_a + pair.mass_b);
    for (int i = 0; i < D; ++i) result.impulse[i] = share * result.impulse[i];
  }
};

struct Pulls : Coulomb {
  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    ContactPair<D, S> touching = pair;
    touching.separation = S(real<S>(-1));
    Coulomb::apply(p, touching, result);
  }
};

struct HeatsTooLittle : Coulomb {
  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    Coulomb::apply(p, pair, result);
    result.dissipated = real<S>(0.5) * result.dissipated;
  }
};

struct SlipsInPlace : Stick {  // says that a weld slips
  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    Stick::apply(p, pair, result);
    result.status = S(real<S>(2));
  }
};

struct MultipliesMasses : Coulomb {  // makes the reduced mass by a product, which is infinite beside a rigid body
  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    Coulomb::apply(p, pair, result);
    const S product = pair.mass_a * pair.mass_b / (pair.mass_a + pair.mass_b);
    const S share = product / reduced_mass_of(pair.mass_a, pair.mass_b);
    for (int i = 0; i < D; ++i) result.impulse[i] = share * result.impulse[i];
  }
};

struct PullsOpenly : Pulls {  // is the same law, declared
  static constexpr unsigned traits = MPM_PULLS;
};

struct DragsTwice : LiquidContact {  // drags before the forces too
  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    ContactPair<D, S> again = pair;
    again.after_forces = true;
    LiquidContact::apply(p, again, result);
  }
};

struct SpringsUnsaid : LinearInterface {  // says nothing of the time over which it pulls
  static constexpr unsigned traits = MPM_PULLS | MPM_COMPLIANT;
};

struct LiquidPulls : LiquidContact {  // slows what parts, along the normal too
  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    LiquidContact::apply(p, pair, result);
    const RelativeMotion<D, S> motion(pair);
    const scalar_of<S> zero = 0;
    const S parts = select(motion.approach < zero, motion.approach, S(zero));
    for (int i = 0; i < D; ++i)
      result.impulse[i] = result.impulse[i] - motion.reduced_mass * parts * pair.normal[i] * real<S>(0.1);
  }
};

struct HalfSprings : LinearInterface {  // says that its springs store half of what they take
  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    LinearInterface::apply(p, pair, result);
    result.stored = real<S>(0.5) * result.stored;
  }
};

struct SpreadsItsState : BreakableGlue {  // says again what it was told
  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    BreakableGlue::apply(p, pair, result);
    result.reached[broken] = max(result.reached[broken], max(pair.state_a[broken], pair.state_b[broken]));
  }
};

struct OneSidedState : BreakableGlue {  // asks the first body alone what it keeps
  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    ContactPair<D, S> alone = pair;
    alone.state_b = pair.state_a;
    BreakableGlue::apply(p, alone, result);
  }
};

struct HealsItself : BreakableGlue {  // takes back what has broken
  template <int D, class S>
  MPM_HD static void apply(const Parameters& p, const ContactPair<D, S>& pair, ContactResult<D, S>& result) {
    BreakableGlue::apply(p, pair, result);
    result.reached[glued] = real<S>(-0.1) * result.reached[broken];
  }
};

struct EndlessStep : BreakableGlue {  // stands longer steps on smaller cells
  static double step_limit(const Parameters&, double, double cell_size) { return 1 / cell_size; }
};

struct StressOffEnergy : NeoHookean {
  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    Sym<D, S> tau = NeoHookean::kirchhoff_stress(c, state);
    for (S& component : tau.s) component = component * real<S>(1.001);
    return tau;
  }
};

struct ShearOffEnergy
    : NeoHookean {  // its shear modulus grows with the volume, in the stress alone; says less of itself
  static constexpr unsigned traits = MPM_OBJECTIVE;
  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    Sym<D, S> tau = NeoHookean::kirchhoff_stress(c, state);
    const S mean = (tau.s[0] + tau.s[1] + tau.s[2]) / real<S>(3), J = NeoHookean::volume_ratio(state);
    for (std::size_t k = 0; k < std::size(tau.s); ++k)
      tau.s[k] = tau.s[k] + real<S>(0.5) * (J - real<S>(1)) * (k < 3 ? S(tau.s[k] - mean) : tau.s[k]);
    return tau;
  }
};

/// Stores a thousandth more than its stress has worked, which lies within what the steps of a plastic path leave.
struct StoresTooMuch : VonMises {
  template <class C, class State>
  MPM_HD static auto stored_energy(const C& c, const State& state) {
    auto energy = VonMises::stored_energy(c, state);
    return decltype(energy)(energy * real<decltype(energy)>(1.001));
  }
};

struct AlwaysWarm : VonMises {  // says heat in every step, so that no strain of it is elastic
  template <class G, int D, class S>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const G& L, scalar_of<S> dt, State<D, S>& state) {
    return VonMises::advance(c, L, dt, state) + real<S>(1e-3) * c.mu;
  }
};

struct Creeps : NeoHookean {  // grows by a millionth a step
  template <int D, class S>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const Mat<D, S>& L, scalar_of<S> dt, State<D, S>& state) {
    const S heat = NeoHookean::advance(c, L, dt, state);
    state.deformation_gradient(0, 0) = state.deformation_gradient(0, 0) * real<S>(1 + 1e-6);
    return heat;
  }
};

struct SlowWave : NeoHookean {
  template <int D, class S>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    return real<S>(0.8) * NeoHookean::wave_speed(c, state);
  }
};

struct SlowBranches : Prony {  // leaves out half of what its branches carry at once
  template <class G, class S = typename G::Scalar>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const PronyState<G>& state) {
    return real<S>(0.7) * Prony::wave_speed(c, state);
  }
};

struct SpeedWithoutDensity : NeoHookean {
  template <int D, class S>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    return NeoHookean::wave_speed(c, state) / sqrt(c.inverse_density);
  }
};

struct SquaredPascals : NeoHookean {  // multiplies by a modulus too often
  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    Sym<D, S> tau = NeoHookean::kirchhoff_stress(c, state);
    for (S& component : tau.s) component = component * c.mu;
    return tau;
  }
};

struct NotObjective : NeoHookean {  // takes the right instead of the left Cauchy-Green tensor
  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    State<D, S> transposed;
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) transposed.deformation_gradient(i, j) = state.deformation_gradient(j, i);
    return NeoHookean::kirchhoff_stress(c, transposed);
  }
};

struct CreatesHeat : NeoHookean {
  template <int D, class S>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const Mat<D, S>& L, scalar_of<S> dt, State<D, S>& state) {
    NeoHookean::advance(c, L, dt, state);
    return S(c.mu * dt);
  }
};

struct HidesInversion : NeoHookean {
  template <int D, class S>
  MPM_HD static S volume_ratio(const State<D, S>& state) {
    return abs(NeoHookean::volume_ratio(state));
  }
};

/// The descriptor of a functor, alive for the whole test.
template <class F>
constexpr mpm_descriptor wrong_shape = sdk::shape<F>(manual, source);
template <class F>
constexpr mpm_descriptor wrong_filter = sdk::filter<F>(manual, source);
template <class F>
constexpr mpm_descriptor wrong_transfer = sdk::transfer<F>(manual, source);
template <class F>
constexpr mpm_descriptor wrong_normal = sdk::normal<F>(manual, source);
template <class F>
constexpr mpm_descriptor wrong_detection = sdk::detection<F>(manual, source);
template <class F>
constexpr mpm_descriptor wrong_contact = sdk::contact<F>(manual, source);
template <class F>
constexpr mpm_descriptor wrong_material = sdk::material<F>(manual, source);

TEST_CASE("the plugins that the wrong ones are made from pass") {
  CHECK(failures(wrong_shape<BsplineQuadratic>).empty());
  CHECK(failures(wrong_shape<Gimp>).empty());
  CHECK(failures(wrong_shape<GimpContiguous>).empty());
  CHECK(failures(wrong_shape<Cpdi>).empty());
  CHECK(failures(wrong_filter<Fmpm>).empty());
  CHECK(failures(wrong_transfer<Tpic>).empty());
  CHECK(failures(wrong_transfer<Apic>).empty());
  CHECK(failures(wrong_transfer<Rpic>).empty());
  CHECK(failures(wrong_transfer<Aflip>).empty());
  CHECK(failures(wrong_transfer<Asflip>).empty());
  CHECK(failures(wrong_transfer<Flip>).empty());
  CHECK(failures(wrong_contact<Coulomb>).empty());
  CHECK(failures(wrong_contact<Stick>).empty());
  CHECK(failures(wrong_material<NeoHookean>).empty());
}

TEST_CASE("wrong shapes are caught") {
  check_caught(wrong_shape<WrongGradientSign>, "gradient_is_derivative");
  check_caught(wrong_shape<WrongGradientSign>, "affine_consistency");
  check_caught(wrong_shape<WrongPartition>, "partition_of_unity");
  check_caught(wrong_shape<WrongSecondMoment>, "second_moment_constant");
  check_caught(wrong_shape<WrongBase>, "linear_consistency");
}

TEST_CASE("wrong exported second moments are caught") {
  check_caught(with_table(wrong_shape<Gimp>, large_moment_table), "second_moment_summed");
  check_caught(with_table(wrong_shape<Cpdi>, diagonal_moment_table), "second_moment_summed");
}

TEST_CASE("wrong boxes that follow the deformation are caught") {
  check_caught(wrong_shape<CutsLongBoxes>, "holds_or_has_no_weight");
  check_caught(wrong_shape<BaseFollowsBox>, "base_of_position_alone");
  check_caught(wrong_shape<HoldsNarrowBoxes>, "holds_undeformed_boxes");
}

TEST_CASE("wrong lists of nodes are caught") {
  check_caught(wrong_shape<RepeatsNode>, "unique_nodes");
  check_caught(wrong_shape<MissesNode>, "partition_of_unity");
  check_caught(wrong_shape<MissesNode>, "affine_value");
  check_caught(wrong_shape<TurnsListGradient>, "affine_consistency");
  check_caught(wrong_shape<TurnsListGradient>, "affine_slope");
  check_caught(wrong_shape<OutOfReach>, "reach");
}

TEST_CASE("wrong boxes are caught") {
  check_caught(wrong_shape<BoxLosesWeight>, "box_agrees_with_list");
  check_caught(wrong_shape<BoxTurnsGradient>, "box_gradient_agrees_with_list");
  check_caught(wrong_shape<BoxCutsNodes>, "box_holds_list");
  check_caught(wrong_shape<BoxTakesAll>, "box_refuses");
  check_caught(wrong_shape<BoxTooWide>, "box_extent");
  check_caught(wrong_shape<BoxLosesMoment>, "box_second_moment_agrees_with_list");
  check_caught(wrong_shape<BoxRoundsCells>, "box_translation");
  check_caught(with_extension<leaning_boxes>(wrong_shape<Cpdi>), "box_independent_of_neighbours");
  check_caught(with_extension<long_boxes>(wrong_shape<Cpdi>), "box_writes_inside_arrays");
}

TEST_CASE("wrong filters are caught") {
  check_caught(wrong_filter<FilterMakesNaN>, "finite");
  check_caught(wrong_filter<FilterSlowsDown>, "uniform_motion_kept");
  check_caught(wrong_filter<FilterRunsBackwards>, "iterations_not_negative");
  check_caught(with_table(wrong_filter<Fmpm>, reads_beyond_table), "independent_of_batch");
  check_caught(with_table(wrong_filter<Fmpm>, reads_beyond_table), "independent_of_neighbours");
  check_caught(with_table(wrong_filter<Fmpm>, writes_beyond_table), "writes_inside_arrays");
}

TEST_CASE("wrong transfers are caught") {
  check_caught(wrong_transfer<HalvesGradient>, "round_trip_velocity");
  check_caught(wrong_transfer<HalvesSpin>, "angular_momentum");
  check_caught(wrong_transfer<HalvesSpin>, "round_trip_velocity");
  check_caught(wrong_transfer<AdvectsByTwice>, "round_trip_advection");
  check_caught(wrong_transfer<LosesMomentum>, "scattered_momentum");
  check_caught(wrong_transfer<TransposesAffine>, "angular_momentum");
  check_caught(wrong_transfer<TransposesAffine>, "round_trip_velocity");
  check_caught(wrong_transfer<ForgetsVelocity>, "zero_increment_keeps_velocity");
  check_caught(wrong_transfer<KeepsMotionSecretly>, "replaces_motion");
  check_caught(wrong_transfer<MovesTwiceAsFar>, "moves_with_gathered_velocity");
}

struct LongNormal : AverageVolumeGradient {
  template <int D, class S>
  MPM_HD static void find(const Parameters& p, const NormalPair<D, S>& pair, NormalResult<D, S>& result) {
    AverageVolumeGradient::find(p, pair, result);
    for (int i = 0; i < D; ++i) result.normal[i] = real<S>(1.01) * result.normal[i];
  }
};

struct BackwardsNormal : AverageVolumeGradient {
  template <int D, class S>
  MPM_HD static void find(const Parameters& p, const NormalPair<D, S>& pair, NormalResult<D, S>& result) {
    AverageVolumeGradient::find(p, pair, result);
    for (int i = 0; i < D; ++i) result.normal[i] = real<S>(-1) * result.normal[i];
  }
};

struct FirstBodysNormal : AverageVolumeGradient {
  template <int D, class S>
  MPM_HD static void find(const Parameters&, const NormalPair<D, S>& pair, NormalResult<D, S>& result) {
    result.normal = pair.volume_gradient_a;
    result.found = make_unit(result.normal);
  }
};

struct NormalOfFrame : AverageVolumeGradient {  // takes the first axis for the better one
  template <int D, class S>
  MPM_HD static void find(const Parameters&, const NormalPair<D, S>& pair, NormalResult<D, S>& result) {
    for (int i = 0; i < D; ++i)
      result.normal[i] = real<S>(i ? 1 : 1.01) * (pair.volume_gradient_a[i] - pair.volume_gradient_b[i]);
    result.found = make_unit(result.normal);
  }
};

struct NormalOfNothing : AverageVolumeGradient {
  template <int D, class S>
  MPM_HD static void find(const Parameters& p, const NormalPair<D, S>& pair, NormalResult<D, S>& result) {
    AverageVolumeGradient::find(p, pair, result);
    result.found = S(real<S>(1));
  }
};

struct SharedOwnNormals : OwnGradient {  // says that momentum is not kept, and keeps it
  template <int D, class S>
  MPM_HD static void find(const Parameters& p, const NormalPair<D, S>& pair, NormalResult<D, S>& result) {
    OwnGradient::find(p, pair, result);
    result.own_a = result.own_b = result.normal;
  }
};

struct ShortOwnNormals : OwnGradient {
  template <int D, class S>
  MPM_HD static void find(const Parameters& p, const NormalPair<D, S>& pair, NormalResult<D, S>& result) {
    OwnGradient::find(p, pair, result);
    for (int i = 0; i < D; ++i) result.own_b[i] = real<S>(0.99) * result.own_b[i];
  }
};

struct TiltedGap : WidestGap {
  template <int D, class Points>
  MPM_HD static bool find(const Parameters& p, const Points& points, double* normal) {
    if (!WidestGap::find<D>(p, points, normal)) return false;
    const double x = normal[0];
    normal[0] = std::cos(0.01) * x - std::sin(0.01) * normal[1];
    normal[1] = std::sin(0.01) * x + std::cos(0.01) * normal[1];
    return true;
  }
};

struct BackwardsGap : WidestGap {
  template <int D, class Points>
  MPM_HD static bool find(const Parameters& p, const Points& points, double* normal) {
    const bool found = WidestGap::find<D>(p, points, normal);
    for (int c = 0; c < D; ++c) normal[c] = -normal[c];
    return found;
  }
};

struct NoGap : WidestGap {
  template <int D, class Points>
  MPM_HD static bool find(const Parameters&, const Points&, double*) {
    return false;
  }
};

TEST_CASE("wrong contact normals are caught") {
  CHECK(failures(wrong_normal<AverageVolumeGradient>).empty());
  CHECK(failures(wrong_normal<OwnGradient>).empty());
  CHECK(failures(wrong_normal<WidestGap>).empty());
  check_caught(wrong_normal<LongNormal>, "unit_length");
  check_caught(wrong_normal<BackwardsNormal>, "from_a_to_b");
  check_caught(wrong_normal<FirstBodysNormal>, "exchange_of_bodies");
  check_caught(wrong_normal<NormalOfFrame>, "rotation_of_frame");
  check_caught(wrong_normal<NormalOfNothing>, "none_of_nothing");
  check_caught(wrong_normal<SharedOwnNormals>, "own_normals_differ");
  check_caught(wrong_normal<ShortOwnNormals>, "own_unit_length");
  check_caught(wrong_normal<TiltedGap>, "mirror_image");
  check_caught(wrong_normal<BackwardsGap>, "from_a_to_b");
  check_caught(wrong_normal<NoGap>, "finds_a_normal");
}

struct GapOfFirstBody : ApproachAndPosition {
  template <class S>
  MPM_HD static S gap(const Parameters&, const DetectionPair<S>& pair) {
    return pair.edge_b - real<S>(1.01) * pair.edge_a;
  }
};

struct BackwardsDetection : ApproachAndPosition {
  template <class S>
  MPM_HD static S gap(const Parameters&, const DetectionPair<S>& pair) {
    return pair.edge_a - pair.edge_b;
  }
};

struct AsksForMeans : ApproachAndPosition {  // which it does not read
  static constexpr unsigned traits = MPM_READS_EDGES | MPM_READS_MEAN_POSITION;
};

struct OffsetWithoutMeans : FixedOffset {
  template <class S>
  MPM_HD static S gap(const Parameters& p, const DetectionPair<S>&) {
    return S(real<S>(p.offset));
  }
};

struct GapOverNothing : ApproachAndPosition {
  template <class S>
  MPM_HD static S gap(const Parameters&, const DetectionPair<S>& pair) {
    return (pair.edge_b - pair.edge_a) / pair.mean_a;  // which it does not ask for
  }
};

TEST_CASE("wrong contact detections are caught") {
  CHECK(failures(wrong_detection<ApproachAndPosition>).empty());
  CHECK(failures(wrong_detection<FixedOffset>).empty());
  CHECK(failures(wrong_detection<ParticleSurfaces>).empty());
  check_caught(wrong_detection<GapOfFirstBody>, "exchange_of_bodies");
  check_caught(wrong_detection<BackwardsDetection>, "moving_apart");
  check_caught(wrong_detection<AsksForMeans>, "reads_mean_position");
  check_caught(wrong_detection<OffsetWithoutMeans>, "reads_mean_position");
  check_caught(wrong_detection<GapOverNothing>, "finite_gap");
}

TEST_CASE("wrong contact laws are caught") {
  check_caught(wrong_contact<GainsEnergy>, "energy_never_grows");
  check_caught(wrong_contact<OneSided>, "pair_symmetry");
  check_caught(wrong_contact<OneSided>, "no_approach_after");
  check_caught(wrong_contact<HeatsTooLittle>, "heat_is_work_of_friction");
  check_caught(wrong_contact<SlipsInPlace>, "sliding_pair_slides");
  check_caught(wrong_contact<Pulls>, "no_pull");
  check_caught(wrong_contact<MultipliesMasses>, "infinite_mass");
  CHECK(failures(wrong_contact<PullsOpenly>).count("no_pull") == 0);
  CHECK(failures(wrong_contact<LiquidContact>).empty());
  CHECK(failures(wrong_contact<LinearInterface>).empty());
  check_caught(wrong_contact<DragsTwice>, "acts_once_a_step");
  check_caught(wrong_contact<SpringsUnsaid>, "acts_in_no_time");
  check_caught(wrong_contact<LiquidPulls>, "no_pull");
  check_caught(wrong_contact<HalfSprings>, "springs_store_their_work");
  CHECK(failures(wrong_contact<BreakableGlue>).empty());
  check_caught(wrong_contact<SpreadsItsState>, "state_not_handed_on");
  check_caught(wrong_contact<OneSidedState>, "pair_symmetry");
  check_caught(wrong_contact<HealsItself>, "state_not_negative");
  check_caught(wrong_contact<EndlessStep>, "step_limit_shortens");
}

TEST_CASE("wrong materials are caught") {
  check_caught(wrong_material<StressOffEnergy>, "stress_from_energy");
  check_caught(wrong_material<ShearOffEnergy>, "closed_path");
  check_caught(wrong_material<test::LyingMetal>, "closed_path");
  check_caught(wrong_material<StoresTooMuch>, "stress_from_elastic_energy");
  CHECK(failures(wrong_material<StoresTooMuch>).count("closed_path") == 0);
  check_caught(wrong_material<AlwaysWarm>, "elastic_strains_found");
  check_caught(wrong_material<Creeps>, "closed_path_returns");
  check_caught(wrong_material<SlowWave>, "wave_speed_bounds_tangent");
  check_caught(wrong_material<SlowBranches>, "wave_speed_bounds_tangent");
  check_caught(wrong_material<SpeedWithoutDensity>, "scales_with_density");
  check_caught(wrong_material<SquaredPascals>, "scales_with_moduli");
  check_caught(wrong_material<NotObjective>, "objective_stress");
  check_caught(wrong_material<CreatesHeat>, "no_dissipation");
  check_caught(wrong_material<HidesInversion>, "inadmissible_index");
}

}  // namespace
}  // namespace mpm
