// A solid that cracks on one plane, under imposed deformation, in closed form: the softening of opening and of sliding, each
// with the area of its energy over the band width (Bazant & Oh, Mater. Struct. 16 (1983) 155), what stays whole, and how the
// plane is found and turns.

#include <cmath>

#include "kernel/polar.hpp"
#include "materials/anisotropic_damage/anisotropic_damage.hpp"
#include "materials/damage/damage.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;
using Mat3 = Mat<3, double>;
using Law = AnisotropicDamage;

constexpr double linear = 0, exponential = 1, bilinear = 2;
/// Concrete: E = 30 GPa, ft = 3 MPa, Gc = 100 J/m^2, and along cracks 2 MPa and 60 J/m^2: usable on bands below 0.375 m.
constexpr double young = 30e9, poisson = 0.2, strength = 3e6, toughness = 100, shear_strength = 2e6,
                 shear_toughness = 60, onset = strength / young, width = 0.05;
constexpr double mu = young / (2 * (1 + poisson)), lambda = 2 * mu * poisson / (1 - 2 * poisson);
constexpr double modulus = lambda + 2 * mu;

Law::Parameters concrete(double size = width, double softening = linear, double shear_softening = linear) {
  return {young,           poisson,         2400, strength, toughness, softening, shear_strength,
          shear_toughness, shear_softening, 1,    size};
}
/// A soft solid whose strains are not small: bands of 0.1 m end at an opening of 0.4 and a slip of 0.6.
Law::Parameters soft() {
  return {1000, 0.3, 1000, 50, 1, linear, 40, 1.2, linear, 1, 0.1};
}

Mat3 transposed(const Mat3& a) {
  Mat3 r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r(i, j) = a(j, i);
  return r;
}
/// A turn about the axis that the two given ones do not hold.
Mat3 turn(double angle, int first = 0, int second = 1) {
  Mat3 r = Mat3::identity();
  r(first, first) = r(second, second) = std::cos(angle);
  r(second, first) = std::sin(angle), r(first, second) = -std::sin(angle);
  return r;
}
Mat3 diagonal(double x, double y, double z) {
  return {{x, 0, 0, 0, y, 0, 0, 0, z}};
}
Mat3 exponential_of(Mat3 E) {
  for (double& entry : E.m) entry /= 64;
  Mat3 sum = Mat3::identity(), term = sum;
  for (int k = 1; k < 14; ++k) {
    term = term * E;
    for (double& entry : term.m) entry /= k;
    for (int i = 0; i < 9; ++i) sum.m[i] += term.m[i];
  }
  for (int k = 0; k < 6; ++k) sum = sum * sum;
  return sum;
}
Mat3 inverse(const Mat3& a) {
  Mat3 r = transposed(polar::cofactor(a));
  for (double& entry : r.m) entry /= determinant(a);
  return r;
}

/// A particle whose logarithmic strain is imposed, turned by a rotation afterwards.
template <class T = double>
struct Particle {
  Law::Constants<T> constants;
  typename Law::State<3, T> state{Mat<3, T>::identity(), {}, 0, 0, 0, 0};
  Mat3 strain{}, F = Mat3::identity();
  double heat = 0;  ///< dissipated so far, J/m^3

  explicit Particle(const Law::Parameters& p) : constants(p) {}

  void deform_to(const Mat3& next) {
    const Mat3 ratio = next * inverse(F);
    Mat<3, T> L;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) L(i, j) = static_cast<T>(ratio(i, j) - (i == j ? 1 : 0));
    heat += Law::advance(constants, L, T(1), state);
    F = next;
  }
  void strain_to(const Mat3& next, int steps = 16, const Mat3& rotation = Mat3::identity()) {
    const Mat3 first = strain;
    for (int k = 1; k <= steps; ++k) {
      for (int i = 0; i < 9; ++i) strain.m[i] = first.m[i] + (next.m[i] - first.m[i]) * k / steps;
      deform_to(rotation * exponential_of(strain));
    }
  }
  /// Uniaxial tension: the strain along x is `along`, and the sides are free of stress where that along x is `sigma`.
  void pull_to(double along, double sigma, int steps = 16) {
    const double side = -poisson * sigma / young;
    strain_to(diagonal(along, side, side), steps);
  }
  Sym<3, T> stress() const { return Law::kirchhoff_stress(constants, state); }
  double energy() const { return Law::stored_energy(constants, state); }
};

