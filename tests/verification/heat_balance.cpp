// Heat in bodies that move: a uniform temperature stays, plastic work warms, the ledger closes, a saved run goes on with
// the same bits, and melting changes what a particle is made of.

#include "slab.hpp"
#include "support/catch.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::vector<std::string> carriers{"pic", "flip", "apic", "mls", "tpic", "aflip", "asflip"};

/// A block of wax that falls into a corner, is warmed from all sides, melts and slumps.
std::string wax(const std::string& backend) {
  return R"J({"dimension": 2, "backend": ")J" + backend + R"J(",
  "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]], "boundaries": {
    "x_min": {"type": "slip", "convection": {"coefficient": 300, "temperature": "400 + 10*y"}},
    "y_min": {"type": "stick", "temperature": "330 + 10*t"},
    "x_max": {"type": "stick", "heat_flux": "1 kW/m^2"}, "y_max": "slip"}},
  "node_conditions": [{"type": "thermal", "lower": [0.4, 0.3], "upper": [0.6, 0.4], "heating": 500}],
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
  "materials": {"wax": {"type": "von_mises", "youngs_modulus": 1e5, "poisson_ratio": 0.3, "yield_stress": 1e3,
    "density": 1000, "thermal": {"conductivity": 500, "heat_capacity": 100, "dissipation_to_heat": 0.9,
      "phase_change": {"temperature": 320, "latent_heat": 1000,
                       "melted": {"heat_capacity": 150, "yield_stress": 50, "youngs_modulus": 5e4}}}}},
  "bodies": [{"name": "block", "material": "wax", "temperature": "315 + 4.9*x", "velocity": [-0.5, -0.5], "jitter": 0.1,
              "geometry": {"type": "box", "lower": [0.1, 0.1], "upper": [0.5, 0.5]}}],
  "gravity": [0, -9.81],
  "solver": {"time_step": 0.001, "end_time": 0.2}})J";
}

}  // namespace

TEST_CASE("every transfer keeps a uniform temperature in a body that falls, bounces and shears", "[temperature]") {
  for (const std::string& backend : heat_backends())
    for (const std::string& transfer : carriers)
      for (const std::string update : {"last", "first", "modified_last", "averaged"}) {
        INFO(backend << " " << transfer << " " << update);
        Scene scene(R"J({"dimension": 2, "backend": ")J" + backend + R"J(",
          "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]], "boundaries": {
            "y_min": {"type": "stick", "temperature": 300}, "x_min": {"type": "periodic"}, "x_max": {"type": "periodic"},
            "y_max": "slip"}},
          "shape": {"type": "bspline_quadratic"}, "transfer": {"type": ")J" +
                    transfer + R"J("},
          "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e5, "poisson_ratio": 0.3, "density": 1000,
                              "thermal": {"conductivity": 1000, "heat_capacity": 100}}},
          "bodies": [{"name": "b", "material": "m", "temperature": 300, "velocity": ["1 + y", -0.3], "jitter": 0.2,
                      "geometry": {"type": "box", "lower": [0.1, 0.02], "upper": [0.6, 0.5]}}],
          "solver": {"stress_update": ")J" +
                    update + R"J(", "time_step": 0.001, "end_time": 0.15}})J");
        const Totals end = scene.run();
        CHECK(std::abs(end.lowest_temperature - 300) < 1e-10);
        CHECK(std::abs(end.highest_temperature - 300) < 1e-10);
      }
}

