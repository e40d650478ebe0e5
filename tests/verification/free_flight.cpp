// Free flight of every shape, transfer and filter that the build has, in two and three dimensions: flight under gravity
// through 20 cells with v = v0 + g n dt, x = x0 + v0 t + g t (t + dt) / 2, F = I, and domains as they were. `ctest -V`
// shows the table. Every order of the stress update is in free_fall.cpp, node_lists.cpp and filters.cpp.

#include <cstdio>

#include "support/catch.hpp"
#include "support/differences.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double dt = 0.002, velocity[3] = {8, 2, -1}, gravity[3] = {0, -9.81, 1}, speed = 8, cell = 0.1;
constexpr int steps = 125;
static_assert(speed * dt * steps >= 20 * cell);

std::string flight(int dimension) {
  const bool flat = dimension == 2;
  return R"({"title": "flight", "dimension": )" + std::to_string(dimension) +
         R"(, "precision": "double", "backend": "reference", "grid": {"cell_size": 0.1, "domain": )" +
         (flat ? "[[0, 0], [4, 2]]" : "[[0, 0, 0], [3, 1, 1]]") +
         R"(, "boundaries": {"all": "free"}}, "shape": {"type": "linear"}, "transfer": {"type": "pic"},
      "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e3, "poisson_ratio": 0.3, "density": 1000}},
      "bodies": [{"name": "ball", "material": "m", "geometry": {"type": "ball", )" +
         (flat ? R"("centre": [0.6, 1], "radius": 0.23}, "velocity": [8, 2]}], "gravity": [0, -9.81])"
               : R"("centre": [0.4, 0.4, 0.6], "radius": 0.11}, "velocity": [8, 2, -1]}], "gravity": [0, -9.81, 1])") +
         R"(, "solver": {"time_step": 0.002, "end_time": 0.25}, "output": {"ledger": false}})";
}

struct Errors {
  double position = 0, velocity = 0, momentum = 0;  ///< all relative; velocity and momentum to the speed
  double deformation = 0, domain = 0;               ///< error of F; error of a domain's sides or corners over its size
};

/// The largest difference over the largest expected entry.
double relative(const std::vector<double>& found, const std::vector<double>& expected) {
  double size = 0;
  for (const double value : expected) size = larger(size, std::abs(value));
  return largest_difference(found, expected) / size;
}

Errors errors_of(Scene& scene) {
  const BodyState before = scene.body();
  const Totals start = scene.metrics.initial(), end = scene.run_steps(steps);
  const BodyState after = scene.body();
  const std::size_t D = scene.experiment.dimension;
  const double t = steps * dt;
  std::vector<double> v = before.velocity, ratio = after.position, F = after.material_state.at("deformation_gradient");
  const std::vector<double> ones(ratio.size(), 1);
  for (std::size_t k = 0; k < v.size(); ++k) {
    const std::size_t c = k % D;
    ratio[k] /= before.position[k] + velocity[c] * t + gravity[c] * t * (t + dt) / 2;
    v[k] += gravity[c] * t;
  }
  std::vector<double> identity(F.size(), 0), momentum, expected;
  for (std::size_t k = 0; k < F.size(); ++k) identity[k] = k % (D * D) % (D + 1) == 0 ? 1 : 0;
  for (std::size_t c = 0; c < D; ++c) {
    momentum.push_back(end.momentum[c] - start.momentum[c]);
    expected.push_back(start.mass * gravity[c] * t);
  }
  Errors e{.position = largest_difference(ratio, ones),
           .velocity = relative(after.velocity, v),
           .momentum = largest_difference(momentum, expected) / (speed * start.mass),
           .deformation = largest_difference(F, identity)};
  if (!before.domain.empty()) e.domain = relative(after.domain, before.domain);
  if (!before.corners.empty()) e.domain = relative(after.corners, before.corners);
  return e;
}

/// Whether a transfer adds the grid's increments: a filter can then act periodically only.
bool takes_increments(const Plugin& transfer) {
  return transfer.transfer().traits & MPM_GATHERS_INCREMENT;
}

/// All transfers, each as the value of /transfer, with the whole basis of PolyPIC beside the default.
std::vector<std::pair<const Plugin*, std::string>> all_transfers() {
  std::vector<std::pair<const Plugin*, std::string>> all;
  for (const Plugin* transfer : plugins().of_kind(MPM_TRANSFER)) {
    const std::string id(transfer->id());
    all.emplace_back(transfer, "{\"type\": \"" + id + "\"}");
    if (id == "polypic") all.emplace_back(transfer, R"({"type": "polypic", "basis": "full"})");
  }
  return all;
}

/// Whether a pair is refused: products of polynomials need nodes along axes, their powers all of a stencil's nodes.
bool is_refused(const std::string& shape, const std::string& transfer) {
  if (transfer.find("polypic") == transfer.npos) return false;
  return shape.find("cpdi") == 0 || (transfer.find("full") != transfer.npos && shape.find("gimp") != shape.npos);
}

struct Count {
  int flown = 0, refused = 0;
  bool operator==(const Count&) const = default;
};

const char *fmpm = R"("type": "fmpm", "order": 4)", *xpic = R"("type": "xpic", "order": 3)";

void print_heading(const char* filters) {
  std::printf("Free flight, 20 cells, %s: relative errors of position, velocity, momentum; of F; of domains\n",
              filters);
}

/// Flies all pairs of shape and transfer on a backend, with a filter (its type and order) or none.
Count fly_all(int dimension, const std::string& backend, const std::string& filter) {
  Count count;
  for (const Plugin* shape : plugins().of_kind(MPM_SHAPE))
    for (const auto& [transfer, choice] : all_transfers()) {
      const std::string id(shape->id()), name = id + " " + choice + " " + filter;
      std::vector<std::string> words{set("/backend", backend), set("/shape/type", id), set("/transfer", choice)};
      if (!filter.empty())
        words.push_back("/filter={" + filter + (takes_increments(*transfer) ? R"(, "every_steps": 3})" : "}"));
      INFO(dimension << "-D " << backend << " " << name);
      if (is_refused(id, choice)) {
        CHECK_THROWS_AS(Scene(flight(dimension), words), InputError);
        ++count.refused;
        continue;
      }
      Scene scene(flight(dimension), words);
      const Errors e = errors_of(scene);
      if (backend == "cpu")
        std::printf("  %d-D %-72s %.1e %.1e %.1e  %.1e %.1e\n", dimension, name.c_str(), e.position, e.velocity,
                    e.momentum, e.deformation, e.domain);
      for (const double error : {e.position, e.velocity, e.momentum, e.domain}) CHECK(error <= 1e-12);
      CHECK(e.deformation <= steps * 1e-15);
      ++count.flown;
    }
  return count;
}

}  // namespace

TEST_CASE("free flight of every shape with every transfer", "[free_flight]") {
  print_heading("no filter");
  CHECK(fly_all(2, "cpu", "") == Count{73, 7});
  CHECK(fly_all(3, "cpu", "") == Count{73, 7});
  CHECK(fly_all(2, "reference", "") == Count{73, 7});
}

TEST_CASE("free flight of every shape with every transfer and FMPM", "[free_flight][filters]") {
  print_heading("FMPM(4), every third step with FLIP, AFLIP and ASFLIP");
  for (const int dimension : {2, 3}) CHECK(fly_all(dimension, "cpu", fmpm) == Count{73, 7});
}

TEST_CASE("free flight of every shape with every transfer and a filter on both backends",
          "[free_flight][filters][slow]") {
  print_heading("XPIC(3), every third step with FLIP, AFLIP and ASFLIP; the reference backend with FMPM(4) too");
  CHECK(fly_all(3, "reference", "") == Count{73, 7});
  for (const int dimension : {2, 3}) {
    for (const std::string backend : {"reference", "cpu"}) CHECK(fly_all(dimension, backend, xpic) == Count{73, 7});
    CHECK(fly_all(dimension, "reference", fmpm) == Count{73, 7});
  }
}
