// Verbs that compute nothing: help, list, describe, schema, check, plan; and plugins that cannot be used.

#include "cli/program.hpp"
#include "support/scene.hpp"

using namespace mpm::test;

namespace {

std::string printed(const Words& words) {
  const Folder folder;
  const Result result = call(folder, words);
  INFO(result.err);
  REQUIRE(result.code == 0);
  CHECK(result.err.empty());
  return result.out;
}

Json plan_of(const Json& scene) {
  const Folder folder;
  spill(folder / "scene.json", scene.dump());
  const Result result = call(folder, {"plan", "scene.json", "--json"});
  INFO(result.err);
  REQUIRE(result.code == 0);
  CHECK(folder.names() == Words{"scene.json"});
  return Json::parse(result.out);
}

Json without_ledger(Json scene) {
  scene["output"]["ledger"] = false;
  return scene;
}

/// The words "name bytes" of each row, in order.
Words rows(const Json& plan, const char* table, const char* bytes) {
  Words list;
  for (const Json& row : plan[table])
    list.push_back(row["name"].get<std::string>() + " " + std::to_string(row[bytes].get<int>()));
  return list;
}
Words attributes(const Json& plan) {
  return rows(plan, "attributes", "bytes_per_particle");
}
Words fields(const Json& plan) {
  return rows(plan, "fields", "bytes_per_node");
}

std::string because(const Json& plan, const char* table, const std::string& name) {
  for (const Json& row : plan[table])
    if (row["name"] == name) return row["because"];
  return "";
}

int total(const Json& plan, const char* table, const char* bytes) {
  int sum = 0;
  for (const Json& row : plan[table]) sum += row[bytes].get<int>();
  return sum;
}

/// Bytes a particle that the built scene stores.
double held(const Json& scene) {
  const Scene built(scene.dump());
  return static_cast<double>(built.simulation.backend().particle_bytes()) /
         static_cast<double>(built.simulation.particle_count());
}

}  // namespace

TEST_CASE("--help lists every verb and exit code") {
  const std::string help = printed({"--help"});
  for (const char* verb :
       {"run", "check", "plan", "list", "describe", "schema", "figure", "film", "compare", "contact-offset"})
    CHECK(has(help, std::string("\n  ") + verb + " "));
  for (const char* code :
       {"0 done", "2 bad input", "3 the run became unstable", "4 an expectation", "5 the machine", "130 stopped"})
    CHECK(has(help, code));
  CHECK(has(help, "MPM_PLUGIN_PATH"));
  const std::string run = printed({"run", "--help"});
  for (const char* option : {"--set", "--out", "--threads", "--backend", "--replace"}) CHECK(has(run, option));
  CHECK(printed({"--version"}).starts_with("mpm "));
}

TEST_CASE("list and describe show every plugin") {
  const std::string text = printed({"list"});
  const Json json = Json::parse(printed({"list", "--json"}));
  std::size_t listed = 0;
  for (const auto& [kind, plugins] : json.items())
    for (const Json& plugin : plugins) {
      ++listed;
      const std::string id = plugin["id"];
      INFO(id);
      CHECK(plugin["kind"] == kind);
      CHECK(has(text, "\n  " + id + " "));
      for (const char* key : {"summary", "citation", "manual", "version"})
        CHECK(!plugin[key].get<std::string>().empty());
      for (const Json& parameter : plugin["parameters"])
        for (const char* key : {"name", "default", "range", "doc"}) CHECK(!parameter[key].get<std::string>().empty());
    }
  CHECK(listed == plugins().plugins().size());
  CHECK(listed >= 11);

  const std::string manual = printed({"describe", "von_mises"});
  CHECK(has(manual, "\nDissipates by: plastic work (row of the energy ledger)\n"));
  CHECK(!has(printed({"describe", "neo_hookean"}), "Dissipates by"));
  for (const char* part : {"von_mises (material", "Source: ", "yield_stress (Pa)", "State a particle"})
    CHECK(has(manual, part));
  CHECK(printed({"describe", "material/von_mises"}) == manual);
  CHECK(Json::parse(printed({"describe", "flip", "--json"}))["id"] == "flip");

  const Folder folder;
  const Result unknown = call(folder, {"describe", "neohookean"});
  CHECK(unknown.code == 2);
  CHECK(has(unknown.err, "no plugin is called \"neohookean\"; did you mean \"neo_hookean\"?"));
}

TEST_CASE("schema is JSON that names every plugin") {
  const std::string text = printed({"schema"});
  const Json schema = Json::parse(text);
  CHECK(has(schema["$schema"], "json-schema.org"));
  for (const mpm::Plugin& plugin : plugins().plugins()) {
    INFO(plugin.id());
    CHECK(has(text, "\"" + std::string(plugin.id()) + "\""));
  }
}

