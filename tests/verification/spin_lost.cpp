// Where FLIP and XPIC lose spin. The case asks that ten turns cost APIC, FLIP and XPIC less than 1 %.
//
// What a step of FLIP and of XPIC on PIC takes, exactly, is in spin_balance.hpp: lumped masses take it, and the filter.
// What counts is the rim, where the centre c_i of the mass that node i holds lies inside of x_i. Nodes see a rigid turn
// w x r of the particles as w x c_i, the rim is strained, and its forces answer until S+ v is rigid: particles at the
// rim then run ahead. As the rim moves over cells this goes on. A filter sends the rim back at every step.
//
// A filter takes of a rigid turn r, without any force, d_m = <r, (I - S S+)^m r> / <r, r> a step, since S S+ is
// symmetric in the product weighted with mass. For PIC, with tr D = h^2/2, sum_i w_ip |x_i - x_p|^2 = tr D gives
//   d_1 = (M h^2/2 - sum_i m_i |c_i - x_i|^2) / sum_p m |x_p|^2,  h^2/R^2 of a disc but for its rim.

#include <cmath>
#include <numbers>

#include "spin_balance.hpp"
#include "spinning_disc.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double pi = std::numbers::pi, radius = 0.5, modulus = 9.869604401e6, poisson = 0.3;

const std::string pic = set("/transfer/type", "pic");

std::string xpic(int order) {
  return R"(/filter={"type": "xpic", "order": )" + std::to_string(order) + "}";
}

/// A scene of FLIP on a disc ten times as soft as the case's, unless `settings` say otherwise.
Scene spinning(const std::vector<std::string>& settings) {
  std::vector<std::string> all{set("/transfer/type", "flip"), set("/materials/m/youngs_modulus", digits(modulus))};
  all.insert(all.end(), settings.begin(), settings.end());
  return Scene(spinning_disc, all);
}

double kept_spin(const std::vector<std::string>& settings) {
  Scene scene = spinning(settings);
  return scene.run().angular_momentum[2] / scene.metrics.initial().angular_momentum[2];
}

}  // namespace

TEST_CASE("the spin that FLIP and XPIC lose is what lumped masses and the filter take", "[spin]") {
  std::printf("Spin, an eighth of a turn: change of spin by lumped masses, motion, filter | sum, the run's | gap\n");
  const auto balance = [](const std::string& name, std::vector<std::string> settings, int order) {
    settings.push_back(set("/solver/end_time", "0.125"));
    Scene scene = spinning(settings);
    const SpinBalance found = spin_balance(scene, modulus, poisson, order);
    check_balance(name, found);
    CHECK(found.change < 0);
    return found;
  };
  const SpinBalance flip = balance("flip", {set("/solver/courant", "0.4")}, 0),
                    quarter = balance("flip, dt/4", {set("/solver/courant", "0.1")}, 0);
  CHECK(std::abs(flip.motion) < 0.01 * std::abs(flip.lumping));
  CHECK(quarter.motion == Approx(flip.motion / 4).epsilon(0.2));
  CHECK(std::abs(quarter.lumping) > std::abs(flip.lumping));  // smaller steps do not help
  for (const int order : {2, 4, 8}) {
    const SpinBalance found = balance("xpic " + std::to_string(order), {pic, xpic(order)}, order);
    CHECK(std::abs(found.motion) < 1e-12);
    if (order >= 4) CHECK(std::abs(found.lumping) > 2 * std::abs(found.filter));
  }
}

TEST_CASE("what one step of a filter takes of a rigid turn", "[spin]") {
  std::printf(
      "Spin, share of the spin that a step takes: order; from the nodes' masses, the first step of XPIC and FMPM\n");
  const Vectors x = pairs(spinning({}).body().position);
  double before = 1;
  for (const int order : {1, 2, 4, 8, 16}) {
    const double taken = taken_of_turn(x, 0.05, order);
    std::printf("  %2d: %.6e", order, taken);
    for (const std::string type : {"xpic", "fmpm"}) {
      // The body is still unstrained: nothing but the filter acts.
      Scene scene = spinning({pic, R"(/filter={"type": ")" + type + R"(", "order": )" + std::to_string(order) + "}"});
      const double start = scene.metrics.initial().angular_momentum[2];
      const double lost = 1 - scene.run_steps(1).angular_momentum[2] / start;
      std::printf(" %.6e", lost);
      INFO(type << " " << order);
      CHECK(lost == Approx(taken).epsilon(1e-6).margin(1e-13));
    }
    std::printf("\n");
    CHECK(taken < before);
    if (order > 4) CHECK(before / taken == Approx(4).epsilon(0.15));  // the loss falls as 1/m^2 only
    before = taken;
  }
  // The loss of PIC follows the closed form, and is near h^2/R^2.
  const Nodes nodes(x, 0.05);
  double square = 0, rim = 0;
  for (const auto& place : x) square += place[0] * place[0] + place[1] * place[1];
  for (std::size_t i = 0; i < nodes.place.size(); ++i)
    rim += nodes.mass[i] *
           (std::pow(nodes.centre[i][0] - nodes.place[i][0], 2) + std::pow(nodes.centre[i][1] - nodes.place[i][1], 2));
  const double first = (static_cast<double>(x.size()) * 0.05 * 0.05 / 2 - rim) / square;
  CHECK(taken_of_turn(x, 0.05, 1) == Approx(first).epsilon(1e-10));
  CHECK(first == Approx(0.05 * 0.05 / (radius * radius)).epsilon(0.06));
}

