// Where a particle cannot go on, the reference and the cpu backend stop in the same step, at the same particle.

#include "parity/parity.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A box in a domain of 60 x 4 cells of 1 m that moves as it was thrown, without stress.
std::string thrown(const std::string& boundaries, const std::string& lower, const std::string& upper,
                   const std::string& velocity, const std::string& solver) {
  return R"({"title": "thrown", "dimension": 2, "grid": {"cell_size": 1, "domain": [[0, 0], [60, 4]],
    "boundaries": )" +
         boundaries + R"(}, "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"}, "materials":
    {"m": {"type": "neo_hookean", "youngs_modulus": 1e-9, "poisson_ratio": 0, "density": 1}},
    "bodies": [{"name": "b", "material": "m", "geometry": {"type": "box", "lower": )" +
         lower + ", \"upper\": " + upper + "}, \"velocity\": " + velocity + R"(}], "solver": )" + solver +
         R"(, "output": {"ledger": false}})";
}

struct Stop {
  Failure failure;
  long step;
};

/// What both backends stop with.
Stop stop_of(const std::string& text) {
  INFO(text);
  std::vector<Stop> stops;
  for (const std::string backend : {"reference", "cpu"}) {
    Scene scene(text, {set("/backend", backend), "/precision=double"});
    try {
      while (!scene.simulation.finished()) scene.simulation.step();
    } catch (const RunFailure& stopped) {
      stops.push_back({stopped.failure, scene.simulation.steps()});
    }
  }
  REQUIRE(stops.size() == 2);
  CHECK(stops[0].failure.cause == stops[1].failure.cause);
  CHECK(stops[0].failure.particle == stops[1].failure.particle);
  CHECK(stops[0].failure.axis == stops[1].failure.axis);
  const double value = stops[0].failure.value, other = stops[1].failure.value;
  if (std::isfinite(other))
    CHECK(value == Approx(other).epsilon(1e-9));
  else
    CHECK(!std::isfinite(value));
  CHECK(stops[0].step == stops[1].step);
  return stops[0];
}

}  // namespace

// A separating wall lets particles half a cell through. The face across from it does not: the particle that begins at
// 1.25 m from it and moves 0.1 m a step is beyond it after 13 steps.
TEST_CASE("a face lets through what its own condition says, not that of the face across", "[parity][failure]") {
  const std::string solver = R"({"time_step": 0.1, "end_time": 10})";
  for (const std::string open : {"x_min", "x_max"}) {
    const bool down = open == "x_min";
    const Stop stop = stop_of(thrown(R"({"all": "separate", ")" + open + R"(": "free"})", down ? "[1, 1]" : "[57, 1]",
                                     down ? "[3, 3]" : "[59, 3]", down ? "[-1, 0]" : "[1, 0]", solver));
    CHECK(stop.failure.cause == Cause::left_domain);
    CHECK(stop.failure.axis == 0);
    CHECK(stop.failure.value == Approx(down ? -0.05 : 60.05).epsilon(1e-9));
    CHECK(stop.step == 12);  // complete ones
  }
}

// Its velocity has a gradient that takes the first step's deformation beyond the largest number.
TEST_CASE("a deformation that is no number is told from one that is inside out", "[parity][failure]") {
  const std::string free = R"({"all": "free"})",
                    solver = R"({"time_step": 10, "end_time": 100, "stress_update": "first"})";
  CHECK(stop_of(thrown(free, "[1, 1]", "[3, 3]", R"(["5e307*x", 0])", solver)).failure.cause ==
        Cause::deformation_not_a_number);
  CHECK(stop_of(thrown(free, "[1, 1]", "[3, 3]", R"(["-5*x", 0])", solver)).failure.cause == Cause::inverted);
}

