// A solid cylinder on an incline of 30 degrees, from rest: it rolls with a = (2/3) g sin where friction holds it (mu above
// tan / 3), and slides with g (sin - mu cos) where it does not, turning with 2 mu g cos / R. The slope is aligned with the
// grid. `ctest -V` shows the tables.

#include <cmath>

#include "support/catch.hpp"
#include "support/page.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double g = 9.81, radius = 0.5;
const double sine = 0.5, cosine = std::sqrt(3.0) / 2;

/// The weight grows over many periods in which the wheel swings on its contact; let go of at once it bounces.
const char* wheel = R"J({
  "dimension": 2,
  "grid": {"cell_size": 0.05, "domain": [[0, -0.4], [2.4, 1.2]],
           "boundaries": {"x_min": "free", "x_max": "free", "y_min": "stick", "y_max": "free"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"}, "contact": {"type": "coulomb", "friction": 0.5},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 2e6, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [
    {"name": "ground", "material": "m", "geometry": {"type": "box", "lower": [0, -0.4], "upper": [2.4, 0]}},
    {"name": "wheel", "material": "m", "geometry": {"type": "ball", "centre": [0.7, 0.5], "radius": 0.5}}],
  "body_force": ["4.905*(0.5*(1-cos(pi*t/0.4))*(t<0.4)+(t>=0.4))", "-8.495709211*(0.5*(1-cos(pi*t/0.4))*(t<0.4)+(t>=0.4))"],
  "solver": {"end_time": 0.9}, "output": {"ledger": false}})J";

/// Slopes of the least-squares lines, from the full weight on, through the wheel's velocity along the slope and through the
/// speed of its rim, m/s^2.
struct Rolling {
  double acceleration = 0, spin_up = 0;
};

/// Speed of the rim: angular momentum about the centre of mass over that of a solid cylinder, m R^2 / 2, times R.
std::pair<double, double> speeds(const BodyState& state) {
  const std::size_t count = state.position.size() / 2;
  double x[2]{}, v[2]{}, spin = 0;
  for (std::size_t k = 0; k < 2 * count; ++k) {
    x[k % 2] += state.position[k] / static_cast<double>(count);
    v[k % 2] += state.velocity[k] / static_cast<double>(count);
  }
  for (std::size_t p = 0; p < count; ++p)
    spin += (state.position[2 * p] - x[0]) * state.velocity[2 * p + 1] -
            (state.position[2 * p + 1] - x[1]) * state.velocity[2 * p];
  return {v[0], -spin / static_cast<double>(count) / (0.5 * radius)};
}

double slope(const std::vector<double>& t, const std::vector<double>& y) {
  double mean_t = 0, mean_y = 0, above = 0, below = 0;
  for (std::size_t k = 0; k < t.size(); ++k)
    mean_t += t[k] / static_cast<double>(t.size()), mean_y += y[k] / static_cast<double>(t.size());
  for (std::size_t k = 0; k < t.size(); ++k)
    above += (t[k] - mean_t) * (y[k] - mean_y), below += (t[k] - mean_t) * (t[k] - mean_t);
  return above / below;
}

Rolling roll(const std::vector<std::string>& settings) {
  Scene scene(wheel, settings);
  std::vector<double> times, velocities, rims;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    if (scene.simulation.time() < 0.4 || scene.simulation.steps() % 20 != 0) continue;
    const auto [velocity, rim] = speeds(scene.body(1));
    times.push_back(scene.simulation.time()), velocities.push_back(velocity), rims.push_back(rim);
  }
  return {slope(times, velocities), slope(times, rims)};
}

/// Runs both cases; `within` is a share of the exact accelerations, `seen` the share of the spin that is in the velocities.
void check_both(const std::string& name, std::vector<std::string> settings, double within, double seen = 1) {
  settings.push_back(set("/contact/friction", "0.5"));
  const Rolling rolls = roll(settings);
  settings.back() = set("/contact/friction", "0.15");
  const Rolling slips = roll(settings);
  std::printf("  %-24s %.4f %.4f | %.4f %.4f\n", name.c_str(), rolls.acceleration, rolls.spin_up, slips.acceleration,
              slips.spin_up);
  INFO(name);
  CHECK(rolls.acceleration == Approx(3.27).epsilon(within));
  CHECK(rolls.spin_up == Approx(3.27 * seen).epsilon(within));
  CHECK(slips.acceleration == Approx(3.63064362).epsilon(within));
  CHECK(slips.spin_up == Approx(2.548713 * seen).epsilon(within));
}

