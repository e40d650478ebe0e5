// A material point: `mpm run` on files with that solver, and the verb `drive`, standard paths of any material.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <optional>

#include "drive/read_drive.hpp"
#include "drive/results.hpp"
#include "drive/standard_paths.hpp"
#include "experiment/diagnostics.hpp"
#include "mpm/drive.hpp"
#include "mpm/drive_extremes.hpp"
#include "mpm/stop_on_signal.hpp"
#include "output/manifest.hpp"
#include "output/report.hpp"
#include "output/run_folder.hpp"
#include "run/earlier_run.hpp"
#include "run/summary.hpp"
#include "support/files.hpp"
#include "support/hash.hpp"
#include "support/numbers.hpp"

namespace mpm::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using drive::Course;
using drive::DriveExperiment;

Json manifest(const DriveExperiment& path, const std::string& command, const std::string& text) {
  const Plugin& plugin = *path.material().plugin;
  const mpm_descriptor& d = *plugin.descriptor;
  Json json{{"program", "mpm"},
            {"version", MPM_VERSION},
            {"command", command},
            {"experiment_file", path.experiment.file.filename().string()},
            {"experiment_sha256", support::sha256(text)},
            {"machine", output::machine_description()}};
  json["plugins"].push_back({{"id", d.id},
                             {"kind", kind_name(static_cast<mpm_kind>(d.kind))},
                             {"version", d.version},
                             {"summary", d.summary},
                             {"citation", d.citation},
                             {"file_sha256", support::sha256_of_file(plugin.file)}});
  return json;
}

void draw(const DriveExperiment& path, const Course& course, const fs::path& figures) {
  const std::string footnote = path.experiment.file.filename().string();
  const auto draw_if_any = [&](const render::Plot& plot, const char* name) {
    if (!plot.series.empty()) render::write_figure(plot, figures / name);
  };
  draw_if_any(stress_figure(path, course, footnote), "stress");
  draw_if_any(stress_over_time_figure(path, course, footnote), "stress_over_time");
  draw_if_any(energy_figure(path, course, footnote), "energy_per_volume");
}

std::string stop_text(const DriveExperiment& path, const drive::Stop& stop) {
  return "step " + std::to_string(stop.step) + " of " + path.stages[stop.stage].name +
         ", t = " + number_text(stop.time) + " s: " + stop.reason;
}

std::string interruption_text(const Course& course) {
  return "stopped by a signal after step " + std::to_string(course.rows.back().step);
}

int code_of(const Course& course) {
  return course.stop ? run_failed : course.is_interrupted ? interrupted : done;
}

/// Follows the path into a run folder. Returns the course and the exit code.
std::pair<Course, int> follow_into(const DriveExperiment& path, const fs::path& place, bool replace,
                                   const std::string& command, const std::string& text) {
  const auto folder = folder_for_new_run(place, path.experiment, replace);
  const output::FolderLock lock(folder.root());
  folder.write_json("manifest.json", manifest(path, command, text));
  folder.remove_temporary_files();
  folder.write_json("experiment.json", path.experiment.resolved);
  Course course = drive::follow(path, drive::Slopes::tangent, stop_requested);
  drive::write_table(path, course, folder.root() / "metrics.csv");
  Json summary = drive::summary_of(path, course);
  int code = code_of(course);
  summary["warnings"] = course.warnings;
  Json outcome{{"exit_code", code}, {"status", "done"}, {"reason", ""}};
  if (course.stop) {
    outcome = {{"exit_code", code},
               {"status", "failed"},
               {"reason", stop_text(path, *course.stop)},
               {"remedy", course.stop->remedy}};
    std::cerr << "the run failed: " << stop_text(path, *course.stop) << "\nremedy: " << course.stop->remedy << "\n";
  } else if (course.is_interrupted) {
    outcome = {{"exit_code", code}, {"status", "interrupted"}, {"reason", interruption_text(course)}};
    std::cerr << interruption_text(course) << "\n";
  } else if (const auto failed = judge_expectations(path.experiment, summary); !failed.empty()) {
    for (const std::string& sentence : failed) std::cerr << sentence << "\n";
    code = expectation_failed;
    outcome = {{"exit_code", code}, {"status", "expectation failed"}, {"reason", failed.front()}};
  }
  for (const std::string& warning : course.warnings) std::cerr << "warning: " << warning << "\n";
  summary["outcome"] = outcome;
  folder.write_json("summary.json", summary);
  draw(path, course, folder.figures());
  output::write_report(folder.root());
  return {std::move(course), code};
}

void refuse_options(const RunOptions& options) {
  const std::string one = "a material point is one particle in the material's plain entry: it takes no ";
  if (options.backend) refuse_input("--backend", one + "backend");
  if (!options.device.empty()) refuse_input("--device", one + "device");
  if (options.resume) refuse_input("--resume", one + "checkpoints, and starts anew");
}

// ---- the verb drive ------------------------------------------------------------------------------------------------

