// Verb `test-plugin`: the conformance suite on one file, in a process of its own, so that a plugin that crashes or
// never returns is reported like one that answers wrongly.

#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <iostream>

#include "conformance/conformance.hpp"
#include "experiment/diagnostics.hpp"
#include "mpm/cli.hpp"
#include "mpm/test_plugin_device.hpp"
#include "support/file_descriptor.hpp"
#include "support/files.hpp"

namespace mpm::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// ---- the process that runs the plugin ----------------------------------------------------------------------------

/// Sends one line of JSON a message. Texts of a broken plugin need not be UTF-8.
void say(int pipe, const Json& message) {
  const std::string line = message.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  for (std::size_t at = 0; at < line.size();) {
    const ssize_t written = ::write(pipe, line.data() + at, line.size() - at);
    if (written < 0 && errno != EINTR) _exit(1);
    if (written > 0) at += static_cast<std::size_t>(written);
  }
}

Json message_of(const ConformanceFinding& finding) {
  return {{"check", finding.check}, {"passed", finding.passed}, {"measured", finding.measured},
          {"bound", finding.bound}, {"detail", finding.detail}, {"text", to_string(finding)}};
}

void load_and_check(const fs::path& file, bool with_device, int pipe) {
  say(pipe, {{"running", "loading the file"}});
  Registry registry;
  try {
    registry.load(file);
  } catch (const PluginError& error) {
    return say(pipe, {{"refused", error.what()}});
  }
  for (const Plugin& plugin : registry.plugins()) {
    const std::string kind(kind_name(static_cast<mpm_kind>(plugin.descriptor->kind)));
    say(pipe, {{"plugin", {{"kind", kind}, {"id", plugin.id()}}}});
    say(pipe, {{"running", "tables"}});
    for (const ConformanceFinding& finding : check_plugin(plugin, [&](std::string_view group) {
           say(pipe, {{"running", group}});
         }))
      say(pipe, {{"finding", message_of(finding)}});
    if (with_device)
      for (const ConformanceFinding& finding : check_plugin_on_device(plugin, [&](std::string_view group) {
             say(pipe, {{"running", group}});
           }))
        say(pipe, {{"finding", message_of(finding)}});
  }
  say(pipe, {{"done", true}});
}

[[noreturn]] void child(const fs::path& file, bool with_device, int pipe) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // an endless loop does not outlive the program
  const rlimit none{0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
  ::dup2(STDERR_FILENO, STDOUT_FILENO);  // what a plugin prints is not part of the result
  try {
    load_and_check(file, with_device, pipe);
  } catch (const std::exception& error) {
    say(pipe, {{"threw", error.what()}});
  } catch (...) {
    say(pipe, {{"threw", "an object that is no std::exception"}});
  }
  _exit(0);
}

// ---- the process that watches it ---------------------------------------------------------------------------------

struct Tested {
  std::string kind, id;
  std::vector<Json> findings;

  std::string name() const { return kind + " " + id; }
  long failed() const {
    long count = 0;
    for (const Json& finding : findings) count += !finding["passed"].get<bool>();
    return count;
  }
};

struct Verdict {
  std::string outcome;  ///< passed, failed, crashed, hung, refused
  std::string message;  ///< message of the last three outcomes
  std::string running;  ///< the check during which it crashed or hung
  int signal = 0;
  std::vector<Tested> plugins;
};

void hear(const std::string& line, Verdict& verdict) {
  const Json message = Json::parse(line);
  if (message.contains("running")) verdict.running = message["running"];
  if (message.contains("plugin")) verdict.plugins.push_back({message["plugin"]["kind"], message["plugin"]["id"], {}});
  if (message.contains("finding")) verdict.plugins.back().findings.push_back(message["finding"]);
  if (message.contains("refused")) verdict.outcome = "refused", verdict.message = message["refused"];
  if (message.contains("threw"))
    verdict.outcome = "crashed", verdict.message = "threw an exception: " + message["threw"].get<std::string>();
  if (message.contains("done")) verdict.outcome = "passed";
}

/// Takes everything the child says until it closes the pipe; false when the time is over before.
bool listen(int pipe, double seconds, Verdict& verdict) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  std::string text;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    pollfd wait{pipe, POLLIN, 0};
    const int ready = left > 0 ? ::poll(&wait, 1, static_cast<int>(left)) : 0;
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return false;
    char buffer[4096];
    const ssize_t bytes = ::read(pipe, buffer, sizeof buffer);
    if (bytes < 0 && errno == EINTR) continue;
    if (bytes <= 0) return true;
    text.append(buffer, static_cast<std::size_t>(bytes));
    for (std::size_t newline; (newline = text.find('\n')) != std::string::npos; text.erase(0, newline + 1))
      hear(text.substr(0, newline), verdict);
  }
}

