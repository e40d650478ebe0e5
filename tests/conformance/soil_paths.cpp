// Mohr-Coulomb on triaxial paths, on faces, edges and the apex; modified Cam-Clay from virgin compression to the critical
// state; mu(I) rheology in shear at several rates. Stresses are Kirchhoff's.

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "materials/cam_clay/cam_clay.hpp"
#include "materials/mohr_coulomb/mohr_coulomb.hpp"
#include "materials/mu_i/mu_i.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using Mat3 = Mat<3, double>;
using Vec3 = Vec<3, double>;

constexpr double young = 1e7, poisson = 0.3, bulk = young / (3 * (1 - 2 * poisson)),
                 shear = young / (2 * (1 + poisson));
constexpr double degree = 3.14159265358979323846 / 180;

Mat3 diagonal(double x, double y, double z) {
  return {{x, 0, 0, 0, y, 0, 0, 0, z}};
}

/// One particle of a material, driven by increments dt L over steps of `dt`.
template <class Material>
struct Particle {
  typename Material::template Constants<double> constants;
  typename Material::template State<3, double> state{{Mat3::identity()}, 1};
  double dt = 1, heat = 0, work = 0;

  explicit Particle(const typename Material::Parameters& parameters) : constants(parameters) {}

  Sym<3, double> stress() const { return Material::kirchhoff_stress(constants, state); }
  double energy() const { return Material::stored_energy(constants, state); }
  double mean_strain() const { return HenckySolid::sum(Material::prepared(state).strain); }
  double p() const { return -trace(stress()) / 3; }
  double q() const { return std::sqrt(1.5 * squared_norm(deviator(stress()))); }

  /// Strains by one increment, and adds heat and work, the latter by the trapezoidal rule. Returns the heat.
  double advance(const Mat3& increment) {
    Mat3 rate = increment;
    for (double& entry : rate.m) entry /= dt;
    const Sym<3, double> before = stress();
    const double now = Material::advance(constants, rate, dt, state);
    const Sym<3, double> after = stress();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) work += 0.5 * (before(i, j) + after(i, j)) * increment(i, j);
    heat += now;
    return now;
  }
  /// Strains along the axes by logarithmic strains.
  double strain(double x, double y, double z) { return advance(diagonal(std::expm1(x), std::expm1(y), std::expm1(z))); }

  /// Strains by `axial` along x so that the stresses along y and z stay at -side: the lateral strain by a secant.
  void squeeze(double axial, double side) {
    const Particle before = *this;
    const auto miss = [&](double lateral) {
      *this = before;
      strain(axial, lateral, lateral);
      return (stress()(1, 1) + side) / side;
    };
    double a = 0, b = -poisson * axial, at_a = miss(a), at_b = miss(b);
    for (int iteration = 0; iteration < 60 && std::abs(at_b) > 1e-13 && at_a != at_b; ++iteration) {
      const double next = b - at_b * (b - a) / (at_b - at_a);
      a = b, at_a = at_b;
      b = next, at_b = miss(b);
    }
    REQUIRE(std::abs(at_b) < 1e-9);
  }
};

/// Stresses of small-strain elasticity, which Hencky's law is in logarithmic strains, and back.
Vec3 elastic_stress(const Vec3& e) {
  const double mean = (bulk - 2 * shear / 3) * (e[0] + e[1] + e[2]);
  return {{2 * shear * e[0] + mean, 2 * shear * e[1] + mean, 2 * shear * e[2] + mean}};
}

// ---- Mohr-Coulomb ------------------------------------------------------------------------------------------------

Particle<MohrCoulomb> soil(double friction, double cohesion, double dilation) {
  return Particle<MohrCoulomb>({young, poisson, 1600, friction * degree, cohesion, dilation * degree});
}

/// A principal stress against another at failure: s1 = s3 (1 + sin)/(1 - sin) + 2 c cos/(1 - sin), compression
/// positive.
double larger_at_failure(double smaller, double friction, double cohesion) {
  const double s = std::sin(friction * degree), c = std::cos(friction * degree);
  return smaller * (1 + s) / (1 - s) + 2 * cohesion * c / (1 - s);
}

/// Multisurface plasticity without any knowledge of faces, edges and the apex: the six planes of Mohr-Coulomb, all sets
/// of one to three of them tried as active. A set is the answer where its multipliers are not negative and no plane is
/// violated (Koiter). Returns whether one was found; dilation must not be zero, or the apex has no set.
struct ActiveSets {
  double sine, dilation, strength;  ///< strength is 2 c cos phi
  std::array<Vec3, 6> normal{}, flow{};

  ActiveSets(double friction, double cohesion, double dilation_angle)
      : sine(std::sin(friction * degree)),
        dilation(std::sin(dilation_angle * degree)),
        strength(2 * cohesion * std::cos(friction * degree)) {
    int plane = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        if (i == j) continue;
        normal[plane][i] = 1 + sine, normal[plane][j] = -(1 - sine);
        flow[plane][i] = 1 + dilation, flow[plane][j] = -(1 - dilation);
        ++plane;
      }
  }

  double violation(const Vec3& tau) const {
    double most = -1e300;
    for (const Vec3& n : normal) most = std::max(most, HenckySolid::dot(n, tau) - strength);
    return most;
  }

  bool returned(const Vec3& trial, Vec3& tau) const {
    const double scale = std::abs(trial[0]) + std::abs(trial[1]) + std::abs(trial[2]) + strength;
    for (int set = 1; set < 64; ++set) {
      std::vector<int> active;
      for (int k = 0; k < 6; ++k)
        if (set >> k & 1) active.push_back(k);
      if (active.size() > 3) continue;
      std::vector<double> multiplier;
      if (!multipliers(active, trial, multiplier)) continue;
      tau = trial;
      bool positive = true;
      for (std::size_t a = 0; a < active.size(); ++a) {
        positive &= multiplier[a] >= -1e-12;
        const Vec3 back = elastic_stress(flow[active[a]]);
        for (int i = 0; i < 3; ++i) tau[i] -= multiplier[a] * back[i];
      }
      if (positive && violation(tau) < 1e-10 * scale) return true;
    }
    return false;
  }

  /// Solves n_a.C m_b x_b = n_a.trial - strength by Gauss-Jordan; false where the set is singular.
  bool multipliers(const std::vector<int>& active, const Vec3& trial, std::vector<double>& x) const {
    const std::size_t n = active.size();
    std::vector<std::vector<double>> A(n, std::vector<double>(n + 1));
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b < n; ++b)
        A[a][b] = HenckySolid::dot(normal[active[a]], elastic_stress(flow[active[b]]));
      A[a][n] = HenckySolid::dot(normal[active[a]], trial) - strength;
    }
    for (std::size_t k = 0; k < n; ++k) {
      std::size_t pivot = k;
      for (std::size_t a = k; a < n; ++a)
        if (std::abs(A[a][k]) > std::abs(A[pivot][k])) pivot = a;
      if (std::abs(A[pivot][k]) < 1e-9 * young) return false;
      std::swap(A[k], A[pivot]);
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = n + 1; a != k && b-- > k;) A[a][b] -= A[a][k] / A[k][k] * A[k][b];
    }
    x.resize(n);
    for (std::size_t k = 0; k < n; ++k) x[k] = A[k][n] / A[k][k];
    return true;
  }
};

// ---- modified Cam-Clay -------------------------------------------------------------------------------------------

constexpr double consolidation = 1e5, critical = 1.2, exponent = 20;

