// Temperature on the host-run device: against the reference backend, and against what no program is needed to know.

#include "device/device_support.hpp"
#include "parity/heat_scenes.hpp"
#include "support/heat_solutions.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Checks what check_on_device does, and the heat ledger too. Returns the reference's rows over its heat content.
std::vector<double> check_heat(const Mix& mix, const std::vector<std::string>& precisions = {"double"}) {
  if (!is_chosen_check()) return std::vector<double>(8, 1.0);
  INFO(mix.name());
  const std::string text = mix.text();
  Scene reference(text, on_reference(mix));
  const double content = heat_content(reference);
  while (!reference.simulation.finished()) reference.simulation.step();
  for (const std::string& precision : precisions) {
    INFO(precision);
    DeviceScene scene(text, precision, {}, mix.overrides);
    CHECK(std::abs(heat_content(scene) / content - 1) < 4 * epsilon_of(precision));
    scene.run();
    REQUIRE(scene.simulation.steps() == reference.simulation.steps());
    const double worst = std::max(scene_difference(reference, scene),
                                  difference(heat_ledger_values(reference), heat_ledger_values(scene), content)) /
                         epsilon_of(precision);
    CHECK(worst <= device_bound(mix));
  }
  std::vector<double> rows = heat_ledger_values(reference);
  for (double& row : rows) row /= content;
  return rows;
}

void prepare(const std::vector<Mix>& mixes, const std::string& precision = "double") {
  if (!makes_all_checks()) return;
  std::vector<device::Choice> choices;
  std::set<std::string> texts;
  for (const Mix& mix : mixes) {
    const device::Choice choice = device_choice_of(device_experiment(mix.text(), precision, mix.overrides));
    if (texts.insert(device::compose(choice).hash).second) choices.push_back(choice);
  }
  Programs::shared().prepare(choices);
}

/// A box of matter at rest that fills a domain of 0.8 m x 0.4 m.
std::string slab(const std::string& temperature, const std::string& walls, const std::string& more = "") {
  return R"({"dimension": 2, "grid": {"cell_size": 0.1, "domain": [[0, 0], [0.8, 0.4]], "boundaries": )" + walls +
         R"(}, "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"}, "materials": {"m": )" +
         material(elastic) + R"(}, "bodies": [{"name": "a", "material": "m", "temperature": ")" + temperature +
         R"(", "geometry": {"type": "box", "lower": [0, 0], "upper": [0.8, 0.4]}}])" + more +
         R"(, "solver": {"time_step": 0.005, "end_time": 0.2}})";
}

/// Runs every transfer that carries temperature with some shapes, as many of the list as are asked for, in turn.
void check_transfers(std::size_t shapes_each) {
  const std::vector<std::string> shapes{"bspline_quadratic", "linear", "bspline_cubic", "gimp", "cpdi"};
  const auto transfers = plugins().of_kind(MPM_TRANSFER);
  std::vector<Mix> mixes;
  std::set<std::string> accepted;
  for (std::size_t t = 0; t < transfers.size(); ++t)
    for (std::size_t k = 0; k < shapes_each; ++k) {
      Mix mix;
      mix.close = true, mix.shape = transfer_named(shapes[(t + k) % shapes.size()]);
      mix.transfer = device_choice(*transfers[t]);
      mix.boundaries = boundaries(2, "slip"), mix.stress_update = orders[mixes.size() % orders.size()];
      mix = warm(mix);
      if (!is_accepted(mix)) continue;
      accepted.insert(std::string(transfers[t]->id()));
      mixes.push_back(mix);
    }
  CHECK(accepted.size() + 2 == transfers.size());  // spins alone and polynomials are refused
  prepare(mixes);
  for (const Mix& mix : mixes) check_heat(mix);
}

}  // namespace

TEST_CASE("every transfer carries temperature on the host-run device as on the reference backend", "[device]") {
  check_transfers(2);
}

TEST_CASE("every transfer carries temperature on the host-run device with every kind of shape", "[device][slow]") {
  check_transfers(5);
}