// Grips take particles along at 1 m/s, whatever the walls do. With cells of 0.5 m the nearest column begins at 1.125 m from
// the face and moves 0.1 m a step: half a cell through the wall lies between its steps 13 and 14.
TEST_CASE("a separating wall lets particles half a cell through, and no further", "[parity][failure]") {
  const std::string solver = R"({"time_step": 0.1, "end_time": 10})";
  for (const bool down : {true, false}) {
    const std::string grip = std::string(R"(, "grips": [{"body": "b", "velocity": )") + (down ? "[-1, 0]" : "[1, 0]") +
                             R"(, "where": {"type": "half_space", "point": [30, 10], "normal": [0, 1]}}]})";
    std::string text =
        thrown(R"({"all": "separate"})", down ? "[1, 1]" : "[57, 1]", down ? "[3, 3]" : "[59, 3]", "[0, 0]", solver);
    text.replace(text.rfind('}'), 1, grip);
    text.replace(text.find(R"("cell_size": 1)"), 14, R"("cell_size": 0.5)");
    const Stop stop = stop_of(text);
    CHECK(stop.failure.cause == Cause::left_domain);
    CHECK(stop.failure.axis == 0);
    CHECK(stop.failure.value == Approx(down ? -0.275 : 60.275).epsilon(1e-9));
    CHECK(stop.step == 13);  // complete ones
  }
}

// The other faces let through what rounding may make of a place: 1e-9 of the domain's 60 m, which is 6e-8 m.
TEST_CASE("a closed face lets particles through by rounding alone", "[parity][failure]") {
  for (const bool down : {true, false})
    for (const bool beyond : {false, true})
      for (const std::string backend : {"reference", "cpu"}) {
        INFO(backend << (down ? " down" : " up") << (beyond ? " beyond" : " within"));
        const std::string speed = beyond ? "12.50000075" : "12.50000045";  // 1.25 m and 7.5e-8 or 4.5e-8 m in a step
        const std::string grip = R"(, "grips": [{"body": "b", "velocity": [)" + (down ? "-" + speed : speed) +
                                 R"(, 0], "where": {"type": "half_space", "point": [30, 10], "normal": [0, 1]}}]})";
        std::string text = thrown(R"({"all": "free"})", down ? "[1, 1]" : "[57, 1]", down ? "[3, 3]" : "[59, 3]",
                                  "[0, 0]", R"({"time_step": 0.1, "end_time": 0.1})");
        text.replace(text.rfind('}'), 1, grip);
        Scene scene(text, {set("/backend", backend), "/precision=double"});
        if (beyond)
          CHECK_THROWS_AS(scene.simulation.step(), RunFailure);
        else
          CHECK_NOTHROW(scene.simulation.step());
      }
}

