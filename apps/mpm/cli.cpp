#include "mpm/cli.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <csignal>
#include <functional>
#include <iostream>
#include <new>
#include <set>
#include <utility>

#include "backends/device/device_plan.hpp"
#include "backends/device/program.hpp"
#include "drive/standard_paths.hpp"
#include "experiment/diagnostics.hpp"
#include "experiment/located_json.hpp"
#include "experiment/sections.hpp"
#include "experiment/units.hpp"
#include "metrics/exact.hpp"
#include "metrics/particle_quantities.hpp"
#include "mpm/drive.hpp"
#include "mpm/run_figures.hpp"
#include "output/run_folder.hpp"
#include "plugin/on_demand.hpp"
#include "solvers/solver.hpp"
#include "support/files.hpp"
#include "support/film_formats.hpp"

namespace mpm::app {
namespace {

constexpr const char* footer =
    R"(Exit codes: 0 done and every expectation held; 2 bad input, nothing was run; 3 the run became unstable or
invalid (what, where and when is printed; results so far are kept), or test-plugin found a plugin that fails, crashes
or hangs; 4 an expectation in "compare" failed, or the run broke a limit: it gained more than 1 % of energy out of
nothing, or a volume ratio J left 0.1 to 10 (flagged by name; other limits under "limits"), or compare found numbers
that differ; 5 the machine failed (disk, memory, device); 130 stopped by Ctrl-C at a step
boundary, everything written.
A run that was stopped, killed or had no room on the disk goes on from its last checkpoint with --resume.
Plugins are found in the build tree and in the folders of MPM_PLUGIN_PATH.)";

void add_experiment(CLI::App& verb, RunOptions& options) {
  verb.add_option("FILE", options.file, "experiment file (JSON, comments allowed)")->required();
  verb.add_option("--set", options.overrides, "/json/pointer=value: replaces a value of the file; may be repeated")
      ->allow_extra_args(false);
  verb.add_option("--backend", options.backend, "reference, cpu or cuda, in place of the file's");
}

void add_device(CLI::App& verb, std::string& device) {
  verb.add_option(
          "--device", device,
          "of backend cuda: the number of a device (mpm list --devices), or host, which runs the device's kernels "
          "on the processor; default what MPM_DEVICE says, else 0")
      ->check([](const std::string& word) {
        return device::names_device(word) ? "" : "expected \"host\" or the number of a device, got \"" + word + "\"";
      });
}

void add_bench(CLI::App& verb, BenchOptions& options, std::string& point) {
  verb.add_option("SECTION", options.sections, "what to measure; default all");
  verb.footer("Sections:\n" + bench_section_list() +
              "Exit codes: 0 also where a target is missed, which is printed; 4 then with --strict.");
  verb.add_flag("--json", options.json, "one JSON document in place of the tables");
  verb.add_flag("--quick", options.quick, "1/64 of the particles, 2 rounds: shows that everything runs, not how fast");
  verb.add_option("--repeats", options.repeats, "rounds; at least 5 unless --quick; default 5")
      ->check(CLI::Range(1, 1000));
  verb.add_option("--threads", options.threads, "of the parallel contenders; default all processors")
      ->check(CLI::Range(1, 1024));
  verb.add_flag("--processor-time", options.processor_time,
                "rates of one thread by the processor's time, not the wall's: for a busy machine");
  verb.add_option("--out", options.out, "folder for bench.json, tables as CSV, report.md and the roofline figure");
  verb.add_flag("--strict", options.strict, "exit code 4 when a target is missed");
  verb.add_option("--backend", options.backend, "cpu (the default), or cuda: the standard scenes on a device")
      ->check(CLI::IsMember({"cpu", "cuda"}));
  add_device(verb, options.device);
  verb.add_flag(
      "--predict", options.predict,
      "of backend cuda: counts bytes and operations, and predicts from them and from occupancy; needs no device");
  verb.add_option("--point", point, "of the program itself: one point of the section growth")->group("");
}

void add_study(CLI::App& verb, StudyOptions& options) {
  verb.add_option("FILE", options.file, "study file (JSON, comments allowed)")->required();
  verb.add_option("--set", options.overrides,
                  "/json/pointer=value: replaces a value of the base experiment in every run; may be repeated")
      ->allow_extra_args(false);
  verb.add_option("--out", options.out, "study folder; default runs/<name of the file>");
  verb.add_option("--jobs", options.jobs,
                  "runs at a time; default as many as the processors have threads for; 1 for undisturbed seconds")
      ->check(CLI::Range(1, 1024));
  verb.add_option("--threads", options.threads, "of each run; default 1")->check(CLI::Range(1, 1024));
  verb.footer(
      "Exit codes: 0 all combinations finished, stopped with a reason or were refused; 2 bad input, or every "
      "combination is refused; 4 a run gained energy, left the range of volume ratios, failed an expectation or "
      "crashed; 5 the "
      "machine failed; 130 stopped by Ctrl-C. Calling it again runs only what is missing or has changed.");
}

void add_advise(CLI::App& verb, AdviseOptions& options) {
  verb.add_option("STUDY", options.study, "folder of a study, or its file when it ran into the default folder")
      ->required();
  verb.add_option("--error", options.error, "largest error, such as 1% or \"0.1 mm\": the cheapest that reaches it");
  verb.add_option("--time", options.time, "largest time of stepping, such as 10s: the most exact within it");
  verb.add_option("--by", options.by, "with --error: measure that is to be small, such as particle_steps");
  verb.add_option("--measure", options.measure,
                  "measure that is the error, zero where nothing is wrong, in place of the study's own");
  verb.add_flag("--json", options.json, "as JSON");
  verb.footer("Exit code 4 when no combination reaches the target; the nearest are then listed.");
}

void add_compare(CLI::App& verb, CompareOptions& options) {
  verb.add_option("RUN", options.first, "run folder")->required();
  verb.add_option("OTHER", options.second, "run folder that is held against it")->required();
  verb.add_option("--tolerance", options.tolerance,
                  "largest relative difference of numbers that are taken as equal; default 0: the same bits")
      ->check(CLI::Range(0.0, 1.0));
  verb.add_flag("--json", options.json, "as JSON");
  verb.footer(
      "Judged are the numbers and words of summary.json, without those under \"performance\", and the columns of "
      "metrics.csv. A column is held against its largest number, a component against its vector's, an energy or a heat "
      "against the largest of its kind. Keys of the experiment and files that differ are told and not judged; above a "
      "tolerance of 0 neither are the ledger's books and warnings, which tell of rounding.\n"
      "Exit codes: 0 all agree within the tolerance; 2 bad input; 4 something does not agree.");
}

/// A check that takes a number from one bound to the other, and says them as they are written here.
std::function<std::string(const std::string&)> number_between(const std::string& least, const std::string& most) {
  return [=](const std::string& word) {
    const auto number = parse_number(word);
    const bool fits = number && *number >= parse_number(least) && *number <= parse_number(most);
    return fits ? "" : "expected a number from " + least + " to " + most + ", got " + word;
  };
}

void add_drive(CLI::App& verb, DriveOptions& options) {
  verb.add_option("ID", options.id, "material; or, with --extremes, the word every: a row of each that is installed")
      ->required();
  verb.add_option("--param", options.parameters,
                  "name=value: a parameter of the material, with a unit if wanted; may be repeated")
      ->allow_extra_args(false);
  std::vector<std::string> names;
  std::string list;
  for (const drive::StandardPath& path : drive::standard_paths()) {
    names.emplace_back(path.name);
    list += std::string("  ") + path.name + std::string(14 - names.back().size(), ' ') + path.doc + "\n";
  }
  auto* path = verb.add_option("--path", options.path, "one path; default all")->check(CLI::IsMember(names));
  auto* strain = verb.add_option("--strain", options.strain, "largest displacement gradient; default 0.1")
                     ->check(number_between("1e-9", "0.999"));
  auto* steps =
      verb.add_option("--steps", options.steps, "steps of one way; default 100")->check(CLI::Range(1, 1000000));
  verb.add_option("--duration", options.duration, "seconds of one way, for materials that flow or creep; default 1")
      ->check(number_between("1e-12", "1e12"));
  verb.add_option("--dimension", options.dimension, "3, or 2: plane strain; default 3 where the material can")
      ->check(CLI::IsMember({2, 3}));
  verb.add_option("--cell-size", options.cell_size, "of a grid, m, for materials that read it");
  auto* extremes =
      verb.add_flag("--extremes", options.extremes,
                    "in place of the paths: crushed to a millionth of its volume and torn to a million times, "
                    "drawn, pressed flat and sheared by 1e4, turned inside out, shaken by small cycles");
  for (CLI::Option* other : {path, strain, steps}) extremes->excludes(other);
  verb.add_option("--cycles", options.cycles, "of the extremes' small cycles; default 100000")
      ->check(CLI::Range(1, 100000000))
      ->needs(extremes);
  auto* out =
      verb.add_option("--out", options.out,
                      "folder that gets a run folder of each path: numbers, figures, report.html; with --extremes "
                      "figures of what was passed through, of every material a map")
          ->check([](const std::string& word) { return word.empty() ? "names no folder" : ""; });
  verb.add_flag("--replace", options.replace, "replaces whatever runs, and with --extremes figures, are there")
      ->needs(out);
  verb.footer(
      "Paths:\n" + list +
      "The first slope is that of the first step: E, G, K or the modulus M of uniaxial strain at small strains "
      "(E' in plane strain); of a material with viscosity also that over the step's time. The residual is work less "
      "stored and dissipated energy, over the turnover.\n"
      "At an extreme a material is right, or refuses the particle, and a run would stop there and name it; a number "
      "that is "
      "none, a wrong J, a negative energy and a state that no body can have and that is taken are failures.\n"
      "Exit codes: 0 done; 2 bad input; 3 a path could not be followed to its end, or an extreme failed; 5 the machine "
      "failed; 130 stopped "
      "by Ctrl-C between two steps or two extremes.");
}

std::string quoted_for_a_shell(const std::string& word) {
  const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return c >= 128 || std::isalnum(c) ||
           std::string_view("_@%+=:,./-").find(static_cast<char>(c)) != std::string::npos;
  });
  if (plain) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

