// Mohr-Coulomb on triaxial paths, on faces, edges and the apex; mu(I) rheology in shear at several rates. Stresses are
// Kirchhoff's.

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "conformance/soil_particle.hpp"
#include "materials/mohr_coulomb/mohr_coulomb.hpp"
#include "materials/mu_i/mu_i.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;
using namespace mpm::test::soils;

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
    for (const Vec3& n : normal) most = larger(most, HenckySolid::dot(n, tau) - strength);
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

// ---- mu(I) -------------------------------------------------------------------------------------------------------

constexpr double diameter = 1e-3, grain = 2450, static_friction = 0.38, limit_friction = 0.64, inertial = 0.279;

Particle<MuI> grains(double critical_density = 0, double limit = limit_friction) {
  return Particle<MuI>({young, poisson, 1500, diameter, grain, static_friction, limit, inertial, critical_density});
}
/// Presses from all sides to a pressure.
void press(Particle<MuI>& particle, double pressure) {
  particle.strain(-pressure / (3 * bulk), -pressure / (3 * bulk), -pressure / (3 * bulk));
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
    for (int i = 0; i < 3; ++i) worst = larger(worst, std::abs(tau.s[i] - exact[i]) / scale);
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
      most = larger(most, -HenckySolid::dot(x, Cm) * HenckySolid::dot(x, Cn) / 2);
      for (const Vec3& l : {Vec3{{0.5, 1.5, 1.5}}, Vec3{{0.5, 0.5, 1.5}}}) {
        const double bound = HenckySolid::dot(g, l) - s * trace_of_g * HenckySolid::sum(l);
        most = larger(most, HenckySolid::dot(x, l) * sum / bound - elastic);
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
      most = larger(most, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(symmetric).eigenvalues().maxCoeff());
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
  check_elastic_loop(elastic, 1e-4);
  double last = 0;
  for (int steps : {200, 400, 800}) {
    Particle<MuI> flowing = grains();
    flowing.dt = 0.02 / steps;
    const double legs[4][3] = {{-0.01, -0.01, -0.01}, {0.03, -0.03, 0}, {0.01, 0.005, -0.02}, {-0.02, 0.03, 0}};
    double least = 0;
    for (const auto& leg : legs)
      for (int step = 0; step < steps; ++step)
        least = smaller(least, flowing.strain(leg[0] / steps, leg[1] / steps, leg[2] / steps));
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
      largest = larger(largest, u * (k - u));
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