/// Cracked by uniaxial strain along x, which hardly opens, so that it has lost next to nothing.
Particle<> barely_cracked(const Law::Parameters& p) {
  Particle<> particle(p);
  const double first = particle.constants.opening.first_measure() * (1 + 1e-9);
  particle.strain_to(diagonal(first, 0, 0), 1);
  REQUIRE(particle.state.opening_strain > 0);
  return particle;
}

/// Pulls to a strain in one step and in many: stress sigma along x, none at the sides, and the energy of a straight way back.
void check_curve(const Law::Parameters& p, double along, double sigma) {
  for (const int steps : {1, 200}) {
    Particle<> particle(p);
    particle.pull_to(along, sigma, steps);
    CAPTURE(along, steps, sigma, p.softening);
    const Sym<3, double> tau = particle.stress();
    CHECK(tau(0, 0) == Approx(sigma).epsilon(1e-9).margin(1e-9 * strength));
    for (int k = 1; k < 6; ++k) CHECK(std::abs(tau.s[k]) < 1e-9 * strength);
    CHECK(particle.energy() == Approx(sigma * along / 2).epsilon(1e-9).margin(1e-12 * strength));
  }
}

/// The stress of a body that is not turned, from the derivative of its energy by the strain of the plane of x and y: in the
/// frame of the principal strains, which differ by z, the shear stress is z/sinh(z) times that.
Sym<3, double> carried_over(const Mat3& E, double xx, double yy, double xy) {
  const double angle = 0.5 * std::atan2(2 * E(0, 1), E(0, 0) - E(1, 1));
  const double z = std::hypot(2 * E(0, 1), E(0, 0) - E(1, 1));
  const Mat3 R = turn(angle), T{{xx, xy, 0, xy, yy, 0, 0, 0, 0}};
  Mat3 principal = transposed(R) * T * R;
  principal(0, 1) = principal(1, 0) = principal(0, 1) * z / std::sinh(z);
  const Mat3 back = R * principal * transposed(R);
  Sym<3, double> tau{};
  tau(0, 0) = back(0, 0), tau(1, 1) = back(1, 1), tau(0, 1) = back(0, 1);
  return tau;
}

}  // namespace

TEST_CASE("anisotropic damage: uniaxial tension follows the softening law, whatever the steps, and dissipates Gc") {
  for (const double size : {0.01, 0.02, 0.05}) {
    const double opening = toughness / (strength * size);
    for (const double share : {0.1, 0.5, 0.9})
      check_curve(concrete(size), onset + share * (2 * opening - onset), (1 - share) * strength);
    check_curve(concrete(size), 0.5 * onset, 0.5 * strength);
    check_curve(concrete(size), 2 * opening * (1 + 1e-7), 0);
    for (const double lengths : {0.2, 1.0, 3.0})
      check_curve(concrete(size, exponential), onset + lengths * (opening - onset / 2), strength * std::exp(-lengths));
    check_curve(concrete(size, bilinear), onset / 3 + 0.8 * opening, strength / 3);
    check_curve(concrete(size, bilinear), (onset / 3 + 0.8 * opening + 3.6 * opening) / 2, strength / 6);
    const double ends[] = {3 * opening, onset + 40 * (opening - onset / 2), 4 * opening};
    for (const double law : {linear, exponential, bilinear})
      for (const int steps : {1, 3, 1000}) {
        Particle<> particle(concrete(size, law));
        particle.pull_to(ends[static_cast<int>(law)], 0, steps);
        CAPTURE(size, law, steps);
        CHECK(particle.heat * size == Approx(toughness).epsilon(1e-9));
        CHECK(particle.state.damage == Approx(1).epsilon(1e-9));
        CHECK(particle.energy() < 1e-9 * strength);
      }
  }
}