std::string typed_command(int argc, char** argv) {
  std::string command = "./mpm";
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    command += " " + quoted_for_a_shell(word);
  }
  return command;
}

int complain(const std::string& message, int code) {
  std::cerr << message << "\n";
  return code;
}

/// The one place where errors become messages and exit codes.
template <class Verb>
int guarded(Verb verb, const std::string& nothing = "nothing was run") {
  try {
    return verb();
  } catch (const InputError& error) {
    const auto count = error.problems().size();
    return complain(
        std::string(error.what()) + "\n" + (count > 1 ? std::to_string(count) + " mistakes; " : "") + nothing,
        bad_input);
  } catch (const output::FolderRefused& error) {
    return complain(error.what(), bad_input);
  } catch (const PluginError& error) {
    return complain(error.what(), bad_input);
  } catch (const std::bad_alloc&) {
    return complain(
        "out of memory: use larger cells, fewer particles a cell or --set /precision=float; what was written before is "
        "kept",
        machine_failed);
  } catch (const std::exception& error) {  // MachineError, and whatever the system refused
    return complain(error.what(), machine_failed);
  }
}

/// Says that a first word is no verb, with the nearest one; an empty string when it is one (or an option, or missing).
std::string wrong_verb(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return "";
  std::vector<std::string> verbs;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    verbs.push_back(verb->get_name());
  if (std::find(verbs.begin(), verbs.end(), argv[1]) != verbs.end()) return "";
  return "no verb is called " + in_quotes(argv[1]) + suggestion(argv[1], verbs, "verbs are " + quoted_list(verbs));
}

