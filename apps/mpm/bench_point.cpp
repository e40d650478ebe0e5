#include "mpm/bench_point.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <fstream>
#include <iostream>

#include "mpm/bench_suite.hpp"
#include "mpm/cli.hpp"
#include "support/files.hpp"

namespace mpm::app {
namespace {

using bench::Json;

/// The largest resident set of this program so far. It is not getrusage's, which is handed on by the program that
/// started this one.
double peak_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (unsigned long long kilobytes = 0; std::sscanf(line.c_str(), "VmHWM: %llu kB", &kilobytes) == 1)
      return static_cast<double>(kilobytes) * 1024;
  return 0;
}

/// Bytes of position, velocity, C and F a particle: the size of the state without anything else.
double state_bytes(const Experiment& experiment) {
  const double D = experiment.dimension, scalar = experiment.precision == Precision::single ? 4 : 8;
  return (2 * D + 2 * D * D) * scalar;
}

double processor_seconds() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void answer(const Json& json) {
  std::cout << json.dump() << "\n" << std::flush;
}

}  // namespace

/// Answers questions until its input ends: a number of steps to run, or "report".
int bench_point(const std::string& description) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const auto start = std::chrono::steady_clock::now();
  const double before = peak_bytes();
  const Json point = Json::parse(description);
  const Registry registry = load_registry();
  const BenchSuite suite(registry, point.at("quick"));
  Edits edits;
  for (const auto& [pointer, value] : point.at("set").items()) edits.push_back({pointer, value});
  Product product(suite.experiment(suite.scene(point.at("scene")), point.at("motion"), edits), 1);
  product.step();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double processor = processor_seconds();
  answer({{"particles", product.particle_count()}});
  for (std::string question; std::getline(std::cin, question);) {
    if (question != "report") {
      const bench::Seconds taken = product.run(std::stoi(question));
      answer({{"wall", taken.wall}, {"processor", taken.processor}});
    } else {
      const Backend& backend = product.simulation().backend();
      answer({{"startup_seconds", seconds},
              {"startup_processor_seconds", processor},
              {"peak_bytes", peak_bytes() - before},
              {"particle_bytes", backend.particle_bytes()},
              {"grid_bytes", backend.grid_bytes()},
              {"state_bytes", state_bytes(product.experiment()) * static_cast<double>(product.particle_count())}});
    }
  }
  return done;
}

RemotePoint::RemotePoint(const Json& description) : name_(description.dump()), cycle_(description.value("cycle", 1)) {
  ::signal(SIGPIPE, SIG_IGN);  // a process that died is an error of writing
  int to[2], from[2];
  if (::pipe2(to, O_CLOEXEC) != 0 || ::pipe2(from, O_CLOEXEC) != 0)
    throw support::MachineError::from_errno("open a pipe for", "mpm bench", errno);
  std::cout.flush();
  process_ = ::fork();
  if (process_ < 0) throw support::MachineError::from_errno("start", "mpm bench", errno);
  if (process_ == 0) {
    ::dup2(to[0], STDIN_FILENO);
    ::dup2(from[1], STDOUT_FILENO);
    ::execl("/proc/self/exe", "mpm", "bench", "--point", name_.c_str(), static_cast<char*>(nullptr));
    _exit(machine_failed);
  }
  ::close(to[0]);
  ::close(from[1]);
  questions_ = to[1];
  answers_ = ::fdopen(from[0], "r");
  try {
    particles_ = hear().at("particles");
  } catch (...) {
    end();
    throw;
  }
}

RemotePoint::~RemotePoint() {
  end();
}

void RemotePoint::end() {
  ::close(questions_);  // the process ends when its input ends
  std::fclose(answers_);
  while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

bench::Seconds RemotePoint::run(int steps) {
  const Json taken = ask(std::to_string(steps));
  return {taken.at("wall"), taken.at("processor")};
}

Json RemotePoint::ask(const std::string& what) {
  const std::string line = what + "\n";
  if (::write(questions_, line.data(), line.size()) != static_cast<ssize_t>(line.size()))
    throw support::MachineError::from_errno("write to", "a process of mpm bench", errno);
  return hear();
}

Json RemotePoint::hear() {
  std::string line;
  for (int c; (c = std::fgetc(answers_)) != EOF && c != '\n';) line += static_cast<char>(c);
  if (line.empty())
    throw support::MachineError("mpm bench: the process of a point ended early (" + name_ +
                                "); what it said stands above, most likely memory ran out");
  return Json::parse(line);
}

}  // namespace mpm::app
