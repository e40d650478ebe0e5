// What materials, filters and others offer beyond their core tables is held to its words: right ones pass, and each
// planted mistake is caught by the check that names it.

#include <cmath>

#include "faults/failed_checks.hpp"
#include "filters/fmpm/fmpm.hpp"
#include "filters/xpic/xpic.hpp"
#include "materials/drucker_prager/drucker_prager.hpp"
#include "materials/snow/snow.hpp"
#include "plugin/extension_of.hpp"
#include "shapes/bspline_quadratic/bspline_quadratic.hpp"
#include "support/catch.hpp"
#include "support/fixture_materials.hpp"

namespace mpm {  // so that functors find mpm::floor and its like, as those of the modules do
namespace {

using test::BandHardening;
using test::check_caught;
using test::failures;
using test::findings;
using test::name_of;
using test::WarmRubber;

constexpr const char* source = "struct Fixture {};";
template <class F>
constexpr mpm_descriptor material_of = sdk::material<F>(test::fixture_manual, source);

bool was_checked(const mpm_descriptor& descriptor, const std::string& check) {
  for (const ConformanceFinding& finding : findings(descriptor))
    if (name_of(finding) == check) return true;
  return false;
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

#define ENTRIES(function)                                                   \
  {                                                                         \
    {&function<2, sdk::LanesFloat>, &function<3, sdk::LanesFloat>},         \
        {&function<2, sdk::LanesDouble>, &function<3, sdk::LanesDouble>}, { \
      &function<2, double>, &function<3, double>                            \
    }                                                                       \
  }

// ---- mistakes ----------------------------------------------------------------------------------------------------

template <int D, class S>
std::int32_t commits(const void* parameters, const mpm_trial_batch* batch) {
  mpm_trial_batch request = *batch;
  if (!request.trial_state) request.trial_state = const_cast<void* const*>(batch->state);
  return sdk::trial_batch<VonMises, D, S>(parameters, &request);
}
constexpr mpm_material_trial committing_trial{MPM_MATERIAL_TRIAL_VERSION, 0, ENTRIES(commits)};

template <int D, class S>
std::int32_t forgets_time(const void* parameters, const mpm_trial_batch* batch) {
  mpm_trial_batch request = *batch;
  request.dt *= 0.999;
  return sdk::trial_batch<VonMises, D, S>(parameters, &request);
}
constexpr mpm_material_trial slow_trial{MPM_MATERIAL_TRIAL_VERSION, 0, ENTRIES(forgets_time)};

/// A tangent that is elastic where the law flows.
template <int D, class S>
std::int32_t stays_elastic(const void* parameters, const mpm_tangent_batch* batch) {
  VonMises::Parameters strong = *static_cast<const VonMises::Parameters*>(parameters);
  strong.yield_stress *= 1e9;
  return sdk::tangent_batch<VonMises, D, S>(&strong, batch);
}
constexpr mpm_material_tangent elastic_tangent{MPM_MATERIAL_TANGENT_VERSION, 0, nullptr, ENTRIES(stays_elastic)};
constexpr mpm_material_tangent silent_tangent{MPM_MATERIAL_TANGENT_VERSION, 0, "", {}};

/// A tangent whose packs of float lose the direction's sign.
template <int D, class S>
std::int32_t turns_packs(const void* parameters, const mpm_tangent_batch* batch) {
  const std::int32_t index = sdk::tangent_batch<NeoHookean, D, S>(parameters, batch);
  using T = scalar_of<S>;
  if (sizeof(T) == 4)
    for (std::uint32_t lane = 0; lane < batch->count; ++lane) static_cast<T*>(batch->stress_change)[lane] *= T(-1);
  return index;
}
constexpr mpm_material_tangent turning_tangent{MPM_MATERIAL_TANGENT_VERSION, 0, nullptr, ENTRIES(turns_packs)};

/// A projection that adds a stretch along x to what the law returns to.
template <int D, class S>
std::int32_t stretches(const void* parameters, const mpm_projection_batch* batch) {
  const std::int32_t index = sdk::projection_batch<DruckerPrager, D, S>(parameters, batch);
  using T = scalar_of<S>;
  for (std::uint32_t lane = 0; lane < batch->count; ++lane) static_cast<T*>(batch->state[0])[lane] *= T(0.9);
  return index;
}
constexpr mpm_material_projection stretching_projection{MPM_MATERIAL_PROJECTION_VERSION, 0, ENTRIES(stretches)};
template <int D, class S>
std::int32_t does_nothing(const void*, const mpm_projection_batch*) {
  return -1;
}
constexpr mpm_material_projection idle_projection{MPM_MATERIAL_PROJECTION_VERSION, 0, ENTRIES(does_nothing)};

struct ColdRubber : WarmRubber {  // it takes a temperature and does not look at it
  template <class G, class S = typename G::Scalar>
  MPM_HD static S warmth(const WarmState<G>&) {
    return S(real<S>(0));
  }
  template <class G, class S = typename G::Scalar>
  MPM_HD static Sym<G::dimension, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const WarmState<G>& state) {
    return NeoHookean::kirchhoff_stress(c.solid, solid(state));
  }
};
constexpr mpm_material_temperature other_reference{MPM_MATERIAL_TEMPERATURE_VERSION, 0, 300};

struct IgnoresCells : BandHardening {
  template <class T>
  struct Constants : VonMises::Constants<T> {
    MPM_HD explicit Constants(const Parameters& p)
        : VonMises::Constants<T>(
              VonMises::Parameters{p.youngs_modulus, p.poisson_ratio, p.density, p.yield_stress, 0, 2}) {}
  };
};
constexpr mpm_material_cell_size shared_place{MPM_MATERIAL_CELL_SIZE_VERSION, 0};

/// Hardening by cells that refuses those above a size, as laws that soften do; and mistakes of it.
struct NarrowBand : BandHardening {
  static double largest(const Parameters& p) { return 0.01 * p.yield_stress / p.stiffness; }
  static mpm_refusal refusal(const Parameters& p, const mpm_refusal_case&) {
    if (p.cell_size <= largest(p)) return {nullptr, nullptr, 0};
    return {"cell_size", "cells are too large for the band; take smaller ones", largest(p)};
  }
};
template <class Change>
struct WronglyRefused : NarrowBand {
  static mpm_refusal refusal(const Parameters& p, const mpm_refusal_case& of) {
    mpm_refusal refused = NarrowBand::refusal(p, of);
    if (refused.parameter) Change::apply(refused);
    return refused;
  }
};
struct ShortLimit {
  static void apply(mpm_refusal& refused) { refused.limit *= 0.999; }
};
struct LongLimit {
  static void apply(mpm_refusal& refused) { refused.limit *= 1.001; }
};
struct OtherName {
  static void apply(mpm_refusal& refused) { refused.parameter = "cell_width"; }
};
struct NoReason {
  static void apply(mpm_refusal& refused) { refused.why = ""; }
};
struct NoWayOut {
  static void apply(mpm_refusal& refused) { refused.limit = std::nan(""); }
};
constexpr mpm_refusals never{MPM_REFUSAL_VERSION, 0, [](const void*, const mpm_refusal_case*, mpm_refusal* refusal) {
                               *refusal = {nullptr, nullptr, 0};
                             }};

/// Sand that books its heat with the wrong sign; and one that excuses itself for it.
struct CoolingSand : DruckerPrager {
  template <class G, int D, class S>
  MPM_HD static S advance(const Constants<scalar_of<S>>& c, const G& L, scalar_of<S> dt, State<D, S>& state) {
    return -DruckerPrager::advance(c, L, dt, state);
  }
};
struct ExcusedSand : CoolingSand {
  static constexpr const char* makes_energy = "wherever it yields";
};
constexpr mpm_material_makes_energy nowhere{MPM_MATERIAL_MAKES_ENERGY_VERSION, 0, ""};

constexpr mpm_material_dissipation by_magic{MPM_MATERIAL_DISSIPATION_VERSION, MPM_DAMAGE + 1},
    by_yield{MPM_MATERIAL_DISSIPATION_VERSION, MPM_PLASTIC_WORK};

/// Snow whose clamps have no name, or act where they were said not to.
constexpr mpm_clamp nameless[] = {{"below J =", "", ""}};
void no_bounds(const void*, double* bound) {
  bound[0] = std::nan("");
}
void finds(const mpm_clamp_batch* q, std::uint32_t bits) {
  for (std::uint32_t k = 0; k < q->count; ++k) q->acting[k] = bits;
}
void finds_none(const void*, const mpm_clamp_batch* q) {
  finds(q, 0);
}
void finds_first(const void*, const mpm_clamp_batch* q) {
  finds(q, 1);
}
void finds_stranger(const void*, const mpm_clamp_batch* q) {
  finds(q, 2);
}
void finds_and_moves(const void*, const mpm_clamp_batch* q) {
  finds(q, 0);
  *static_cast<double*>(const_cast<void*>(q->state[0])) += 1e-3;
}
constexpr mpm_clamp named[] = {{"below J =", "", "nothing goes on"}};
constexpr mpm_material_clamps nameless_clamps{
    MPM_MATERIAL_CLAMPS_VERSION, 1, nameless, &no_bounds, {&finds_none, &finds_none}};
constexpr mpm_material_clamps impossible_clamps{
    MPM_MATERIAL_CLAMPS_VERSION, 1, named, &no_bounds, {&finds_first, &finds_first}};
constexpr mpm_material_clamps strange_clamps{
    MPM_MATERIAL_CLAMPS_VERSION, 1, named, &no_bounds, {&finds_stranger, &finds_stranger}};
constexpr mpm_material_clamps moving_clamps{
    MPM_MATERIAL_CLAMPS_VERSION, 1, named, &no_bounds, {&finds_and_moves, &finds_and_moves}};

struct RefusesTangent : NeoHookean {
  static constexpr const char* no_tangent = "its stress is looked up in a table";
};

void counts_nothing(const void*, const mpm_cost_case*, mpm_cost* cost) {
  *cost = {0, 0};
}
constexpr mpm_costs no_costs{MPM_COSTS_VERSION, 0, &counts_nothing};
void counts_backwards(const void*, const mpm_cost_case* of, mpm_cost* cost) {
  *cost = {of->dimension == 2 ? 9.0 : 4.0, 0};
}
constexpr mpm_costs backward_costs{MPM_COSTS_VERSION, 0, &counts_backwards};
void counts_lists(const void*, const mpm_cost_case*, mpm_cost* cost) {
  *cost = {5, 3};
}
constexpr mpm_costs list_costs{MPM_COSTS_VERSION, 0, &counts_lists};

struct LongStep : Fmpm {  // its step limit is as if the order took nothing
  static double step_limit(const Parameters&, double unfiltered) { return unfiltered; }
};
struct FixedStep : Fmpm {
  static double step_limit(const Parameters&, double) { return 1e-3; }
};
struct LongerStep : Fmpm {
  static double step_limit(const Parameters&, double unfiltered) { return 2 * unfiltered; }
};
struct BoldShape : BsplineQuadratic {  // no explicit step stands what it promises
  static constexpr double courant_limits[2][3] = {{0.9, 0.58, 2.5}, {0.6, 0.3, 1}};
};
struct StuckShape : BsplineQuadratic {
  static constexpr double courant_limits[2][3] = {{0.9, 0.58, 1.4}, {0.6, 0, 1}};
};
template <class F>
constexpr mpm_descriptor shape_of = sdk::shape<F>(test::fixture_manual, source);
template <class F>
constexpr mpm_descriptor filter_of = sdk::filter<F>(test::fixture_manual, source);

}  // namespace

TEST_CASE("materials with temperature and with cell size conform") {
  for (const ConformanceFinding& finding : findings(material_of<WarmRubber>)) {
    INFO(to_string(finding));
    CHECK(finding.passed);
  }
  for (const ConformanceFinding& finding : findings(material_of<BandHardening>)) {
    INFO(to_string(finding));
    CHECK(finding.passed);
  }
  CHECK(was_checked(material_of<WarmRubber>, "temperature_matters"));
  CHECK(was_checked(material_of<WarmRubber>, "tangent_around_axis"));
  CHECK(was_checked(material_of<BandHardening>, "cell_size_matters"));
  CHECK(was_checked(material_of<BandHardening>, "projection_once"));
  CHECK_FALSE(was_checked(material_of<WarmRubber>, "projection_once"));
  CHECK_FALSE(was_checked(material_of<WarmRubber>, "cell_size_matters"));
}

TEST_CASE("a trial that commits the state or is another update is caught") {
  check_caught(with_extension<committing_trial>(material_of<VonMises>), "trial_keeps_state");
  check_caught(with_extension<slow_trial>(material_of<VonMises>), "trial_equals_update");
}

TEST_CASE("a wrong tangent is caught, and none at all needs a reason") {
  check_caught(with_extension<elastic_tangent>(material_of<VonMises>), "tangent_is_derivative");
  check_caught(with_extension<elastic_tangent>(material_of<VonMises>), "tangent_around_axis");
  check_caught(with_extension<turning_tangent>(material_of<NeoHookean>), "tangent_agrees_with_scalar");
  check_caught(with_extension<silent_tangent>(material_of<VonMises>), "tangent_or_reason");
  CHECK(failures(material_of<RefusesTangent>).empty());
  CHECK_FALSE(was_checked(material_of<RefusesTangent>, "tangent_is_derivative"));
}

TEST_CASE("a wrong projection is caught") {
  const std::set<std::string> failed = failures(with_extension<stretching_projection>(material_of<DruckerPrager>));
  CAPTURE(failed);
  CHECK(failed.count("projection_keeps_admissible") == 1);
  CHECK(failed.count("projection_once") == 1);
  CHECK(failed.count("projection_objective") == 1);
  CHECK(failed.count("projection_lowers_energy") == 1);
  check_caught(with_extension<idle_projection>(material_of<DruckerPrager>), "projection_is_admissible");
}

TEST_CASE("negative heat is caught, and a material that says that it makes energy still answers for its balance") {
  CHECK(was_checked(material_of<DruckerPrager>, "dissipation_not_negative"));
  check_caught(material_of<CoolingSand>, "dissipation_not_negative");
  CHECK_FALSE(was_checked(material_of<ExcusedSand>, "dissipation_not_negative"));
  CHECK(was_checked(material_of<ExcusedSand>, "negative_dissipation"));
  check_caught(material_of<ExcusedSand>, "energy_balance");
  check_caught(with_extension<nowhere>(material_of<VonMises>), "makes_energy_says_where");
  check_caught(with_extension<nowhere>(material_of<NeoHookean>), "makes_energy_dissipates");
}

TEST_CASE("a cause of dissipation that the ledger does not have, or of a law that dissipates nothing, is caught") {
  CHECK(was_checked(material_of<VonMises>, "dissipation_cause_known"));
  CHECK_FALSE(was_checked(material_of<NeoHookean>, "dissipation_cause_known"));
  check_caught(with_extension<by_magic>(material_of<VonMises>), "dissipation_cause_known");
  check_caught(with_extension<by_yield>(material_of<NeoHookean>), "dissipation_cause_dissipates");
}

TEST_CASE("clamps without a name, or that act where they cannot, are caught") {
  CHECK(was_checked(material_of<Snow>, "clamps_can_act"));
  CHECK_FALSE(was_checked(material_of<NeoHookean>, "clamps_can_act"));
  check_caught(with_extension<nameless_clamps>(material_of<VonMises>), "clamps_are_named");
  check_caught(with_extension<impossible_clamps>(material_of<VonMises>), "clamps_can_act");
  check_caught(with_extension<strange_clamps>(material_of<VonMises>), "clamps_can_act");
  check_caught(with_extension<moving_clamps>(material_of<VonMises>), "clamps_keep_state");
}

TEST_CASE("temperatures and cell sizes that do nothing are caught") {
  check_caught(material_of<ColdRubber>, "temperature_matters");
  check_caught(with_extension<other_reference>(material_of<WarmRubber>), "absent_temperature_is_reference");
  check_caught(material_of<IgnoresCells>, "cell_size_matters");
  check_caught(with_extension<shared_place>(material_of<BandHardening>), "cell_size_has_own_place");
}

TEST_CASE("parameters that are refused are held to the name, the reason and the limit that the plugin gives") {
  CHECK(failures(material_of<NarrowBand>).empty());
  CHECK(was_checked(material_of<NarrowBand>, "refusal_limit"));
  CHECK(was_checked(material_of<NarrowBand>, "cell_size_matters"));
  CHECK_FALSE(was_checked(material_of<BandHardening>, "refusal_limit"));
  check_caught(material_of<WronglyRefused<ShortLimit>>, "refusal_limit");
  check_caught(material_of<WronglyRefused<LongLimit>>, "refusal_limit");
  check_caught(material_of<WronglyRefused<OtherName>>, "refusal_names_parameter");
  check_caught(material_of<WronglyRefused<NoReason>>, "refusal_says_why");
  check_caught(material_of<WronglyRefused<NoWayOut>>, "refusal_leaves_values");
  check_caught(with_extension<never>(material_of<VonMises>), "refusal_refuses");
}

TEST_CASE("wrong operation counts are caught") {
  check_caught(with_extension<no_costs>(material_of<NeoHookean>), "costs_positive");
  check_caught(with_extension<backward_costs>(material_of<NeoHookean>), "costs_ordered");
  check_caught(with_extension<list_costs>(material_of<NeoHookean>), "costs_nodes");
}

TEST_CASE("a filter's limit of the step covers what it amplifies") {
  CHECK(failures(filter_of<Fmpm>).empty());
  CHECK(failures(filter_of<Xpic>).empty());
  check_caught(filter_of<LongStep>, "step_limit_covers_gain");
  check_caught(filter_of<FixedStep>, "step_limit_proportional");
  check_caught(filter_of<LongerStep>, "step_limit_shortens");
  mpm_descriptor without = filter_of<Fmpm>;
  without.extension = nullptr;
  check_caught(without, "step_limit_covers_gain");
}

TEST_CASE("a shape's limit of the step is a number that an explicit step can stand") {
  CHECK(failures(shape_of<BsplineQuadratic>).empty());
  CHECK(was_checked(shape_of<BsplineQuadratic>, "courant_limit_below_leapfrog"));
  check_caught(shape_of<BoldShape>, "courant_limit_below_leapfrog");
  check_caught(shape_of<StuckShape>, "courant_limit_positive");
  mpm_descriptor without = shape_of<BsplineQuadratic>;
  without.extension = nullptr;
  CHECK(failures(without).empty());
}

TEST_CASE("the tangent of a tension test is Young's modulus where it is small, and less where metal flows") {
  // The first particle is confined at its sides: dtau_xx / deps_xx = lambda + 2 mu at rest. Beyond yield, without
  // hardening, a shear adds no stress: dtau_xy / dgamma falls to zero as the shear grows.
  const VonMises::Parameters metal{200e9, 0.3, 7800, 250e6, 0, 0};
  const double lambda = lame_lambda(200e9, 0.3), mu = shear_modulus(200e9, 0.3);
  alignas(64) double state[4 + 2][MPM_LANES]{}, gradient[4][MPM_LANES]{}, direction[4][MPM_LANES]{};
  alignas(64) double change[4][MPM_LANES];
  for (std::uint32_t lane = 0; lane < MPM_LANES; ++lane)
    state[0][lane] = state[1][lane] = state[2][lane] = state[4][lane] = 1;
  const void* const fields[] = {state[0], state[4], state[5]};
  mpm_tangent_batch request{};
  request.count = request.stride = MPM_LANES, request.dimension = 2, request.dt = 1;
  request.velocity_gradient = gradient, request.direction = direction;
  request.state = fields, request.stress_change = change;
  const Plugin plugin{&material_of<VonMises>, "test"};
  const auto* tangent = extension_of<mpm_material_tangent>(plugin);
  REQUIRE(tangent);
  for (double& entry : direction[0]) entry = 1;
  CHECK(tangent->evaluate[MPM_SCALAR_DOUBLE][0](&metal, &request) == -1);
  CHECK(change[0][0] == Approx(lambda + 2 * mu).epsilon(1e-12));
  CHECK(change[1][0] == Approx(lambda).epsilon(1e-12));
  for (int lane = 0; lane < 2; ++lane) {  // shears of 0.1 % (elastic) and 2 %
    direction[0][lane] = 0, direction[1][lane] = 1;
    gradient[1][lane] = lane == 0 ? 1e-3 : 2e-2;
  }
  tangent->evaluate[MPM_SCALAR_DOUBLE][0](&metal, &request);
  CHECK(change[3][0] == Approx(mu).epsilon(1e-5));
  CHECK(std::abs(change[3][1]) < 1e-3 * mu);
}

}  // namespace mpm
