// The suite must catch wrong plugins: each functor here has one planted mistake, and the check that names it must fail.

#include <set>

#include "contacts/coulomb/coulomb.hpp"
#include "materials/neo_hookean/neo_hookean.hpp"
#include "plugin/conformance.hpp"
#include "plugin/sdk.hpp"
#include "shapes/bspline_quadratic/bspline_quadratic.hpp"
#include "support/catch.hpp"
#include "transfers/apic/apic.hpp"
#include "transfers/flip/flip.hpp"

namespace mpm {  // so that functors find mpm::floor and its like, as those of the modules do
namespace {

/// Names of the failed checks, without precision and dimension.
std::set<std::string> failures(const mpm_descriptor& descriptor) {
  std::set<std::string> names;
  for (const ConformanceFinding& finding : check_plugin(Plugin{&descriptor, "test"}))
    if (!finding.passed) names.insert(finding.check.substr(0, finding.check.find(" [")));
  return names;
}

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

struct StressOffEnergy : NeoHookean {
  template <int D, class S>
  MPM_HD static Sym<D, S> kirchhoff_stress(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    Sym<D, S> tau = NeoHookean::kirchhoff_stress(c, state);
    for (S& component : tau.s) component = component * real<S>(1.001);
    return tau;
  }
};

struct SlowWave : NeoHookean {
  template <int D, class S>
  MPM_HD static S wave_speed(const Constants<scalar_of<S>>& c, const State<D, S>& state) {
    return real<S>(0.8) * NeoHookean::wave_speed(c, state);
  }
};

struct NotObjective : NeoHookean {  // right instead of left Cauchy-Green tensor
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

/// One descriptor a functor, alive for the whole test.
template <class F>
constexpr mpm_descriptor wrong_shape = sdk::shape<F>(manual, source);
template <class F>
constexpr mpm_descriptor wrong_transfer = sdk::transfer<F>(manual, source);
template <class F>
constexpr mpm_descriptor wrong_contact = sdk::contact<F>(manual, source);
template <class F>
constexpr mpm_descriptor wrong_material = sdk::material<F>(manual, source);

void check_caught(const mpm_descriptor& descriptor, const char* check) {
  const std::set<std::string> failed = failures(descriptor);
  CAPTURE(failed);
  CHECK(failed.count(check) == 1);
}

TEST_CASE("the plugins that the wrong ones are made from pass") {
  CHECK(failures(wrong_shape<BsplineQuadratic>).empty());
  CHECK(failures(wrong_transfer<Apic>).empty());
  CHECK(failures(wrong_transfer<Flip>).empty());
  CHECK(failures(wrong_contact<Coulomb>).empty());
  CHECK(failures(wrong_material<NeoHookean>).empty());
}

TEST_CASE("wrong shapes are caught") {
  check_caught(wrong_shape<WrongGradientSign>, "gradient_is_derivative");
  check_caught(wrong_shape<WrongGradientSign>, "affine_consistency");
  check_caught(wrong_shape<WrongPartition>, "partition_of_unity");
  check_caught(wrong_shape<WrongSecondMoment>, "second_moment_constant");
  check_caught(wrong_shape<WrongBase>, "linear_consistency");
}

TEST_CASE("wrong transfers are caught") {
  check_caught(wrong_transfer<LosesMomentum>, "scattered_momentum");
  check_caught(wrong_transfer<TransposesAffine>, "angular_momentum");
  check_caught(wrong_transfer<TransposesAffine>, "round_trip_velocity");
  check_caught(wrong_transfer<ForgetsVelocity>, "zero_increment_keeps_velocity");
}

TEST_CASE("wrong contact laws are caught") {
  check_caught(wrong_contact<GainsEnergy>, "energy_never_grows");
  check_caught(wrong_contact<OneSided>, "pair_symmetry");
  check_caught(wrong_contact<OneSided>, "no_approach_after");
  check_caught(wrong_contact<Pulls>, "no_pull");
}

TEST_CASE("wrong materials are caught") {
  check_caught(wrong_material<StressOffEnergy>, "stress_from_energy");
  check_caught(wrong_material<SlowWave>, "wave_speed_bounds_tangent");
  check_caught(wrong_material<NotObjective>, "objective_stress");
  check_caught(wrong_material<CreatesHeat>, "no_dissipation");
  check_caught(wrong_material<HidesInversion>, "inadmissible_index");
}

}  // namespace
}  // namespace mpm
