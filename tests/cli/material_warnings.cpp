// What a run and the material driver warn of because a material does not hold there: clamps, gases beyond their walls.

#include "cli/program.hpp"

using namespace mpm::test;

namespace {

/// A block of the material that is stretched by xx from the start; two steps.
Json stretched(const Json& material, double xx) {
  Json scene = ball();
  scene["materials"]["m"] = material;
  scene["bodies"][0].erase("velocity");
  scene["bodies"][0]["initial_deformation_gradient"] = {{"xx", xx}};
  scene["solver"] = {{"time_step", 1e-6}, {"end_time", 2e-6}};
  scene["limits"] = {{"volume_ratio", nullptr}, {"energy_gain", nullptr}};
  return scene;
}

/// The warnings of a run that ends well.
std::string warned(const Json& scene) {
  const Folder folder;
  const Result result = run_scene(folder, scene);
  INFO(result.err);
  CHECK(result.code == 0);
  const Json warnings = json_in(folder / "run/summary.json")["warnings"];
  for (const Json& warning : warnings) CHECK(has(result.err, "warning: " + warning.get<std::string>()));
  return warnings.dump();
}

int count(const std::string& text, const std::string& part) {
  int found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

const Json solid{{"youngs_modulus", 1e5}, {"poisson_ratio", 0.3}, {"density", 1000}};

Json law(const std::string& type, const Json& with) {
  Json material = solid;
  material["type"] = type;
  material.update(with);
  return material;
}

Json liquid(const std::string& type, const std::string& form, const Json& with = Json::object()) {
  Json material{{"type", type}, {"equation_of_state", form}, {"bulk_modulus", 1000}, {"density", 1000}};
  material.update(with);
  return material;
}

/// Two square chambers of gas in a channel: `left` up to x = 0.3, `right` from there to 0.6.
Json gases(const Json& left, const Json& right) {
  Json scene = ball();
  scene["grid"]["cell_size"] = 0.05;
  scene["materials"] = {{"left", left}, {"right", right}};
  const auto chamber = [](const char* name, double x) {
    return Json{{"name", name},
                {"material", name},
                {"geometry", {{"type", "box"}, {"lower", {x, 0}}, {"upper", {x + 0.3, 1}}}}};
  };
  scene["bodies"] = {chamber("left", 0), chamber("right", 0.3)};
  scene["solver"] = {{"courant", 0.3}, {"end_time", 0.01}};
  scene["limits"] = {{"energy_gain", nullptr}};
  return scene;
}

const Json air{{"type", "ideal_gas"}, {"pressure", 1000}, {"density", 1}};

}  // namespace

// Where each clamp begins follows from the parameters: 1 -+ ln(100)/10 of snow; p_c = 3.9 K/xi of clay with M = 1.2 and nu =
// 0.3 (its manual), J_p = (p_c0/p_c)^(1/xi); 1 - 0.9/s of Mie-Gruneisen.
TEST_CASE("every clamp that acts is warned of once by its name, and none that does not") {
  const Json snow = law("snow", Json::object()),
             clay = law("cam_clay", {{"preconsolidation_pressure", 1000}, {"hardening", 10}}),
             metal = law("johnson_cook", {{"yield_stress", 1e4},
                                          {"hardening_coefficient", 1e4},
                                          {"hardening_exponent", 0.3},
                                          {"rate_coefficient", 0.01},
                                          {"melting_temperature", 1000}});
  const auto with = [](Json material, const char* name, double value) {
    material[name] = value;
    return material;
  };
  const auto soil = [](double dilation) {
    return law("mohr_coulomb", {{"friction_angle", 0.5}, {"dilation_angle", dilation}});
  };
  const Json grains = law("mu_i", {{"grain_diameter", 0.001}});
  struct Case {
    Json material;
    double xx;  // of F at the start
    const char* words;
  };
  const Case acting[] = {
      {snow, 0.5, ": below J_P = 0.539, the moduli of snow that is compacted stay"},
      {snow, 1.6, ": above J_P = 1.46, the moduli of snow that has come loose stay"},
      {clay, 0.3, ": below J_p = 0.706, p_c grows along a straight line"},
      {soil(0.6), 1, ": above psi = 0.5 rad, dilation_angle counts as friction_angle"},
      {with(grains, "limit_friction", 0.2), 1, ": below mu_2 = 0.38, limit_friction counts as static_friction"},
      {with(grains, "critical_density", 900), 1, ": below 1e+03 kg/m^3, critical_density counts as density"},
      {with(metal, "room_temperature", 300), 1, ": below T = 300 K, T* stays at 0"},
      {liquid("newtonian_fluid", "mie_gruneisen", {{"viscosity", 0}}), 0.39,
       ": below J = 0.396, the pressure of mie_gruneisen goes on along its tangent"},
      {liquid("herschel_bulkley", "mie_gruneisen",
              {{"shear_modulus", 100}, {"yield_stress", 1e6}, {"consistency", 1}, {"hugoniot_slope", 2}}),
       0.54, ": below J = 0.55, the pressure of mie_gruneisen goes on along its tangent"},
  };
  for (const Case& one : acting) {
    const std::string warnings = warned(stretched(one.material, one.xx));
    INFO(one.material.dump() << " " << warnings);
    CHECK(count(warnings, "was clamped") == 1);
    CHECK(has(warnings, "material \\\"m\\\" was clamped from t = "));
    CHECK(has(warnings, one.words));
  }
  const std::pair<Json, double> free[] = {
      {snow, 0.6},
      {snow, 1.4},
      {clay, 0.9},
      {soil(0.4), 1},
      {grains, 1},
      {with(grains, "critical_density", 1100), 1},
      {metal, 1},
      {liquid("newtonian_fluid", "mie_gruneisen", {{"viscosity", 0}}), 0.41},
      {liquid("newtonian_fluid", "power", {{"viscosity", 0}}), 0.39},
  };
  for (const auto& [material, xx] : free) {
    const std::string warnings = warned(stretched(material, xx));
    INFO(material.dump() << " " << warnings);
    CHECK(count(warnings, "was clamped") == 0);
  }
}

TEST_CASE("a clamp is looked for in the particles of its own material, in axisymmetric scenes too and in hot ones") {
  // Rubber that is crushed beside a liquid at rest, whose law would be clamped there.
  Json scene = stretched(law("neo_hookean", Json::object()), 0.3);
  scene["materials"]["water"] = liquid("newtonian_fluid", "mie_gruneisen", {{"viscosity", 0}});
  scene["bodies"][0]["geometry"] = {{"type", "ball"}, {"centre", {0.3, 0.5}}, {"radius", 0.1}};
  Json water = scene["bodies"][0];
  water["name"] = "pool", water["material"] = "water";
  water["geometry"]["centre"] = {0.7, 0.5};
  water.erase("initial_deformation_gradient");
  scene["bodies"].push_back(water);
  CHECK(!has(warned(scene), "mie_gruneisen"));
  scene["bodies"][1]["initial_deformation_gradient"] = {{"xx", 0.3}};
  CHECK(has(warned(scene), "material \\\"water\\\" was clamped"));
  scene["bodies"].erase(0);
  scene["grid"]["symmetry"] = "axisymmetric";
  CHECK(has(warned(scene), "material \\\"water\\\" was clamped"));

  Json hot = stretched(law("johnson_cook", {{"yield_stress", 1e4},
                                            {"hardening_coefficient", 1e4},
                                            {"hardening_exponent", 0.3},
                                            {"rate_coefficient", 0.01},
                                            {"melting_temperature", 1000},
                                            {"thermal", {{"conductivity", 1}, {"heat_capacity", 10}}}}),
                       1);
  // The temperature that single precision makes of the default room temperature lies below it.
  for (const char* precision : {"float", "double"}) {
    hot["precision"] = precision, hot["bodies"][0]["temperature"] = 293.15;
    CHECK_FALSE(has(warned(hot), "T* stays at"));
  }
  for (const double temperature : {999, 1001}) {
    hot["bodies"][0]["temperature"] = temperature;
    CHECK(has(warned(hot), ": above T = 1e+03 K, T* stays at 1") == (temperature > 1000));
  }
}

TEST_CASE("the material driver warns of a clamp too") {
  Json scene = Json::parse(R"({
    "materials": {"water": {"type": "newtonian_fluid", "bulk_modulus": 1000, "density": 1000, "viscosity": 0}},
    "solver": {"type": "material_point", "cell_size": 1,
               "stages": [{"name": "press", "steps": 70, "deformation_gradient": {"xx": "1 - 0.7*t"}}]}
  })");
  const Folder folder;
  for (const char* form : {"mie_gruneisen", "power"}) {
    scene["materials"]["water"]["equation_of_state"] = form;
    const Result result = run_scene(folder, scene);
    INFO(result.err);
    CHECK(result.code == 0);
    const bool clamped = std::string(form) == "mie_gruneisen";
    CHECK(count(result.err, "warning: material \"water\" was clamped from t = 0.871 s on (1 particle then): below J") ==
          clamped);
    CHECK(json_in(folder / "run/summary.json")["warnings"].size() == clamped);
    CHECK(has(slurp(folder / "run/report.html"), "was clamped") == clamped);
  }
  const auto driven = [&](const char* strain) {
    return call(folder, {"drive", "snow", "--param", "youngs_modulus=1e5", "--param", "poisson_ratio=0.2", "--param",
                         "density=400", "--path", "isotropic", "--strain", strain});
  };
  CHECK(has(driven("0.3").err, "was clamped"));
  CHECK(driven("0.05").err.empty());
}

