// Verbs that compute nothing: check, plan, list, describe, schema.

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <optional>
#include <sstream>

#include "backends/device/cache.hpp"
#include "backends/device/device.hpp"
#include "backends/device/device_plan.hpp"
#include "backends/device/program.hpp"
#include "backends/make_backend.hpp"
#include "drive/read_drive.hpp"
#include "drive/sections.hpp"
#include "experiment/diagnostics.hpp"
#include "experiment/located_json.hpp"
#include "experiment/schema.hpp"
#include "mpm/cli.hpp"
#include "mpm/drive.hpp"
#include "mpm/run_figures.hpp"
#include "plan/compatibility.hpp"
#include "plugin/extension_of.hpp"
#include "run/start_checks.hpp"
#include "simulation/backend.hpp"
#include "solvers/solver.hpp"
#include "study/run_study.hpp"
#include "study/study.hpp"
#include "support/files.hpp"

namespace mpm::app {
namespace {

using Json = nlohmann::ordered_json;

std::string choice_at(const mpm_parameter& parameter, int index) {
  std::stringstream list(parameter.choices);
  std::string choice;
  for (int k = 0; k <= index; ++k) std::getline(list, choice, '|');
  return choice;
}

std::string default_text(const mpm_parameter& parameter) {
  if (parameter.flags & MPM_REQUIRED) return "required";
  if (parameter.type == MPM_CHOICE)
    return "\"" + choice_at(parameter, static_cast<int>(parameter.default_value)) + "\"";
  if (parameter.type == MPM_BOOLEAN) return parameter.default_value != 0 ? "true" : "false";
  return number_text(parameter.default_value);
}

std::string range_text(const mpm_parameter& p) {
  if (p.type == MPM_CHOICE) return std::string("one of ") + p.choices;
  if (p.type == MPM_BOOLEAN) return "true or false";
  const bool below = std::isfinite(p.minimum), above = std::isfinite(p.maximum);
  std::string text;
  if (below) text += (p.flags & MPM_ABOVE_MINIMUM ? "above " : "at least ") + number_text(p.minimum);
  if (above)
    text +=
        std::string(below ? ", " : "") + (p.flags & MPM_BELOW_MAXIMUM ? "below " : "at most ") + number_text(p.maximum);
  return text.empty() ? "any number" : text;
}

constexpr const char* shape_names[] = {"scalar", "vector", "matrix", "symmetric", "deformation", "plane deformation"};

/// Whether a material runs in axisymmetric scenes.
bool strains_around_axis(const Plugin& plugin) {
  return plugin.descriptor->kind == MPM_MATERIAL && (plugin.material().traits & MPM_STRAINS_AROUND_AXIS);
}

Json description(const Plugin& plugin) {
  const mpm_descriptor& d = *plugin.descriptor;
  Json json{{"id", d.id},
            {"kind", kind_name(static_cast<mpm_kind>(d.kind))},
            {"version", d.version},
            {"summary", d.summary},
            {"citation", d.citation},
            {"manual", d.manual}};
  json["dimensions"] = Json::array();
  if (d.dimensions & MPM_2D) json["dimensions"].push_back(2);
  if (d.dimensions & MPM_3D) json["dimensions"].push_back(3);
  if (d.kind == MPM_MATERIAL) json["axisymmetric"] = strains_around_axis(plugin);
  json["precisions"] = Json::array();
  if (d.precisions & (1u << MPM_LANES_FLOAT)) json["precisions"].push_back("float");
  if (d.precisions & (1u << MPM_LANES_DOUBLE)) json["precisions"].push_back("double");
  json["parameters"] = Json::array();
  for (const mpm_parameter& p : plugin.parameters())
    json["parameters"].push_back(
        {{"name", p.name}, {"unit", p.unit}, {"default", default_text(p)}, {"range", range_text(p)}, {"doc", p.doc}});
  json["state"] = Json::array();
  for (const mpm_state& s : plugin.state())
    json["state"].push_back({{"name", s.name}, {"shape", shape_names[s.shape]}, {"unit", s.unit}, {"doc", s.doc}});
  json["file"] = plugin.file.filename().string();
  return json;
}

void print(const Plugin& plugin) {
  const mpm_descriptor& d = *plugin.descriptor;
  std::cout << d.id << " (" << kind_name(static_cast<mpm_kind>(d.kind)) << " " << d.version << ", "
            << plugin.file.filename().string() << ")\n"
            << d.summary << "\n\n"
            << d.manual << "\n\nSource: " << d.citation << "\n";
  const bool two = d.dimensions & MPM_2D, three = d.dimensions & MPM_3D;
  std::cout << "Runs in: " << (two ? "2-D " : "") << (strains_around_axis(plugin) ? "axisymmetric " : "")
            << (three ? "3-D " : "") << "| " << (d.precisions & (1u << MPM_LANES_FLOAT) ? "float " : "")
            << (d.precisions & (1u << MPM_LANES_DOUBLE) ? "double" : "") << "\n";
  if (d.kind == MPM_SHAPE) {
    const mpm_shape& shape = plugin.shape();
    if (shape.form == MPM_NODE_LIST)
      std::cout << "A list of at most " << shape.capacity[0] << " nodes in 2-D, " << shape.capacity[1] << " in 3-D";
    else
      std::cout << "Nodes an axis: " << shape.width;
    std::cout << "; second moment: "
              << (shape.second_moment_kind == MPM_MOMENT_IS_GRADIENT    ? "w D^-1 d = grad w"
                  : shape.second_moment_kind == MPM_MOMENT_PER_PARTICLE ? "one a particle"
                                                                        : number_text(shape.second_moment) + " h^2")
              << "\n";
    if (shape.sample_points[0] > 0)
      std::cout << "Carries the " << shape.sample_points[0] << " corners of its domain in 2-D, "
                << shape.sample_points[1] << " in 3-D, which the grid's velocity moves\n";
    if (d.needs & MPM_NEEDS_HALF_SIZE) std::cout << "Needs the size of the undeformed particle\n";
    if (d.needs & MPM_NEEDS_DOMAIN) std::cout << "Needs the deformed domain of the particle, which it then carries\n";
  }
  if (double Ledger::*const row = d.kind == MPM_MATERIAL ? dissipation_of(plugin) : nullptr)
    std::cout << "Dissipates by: " << name_of(row) << " (row of the energy ledger)\n";
  std::string extensions;
  for (const KnownExtension& known : known_extensions())
    if (plugin.extension(known.id)) extensions += std::string(extensions.empty() ? "" : ", ") + known.id;
  if (!extensions.empty()) std::cout << "Extensions: " << extensions << "\n";
  std::cout << "\nParameters" << (plugin.parameters().empty() ? ": none\n" : "\n");
  for (const mpm_parameter& p : plugin.parameters())
    std::cout << "  " << p.name << (*p.unit ? std::string(" (") + p.unit + ")" : "") << ", default " << default_text(p)
              << ", " << range_text(p) << "\n      " << p.doc << "\n";
  std::cout << "State a particle" << (plugin.state().empty() ? ": none\n" : "\n");
  for (const mpm_state& s : plugin.state())
    std::cout << "  " << s.name << ", " << shape_names[s.shape] << (*s.unit ? std::string(" (") + s.unit + ")" : "")
              << "\n      " << s.doc << "\n";
}

std::vector<const Plugin*> matching(const Registry& registry, const std::string& id) {
  std::vector<const Plugin*> found;
  for (const Plugin& plugin : registry.plugins()) {
    const std::string name(plugin.id()), kind(kind_name(static_cast<mpm_kind>(plugin.descriptor->kind)));
    if (id == name || id == kind + "/" + name) found.push_back(&plugin);
  }
  return found;
}

constexpr double most_to_place = 500'000;  ///< particles that are placed in a second or so

struct Start {
  std::size_t particles;
  std::vector<std::string> warnings;
};

/// Places the particles and tries their first moment, as a run would; nothing where they are too many for a check. Throws
/// InputError.
std::optional<Start> try_start(const Experiment& experiment, const Plan& plan) {
  if (static_cast<double>(plan.particles) > most_to_place) return {};
  const Simulation simulation(experiment, unstepped_backend_factory());
  return Start{simulation.particle_count(), check_start(simulation)};
}

/// Validates a study and the experiment of each of its combinations. One that is refused is no mistake, as in a run of
/// the study, unless all are.
int check_study(const RunOptions& options) {
  std::vector<std::string> overrides = options.overrides;
  if (options.backend) overrides.push_back("/backend=" + *options.backend);
  const study::Study plan = study::read_study(options.file, overrides);
  refuse_material_point(plan.base, plan.file, overrides);
  read_located(plan.base);  // a base that is no JSON is one mistake, not one a combination
  const Registry registry = load_registry_for({plan.file, plan.base}, overrides);
  const std::vector<study::Combination> combinations = study::expand(plan);
  std::vector<Problem> refused;
  ReadOptions read = read_options(registry, {});
  bool started = false;
  for (const study::Combination& combination : combinations) {
    read.overrides = combination.overrides;
    if (plan.bisection)
      read.overrides.push_back(plan.bisection->pointer + "=" +
                               Json(plan.bisection->from * plan.bisection->scale).dump());
    try {
      const Experiment experiment = read_experiment(plan.base, registry, read);
      const Plan step = make_plan(experiment);
      if (!started) try_start(experiment, step), started = true;  // one stands for all: they differ in a few keys
    } catch (const InputError& error) {
      refused.push_back(
          {plan.file.string(), 0, 0, "", combination.name + ": " + study::reason_of(error, plan, read.overrides)});
    }
  }
  if (refused.size() == combinations.size()) throw InputError(std::move(refused));
  std::cout << options.file.string() << ": ok, a study of " << combinations.size() << " combinations of "
            << plan.base.string();
  if (!refused.empty()) std::cout << ", of which " << refused.size() << " will be refused:";
  std::cout << "\n";
  for (const Problem& problem : refused) std::cout << "  " << problem.message << "\n";
  return done;
}

}  // namespace

void refuse_study(const std::filesystem::path& file, const std::string& verb) {
  if (!study::is_study(read_located(file))) return;
  throw InputError(
      {Problem{file.string(), 1, 1, "",
               "this is a study (it has \"base\" and \"axes\"), and mpm " + verb +
                   " takes an experiment: use `mpm study " + file.string() + "`, or `mpm check` to validate it"}});
}

int check(const RunOptions& options) {
  if (study::is_study(read_located(options.file))) return check_study(options);
  if (drive::is_material_point(options.file, options.overrides)) return check_material_point(options);
  const Registry registry = load_registry_for({options.file}, options.overrides);
  const Experiment experiment = read_experiment(options.file, registry, read_options(registry, options));
  const Plan plan = make_plan(experiment);
  refuse_unknown_records(experiment);
  const std::optional<Start> placed = try_start(experiment, plan);
  std::cout << options.file.string() << ": ok, " << experiment.dimension << "-D, " << experiment.bodies.size()
            << (experiment.bodies.size() == 1 ? " body" : " bodies") << ", "
            << (placed ? std::to_string(placed->particles) : "about " + std::to_string(plan.particles)) << " particles"
            << (placed ? "" : " (too many to be placed here)") << ", " << experiment.shape.plugin->id() << " + "
            << experiment.transfer.plugin->id() << "\n";
  if (placed)
    for (const std::string& warning : placed->warnings) std::cerr << "warning: " << warning << "\n";
  return done;
}

int plan(const RunOptions& options, bool json, const std::string& graph, const std::string& architecture) {
  refuse_study(options.file, "plan");
  if (drive::is_material_point(options.file, options.overrides))
    throw InputError({Problem{options.file.string(), 1, 1, "",
                              "a material point has no plan: its step is one update of one particle; `mpm check` "
                              "validates it, `mpm run` runs it"}});
  const Registry registry = load_registry_for({options.file}, options.overrides);
  const Experiment experiment = read_experiment(options.file, registry, read_options(registry, options));
  const Plan plan = make_plan(experiment);
  if (!graph.empty()) {
    const std::string title = experiment.title.empty() ? options.file.stem().string() : experiment.title;
    support::write_atomically(graph, plan.to_svg("One step of: " + title));
    std::cout << graph << "\n";
    return done;
  }
  std::optional<device::DevicePlan> on_device;
  if (experiment.backend == "cuda")
    on_device = device::device_plan(experiment, plan, device::multiprocessor(architecture));
  if (json) {
    Json document = plan.to_json();
    if (on_device) document["device"] = on_device->to_json();
    std::cout << document.dump(2) << "\n";
  } else {
    std::cout << plan.to_text() << (on_device ? on_device->to_text() : "");
  }
  return done;
}

int list_devices() {
  std::cout << device::device_list();
  return done;
}

int cache(bool clear) {
  const device::ProgramCache cache = device::ProgramCache::of_user();
  if (cache.folder().empty()) {
    std::cout << "compiled programs are not kept: MPM_CACHE is empty, or there is no home folder\n";
    return done;
  }
  const auto [programs, bytes] = clear ? cache.clear() : cache.contents();
  const auto words = [](std::uint64_t size) { return device::bytes_in_words(static_cast<double>(size)); };
  std::cout << cache.folder().string() << (clear ? ": removed " : ": ") << programs
            << (programs == 1 ? " program, " : " programs, ") << words(bytes);
  if (!clear) std::cout << " of at most " << words(cache.most_bytes());
  std::cout << "\n";
  return done;
}

int list(bool json) {
  const Registry registry = load_registry();
  Json all = Json::object();
  for (const mpm_kind kind : all_kinds()) {
    const auto plugins = registry.of_kind(kind);
    if (!json && !plugins.empty()) std::cout << kind_plural(kind) << "\n";
    for (const Plugin* plugin : plugins) {
      all[std::string(kind_name(kind))].push_back(description(*plugin));
      if (!json)
        std::cout << "  " << std::left << std::setw(27) << plugin->id() << " " << plugin->descriptor->summary << "\n";
    }
  }
  if (json) std::cout << all.dump(2) << "\n";
  return done;
}

namespace {

constexpr const char* update_names[] = {"first", "last", "modified_last", "averaged"};

std::string id_of(const Plugin* plugin) {
  return plugin ? std::string(plugin->id()) : "none";
}

/// Prints a table of transfers against filters: what holds for every shape, contact law and stress update.
void print_filters(const Registry& registry) {
  const auto filters = registry.of_kind(MPM_FILTER);
  std::cout << "| transfer |";
  for (const Plugin* filter : filters) std::cout << " `" << filter->id() << "` at every step | periodically |";
  std::cout << "\n|---|";
  for (std::size_t k = 0; k < filters.size(); ++k) std::cout << "---|---|";
  std::cout << "\n";
  for (const Plugin* transfer : registry.of_kind(MPM_TRANSFER)) {
    std::cout << "| `" << transfer->id() << "` |";
    for (const Plugin* filter : filters)
      for (const bool every_step : {true, false}) {
        const Mix mix{registry.of_kind(MPM_SHAPE).front(), transfer, filter, nullptr, StressUpdate::last, every_step};
        std::cout << (refusal_of(mix) ? " refused |" : " runs |");
      }
    std::cout << "\n";
  }
}

/// Prints which contact normals and detections do not mix with everything.
void print_normals(const Registry& registry) {
  std::cout << "\nContact normals and detections run with one another, with every law but a weld, which looks at none, "
               "and with every shape, transfer and stress update.\n";
  std::string by_surfaces;
  for (const Plugin* detection : registry.of_kind(MPM_DETECTION))
    if (detection->detection().traits & MPM_READS_PARTICLE_SURFACES)
      by_surfaces += (by_surfaces.empty() ? ", and with detection by `" : ", `") + std::string(detection->id()) + "`";
  for (const Plugin* normal : registry.of_kind(MPM_NORMAL))
    if (normal->normal().traits & MPM_OWN_NORMALS)
      std::cout << "`" << normal->id() << "` gives each body an impulse of its own: it is refused with a filter"
                << by_surfaces << ".\n";
}

}  // namespace

int list_combinations(bool json) {
  const Registry registry = load_registry();
  const std::vector<Mix> mixes = all_mixes(registry);
  Json refused = Json::array();
  std::vector<std::string> reasons;
  for (const Mix& mix : mixes) {
    const auto refusal = refusal_of(mix);
    if (!refusal) continue;
    refused.push_back({{"shape", id_of(mix.shape)},
                       {"transfer", id_of(mix.transfer)},
                       {"filter", id_of(mix.filter)},
                       {"filtered_every_step", mix.filtered_every_step},
                       {"contact", id_of(mix.contact)},
                       {"stress_update", update_names[static_cast<int>(mix.stress_update)]},
                       {"reason", refusal->reason}});
    if (std::find(reasons.begin(), reasons.end(), refusal->reason) == reasons.end()) reasons.push_back(refusal->reason);
  }
  if (json) {
    std::cout << Json{{"combinations", mixes.size()}, {"refused", refused}}.dump(2) << "\n";
    return done;
  }
  for (const mpm_kind kind : all_kinds()) {
    std::cout << "- " << kind_plural(kind) << ":";
    for (const Plugin* plugin : registry.of_kind(kind)) std::cout << " `" << plugin->id() << "`";
    std::cout << "\n";
  }
  std::cout
      << "\nShape x transfer x filter (none, at every step, periodically) x contact (none, each law) x stress update: "
      << mixes.size() << " combinations, " << refused.size() << " refused, for " << reasons.size()
      << (reasons.size() == 1 ? " reason" : " reasons")
      << " (a transfer with a choice of polynomials counts once for each order)"
      << ". The others run on every backend, in 2-D and 3-D, with every material.\n\n";
  print_filters(registry);
  std::cout << "\nRefused at load, with this reason:\n\n";
  for (const std::string& reason : reasons) std::cout << "- " << reason << "\n";
  print_normals(registry);
  return done;
}

int describe(const std::string& id, bool json) {
  const Registry registry = load_registry_for({}, {id});
  const auto found = matching(registry, id);
  if (found.empty()) {
    std::vector<std::string> names;
    for (const Plugin& plugin : registry.plugins()) names.emplace_back(plugin.id());
    for (const PluginTarget& plugin : registry.not_built()) names.push_back(plugin.id);
    throw PluginError("no plugin is called " + in_quotes(id) + did_you_mean(id, names) +
                      "; `mpm list` shows all: " + quoted_list(names));
  }
  if (json) {
    Json all = Json::array();
    for (const Plugin* plugin : found) all.push_back(description(*plugin));
    std::cout << (all.size() == 1 ? all[0] : all).dump(2) << "\n";
    return done;
  }
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (k) std::cout << "\n----\n\n";
    print(*found[k]);
  }
  return done;
}

int schema() {
  const Registry registry = load_registry();
  const std::vector<FileKind> others{
      {drive::drive_section(), drive::solver_section(), {{"stages", drive::stage_section(3)}}}};
  std::cout << json_schema(ComponentLookup(registry), read_options(registry, {}), others).dump(2) << "\n";
  return done;
}

}  // namespace mpm::app
