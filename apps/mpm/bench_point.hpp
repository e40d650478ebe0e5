#pragma once
// A contender in a process of its own, so that its memory can be measured: the program run again as `mpm bench
// --point`.

#include <cstdio>
#include <string>

#include "bench/measure.hpp"
#include "bench/table.hpp"

namespace mpm::app {

/// A contender in another process. It is told what it is made of, and answers when it is ready, in lines of JSON.
class RemotePoint final : public bench::Contender {
 public:
  /// Starts the process and waits until its first step is done. Throws MachineError when it ends before.
  explicit RemotePoint(const bench::Json& description);
  ~RemotePoint() override;
  RemotePoint(const RemotePoint&) = delete;
  RemotePoint& operator=(const RemotePoint&) = delete;

  void step() override { run(1); }
  bench::Seconds run(int steps) override;
  std::size_t particle_count() const override { return particles_; }
  int steps_a_cycle() const override { return cycle_; }
  /// The point's numbers: startup_seconds, peak_bytes (growth of the resident set), particle_bytes, grid_bytes,
  /// state_bytes.
  bench::Json report() { return ask("report"); }

 private:
  bench::Json ask(const std::string& what);
  bench::Json hear();
  void end();

  std::string name_;
  std::FILE* answers_ = nullptr;
  int questions_ = -1;
  int process_ = -1;
  std::size_t particles_ = 0;
  int cycle_ = 1;
};

}  // namespace mpm::app
