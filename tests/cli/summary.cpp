// Numbers of summary.json against the laws that they obey.

#include <algorithm>
#include <cmath>

#include "cli/program.hpp"
#include "support/csv.hpp"

using namespace mpm::test;

TEST_CASE("the mean force of supports is what gravity and the change of momentum leave for them") {
  Json scene = ball();
  scene["materials"]["m"]["youngs_modulus"] = 1e5;
  scene["gravity"] = {3, -10};
  scene["bodies"][0]["geometry"]["centre"] = {0.6, 0.25};
  scene["bodies"][0]["velocity"] = {1, -1};
  scene["output"]["reactions"] = true;
  scene["solver"] = {{"time_step", 0.002}, {"end_time", 0.25}};
  const Folder folder;
  CHECK(run_scene(folder, scene).code == 0);
  const Json summary = json_in(folder / "run/summary.json");
  const double mass = summary["mass"], time = summary["simulated_time"];
  CHECK(time == Approx(0.25));
  const Json &momentum = summary["momentum"]["linear"], &supports = summary["reaction"];
  for (const auto& [axis, gravity] : {std::pair{"x", 3.0}, std::pair{"y", -10.0}}) {
    const double change = momentum["final"][axis].get<double>() - momentum["initial"][axis].get<double>();
    double mean = 0;
    for (const Json& support : supports) mean += support["mean_force"][axis].get<double>();
    INFO(axis << " " << mean);
    CHECK(std::abs(mean) > 10);
    CHECK(mean == Approx(change / time - mass * gravity).epsilon(1e-9));
  }
}

TEST_CASE("what PIC takes of a turning body's energy is its numerical loss") {
  Json scene = ball();
  scene["transfer"]["type"] = "pic";
  scene["bodies"][0]["velocity"] = {"-3*(y-0.5)", "3*(x-0.5)"};
  const Folder folder;
  CHECK(run_scene(folder, scene).code == 0);
  const Json total = json_in(folder / "run/summary.json")["energy"]["total"];
  const double lost = 1 - total["final_over_initial"].get<double>();
  CHECK(lost > 0.5);
  CHECK(total["numerical_loss"].get<double>() == Approx(lost).epsilon(0.01));
  CHECK(std::abs(total["unexplained_loss"].get<double>()) < 0.01 * lost);
}

TEST_CASE("the extremes of contact are those of its columns") {
  Json scene = two_balls();
  scene["output"] = {{"metrics_every", 1}};
  const Folder folder;
  CHECK(run_scene(folder, scene).code == 0);
  const Json contact = json_in(folder / "run/summary.json")["contact"];
  const auto table = mpm::support::read_csv(folder / "run/metrics.csv");
  const auto column = [&](const char* name) {
    const auto* values = table.find(name);
    REQUIRE(values != nullptr);
    return *values;
  };
  const auto largest = [](const std::vector<double>& values) {
    return *std::max_element(values.begin(), values.end());
  };
  CHECK(largest(column("largest penetration")) > 0);
  CHECK(contact["largest_penetration"].get<double>() == Approx(largest(column("largest penetration"))));
  CHECK(contact["most_nodes"].get<double>() == largest(column("contact nodes")));
  const std::vector<double> x = column("contact force x"), y = column("contact force y"), time = column("time");
  double force = 0, first = NAN;
  for (std::size_t row = 0; row < time.size(); ++row) {
    const double now = std::hypot(x[row], y[row]);
    if (std::isnan(first) && now > 0) first = time[row];
    force = larger(force, now);
  }
  CHECK(first > 0);
  CHECK(contact["first_time"].get<double>() == Approx(first));
  CHECK(contact["largest_force"].get<double>() == Approx(force));
}