TEST_CASE("gas that expands freely is warned of, and not gas that is confined or shrinks") {
  Json scene = gases(air, air);
  scene["bodies"].erase(1);
  scene["materials"].erase("right");
  scene["solver"]["end_time"] = 0.02;
  const std::string words = "gas \\\"left\\\" expanded freely, to J = ";
  scene["bodies"][0]["initial_deformation_gradient"] = {{"xx", 0.4}};
  CHECK(has(warned(scene), words));
  scene["materials"]["left"] = {{"type", "newtonian_fluid"},
                                {"equation_of_state", "ideal_gas"},
                                {"bulk_modulus", 1400},
                                {"density", 1},
                                {"viscosity", 0}};
  CHECK(has(warned(scene), words));
  Json water = scene;
  water["materials"]["left"]["equation_of_state"] = "linear";
  CHECK(!has(warned(water), "expanded freely"));
  Json still = scene;
  still["bodies"][0].erase("initial_deformation_gradient");
  CHECK(!has(warned(still), "expanded freely"));
  // A rigid piston on the open side keeps it in.
  Json confined = scene;
  confined["rigid_bodies"] = Json::array({{{"name", "piston"},
                                           {"geometry", {{"type", "box"}, {"lower", {0.3, 0}}, {"upper", {1, 1}}}},
                                           {"contact", {{"type", "frictionless"}}}}});
  CHECK(!has(warned(confined), "expanded freely"));
}

