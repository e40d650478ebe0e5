#include "run/checkpoint.hpp"

#include <algorithm>
#include <iostream>

#include "experiment/diagnostics.hpp"
#include "output/checkpoint_file.hpp"
#include "output/json_differences.hpp"
#include "support/files.hpp"
#include "support/hash.hpp"

namespace mpm::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

/// What may change between the parts of a run: it acts at the end only, or on nothing that is recorded.
constexpr const char* free_keys[] = {"/title",
                                     "/description",
                                     "/figures",
                                     "/compare/expect",
                                     "/limits",
                                     "/solver/max_steps",
                                     "/output/film",
                                     "/output/checkpoint_every",
                                     "/output/checkpoint_steps"};

constexpr const char* start_anew = "or start anew with --replace in place of --resume";

/// The value as it would be read back from a file.
Json as_written(const Json& value) {
  return Json::parse(value.dump(-1, ' ', false, Json::error_handler_t::replace));
}

/// What may change beside these when a run is resumed: the state is the same, and each backend has its own rounding.
constexpr const char* free_when_resumed[] = {"/backend", "/device"};

Json without_free_keys(const Json& experiment, bool resumed) {
  Json kept = as_written(experiment);
  std::vector<const char*> keys(std::begin(free_keys), std::end(free_keys));
  if (resumed) keys.insert(keys.end(), std::begin(free_when_resumed), std::end(free_when_resumed));
  for (const char* key : keys) {
    const Json::json_pointer pointer(key);
    if (!kept.contains(pointer)) continue;
    Json& parent = kept.at(pointer.parent_pointer());
    parent.erase(pointer.back());
    if (parent.empty()) kept.erase(pointer.parent_pointer().back());  // kept as if the section had not been written
  }
  return kept;
}

std::string plugin_text(const Json& plugin) {
  return plugin.value("version", "") + ", SHA-256 " + plugin.value("file_sha256", "").substr(0, 12);
}

/// Refuses another program or other plugins, which would go on with other arithmetic.
void refuse_other_program(const Json& now, const Json& then, const fs::path& path) {
  const std::string version = then.value("version", "unknown");
  if (then.value("program", "") != now["program"].get<std::string>() || version != now["version"].get<std::string>())
    throw output::FolderRefused(path.string() + " was written by version " + version + " of the program, and this is " +
                                now.value("version", "") + ": resume with that version, " + start_anew);
}

void refuse_other_plugins(const Json& now, const Json& then, const fs::path& path) {
  const Json before = then.value("plugins", Json::array());
  for (const Json& plugin : now["plugins"]) {
    const auto same = std::find_if(before.begin(), before.end(), [&](const Json& other) {
      return other.value("id", "") == plugin["id"].get<std::string>() &&
             other.value("kind", "") == plugin["kind"].get<std::string>();
    });
    if (same != before.end() && *same == plugin) continue;
    throw output::FolderRefused("plugin " + in_quotes(plugin["id"].get<std::string>()) + " is not the one that wrote " +
                                path.string() + " (now " + plugin_text(plugin) + "; then " +
                                (same == before.end() ? "none" : plugin_text(*same)) + "): put that one back, " +
                                start_anew);
  }
}

/// Refuses files of bodies that have changed since the checkpoint.
void refuse_other_inputs(const Experiment& experiment, const Json& then, const fs::path& path) {
  const Json now = inputs_of(experiment);
  for (std::size_t k = 0; k < now.size(); ++k)
    if (k >= then.size() || then[k].value("sha256", "") != now[k]["sha256"].get<std::string>())
      throw output::FolderRefused(now[k]["file"].get<std::string>() + " is not the file that " + path.string() +
                                  " was made with: put that one back, " + start_anew);
}

EarlierParts read_earlier_parts(ArchiveReader& archive) {
  EarlierParts earlier;
  archive.get("wall_seconds", earlier.wall_seconds);
  std::size_t count = 0;
  archive.get("passes", count);
  for (std::size_t k = 0; k < count; ++k) {
    std::string name;
    archive.get("pass", name);
    archive.get("seconds", earlier.seconds_by_pass[name]);
  }
  archive.get("resumed_from_steps", earlier.resumed_from_steps);
  return earlier;
}