/// Where in the suite the plugin was: "material my_rubber: energy balance [scalar double, 2-D]; density=1000".
std::string place(const Verdict& verdict) {
  return verdict.plugins.empty() ? verdict.running : verdict.plugins.back().name() + ": " + verdict.running;
}

Verdict watch(const fs::path& file, double seconds, bool with_device) {
  int ends[2];
  if (::pipe(ends) != 0) throw support::MachineError::from_errno("open a pipe for", file, errno);
  const support::FileDescriptor reading(ends[0]);
  support::FileDescriptor writing(ends[1]);
  std::cout.flush();
  const pid_t id = ::fork();
  if (id < 0) throw support::MachineError::from_errno("start a process for", file, errno);
  if (id == 0) child(file, with_device, ends[1]);
  writing.close();

  Verdict verdict;
  const bool in_time = listen(ends[0], seconds, verdict);
  if (!in_time) ::kill(id, SIGKILL);
  int status = 0;
  while (::waitpid(id, &status, 0) < 0 && errno == EINTR) {
  }
  if (!in_time) {
    verdict.outcome = "hung";
    verdict.message = "did not end within " + number_text(seconds) + " s and was stopped";
  } else if (WIFSIGNALED(status)) {
    verdict.outcome = "crashed";
    verdict.signal = WTERMSIG(status);
    const char* name = sigabbrev_np(verdict.signal);
    verdict.message = "crashed with SIG" + std::string(name ? name : std::to_string(verdict.signal)) + " (" +
                      strsignal(verdict.signal) + ")";
  } else if (verdict.outcome.empty()) {
    verdict.outcome = "crashed";
    verdict.message = "ended the process with exit code " + std::to_string(WEXITSTATUS(status));
  }
  for (const Tested& plugin : verdict.plugins)
    if (verdict.outcome == "passed" && plugin.failed() > 0) verdict.outcome = "failed";
  return verdict;
}

Json json_of(const fs::path& file, const Verdict& verdict) {
  Json json{{"file", file.string()}, {"outcome", verdict.outcome}};
  if (!verdict.message.empty()) json["message"] = verdict.message;
  if (verdict.outcome == "crashed" || verdict.outcome == "hung") json["running"] = place(verdict);
  if (verdict.signal != 0) json["signal"] = verdict.signal;
  json["plugins"] = Json::array();
  for (const Tested& plugin : verdict.plugins) {
    json["plugins"].push_back({{"kind", plugin.kind},
                               {"id", plugin.id},
                               {"checks", plugin.findings.size()},
                               {"failed", plugin.failed()},
                               {"findings", Json::array()}});
    for (Json finding : plugin.findings) {
      finding.erase("text");
      json["plugins"].back()["findings"].push_back(finding);
    }
  }
  return json;
}

void print(const Verdict& verdict, bool verbose) {
  for (const Tested& plugin : verdict.plugins) {
    for (const Json& finding : plugin.findings)
      if (verbose || !finding["passed"].get<bool>()) std::cout << finding["text"].get<std::string>() << "\n";
    const auto checks = plugin.findings.size();
    if (checks == 0) continue;
    std::cout << plugin.name() << ": ";
    if (plugin.failed() > 0)
      std::cout << plugin.failed() << " of " << checks << " checks FAILED\n";
    else
      std::cout << checks << " checks passed\n";
  }
  if (verdict.outcome == "crashed" || verdict.outcome == "hung")
    std::cout << (verdict.outcome == "hung" ? "HUNG" : "CRASHED") << " in " << place(verdict) << "\n  it "
              << verdict.message << "\n";
}

}  // namespace

int test_plugin(const fs::path& file, double seconds, bool verbose, bool json, bool with_device) {
  std::error_code error;
  if (!fs::exists(file, error)) throw PluginError("plugin " + file.string() + ": there is no such file");
  const Verdict verdict = watch(file, seconds, with_device);
  if (json) std::cout << json_of(file, verdict).dump(2) << "\n";
  if (verdict.outcome == "refused") {
    std::cerr << verdict.message << "\n";
    return bad_input;
  }
  if (!json) print(verdict, verbose);
  return verdict.outcome == "passed" ? done : run_failed;
}

}  // namespace mpm::app
