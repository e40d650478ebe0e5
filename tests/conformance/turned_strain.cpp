// A strained particle turned by 360 degrees in 7 steps; and what linear elasticity does instead.

#include <cmath>
#include <numbers>

#include "materials/anisotropic_damage/anisotropic_damage.hpp"
#include "materials/corotated/corotated.hpp"
#include "materials/damage/damage.hpp"
#include "materials/drucker_prager/drucker_prager.hpp"
#include "materials/fixed_corotated/fixed_corotated.hpp"
#include "materials/hencky/hencky.hpp"
#include "materials/linear_elastic/linear_elastic.hpp"
#include "materials/mooney_rivlin/mooney_rivlin.hpp"
#include "materials/neo_hookean/neo_hookean.hpp"
#include "materials/transversely_isotropic/transversely_isotropic.hpp"
#include "materials/von_mises/von_mises.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;
using Mat2 = Mat<2, double>;
using Sym2 = Sym<2, double>;

constexpr int turns = 7;

Mat2 rotation(double angle) {
  return {{std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)}};
}

/// The turned stress Q tau Q^T in the plane; zz stays.
Sym2 rotated(const Sym2& tau, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {{c * c * tau.s[0] - 2 * c * s * tau.s[3] + s * s * tau.s[1],
           s * s * tau.s[0] + 2 * c * s * tau.s[3] + c * c * tau.s[1], tau.s[2],
           c * s * (tau.s[0] - tau.s[1]) + (c * c - s * s) * tau.s[3]}};
}

double difference(const Sym2& a, const Sym2& b) {
  double worst = 0;
  for (int k = 0; k < 4; ++k) worst = larger(worst, std::abs(a.s[k] - b.s[k]));
  return worst;
}

/// Pre-strains, then turns in steps and compares with the turned stress.
template <class Material>
void check_rotation(const typename Material::template Constants<double>& constants,
                    typename Material::template State<2, double> state, double modulus) {
  Material::advance(constants, Mat2{{0.3, 0, 0, -0.2}}, 1.0, state);  // F = diag(1.3, 0.8)
  const Sym2 start = Material::kirchhoff_stress(constants, state);
  Mat2 turn = rotation(2 * std::numbers::pi / turns);
  for (int i = 0; i < 2; ++i) turn(i, i) -= 1;
  for (int k = 1; k <= turns; ++k) {
    Material::advance(constants, turn, 1.0, state);
    const Sym2 expected = rotated(start, 2 * std::numbers::pi * k / turns);
    CHECK(difference(Material::kirchhoff_stress(constants, state), expected) < 1e-12 * modulus);
  }
}

}  // namespace

TEST_CASE("stress turns with the particle") {
  for (double form : {0, 1})
    for (double volumetric : {0, 1, 2})
      check_rotation<NeoHookean>(NeoHookean::Constants<double>({1000, 0.3, 1000, form, volumetric}), {Mat2::identity()},
                                 1000);
  // The first case is elastic, the second yields before it turns.
  for (double yield : {1e4, 50.0})
    check_rotation<VonMises>(VonMises::Constants<double>({1000, 0.3, 1000, yield, 10, 2}), {Sym2::identity(), 1, 0},
                             1000);
}

TEST_CASE("linear elasticity makes the false stress 2 (lambda + mu) (cos theta - 1) when turned") {
  const LinearElastic::Constants<double> constants({1000, 0.3, 1000});
  for (double angle : {0.01, 0.5, 1.0, 2.0, std::numbers::pi}) {
    const Sym2 tau = LinearElastic::kirchhoff_stress(constants, LinearElastic::State<2, double>{rotation(angle)});
    const double expected = 2 * (constants.lambda + constants.mu) * (std::cos(angle) - 1);
    CHECK(tau(0, 0) == Approx(expected).epsilon(1e-12));
    CHECK(tau(1, 1) == Approx(expected).epsilon(1e-12));
    CHECK(std::abs(tau(0, 1)) < 1e-12);
    CHECK(tau.s[2] == Approx(2 * constants.lambda * (std::cos(angle) - 1)).epsilon(1e-12));
  }
}

TEST_CASE("laws whose stress turns with the particle say so, and linear elasticity does not") {
  CHECK((NeoHookean::traits & MPM_OBJECTIVE) != 0);
  CHECK((FixedCorotated::traits & MPM_OBJECTIVE) != 0);
  CHECK((VonMises::traits & MPM_OBJECTIVE) != 0);
  CHECK((DruckerPrager::traits & MPM_OBJECTIVE) != 0);
  CHECK((Damage::traits & MPM_OBJECTIVE) != 0);
  CHECK((AnisotropicDamage::traits & MPM_OBJECTIVE) != 0);
  CHECK((AnisotropicDamage::traits & MPM_HYPERELASTIC) != 0);
  CHECK((Hencky::traits & MPM_OBJECTIVE) != 0);
  CHECK((Corotated::traits & MPM_OBJECTIVE) != 0);
  CHECK((MooneyRivlin::traits & MPM_OBJECTIVE) != 0);
  CHECK((TransverselyIsotropic::traits & MPM_OBJECTIVE) != 0);
  CHECK((LinearElastic::traits & MPM_OBJECTIVE) == 0);
  // Those whose stress follows from a stored energy say that too.
  CHECK((NeoHookean::traits & MPM_HYPERELASTIC) != 0);
  CHECK((FixedCorotated::traits & MPM_HYPERELASTIC) != 0);
  CHECK((VonMises::traits & MPM_HYPERELASTIC) == 0);
  CHECK((DruckerPrager::traits & MPM_HYPERELASTIC) == 0);
}