Particle<CamClay> clay(double cohesion = 0, double xi = exponent, double M = critical) {
  return Particle<CamClay>({young, poisson, 1600, consolidation, M, xi, cohesion});
}
/// Plastic compaction e.
double compaction(const Particle<CamClay>& particle) {
  return -std::log(particle.state.plastic_volume_ratio);
}
/// p_c by the exponential law.
double size_of(const Particle<CamClay>& particle, double xi = exponent) {
  return consolidation * std::exp(xi * compaction(particle));
}
/// The ellipse's function, over (M p_c)^2.
double off_ellipse(const Particle<CamClay>& particle, double beta, double M = critical, double xi = exponent) {
  const double p = particle.p(), q = particle.q(), size = size_of(particle, xi);
  return ((1 + 2 * beta) * q * q + M * M * (p + beta * size) * (p - size)) / (M * M * size * size);
}

// ---- mu(I) -------------------------------------------------------------------------------------------------------

constexpr double diameter = 1e-3, grain = 2450, static_friction = 0.38, limit_friction = 0.64, inertial = 0.279;

Particle<MuI> grains(double critical_density = 0, double limit = limit_friction) {
  return Particle<MuI>({young, poisson, 1500, diameter, grain, static_friction, limit, inertial, critical_density});
}
/// sqrt(dev : dev/2).
template <class Material>
double shear_stress(const Particle<Material>& particle) {
  return std::sqrt(0.5 * squared_norm(deviator(particle.stress())));
}
/// Presses from all sides to a pressure.
void press(Particle<MuI>& particle, double pressure) {
  particle.strain(-pressure / (3 * bulk), -pressure / (3 * bulk), -pressure / (3 * bulk));
}

/// The root of a function that rises from a to b.
double root_of(double a, double b, const std::function<double(double)>& f) {
  for (int k = 0; k < 200; ++k) (f(0.5 * (a + b)) < 0 ? a : b) = 0.5 * (a + b);
  return 0.5 * (a + b);
}

}  // namespace

TEST_CASE("Mohr-Coulomb: triaxial compression and extension fail at s1 = s3 (1 + sin)/(1 - sin) + 2 c cos/(1 - sin)") {
  const double side = 1e5;
  for (double friction : {20.0, 30.0, 40.0})
    for (double cohesion : {0.0, 1e4, 5e4})
      for (double dilation : {0.0, 10.0, friction}) {
        CAPTURE(friction, cohesion, dilation);
        for (double direction : {-1.0, 1.0}) {
          Particle<MohrCoulomb> particle = soil(friction, cohesion, dilation);
          particle.strain(-side / (3 * bulk), -side / (3 * bulk), -side / (3 * bulk));
          CHECK(particle.p() == Approx(side).epsilon(1e-12));
          CHECK(particle.heat == 0);
          for (int step = 0; step < 80; ++step) particle.squeeze(direction * 1e-3, side);
          // In extension the axial stress is the smaller one, and tension where the cohesion allows it.
          const double s = std::sin(friction * degree), c = std::cos(friction * degree);
          const double exact = direction < 0 ? larger_at_failure(side, friction, cohesion)
                                             : (side * (1 - s) - 2 * cohesion * c) / (1 + s);
          CHECK(-particle.stress()(0, 0) == Approx(exact).margin(1e-8 * side));
          // Dry soil with psi = phi dissipates nothing: its flow is at right angles to its stress.
          if (cohesion > 0 || dilation < friction)
            CHECK(particle.heat > 0);
          else
            CHECK(std::abs(particle.heat) < 1e-12 * young);
        }
      }
}

TEST_CASE("Mohr-Coulomb: at 30 degrees and 100 kPa compression fails at 300 kPa, extension at 100/3 kPa") {
  for (double direction : {-1.0, 1.0}) {
    Particle<MohrCoulomb> particle = soil(30, 0, 0);
    particle.strain(-1e5 / (3 * bulk), -1e5 / (3 * bulk), -1e5 / (3 * bulk));
    for (int step = 0; step < 80; ++step) particle.squeeze(direction * 1e-3, 1e5);
    CHECK(-particle.stress()(0, 0) == Approx(direction < 0 ? 3e5 : 1e5 / 3).epsilon(1e-8));
  }
}

TEST_CASE("Mohr-Coulomb: plastic flow in triaxial tests dilates by 2 sin psi/(1 - sin psi) and is heat") {
  // Compression flows on the edge of equal lateral stresses: of m = (1 + sin, -(1 - sin)) twice, one half each, so that
  // the volume grows by 2 sin psi for an axial strain of 1 - sin psi; extension by 2 sin psi for 1 + sin psi.
  for (double dilation : {0.0, 10.0, 30.0})
    for (double direction : {-1.0, 1.0}) {
      CAPTURE(dilation, direction);
      Particle<MohrCoulomb> particle = soil(30, 1e4, dilation);
      particle.strain(-1e5 / (3 * bulk), -1e5 / (3 * bulk), -1e5 / (3 * bulk));
      for (int step = 0; step < 60; ++step) particle.squeeze(direction * 1e-3, 1e5);
      const double volume = std::log(particle.state.volume_ratio), heat = particle.heat;
      const double axial_stress = particle.stress()(0, 0), sine = std::sin(dilation * degree);
      for (int step = 0; step < 20; ++step) particle.squeeze(direction * 1e-4, 1e5);
      const double axial = direction * 20e-4;
      const double grown = std::abs(axial) * 2 * sine / (1 + direction * sine);
      CHECK(std::log(particle.state.volume_ratio) - volume == Approx(grown).margin(1e-9));
      // The work of constant stresses, all of it heat: axial, and the side's -100 kPa on the two lateral strains.
      CHECK(particle.heat - heat == Approx(axial_stress * axial - 1e5 * (grown - axial)).epsilon(1e-6));
    }
}

TEST_CASE("Mohr-Coulomb: plane strain flows on a face, whose middle stress follows from the return") {
  // Biaxial compression at constant volume: the pressure stays, and the shear stress ends at (s1 - s3)/2 = p' sin phi +
  // c cos phi of the mean p' of the largest and least stress. The middle stress stays between them.
  for (double cohesion : {0.0, 2e4}) {
    Particle<MohrCoulomb> particle = soil(35, cohesion, 0);
    particle.strain(-1e5 / (3 * bulk), -1e5 / (3 * bulk), -1e5 / (3 * bulk));
    for (int step = 0; step < 100; ++step) particle.strain(-1e-3, 1e-3, 0);
    const double least = -particle.stress()(1, 1), largest = -particle.stress()(0, 0),
                 middle = -particle.stress()(2, 2);
    const double expected = (largest + least) / 2 * std::sin(35 * degree) + cohesion * std::cos(35 * degree);
    CHECK((largest - least) / 2 == Approx(expected).epsilon(1e-10));
    CHECK(particle.p() == Approx(1e5).epsilon(1e-9));  // flow at constant volume
    CHECK(middle == Approx(1e5).epsilon(1e-9));        // and none along the middle axis
    CHECK((largest + least) / 2 == Approx(1e5).epsilon(1e-9));
  }
}