/// Says what a verb was given beyond what it takes, with the nearest option it has.
std::string unexpected_words(const CLI::App& app) {
  std::string message;
  for (const CLI::App* verb : app.get_subcommands()) {
    std::vector<std::string> options;
    for (const CLI::Option* option : verb->get_options())
      for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
    for (const std::string& word : verb->remaining()) {
      if (!message.empty()) message += "\n";
      message += "mpm " + verb->get_name() + " takes no " + in_quotes(word);
      message += word.starts_with("-") ? suggestion(word, options, "options are " + quoted_list(options)) : "";
    }
  }
  return message;
}

Registry load_plugins() {
  Registry registry = Registry::from_folders(Registry::default_folders());
  for (const std::string& message : registry.rejected()) std::cerr << "warning: " << message << "\n";
  if (registry.plugins().empty())
    throw PluginError("no plugin was found: build the target `plugins`, or name their folder in MPM_PLUGIN_PATH");
  return registry;
}

void collect_words(const std::string& text, std::set<std::string, std::less<>>& words) {
  std::string word;
  for (const char c : text + " ") {
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '_')
      word += c;
    else
      words.insert(std::exchange(word, {}));
  }
}

/// Those of keys as well, which are pointers in a study; a title names nothing that is used.
void collect_words(const Node& node, std::set<std::string, std::less<>>& words) {
  if (node.type == Node::Type::string) collect_words(node.text, words);
  for (const Node& item : node.items) collect_words(item, words);
  for (const Member& member : node.members) {
    if (member.key == "title") continue;
    collect_words(member.key, words);
    collect_words(member.value, words);
  }
}

}  // namespace

