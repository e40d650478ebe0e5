// A build tree that holds part of what it can build: the launcher that started the program builds what a scene names.

#include <algorithm>

#include "cli/program.hpp"
#include "drive/read_drive.hpp"
#include "experiment/located_json.hpp"
#include "mpm/cli.hpp"
#include "run/checkpoint.hpp"
#include "study/study.hpp"

using namespace mpm::test;

namespace {

const fs::path build = MPM_BUILD_DIR;

/// A build folder with the program, the ball's plugins and the backends named. Its launcher notes what it is asked for and
/// takes that from the whole build.
struct PartOfABuild {
  Folder folder;
  fs::path bin = folder / "build/bin", plugins = folder / "build/plugins", backends = folder / "build/backends";
  fs::path launcher = folder / "launcher", asked = folder / "asked";

  explicit PartOfABuild(const Words& backends_there = {"cpu_2_double"}) {
    for (const fs::path& made : {bin, plugins, backends}) fs::create_directories(made);
    fs::copy_file(build / "bin/mpm", bin / "mpm");
    fs::copy_file(build / "on_demand", folder / "build/on_demand");
    for (const char* plugin : {"shape_bspline_quadratic", "transfer_mls", "material_neo_hookean"})
      fs::create_symlink(build / "plugins" / (plugin + std::string(".so")), plugins / (plugin + std::string(".so")));
    for (const std::string& backend : backends_there)
      fs::create_symlink(build / "backends" / (backend + ".so"), backends / (backend + ".so"));
    spill(launcher, "build='" + build.string() + "' part='" + (folder / "build").string() + R"('
echo "$@" >> "$part/../asked"
shift
for target; do
  case $target in
    backend_*) ln -s "$build/backends/${target#backend_}.so" "$part/backends/" ;;
    *) ln -s "$build/plugins/$target.so" "$part/plugins/" ;;
  esac || exit 1
done
)");
  }

  /// Runs the part's own program on a scene.
  Result call(const std::string& verb, const Json& scene, Words more = {}, bool with_launcher = true) const {
    spill(folder / "scene.json", scene.dump(1));
    Words words{(bin / "mpm").string(), verb, "scene.json"};
    words.insert(words.end(), more.begin(), more.end());
    return Process(folder, words, {"MPM_LAUNCHER=" + (with_launcher ? launcher.string() : "")}).finish();
  }
};

Json with_other_transfer(const std::string& id) {
  Json scene = ball();
  scene["transfer"]["type"] = id;
  return scene;
}

}  // namespace

TEST_CASE("on demand: a scene whose parts are all there asks for nothing") {
  const PartOfABuild part;
  const Result result = part.call("run", ball(), {"--out", "run"});
  INFO(result.err);
  CHECK(result.code == 0);
  CHECK(!fs::exists(part.asked));
}

TEST_CASE("on demand: what a scene or an option names is built once, and the run is that of the whole build") {
  const PartOfABuild part;
  Json scene = two_balls();
  const Result result =
      part.call("run", scene, {"--out", "run", "--set", "/precision=float", "--set", "/shape={\"type\": \"linear\"}"});
  INFO(result.err);
  CHECK(result.code == 0);
  CHECK(slurp(part.asked) ==
        "needed shape_linear transfer_apic contact_coulomb normal_average_volume_gradient "
        "detection_approach_and_position\nneeded backend_cpu_2_float\n");
  const Result whole = Process(part.folder, program({"run", "scene.json", "--out", "whole", "--set", "/precision=float",
                                                     "--set", "/shape={\"type\": \"linear\"}"}))
                           .finish();
  CHECK(whole.code == 0);
  CHECK(slurp(part.folder / "run/metrics.csv") == slurp(part.folder / "whole/metrics.csv"));
  CHECK(part.call("check", scene, {"--set", "/precision=float"}).code == 0);
  CHECK(has(slurp(part.asked), "backend_cpu_2_float\n"));
  const std::string before = slurp(part.asked);
  CHECK(part.call("plan", scene, {"--set", "/shape/type=linear"}).code == 0);
  CHECK(slurp(part.asked) == before);
}