TEST_CASE("check says ok and writes nothing") {
  const Folder folder;
  spill(folder / "scene.json", two_balls().dump());
  const Result result = call(folder, {"check", "scene.json"});
  CHECK(result.code == 0);
  CHECK(has(result.out, "scene.json: ok, 2-D, 2 bodies, "));
  CHECK(!has(result.out, "about"));  // so few are counted
  CHECK(has(result.out, "bspline_quadratic + apic"));
  CHECK(folder.names() == Words{"scene.json"});
  const Result wrong = call(folder, {"check", "scene.json", "--set", "/contact/friction=-1"});
  INFO(wrong.err);
  CHECK(wrong.code == 2);
  CHECK(has(wrong.err, "--set: /contact/friction: out of range: expected a number of at least 0, got -1"));
}

TEST_CASE("a single elastic body with MLS holds nothing that it does not use") {
  const Json plan = plan_of(without_ledger(ball()));
  CHECK(attributes(plan) ==
        Words{"position 16", "velocity 16", "affine_velocity 32", "deformation_gradient 32", "identity 4"});
  CHECK(total(plan, "attributes", "bytes_per_particle") == 100);
  CHECK(fields(plan) == Words{"momentum 32", "mass 0", "velocity 0", "next_momentum 32", "next_mass 0"});
  CHECK(plan["fields"][1]["beside"] == "momentum");
  CHECK(plan["fields"][2]["in_place_of"] == "momentum");
  CHECK(plan["velocity_fields"] == 1);
  CHECK(plan["fused"] == true);
  for (const char* flag : {"weight_gradients", "separate_force", "velocity_increment", "ledger"})
    CHECK(plan[flag] == false);
  CHECK(plan["affine_moment"] == true);
  Words passes;
  for (const Json& pass : plan["passes"]) passes.push_back(pass["name"]);
  CHECK(passes ==
        Words{"unless scattered", "momentum to velocity", "apply forces", "sort", "gather, strain and scatter"});
  Words first;
  for (const Json& pass : plan["passes"][0]["passes"]) first.push_back(pass["name"]);
  CHECK(first == Words{"sort", "reset grid", "scatter"});

  Json apart = without_ledger(ball());
  apart["solver"]["passes"] = "separate";
  const Json separate = plan_of(apart);
  CHECK(fields(separate) == Words{"momentum 32", "mass 0", "velocity 0"});
  CHECK(separate["why_not_fused"] == "/solver/passes \"separate\"");
  passes.clear();
  for (const Json& pass : separate["passes"]) passes.push_back(pass["name"]);
  CHECK(passes ==
        Words{"sort", "reset grid", "scatter", "momentum to velocity", "apply forces", "sort", "gather and strain"});
  const std::string all = plan.dump();
  for (const char* word : {"contact", "filter", "plastic", "volume", "surface"}) CHECK(!has(all, word));

  Json single = without_ledger(ball());
  single["precision"] = "float";
  const Json half = plan_of(single);
  CHECK(total(half, "attributes", "bytes_per_particle") == 52);  // the identity stays 4 bytes
  CHECK(fields(half) == Words{"momentum 16", "mass 0", "velocity 0", "next_momentum 16", "next_mass 0"});
}

TEST_CASE("the backend holds what the plan says, and the padding of its last batches") {
  Json scene = without_ledger(ball());
  scene["grid"]["cell_size"] = 0.005;
  const double bytes = held(scene);
  CHECK(bytes >= 100);
  CHECK(bytes < 126);
  scene["precision"] = "float";
  const double half = held(scene);
  CHECK(half >= 52);
  CHECK(half < 68);
}

TEST_CASE("what is switched on adds its own rows, and each names the line that asked for it") {
  const Json bare = plan_of(without_ledger(ball()));

  const Json ledger = plan_of(ball());
  CHECK(attributes(ledger) == attributes(bare));
  CHECK(fields(ledger) == Words{"momentum 32", "mass 0", "velocity 0", "next_momentum 32", "next_mass 0",
                                "velocity_before 32", "force 32", "boundary_impulse 32"});
  CHECK(because(ledger, "fields", "force") == "/output/ledger: work of the forces");

  Json scene = without_ledger(ball());
  scene["materials"]["m"] = {{"type", "von_mises"},
                             {"youngs_modulus", 1000},
                             {"poisson_ratio", 0.3},
                             {"density", 1000},
                             {"yield_stress", 100}};
  const Json plastic = plan_of(scene);
  CHECK(fields(plastic) == fields(bare));
  CHECK(attributes(plastic) == Words{"position 16", "velocity 16", "affine_velocity 32", "elastic_left_cauchy_green 32",
                                     "volume_ratio 8", "equivalent_plastic_strain 8", "identity 4"});
  CHECK(
      because(plastic, "attributes", "equivalent_plastic_strain").starts_with("line 1: /materials/m \"von_mises\": "));

  scene = without_ledger(two_balls());
  scene["transfer"]["type"] = "mls";
  const Json contact = plan_of(scene);
  CHECK(attributes(contact).size() == 2 * attributes(bare).size());
  CHECK(total(contact, "attributes", "bytes_per_particle") == 200);
  CHECK(fields(contact) == Words{"momentum 64", "mass 0", "velocity 0", "next_momentum 64", "next_mass 0", "force 64",
                                 "volume_gradient 64", "mass_position 64"});
  CHECK(contact["velocity_fields"] == 2);
  CHECK(contact["weight_gradients"] == true);
  CHECK(because(contact, "fields", "force") == "line 1: /contact \"coulomb\": acts before and after the forces");
  CHECK(because(contact, "fields", "volume_gradient").starts_with("/contact/normal "));
  CHECK(because(contact, "fields", "mass_position").starts_with("/contact/detection "));

  const Json flip = [] {
    Json with_flip = without_ledger(ball());
    with_flip["transfer"]["type"] = "flip";
    return plan_of(with_flip);
  }();
  CHECK(!has(flip.dump(), "affine_velocity"));
  CHECK(flip["weight_gradients"] == true);
  CHECK(because(flip, "fields", "force") == "line 1: /transfer \"flip\": gathers the change of velocity");
}

