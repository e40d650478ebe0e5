// The recorded contact force, integrated over an impact, is the momentum that the bodies exchanged: Newton's third law
// and the balance of momentum, which no transfer, filter or order of the updates may change.

#include <algorithm>
#include <cmath>

#include "simulation/contact_impulse.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A ball runs into a spinning box with friction, in free space.
std::string impact(int dimension) {
  const bool flat = dimension == 2;
  return R"J({"title": "impact", "dimension": )J" + std::to_string(dimension) + R"J(, "precision": "double",
  "grid": {"cell_size": 0.1, "domain": )J" +
         (flat ? "[[-0.6, -0.6], [1.6, 1.4]]" : "[[-0.6, -0.6, -0.6], [1.6, 1.4, 1.2]]") +
         R"J(, "boundaries": {"all": "free"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
  "contact": {"type": "coulomb", "friction": 0.3},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [
    {"name": "ball", "material": "m", "geometry": {"type": "ball", "centre": )J" +
         (flat ? R"J([0.31, 0.43], "radius": 0.2}, "velocity": [1.2, 0.3]})J"
               : R"J([0.31, 0.43, 0.3], "radius": 0.15}, "velocity": [1.2, 0.3, 0.1]})J") +
         R"J(,
    {"name": "box", "material": "m", "geometry": {"type": "box", "lower": )J" +
         (flat ? R"J([0.52, 0.2], "upper": [0.81, 0.6]}, "velocity": ["-y", "x-0.6"]})J"
               : R"J([0.47, 0.3, 0.2], "upper": [0.66, 0.55, 0.41]}, "velocity": ["-y", "x-0.6", 0]})J") +
         R"J(],
  "solver": {"time_step": 0.009, "end_time": 0.2}})J";
}

struct Exchange {
  Vector3 of_force{}, of_particles{};  ///< kg m/s, given to the ball
  double distance() const {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) sum += std::pow(of_force[c] - of_particles[c], 2);
    return std::sqrt(sum);
  }
  double size() const { return std::hypot(of_particles[0], of_particles[1], of_particles[2]); }
};

Vector3 momentum_of_ball(const Scene& scene) {
  const BodyState state = scene.body(0);
  const auto D = static_cast<std::size_t>(scene.experiment.dimension);
  Vector3 sum{};
  for (std::size_t k = 0; k < state.velocity.size(); ++k) sum[k % D] += state.mass * state.velocity[k];
  return sum;
}

Exchange exchange(int dimension, const std::vector<std::string>& overrides) {
  Scene scene(impact(dimension), overrides);
  const Vector3 start = momentum_of_ball(scene);
  Exchange result;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    for (std::size_t c = 0; c < 3; ++c)
      result.of_force[c] += scene.simulation.last_time_step() * scene.simulation.backend().contact_record().force[c];
  }
  const Vector3 end = momentum_of_ball(scene);
  for (std::size_t c = 0; c < 3; ++c) result.of_particles[c] = end[c] - start[c];
  return result;
}

}  // namespace

TEST_CASE("the recorded contact force integrates to the momentum that the bodies exchanged",
          "[contact][contact_force]") {
  const std::vector<std::string> filters{"",
                                         R"({"type": "fmpm", "order": 2})",
                                         R"({"type": "fmpm", "order": 4})",
                                         R"({"type": "fmpm", "order": 4, "constraints": "kept_impulses"})",
                                         R"({"type": "fmpm", "order": 4, "constraints": "at_end"})",
                                         R"({"type": "fmpm", "order": 3, "every_steps": 3})",
                                         R"({"type": "xpic", "order": 3})"};
  int tried = 0, refused = 0;
  for (const std::string backend : {"reference", "cpu"})
    for (const Plugin* transfer : plugins().of_kind(MPM_TRANSFER))
      for (const std::string update : {"last", "first", "averaged", "modified_last"})
        for (const std::string& filter : filters) {
          std::vector<std::string> overrides{set("/backend", backend),
                                             set("/transfer/type", std::string(transfer->id())),
                                             set("/solver/stress_update", update)};
          if (!filter.empty()) overrides.push_back("/filter=" + filter);
          INFO(backend << " " << transfer->id() << " " << update << " " << filter);
          try {
            const Exchange found = exchange(2, overrides);
            CHECK(found.size() > 10);
            CHECK(found.distance() < 1e-11 * found.size());
            ++tried;
          } catch (const InputError&) {
            ++refused;
          }
        }
  CHECK(tried > 300);
  CHECK(refused < 125);
}

TEST_CASE("so it does in 3-D and with a weld", "[contact][contact_force]") {
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string transfer : {"apic", "flip"})
      for (const std::string contact : {R"({"type": "coulomb", "friction": 0.3})", R"({"type": "stick"})"}) {
        INFO(backend << " " << transfer << " " << contact);
        const Exchange found =
            exchange(3, {set("/backend", backend), set("/transfer/type", transfer), "/contact=" + contact});
        CHECK(found.size() > 1);
        CHECK(found.distance() < 1e-11 * found.size());
      }
}

TEST_CASE("shares of a blended transfer add up to one", "[contact][contact_force]") {
  const GatherShares shares =
      gather_shares(experiment_from(impact(2), {R"(/transfer={"type": "flip", "pic_fraction": 0.25})"}));
  CHECK(shares.of_velocity == Approx(0.25).epsilon(1e-15));
  CHECK(shares.of_increment == Approx(0.75).epsilon(1e-15));
}
