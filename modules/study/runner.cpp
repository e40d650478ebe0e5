#include "study/runner.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <sstream>
#include <vector>

#include "output/summary_value.hpp"
#include "support/files.hpp"
#include "support/hash.hpp"

namespace mpm::study {
namespace {

namespace fs = std::filesystem;

Json read_json(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return Json::object();
  Json json = Json::parse(support::read_file(file), nullptr, false);
  return json.is_object() ? json : Json::object();
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw support::MachineError::from_errno("create the folder", folder, error.value());
}

constexpr int code_not_started = 127;  ///< of a child that could not become the program, as a shell has it

/// Becomes the program, in the child. Only calls that are safe after a fork are made.
[[noreturn]] void become(std::vector<char*>& words, const char* log) {
  ::setpgid(0, 0);                     // Ctrl-C reaches the study alone, which asks its runs to stop
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // a run does not outlive a study that was killed
  const int nothing = ::open("/dev/null", O_RDONLY), file = ::open(log, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (nothing >= 0) ::dup2(nothing, 0);
  if (file >= 0) ::dup2(file, 1), ::dup2(file, 2);
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE}) ::signal(signal, SIG_DFL);
  ::execv(words[0], words.data());
  _exit(code_not_started);
}

}  // namespace

// ---- keys --------------------------------------------------------------------------------------------------------

KeyMaker::KeyMaker(const fs::path& program) : program_(support::sha256_of_file(program)) {}

const std::string& KeyMaker::hash_of(const fs::path& file) {
  std::string& hash = hashes_[file];
  if (hash.empty()) hash = support::sha256_of_file(file);
  return hash;
}

std::string KeyMaker::operator()(const Experiment& experiment) {
  std::string text = program_ + "\n" + experiment.resolved.dump() + "\n";
  const auto add = [&](const Component& component) { text += hash_of(component.plugin->file) + "\n"; };
  add(experiment.shape);
  add(experiment.transfer);
  if (experiment.filter) add(*experiment.filter);
  if (experiment.contact) add(*experiment.contact);
  for (const RigidBodySpecification& body : experiment.rigid_bodies) add(body.contact);
  for (const MaterialSpecification& material : experiment.materials) add(material.component);
  return support::sha256(text);
}

// ---- runs --------------------------------------------------------------------------------------------------------

Runner::Runner(fs::path program, fs::path folder, int threads)
    : program_(std::move(program)), folder_(std::move(folder)), threads_(threads) {
  make_folder(folder_ / "runs");
  make_folder(folder_ / "records");
}

Runner::~Runner() {
  for (const auto& [id, child] : children_) ::kill(id, SIGKILL);
  for (const auto& [id, child] : children_) ::waitpid(id, nullptr, 0);
}

fs::path Runner::record(const std::string& name, const char* ending) const {
  return folder_ / "records" / (name + ending);
}

Json Runner::summary(const std::string& name) const {
  return read_json(run_folder(name) / "summary.json");
}

std::optional<Outcome> Runner::earlier(const PreparedRun& run) const {
  const Json known = read_json(record(run.name, ".json"));
  if (known.value("key", "") != run.key) return std::nullopt;
  const Status status = status_named(known.value("status", "not run"));
  if (!is_finished(status) && status != Status::failed) return std::nullopt;
  if (summary(run.name).empty()) return std::nullopt;
  return Outcome{status, known.value("reason", ""), true, known.value("cause", "")};
}

bool Runner::can_go_on(const PreparedRun& run) const {
  const Json known = read_json(record(run.name, ".json"));
  std::error_code ignored;
  const fs::path checkpoints = run_folder(run.name) / "checkpoint";
  return known.value("key", "") == run.key && known.value("status", "") == name_of(Status::interrupted) &&
         fs::is_directory(checkpoints, ignored) && !fs::is_empty(checkpoints, ignored);
}