TEST_CASE("Mohr-Coulomb: the return is that of the active planes that Koiter's conditions choose") {
  std::mt19937 generator(7);
  std::normal_distribution<double> normal(0, 1);
  std::uniform_real_distribution<double> unit(0, 1);
  int faces = 0, edges = 0, apexes = 0, elastic = 0;
  double worst = 0;
  for (int sample = 0; sample < 20000; ++sample) {
    const double friction = 5 + 75 * unit(generator), dilation = friction * (sample % 3 == 0 ? 1 : unit(generator));
    const double cohesion = sample % 2 ? 0 : 1e4 * unit(generator), size = std::pow(10, -4 + 3 * unit(generator));
    Vec3 e{{size * normal(generator), size * normal(generator), size * normal(generator)}};
    if (sample % 5 == 0) e[1] = e[0];
    CAPTURE(sample, friction, dilation, cohesion, e[0], e[1], e[2]);
    const ActiveSets planes(friction, cohesion, dilation);
    Vec3 exact;
    const Vec3 trial = elastic_stress(e);
    const bool found = planes.violation(trial) <= 0;
    if (found) exact = trial;
    if (!found && !planes.returned(trial, exact)) {
      FAIL("no set of planes returns the trial");
    }
    Particle<MohrCoulomb> particle = soil(friction, cohesion, dilation);
    const double heat = particle.strain(e[0], e[1], e[2]);
    const Sym<3, double> tau = particle.stress();
    const double scale = std::max({std::abs(trial[0]), std::abs(trial[1]), std::abs(trial[2])});
    for (int i = 0; i < 3; ++i) worst = std::max(worst, std::abs(tau.s[i] - exact[i]) / scale);
    CHECK(heat >= -1e-15 * scale);
    const bool same01 = std::abs(exact[0] - exact[1]) < 1e-9 * scale,
               same12 = std::abs(exact[1] - exact[2]) < 1e-9 * scale;
    const bool same02 = std::abs(exact[0] - exact[2]) < 1e-9 * scale;
    if (found)
      ++elastic;
    else if (same01 && same12)
      ++apexes;
    else if (same01 || same12 || same02)
      ++edges;
    else
      ++faces;
  }
  CAPTURE(elastic, faces, edges, apexes);
  CHECK(std::min({elastic, faces, edges, apexes}) > 500);
  CHECK(worst < 1e-9);
}

TEST_CASE("Mohr-Coulomb: in plane strain z takes its place among the principal stresses") {
  const MohrCoulomb::Constants<double> c({young, poisson, 1600, 10 * degree, 1e4, 5 * degree});
  for (const auto& [x, y] : {std::array{-0.03, -0.02}, std::array{0.02, 0.01}, std::array{-0.02, 0.015}}) {
    MohrCoulomb::State<2, double> flat{Deformation<2, double>::identity(), 1};
    Particle<MohrCoulomb> space = soil(10, 1e4, 5);
    const double heat = MohrCoulomb::advance(c, Mat<2, double>{{std::expm1(x), 0, 0, std::expm1(y)}}, 1.0, flat);
    CHECK(heat > 0);
    CHECK(heat == Approx(space.strain(x, y, 0)).epsilon(1e-12));
    for (int i = 0; i < 3; ++i)
      CHECK(MohrCoulomb::kirchhoff_stress(c, flat).s[i] == Approx(space.stress().s[i]).margin(1e-13 * young));
  }
}

TEST_CASE("Mohr-Coulomb: tension ends at the apex c cot phi, and what opens is heat") {
  for (double dilation : {0.0, 20.0}) {
    Particle<MohrCoulomb> particle = soil(30, 2e4, dilation);
    const double tension = 2e4 / std::tan(30 * degree);
    for (int step = 0; step < 50; ++step) particle.strain(1e-3, 1e-3, 1e-3);
    CHECK(-particle.p() == Approx(tension).epsilon(1e-10));
    CHECK(particle.q() < 1e-6 * tension);
    CHECK(particle.heat == Approx(tension * (0.15 - tension / bulk)).epsilon(1e-9));
    CHECK(std::log(particle.state.volume_ratio) == Approx(0.15).epsilon(1e-12));
  }
  Particle<MohrCoulomb> dry = soil(30, 0, 10);
  dry.advance({{0.02, 0.01, 0, 0, 0.01, 0, -0.02, 0, 0.03}});
  for (double component : dry.stress().s) CHECK(std::abs(component) < 1e-14 * young);
}

TEST_CASE("Mohr-Coulomb without friction is Tresca: simple shear ends at c, uniaxial compression at 2 c") {
  Particle<MohrCoulomb> sheared = soil(0, 1e4, 0);
  for (int step = 0; step < 200; ++step) sheared.advance({{0, 1e-4, 0, 0, 0, 0, 0, 0, 0}});
  const Sym<3, double> tau = sheared.stress();
  const double radius = std::sqrt(0.25 * (tau(0, 0) - tau(1, 1)) * (tau(0, 0) - tau(1, 1)) + tau(0, 1) * tau(0, 1));
  CHECK(radius == Approx(1e4).epsilon(1e-10));
  CHECK(std::abs(sheared.p()) < 1e-6 * 1e4);
  Particle<MohrCoulomb> pressed = soil(0, 1e4, 0);
  pressed.strain(-1e5 / (3 * bulk), -1e5 / (3 * bulk), -1e5 / (3 * bulk));
  for (int step = 0; step < 60; ++step) pressed.squeeze(-1e-3, 1e5);
  CHECK(-pressed.stress()(0, 0) == Approx(1e5 + 2e4).epsilon(1e-9));
}

TEST_CASE("Mohr-Coulomb: a dilation angle above the friction angle counts as the friction angle") {
  Particle<MohrCoulomb> clamped = soil(25, 1e4, 60), associated = soil(25, 1e4, 25);
  for (Particle<MohrCoulomb>* particle : {&clamped, &associated}) particle->strain(-0.02, 0.03, 0.001);
  for (int i = 0; i < 3; ++i) CHECK(clamped.stress().s[i] == associated.stress().s[i]);
}

TEST_CASE("Mohr-Coulomb: within the pyramid it is Hencky's law, keeps F_e to the last bit and closes its loops") {
  Particle<MohrCoulomb> particle = soil(30, 1e5, 10);
  Mat3 F = particle.state.elastic_deformation_gradient.plane;
  for (int step = 0; step < 10; ++step) {
    const Mat3 L{{1e-6 * step, 3e-7, 0, -2e-7, 1e-6, 1e-7, 4e-7, 0, -1e-6}};
    F = advanced(F, L, 1.0);
    CHECK(particle.advance(L) == 0);
    for (int k = 0; k < 9; ++k) CHECK(particle.state.elastic_deformation_gradient.plane.m[k] == F.m[k]);
  }
  Particle<MohrCoulomb> loop = soil(30, 1e5, 10);
  const double turn[4][3] = {{1e-3, -2e-3, 5e-4}, {-2e-3, 1e-3, 0}, {-1e-3, 2e-3, -5e-4}, {2e-3, -1e-3, 0}};
  for (const auto& leg : turn)
    for (int step = 0; step < 50; ++step) loop.strain(leg[0] / 50, leg[1] / 50, leg[2] / 50);
  CHECK(loop.heat == 0);
  CHECK(std::abs(loop.energy()) < 1e-20 * young);
  for (double component : loop.stress().s) CHECK(std::abs(component) < 1e-12 * young);
}

TEST_CASE("Mohr-Coulomb: work is stored plus dissipated energy on a closed loop beyond yield") {
  double last = 0;
  for (int steps : {200, 400, 800}) {
    Particle<MohrCoulomb> particle = soil(30, 1e4, 8);
    particle.strain(-5e-3, -5e-3, -5e-3);
    particle.work = particle.energy();
    const double legs[4][3] = {{-0.04, 0.03, 0}, {0, -0.04, 0.03}, {0.04, 0, -0.03}, {0, 0.01, 0}};
    for (const auto& leg : legs)
      for (int step = 0; step < steps; ++step) particle.strain(leg[0] / steps, leg[1] / steps, leg[2] / steps);
    CHECK(particle.heat > 0);
    const double miss = std::abs(particle.work - particle.energy() - particle.heat) / particle.work;
    CHECK(miss < 2.0 / steps);
    if (last > 0) CHECK(miss < 0.6 * last);  // of first order
    last = miss;
  }
}

