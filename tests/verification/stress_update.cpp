// Dissipation and frequency of FLIP by the order of the stress update, exact for a periodic line with one particle a
// cell at cell centres and linear functions. The amplitude q of a mode follows
//   q(n + 2) = trace q(n + 1) - det q(n),   det = 1 - z^2 (1 - s2), trace = 2 - z^2        of USL
//                                           det = 1,               trace = 2 - s2 z^2      of USF and MUSL
//                         the mean of USL's and USF's                                        of USAVG
// with s2 = cos^2(theta / 2), z = 2 C sin(theta / 2): it shrinks by sqrt(det) a step and turns by the angle whose
// cosine is trace / (2 sqrt(det)). `ctest -V` shows what was found.
//
// USAVG on the grid's velocity u = S+ V and the scaled stress s: s* = s + z u / 2;  u+ = u - z s*;  s' = s* + z u+ / 2;
// u' = u - s2 z s*. Its determinant is 1 - z^2 (1 - s2) / 2, its trace 2 - z^2 (1 + s2) / 2. The amplitude's factor a
// step is 1 - C^2 theta^4 / 16 + O(theta^6): neutral to the third order in the wave number, and half of what USL takes
// beyond it; stable to z^2 <= 4.

#include <cstdio>
#include <vector>

#include "lattice.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

struct Wave {
  double trace, det;
};

Wave exact_wave(const std::string& update, int mode, double courant) {
  const double theta = 2 * std::numbers::pi * mode / 32;
  const double s2 = std::pow(std::cos(theta / 2), 2), z = 2 * courant * std::sin(theta / 2);
  if (update == "last") return {2 - z * z, 1 - z * z * (1 - s2)};
  if (update == "averaged") return {2 - z * z * (1 + s2) / 2, 1 - z * z * (1 - s2) / 2};
  return {2 - s2 * z * z, 1};
}

/// A scene with velocities of 1e-7 wave speeds: finite strain enters with that, relative.
LineScene line_scene(const std::string& backend, const std::string& update, int mode, double courant) {
  return LineScene(
      {.transfer = "flip", .stress_update = update, .backend = backend, .mode = mode, .time_step = courant},
      [mode](double x) { return 1e-7 * std::sin(2 * std::numbers::pi * mode * x / 32); });
}

/// The trace and determinant of `power` steps, from four amplitudes.
Wave found_wave(LineScene scene, int power) {
  double q[4];
  for (double& value : q) {
    value = scene.amplitude();
    scene.step(power);
  }
  const double minor = q[0] * q[2] - q[1] * q[1];
  return {(q[0] * q[3] - q[1] * q[2]) / minor, (q[1] * q[3] - q[2] * q[2]) / minor};
}

/// The number of steps that make about a radian: there the four amplitudes tell the wave best.
int radian(const Wave& wave) {
  return std::max(1, static_cast<int>(1 / std::acos(wave.trace / (2 * std::sqrt(wave.det)))));
}

}  // namespace

TEST_CASE("USL dissipates, USAVG half of it, USF and MUSL do not, and each has its frequency", "[stress_update]") {
  std::printf("Stress update: update, mode of 32 cells, C, factor a step (run, exact), radians a step (run, exact)\n");
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string update : {"last", "first", "modified_last", "averaged"})
      for (const int mode : {1, 2, 4, 8})
        for (const double courant : {0.25, 0.5}) {
          const Wave exact = exact_wave(update, mode, courant);
          const int power = radian(exact);
          const Wave found = found_wave(line_scene(backend, update, mode, courant), power);
          const double factor = std::pow(found.det, 0.5 / power), exact_factor = std::sqrt(exact.det);
          const double turn = std::acos(found.trace / (2 * std::sqrt(found.det))) / power;
          const double exact_turn = std::acos(exact.trace / (2 * exact_factor));
          if (backend == "cpu")
            std::printf("  %-13s %d %.2f  %.7f %.7f  %.6f %.6f\n", update.c_str(), mode, courant, factor, exact_factor,
                        turn, exact_turn);
          INFO(backend << " " << update << " mode " << mode << " C " << courant);
          CHECK(std::abs(factor - exact_factor) <= 1e-7);
          CHECK(turn == Approx(exact_turn).epsilon(1e-5));
        }
}

TEST_CASE("decay of a wave in numbers: 0.9992755 a step, 0.484 after 1000 steps of USL, 1 of MUSL and USF",
          "[stress_update]") {
  std::printf("Stress update: update, amplitude after 1000 steps, mode 2 of 32 cells, C = 0.5\n");
  REQUIRE(std::sqrt(exact_wave("last", 2, 0.5).det) == Approx(0.9992755).epsilon(1e-7));
  for (const std::string update : {"last", "first", "modified_last"}) {
    const Wave wave = exact_wave(update, 2, 0.5);
    // This form of two amplitudes shrinks by det a step, whatever the phase.
    const auto size = [&](LineScene& scene) {
      const double q0 = scene.amplitude();
      scene.step();
      const double q1 = scene.amplitude();
      return wave.det * q0 * q0 - wave.trace * q0 * q1 + q1 * q1;
    };
    LineScene scene = line_scene("cpu", update, 2, 0.5);
    const double before = size(scene);
    scene.step(999);
    const double amplitude = std::sqrt(size(scene) / before);
    std::printf("  %-13s %.4f\n", update.c_str(), amplitude);
    INFO(update << ": " << amplitude);
    CHECK(std::abs(amplitude - (update == "last" ? 0.484 : 1.0)) <= 1e-3);
    CHECK(amplitude == Approx(std::pow(wave.det, 500)).epsilon(1e-4));
  }
}
