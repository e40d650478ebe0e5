#pragma once
// A periodic line of particles on one row of cells: the layout of damping, null space, critical step and stress update,
// whose factors and limits are exact.

#include <functional>
#include <numbers>

#include "support/larger.hpp"
#include "support/scene.hpp"

namespace mpm::test {

/// A line of particles; `transfer` is an id, or an object with parameters.
struct Line {
  std::string shape = "linear", transfer = "pic", filter = {}, stress_update = "last", backend = "reference";
  int cells = 32, particles_per_cell = 1, mode = 1;
  double offset = 0;         ///< cells by which the lattice is moved along the line
  double jitter = 0;         ///< largest shift of a particle, cells: couples modes that a perfect lattice keeps apart
  double time_step = 1e-13;  ///< s; with unit cells and unit wave speed, also the Courant number
  double pic_fraction = 0;   ///< pic_fraction of flip
  double youngs_modulus = 1;
  bool frozen = false;
};

/// The scene of a line. Wave speed, cell size and density are one. It is periodic across the line too: both rows of
/// nodes are one, so that no shear across it, with a limit of its own, can grow out of rounding. Velocities are those
/// of the mode, or what `velocity` gives of the place on the line before the offset.
class LineScene {
 public:
  explicit LineScene(const Line& line, const std::function<double(double)>& velocity = {})
      : line_(line),
        experiment_(experiment_from(text(line))),
        simulation_(experiment_, [&](const Experiment& e, const Plan& p, std::vector<SeededBody> bodies) {
          SeedArrays seeds = bodies[0].arrays();
          for (std::size_t k = 0; k < bodies[0].count(); ++k) {
            const double x = seeds.position[2 * k];
            seeds.velocity[2 * k] = velocity ? velocity(x) : mode(x);
            seeds.position[2 * k] =
                std::fmod(x + line.offset + line.jitter * std::sin(1e4 * std::sin(7.7 * x)), line.cells);
          }
          bodies[0].replace(std::move(seeds));
          return backend_factory(1)(e, p, std::move(bodies));
        }) {}

  void step(long count = 1) {
    for (long k = 0; k < count; ++k) simulation_.step();
  }
  std::vector<double> velocities() const {
    const BodyState state = simulation_.backend().body_state(0);
    std::vector<double> v;
    for (std::size_t k = 0; k < state.velocity.size(); k += 2) v.push_back(state.velocity[k]);
    return v;
  }
  /// The particles' places on the line, cells from its start.
  std::vector<double> places() const {
    const BodyState state = simulation_.backend().body_state(0);
    std::vector<double> x;
    for (std::size_t k = 0; k < state.position.size(); k += 2) x.push_back(state.position[k]);
    return x;
  }
  /// The particles' strains along the line, F - 1.
  std::vector<double> strains() const {
    const auto F = simulation_.backend().body_state(0).material_state.at("deformation_gradient");
    std::vector<double> strain;
    for (std::size_t k = 0; k < F.size(); k += 4) strain.push_back(F[k] - 1);
    return strain;
  }
  /// The amplitude sum v sin(2 pi mode x / length).
  double amplitude() const {
    const BodyState state = simulation_.backend().body_state(0);
    double sum = 0;
    for (std::size_t k = 0; k < state.velocity.size(); k += 2)
      sum += state.velocity[k] * mode(state.position[k] - line_.offset);
    return sum;
  }
  double largest_speed() const {
    double largest = 0;
    for (const double v : velocities()) largest = larger(largest, std::abs(v));
    return largest;
  }

  /// The largest of velocity over wave speed and of strain: the shortest wave shows in strains only.
  double largest_disturbance() const {
    double largest = largest_speed();
    for (const double strain : strains()) largest = larger(largest, std::abs(strain));
    return largest;
  }

 private:
  double mode(double x) const { return std::sin(2 * std::numbers::pi * line_.mode * x / line_.cells); }
  static std::string transfer_of(const Line& line) {
    if (line.transfer[0] == '{') return line.transfer;
    return "{\"type\": \"" + line.transfer + "\"" +
           (line.pic_fraction > 0 ? ", \"pic_fraction\": " + digits(line.pic_fraction) : "") + "}";
  }
  static std::string text(const Line& line) {
    const std::string length = std::to_string(line.cells);
    return R"({"dimension": 2, "backend": ")" + line.backend + R"(", "grid": {"cell_size": 1, "domain": [[0, 0], [)" +
           length +
           R"(, 1]], "boundaries": {"x_min": "periodic", "x_max": "periodic", "y_min": "periodic", "y_max": "periodic"}},
      "shape": {"type": ")" +
           line.shape + R"("}, "transfer": )" + transfer_of(line) + "," +
           (line.filter.empty() ? "" : "\"filter\": " + line.filter + ",") + R"(
      "materials": {"m": {"type": "linear_elastic", "youngs_modulus": )" +
           digits(line.youngs_modulus) + R"(, "poisson_ratio": 0, "density": 1}},
      "bodies": [{"name": "line", "material": "m", "particles_per_cell_axis": )" +
           std::to_string(line.particles_per_cell) + R"(, "frozen": )" + (line.frozen ? "true" : "false") +
           R"(, "geometry": {"type": "box", "lower": [0, 0], "upper": [)" + length + R"(, 1]}}],
      "solver": {"stress_update": ")" +
           line.stress_update + R"(", "time_step": )" + digits(line.time_step) +
           R"(, "end_time": 1e9}, "output": {"ledger": false}})";
  }

  Line line_;
  Experiment experiment_;
  Simulation simulation_;
};

/// The factor on the velocity of a mode in one step. The first step brings affine velocities to the mode's own.
inline double factor(const Line& line) {
  LineScene scene(line);
  scene.step();
  const double before = scene.amplitude();
  scene.step();
  return scene.amplitude() / before;
}

/// The `filter` of an experiment as JSON.
inline std::string filter(const std::string& type, int order) {
  return R"({"type": ")" + type + R"(", "order": )" + std::to_string(order) + "}";
}

/// The shapes of `names` that this build has: tables also name shapes that a build may lack.
inline std::vector<std::string> shapes_present(const std::vector<std::string>& names) {
  std::vector<std::string> found;
  for (const std::string& name : names)
    if (plugins().find(MPM_SHAPE, name) != nullptr) found.push_back(name);
  return found;
}

}  // namespace mpm::test