TEST_CASE("Mohr-Coulomb: the fastest waves at psi = phi are elastic, and flow that is not associated adds") {
  const auto modulus = [](const Particle<MohrCoulomb>& particle) {
    const double speed = MohrCoulomb::wave_speed(particle.constants, particle.state);
    return 1600 * speed * speed;
  };
  CHECK(modulus(soil(30, 0, 30)) == Approx(bulk + 4 * shear / 3).epsilon(1e-12));
  // phi = 30, psi = 0 in units of 2 G, where lambda = 0.75: the most that x.(E - C)x has over unit vectors x of normal
  // strains, E = C - C m (x) C n/(n.C m) on a face, and E = l (x) g/(g.C^-1 l) on the edges.
  const Vec3 Cn{{2.25, 0.75, 0.25}}, Cm{{1, 0, -1}}, g{{1, 1, 1}};
  const double trace_of_g = 3, s = poisson / (1 + poisson);
  double most = 0;
  for (int i = 0; i < 400; ++i)
    for (int j = 0; j < 400; ++j) {
      const double polar = 3.14159265358979 * i / 400, around = 3.14159265358979 * j / 400;
      const Vec3 x{{std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar)}};
      const double sum = x[0] + x[1] + x[2], elastic = 1 + 0.75 * sum * sum;
      most = std::max(most, -HenckySolid::dot(x, Cm) * HenckySolid::dot(x, Cn) / 2);
      for (const Vec3& l : {Vec3{{0.5, 1.5, 1.5}}, Vec3{{0.5, 0.5, 1.5}}}) {
        const double bound = HenckySolid::dot(g, l) - s * trace_of_g * HenckySolid::sum(l);
        most = std::max(most, HenckySolid::dot(x, l) * sum / bound - elastic);
      }
    }
  CHECK(modulus(soil(30, 0, 0)) == Approx(bulk + 4 * shear / 3 + 2 * shear * most).epsilon(1e-4));
}

TEST_CASE("Mohr-Coulomb: at other angles and Poisson ratios the fastest waves are those of a face or of an edge") {
  const double cases[][3] = {{-0.8, 60, 10}, {-0.5, 30, 0}, {0, 5, 0}, {0.3, 30, 10}, {0.45, 60, 10}, {0.45, 60, 0}};
  for (const auto& [nu, friction, dilation] : cases) {
    CAPTURE(nu, friction, dilation);
    const double sine = std::sin(friction * degree), flow = std::sin(dilation * degree), r = nu / (1 - 2 * nu);
    const Eigen::Matrix3d C = Eigen::Matrix3d::Identity() + r * Eigen::Matrix3d::Ones();  // in units of 2 G
    const Eigen::Vector3d n(1 + sine, 0, sine - 1), m(1 + flow, 0, flow - 1);
    double most = 0;
    // The most that the tangent of normal strains has over the elastic one.
    const auto grows_to = [&](const Eigen::Matrix3d& tangent) {
      const Eigen::Matrix3d change = tangent - C, symmetric = 0.5 * (change + change.transpose());
      most = std::max(most, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(symmetric).eigenvalues().maxCoeff());
    };
    grows_to(C - C * m * n.transpose() * C / n.dot(C * m));
    for (double middle : {-1.0, 1.0}) {
      const Eigen::Vector3d l(1 - sine, 1 - middle * sine, 1 + sine), g(1 - flow, 1 - middle * flow, 1 + flow);
      grows_to(l * g.transpose() / g.dot(C.inverse() * l));
    }
    const double G = young / (2 * (1 + nu));
    const MohrCoulomb::Constants<double> c({young, nu, 1600, friction * degree, 0, dilation * degree});
    CHECK(c.longitudinal == Approx(2 * G * (1 + r + most)).epsilon(1e-12));
  }
}

TEST_CASE("Mohr-Coulomb: J from 1e-6 to 1e6, thin and long particles, and inverted ones") {
  for (double J : {1e-6, 1e-3, 1e3, 1e6}) {
    CAPTURE(J);
    Particle<MohrCoulomb> particle = soil(30, 1e4, 10);
    const double third = std::cbrt(J) - 1;
    const double heat = particle.advance(diagonal(third, third, third));
    CHECK(particle.state.volume_ratio == Approx(J).epsilon(1e-12));
    const double pressure = J < 1 ? -bulk * std::log(J) : -1e4 / std::tan(30 * degree);
    CHECK(particle.p() == Approx(pressure).epsilon(1e-12));
    CHECK(heat >= 0);
    CHECK(std::isfinite(MohrCoulomb::wave_speed(particle.constants, particle.state)));
  }
  for (double stretch : {1e-6, 1e6}) {
    Particle<MohrCoulomb> particle = soil(30, 1e4, 10);
    CHECK(particle.advance(diagonal(stretch - 1, 0, 0)) >= 0);
    const Sym<3, double> tau = particle.stress();
    const double s = 0.5, largest = std::max({tau.s[0], tau.s[1], tau.s[2]}),
                 least = std::min({tau.s[0], tau.s[1], tau.s[2]});
    CHECK((largest - least) + (largest + least) * s <= 2e4 * std::cos(30 * degree) + 1e-9 * young);
  }
  Particle<MohrCoulomb> inverted = soil(30, 1e4, 10);
  inverted.advance(diagonal(-2, 0, 0));
  CHECK_FALSE(inverted.state.volume_ratio > 0);  // the host stops the run and names the particle
}

TEST_CASE("Cam-Clay: virgin compression follows p/K + ln(p/p_c0)/xi, unloading K") {
  for (double volume : {0.05, 0.15, 0.3})
    for (int steps : {1, 7, 400}) {
      CAPTURE(volume, steps);
      Particle<CamClay> particle = clay();
      for (int step = 0; step < steps; ++step)
        particle.strain(-volume / 3 / steps, -volume / 3 / steps, -volume / 3 / steps);
      const double exact = root_of(consolidation, 10 * bulk, [&](double p) {
        return p / bulk + std::log(p / consolidation) / exponent - volume;
      });
      CHECK(particle.p() == Approx(exact).epsilon(1e-9));
      CHECK(size_of(particle) == Approx(exact).epsilon(1e-9));
      CHECK(particle.q() < 1e-9 * exact);
      // The plastic work is the integral of p_c de = (p_c - p_c0)/xi.
      if (steps == 400) CHECK(particle.heat == Approx((exact - consolidation) / exponent).epsilon(5e-3));
      const double heat = particle.heat, plastic = particle.state.plastic_volume_ratio;
      particle.strain(1e-3, 1e-3, 1e-3);
      CHECK(particle.p() == Approx(exact - 3e-3 * bulk).epsilon(1e-9));
      CHECK(particle.heat == heat);
      CHECK(particle.state.plastic_volume_ratio == plastic);
    }
}

TEST_CASE("Cam-Clay: drained triaxial tests end at the critical state q = M p, p_c = 2 p, at constant volume") {
  // With the side at s: compression q = 3 M s/(3 - M), extension q = 3 M s/(3 + M). At M = 1.2 and 100 kPa: 200 kPa,
  // 85.714 kPa.
  for (double preloaded : {1.0, 5.0})  // normally consolidated and overconsolidated
    for (double direction : {-1.0, 1.0}) {
      CAPTURE(preloaded, direction);
      const double side = consolidation / preloaded, q = 3 * critical * side / (3 + direction * critical);
      Particle<CamClay> particle = clay();
      particle.strain(-side / (3 * bulk), -side / (3 * bulk), -side / (3 * bulk));
      double strongest = 0;
      for (int step = 0; step < 1000; ++step) {
        particle.squeeze(direction * 1e-3, side);
        strongest = std::max(strongest, particle.q());
      }
      const double volume = particle.state.plastic_volume_ratio, heat = particle.heat;
      CHECK(particle.q() == Approx(q).epsilon(1e-6));
      CHECK(particle.q() / particle.p() == Approx(critical).epsilon(1e-6));
      CHECK(size_of(particle) == Approx(2 * particle.p()).epsilon(1e-6));
      if (preloaded > 1)
        CHECK(strongest > 1.2 * q);  // overconsolidated clay has a peak, and has dilated
      else
        CHECK(strongest < 1.000001 * q);
      CHECK((volume > 1) == (compaction(particle) < 0));
      for (int step = 0; step < 10; ++step) particle.squeeze(direction * 1e-3, side);
      CHECK(particle.state.plastic_volume_ratio == Approx(volume).epsilon(1e-7));
      CHECK(particle.heat - heat == Approx(q * 0.01).epsilon(1e-5));
    }
}