/// The material of the command line as it would stand in a file. Throws InputError where a parameter is missing.
Json material_of(const Plugin& plugin, const DriveOptions& options) {
  Json material{{"type", plugin.id()}};
  std::map<std::string, std::string> texts;  // as typed
  for (const std::string& given : options.parameters) {
    const std::size_t equals = given.find('=');
    if (equals == std::string::npos || equals == 0)
      refuse_input("--param", in_quotes(given) + " is not of the form name=value, e.g. density=1000");
    const std::string name = given.substr(0, equals), text = given.substr(equals + 1);
    if (name == "type") refuse_input("--param", "\"type\" is no parameter: the material is the word after `mpm drive`");
    if (const auto before = texts.find(name); before != texts.end())
      refuse_input("--param", in_quotes(name) + " is given twice: " + before->second + " and " + text);
    texts[name] = text;
    const Json value = Json::parse(text, nullptr, false);
    material[name] = value.is_discarded() || value.is_structured() ? Json(text) : value;
  }
  std::string list, example;
  for (const mpm_parameter& declared : plugin.parameters()) {
    if (!(declared.flags & MPM_REQUIRED) || material.contains(declared.name)) continue;
    const std::string unit = *declared.unit ? " (" + std::string(declared.unit) + ")" : "";
    list += "\n  " + std::string(declared.name) + unit + ": " + declared.doc;
    example += std::string(" --param ") + declared.name + "=…";
  }
  if (list.empty()) return material;
  refuse_input("mpm drive " + options.id, "these parameters have no default and need a value:" + list + "\nadd" +
                                              example + "; units may be written, as in --param 'density=1 g/cm^3'");
}

const Plugin& material_plugin(const Registry& registry, const std::string& id) {
  std::vector<std::string> names;
  for (const Plugin* plugin : registry.of_kind(MPM_MATERIAL)) {
    if (plugin->id() == id) return *plugin;
    names.emplace_back(plugin->id());
  }
  if (fs::path(id).extension() == ".json")
    refuse_input(id,
                 "mpm drive takes the id of a material; a file whose solver is a material point runs with `mpm run`");
  throw PluginError("no material is called " + in_quotes(id) + did_you_mean(id, names) + "; they are " +
                    quoted_list(names));
}

/// What the first step measures: a slope of stress against strain, or of pressure against the logarithm of J.
std::string modulus_of(const drive::StandardPath& standard, const DriveExperiment& path, const Course& course) {
  if (course.rows.size() < 2) return "";
  const drive::Row &start = course.rows[0], &next = course.rows[1];
  const auto [i, j] = drive::driven_component(path, course);
  const bool by_volume = *standard.modulus == 'K';
  const bool flat = path.experiment.dimension == 2 && *standard.modulus == 'E';
  const std::string name = std::string(standard.modulus) + (flat ? "'" : "") + " = ";
  constexpr double least = 1e-12;  // what is smaller has too few digits beside the 1 of F
  if (std::abs(next.F(i, j) - start.F(i, j)) < least) return name + "-";
  const double slope =
      by_volume ? -(pressure(next.response) - pressure(start.response)) /
                      std::log(next.response.volume_ratio / start.response.volume_ratio)
                : (next.response.cauchy(i, j) - start.response.cauchy(i, j)) / (next.F(i, j) - start.F(i, j));
  return name + support::exponential(slope);
}

void print_row(const drive::StandardPath& standard, const DriveExperiment& path, const Course& course) {
  double shear = 0, least = INFINITY, most = -INFINITY;
  for (const drive::Row& row : course.rows) {
    shear = std::max(shear, von_mises_stress(row.response));
    least = std::min(least, pressure(row.response)), most = std::max(most, pressure(row.response));
  }
  const drive::Row& end = course.rows.back();
  const double all = turnover(course);
  std::printf("%-14s%6zu  %-15s%12s%12s%12s%12s%12s%12s\n", standard.name, course.rows.size() - 1,
              modulus_of(standard, path, course).c_str(), support::exponential(shear).c_str(),
              support::exponential(least).c_str(), support::exponential(most).c_str(),
              support::exponential(end.response.stored - course.rows[0].response.stored).c_str(),
              support::exponential(end.dissipated).c_str(),
              support::exponential(all > 0 ? residual(course, end) / all : 0).c_str());
}

/// The experiment of a standard path. What its reader objects to is the command line's.
DriveExperiment read_standard(const DriveOptions& options, const std::string& name, const std::string& text,
                              const ComponentLookup& lookup) {
  std::vector<std::string> overrides;
  if (!options.cell_size.empty()) overrides.push_back("/solver/cell_size=" + options.cell_size);
  try {
    return drive::read_drive_text(text, options.id + "_" + name + ".json", lookup, overrides);
  } catch (const InputError& error) {
    std::vector<Problem> problems = error.problems();
    for (Problem& problem : problems) {
      problem = {"mpm drive " + options.id, 0, 0, problem.pointer, problem.message};
      const std::string key = "give \"cell_size\"";
      if (const auto at = problem.message.find(key); at != std::string::npos)
        problem.message.replace(at, key.size(), "give --cell-size H");
    }
    throw InputError(std::move(problems));
  }
}