TEST_CASE("anisotropic damage: a body that has parted along x bears all of a pull along y, where damage bears none") {
  Particle<> split(concrete());
  split.pull_to(2e-3, 0);
  CHECK(split.state.damage == 1);
  CHECK(std::abs(split.stress()(0, 0)) < 1e-9 * strength);
  // Ten times the strength along y, with free sides: Young's modulus; and held along z, that of a plate.
  const double along = 10 * onset;
  split.strain_to(diagonal(2e-3, along, -poisson * along), 16);
  CHECK(split.stress()(1, 1) == Approx(young * along).epsilon(1e-9));
  CHECK(std::abs(split.stress()(0, 0)) < 1e-9 * strength);
  CHECK(std::abs(split.stress()(2, 2)) < 1e-9 * strength);
  CHECK(split.energy() == Approx(young * along * along / 2).epsilon(1e-9));
  CHECK(split.heat * width == Approx(toughness).epsilon(1e-9));  // a second crack does not begin
  split.strain_to(diagonal(2e-3, along, 0), 16);
  CHECK(split.stress()(1, 1) == Approx(young / (1 - poisson * poisson) * along).epsilon(1e-9));
  CHECK(split.stress()(2, 2) == Approx(poisson * young / (1 - poisson * poisson) * along).epsilon(1e-9));
  // Sheared within its plane it is whole as well.
  Mat3 sheared = diagonal(2e-3, 0, 0);
  sheared(1, 2) = sheared(2, 1) = 1e-3;
  split.strain_to(sheared, 16);
  CHECK(split.stress()(1, 2) == Approx(2 * mu * 1e-3).epsilon(1e-6));
  // The isotropic law has lost all of this.
  const Damage::Constants<double> constants(
      {young, poisson, 2400, strength, toughness, linear, 1, 0, 0, 0, 0, 0, 0, 0, 0, width});
  Damage::State<3, double> state{Mat3::identity(), 0, 0};
  Mat3 L = diagonal(std::exp(2e-3) - 1, 0, 0);
  Damage::advance(constants, L, 1.0, state);
  L = diagonal(0, std::exp(along) - 1, std::exp(-poisson * along) - 1);
  Damage::advance(constants, L, 1.0, state);
  CHECK(state.damage == 1);
  CHECK(std::abs(Damage::kirchhoff_stress(constants, state)(1, 1)) < 1e-9 * strength);
}

TEST_CASE("anisotropic damage: half open it pulls with what is left, and unloads to the origin without heat") {
  const double opening = toughness / (strength * width), kappa = onset + 0.5 * (2 * opening - onset);
  Particle<> particle(concrete());
  particle.pull_to(kappa, strength / 2);
  // What is left of x's share of the confined modulus: (1 - d)/(1 - k d) = sigma/(E kappa), k = 1 - E/M.
  const double left = strength / 2 / (young * kappa), k = 1 - young / modulus;
  CHECK(particle.state.damage == Approx((1 - left) / (1 - k * left)).epsilon(1e-9));
  const double heat = particle.heat;
  CHECK(heat == Approx(toughness / width - strength / 2 * 2 * opening / 2).epsilon(1e-9));
  for (const double share : {0.5, 0.0, 0.7, 1.0}) {
    particle.pull_to(share * kappa, share * strength / 2);
    CHECK(particle.stress()(0, 0) == Approx(share * strength / 2).epsilon(1e-9).margin(1e-9 * strength));
    CHECK(particle.heat == Approx(heat).epsilon(1e-9));
  }
  // Held at the sides: (1 - d) M along the crack's normal, and at the sides nu/(1 - nu) of that.
  particle.strain_to(diagonal(0.9 * kappa * (1 - k), 0, 0));
  const double held = (1 - particle.state.damage) * modulus * 0.9 * kappa * (1 - k);
  CHECK(particle.stress()(0, 0) == Approx(held).epsilon(1e-9));
  CHECK(particle.stress()(1, 1) == Approx(held * poisson / (1 - poisson)).epsilon(1e-9));
  CHECK(particle.stress()(2, 2) == Approx(held * poisson / (1 - poisson)).epsilon(1e-9));
}