std::set<std::string, std::less<>> words_of(const std::vector<std::filesystem::path>& files,
                                            const std::vector<std::string>& overrides) {
  std::set<std::string, std::less<>> words;
  for (const std::filesystem::path& file : files) collect_words(read_located(file), words);
  for (const std::string& change : overrides) collect_words(change, words);
  if (words.contains("contact")) words.insert({standard_normal, standard_detection});  // it need not name them
  return words;
}

Registry load_registry() {
  std::vector<std::string> targets;
  for (const PluginTarget& plugin : plugins_not_built()) targets.push_back(plugin.name());
  if (!targets.empty()) build_missing(targets);
  return load_plugins();
}

Registry load_registry_for(const std::vector<std::filesystem::path>& files, const std::vector<std::string>& overrides) {
  std::vector<PluginTarget> not_built = plugins_not_built();
  if (!not_built.empty()) {
    const auto words = words_of(files, overrides);
    std::vector<std::string> targets;
    for (const PluginTarget& plugin : not_built)
      if (words.contains(plugin.id)) targets.push_back(plugin.name());
    if (!targets.empty()) build_missing(targets);
    not_built = plugins_not_built();
  }
  Registry registry = load_plugins();
  registry.set_not_built(std::move(not_built));
  return registry;
}

ReadOptions read_options(const Registry& registry, const RunOptions& options) {
  ReadOptions read;
  read.solvers = solver_descriptions();
  read.overrides = options.overrides;
  read.backend = options.backend;
  read.exact = exact_solutions();
  read.figures = figure_names();
  read.colour_quantities = quantity_names(registry);
  return read;
}

