// What `mpm bench` counts and compares with: the baseline solves the product's problem, the counter counts.

#include "bench/baseline.hpp"

#include "bench/costs.hpp"
#include "bench/measure.hpp"
#include "bench/table.hpp"
#include "kernel/counted.hpp"
#include "kernel/tensor.hpp"
#include "support/catch.hpp"
#include "support/differences.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::bench;

namespace {

/// A block in a corner, pressed into three (two) walls and sheared.
std::string block(int dimension) {
  const bool three = dimension == 3;
  const std::string z = three ? ", 0.1" : "";
  return std::string(R"({"dimension": )") + (three ? "3" : "2") +
         R"(, "precision": "double", "grid": {"cell_size": 0.1, "domain": [[0, 0)" + (three ? ", 0" : "") +
         R"(], [1, 1)" + (three ? ", 1" : "") + R"(]], "boundaries": {"all": "slip"}},
         "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "mls"},
         "materials": {"jelly": {"type": "neo_hookean", "youngs_modulus": 4e5, "poisson_ratio": 0.3, "density": 1000}},
         "bodies": [{"name": "block", "material": "jelly", "geometry": {"type": "box", "lower": [0.05, 0.1)" +
         z + R"(], "upper": [0.6, 0.5)" + (three ? ", 0.5" : "") + R"(]}, "velocity": ["-6-4*y", "3*x-8")" +
         (three ? R"(, "x*y-6")" : "") + R"(]}],
         "gravity": [0, -9.81)" +
         (three ? ", 2" : "") + R"(], "solver": {"time_step": 1e-3, "end_time": 10}, "output": {"ledger": false}})";
}

struct Sleeper final : Contender {
  explicit Sleeper(int cycle) : cycle(cycle) {}
  void step() override { ++steps; }
  std::size_t particle_count() const override { return 10; }
  int steps_a_cycle() const override { return cycle; }
  int cycle, steps = 0;
};

}  // namespace

TEST_CASE("the baseline solves the same problem as the cpu backend", "[bench]") {
  for (const int dimension : {2, 3}) {
    INFO(dimension << "-D");
    mpm::test::Scene scene(block(dimension));
    const auto baseline = make_baseline(scene.experiment);
    const std::vector<double> start = baseline->positions();
    CHECK(mpm::test::largest_difference(start, scene.body().position) < 1e-14);
    for (int step = 0; step < 30; ++step) {
      baseline->step();
      scene.simulation.step();
    }
    const BodyState state = scene.body();
    CHECK(mpm::test::largest_difference(start, state.position) > 0.1);  // a cell: particles crossed, walls pushed
    CHECK(mpm::test::largest_difference(baseline->positions(), state.position) < 1e-12);
    CHECK(mpm::test::largest_difference(baseline->velocities(), state.velocity) < 1e-10);
  }
}

TEST_CASE("the baseline in float stays near its double", "[bench]") {
  const Experiment exact = mpm::test::experiment_from(block(3));
  const Experiment single = mpm::test::experiment_from(block(3), {"/precision=float"});
  const auto a = make_baseline(exact), b = make_baseline(single);
  for (int step = 0; step < 20; ++step) a->step(), b->step();
  const double difference = mpm::test::largest_difference(a->positions(), b->positions());
  CHECK(difference > 0);
  CHECK(difference < 1e-5);
}

TEST_CASE("the baseline names what it cannot run", "[bench]") {
  const auto why = [](const std::string& edit) {
    return baseline_refusal(mpm::test::experiment_from(block(2), {edit}));
  };
  CHECK(baseline_refusal(mpm::test::experiment_from(block(2))).empty());
  CHECK(why("/shape/type=linear") == "it knows quadratic B-splines");
  CHECK(why("/transfer/type=pic") == "it knows MLS");
  CHECK(why("/solver/time_step=auto") == "it knows a fixed time step and USL");
  CHECK(why("/materials/jelly/form=split") == "it knows neo_hookean, coupled and logarithmic");
  CHECK(why("/grid/boundaries={\"all\":\"stick\"}") == "it knows slip walls");
  const Experiment wrong = mpm::test::experiment_from(block(2), {"/transfer/type=pic"});
  CHECK_THROWS_AS(make_baseline(wrong), std::invalid_argument);
}

TEST_CASE("the counter counts operations", "[bench]") {
  using S = Counted<float>;
  const S a = 1, b = 2, c = 3;
  CHECK(count_operations([&] { (void)((a + b) * c / b - sqrt(a)); }) == 5);
  CHECK(((a + b) * c / b - sqrt(a)).value == 3.5f);  // and computes
  S sum = a;
  CHECK(count_operations([&] { sum += b, sum -= a, sum *= c; }) == 3);
  CHECK(sum.value == 6);
  CHECK((-c).value == -3);
  CHECK((a <= b && a <= a && !(b <= a) && b >= a && b >= b && !(a >= b) && a == a && a != b));
  CHECK((min(a, b).value == 1 && min(b, a).value == 1 && max(a, b).value == 2 && max(b, a).value == 2));
  CHECK((abs(-c).value == 3 && floor(S(-0.5)).value == -1 && (b - c).value == -1 && (b / c).value == 2.0f / 3));
  // A count within another leaves that one as it was.
  CHECK(count_operations([&] { (void)(a + b), count_operations([&] { (void)(a * b + c * a); }), (void)(a - b); }) == 2);
  CHECK(count_operations([&] { (void)max(abs(-a), floor(b)); }) == 0);
  CHECK(count_operations([&] { (void)log(a); }) == 19);
  CHECK(count_operations([&] { (void)log(Counted<double>(1)); }) == 33);
  CHECK(count_operations([&] { (void)exp(a); }) == 28);
  CHECK(count_operations([&] { (void)exp(Counted<double>(1)); }) == 46);
  const Mat<3, S> M = Mat<3, S>::identity();
  CHECK(count_operations([&] { (void)(M * M); }) == 45);
  CHECK(count_operations([&] { (void)determinant(M); }) == 14);
  CHECK(count_operations([&] { (void)real<S>(0.5); }) == 0);
}

TEST_CASE("rows of the stencil cost what a hand count gives", "[bench]") {
  // Scatter, 3-D, 3 nodes, affine, lanes x y z and mass: a row 3 * 8 + 2 * 6; a plane 3 * (row + 4 + 6); 3 planes with
  // 4 + 3 + 6 each.
  CHECK(scatter_rows(3, 3, true, false) == 3 * (4 + 3 + 6 + 3 * (36 + 4 + 6)));
  CHECK(scatter_rows(2, 3, false, false) == 3 * (3 + 3 * 6));
  CHECK(gather_rows(3, 3, true, false) == 414);
  CHECK(gather_rows(2, 2, false, false) == 2 * (2 + 4 + 4));
  CHECK(scatter_rows(3, 4, true, false) > 2 * scatter_rows(3, 3, true, false));
}

TEST_CASE("operations and bytes of the standard combination", "[bench]") {
  const Experiment experiment = mpm::test::experiment_from(block(3), {"/precision=float"});
  const Plan plan = make_plan(experiment);
  const auto flops = flops_per_particle(experiment, plan, {0.5, true, {}, {}, false});
  REQUIRE(flops);
  // Neo-Hookean: (I + dt L) F 45 + 18, J 14, and in the stress b 30 + 3 (it starts as I), J 14, log 19,
  // lambda ln J - mu 2, mu b 6, + p 3.
  CHECK(flops->material == 45 + 18 + 14 + 30 + 3 + 14 + 19 + 2 + 6 + 3);
  CHECK(flops->transfer == 12);       // counts m v and m C
  CHECK(flops->shape == 2 * 3 * 12);  // two evaluations of 11 an axis and the offset
  CHECK(flops->grid == 0.5 * 4 * 3);
  CHECK(bytes_per_particle(experiment, plan, 0.5) == 2 * 4 * (3 + 9) + 2 * 0.5 * 32);  // counts x and F; v and C pass
  const Experiment ledger = mpm::test::experiment_from(block(3), {"/output/ledger=true"});
  CHECK_FALSE(flops_per_particle(ledger, make_plan(ledger), {0.5, true, {}, {}, false}));
}

TEST_CASE("the work of temperature is not known, so a scene that has one has no count of operations", "[bench]") {
  const std::vector<std::string> warm{R"(/materials/jelly/thermal={"conductivity": 1, "heat_capacity": 1000})",
                                      "/bodies/0/temperature=300", R"(/transfer/type="apic")"};
  const Experiment heated = mpm::test::experiment_from(block(2), warm);
  CHECK_FALSE(flops_per_particle(heated, make_plan(heated), {1, true, {}, {}, false}));
  const Experiment cold = mpm::test::experiment_from(block(2), {warm.back()});
  CHECK(flops_per_particle(cold, make_plan(cold), {1, true, {}, {}, false}));
}

TEST_CASE("each pass over the particles that a scene adds is counted", "[bench]") {
  const auto count = [](const std::vector<std::string>& overrides) {
    const Experiment experiment = mpm::test::experiment_from(block(2), overrides);
    const auto flops = flops_per_particle(experiment, make_plan(experiment), {1, true, {}, {}, false});
    REQUIRE(flops);
    return *flops;
  };
  const std::string flip = "/transfer/type=\"flip\"", apic = "/transfer/type=\"apic\"";
  const Flops last = count({apic});
  const Flops first = count({apic, "/solver/stress_update=\"first\""});
  const Flops modified = count({apic, "/solver/stress_update=\"modified_last\""});
  const Flops averaged = count({apic, "/solver/stress_update=\"averaged\""});
  CHECK(first.material == last.material);
  CHECK(averaged.material == 2 * last.material);
  CHECK(first.shape > last.shape);
  CHECK(first.shape - last.shape < averaged.shape - last.shape + 1);
  CHECK(modified.scatter > last.scatter);
  CHECK(averaged.total() > first.total());
  // A loop of the filter is a gather and a scatter of momentum: each pass adds the same.
  const Flops two = count({apic, R"(/filter={"type": "fmpm", "order": 2})"});
  const Flops four = count({apic, R"(/filter={"type": "fmpm", "order": 4})"});
  CHECK(two.gather - last.gather == (four.gather - last.gather) / 3);
  CHECK(four.scatter > two.scatter);
  CHECK(count({flip}).gather > 0);
}

TEST_CASE("sums of polynomials beyond affine cost what a hand count gives", "[bench]") {
  // In 2-D with 3 nodes and powers to 1, each line's 3 nodes give 2 powers, and these go into 2 * 2 products; x and y.
  CHECK(polynomial_sums(2, 3, 1) == 3 * (3 * 2 + 2 * 2) * 2 * 2);
  // In 3-D with 4 nodes and powers to 3 there are lines of 4 * 4, planes of 4 lines and 4 * 4 a line, 4^3 products a
  // plane.
  CHECK(polynomial_sums(3, 4, 3) == 4 * (4 * (4 * 4 + 4 * 4) + 64) * 2 * 3);
}

TEST_CASE("PolyPIC costs what APIC does and its polynomials", "[bench]") {
  const auto count = [](const std::string& transfer, const std::vector<std::string>& more = {}) {
    std::vector<std::string> overrides{"/transfer=" + transfer};
    overrides.insert(overrides.end(), more.begin(), more.end());
    const Experiment experiment = mpm::test::experiment_from(block(2), overrides);
    const auto flops = flops_per_particle(experiment, make_plan(experiment), {1, true, {}, {}, false});
    REQUIRE(flops);
    return *flops;
  };
  const std::string affine = R"({"type": "apic"})", two = R"({"type": "polypic"})";
  const std::string full = R"({"type": "polypic", "basis": "full"})";
  const Flops apic = count(affine), multilinear = count(two), quadratic = count(full);
  CHECK(multilinear.shape == apic.shape);
  CHECK(multilinear.transfer == apic.transfer);
  CHECK(multilinear.material == apic.material);
  // There is one product, x y. The bases of an axis take: P_0 of distances 3, w P 3, norm 6, moment 9, giving back 3;
  // P_1 as many, its recurrence 12 and two ratios.
  const double gather = 2 * (24 + 38) + polynomial_sums(2, 3, 1);
  CHECK(multilinear.gather - apic.gather == gather);
  CHECK(multilinear.scatter - apic.scatter == gather + 2);  // coefficients are taken times the mass
  CHECK(quadratic.gather - apic.gather > 6 * 2 * 3);
  CHECK(quadratic.gather > multilinear.gather);
  // Each pass of a filter's loop gathers and scatters them, MUSL scatters them once more.
  const std::vector<std::string> filter{R"(/filter={"type": "fmpm", "order": 3})"};
  const double passes = (count(two, filter).gather - count(affine, filter).gather) / gather;
  CHECK(passes == 3);
  const std::vector<std::string> modified{"/solver/stress_update=\"modified_last\""};
  CHECK(count(two, modified).scatter - count(affine, modified).scatter == 2 * (gather + 2));
}

TEST_CASE("CPDI2 costs its corners", "[bench]") {
  for (const int dimension : {2, 3})
    for (const std::string precision : {"float", "double"}) {
      INFO(dimension << "-D " << precision);
      const auto count = [&](const std::string& shape) {
        const Experiment experiment = mpm::test::experiment_from(
            block(dimension),
            {"/shape/type=\"" + shape + "\"", "/transfer/type=\"flip\"", "/precision=\"" + precision + "\""});
        const auto flops = flops_per_particle(experiment, make_plan(experiment), {1, true, {}, {}, false});
        REQUIRE(flops);
        return *flops;
      };
      const Flops cpdi = count("cpdi"), cpdi2 = count("cpdi2");
      // On squares and cubes both have the same nodes.
      CHECK(cpdi2.scatter == cpdi.scatter);
      CHECK(cpdi2.transfer == cpdi.transfer);
      CHECK(cpdi2.material == cpdi.material);
      CHECK(cpdi2.shape > cpdi.shape);
      // The corners take the velocity of their 2^D nodes and go there; CPDI's domain follows L.
      const int D = dimension, corners = 1 << D;
      CHECK(cpdi2.gather - cpdi.gather > corners * (corners * 2 * D + 5 * D) - D * D * (2 * D + 2));
    }
}

TEST_CASE("a ratio is the median of the rounds' ratios", "[bench]") {
  Rates rates;
  rates.by_contender = {{10, 20, 30, 40, 500}, {5, 10, 10, 20, 50}};
  CHECK(rates.rate(0) == 30);
  CHECK(rates.rate(1) == 10);
  CHECK(rates.ratio(0, 1) == 2);
  CHECK(median({4, 1, 2, 3}) == 2.5);
  CHECK(std::isnan(median({})));
}

TEST_CASE("contenders run the same number of rounds in whole cycles", "[bench]") {
  Sleeper a(7), b(1);
  const Rates rates = run_in_turns({&a, &b}, {5, 3, 1e-9, false, true});
  CHECK(rates.by_contender[0].size() == 5);
  CHECK(rates.by_contender[1].size() == 5);
  CHECK(rates.steps[0] % 7 == 0);
  CHECK(a.steps == 3 + 5 * rates.steps[0]);
  CHECK(b.steps == 3 + 5 * rates.steps[1]);
}

TEST_CASE("tables as text, CSV, Markdown and JSON", "[bench]") {
  const Table table{
      "t", "Title", {{"name", "name"}, {"rate", "rate (M/s)"}}, {{std::string("a,b"), 12.345}, {std::string("c"), {}}}};
  CHECK(table.text() == "Title\nname  rate (M/s)\na,b        12.35\nc              -\n");
  CHECK(table.csv() == "name,rate (M/s)\n\"a,b\",12.345000000000001\nc,\n");
  CHECK(table.markdown() == "| name | rate (M/s) |\n|---|---:|\n| a,b | 12.35 |\n| c | - |\n");
  CHECK(table.json().dump() == R"([{"name":"a,b","rate":12.345},{"name":"c"}])");
  CHECK_FALSE(Target{"x", "x", std::nan(""), 1, true}.held());
  CHECK(Target{"x", "x", 2, 1, true}.held());
  CHECK_FALSE(Target{"x", "x", 2, 1, false}.held());
}