TEST_CASE("on demand: other backends are libraries of their own") {
  const PartOfABuild part(Words{});
  const Result result = part.call("run", ball(), {"--out", "run", "--backend", "reference"});
  INFO(result.err);
  CHECK(result.code == 0);
  CHECK(slurp(part.asked) == "needed backend_reference\n");
}

TEST_CASE("on demand: a signal that ends the program ends the build as well, with all that it has started") {
  const PartOfABuild part;
  spill(part.launcher, "cd '" + part.folder.path().string() + R"('
bash -c 'echo $$ > id; mv id compiler; exec sleep 60'
echo on > went_on
)");
  spill(part.folder / "scene.json", with_other_transfer("apic").dump(1));
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
    fs::remove(part.folder / "compiler");
    Process process(part.folder, {(part.bin / "mpm").string(), "check", "scene.json"},
                    {"MPM_LAUNCHER=" + part.launcher.string()});
    REQUIRE(process.wait_until([&] { return fs::exists(part.folder / "compiler"); }));
    const std::string of_compiler = "/proc/" + std::to_string(std::stol(slurp(part.folder / "compiler")));
    const std::string stat = of_compiler + "/stat";
    // A bash that waits for mv takes a signal that mv outlives for one that mv has dealt with, and goes on.
    REQUIRE(process.wait_until([&] { return slurp(of_compiler + "/comm") == "sleep\n"; }));
    const auto runs = [&] {
      std::error_code error;
      if (!fs::exists(stat, error)) return false;
      const std::string text = slurp(stat);
      return text.find(") Z") == std::string::npos && !text.empty();
    };
    CHECK(runs());
    process.send(signal);
    CHECK(process.finish().signal == signal);
    for (int k = 0; runs() && k < 500; ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    CHECK(!runs());
    CHECK(!fs::exists(part.folder / "went_on"));
  }
}

TEST_CASE("on demand: what is built by a program whose caller ignores the ends of its children is told as well") {
  const PartOfABuild part;
  spill(part.folder / "scene.json", with_other_transfer("apic").dump(1));
  const auto code_of = [&] {
    return Process(part.folder,
                   {"/bin/bash", "-c", "trap '' CHLD; exec \"$0\" check scene.json", (part.bin / "mpm").string()},
                   {"MPM_LAUNCHER=" + part.launcher.string()})
        .finish()
        .code;
  };
  CHECK(code_of() == 0);
  CHECK(has(slurp(part.asked), "transfer_apic"));
}

TEST_CASE("on demand: without a launcher, or with one that fails, the message says what to call, with code 5") {
  const PartOfABuild part(Words{});
  const Result alone = part.call("run", with_other_transfer("apic"), {}, false);
  CHECK(alone.code == 5);
  CHECK(alone.err == "not built yet: transfer_apic; `./mpm build` builds everything, and `./mpm run` what it needs\n");
  const Result backend = part.call("run", ball(), {}, false);
  CHECK(backend.code == 5);
  CHECK(has(backend.err, "not built yet: backend_cpu_2_double; `./mpm build` builds everything"));
  CHECK(!fs::exists(part.folder / "runs"));
  spill(part.launcher, "exit 5\n");
  const Result failed = part.call("run", with_other_transfer("apic"));
  CHECK(failed.code == 5);
  CHECK(has(failed.err, "could not be built: transfer_apic; see the lines above"));
}

TEST_CASE("on demand: a wrong name is told among all that could be built") {
  const PartOfABuild part;
  const Result result = part.call("check", with_other_transfer("apik"));
  CHECK(result.code == 2);
  CHECK(has(result.err, "unknown transfer \"apik\"; did you mean \"apic\"? (available: "));
  CHECK(has(result.err, "\"tpic\""));
  CHECK(!fs::exists(part.asked));
}

TEST_CASE("on demand: a plugin is described, or its name told wrong, among all that could be built") {
  const PartOfABuild part;
  const auto described = [&](const std::string& id) {
    return Process(part.folder, {(part.bin / "mpm").string(), "describe", id},
                   {"MPM_LAUNCHER=" + part.launcher.string()})
        .finish();
  };
  const Result wrong = described("apik");
  CHECK(wrong.code == 2);
  CHECK(has(wrong.err, "no plugin is called \"apik\"; did you mean \"apic\"?"));
  const Result known = described("snow");
  CHECK(known.code == 0);
  CHECK(has(known.out, "snow (material "));
  CHECK(has(slurp(part.asked), " material_snow"));
}