TEST_CASE("plan as text has the same rows") {
  const Folder folder;
  spill(folder / "scene.json", without_ledger(ball()).dump());
  const Result result = call(folder, {"plan", "scene.json"});
  CHECK(result.code == 0);
  CHECK(has(result.out, "body 0: 100 bytes a particle"));
  CHECK(has(result.out, "Fields of a node: 64 bytes"));
  CHECK(has(result.out, "deformation gradient"));
  CHECK(has(result.out, "Stencil: weights only, no gradients; force merged into momentum"));
  CHECK(has(result.out, "Gather and scatter: fused, one visit of a particle a step"));
  CHECK(has(result.out, "Estimate: "));
  CHECK(!has(result.out, "contact"));
}

TEST_CASE("a filter is a branch of the plan's tree, with its loop") {
  const Folder folder;
  Json scene = without_ledger(ball());
  scene["filter"] = {{"type", "fmpm"}, {"order", 4}, {"every_steps", 2}};
  const Json plan = plan_of(scene);
  CHECK(plan["fused"] == false);
  CHECK(has(plan["why_not_fused"].get<std::string>(), "/filter: the filter reads the grid between gather and scatter"));
  const auto group = std::find_if(plan["passes"].begin(), plan["passes"].end(),
                                  [](const Json& pass) { return pass["name"] == "when filtered"; });
  REQUIRE(group != plan["passes"].end());
  Words names;
  for (const Json& pass : (*group)["passes"]) names.push_back(pass["name"]);
  CHECK(names == Words{"begin filter", "repeat", "end filter"});
  CHECK((*group)["passes"][1]["times"] == 3);
  CHECK((*group)["passes"][1]["passes"][0]["name"] == "project");
  CHECK((*group)["passes"][1]["passes"][1]["name"] == "update filter");
  CHECK(fields(plan) ==
        Words{"momentum 32", "mass 0", "velocity 0", "increment 32", "projection 32", "trial_velocity 0"});

  spill(folder / "scene.json", scene.dump());
  const Result text = call(folder, {"plan", "scene.json"});
  CHECK(has(text.out, "repeat"));
  CHECK(has(text.out, "up to 3 times"));

  scene["solver"]["passes"] = "fused";
  spill(folder / "scene.json", scene.dump());
  const Result refused = call(folder, {"check", "scene.json"});
  CHECK(refused.code == 2);
  CHECK(has(refused.err, "passes cannot be fused: /filter: the filter reads the grid between gather and scatter"));
}

TEST_CASE("plugins that cannot be used are named, and the program goes on") {
  const Folder folder;
  fs::create_directory(folder / "plugins");
  const std::string whole = slurp(plugins().plugins().front().file);
  REQUIRE(whole.size() > 1000);
  spill(folder / "plugins/truncated.so", whole.substr(0, whole.size() / 2));
  spill(folder / "plugins/text.so", "this is no plugin");
  spill(folder / "plugins/empty.so", "");
  spill(folder / "plugins/notes.txt", "not looked at");
  spill(folder / "scene.json", ball().dump());
  const Words environment{"MPM_PLUGIN_PATH=" + (folder / "plugins").string() + ":/no/such/folder"};
  for (const Words& words : {Words{"list"}, Words{"check", "scene.json"}}) {
    const Result result = call(folder, words, environment);
    INFO(result.err);
    CHECK(result.code == 0);
    CHECK(has(result.err, "warning: plugin " + (folder / "plugins/truncated.so").string() + ": is truncated ("));
    CHECK(has(result.err, "warning: plugin " + (folder / "plugins/text.so").string() + ": is not a shared object"));
    CHECK(has(result.err, "warning: plugin " + (folder / "plugins/empty.so").string() + ": is not a shared object"));
    CHECK(!has(result.err, "notes.txt"));
  }
}

TEST_CASE("an experiment cannot name a file to load") {
  const Folder folder;
  const std::string path = fs::absolute(plugins().plugins().front().file).string();
  for (const char* section : {"shape", "transfer"}) {
    Json scene = ball();
    scene[section]["type"] = path;
    spill(folder / "scene.json", scene.dump());
    const Result result = call(folder, {"run", "scene.json"});
    INFO(result.err);
    CHECK(result.code == 2);
    CHECK(has(result.err, std::string("/") + section));
    CHECK(!fs::exists(folder / "runs"));
  }
}