void print_head() {
  std::printf(
      "Wheel on an incline (m/s^2): friction 0.5, a and alpha R | 0.15, a and alpha R\n  %-24s %.4f %.4f | %.4f %.4f\n",
      "exact", 3.27, 3.27, 3.63064362, 2.548713);
}

std::vector<std::string> grid(const std::string& cell, const std::string& particles) {
  return {set("/grid/cell_size", cell), set("/bodies/0/particles_per_cell_axis", particles),
          set("/bodies/1/particles_per_cell_axis", particles)};
}

}  // namespace

TEST_CASE("the accelerations of a wheel on an incline follow from friction and inertia", "[friction][rolling]") {
  CHECK(2 * g * sine / 3 == Approx(3.27).epsilon(1e-9));
  CHECK(g * (sine - 0.15 * cosine) == Approx(3.63064362).epsilon(1e-8));
  CHECK(2 * 0.15 * g * cosine == Approx(2.548713).epsilon(1e-6));
  CHECK(sine / cosine / 3 > 0.15);  // slips
  CHECK(sine / cosine / 3 < 0.5);   // rolls
}

TEST_CASE("a wheel on an incline rolls with two thirds of g sin, or slips", "[friction][rolling]") {
  print_head();
  check_both("flip, 4 a cell and axis", grid("0.05", "4"), 0.025);
}

TEST_CASE("a wheel of finer particles rolls more exactly", "[friction][rolling][slow]") {
  print_head();
  check_both("flip, 2 a cell and axis", grid("0.05", "2"), 0.06);
  std::vector<std::string> apic = grid("0.05", "4");
  apic.push_back(set("/transfer/type", "apic"));
  // The affine velocities hold 2 D omega a mass, h^2 / 2 of R^2 / 2.
  check_both("apic, 4 a cell and axis", apic, 0.025, 1 / (1 + 0.05 * 0.05 / (radius * radius)));
  check_both("flip, half the cells", grid("0.025", "2"), 0.025);
}

// The force of a slipping wheel is what is missing of m g sin, and the arm is I alpha over it: both tend to those of a
// wheel that touches at its rim. The numbers of docs/contact.md.
TEST_CASE("friction on a wheel has the right size on coarser grids than the right arm",
          "[friction][rolling][docs][slow]") {
  const Page page("docs/contact.md");
  struct Row {
    const char *cells, *cell_size, *particles;
  };
  for (const Row& row :
       {Row{"5", "0.1", "2"}, {"5", "0.1", "4"}, {"10", "0.05", "2"}, {"10", "0.05", "4"}, {"20", "0.025", "2"}}) {
    INFO(row.cells << " cells a radius, " << row.particles << " particles");
    const auto printed = page.read("| " + std::string(row.cells) + " | " + row.particles + " | # | # |");
    std::vector<std::string> settings = grid(row.cell_size, row.particles);
    settings.push_back(set("/contact/friction", "0.15"));
    const Rolling slips = roll(settings);
    const double force = g * sine - slips.acceleration, arm = slips.spin_up / 2 / force;
    CHECK(force / (0.15 * g * cosine) == printed[0].rounded());
    CHECK(arm == printed[1].rounded());
  }
}

TEST_CASE("shorter steps do not bring back the spin that a wheel lacks", "[friction][rolling][docs][slow]") {
  const auto printed = Page("docs/contact.md").read("spin #, #, # and # % low at `courant` 0.4, 0.2, 0.1 and 0.05");
  std::size_t k = 0;
  for (const char* courant : {"0.4", "0.2", "0.1", "0.05"}) {
    INFO(courant);
    std::vector<std::string> settings = grid("0.05", "2");
    settings.insert(settings.end(), {set("/contact/friction", "0.15"), set("/solver/courant", courant)});
    CHECK(100 * (1 - roll(settings).spin_up / 2.548713) == printed[k++].rounded());
  }
}