TEST_CASE("anisotropic damage: a closed crack presses as if it were whole") {
  const double bulk = young / (3 * (1 - 2 * poisson));
  Particle<> split(concrete());
  split.pull_to(2e-3, 0);
  split.strain_to(diagonal(-1e-3, -1e-3, -1e-3));
  for (int i = 0; i < 3; ++i) CHECK(split.stress().s[i] == Approx(-3e-3 * bulk).epsilon(1e-9));
  CHECK(split.energy() == Approx(bulk / 2 * 9e-6).epsilon(1e-9));
  split.pull_to(-1e-3, -1e-3 * young);
  CHECK(split.stress()(0, 0) == Approx(-1e-3 * young).epsilon(1e-9));
  CHECK(std::abs(split.stress()(1, 1)) < 1e-9 * strength);
  CHECK(split.heat * width == Approx(toughness).epsilon(1e-9));
  // Along the plane it bears no shear once it has parted, closed or open.
  Mat3 slid = diagonal(-1e-3, 0, 0);
  slid(0, 1) = slid(1, 0) = 2e-3;
  split.strain_to(slid);
  CHECK(std::abs(split.stress()(0, 1)) < 1e-2 * 2 * mu * 2e-3);
  CHECK(split.energy() == Approx(modulus / 2 * 1e-6).epsilon(1e-9));
  CHECK(split.heat * width == Approx(toughness).epsilon(1e-9));
}

TEST_CASE("anisotropic damage: a plane that slides softens by its own law and dissipates Gs, whatever the steps") {
  const double slip = shear_toughness / (shear_strength * width), first = shear_strength / mu;
  const struct {
    double law, strain, stress;
  } points[] = {{linear, 0.5 * first, 0.5 * shear_strength},
                {linear, first + 0.25 * (2 * slip - first), 0.75 * shear_strength},
                {linear, first + 0.8 * (2 * slip - first), 0.2 * shear_strength},
                {exponential, first + 2 * (slip - first / 2), std::exp(-2) * shear_strength},
                {bilinear, first / 3 + 0.8 * slip, shear_strength / 3},
                {bilinear, 3.6 * slip * 1.01, 0}};
  for (const auto& point : points)
    for (const int steps : {1, 100}) {
      CAPTURE(point.law, point.strain, steps);
      Particle<> particle = barely_cracked(concrete(width, linear, point.law));
      const double pressed = -2e-3;
      particle.strain_to(diagonal(pressed, 0, 0), 1);
      // In the plane of x and y, and of x and z, at a slant: the shear strain along the plane is `strain`.
      Mat3 E = diagonal(pressed, 0, 0);
      E(0, 1) = E(1, 0) = 0.6 * point.strain / 2, E(0, 2) = E(2, 0) = 0.8 * point.strain / 2;
      particle.strain_to(E, steps);
      const Sym<3, double> tau = particle.stress();
      // What is of second order in the strain is left out.
      CHECK(tau(0, 1) == Approx(0.6 * point.stress).epsilon(1e-4).margin(1e-4 * shear_strength));
      CHECK(tau(0, 2) == Approx(0.8 * point.stress).epsilon(1e-4).margin(1e-4 * shear_strength));
      CHECK(tau(0, 0) == Approx(modulus * pressed).epsilon(2e-3));
      CHECK(particle.energy() ==
            Approx(modulus / 2 * pressed * pressed + point.stress * point.strain / 2).epsilon(1e-7));
    }
  for (const double law : {linear, exponential, bilinear})
    for (const int steps : {1, 7, 500}) {
      Particle<> particle = barely_cracked(concrete(width, exponential, law));
      particle.strain_to(diagonal(-1e-3, 0, 0), 1);
      Mat3 E = diagonal(-1e-3, 0, 0);
      E(0, 1) = E(1, 0) = 20 * slip;
      particle.strain_to(E, steps);
      CAPTURE(law, steps);
      CHECK(particle.heat * width == Approx(shear_toughness).epsilon(1e-6));
      CHECK(particle.state.shear_damage == Approx(1).epsilon(1e-6));
      // What has slid apart bears no tension.
      particle.strain_to(diagonal(onset / 2, 0, 0), 1);
      CHECK(std::abs(particle.stress()(0, 0)) < 1e-6 * strength);
    }
}