TEST_CASE("temperature in three dimensions, around an axis and in float on the host-run device", "[device]") {
  std::vector<Mix> mixes;
  for (const std::string transfer : {"flip", "mls", "asflip"})
    for (const std::string shape : {"bspline_quadratic", "bspline_cubic", "cpdi2"}) {
      if ((transfer == "flip") != (shape != "bspline_quadratic")) continue;
      Mix mix;
      mix.dimension = 3, mix.close = true, mix.shape = transfer_named(shape), mix.transfer = transfer_named(transfer);
      mix.boundaries = boundaries(3, "slip");
      mixes.push_back(warm(mix));
    }
  for (const std::string transfer : {"flip", "apic", "tpic"}) {
    Mix mix = warm_and_close(2);
    mix.transfer = transfer_named(transfer), mix.boundaries = boundaries(2, "slip");
    mix.overrides.push_back(set("/grid/symmetry", "axisymmetric"));
    mix.overrides.push_back(set("/gravity", "[0, -1.3]"));
    mixes.push_back(mix);
  }
  REQUIRE(mixes.size() == 7);
  for (const std::string precision : {"double", "float"}) prepare(mixes, precision);
  for (const Mix& mix : mixes) check_heat(mix, {"double", "float"});
}

TEST_CASE("walls of every kind with every exchange of heat on the host-run device", "[device]") {
  for (const std::string type : {"slip", "stick"}) {
    Mix mix = warm_and_close(2);
    mix.transfer = transfer_named("flip"), mix.boundaries = boundaries(2, type);
    const std::vector<double> rows = check_heat(mix, {"double", "float"});
    for (const int row : {4, 5}) CHECK(std::abs(rows[row]) > 1e-3);
    CHECK(std::abs(rows[3]) > 1e-3);
  }
  Mix mix = warm_and_close(2);
  mix.boundaries = R"({"all": "slip", "x_min": "periodic", "x_max": "periodic", "y_max": "separate",
    "y_min": {"type": "prescribed", "velocity": ["0.3+t", "0.1*x"], "temperature": "40+5*x-t"}})";
  check_heat(mix);
  // Corners belong to two walls that are held at different temperatures.
  mix.boundaries = R"({"all": {"type": "stick", "temperature": 15}, "y_min": {"type": "slip", "temperature": 35}})";
  check_heat(mix);
  mix.overrides.push_back(set("/output", R"({"ledger": false})"));
  check_heat(mix);
}

TEST_CASE("boxes of nodes that are warmed or held at a temperature on the host-run device", "[device]") {
  const auto box = [](const std::string& what) {
    return R"({)" + what + R"(, "lower": [0.2, 0.2], "upper": [0.4, 0.4]})";
  };
  for (const std::string what :
       {R"("type": "thermal", "temperature": "50+9*x-99*t")", R"("type": "thermal", "heating": "900+9000*t-99*x")",
        R"("type": "stick", "temperature": "5")", R"("type": "slip", "axis": "y", "heating": "2000")"}) {
    Mix mix = warm_and_close(2);
    mix.more = R"(, "node_conditions": [)" + box(what) + "]";
    CHECK(std::abs(check_heat(mix, {"double", "float"})[6]) > 1e-3);
    mix.dimension = 3;
    mix.more = R"(, "node_conditions": [{)" + what + R"(, "lower": [0.2, 0.1, 0.1], "upper": [0.4, 0.3, 0.3]}])";
    CHECK(std::abs(check_heat(mix)[6]) > 1e-3);
  }
  // Where two boxes and a wall hold the same node, the last one counts; a warmed one is shared by all fields.
  Mix mix = warm_and_close(2);
  mix.boundaries = boundaries(2, "slip"), mix.contact = R"({"type": "coulomb", "friction": 0.2})";
  mix.more = R"(, "node_conditions": [)" + box(R"("type": "thermal", "temperature": "50")") +
             R"(, {"type": "thermal", "heating": 3000, "lower": [0.3, 0.2], "upper": [0.8, 0.6]},
             {"type": "thermal", "temperature": 5, "lower": [0.1, 0.3], "upper": [0.3, 0.6]},
             {"type": "stick", "lower": [0.5, 0.4], "upper": [0.6, 0.5]}, )" +
             R"({"type": "thermal", "heating": 3000, "lower": [0.32, 0.32], "upper": [0.34, 0.34]}])";  // between nodes
  check_heat(mix);
}