int run_command_line(int argc, char** argv) {
  CLI::App app("MPM Sandbox: material point method experiments from JSON files, components as plugins", "mpm");
  app.footer(footer);
  app.require_subcommand(1);
  app.set_version_flag("--version", std::string("mpm ") + MPM_VERSION);
  RunOptions options;
  options.command = typed_command(argc, argv);
  bool json = false;
  std::string id;
  std::vector<std::filesystem::path> runs;
  std::filesystem::path specification, figure_out;
  std::string kind;
  std::filesystem::path plugin_file, plugin_folder;
  double seconds = 120;
  bool verbose = false;
  int code = done;

  auto* run_verb =
      app.add_subcommand("run", "run an experiment; writes figures, report.html and numbers to its run folder");
  add_experiment(*run_verb, options);
  run_verb->add_option("--out", options.out, "run folder; default runs/<name of the file>");
  run_verb
      ->add_option(
          "--threads", options.threads,
          "of the cpu backend, at most one a processor; default all processors that it may use; results do not depend "
          "on it")
      ->check(CLI::Range(1, 1024));
  add_device(*run_verb, options.device);
  run_verb->add_flag("--resume", options.resume,
                     "goes on with the unfinished run in the run folder, from its last checkpoint, bit for bit; with "
                     "the same FILE and --set. With another --backend it goes on from the same state, with that "
                     "backend's rounding");
  auto* replace = run_verb->add_flag(
      "--replace", options.replace,
      "replaces whatever run the run folder holds. Without it a finished run of the same experiment is replaced, "
      "which is said, and one of another experiment, or one that --resume could go on with, is refused (code 2). Files "
      "that no run writes stay");
  run_verb->get_option("--resume")->excludes(replace);
  run_verb->callback([&] { code = guarded([&] { return run(options); }); });

  auto* check_verb =
      app.add_subcommand("check", "validate an experiment or a study; every mistake is listed with its place");
  add_experiment(*check_verb, options);
  check_verb->callback([&] { code = guarded([&] { return check(options); }); });

  auto* plan_verb =
      app.add_subcommand("plan", "show what a run will hold and do, with bytes, and which line asked for it");
  add_experiment(*plan_verb, options);
  plan_verb->add_flag("--json", json, "as JSON");
  std::string graph;
  plan_verb->add_option("--graph", graph, "writes the step as a picture (SVG): operators, fields, loops, and who asked")
      ->type_name("OUT.svg");
  std::string architecture = device::multiprocessors().back().architecture;
  plan_verb
      ->add_option(
          "--architecture", architecture,
          "of backend cuda: what its kernels are compiled for to see what they take (sm_80 or sm_90, by default "
          "sm_90); nothing is run")
      ->check([](const std::string& word) {
        try {
          return device::multiprocessor(word), std::string();
        } catch (const std::invalid_argument& error) {
          return std::string(error.what());
        }
      });
  plan_verb->callback([&] { code = guarded([&] { return plan(options, json, graph, architecture); }); });

  auto* list_verb = app.add_subcommand("list", "every plugin found, by kind");
  list_verb->add_flag("--json", json, "as JSON");
  bool combinations = false;
  list_verb->add_flag("--combinations", combinations, "which components run together, and which are refused and why");
  bool devices = false;
  list_verb->add_flag("--devices", devices, "the devices of backend cuda instead, or what is missing for one");
  list_verb->callback([&] {
    code = guarded([&] { return devices ? list_devices() : combinations ? list_combinations(json) : list(json); });
  });

  auto* cache_verb = app.add_subcommand("cache", "the compiled kernels that are kept for later runs on a device");
  bool clear = false;
  cache_verb->add_flag("--clear", clear, "removes them");
  cache_verb->callback([&] { code = guarded([&] { return cache(clear); }, "not all were removed"); });

  auto* describe_verb = app.add_subcommand("describe", "one plugin's manual, parameters, state and citation");
  describe_verb->add_option("ID", id, "id, or kind/id where two kinds share an id")->required();
  describe_verb->add_flag("--json", json, "as JSON");
  describe_verb->callback([&] { code = guarded([&] { return describe(id, json); }); });

  std::string shape = "bspline_quadratic";
  int particles = 2;
  std::filesystem::path stem;
  auto* offset_verb = app.add_subcommand(
      "contact-offset", "how far apart a node sees two bodies that touch, which contact detection accounts for");
  offset_verb->add_option("SHAPE", shape, "shape function; default bspline_quadratic");
  offset_verb->add_option("--particles", particles, "particles a cell and axis; default 2")->check(CLI::Range(1, 64));
  offset_verb
      ->add_option("--figure", stem, "draws it as well: STEM.png, STEM.svg and STEM.csv, in a folder that exists")
      ->type_name("STEM");
  offset_verb->callback([&] { code = guarded([&] { return contact_offset(shape, particles, stem); }); });

  auto* normals_verb = app.add_subcommand(
      "contact-normals", "how far each contact normal turns from the true one, along a flat face and around a disc");
  normals_verb->add_option("SHAPE", shape, "shape function, a tensor product; default bspline_quadratic");
  normals_verb
      ->add_option("--figure", stem,
                   "draws it as well: STEM and STEM_end, each .png, .svg and .csv, in a folder that exists")
      ->type_name("STEM");
  normals_verb->callback([&] { code = guarded([&] { return contact_normals(shape, stem); }); });

  auto* schema_verb = app.add_subcommand(
      "schema", "print the JSON Schema of experiment files, those of a material point too, for editors");
  schema_verb->callback([&] { code = guarded([&] { return schema(); }); });

  auto* figure_verb =
      app.add_subcommand("figure", "draw figures again from recorded numbers; several runs are laid over one another");
  figure_verb->add_option("RUN", runs, "run folders")->required();
  figure_verb->add_option("--spec", specification,
                          "JSON: {\"title\", \"x\", \"y\", \"log_x\", \"log_y\", \"labels\"}, columns of metrics.csv");
  figure_verb->add_option("--out", figure_out,
                          "folder for the figures; default figures/ of the run, or runs/overlay for several");
  figure_verb->callback(
      [&] { code = guarded([&] { return figure(runs, specification, figure_out); }, "nothing was drawn"); });

  std::filesystem::path film_run;
  std::string format = "mp4";
  auto* film_verb =
      app.add_subcommand("film", "join the frames of a recorded run to a film, film.FORMAT in its folder");
  film_verb->add_option("RUN", film_run, "run folder")->required();
  film_verb->add_option("--format", format, "webp is an animated picture, for pages")
      ->check(CLI::IsMember(support::film_formats()))
      ->capture_default_str();
  film_verb->callback([&] { code = guarded([&] { return film(film_run, format); }, "no film was made"); });

  DriveOptions drive_options;
  drive_options.command = options.command;
  auto* drive_verb = app.add_subcommand(
      "drive", "one particle of a material along standard paths: its moduli, strength, heat, and energy balance");
  add_drive(*drive_verb, drive_options);
  drive_verb->callback([&] { code = guarded([&] { return drive_material(drive_options); }); });

  StudyOptions study_options;
  study_options.command = options.command;
  auto* study_verb = app.add_subcommand("study", "run every combination of a study's axes; tables, figures, report");
  add_study(*study_verb, study_options);
  study_verb->callback([&] { code = guarded([&] { return study(study_options); }); });

  AdviseOptions advise_options;
  auto* advise_verb =
      app.add_subcommand("advise", "the best combination that a study measured, for an error or a time");
  add_advise(*advise_verb, advise_options);
  advise_verb->callback([&] { code = guarded([&] { return advise(advise_options); }, "no advice was given"); });

  CompareOptions compare_options;
  auto* compare_verb = app.add_subcommand("compare", "print what differs between two runs, and by how much");
  add_compare(*compare_verb, compare_options);
  compare_verb->callback([&] { code = guarded([&] { return compare(compare_options); }, "nothing was compared"); });

  BenchOptions bench_options;
  bench_options.command = options.command;
  std::string point;
  auto* bench_verb = app.add_subcommand("bench", "measure the speed on the standard scenes (docs/benchmarks)");
  add_bench(*bench_verb, bench_options, point);
  bench_verb->callback([&] {
    code = guarded([&] {
      if (!point.empty()) return bench_point(point);
      return bench_options.backend == "cuda" ? bench_device(bench_options) : bench(bench_options);
    });
  });

  auto* new_verb = app.add_subcommand("new", "write a project for a plugin of your own, with an experiment and a test");
  new_verb->add_option("KIND", kind, "shape, transfer, filter, contact, normal, detection or material")->required();
  new_verb->add_option("ID", id, "the word that experiments will use, e.g. my_rubber")->required();
  new_verb->add_option("DIR", plugin_folder, "folder to write, new or empty")->required();
  new_verb->callback(
      [&] { code = guarded([&] { return new_plugin(kind, id, plugin_folder); }, "nothing was written"); });

  auto* test_verb = app.add_subcommand("test-plugin", "run the conformance suite on a plugin's file");
  test_verb->add_option("FILE", plugin_file, "the plugin, KIND_ID.so")->required();
  test_verb->add_option("--seconds", seconds, "time after which a plugin counts as hung; default 120")
      ->check(CLI::Range(0.1, 86400.0));
  test_verb->add_flag("--verbose", verbose, "every check, not only those that failed");
  test_verb->add_flag("--json", json, "as JSON; a number that is not finite is null");
  bool no_device = false;
  test_verb->add_flag("--no-device", no_device,
                      "leaves out the functor's text in the device's kernels, which a compiler of the system compiles");
  test_verb->callback(
      [&] { code = guarded([&] { return test_plugin(plugin_file, seconds, verbose, json, !no_device); }); });

  // A limit on file size is then an error of writing, with its message, like a full disk.
  std::signal(SIGXFSZ, SIG_IGN);
  if (const std::string wrong = wrong_verb(app, argc, argv); !wrong.empty()) return complain(wrong, bad_input);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ExtrasError& error) {
    const std::string message = unexpected_words(app);
    return complain(message.empty() ? error.what() : message, bad_input);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? static_cast<int>(done) : static_cast<int>(bad_input);
  }
  return code;
}

}  // namespace mpm::app