/// Restores one checkpoint. Throws output::CheckpointDamaged when an older one may do; anything else when that is no
/// use.
EarlierParts restore_from(const fs::path& path, Simulation& simulation, Recorder& recorder,
                          const output::RunFolder& folder, const Json& identity) {
  const output::CheckpointFile file = output::read_checkpoint(path);
  refuse_other_program(identity, file.identity, path);
  refuse_other_experiment(simulation.experiment(), file.identity.value("experiment", Json()), folder);
  refuse_other_plugins(identity, file.identity, path);
  refuse_other_inputs(simulation.experiment(), file.identity.value("inputs", Json::array()), path);
  try {
    ArchiveReader archive(file.state);
    EarlierParts earlier = read_earlier_parts(archive);
    recorder.restore(archive);
    simulation.restore(archive);
    if (!archive.at_end()) throw ArchiveError("there is more than was expected");
    earlier.resumed_from_steps.push_back(simulation.steps());
    return earlier;
  } catch (const ArchiveError& error) {
    throw output::FolderRefused(path.string() + " is whole but holds another state than this program keeps (" +
                                error.what() + "): resume with the program that wrote it, " + start_anew);
  }
}

}  // namespace

std::vector<const Plugin*> plugins_of(const Experiment& experiment) {
  std::vector<const Plugin*> used;
  const auto add = [&](const Component& component) {
    if (std::find(used.begin(), used.end(), component.plugin) == used.end()) used.push_back(component.plugin);
  };
  add(experiment.shape), add(experiment.transfer);
  if (experiment.filter) add(*experiment.filter);
  if (experiment.contact) add(*experiment.contact);
  if (experiment.contact_normal) add(*experiment.contact_normal);
  if (experiment.contact_detection) add(*experiment.contact_detection);
  for (const RigidBodySpecification& body : experiment.rigid_bodies) add(body.contact);
  for (const MaterialSpecification& material : experiment.materials) add(material.component);
  return used;
}

Json inputs_of(const Experiment& experiment) {
  Json files = Json::array();
  for (const InputFile& input : experiment.inputs)
    files.push_back({{"pointer", input.pointer}, {"file", input.path.string()}, {"sha256", input.sha256}});
  return files;
}

Json identity_of(const Experiment& experiment) {
  Json identity{{"program", "mpm"}, {"version", MPM_VERSION}, {"plugins", Json::array()}};
  for (const Plugin* plugin : plugins_of(experiment))
    identity["plugins"].push_back({{"id", plugin->descriptor->id},
                                   {"kind", kind_name(static_cast<mpm_kind>(plugin->descriptor->kind))},
                                   {"version", plugin->descriptor->version},
                                   {"file_sha256", support::sha256_of_file(plugin->file)}});
  if (!experiment.inputs.empty()) identity["inputs"] = inputs_of(experiment);
  identity["experiment"] = as_written(experiment.resolved);
  return identity;
}

std::optional<ExperimentDifference> difference_to(const Experiment& experiment, const Json& recorded, bool resumed) {
  const Json now = without_free_keys(experiment.resolved, resumed), then = without_free_keys(recorded, resumed);
  const auto found = output::differences(now, then);
  if (found.empty()) return std::nullopt;
  return ExperimentDifference{found.front().pointer, output::short_text(found.front().first),
                              output::short_text(found.front().second)};
}

void refuse_other_experiment(const Experiment& experiment, const Json& recorded, const output::RunFolder& folder) {
  const auto difference = difference_to(experiment, recorded, /*resumed=*/true);
  if (!difference) return;
  const std::string message = "is " + difference->now + ", and " + difference->then + " in the run in " +
                              folder.root().string() +
                              ": a run is resumed with the experiment and --set that it was started with (" +
                              (folder.root() / "experiment.json").string() + " holds them all), " + start_anew;
  Problem problem{experiment.where(difference->pointer), 0, 0, difference->pointer, message};
  for (const auto& [known, place] : experiment.positions)
    if (known == difference->pointer && place.first > 0)
      problem.file = experiment.file.string(), problem.line = place.first, problem.column = place.second;
  throw InputError({problem});
}

std::optional<int> finished_with(const output::RunFolder& folder) {
  const fs::path path = folder.root() / "summary.json";
  // The checkpoints of a run that came to its end are removed last, after its report.
  if (!fs::exists(path) || !output::checkpoints_in(folder.root() / "checkpoint").empty()) return std::nullopt;
  const Json summary = Json::parse(support::read_file(path), nullptr, false);
  const Json::json_pointer pointer("/outcome/exit_code");
  if (!summary.is_object() || !summary.contains(pointer) || !summary[pointer].is_number_integer()) return std::nullopt;
  const int code = summary[pointer].get<int>();
  return code == 0 || code == 4 ? std::optional(code) : std::nullopt;
}