TEST_CASE("on demand: a library that is none, or of another build, is refused by name") {
  const PartOfABuild part(Words{});
  fs::copy_file(build / "plugins/transfer_mls.so", part.backends / "cpu_2_double.so");
  const Result none = part.call("run", ball(), {"--out", "run"});
  CHECK(none.code == 5);
  CHECK(has(none.err, "cpu_2_double.so: exports no backend; build it again (./mpm build)"));
  spill(part.backends / "cpu_2_double.so", "no library");
  CHECK(has(part.call("run", ball(), {"--out", "run"}).err, "cpu_2_double.so: cannot be loaded: "));

  // One that says the hash of other headers.
  fs::remove(part.backends / "cpu_2_double.so");
  spill(part.folder / "old.c", "const unsigned long long mpm_backend_library[2] = {1, 0};\n");
  const std::string command = "cc -shared -fPIC -o '" + (part.backends / "cpu_2_double.so").string() + "' '" +
                              (part.folder / "old.c").string() + "'";
  REQUIRE(std::system(command.c_str()) == 0);
  const Result old = part.call("run", ball(), {"--out", "run"});
  CHECK(old.code == 5);
  CHECK(has(old.err, "cpu_2_double.so: is of another build than this program; build it again (./mpm build)"));
}

TEST_CASE("on demand: verbs that look at all plugins have all of them built first") {
  const PartOfABuild part;
  const auto list = [&](const std::string& launcher) {
    return Process(part.folder, {(part.bin / "mpm").string(), "list"}, {"MPM_LAUNCHER=" + launcher}).finish();
  };
  const Result alone = list("");
  CHECK(alone.code == 5);
  CHECK(has(alone.err, " transfer_tpic"));
  CHECK(alone.out.empty());
  const Result all = list(part.launcher.string());
  CHECK(all.code == 0);
  CHECK(all.out == call(part.folder, {"list"}).out);
}

TEST_CASE("on demand: the time of a compiler is no time of the run") {
  const PartOfABuild part(Words{});
  spill(part.launcher, "sleep 4\n" + slurp(part.launcher));
  CHECK(part.call("run", ball(), {"--out", "run"}).code == 0);
  CHECK(has(slurp(part.asked), "backend_cpu_2_double"));
  CHECK((json_in(part.folder / "run/summary.json")["performance"]["wall_seconds"] < 4));
}

TEST_CASE("on demand: every shipped experiment and study names the plugins that it uses") {
  const mpm::Registry registry = mpm::Registry::from_folders(mpm::Registry::default_folders());
  int read = 0, studies = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(MPM_SOURCE_DIR) / "experiments")) {
    const fs::path& file = entry.path();
    if (file.extension() != ".json" || file.filename() == "standard.json") continue;
    if (mpm::drive::is_material_point(file, {})) continue;
    if (mpm::study::is_study(mpm::read_located(file))) {
      const mpm::study::Study study = mpm::study::read_study(file);
      const auto words = mpm::app::words_of({study.file, study.base}, {});
      for (const mpm::study::Combination& combination : mpm::study::expand(study))
        for (const std::string& word : mpm::app::words_of({study.base}, combination.overrides)) {
          const bool is_plugin = std::any_of(registry.plugins().begin(), registry.plugins().end(),
                                             [&](const mpm::Plugin& plugin) { return plugin.id() == word; });
          if (is_plugin && !words.contains(word)) FAIL_CHECK(file << ": " << word << " of " << combination.name);
        }
      ++studies;
      continue;
    }
    const mpm::Experiment experiment = mpm::read_experiment(file, registry, mpm::app::read_options(registry, {}));
    const auto words = mpm::app::words_of({file}, {});
    for (const mpm::Plugin* plugin : mpm::app::plugins_of(experiment)) {
      INFO(file << " uses " << plugin->id());
      CHECK(words.contains(plugin->id()));
    }
    ++read;
  }
  CHECK(read > 80);
  CHECK(studies > 40);
}