TEST_CASE("gases that meet are warned of, in one field and in contact, with their pressures where these differ") {
  Json other = air;
  other["density"] = 2;
  CHECK(has(warned(gases(air, other)), "gas \\\"left\\\" met gas \\\"right\\\": with one velocity for both"));
  other["pressure"] = 500;
  CHECK(has(warned(gases(air, other)),
            "gas \\\"left\\\" met gas \\\"right\\\": their pressures at rest, 1e+03 and 500 Pa, differ"));
  Json touching = gases(air, air);
  CHECK(!has(warned(touching), "met gas"));  // one material on one field is one gas
  touching["contact"] = {{"type", "frictionless"}};
  CHECK(has(warned(touching), "gas \\\"left\\\" met gas \\\"right\\\": contact only pushes"));
  Json apart = gases(air, other);
  apart["bodies"][1]["geometry"] = {{"type", "box"}, {"lower", {0.5, 0}}, {"upper", {0.8, 1}}};
  CHECK(!has(warned(apart), "met gas"));
  // Across a periodic face they meet.
  Json across = apart;
  across["bodies"][1]["geometry"] = {{"type", "box"}, {"lower", {0.7, 0}}, {"upper", {1, 1}}};
  CHECK(!has(warned(across), "met gas"));
  across["grid"]["boundaries"]["x_min"] = across["grid"]["boundaries"]["x_max"] = "periodic";
  CHECK(has(warned(across), "gas \\\"left\\\" met gas"));
}
