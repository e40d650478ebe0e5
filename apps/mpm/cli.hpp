#pragma once
// The verbs of the program. Each returns its exit code; the errors they throw are turned into messages and codes in one
// place.

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "experiment/read.hpp"
#include "plugin/registry.hpp"

namespace mpm::app {

enum ExitCode {
  done = 0,                ///< the verb did its work, and every expectation held
  bad_input = 2,           ///< nothing was run
  run_failed = 3,          ///< unstable or invalid: results up to there are kept; test-plugin: the plugin failed
  expectation_failed = 4,  ///< an expectation failed, or a limit was broken
  machine_failed = 5,      ///< the disk or the memory failed
  interrupted = 130        ///< Ctrl-C: everything up to the last step is written
};

struct RunOptions {
  std::filesystem::path file;
  std::vector<std::string> overrides;
  std::optional<std::string> backend;
  std::filesystem::path out;  ///< empty: runs/<name of the file>
  int threads = 0;            ///< 0: all processors
  std::string device;         ///< of backend "cuda"; empty: what MPM_DEVICE says
  bool resume = false;        ///< goes on with the unfinished run in `out`
  bool replace = false;       ///< whatever run `out` holds is replaced
  std::string command;        ///< as typed, for the manifest
};

struct BenchOptions {
  std::vector<std::string> sections;  ///< empty: all
  bool json = false;
  bool quick = false;           ///< tiny scenes: shows that everything runs
  bool strict = false;          ///< a target that is missed gives exit code 4
  int repeats = 0;              ///< rounds; 0: the protocol's 5 (2 under --quick)
  int threads = 0;              ///< threads of the parallel contenders; 0: all processors
  bool processor_time = false;  ///< contenders of one thread by the processor's time: for a busy machine
  std::filesystem::path out;
  std::string command;                  ///< command as typed
  std::string backend = "cpu", device;  ///< device: of backend "cuda", as in RunOptions
  bool predict = false;                 ///< of backend "cuda": count and predict alone
};

struct StudyOptions {
  std::filesystem::path file;
  std::vector<std::string> overrides;  ///< overrides of the base experiment
  std::filesystem::path out;           ///< empty: runs/<name of the file>
  int jobs = 0;                        ///< runs at a time; 0: all processors
  int threads = 1;                     ///< threads of each run
  std::string command;                 ///< command as typed
};

struct AdviseOptions {
  std::filesystem::path study;  ///< the study's folder, or its file when it ran into the default folder
  std::string error, time;      ///< one of the two, as typed
  std::string by;               ///< measure that ranks; empty: the study's cost
  std::string measure;          ///< measure that is the error; empty: the study's
  bool json = false;
};

struct CompareOptions {
  std::filesystem::path first, second;  ///< run folders
  double tolerance = 0;                 ///< of numbers, relative
  bool json = false;
};

int run_command_line(int argc, char** argv);

/// What the program offers to the reader: names of exact solutions, figures, quantities.
ReadOptions read_options(const Registry& registry, const RunOptions& options);
/// Every plugin of the default folders, after those that the build tree lacks were built (plugin/on_demand.hpp); unusable files
/// are named on standard error. Throws NotBuilt.
Registry load_registry();
/// What experiment files and overrides hold in words, and the ids that contact has where it names none.
std::set<std::string, std::less<>> words_of(const std::vector<std::filesystem::path>& files,
                                            const std::vector<std::string>& overrides);
/// The same, where of those that the build tree lacks only the ones are built whose ids are among these words.
Registry load_registry_for(const std::vector<std::filesystem::path>& files, const std::vector<std::string>& overrides);

int run(const RunOptions& options);
/// Validates an experiment, or a study with all its combinations.
int check(const RunOptions& options);
/// Throws InputError where the file is a study, with the verb that takes it in place of `verb`.
void refuse_study(const std::filesystem::path& file, const std::string& verb);
/// `architecture` is what the kernels of backend "cuda" are compiled for, "sm_90".
int plan(const RunOptions& options, bool json, const std::string& graph, const std::string& architecture);
int list(bool json);
/// Prints the devices of backend "cuda", and what is missing for one.
int list_devices();
/// Prints how many compiled programs are kept and where, or removes them.
int cache(bool clear);
/// Prints which components run together and which are refused, generated from the same function that refuses.
int list_combinations(bool json);
int describe(const std::string& id, bool json);
/// Prints the contact offset of a shape function, and draws it where `figure` names files, without their extension.
/// Throws PluginError where there is no such shape.
int contact_offset(const std::string& shape, int particles, const std::filesystem::path& figure);
/// Prints the errors of all contact normals that need no parameters, and draws them where `figure` names files, without
/// their extension. Throws PluginError where there is no such shape, or it lists its nodes.
int contact_normals(const std::string& shape, const std::filesystem::path& figure);
int schema();
/// Writes a project for a plugin of `kind` into `folder`, which must be empty or missing. Throws InputError.
int new_plugin(const std::string& kind, const std::string& id, const std::filesystem::path& folder);
/// Runs the conformance suite on a plugin's file in a process of its own, for at most `seconds`; `with_device` also its
/// functor in the device's kernels.
int test_plugin(const std::filesystem::path& file, double seconds, bool verbose, bool json, bool with_device);
/// Measures speed on the standard scenes. Throws InputError for a section that does not exist.
int bench(const BenchOptions& options);
/// The same for backend "cuda": counts of the standard scenes, what follows for some GPUs, and, unless
/// options.predict, times. Throws DeviceError.
int bench_device(const BenchOptions& options);
/// The sections, one line each, for the help.
std::string bench_section_list();
/// Runs the child process of a point of the section `growth`: answers questions on standard input.
int bench_point(const std::string& description);
/// Runs every combination of a study. Throws InputError when nothing of it can be run.
int study(const StudyOptions& options);
/// Prints the best measured combination for an error or a time; exit code 4 when there is none. Throws InputError.
int advise(const AdviseOptions& options);
/// Prints what differs between two runs; exit code 4 when their numbers do. Throws InputError and FolderRefused.
int compare(const CompareOptions& options);
int figure(const std::vector<std::filesystem::path>& runs, const std::filesystem::path& specification,
           const std::filesystem::path& out);
/// Joins the frames of a recorded run to RUN/film.FORMAT; exit code 5 without ffmpeg. Throws InputError when the run has
/// fewer than two frames, FolderRefused when there is no run or another program writes it, and support::MachineError
/// with ffmpeg's last lines when it fails.
int film(const std::filesystem::path& run, const std::string& format);

}  // namespace mpm::app