TEST_CASE("melting, freezing and warming by dissipation on the host-run device", "[device]") {
  const std::string dissipates = R"(, "dissipation_to_heat": 0.9)";
  for (const int dimension : {2, 3})
    for (const std::string order : {"last", "modified_last"}) {
      Mix mix;
      mix.dimension = dimension, mix.close = true, mix.stress_update = order;
      mix.transfer = transfer_named(order == "last" ? "flip" : "apic");
      mix.material = material(plastic, dissipates + melts + R"(, "yield_stress": 20}})");
      mix.boundaries = R"({"all": "slip", "x_min": {"type": "slip", "temperature": 60},
                           "x_max": {"type": "slip", "temperature": 0}})";
      mix = warm(mix);
      const std::vector<double> rows = check_heat(mix, {"double", "float"});
      CHECK(rows[7] > 1e-6);
      Scene reference(mix.text(), on_reference(mix));
      const auto fractions = [&] {
        std::vector<double> all;
        for (const int body : {0, 1}) {
          const std::vector<double> some = reference.body(body).host_state.at("melted_fraction");
          all.insert(all.end(), some.begin(), some.end());
        }
        return all;
      };
      const std::vector<double> before = fractions();
      reference.run();
      const std::vector<double> after = fractions();
      int thawed = 0, froze = 0, between = 0;
      for (std::size_t p = 0; p < after.size(); ++p) {
        thawed += before[p] < 0.5 && after[p] >= 0.5, froze += before[p] >= 0.5 && after[p] < 0.5;
        between += after[p] > 0 && after[p] < 1;
      }
      INFO(thawed << " thawed, " << froze << " froze, " << between << " between");
      CHECK(thawed > 0);
      CHECK(froze > 0);
      CHECK(between > 0);
    }
}

TEST_CASE("a body that melts beside one that cannot on the host-run device", "[device]") {
  for (const bool first : {false, true})
    for (const std::string symmetry : {"plane_strain", "axisymmetric"}) {
      Mix mix;
      mix.close = true, mix.material = material(elastic), mix.contact = R"({"type": "coulomb", "friction": 0.2})";
      mix.boundaries = boundaries(2, "slip");
      mix.overrides.push_back(set("/materials/n", material(plastic, melts + R"(, "yield_stress": 20}})")));
      mix.overrides.push_back(set(first ? "/bodies/0/material" : "/bodies/1/material", "\"n\""));
      mix.overrides.push_back(set("/grid/symmetry", symmetry));
      mix.overrides.push_back(set("/gravity", "[0, -1.3]"));
      mix = warm(mix);
      check_heat(mix, {"double", "float"});
      DeviceScene scene(mix.text(), "double", {}, mix.overrides);
      CHECK(scene.body(first ? 0 : 1).host_state.count("melted_fraction") == 1);
      CHECK(scene.body(first ? 1 : 0).host_state.count("melted_fraction") == 0);
    }
}

TEST_CASE("lanes in any number and order carry the same heat on the host-run device", "[device]") {
  Mix mix = warm_and_close(2);
  mix.shape = transfer_named("cpdi"), mix.transfer = transfer_named("flip"), mix.boundaries = boundaries(2, "slip");
  mix.more = R"(, "node_conditions": [{"type": "thermal", "heating": 900, "lower": [0.2, 0.2], "upper": [0.5, 0.4]}])";
  DeviceScene scene(mix.text(), "double", {}, mix.overrides);
  scene.run();
  for (const TeamShape team : {TeamShape{1, false}, {17, true}, {256, true}}) {
    DeviceScene other(mix.text(), "double", team, mix.overrides);
    other.run();
    CHECK(scene_difference(scene, other) < 1e3 * 0x1p-52);
    CHECK(difference(heat_ledger_values(scene), heat_ledger_values(other), heat_content(scene)) < 1e3 * 0x1p-52);
  }
}