TEST_CASE("temperatures of a body that moves across cells stay between those that it began with", "[temperature]") {
  // A linear shape with carried gradients is refused, as its temperatures leave all bounds in this scene.
  for (const std::string shape : {"linear", "bspline_quadratic", "bspline_cubic", "gimp", "cpdi"})
    for (const std::string& transfer : carriers) {
      if (shape == "linear" && transfer != "pic" && transfer != "flip") continue;
      INFO(shape << " " << transfer);
      Scene scene(R"J({"dimension": 2,
        "grid": {"cell_size": 0.1, "domain": [[0, 0], [2, 2]], "boundaries": {"all": "slip"}},
        "shape": {"type": ")J" +
                  shape + R"J("}, "transfer": {"type": ")J" + transfer + R"J("},
        "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000,
                            "thermal": {"conductivity": 1e5, "heat_capacity": 100}}},
        "bodies": [{"name": "b", "material": "m", "temperature": "300 + 100*(x > 0.8)", "jitter": 0.2,
                    "velocity": ["0.1 - 2*(y - 0.8)", "2*(x - 0.8)"],
                    "geometry": {"type": "box", "lower": [0.5, 0.5], "upper": [1.1, 1.1]}}],
        "solver": {"end_time": 0.5}, "output": {"ledger": false}})J");
      const Totals end = scene.run();
      CHECK(end.lowest_temperature > 299);
      CHECK(end.highest_temperature < 401);
    }
}

TEST_CASE("plastic work in simple shear warms a body as much as it dissipates", "[temperature]") {
  const double youngs_modulus = 1e6, shear_modulus = 5e5, yield_stress = 200, hardening = 1e4;
  for (const std::string& backend : heat_backends())
    for (const std::string update : {"last", "modified_last"}) {
      INFO(backend << " " << update);
      Scene scene(R"J({"dimension": 2, "backend": ")J" + backend + R"J(",
        "grid": {"cell_size": 0.25, "domain": [[0, 0], [1, 1]], "boundaries": {
          "x_min": "periodic", "x_max": "periodic", "y_min": {"type": "prescribed", "velocity": ["0.01*y", 0]},
          "y_max": {"type": "prescribed", "velocity": ["0.01*y", 0]}}},
        "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
        "materials": {"m": {"type": "von_mises", "youngs_modulus": )J" +
                  digits(youngs_modulus) + R"J(, "poisson_ratio": 0, "density": 10, "yield_stress": )J" +
                  digits(yield_stress) + R"J(, "hardening_modulus": )J" + digits(hardening) + R"J(, "thermal":
                  {"conductivity": 1, "heat_capacity": 2, "dissipation_to_heat": 0.9}}},
        "bodies": [{"name": "b", "material": "m", "temperature": 300, "velocity": ["0.01*y", 0],
                    "geometry": {"type": "box", "lower": [0, 0], "upper": [1, 1]}}],
        "solver": {"stress_update": ")J" +
                  update + R"J(", "time_step": 2e-4, "end_time": 0.5}})J");
      const Totals end = scene.run();
      const double work = plastic_work_in_shear(0.005, shear_modulus, yield_stress, hardening);
      const double rise = 0.9 * work / (10 * 2);
      INFO("rise " << end.highest_temperature - 300 << " and " << end.lowest_temperature - 300 << " K, exact " << rise);
      CHECK(end.highest_temperature - 300 == Approx(rise).epsilon(0.005));
      CHECK(end.lowest_temperature - 300 == Approx(rise).epsilon(0.005));
      CHECK(scene.simulation.backend().heat_ledger().dissipation ==
            Approx(0.9 * scene.simulation.ledger().material).epsilon(1e-12));
      CHECK(relative_heat_residual(scene, end) < 1e-12);
    }
}