TEST_CASE("Cam-Clay: with 100 kPa at the side and M = 1.2 the strength is 200 kPa") {
  Particle<CamClay> particle = clay();
  particle.strain(-1e5 / (3 * bulk), -1e5 / (3 * bulk), -1e5 / (3 * bulk));
  for (int step = 0; step < 1000; ++step) particle.squeeze(-1e-3, 1e5);
  CHECK(particle.q() == Approx(2e5).epsilon(1e-6));
}

TEST_CASE("Cam-Clay: shearing at constant volume ends where p/K gives what e takes, with cohesion too") {
  for (double beta : {0.0, 0.3, 0.8})
    for (double start : {1.0, 0.1}) {
      CAPTURE(beta, start);
      Particle<CamClay> particle = clay(beta);
      const double pressure = start * consolidation;
      particle.strain(-pressure / (3 * bulk), -pressure / (3 * bulk), -pressure / (3 * bulk));
      for (int step = 0; step < 3000; ++step) particle.strain(-1e-3, 1e-3, 0);
      const double p = root_of(1e-3 * consolidation, consolidation, [&](double at) {
        return (at - pressure) / bulk + std::log(2 * at / ((1 - beta) * consolidation)) / exponent;
      });
      const double size = 2 * p / (1 - beta);
      CHECK(particle.p() == Approx(p).epsilon(1e-8));
      CHECK(size_of(particle) == Approx(size).epsilon(1e-8));
      CHECK(particle.q() == Approx(critical * (1 + beta) * size / (2 * std::sqrt(1 + 2 * beta))).epsilon(1e-8));
    }
}

TEST_CASE("Cam-Clay: overconsolidated clay is elastic up to q^2 = M^2 p (p_c - p)") {
  Particle<CamClay> particle = clay();
  const double side = 2e4;
  particle.strain(-side / (3 * bulk), -side / (3 * bulk), -side / (3 * bulk));
  // On the elastic path p = s + q/3: (1/M^2 + 1/9) q^2 - (p_c - 2 s) q/3 - s (p_c - s) = 0.
  const double a = 1 / (critical * critical) + 1.0 / 9, b = -(consolidation - 2 * side) / 3;
  const double yields = (-b + std::sqrt(b * b + 4 * a * side * (consolidation - side))) / (2 * a);
  double last = 0;
  while (particle.heat == 0 && last < 10 * yields) {
    last = particle.q();
    particle.squeeze(-2e-5, side);
  }
  CHECK(last <= yields * (1 + 1e-4));
  CHECK(last + 2e-5 * young >= yields * (1 - 1e-4));
}

TEST_CASE("Cam-Clay: every return is on the ellipse, along its normal, and loses what the plastic strain takes") {
  std::mt19937 generator(11);
  std::normal_distribution<double> normal(0, 1);
  std::uniform_real_distribution<double> unit(0, 1);
  int compacts = 0, dilates = 0;
  for (int sample = 0; sample < 20000; ++sample) {
    const double beta = sample % 2 ? 0 : 0.8 * unit(generator), M = 0.5 + 1.5 * unit(generator),
                 xi = 20 * unit(generator);
    Particle<CamClay> particle = clay(beta, xi, M);
    const double p_0 = consolidation * unit(generator), size = 0.1 * unit(generator) * unit(generator);
    particle.strain(-p_0 / (3 * bulk), -p_0 / (3 * bulk), -p_0 / (3 * bulk));
    if (particle.heat > 0) continue;
    const Vec3 e{{size * normal(generator), size * normal(generator), size * normal(generator)}};
    const double trace = e[0] + e[1] + e[2], p_trial = p_0 - bulk * trace;
    double squared = 0;
    for (int i = 0; i < 3; ++i) squared += (e[i] - trace / 3) * (e[i] - trace / 3);
    const double q_trial = std::sqrt(1.5 * squared) * 2 * shear;
    const double heat = particle.strain(e[0], e[1], e[2]);
    if (heat == 0) continue;
    CAPTURE(sample, beta, M, xi, p_trial, q_trial);
    const double p = particle.p(), q = particle.q(), x = compaction(particle), a = 1 + 2 * beta;
    const double p_c = size_of(particle, xi);
    if (p_c < 1e-3 * consolidation) continue;  // rounding of p, of the size of the trial, counts there
    if (xi * p_c > 0.4 * bulk) continue;       // there the slope of hardening is held
    (x > 0 ? compacts : dilates) += 1;
    CHECK(p == Approx(p_trial - bulk * x).margin(1e-9 * young));
    CHECK(std::abs(off_ellipse(particle, beta, M, xi)) < 1e-7);
    // dev : volume of the plastic strain is 2 a q : M^2 (2 p - (1 - beta) p_c) for shear strains (q' - q)/(3 G).
    const double shearing = (q_trial - q) / (3 * shear), flow = M * M * (2 * p - (1 - beta) * p_c);
    CHECK(shearing * flow == Approx(x * 2 * a * q).margin(1e-6 * size * (M * M * p_c + q)));
    CHECK(heat == Approx(q * shearing + p * x).margin(1e-12 * young));
    CHECK(heat >= 0);
  }
  CHECK(std::min(compacts, dilates) > 1000);
}

TEST_CASE("Cam-Clay: tension ends at beta p_c, which parting clay loses, and the gap must close again") {
  const double beta = 0.4;
  Particle<CamClay> particle = clay(beta);
  const double opened = 0.15;
  for (int step = 0; step < 300; ++step) particle.strain(opened / 900, opened / 900, opened / 900);
  // -p = beta p_c0 exp(xi e), and -p/K - e is the volume that opened.
  const double tension = root_of(0, beta * consolidation, [&](double at) {
    return opened - at / bulk + std::log(std::max(at, 1e-300) / (beta * consolidation)) / exponent;
  });
  CHECK(-particle.p() == Approx(tension).epsilon(1e-8));
  CHECK(std::log(CamClay::volume_ratio(particle.state)) == Approx(opened).epsilon(1e-12));
  for (int step = 0; step < 300; ++step) {
    particle.strain(-opened / 900, -opened / 900, -opened / 900);
    CHECK(particle.p() <= size_of(particle) * (1 + 1e-9));
  }
  const double back =
      root_of(1, consolidation, [&](double p) { return p / bulk + std::log(p / consolidation) / exponent; });
  CHECK(particle.p() == Approx(back).epsilon(1e-8));
}

TEST_CASE("Cam-Clay: the slope of hardening is held at half of that at which stress would jump") {
  for (double M : {0.6, 1.2, 2.0})
    for (double beta : {0.0, 0.1, 0.7}) {
      CAPTURE(M, beta);
      // Softening is stable on the ellipse while n.C n > -(dF/dp_c)(dp_c/de)(flow): the least ratio over its dry side,
      // in units of K, F = a q^2 + M^2 (p + beta p_c)(p - p_c) with p_c = 1.
      double least = 1e300;
      for (int k = 1; k <= 200000; ++k) {
        const double p = (1 - beta) / 2 - (1 + beta) / 2 * k / 200000, flow = M * M * (2 * p - (1 - beta));
        const double squared = M * M * (p + beta) * (1 - p) / (1 + 2 * beta), a = 1 + 2 * beta;
        const double stiffness = flow * flow + 12 * shear / bulk * a * a * squared;
        const double falls = -M * M * ((1 - beta) * p + 2 * beta) * flow;
        if (falls > 0) least = std::min(least, stiffness / falls);
      }
      const double xi = 500, straight = 0.5 * least * bulk;
      Particle<CamClay> particle = clay(beta, xi, M);
      particle.strain(-0.2, -0.2, -0.2);
      const double p_1 = particle.p(), e_1 = compaction(particle);
      CHECK(p_1 > straight / xi);
      particle.strain(-0.1, -0.1, -0.1);
      CHECK((particle.p() - p_1) / (compaction(particle) - e_1) == Approx(straight).epsilon(1e-6));
      // The straight part goes on from the exponential one, with its slope.
      const double from = std::log(straight / xi / consolidation) / xi;
      if (straight / xi > consolidation) CHECK(p_1 == Approx(straight / xi + straight * (e_1 - from)).epsilon(1e-6));
    }
}