TEST_CASE("heat by closed forms on the host-run device", "[device]") {
  const auto temperatures = [](const DeviceScene& scene) { return scene.body(0).host_state.at("temperature"); };
  for (const std::string precision : {"double", "float"}) {
    INFO(precision);
    const double epsilon = epsilon_of(precision);
    {  // A straight line between two walls that hold its ends is steady.
      DeviceScene scene(slab("10+50*x", R"({"all": "slip", "x_min": {"type": "slip", "temperature": 10},
                                            "x_max": {"type": "slip", "temperature": "50"}})"),
                        precision);
      scene.run();
      const BodyState state = scene.body(0);
      for (std::size_t p = 0; p < temperatures(scene).size(); ++p)
        CHECK(std::abs(temperatures(scene)[p] - (10 + 50 * state.position[2 * p])) < 3e3 * epsilon);
      const HeatLedger ledger = scene.simulation.backend().heat_ledger();
      CHECK(std::abs(ledger.sum()) < 1e3 * epsilon * heat_content(scene));
    }
    {  // Without walls that let heat through, its amount stays; one temperature stays what it is.
      DeviceScene scene(slab("20+9*cos(7*x)*sin(9*y)", R"({"all": "slip"})"), precision);
      const double before = heat_content(scene);
      const std::vector<double> start = temperatures(scene);
      scene.run();
      CHECK(heat_content(scene) == Approx(before).epsilon(1e3 * epsilon));
      CHECK(difference(temperatures(scene), start, 1) > 1);
      DeviceScene even(slab("37", R"({"all": "stick"})"), precision);
      even.run();
      for (const double T : temperatures(even)) CHECK(std::abs(T - 37) < 1e3 * epsilon);
    }
    {  // The heat is q A t through a wall of 0.4 m, and P t in a box.
      DeviceScene scene(slab("20", R"({"all": "slip", "x_max": {"type": "slip", "heat_flux": 30000}})",
                             R"(, "node_conditions": [{"type": "thermal", "heating": 7000, "lower": [0.1, 0.1],
                                "upper": [0.3, 0.2]}])"),
                        precision);
      const double before = heat_content(scene);
      scene.run();
      const HeatLedger ledger = scene.simulation.backend().heat_ledger();
      CHECK(ledger.flux == Approx(30000 * 0.4 * 0.2).epsilon(1e3 * epsilon));
      CHECK(ledger.boxes == Approx(7000 * 0.2).epsilon(1e3 * epsilon));
      CHECK(heat_content(scene) - before == Approx(ledger.flux + ledger.boxes).epsilon(1e5 * epsilon));
    }
    {  // A straight line between a held wall and one that gives the flux by Fourier's law is steady too.
      DeviceScene scene(slab("10+50*x", R"({"all": "slip", "x_min": {"type": "slip", "temperature": 10},
                                            "x_max": {"type": "slip", "heat_flux": 25000}})"),
                        precision, {}, {set("/transfer", transfer_named("flip"))});
      scene.run();
      const BodyState state = scene.body(0);
      for (std::size_t p = 0; p < temperatures(scene).size(); ++p)
        CHECK(std::abs(temperatures(scene)[p] - (10 + 50 * state.position[2 * p])) < 3e3 * epsilon);
    }
    {  // Under convection the slowest mode of a slab decays.
      const SlabOfConvection exact{{500, 10, 1000}, 0.8, 2500, 60, -30};
      DeviceScene scene(slab("60-30*cos(" + digits(exact.root() / 0.8) + "*(0.8-x))",
                             R"({"all": "slip", "x_min": {"type": "slip",
                                 "convection": {"coefficient": 2500, "temperature": 60}}})"),
                        precision, {}, {set("/transfer", transfer_named("flip")), set("/solver/end_time", "2")});
      scene.run();
      const BodyState state = scene.body(0);
      double gained = 0, expected = 0;
      for (std::size_t p = 0; p < temperatures(scene).size(); ++p) {
        const double x = state.position[2 * p], start = exact.temperature(x, 0);
        gained += temperatures(scene)[p] - start, expected += exact.temperature(x, 2) - start;
      }
      CHECK(gained == Approx(expected).epsilon(0.02));  // cells are an eighth of the slab
    }
  }
}