// The case as written cannot hold for XPIC on PIC at every step: ten turns are 9e4 steps and more. Even were the disc
// rigid, 1 % would need d_m < 1e-7, and d_m falls only as 1/m^2; the lumped masses take more than the filter does.
TEST_CASE("XPIC at every step loses more than its filter takes of a rigid turn", "[spin]") {
  std::printf("Spin, XPIC on PIC: order; share of spin kept in a turn if the filter alone took it, kept, steps\n");
  const Vectors start = pairs(spinning({}).body().position);
  for (const int order : {4, 8}) {
    // The loss d_m hardly depends on how the disc lies on the grid; its mean is over angles, by symmetry up to an
    // eighth of a turn.
    double taken = 0;
    constexpr int angles = 6;
    for (int k = 0; k < angles; ++k) {
      const double angle = (k + 0.5) / angles * pi / 4, c = std::cos(angle), s = std::sin(angle);
      Vectors turned;
      for (const auto& x : start) turned.push_back({c * x[0] - s * x[1], s * x[0] + c * x[1]});
      const double here = taken_of_turn(turned, 0.05, order);
      taken += here / angles;
      CHECK(here == Approx(taken_of_turn(start, 0.05, order)).epsilon(0.05));
    }
    Scene scene = spinning({pic, xpic(order), set("/solver/courant", "0.4")});
    const Totals end = scene.run();
    const double kept = end.angular_momentum[2] / scene.metrics.initial().angular_momentum[2];
    const double rigid = std::pow(1 - taken, static_cast<double>(scene.simulation.steps()));
    std::printf("  %2d: %.4f %.4f, %ld\n", order, rigid, kept, scene.simulation.steps());
    CHECK(kept < rigid);
    CHECK(rigid < 0.99);
    CHECK(std::pow(rigid, 10) < 0.9);  // loss in ten turns
  }
}

TEST_CASE("FLIP loses less spin on finer cells and with more particles", "[spin]") {
  std::printf("Spin, FLIP: cells a diameter, particles a cell's edge; share of spin lost in half a turn\n");
  const auto lost = [](int cells, int particles) {
    const double loss = 1 - kept_spin({set("/grid/cell_size", digits(1.0 / cells)), set("/solver/end_time", "0.5"),
                                       set("/bodies/0/particles_per_cell_axis", std::to_string(particles))});
    std::printf("  %d, %d: %.3e\n", cells, particles, loss);
    return loss;
  };
  const double coarse = lost(20, 2), more = lost(20, 4), fine = lost(40, 2);
  CHECK(more < 0.004);
  CHECK(more < 0.5 * coarse);
  CHECK(fine < 0.25 * coarse);  // the loss is of second order at least
}

TEST_CASE("spinning disc: ten turns of a stiff one: APIC, XPIC on APIC and FLIP lose less than 1 %", "[spin][slow]") {
  std::printf("Spin, ten turns, density (w R)^2 / E = 1e-4: share of spin kept\n");
  const auto check = [](const char* name, std::vector<std::string> settings, double most_lost) {
    settings.push_back(set("/materials/m/youngs_modulus", digits(10 * modulus)));
    settings.push_back(set("/solver/end_time", "10"));
    const double kept = kept_spin(settings);
    std::printf("  %-28s %.10f\n", name, kept);
    INFO(name);
    CHECK(std::abs(kept - 1) < most_lost);
  };
  const std::string apic = set("/transfer/type", "apic");
  check("apic", {apic}, 1e-9);
  check("mls", {set("/transfer/type", "mls")}, 1e-9);
  // The filter's round trip is the transfer's own, which keeps rotations.
  check("apic, xpic 4", {apic, xpic(4)}, 0.01);
  // FLIP needs 40 cells a diameter and 3 x 3 particles a cell.
  check("flip, 40 cells, 3 x 3", {set("/grid/cell_size", "0.025"), set("/bodies/0/particles_per_cell_axis", "3")},
        0.01);
}