TEST_CASE(
    "Cam-Clay: clay that is larger than the exponential law reaches hardens along the straight part from the start") {
  for (double M : {0.6, 1.2})
    for (double beta : {0.0, 0.5}) {
      CAPTURE(M, beta);
      const double size = consolidation / bulk, xi = 5000;
      const CamClay::Hardening<double> law(size, xi, M, beta, shear / bulk);
      const CamClay::Hardening<double> gentle(1e-3 * size, 0.5 * xi, M, beta, shear / bulk);
      double slope, gentle_slope;
      CHECK(law(0.0, slope) == Approx(size).epsilon(1e-12));
      CHECK(gentle(1.0, gentle_slope) > 0);
      CHECK(slope == Approx(gentle_slope).epsilon(1e-12));  // the steepest does not depend on where it is reached
      const double at_rest = slope;
      CHECK(law(0.01, slope) == Approx(size + 0.01 * at_rest).epsilon(1e-12));
      CHECK(slope == at_rest);
      // Below p_c = slope/xi it is exponential.
      const double first = (at_rest / xi - size) / at_rest;
      CHECK(law(first - 1e-4, slope) == Approx(at_rest / xi * std::exp(-0.5)).epsilon(1e-9));
      CHECK(slope == Approx(at_rest * std::exp(-0.5)).epsilon(1e-9));
    }
}

TEST_CASE(
    "Cam-Clay: the function that Newton's method solves has the sign of the ellipse's, and its slope the derivative") {
  std::mt19937 generator(17);
  std::uniform_real_distribution<double> unit(0, 1);
  int central = 0, tips = 0;
  for (int sample = 0; sample < 3000; ++sample) {
    const double beta = sample % 3 ? 0.9 * unit(generator) : 0, M = 0.5 + 1.5 * unit(generator),
                 xi = 30 * unit(generator);
    const CamClay::Constants<double> c({young, poisson, 1600, consolidation, M, xi, beta});
    CamClay::Trial<double> t;
    t.compaction = 0.02 * (unit(generator) - 0.5);
    double rate;
    const double size = c.hardening(t.compaction, rate), centre = (1 - beta) * size / 2;
    t.side = sample % 2 ? 1 : -1;
    t.pressure = centre + t.side * 2 * (1 + beta) * size * unit(generator);
    t.shear = 2 * M * size * unit(generator);
    const double farthest = std::abs(t.pressure - centre), X = farthest * (0.02 + 0.96 * unit(generator)),
                 h = 1e-6 * size;
    const CamClay::Point<double> here = CamClay::at(c, t, X), before = CamClay::at(c, t, X - h),
                                 after = CamClay::at(c, t, X + h);
    const double p = t.pressure - t.side * X, p_c = c.hardening(t.compaction + t.side * X, rate), a = 1 + 2 * beta;
    const double N = t.side * M * M * (2 * p - (1 - beta) * p_c), half = 0.5 * M * M * (1 + beta) * p_c;
    if (!(N > 1e-3 * half) || std::abs(N - half) < 1e-3 * half) continue;
    CAPTURE(sample, beta, M, xi, X / farthest, N / half);
    (N < half ? central : tips) += 1;
    const double q = t.shear * N / (N + 6 * shear / bulk * a * X);
    const double off = a * q * q + M * M * (p + beta * p_c) * (p - p_c);
    CHECK(here.pressure == Approx(p).margin(1e-14 * size));
    CHECK(here.size == Approx(p_c).epsilon(1e-13));
    CHECK(here.flow == Approx(N).margin(1e-13 * half));
    if (std::abs(off) > 1e-9 * M * M * p_c * p_c) CHECK((here.value > 0) == (off > 0));
    CHECK(here.slope == Approx((after.value - before.value) / (2 * h)).epsilon(1e-5).margin(1e-5));
  }
  CHECK(std::min(central, tips) > 300);
}

TEST_CASE("Cam-Clay: the return is found to the same share of the ellipse, however small the ellipse is") {
  for (double size : {1e-2, 1e-9, 1e-18})
    for (double beta : {0.0, 0.4}) {
      const CamClay::Constants<double> c({young, poisson, 1600, size * bulk, critical, 5, beta});
      for (double side : {1.0, -1.0}) {
        CAPTURE(size, beta, side);
        const double centre = (1 - beta) * size / 2, farthest = 1.5 * size;
        const CamClay::Trial<double> t{centre + side * farthest, 1.3 * size, 0, side};
        const double X = CamClay::solved(c, t, farthest);
        double rate;
        const double p = t.pressure - side * X, p_c = c.hardening(side * X, rate), M2 = critical * critical;
        const double N = side * M2 * (2 * p - (1 - beta) * p_c),
                     q = t.shear * N / (N + 6 * shear / bulk * (1 + 2 * beta) * X);
        CHECK(N > 0);
        CHECK(std::abs((1 + 2 * beta) * q * q + M2 * (p + beta * p_c) * (p - p_c)) < 1e-11 * size * size);
      }
    }
}

TEST_CASE("Cam-Clay: within the ellipse it closes its loops, beyond work is stored plus dissipated energy") {
  Particle<CamClay> elastic = clay();
  elastic.strain(-2e-3, -2e-3, -2e-3);
  const double energy = elastic.energy();
  const double turn[4][3] = {{1e-4, -2e-4, 5e-5}, {-2e-4, 1e-4, 0}, {-1e-4, 2e-4, -5e-5}, {2e-4, -1e-4, 0}};
  for (const auto& leg : turn)
    for (int step = 0; step < 50; ++step) elastic.strain(leg[0] / 50, leg[1] / 50, leg[2] / 50);
  CHECK(elastic.heat == 0);
  CHECK(elastic.energy() == Approx(energy).epsilon(1e-10));
  double last = 0;
  for (int steps : {200, 400, 800}) {
    Particle<CamClay> particle = clay(0.1);
    const double legs[4][3] = {{-0.06, -0.02, -0.02}, {0.03, -0.03, 0.01}, {0.05, 0.02, 0.01}, {-0.02, 0.03, 0}};
    double least = 0;
    for (const auto& leg : legs)
      for (int step = 0; step < steps; ++step)
        least = std::min(least, particle.strain(leg[0] / steps, leg[1] / steps, leg[2] / steps));
    CHECK(least >= 0);
    const double miss = std::abs(particle.work - particle.energy() - particle.heat) / particle.work;
    CHECK(miss < 10.0 / steps);
    if (last > 0) CHECK(miss < 0.6 * last);  // of first order
    last = miss;
  }
}

TEST_CASE("Cam-Clay: at rest the fastest wave is the elastic longitudinal one") {
  const Particle<CamClay> particle = clay();
  const double speed = CamClay::wave_speed(particle.constants, particle.state);
  CHECK(1600 * speed * speed == Approx(bulk + 4 * shear / 3).epsilon(1e-12));
}