EarlierParts restore_newest(Simulation& simulation, Recorder& recorder, const output::RunFolder& folder,
                            const Json& identity) {
  const std::vector<fs::path> paths = output::checkpoints_in(folder.root() / "checkpoint");
  if (paths.empty())
    throw output::FolderRefused(folder.root().string() +
                                " holds no checkpoint: the run ended before its first one (output/checkpoint_every, "
                                "output/checkpoint_steps); start it anew without --resume");
  std::string reasons;
  for (const fs::path& path : paths) {
    try {
      EarlierParts earlier = restore_from(path, simulation, recorder, folder, identity);
      if (!reasons.empty())
        std::cerr << "warning: " << reasons << "; the one before is used, " << path.filename().string() << "\n";
      return earlier;
    } catch (const output::CheckpointDamaged& damage) {
      reasons += (reasons.empty() ? "" : "; ") + std::string(damage.what());
    }
  }
  throw output::FolderRefused(reasons +
                              "; no other checkpoint is left: start anew with --replace in place of --resume");
}

Checkpoints::Checkpoints(const Simulation& simulation, Recorder& recorder, const output::RunFolder& folder,
                         Json identity, EarlierParts earlier, Clock::time_point start)
    : simulation_(simulation),
      recorder_(recorder),
      folder_(folder),
      identity_(std::move(identity)),
      earlier_(std::move(earlier)),
      start_(start),
      last_(Clock::now()),
      last_step_(earlier_.resumed_from_steps.empty() ? -1 : earlier_.resumed_from_steps.back()) {}

bool Checkpoints::due(long steps) const {
  const OutputSpecification& output = simulation_.experiment().output;
  const bool by_steps = output.checkpoint_steps > 0 && steps % output.checkpoint_steps == 0;
  return by_steps || (output.checkpoint_seconds > 0 &&
                      std::chrono::duration<double>(Clock::now() - last_).count() >= output.checkpoint_seconds);
}

void Checkpoints::write_if_due() {
  // By the clock a checkpoint may fall due after a step that was not to be observed: the next step then is observed.
  if (due(simulation_.steps()) && simulation_.observed() && !simulation_.finished()) write();
}

bool Checkpoints::write() {
  if (last_step_ == simulation_.steps()) return true;
  try {
    write_file();
    last_step_ = simulation_.steps();
    if (failing_) std::cerr << "checkpoints are written again\n";
    failing_ = false;
  } catch (const std::exception& error) {  // an error of the disk, or no memory for the copy
    trouble_ = std::string("a checkpoint could not be written: ") + error.what();
    if (!failing_)
      std::cerr << "warning: " << trouble_ << "; the run goes on"
                << (any() ? ", and the checkpoint before is kept" : "") << "\n";
    failing_ = true;
  }
  last_ = Clock::now();
  return !failing_;
}

void Checkpoints::write_file() {
  ArchiveWriter archive;
  archive.put("wall_seconds", earlier_.wall_seconds + std::chrono::duration<double>(Clock::now() - start_).count());
  std::map<std::string, double> seconds_by_pass = earlier_.seconds_by_pass;
  for (const auto& [name, seconds] : simulation_.seconds_by_pass()) seconds_by_pass[name] += seconds;
  archive.put("passes", seconds_by_pass.size());
  for (const auto& [name, seconds] : seconds_by_pass) {
    archive.put("pass", name);
    archive.put("seconds", seconds);
  }
  archive.put("resumed_from_steps", earlier_.resumed_from_steps);
  recorder_.save(archive);
  simulation_.save(archive);
  identity_["step"] = simulation_.steps();
  identity_["time"] = simulation_.time();
  output::write_checkpoint(folder_.checkpoint() / output::checkpoint_name(simulation_.steps()), identity_,
                           {archive.bytes().data(), archive.bytes().size()});
  remove_older();
}

/// Leaves the checkpoint just written and the one that this process wrote or resumed from before it. Others are older,
/// or were found damaged.
void Checkpoints::remove_older() const {
  const std::string newest = output::checkpoint_name(simulation_.steps()), before = output::checkpoint_name(last_step_);
  std::error_code error;
  for (const fs::path& path : output::checkpoints_in(folder_.root() / "checkpoint"))
    if (const std::string name = path.filename().string(); name != newest && name != before) fs::remove(path, error);
}

bool Checkpoints::any() const {
  return !output::checkpoints_in(folder_.root() / "checkpoint").empty();
}

void Checkpoints::remove() {
  const fs::path folder = folder_.root() / "checkpoint";
  std::error_code error;
  // The snapshots are removed last: while there is a checkpoint, what it counts on is there.
  for (const fs::path& path : output::checkpoints_in(folder)) fs::remove(path, error);
  fs::remove(folder / "snapshots.records", error);
  fs::remove(folder, error);  // the folder stays when somebody has put something else there
}

}  // namespace mpm::app