TEST_CASE("Johnson-Cook metal in fast shear softens by its own heat", "[temperature]") {
  // With B = 0 and m = 1 the flow stress is R A (1 - T*), R the factor of the rate, and the heat of d alpha raises T* by
  // k R A (1 - T*) d alpha, k = share/(density capacity (T_melt - T_room)): 1 - T* falls as exp(-k R A alpha).
  const double shear_modulus = 5e5, yield_stress = 200, room = 300, melting = 1300, share = 0.9, capacity = 1e-4;
  const double strain_rate = 0.01, end_time = 0.5,
               rate_factor = 1 + 0.05 * std::log(strain_rate / std::sqrt(3.0) / 1e-4);
  for (const std::string& backend : heat_backends()) {
    INFO(backend);
    Scene scene(R"J({"dimension": 2, "backend": ")J" + backend + R"J(",
      "grid": {"cell_size": 0.25, "domain": [[0, 0], [1, 1]], "boundaries": {
        "x_min": "periodic", "x_max": "periodic", "y_min": {"type": "prescribed", "velocity": ["0.01*y", 0]},
        "y_max": {"type": "prescribed", "velocity": ["0.01*y", 0]}}},
      "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
      "materials": {"m": {"type": "johnson_cook", "youngs_modulus": 1e6, "poisson_ratio": 0, "density": 10,
        "yield_stress": )J" +
                digits(yield_stress) + R"J(, "hardening_coefficient": 0, "hardening_exponent": 1,
        "rate_coefficient": 0.05, "reference_rate": 1e-4, "room_temperature": 300, "melting_temperature": 1300,
        "thermal": {"conductivity": 1e-9, "heat_capacity": )J" +
                digits(capacity) + R"J(,
                    "dissipation_to_heat": 0.9}}},
      "bodies": [{"name": "b", "material": "m", "temperature": 300, "velocity": ["0.01*y", 0],
                  "geometry": {"type": "box", "lower": [0, 0], "upper": [1, 1]}}],
      "solver": {"time_step": 2e-4, "end_time": 0.5}})J");
    const Totals end = scene.run();
    const double fade = share / (10 * capacity * (melting - room)) * rate_factor * yield_stress;
    double plastic = 0;  // gamma - tau/G, tau by what is left of the strength
    for (int k = 0; k < 50; ++k)
      plastic = (strain_rate * end_time -
                 rate_factor * yield_stress * std::exp(-fade * plastic) / std::sqrt(3.0) / shear_modulus) /
                std::sqrt(3.0);
    const double rise = (melting - room) * (1 - std::exp(-fade * plastic));
    INFO("rise " << end.highest_temperature - 300 << " and " << end.lowest_temperature - 300 << " K, exact " << rise);
    CHECK(end.highest_temperature - 300 == Approx(rise).epsilon(0.005));
    CHECK(end.lowest_temperature - 300 == Approx(rise).epsilon(0.005));
    const BodyState state = scene.body();
    for (const double found : state.material_state.at("equivalent_plastic_strain"))
      CHECK(found == Approx(plastic).epsilon(0.002));
  }
}

TEST_CASE("the heat ledger closes to rounding whatever heats, moves and melts", "[temperature]") {
  for (const std::string& backend : heat_backends()) {
    const auto check = [](Scene& scene) {
      const Totals end = scene.run();
      CHECK(relative_heat_residual(scene, end) < 1e-11);
      CHECK(end.latent_heat > 0);
      const HeatLedger ledger = scene.simulation.backend().heat_ledger();
      for (const double row : {ledger.flux, ledger.convection, ledger.boxes, ledger.dissipation}) CHECK(row > 0);
      CHECK(ledger.walls + ledger.images + ledger.scatter + ledger.gather > 0);
      return end;
    };
    for (const std::string& transfer : carriers) {
      INFO(backend << " " << transfer);
      // The block moves from wall to wall, so that every row has something to say.
      Scene scene(wax(backend), {"/transfer/type=\"" + transfer + "\"", "/bodies/0/velocity=[0, 0]",
                                 "/bodies/0/geometry/lower=[0, 0]", "/bodies/0/geometry/upper=[1, 0.5]"});
      check(scene);
    }
  }
}