TEST_CASE("Cam-Clay: J from 1e-6 to 1e6, thin and long particles, and inverted ones") {
  for (double beta : {0.0, 0.5})
    for (double J : {1e-6, 1e-3, 1e3, 1e6}) {
      CAPTURE(J, beta);
      Particle<CamClay> particle = clay(beta);
      const double third = std::cbrt(J) - 1;
      CHECK(particle.advance(diagonal(third, third, third)) >= 0);
      CHECK(CamClay::volume_ratio(particle.state) == Approx(J).epsilon(1e-12));
      CHECK(particle.p() == Approx(bulk * (-std::log(J) - compaction(particle))).margin(1e-10 * bulk));
      if (J > 1) CHECK(-particle.p() <= beta * size_of(particle) + 1e-12 * young);
      if (J < 1) CHECK(particle.p() > 10 * consolidation);
      CHECK(CamClay::wave_speed(particle.constants, particle.state) > 0);
    }
  for (double stretch : {1e-6, 1e-2, 1e2, 1e6}) {
    CAPTURE(stretch);
    Particle<CamClay> particle = clay();
    CHECK(particle.advance(diagonal(stretch - 1, 0, 0)) >= -1e-20 * young);
    CHECK(CamClay::volume_ratio(particle.state) == Approx(1 + (stretch - 1)).epsilon(1e-12));
    CHECK(std::isfinite(particle.q()));
    CHECK(particle.p() > -1e-9 * young);
    const double heat = particle.heat;
    CHECK(particle.strain(0, 0, 0) < 1e-9 * std::max(heat, young));  // the state was on the ellipse
  }
  Particle<CamClay> inverted = clay();
  inverted.advance(diagonal(-2, 0, 0));
  CHECK_FALSE(CamClay::volume_ratio(inverted.state) > 0);
}

TEST_CASE("mu(I): simple shear is carried by (mu_s + (mu_2 - mu_s)/(I_0/I + 1)) p, I = rate d sqrt(rho_s/p)") {
  for (double pressure : {1e3, 2e4})
    for (double inertia : {1e-4, 1e-2, 0.1, 0.279, 1.0, 10.0}) {
      CAPTURE(pressure, inertia);
      const double rate = inertia * std::sqrt(pressure / grain) / diameter, increment = 1e-5;
      Particle<MuI> particle = grains();
      press(particle, pressure);
      CHECK(particle.p() == Approx(pressure).epsilon(1e-9));
      particle.dt = increment / rate;
      const int steps = static_cast<int>(20 * pressure / shear / increment) + 20;
      for (int step = 0; step < steps; ++step) particle.advance({{0, increment, 0, 0, 0, 0, 0, 0, 0}});
      const double friction = static_friction + (limit_friction - static_friction) / (inertial / inertia + 1);
      // Steady flow of an elastic solid lies off the axes of simple shear by the elastic strain, of order p/G.
      CHECK(particle.p() == Approx(pressure).epsilon(1e-9));
      CHECK(shear_stress(particle) == Approx(friction * pressure).epsilon(5 * pressure / shear));
      CHECK(particle.stress()(0, 1) == Approx(friction * pressure).epsilon(5 * pressure / shear));
      const double heat = particle.heat;
      for (int step = 0; step < 10; ++step) particle.advance({{0, increment, 0, 0, 0, 0, 0, 0, 0}});
      CHECK((particle.heat - heat) / (10 * increment) == Approx(friction * pressure).epsilon(5 * pressure / shear));
    }
}

TEST_CASE("mu(I): at I_0 the friction is half way, 0.51 for glass beads") {
  Particle<MuI> particle = grains();
  press(particle, 1e3);
  particle.dt = 1e-5 / (inertial * std::sqrt(1e3 / grain) / diameter);
  for (int step = 0; step < 600; ++step) particle.advance({{0, 1e-5, 0, 0, 0, 0, 0, 0, 0}});
  CHECK(particle.stress()(0, 1) == Approx(510).epsilon(2e-3));
}

TEST_CASE("mu(I): one step solves s = s' - G dt g with the rate g that carries s") {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> unit(0, 1);
  int flows = 0;
  for (int sample = 0; sample < 5000; ++sample) {
    Particle<MuI> particle = grains();
    const double pressure = std::pow(10, 2 + 4 * unit(generator));
    press(particle, pressure);
    particle.dt = std::pow(10, -6 + 5 * unit(generator));
    const double strain = pressure / shear * std::pow(10, -1 + 3 * unit(generator));
    CAPTURE(sample, pressure, particle.dt, strain);
    const double trial = 2 * shear * strain / 2;  // dev eps = (strain/2, -strain/2, 0)
    const double heat = particle.strain(strain / 2, -strain / 2, 0);
    const double s = shear_stress(particle), p = particle.p();
    if (trial < static_friction * p * (1 - 1e-9)) {
      CHECK(heat == 0);
      CHECK(s == Approx(trial).epsilon(1e-9));
    } else if (trial > static_friction * p * (1 + 1e-9)) {
      ++flows;
      CHECK(s <= trial);
      CHECK(s >= static_friction * p * (1 - 1e-9));
      CHECK(s < limit_friction * p);
      // s = mu(I) p solved for I: I = I_0 (s - mu_s p)/(mu_2 p - s).
      const double exact = root_of(static_friction * p, std::min(limit_friction * p, trial), [&](double at) {
        const double I = inertial * (at - static_friction * p) / (limit_friction * p - at);
        return at + shear * particle.dt * I * std::sqrt(p / grain) / diameter - trial;
      });
      CHECK(s == Approx(exact).epsilon(1e-9));
      CHECK(heat == Approx(s * (trial - s) / shear).margin(1e-9 * s * trial / shear));
    }
  }
  CHECK(flows > 1000);
}

TEST_CASE("mu(I): grains that stand still keep mu_s p, whatever they carried when they flowed") {
  Particle<MuI> particle = grains();
  press(particle, 1e4);
  particle.dt = 1e-8;
  for (int step = 0; step < 500; ++step) particle.advance({{0, 1e-4, 0, 0, 0, 0, 0, 0, 0}});
  CHECK(shear_stress(particle) > 0.55e4);
  particle.dt = 1e-3;
  for (int step = 0; step < 3000; ++step) particle.advance({});
  CHECK(shear_stress(particle) == Approx(static_friction * 1e4).epsilon(1e-4));
  CHECK(particle.p() == Approx(1e4).epsilon(1e-9));
}

TEST_CASE("mu(I): without growth of friction it is a cone, at every rate") {
  for (double dt : {1e-9, 1e-3, 1e3}) {
    Particle<MuI> particle = grains(0, 0.1);  // below mu_s it counts as mu_s
    press(particle, 1e4);
    particle.dt = dt;
    for (int step = 0; step < 100; ++step) particle.advance({{0, 1e-3, 0, 0, 0, 0, 0, 0, 0}});
    CHECK(shear_stress(particle) == Approx(static_friction * particle.p()).epsilon(1e-9));
  }
}

TEST_CASE("mu(I): no stress below the critical density, and above it K ln(density/critical density)") {
  const double critical_density = 1600;
  Particle<MuI> particle = grains(critical_density);
  for (int step = 0; step < 600; ++step) {
    // Loosening, shearing and compaction in turn; the packing begins at 1500 kg/m^3.
    const double volume = step < 100 ? 2e-4 : step < 200 ? 0 : -5e-4;
    particle.advance({{volume, step < 200 ? 1e-3 : 2e-4, 0, 0, volume, 0, 0, 0, volume}});
    const double now = 1500 / particle.state.volume_ratio;
    CHECK(particle.p() == Approx(std::max(0.0, bulk * std::log(now / critical_density))).margin(1e-9 * bulk));
    if (now < critical_density) CHECK(shear_stress(particle) == 0);
  }
  CHECK(particle.p() > 1e-2 * bulk);
  while (1500 / particle.state.volume_ratio > critical_density) particle.advance(diagonal(1e-3, 1e-3, 1e-3));
  for (double component : particle.stress().s) CHECK(component == 0);
  CHECK(particle.energy() == 0);
}

