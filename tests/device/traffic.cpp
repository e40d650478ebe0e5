// What a step moves: the words that launches read and write, by rules that a hand can follow, and the counts of a step.

#include "backends/device/traffic.hpp"

#include <array>
#include <cmath>
#include <set>

#include "device/device_support.hpp"
#include "simulation/boundary.hpp"
#include "support/temporary_folder.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Two arrays of words that launches share, and one launch after the other on them.
class Launches {
 public:
  Launches() { recorder.add_memory(address(0), sizeof words_), recorder.add_memory(other(), sizeof other_); }
  /// The kernel's second argument leads to the third word, its third one to the first word of the other array.
  void begin(const std::string& kernel) { recorder.begin_launch(kernel, {7, address(2), other()}); }
  std::uintptr_t address(std::size_t word) const { return reinterpret_cast<std::uintptr_t>(words_.data() + word); }
  std::uintptr_t other() const { return reinterpret_cast<std::uintptr_t>(other_.data()); }
  void read(std::size_t word, std::size_t bytes = 4) { recorder.access(words_.data() + word, bytes, false, false); }
  void write(std::size_t word, std::size_t bytes = 4) { recorder.access(words_.data() + word, bytes, true, false); }
  void add(std::size_t word, std::size_t bytes = 4) { recorder.access(words_.data() + word, bytes, true, true); }
  void write_other(std::size_t word) { recorder.access(other_.data() + word, 4, true, false); }
  void begin_team(int team) { recorder.begin_team(team, nullptr, 0); }

  device::RaceRecorder recorder;

 private:
  std::array<float, 64> words_{}, other_{};
};

/// The nodes in runs of 16 that blocks of 4 by 4 cells with particles reach, one before and two behind: where no wall is near.
class ReachedNodes {
 public:
  explicit ReachedNodes(const Experiment& experiment) : experiment_(experiment) {
    for (std::size_t c = 0; c < 2; ++c) extent_[c] = experiment.grid.cells[c] + 1 + 2 * padding();
  }
  /// Adds what particles at these places reach, [particle][2], m.
  void add(const std::vector<double>& position) {
    for (std::size_t p = 0; p < position.size() / 2; ++p) {
      long first[2];
      for (std::size_t c = 0; c < 2; ++c) {
        const double cells = (position[2 * p + c] - experiment_.grid.lower[c]) / experiment_.grid.cell_size;
        first[c] = 4 * static_cast<long>(std::floor(cells / 4)) + padding() - 1;
      }
      for (long y = std::max(0l, first[1]); y < std::min(extent_[1], first[1] + 7); ++y)
        for (long x = std::max(0l, first[0]); x < std::min(extent_[0], first[0] + 7); ++x)
          runs_.insert((y * extent_[0] + x) / 16);
    }
  }
  long all() const { return extent_[0] * extent_[1]; }
  long nodes() const {
    long sum = 0;
    for (const long run : runs_) sum += std::min(16l, all() - 16 * run);
    return sum;
  }

 private:
  int padding() const { return grid_padding_of(experiment_.shape.plugin->shape()); }

  const Experiment& experiment_;
  long extent_[2];
  std::set<long> runs_;
};

}  // namespace

TEST_CASE("each word counts once a launch and direction, and what is written first is not read", "[device][traffic]") {
  Launches launches;
  launches.begin("mpm_a");
  launches.begin_team(0), launches.recorder.begin_lane(0);
  launches.read(0, 8), launches.read(1), launches.read(0);  // two words
  launches.write(1, 12), launches.write(2);                 // three words, of which one was read
  launches.read(3);                                         // written before
  launches.add(10), launches.add(10);                       // a sum is read and written
  launches.begin_team(1), launches.recorder.begin_lane(0);
  launches.read(0), launches.add(10), launches.read(20);  // one word more
  const device::Traffic first = launches.recorder.traffic().at("mpm_a");
  CHECK(first.launches == 1);
  CHECK(first.bytes_read == 4 * (2 + 1 + 1));
  CHECK(first.bytes_written == 4 * (3 + 1));
  launches.begin("mpm_a");  // all words are as new
  launches.begin_team(0), launches.recorder.begin_lane(0);
  launches.read(0), launches.write(3);
  launches.begin("mpm_b");
  const device::Traffic second = launches.recorder.traffic().at("mpm_a");
  CHECK(second.launches == 2);
  CHECK(second.bytes_read == first.bytes_read + 4);
  CHECK(second.bytes_written == first.bytes_written + 4);
  CHECK(second.bytes() == second.bytes_read + second.bytes_written);
  CHECK(launches.recorder.traffic().at("mpm_b").bytes() == 0);
}