// Four nodes hold a box of two cells. Nodes that part at 0.99 (x - 30) m/s lengthen one of half a cell by 9.9 % in each
// step of 0.1 s, so that it is longer than two cells after 15 steps: 0.5 * 1.099^15 = 2.06.
TEST_CASE("a box that outgrows its stencil along either axis ends the run", "[parity][failure]") {
  for (const bool along_x : {true, false}) {
    const std::string domain = along_x ? "[[0, 0], [60, 4]]" : "[[0, 0], [4, 60]]";
    const std::string geometry =
        along_x ? R"("lower": [29, 1], "upper": [31, 3])" : R"("lower": [1, 29], "upper": [3, 31])";
    const std::string velocity = along_x ? R"J(["0.99*(x-30)", 0])J" : R"J([0, "0.99*(y-30)"])J";
    const std::string text = R"({"title": "apart", "dimension": 2, "grid": {"cell_size": 1, "domain": )" + domain +
                             R"(, "boundaries": {"all": "free"}}, "shape": {"type": "gimp_contiguous"},
      "transfer": {"type": "apic"}, "materials":
      {"m": {"type": "neo_hookean", "youngs_modulus": 1e-9, "poisson_ratio": 0, "density": 1}},
      "bodies": [{"name": "b", "material": "m", "geometry": {"type": "box", )" +
                             geometry + R"(}}], "node_conditions": [{"lower": [0, 0], "upper": )" +
                             (along_x ? "[60, 4]" : "[4, 60]") + R"(, "type": "prescribed", "velocity": )" + velocity +
                             R"(}], "solver": {"time_step": 0.1, "end_time": 10}, "output": {"ledger": false}})";
    for (const std::string backend : {"reference", "cpu"}) {
      INFO(backend << (along_x ? " along x" : " along y"));
      Scene scene(text, {set("/backend", backend), "/precision=double"});
      try {
        scene.run();
        FAIL("no particle has outgrown its stencil");
      } catch (const RunFailure& stopped) {
        CHECK(stopped.failure.cause == Cause::domain_outgrew_stencil);
        CHECK(scene.simulation.steps() == 15);  // complete ones
      }
    }
  }
}

// The body's left half is thrown inside out, its right half as it is, or both; melted is what is above 20 K.
TEST_CASE("the first particle that is inside out ends the run, whichever phase it is in", "[parity][failure]") {
  for (const std::string melted : {"left", "right"})
    for (const std::string inside_out : {"left", "right", "both"}) {
      INFO(melted << " has melted, inside out is " << inside_out);
      std::string text = thrown(R"({"all": "free"})", "[1, 1]", "[9, 3]",
                                inside_out == "both"   ? R"J(["-5*x", 0])J"
                                : inside_out == "left" ? R"J(["-5*min(x-5,0)", 0])J"
                                                       : R"J(["-5*max(x-5,0)", 0])J",
                                R"({"time_step": 0.5, "end_time": 10, "stress_update": "first"})");
      const std::string law = R"("density": 1)";
      text.replace(text.find(law), law.size(), law + R"(, "thermal": {"conductivity": 1e-9, "heat_capacity": 1,
        "phase_change": {"temperature": 20, "latent_heat": 1, "melted": {"youngs_modulus": 2e-9}}})");
      const std::string body = R"("material": "m")";
      text.replace(text.find(body), body.size(),
                   body + (melted == "left" ? R"J(, "temperature": "30-20*max(min(1e9*(x-5),1),0)")J"
                                            : R"J(, "temperature": "10+20*max(min(1e9*(x-5),1),0)")J"));
      const Stop stop = stop_of(text);
      CHECK(stop.failure.cause == Cause::inverted);
      Scene start(text, {"/backend=reference"});
      const double x = start.body().position[2 * stop.failure.particle];
      CHECK((inside_out == "right" ? x > 4 : x < 5));
      if (inside_out == "both") CHECK(stop.failure.particle == 0);
    }
}

// Of a row of eight particles, one a cell at 1.7, 2.7 and so on, the last moves at v = -3.94 m/s. The nodes at 8, 9 and 10
// get 0.32, 0.66/0.68 and 1 of that, and the last particle's gradient is (-0.8 * 0.32 + 0.6 * 0.66/0.68 + 0.2) v: in 0.5 s it
// turns inside out, and the one before it does not. By the mean dilation the last would keep some volume; no scale leads from
// one sign to the other, so that it is left its own.
TEST_CASE("the last particle that is inside out is named with its ratio of volumes", "[parity][failure]") {
  std::string text =
      thrown(R"({"all": "free"})", "[1.2, 1.5]", "[9.2, 2.5]", R"J(["-3.94*max(min(1e9*(x-8.6),1),0)", 0])J",
             R"({"time_step": 0.5, "end_time": 10, "stress_update": "first"})");
  const std::string body = R"("material": "m")", apic = R"("apic")";
  text.replace(text.find(body), body.size(), body + R"(, "particles_per_cell_axis": 1, "seeding": "fitted")");
  text.replace(text.find(apic), apic.size(), R"("pic")");
  std::string averaged = text;
  const std::string first = R"("stress_update": "first")";
  averaged.replace(averaged.find(first), first.size(), first + R"(, "dilation": "averaged")");
  for (const std::string& scene : {text, averaged}) {
    const Stop stop = stop_of(scene);
    CHECK(stop.failure.cause == Cause::inverted);
    CHECK(stop.failure.particle == 7);
    CHECK(stop.failure.value == Approx(1 - 1.97 * (-0.8 * 0.32 + 0.6 * 0.66 / 0.68 + 0.2)).epsilon(1e-9));
  }
}

TEST_CASE("a temperature beyond all numbers ends the run at its particle", "[parity][failure]") {
  std::string text = thrown(R"({"all": "free"})", "[1, 1]", "[3, 3]", "[0, 0]", R"({"time_step": 0.1, "end_time": 1})");
  const std::string law = R"("density": 1)", body = R"("material": "m")";
  text.replace(text.find(law), law.size(), law + R"(, "thermal": {"conductivity": 1, "heat_capacity": 1e9})");
  text.replace(text.find(body), body.size(), body + R"(, "temperature": 1e305)");
  const Stop stop = stop_of(text);
  CHECK(stop.failure.cause == Cause::temperature_not_a_number);
  CHECK(stop.failure.axis == -1);
}