TEST_CASE("the heat ledger of the host-run device explains what particles hold", "[device][ledger]") {
  Mix mix = warm_and_close(2);
  mix.transfer = transfer_named("flip"), mix.material = material(plastic, R"(, "dissipation_to_heat": 0.9)");
  mix.boundaries = boundaries(2, "stick");
  mix.more = R"(, "node_conditions": [{"type": "thermal", "heating": 900, "lower": [0.2, 0.2], "upper": [0.5, 0.4]}])";
  DeviceScene scene(mix.text(), "double", {}, mix.overrides);
  const double before = heat_content(scene);
  scene.run();
  const std::vector<double> rows = heat_ledger_values(scene);
  for (std::size_t k = 1; k < rows.size(); ++k) CHECK(std::abs(rows[k]) > 1e-7 * before);  // a scatter loses none
  const double gained = heat_content(scene) - before;
  CHECK(std::abs(scene.simulation.backend().heat_ledger().sum() - gained) < 1e3 * 0x1p-52 * before);
}

TEST_CASE("work that warms a body is no entry of a ledger that is not asked for on the host-run device", "[device]") {
  Mix mix = warm_and_close(2);
  mix.transfer = transfer_named("flip"), mix.material = material(plastic, R"(, "dissipation_to_heat": 0.9)");
  mix.overrides.emplace_back(R"(/output={"ledger": false})");
  check_on_device(mix);
}

TEST_CASE("a restored run with temperature on the host-run device goes on bit for bit", "[device]") {
  const auto results = [](const Simulation& simulation) {
    std::vector<double> all = all_results(simulation);
    for (int body = 0; body < 2; ++body)
      for (const auto& [name, values] : simulation.backend().body_state(body).host_state)
        all.insert(all.end(), values.begin(), values.end());
    const HeatLedger l = simulation.backend().heat_ledger();
    all.insert(all.end(), {l.scatter, l.images, l.gather, l.walls, l.flux, l.convection, l.boxes, l.dissipation});
    return all;
  };
  Mix melting = warm_and_close(2);
  melting.material = material(plastic, R"(, "dissipation_to_heat": 0.9)" + melts + R"(, "yield_stress": 20}})");
  melting.transfer = transfer_named("asflip"), melting.boundaries = boundaries(2, "slip");
  melting.contact = R"({"type": "coulomb", "friction": 0.2})";
  melting.more = R"(, "node_conditions": [{"type": "thermal", "heating": 900, "lower": [0.2, 0.2],
                    "upper": [0.5, 0.4]}])";
  for (const std::string precision : {"double", "float"}) {
    INFO(precision);
    const std::string text = melting.text();
    DeviceScene whole(text, precision, {}, melting.overrides), resumed(text, precision, {}, melting.overrides);
    for (int k = 0; k < 6; ++k) whole.simulation.step();
    ArchiveWriter archive;
    whole.simulation.save(archive);
    for (int k = 0; k < 2; ++k) resumed.simulation.step();  // steps to be forgotten, whatever they did
    ArchiveReader reader(archive.bytes());
    resumed.simulation.restore(reader);
    CHECK(reader.at_end());
    CHECK(different(results(whole.simulation), results(resumed.simulation)) == 0);
    for (int k = 0; k < 5; ++k) whole.simulation.step(), resumed.simulation.step();
    CHECK(different(results(whole.simulation), results(resumed.simulation)) == 0);
  }
}

TEST_CASE("a composition without temperature holds no kernel of it", "[device]") {
  const auto entries = [](const Mix& mix) {
    return device::compose(device_choice_of(device_experiment(mix.text(), "double", mix.overrides))).entries;
  };
  const auto has = [](const std::vector<std::string>& all, const std::string& entry) {
    return std::count(all.begin(), all.end(), entry) == 1;
  };
  const std::vector<std::string> cold = entries({}), warmed = entries(warm({}));
  for (const std::string entry : {"mpm_scatter_heat", "mpm_conduct", "mpm_gather_heat", "mpm_heat_of_particles"}) {
    CHECK_FALSE(has(cold, entry));
    CHECK(has(warmed, entry));
  }
  CHECK_FALSE(has(warmed, "mpm_change_phase_0"));
  Mix melting = warm({});
  melting.material = material(elastic, melts + "}}");
  CHECK(has(entries(melting), "mpm_change_phase_0"));
  Mix silent = warm({});
  silent.overrides.push_back(set("/output", R"({"ledger": false})"));
  CHECK_FALSE(has(entries(silent), "mpm_heat_of_particles"));
}