void print_head(const DriveOptions& options, const drive::PathSize& size) {
  std::printf("%s, %d-D, strain %s, %d steps a way of %s s\n", options.id.c_str(), size.dimension,
              number_text(size.strain).c_str(), size.steps, number_text(size.duration).c_str());
  for (const auto& words :
       {std::array{"path", "steps", "first slope", "von Mises", "pressure", "pressure", "stored", "dissipated",
                   "residual"},
        std::array{"", "", "(Pa)", "most (Pa)", "least (Pa)", "most (Pa)", "(J/m^3)", "(J/m^3)", "/ turnover"}}) {
    std::printf("%-14s%6s  %-15s", words[0], words[1], words[2]);
    for (std::size_t k = 3; k < words.size(); ++k) std::printf("%12s", words[k]);
    std::printf("\n");
  }
}

}  // namespace

int run_material_point(const RunOptions& options) {
  refuse_options(options);
  const Registry registry = load_registry_for({options.file}, options.overrides);
  const ComponentLookup lookup(registry);
  const DriveExperiment path = drive::read_drive(options.file, lookup, options.overrides);
  const auto place = options.out.empty() ? fs::path("runs") / options.file.stem() : options.out;
  const StopOnSignal signals;
  const auto [course, code] =
      follow_into(path, place, options.replace, options.command, support::read_file(options.file));
  const drive::Row& end = course.rows.back();
  std::cout << "work " << number_text(end.work) << " J/m^3, stored "
            << number_text(end.response.stored - course.rows[0].response.stored) << ", dissipated "
            << number_text(end.dissipated) << ", residual " << number_text(residual(course, end))
            << "\nreport: " << (fs::absolute(place) / "report.html").lexically_relative(fs::current_path()).string()
            << std::endl;
  return code;
}

int check_material_point(const RunOptions& options) {
  refuse_options(options);
  const Registry registry = load_registry_for({options.file}, options.overrides);
  const DriveExperiment path = drive::read_drive(options.file, ComponentLookup(registry), options.overrides);
  long steps = 0;
  for (const drive::Stage& stage : path.stages) steps += stage.steps;
  std::cout << options.file.string() << ": ok, a material point of " << path.material().plugin->id() << ", "
            << path.experiment.dimension << "-D, " << path.stages.size()
            << (path.stages.size() == 1 ? " stage, " : " stages, ") << steps << (steps == 1 ? " step\n" : " steps\n");
  return done;
}

void refuse_material_point(const fs::path& base, const fs::path& study, const std::vector<std::string>& overrides) {
  std::error_code ignored;
  if (!fs::is_regular_file(base, ignored) || !drive::is_material_point(base, overrides)) return;
  refuse_input(study.string(), "a study runs scenes, and " + base.filename().string() +
                                   " is a material point: run it by itself with `mpm run`");
}

int drive_material(const DriveOptions& options) {
  if (options.id == "every") {
    if (!options.extremes || !options.parameters.empty() || !options.cell_size.empty())
      refuse_input("mpm drive every",
                   "takes --extremes, --cycles, --duration, --dimension, --out and --replace alone; other paths want "
                   "one material");
    return drive_every_to_extremes(options);
  }
  const Registry registry = load_registry();
  const ComponentLookup lookup(registry);
  const Plugin& plugin = material_plugin(registry, options.id);
  const Json material = material_of(plugin, options);
  drive::PathSize size;
  size.strain = options.strain, size.duration = options.duration, size.steps = options.steps;
  size.dimension = options.dimension ? options.dimension : plugin.descriptor->dimensions & MPM_3D ? 3 : 2;
  int worst = done;
  bool has_head = false;
  const StopOnSignal signals;
  if (options.extremes) {
    const std::string text = drive::standard_path("isotropic", size, material).dump(2);
    const DriveExperiment path = read_standard(options, "extremes", text, lookup);
    return drive_to_extremes(options, path.material(), size.dimension);
  }
  for (const drive::StandardPath& standard : drive::standard_paths()) {
    if (!options.path.empty() && options.path != standard.name) continue;
    if (stop_requested()) {
      std::printf("stopped by a signal before %s\n", standard.name);
      worst = interrupted;
      break;
    }
    const std::string text = drive::standard_path(standard.name, size, material).dump(2);
    const DriveExperiment path = read_standard(options, standard.name, text, lookup);
    if (!has_head) print_head(options, size), has_head = true;
    Course course;
    if (options.out.empty()) {
      course = drive::follow(path, drive::Slopes::tangent, stop_requested);
      worst = std::max(worst, code_of(course));
      for (const std::string& warning : course.warnings) std::cerr << "warning: " << warning << "\n";
    } else {
      auto [followed, code] = follow_into(path, options.out / standard.name, options.replace, options.command, text);
      course = std::move(followed), worst = std::max(worst, code);
    }
    print_row(standard, path, course);
    if (course.stop)
      std::printf("  stopped in %s\n  remedy: %s\n", stop_text(path, *course.stop).c_str(),
                  course.stop->remedy.c_str());
    if (course.is_interrupted) std::printf("  %s\n", interruption_text(course).c_str());
    std::fflush(stdout);
  }
  return worst;
}

}  // namespace mpm::app