TEST_CASE("a scene with temperature goes on from what it saved with the same bits", "[temperature]") {
  for (const std::string& backend : heat_backends()) {
    Scene whole(wax(backend)), begun(wax(backend)), resumed(wax(backend));
    whole.run_steps(80);
    begun.run_steps(40);
    ArchiveWriter archive;
    begun.simulation.save(archive);
    ArchiveReader reader(archive.bytes());
    resumed.simulation.restore(reader);
    resumed.run_steps(40);
    INFO(backend);
    CHECK(whole.body().host_state.at("melted_fraction") != Scene(wax(backend)).body().host_state.at("melted_fraction"));
    CHECK(different(all_results(whole.simulation), all_results(resumed.simulation)) == 0);
  }
}

TEST_CASE("a melted body has the parameters of its melt", "[temperature]") {
  // The same scene runs twice: of a solid with the melt's parameters, and of a material that is melted from the start.
  for (const std::string& backend : heat_backends()) {
    const auto scene_of = [&](const std::string& material) {
      return R"J({"dimension": 2, "backend": ")J" + backend + R"J(",
        "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]]},
        "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
        "materials": {"m": {"type": "von_mises", "poisson_ratio": 0.3, "density": 1000, )J" +
             material + R"J(}},
        "bodies": [{"name": "b", "material": "m", "temperature": "400 + 50*x",
                    "geometry": {"type": "box", "lower": [0.3, 0], "upper": [0.6, 0.5]}}],
        "gravity": [0, -9.81], "solver": {"time_step": "auto", "end_time": 0.2}})J";
    };
    Scene melted(scene_of(R"("youngs_modulus": 1e6, "yield_stress": 1e9, "thermal": {"conductivity": 1,
      "heat_capacity": 50, "phase_change": {"temperature": 300, "latent_heat": 10,
      "melted": {"conductivity": 200, "heat_capacity": 100, "youngs_modulus": 1e5, "yield_stress": 500}}})")),
        solid(scene_of(R"("youngs_modulus": 1e5, "yield_stress": 500, "thermal": {"conductivity": 200,
      "heat_capacity": 100})"));
    const Totals a = melted.run(), b = solid.run();
    INFO(backend);
    CHECK(a.step == b.step);
    CHECK(different(melted.body().position, solid.body().position) == 0);
    CHECK(a.strain == b.strain);
    CHECK(a.highest_temperature == Approx(b.highest_temperature).epsilon(1e-12));
    CHECK(melted.simulation.ledger().material == solid.simulation.ledger().material);
  }
}

TEST_CASE("the energy that stiffness held goes to the material when it melts", "[temperature]") {
  // A compressed block at rest between walls is warmed throughout until it melts: its stress falls with its stiffness.
  for (const std::string& backend : heat_backends()) {
    Scene scene(R"J({"dimension": 2, "backend": ")J" + backend + R"J(",
      "grid": {"cell_size": 0.1, "domain": [[0, 0], [0.5, 0.5]], "boundaries": {"all": "slip"}},
      "node_conditions": [{"type": "thermal", "lower": [0, 0], "upper": [0.5, 0.5], "heating": 1.0007e5}],
      "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
      "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000,
        "thermal": {"conductivity": 1, "heat_capacity": 100, "phase_change": {"temperature": 300, "latent_heat": 100,
                    "melted": {"youngs_modulus": 1e5}}}}},
      "bodies": [{"name": "b", "material": "m", "temperature": 300, "velocity": ["0.1*sin(2*pi*x)", 0],
                  "geometry": {"type": "box", "lower": [0, 0], "upper": [0.5, 0.5]}}],
      "solver": {"time_step": 1e-4, "end_time": 0.3}})J");
    double released = 0;
    for (int step = 0; step < 3000 && released == 0; ++step) {
      const double material = scene.simulation.ledger().material;
      scene.simulation.step();
      released = scene.simulation.ledger().material - material;
    }
    // Both energies are proportional to Young's modulus.
    const double left = scene.metrics.measure().strain;
    INFO(backend << ": " << released << " J went, " << left << " J are left");
    CHECK(released > 0);
    CHECK(released / (released + left) == Approx(0.9).epsilon(1e-9));
  }
}
