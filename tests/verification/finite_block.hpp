#pragma once
// A block with ends on a slope of 30 degrees. Its weight grows over a tenth of a second, as let go of at once a soft block
// shakes and slips while it presses less.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/scene.hpp"

namespace mpm::test::finite_block {

inline const char* slope = R"J({
  "title": "finite block on a slope", "dimension": 2,
  "grid": {"cell_size": 0.05, "domain": [[-0.8, -1.4], [1.8, 0.8]], "boundaries": {"all": "free"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
  "contact": {"type": "coulomb", "friction": 0, "normal": "widest_gap"},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [
    {"name": "slope", "material": "m", "seeding": "fitted", "geometry": {"type": "turned", "angle": 0, "about": [0, 0],
      "of": {"type": "box", "lower": [-0.4, -0.3], "upper": [1.6, 0]}}},
    {"name": "block", "material": "m", "seeding": "fitted", "geometry": {"type": "turned", "angle": 0, "about": [0, 0],
      "of": {"type": "box", "lower": [0, 0], "upper": [0.4, 0.2]}}}],
  "grips": [{"name": "bed", "body": "slope", "velocity": [0, 0], "where": {"type": "turned", "angle": 0, "about": [0, 0],
      "of": {"type": "box", "lower": [-0.4, -0.3], "upper": [1.6, -0.15]}}}],
  "solver": {"time_step": "auto", "courant": 0.3, "end_time": 0.3}, "output": {"ledger": false}})J";

constexpr double g = 9.81, ramp = 0.1, degree = std::numbers::pi / 180;
inline const double sine = 0.5, cosine = std::sqrt(0.75);
inline double exact(double friction) {
  return g * (sine - friction * cosine);
}

/// The slope of 30 degrees, turned against the grid by so many.
inline std::vector<std::string> turned(double angle) {
  const double down = (30 - angle) * degree;
  const std::string grows = "*min(1, t/0.1)", minus = "\"-" + digits(angle) + " deg\"";
  return {"/gravity=[\"" + digits(g * std::sin(down)) + grows + "\", \"" + digits(-g * std::cos(down)) + grows + "\"]",
          set("/bodies/0/geometry/angle", minus), set("/bodies/1/geometry/angle", minus),
          set("/grips/0/where/angle", minus)};
}

struct Slide {
  double acceleration = 0;  ///< its speed along the slope over the time for which the weight has acted, m/s^2
  double speed = 0;         ///< m/s
};

inline Slide slide(double friction, double angle, std::vector<std::string> settings = {}, double start = 0) {
  std::vector<std::string> all = turned(angle);
  all.push_back(set("/contact/friction", digits(friction)));
  all.insert(all.end(), settings.begin(), settings.end());
  Scene scene(slope, all);
  scene.run();
  const BodyState block = scene.body(1);
  const int D = scene.experiment.dimension;
  Slide found;
  const double count = static_cast<double>(block.velocity.size()) / D;
  for (std::size_t k = 0; k < block.velocity.size(); k += static_cast<std::size_t>(D))
    found.speed +=
        (block.velocity[k] * std::cos(angle * degree) - block.velocity[k + 1] * std::sin(angle * degree)) / count;
  found.acceleration = (found.speed - start) / (scene.simulation.time() - ramp / 2);
  INFO(angle << " degrees, friction " << friction);
  CHECK(scene.simulation.backend().contact_record().momentum_residual < 1e-10);
  return found;
}

/// What the block's contact does while it is watched: the least and the largest force that presses, N, and the impulses
/// that press and rub, N s.
struct Pressed {
  double least = 1e9, most = 0, pressing = 0, rubbing = 0;
};
struct Rocking {
  Pressed early, late;  ///< from 0.15 to 0.25 s and from 0.3 to 0.4 s
};

/// A block half as high as it is long on a slope along the grid, with friction 0.5, which is close to sticking.
inline Rocking rock(const std::vector<std::string>& finer) {
  std::vector<std::string> settings = turned(0);
  settings.insert(settings.end(),
                  {set("/contact/friction", "0.5"), set("/transfer/type", "flip"), set("/solver/end_time", "0.4")});
  settings.insert(settings.end(), finer.begin(), finer.end());
  Scene scene(slope, settings);
  Rocking found;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    const Vector3& force = scene.simulation.backend().contact_record().force;  // on the slope
    const double time = scene.simulation.time(), dt = scene.simulation.last_time_step();
    if (time < 0.15 || (time > 0.25 && time < 0.3)) continue;
    Pressed& third = time < 0.25 ? found.early : found.late;
    third.least = smaller(third.least, -force[1]), third.most = larger(third.most, -force[1]);
    third.pressing -= force[1] * dt, third.rubbing += force[0] * dt;
  }
  return found;
}

/// Nothing, shorter steps and smaller cells.
inline const std::vector<std::vector<std::string>> refinements{
    {}, {set("/solver/courant", "0.1")}, {set("/grid/cell_size", "0.025")}};

}  // namespace mpm::test::finite_block