TEST_CASE("a race is told with both lanes, the field's pointer and the bytes from there", "[device][traffic]") {
  Launches launches;
  const auto texts = [&] {
    std::vector<std::string> all;
    for (const device::Race& race : launches.recorder.races())
      all.push_back(race.text("argument " + std::to_string(race.argument)));
    return all;
  };
  launches.begin("mpm_a");
  launches.begin_team(0), launches.recorder.begin_lane(3);
  launches.write(5), launches.read(1);
  launches.recorder.begin_lane(4), launches.read(1);
  launches.recorder.end_phase();  // orders the lanes of the team
  launches.recorder.begin_lane(4), launches.read(5);
  CHECK(texts().empty());
  launches.recorder.begin_lane(5), launches.write(5);
  CHECK(texts() == std::vector<std::string>{
                       "mpm_a, phase 1: lane 4 of team 0 reads and lane 5 of team 0 writes argument 8, byte 12"});
  launches.begin_team(1), launches.recorder.begin_lane(3);  // no phase orders two teams
  launches.write_other(9);
  launches.begin_team(2), launches.recorder.begin_lane(3);
  launches.recorder.end_phase(), launches.recorder.begin_lane(3);
  launches.write_other(9);
  REQUIRE(texts().size() == 2);
  CHECK(texts()[1] == "mpm_a, phase 1: lane 3 of team 1 writes and lane 3 of team 2 writes argument 16, byte 36");
  launches.begin("mpm_b");  // the next launch comes after all of it
  launches.begin_team(0), launches.recorder.begin_lane(0);
  launches.add(5), launches.write_other(9);
  launches.recorder.begin_lane(1), launches.add(5);  // sums may meet
  CHECK(texts().size() == 2);
  launches.recorder.begin_lane(2), launches.read(5);
  REQUIRE(texts().size() == 3);
  CHECK(texts()[2].find("mpm_b, phase 0: lane 1 of team 0 adds to and lane 2 of team 0 reads argument 8") == 0);
  launches.begin("mpm_c");  // the last that read the word is who writes it, but another one has read it too
  launches.begin_team(0), launches.recorder.begin_lane(0);
  launches.read(5), launches.recorder.begin_lane(1), launches.read(5), launches.write(5);
  REQUIRE(texts().size() == 4);
  CHECK(texts()[3].find("mpm_c, phase 0: lane 0 of team 0 reads and lane 1 of team 0 writes argument 8") == 0);
}

TEST_CASE("who was at a word before stays known when one comes back to it", "[device][traffic]") {
  Launches launches;
  const auto last_text = [&] {
    return launches.recorder.races().empty() ? "" : launches.recorder.races().back().text("it");
  };
  const auto read_by = [&](int team, int lane) {
    launches.begin_team(team), launches.recorder.begin_lane(lane), launches.read(2);
  };
  launches.begin("mpm_lanes");
  launches.begin_team(0), launches.recorder.begin_lane(0);
  launches.read(2), launches.recorder.begin_lane(1), launches.read(2), launches.read(2);
  CHECK(last_text() == "");
  launches.write(2);
  CHECK(last_text() == "mpm_lanes, phase 0: lane 0 of team 0 reads and lane 1 of team 0 writes it, byte 0");
  launches.begin("mpm_teams");
  read_by(0, 0), read_by(1, 0), launches.read(2), launches.write(2);
  CHECK(last_text() == "mpm_teams, phase 0: lane 0 of team 0 reads and lane 0 of team 1 writes it, byte 0");
  launches.begin("mpm_all_lanes");  // before a team's first phase, whatever lane the team before ended with
  read_by(0, 3), launches.begin_team(1), launches.read(2);
  CHECK(launches.recorder.races().size() == 2);
  launches.write(2);
  CHECK(last_text() ==
        "mpm_all_lanes, phase 0: every lane of team 1 writes and every lane of team 1 writes it, byte 0");
  std::array<float, 4> shared{};
  launches.begin("mpm_shared");
  launches.recorder.begin_team(0, shared.data(), sizeof shared);
  for (const int lane : {0, 1}) {
    launches.recorder.begin_lane(lane);
    launches.recorder.access(shared.data() + 3, 4, true, false);
  }
  CHECK(last_text() == "mpm_shared, phase 0: lane 0 of team 0 writes and lane 1 of team 0 writes it, byte 12");
  CHECK(launches.recorder.races().back().argument == -1);
  CHECK(launches.recorder.races().size() == 4);
}