TEST_CASE("mu(I): of a step that closes a gap and presses, only the pressing is stored, the rest of its work is heat") {
  Particle<MuI> particle = grains();
  particle.strain(0.004, 0.003, 0.003);
  CHECK(particle.strain(-0.01, -0.01, -0.01) == Approx(0.02 * bulk * 0.01).epsilon(1e-9));
  CHECK(particle.energy() == Approx(0.5 * bulk * 0.02 * 0.02).epsilon(1e-9));
}

TEST_CASE("mu(I): grains that close a gap and do not flow keep their shear beside the pressure of their volume") {
  Particle<MuI> particle = grains();
  particle.strain(0.003, 0.003, 0.003);
  CHECK(particle.q() == 0);
  const double e[3] = {-0.005, -0.0049, -0.0048}, mean = -0.0049, volume = -0.0147 + 0.009;
  particle.strain(e[0], e[1], e[2]);
  for (int i = 0; i < 3; ++i)
    CHECK(particle.stress().s[i] == Approx(bulk * volume + 2 * shear * (e[i] - mean)).epsilon(1e-9));
}

TEST_CASE("mu(I): below mu_s it is Hencky's law, keeps F_e to the last bit and closes its loops") {
  Particle<MuI> particle = grains();
  press(particle, 1e5);
  const double energy = particle.energy();
  Mat3 F = particle.state.elastic_deformation_gradient.plane;
  for (int step = 0; step < 20; ++step) {
    const double sign = step < 10 ? 1 : -1;
    const Mat3 L{{sign * 1e-5, sign * 3e-5, 0, sign * 1e-5, 0, 0, 0, 0, -sign * 2e-5}};
    F = advanced(F, L, 1.0);
    CHECK(particle.advance(L) == 0);
    for (int k = 0; k < 9; ++k) CHECK(particle.state.elastic_deformation_gradient.plane.m[k] == F.m[k]);
  }
  Particle<MuI> elastic = grains();
  press(elastic, 1e5);
  const double turn[4][3] = {{1e-4, -2e-4, 5e-5}, {-2e-4, 1e-4, 0}, {-1e-4, 2e-4, -5e-5}, {2e-4, -1e-4, 0}};
  for (const auto& leg : turn)
    for (int step = 0; step < 50; ++step) elastic.strain(leg[0] / 50, leg[1] / 50, leg[2] / 50);
  CHECK(elastic.heat == 0);
  CHECK(elastic.energy() == Approx(energy).epsilon(1e-10));
  double last = 0;
  for (int steps : {200, 400, 800}) {
    Particle<MuI> flowing = grains();
    flowing.dt = 0.02 / steps;
    const double legs[4][3] = {{-0.01, -0.01, -0.01}, {0.03, -0.03, 0}, {0.01, 0.005, -0.02}, {-0.02, 0.03, 0}};
    double least = 0;
    for (const auto& leg : legs)
      for (int step = 0; step < steps; ++step)
        least = std::min(least, flowing.strain(leg[0] / steps, leg[1] / steps, leg[2] / steps));
    CHECK(least >= -1e-16 * young);
    const double miss = std::abs(flowing.work - flowing.energy() - flowing.heat) / flowing.work;
    CHECK(miss < 10.0 / steps);
    if (last > 0) CHECK(miss < 0.6 * last);  // of first order
    last = miss;
  }
}

TEST_CASE("mu(I): the wave speed at rest is the fastest that yielding on the cone of mu_2 allows") {
  for (double limit : {0.3, 0.64, 3.0}) {
    const double k = std::max(limit, static_friction) * bulk / (std::sqrt(2.0) * shear);
    double largest = 0;  // of u (k - u) over the components -u of unit deviators
    for (int n = 0; n <= 100000; ++n) {
      const double u = n * 1e-5 * std::sqrt(2.0 / 3);
      largest = std::max(largest, u * (k - u));
    }
    const Particle<MuI> particle = grains(0, limit);
    const double speed = MuI::wave_speed(particle.constants, particle.state);
    CHECK(1500 * speed * speed == Approx(bulk + 4 * shear / 3 + 2 * shear * largest).epsilon(1e-9));
  }
}

TEST_CASE("mu(I): J from 1e-6 to 1e6, thin and long particles, and inverted ones") {
  for (double J : {1e-6, 1e-3, 1e3, 1e6}) {
    CAPTURE(J);
    Particle<MuI> particle = grains();
    const double third = std::cbrt(J) - 1;
    CHECK(particle.advance(diagonal(third, third, third)) >= -1e-14 * young);
    CHECK(particle.state.volume_ratio == Approx(J).epsilon(1e-12));
    CHECK(particle.p() == Approx(std::max(0.0, -bulk * std::log(J))).margin(1e-12 * bulk));
    CHECK(MuI::wave_speed(particle.constants, particle.state) > 0);
  }
  for (double stretch : {1e-6, 1e-2, 1e2, 1e6}) {
    CAPTURE(stretch);
    Particle<MuI> particle = grains();
    CHECK(particle.advance(diagonal(stretch - 1, 0, 0)) >= 0);
    CHECK(shear_stress(particle) <= limit_friction * std::max(particle.p(), 0.0) + 1e-9 * young);
  }
  Particle<MuI> inverted = grains();
  inverted.advance(diagonal(-2, 0, 0));
  CHECK_FALSE(inverted.state.volume_ratio > 0);
}

TEST_CASE("soils: around an axis the hoop stretches as the third axis of space does") {
  const MohrCoulomb::Constants<double> c({young, poisson, 1600, 30 * degree, 1e9, 0});  // elastic
  MohrCoulomb::AxisymmetricState<double> ring{Deformation<2, double>::identity(), 1};
  Particle<MohrCoulomb> space = soil(30, 1e9, 0);
  for (const auto& [x, shearing, hoop] : {std::array{0.1, 0.05, 0.3}, std::array{-0.05, 0.1, 0.2}}) {
    MohrCoulomb::advance(c, Deformation<2, double>{{{x, shearing, 0, 0}}, hoop}, 1.0, ring);
    space.advance({{x, shearing, 0, 0, 0, 0, 0, 0, hoop}});
  }
  CHECK(ring.elastic_deformation_gradient.zz == Approx(1.3 * 1.2).epsilon(1e-14));
  const Sym<2, double> around = MohrCoulomb::kirchhoff_stress(c, ring);
  for (int k = 0; k < 3; ++k) CHECK(around.s[k] == Approx(space.stress().s[k]).epsilon(1e-12));
  CHECK(around(0, 1) == Approx(space.stress()(0, 1)).epsilon(1e-12));
}

TEST_CASE(
    "soils: pressure makes longitudinal waves faster, by the least principal stress, and tension does not slow them") {
  const double at_rest = bulk + 4 * shear / 3;
  const auto modulus = [](double x, double y, double z) {
    const MohrCoulomb::Constants<double> c(
        {young, poisson, 1600, 30 * degree, 1e9, 30 * degree});  // elastic, associated
    const MohrCoulomb::State<3, double> state{{diagonal(std::exp(x), std::exp(y), std::exp(z))}, 1};
    const double speed = MohrCoulomb::wave_speed(c, state);
    return 1600 * speed * speed;
  };
  CHECK(modulus(-0.1, -0.1, -0.1) == Approx(at_rest + 0.3 * bulk).epsilon(1e-9));
  const Vec3 tau = elastic_stress({{-0.2, 0.05, 0.1}});
  CHECK(modulus(0.05, -0.2, 0.1) == Approx(at_rest - tau[0]).epsilon(1e-9));
  CHECK(modulus(0.1, 0.1, 0.1) == Approx(at_rest).epsilon(1e-9));
}