void Runner::write_record(const PreparedRun& run, const Outcome& outcome) const {
  const Json json{
      {"key", run.key}, {"status", name_of(outcome.status)}, {"reason", outcome.reason}, {"cause", outcome.cause}};
  support::write_atomically(record(run.name, ".json"), json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

void Runner::start(const PreparedRun& run) {
  const bool resumed = can_go_on(run);
  if (!resumed) {
    std::error_code error;
    fs::remove_all(run_folder(run.name), error);
    if (error) throw support::MachineError::from_errno("remove the stale run", run_folder(run.name), error.value());
  }
  support::write_atomically(record(run.name, ".experiment.json"), run.experiment.dump(2) + "\n");
  // The record as it stands if this process is killed as well.
  write_record(run, {Status::interrupted, "the study ended before it", false});
  spawn(run, resumed);
}

void Runner::spawn(const PreparedRun& run, bool resumed) {
  std::vector<std::string> words{program_.string(),
                                 "run",
                                 record(run.name, ".experiment.json").string(),
                                 "--out",
                                 run_folder(run.name).string(),
                                 "--threads",
                                 std::to_string(threads_)};
  if (resumed) words.emplace_back("--resume");
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const std::string log = record(run.name, ".log").string();
  const pid_t id = ::fork();
  if (id < 0) throw support::MachineError::from_errno("start a process for", run_folder(run.name), errno);
  if (id == 0) become(pointers, log.c_str());
  children_[id] = {run, resumed};
}

std::optional<Runner::Ended> Runner::poll() {
  for (auto child = children_.begin(); child != children_.end(); ++child) {
    int status = 0;
    if (::waitpid(child->first, &status, WNOHANG) <= 0) continue;
    const Child ended = child->second;
    children_.erase(child);
    Outcome outcome = outcome_of(ended.run.name, status);
    // A checkpoint of no use costs the run what it had done, not the study.
    if (ended.resumed && outcome.status == Status::refused && !stopped_) {
      write_record(ended.run, {Status::not_run, "", false});
      start(ended.run);
      return std::nullopt;
    }
    write_record(ended.run, outcome);
    return Ended{ended.run.name, outcome};
  }
  return std::nullopt;
}

void Runner::stop() {
  if (stopped_) return;
  stopped_ = true;
  for (const auto& [id, child] : children_) ::kill(id, SIGTERM);
}

std::string Runner::last_lines(const std::string& name) const {
  std::error_code ignored;
  const fs::path log = record(name, ".log");
  if (!fs::is_regular_file(log, ignored)) return "it printed nothing";
  std::stringstream lines(support::read_file(log));
  const std::string place = record(name, ".experiment.json").string();
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    // "FILE:line:column: " is cut off: of a file that the study wrote it tells nobody anything.
    if (line.starts_with(place)) line.erase(0, std::min(line.find(": ", place.size()), line.size() - 2) + 2);
    const bool is_count = line.ends_with("nothing was run");
    if (!line.empty() && !is_count) text += (text.empty() ? "" : "; ") + line;
  }
  return text.empty() ? "it printed nothing" : text.size() > 1000 ? "…" + text.substr(text.size() - 1000) : text;
}

Outcome Runner::outcome_of(const std::string& name, int wait_status) const {
  if (WIFSIGNALED(wait_status)) {
    const int signal = WTERMSIG(wait_status);
    const char* abbreviation = sigabbrev_np(signal);
    return {Status::crashed, std::string("ended by SIG") + (abbreviation ? abbreviation : std::to_string(signal)) +
                                 " (" + strsignal(signal) + ")"};
  }
  const int code = WEXITSTATUS(wait_status);
  const Json summary = this->summary(name);
  const Json ending = summary.contains("outcome") ? summary["outcome"] : Json::object();
  const std::string reason = ending.value("reason", "");
  const bool known = ending.value("exit_code", -1) == code;
  if (code == 0 && known) return {Status::done, ""};
  if (code == 4 && known && ending.value("status", "") == output::limit_broken)
    return {Status::done, ""};  // the run is flagged as well
  if (code == 4 && known) return {Status::expectation_failed, reason};
  if (code == 3 && known) return {Status::failed, reason, false, ending.value("cause", "")};
  if (code == 2) return {Status::refused, last_lines(name)};
  if (code == 5) return {Status::machine_failed, known && !reason.empty() ? reason : last_lines(name)};
  if (code == code_not_started)
    return {Status::machine_failed, program_.string() + " could not be started: it was moved, or is being built"};
  if (code == 130) return {Status::interrupted, "stopped by a signal"};
  return {Status::crashed, "ended with code " + std::to_string(code) + ": " + last_lines(name)};
}

}  // namespace mpm::study