TEST_CASE("memory counts in words up to its end, while it is there and a kernel runs", "[device][traffic]") {
  alignas(4) std::array<char, 64> memory{};
  device::RaceRecorder recorder;
  const auto begin = reinterpret_cast<std::uintptr_t>(memory.data());
  recorder.add_memory(begin, 4), recorder.add_memory(begin + 32, 5);
  const auto bytes_read = [&](std::size_t at, std::size_t bytes) {
    const device::Recording recording(&recorder, "mpm_a", {});
    recorder.forget_traffic();
    recorder.begin_launch("mpm_a", {});
    recorder.begin_team(0, nullptr, 0), recorder.begin_lane(0);
    device::access_recorder()->access(memory.data() + at, bytes, false, false);
    return recorder.traffic().at("mpm_a").bytes_read;
  };
  CHECK(bytes_read(0, 1) == 4);
  CHECK(bytes_read(0, 4) == 4);
  CHECK(bytes_read(0, 12) == 4);  // no more than there is
  CHECK(bytes_read(4, 4) == 0);
  CHECK(bytes_read(32, 5) == 8);
  CHECK(bytes_read(36, 1) == 4);
  CHECK(bytes_read(35, 2) == 8);
  CHECK(bytes_read(32, 16) == 8);
  const long accesses = recorder.accesses();
  CHECK(accesses == 7);
  device::access_recorder()->access(memory.data(), 4, false, false);  // of no kernel
  CHECK(recorder.accesses() == accesses);
  recorder.remove_memory(begin + 32);
  CHECK(bytes_read(32, 4) == 0);
  CHECK(recorder.accesses() == accesses);
}

TEST_CASE("averages are of one step and one particle", "[device][traffic]") {
  device::StepTraffic traffic;
  traffic.kernels = {{"one", {4, 100, 20}}, {"other", {2, 30, 10}}};
  traffic.steps = 2, traffic.particles = 10, traffic.bytes_copied = 40;
  CHECK(traffic.bytes_per_particle_step() == 8);
  CHECK(traffic.copied_per_particle_step() == 2);
  CHECK(traffic.launches_per_step() == 3);
}

TEST_CASE("a step is counted with all that it launches, copies and clears", "[device][traffic]") {
  device_setup();  // so that the usual devices are not set later
  const TemporaryFolder folder;
  setenv("MPM_CACHE", folder.path().c_str(), 1);
  const Experiment experiment = device_experiment(Mix{}.text(), "double");
  const device::StepTraffic counted = device::count_traffic(experiment, 3);
  unsetenv("MPM_CACHE");
  use_usual_devices();
  device::DeviceSetup setup = device_setup();
  setup.graphs = false;
  Simulation simulation(experiment, device_factory(setup));
  simulation.observe_when([](double, long) { return false; });
  ReachedNodes reached(experiment);
  long cleared = 0;  // nodes: those that the steps before have reached
  long launches = 0;
  std::uint64_t copied = 0;
  for (int step = 0; step < 4; ++step) {
    if (step > 0) cleared += reached.nodes();
    for (int body = 0; body < 2; ++body) reached.add(simulation.backend().body_state(body).position);
    const long launches_before = device::calls_on_host("cuLaunchKernel");
    const std::uint64_t copied_before = device::bytes_copied_on_host();
    simulation.step();
    if (step == 0) continue;
    launches += device::calls_on_host("cuLaunchKernel") - launches_before;
    copied += device::bytes_copied_on_host() - copied_before;
  }
  CHECK(counted.steps == 3);
  CHECK(counted.particles == simulation.particle_count());
  CHECK(3 * counted.launches_per_step() == Approx(launches));
  CHECK(counted.bytes_copied == static_cast<double>(copied));
  double components = 0;
  for (const Field& field : device_choice_of(experiment).node_fields)
    components += field.cleared ? field.components : 0;
  REQUIRE(reached.nodes() < reached.all());
  const double words =
      std::ceil(std::ceil(static_cast<double>(reached.all()) / 16) / 4);  // a byte for each 16 nodes says whether
  CHECK(counted.kernels.at("clear").bytes_read == 3 * words * 4);
  CHECK(counted.kernels.at("clear").bytes_written ==
        static_cast<double>(cleared) * (components * sizeof(double) + sizeof(int)));  // and whether it is folded
}