TEST_CASE("anisotropic damage: at large strains shear is carried over by z/sinh z of the principal strains") {
  // nu = 0.3 and E = 1000: M = 1346, mu = 385, and the slip of linear softening ends at 2 Gs/(ts b) = 0.6.
  const double shear = 1000 / 2.6, confined = 1000 * 0.7 / (1.3 * 0.4);
  for (const double strain : {0.05, 0.2, 0.45}) {
    Particle<> particle = barely_cracked(soft());
    particle.strain_to(diagonal(-0.3, 0.1, 0), 1);
    Mat3 E = diagonal(-0.3, 0.1, 0);
    E(0, 1) = E(1, 0) = strain / 2;
    particle.strain_to(E, 50);
    const double first = 40 / shear, traction = strain < first ? shear * strain : 40 * (0.6 - strain) / (0.6 - first);
    const double side = confined * 0.3 / 0.7;  // lambda
    const Sym<3, double> tau = particle.stress(), expected = carried_over(E, confined * -0.3 + side * 0.1,
                                                                          confined * 0.1 - side * 0.3, traction);
    CAPTURE(strain);
    for (const int k : {0, 1, 5}) CHECK(tau.s[k] == Approx(expected.s[k]).epsilon(1e-6));
    CHECK(tau(2, 2) == Approx(side * -0.2).epsilon(1e-9));
  }
}

TEST_CASE("anisotropic damage: what one law has lost of its strength the other has lost as well") {
  const double opening = toughness / (strength * width), kappa = onset + 0.5 * (2 * opening - onset);
  const double slip = shear_toughness / (shear_strength * width), first = shear_strength / mu;
  Particle<> half_open(concrete());
  half_open.pull_to(kappa, strength / 2);
  const double heat = half_open.heat, area = toughness / width;
  CHECK(heat == Approx(area - strength / 2 * 2 * opening / 2).epsilon(1e-9));
  // Closed and slid to where half of the shear strength is left, a quarter of it is.
  Mat3 slid = diagonal(-1e-3, 0, 0);
  half_open.strain_to(slid);
  const double strain = first + 0.5 * (2 * slip - first);
  slid(0, 1) = slid(1, 0) = strain / 2;
  half_open.strain_to(slid, 16);
  CHECK(half_open.energy() == Approx(modulus / 2 * 1e-6 + shear_strength / 4 * strain / 2).epsilon(1e-9));
  CHECK(half_open.heat - heat == Approx(0.5 * (shear_toughness / width - shear_strength / 2 * slip)).epsilon(1e-9));
  // Opened as before, it pulls half of what it did; what sliding took there was not stored, as it was closed.
  half_open.pull_to(kappa, strength / 2);
  const double left = 0.5 * (1 - half_open.constants.opening.damage(kappa)), k = 1 - young / modulus;
  CHECK(half_open.stress()(0, 0) == Approx(left * modulus * (kappa - k * strength / 2 / young)).epsilon(1e-9));
  CHECK(1 - half_open.state.damage == Approx(left).epsilon(1e-9));
  // Closed and slid all the way: half of Gs in all, and neither tension nor shear is left.
  half_open.strain_to(diagonal(-1e-3, 0, 0));
  slid(0, 1) = slid(1, 0) = 2 * slip;
  half_open.strain_to(slid);
  CHECK(half_open.heat - heat == Approx(0.5 * shear_toughness / width).epsilon(1e-9));
  CHECK(half_open.state.damage == 1);
  half_open.pull_to(kappa, 0);
  CHECK(std::abs(half_open.stress()(0, 0)) < 1e-9 * strength);

  // A plane that slides apart while it is pulled sets free the energy of the pull, ft^2/(2 M), whatever the steps; beside it the
  // sides keep none, as they do not strain.
  for (const int steps : {1, 50}) {
    Particle<> pulled = barely_cracked(concrete());
    Mat3 E = pulled.strain;
    E(0, 1) = E(1, 0) = 2 * slip;
    pulled.strain_to(E, steps);
    CAPTURE(steps);
    CHECK(pulled.heat == Approx(shear_toughness / width + strength * strength / (2 * modulus)).epsilon(1e-7));
    CHECK(pulled.energy() < 1e-9 * strength * onset);
  }

  // A plane that parts while it is sheared sets free the shear energy that it still stored, mu g^2/2.
  const double g = 0.5 * first;
  for (const int steps : {4000, 8000}) {
    Particle<> sheared = barely_cracked(concrete());
    Mat3 E = diagonal(-1e-5, 0, 0);
    E(0, 1) = E(1, 0) = g / 2;
    sheared.strain_to(E, 1);
    E(0, 0) = 1e-2;
    sheared.strain_to(E, steps);
    CAPTURE(steps);
    CHECK(sheared.heat == Approx(area + mu * g * g / 2).epsilon(1e-6));
    CHECK(sheared.energy() < 1e-9 * strength);
  }
}
