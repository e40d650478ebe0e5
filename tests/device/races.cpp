// Lanes of one phase, and teams of one launch, that meet on one address: every access of every kernel is recorded, and
// two of them that nothing orders on a GPU are reported with kernel, phase and field.

#include <cstddef>

#include "backends/device/kernels/arguments.hpp"
#include "device/covering.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A change of a composition's text: the program is that of the kernels with a mistake in them.
struct Mistake {
  std::string from, to;
};

/// A device that records, with `lanes` a team in an order, and programs that tell it what they access.
class RecordingDevice {
 public:
  RecordingDevice(unsigned order, std::vector<Mistake> mistakes) : mistakes_(std::move(mistakes)) {
    device_setup();  // so that the usual ones are not set later
    device::set_host_devices({{"host, recording", 0, order, true}});
  }
  ~RecordingDevice() { use_usual_devices(); }
  RecordingDevice(const RecordingDevice&) = delete;
  RecordingDevice& operator=(const RecordingDevice&) = delete;

  device::DeviceSetup setup() const {
    device::DeviceSetup setup{&device::host_driver(), 0, 8,
                              [this](device::Composition composition, const std::string&) {
                                for (const Mistake& mistake : mistakes_) {
                                  const std::size_t at = composition.text.find(mistake.from);
                                  REQUIRE(at != std::string::npos);
                                  composition.text.replace(at, mistake.from.size(), mistake.to);
                                }
                                return program_of(composition);
                              }};
    setup.steps_to_forget = 2;  // the third step forgets what two have reached
    return setup;
  }
  const std::vector<device::Race>& races() const { return device::recorder_on_host(0).races(); }
  long accesses() const { return device::recorder_on_host(0).accesses(); }

 private:
  static std::string program_of(const device::Composition& composition) {
    static std::map<std::string, std::string> made;  // by text: orders share a program
    std::string& image = made[composition.text];
    if (image.empty()) {
      device::HostCompiler compiler;
      compiler.records = true;
      image = compiler.compile(composition);
    }
    return image;
  }
  std::vector<Mistake> mistakes_;
};

/// The name of what a pointer in the arguments leads to.
template <class T>
std::string name_of(const device::Choice& choice, long argument) {
  using Arguments = device::Arguments<T>;
  using Particles = device::ParticleArrays<T>;
  using Nodes = device::NodeArrays<T>;
  constexpr long pointer = sizeof(T*);
  const auto field = [&](const std::vector<Field>& fields, long begin) -> std::string {
    const long number = (argument - begin) / pointer;
    return argument >= begin && number < static_cast<long>(fields.size()) ? fields[static_cast<std::size_t>(number)].id
                                                                          : "";
  };
  if (argument < 0) return "shared memory";
  const long particles = offsetof(Arguments, particles) + offsetof(Particles, field),
             grid = offsetof(Arguments, grid) + offsetof(Nodes, field),
             other = offsetof(Arguments, other) + offsetof(Nodes, field);
  if (const std::string id = field(choice.particle_fields, particles); !id.empty()) return id + " of particles";
  if (const std::string id = field(choice.node_fields, grid); !id.empty()) return id + " of nodes";
  if (const std::string id = field(choice.node_fields, other); !id.empty()) return id + " of nodes";
  return "what the argument at byte " + std::to_string(argument) + " leads to";
}

std::string words_for(const device::Race& race, const Experiment& experiment) {
  const device::Choice choice = device_choice_of(experiment);
  return race.text(experiment.precision == Precision::single ? name_of<float>(choice, race.argument)
                                                             : name_of<double>(choice, race.argument));
}

/// What races some steps of a mix have, in words.
std::vector<std::string> races_of(const Mix& mix, const std::string& precision, unsigned order, int steps,
                                  const std::vector<Mistake>& mistakes = {},
                                  std::set<std::string>* launched = nullptr) {
  const RecordingDevice device(order, mistakes);
  // The ledger rests after the first step, so that particles advance in one launch there.
  std::vector<std::string> overrides = mix.overrides;
  const bool has_output = mix.text().find("\"output\"") != std::string::npos;
  overrides.push_back(has_output ? set("/output/ledger_every", "3") : set("/output", R"({"ledger_every": 3})"));
  const Experiment experiment = device_experiment(mix.text(), precision, overrides);
  {
    Simulation simulation(experiment, device_factory(device.setup()));
    simulation.backend().measure_phases(true);
    for (int step = 0; step < steps; ++step) simulation.step();
    simulation.backend().body_state(0);
    const Metrics measured(simulation);
    if (launched)
      for (const auto& [phase, seconds] : simulation.backend().phase_seconds()) launched->insert(phase);
  }
  CHECK(device.accesses() > 1000);  // the program has told something
  std::vector<std::string> words;
  for (const device::Race& race : device.races()) words.push_back(words_for(race, experiment));
  return words;
}

std::string one_line_each(const std::vector<std::string>& lines) {
  std::string all;
  for (const std::string& line : lines) all += "\n  " + line;
  return all;
}

void check_no_races(const Mix& mix, const std::string& precision, int steps, std::set<std::string>& launched) {
  for (const unsigned order : {0u, 1u, 77u}) {
    const std::vector<std::string> found = races_of(mix, precision, order, steps, {}, &launched);
    INFO(mix.name() << " " << precision << ", order " << order << one_line_each(found));
    CHECK(found.empty());
  }
}

/// The phases of all compositions of some mixes, "scatter", "stress_0".
std::set<std::string> phases_of(const std::vector<Mix>& mixes) {
  std::set<std::string> all;
  for (const Mix& mix : mixes)
    for (const std::string& entry :
         device::compose(device_choice_of(device_experiment(mix.text(), "double", mix.overrides))).entries)
      all.insert(entry.substr(std::string("mpm_").size()));
  return all;
}

void check_that_all_were_launched(const std::vector<Mix>& mixes, const std::set<std::string>& launched) {
  for (const std::string& phase : phases_of(mixes)) {
    INFO(phase);
    CHECK(launched.count(phase) == 1);
  }
}

}  // namespace

TEST_CASE("a race that is planted in a kernel is reported with its kernel, its phase and its field",
          "[device][races]") {
  Mix mix;
  mix.transfer = R"({"type": "flip"})";
  const auto found_in = [&](const Mistake& mistake, unsigned order) {
    return one_line_each(races_of(mix, "double", order, 2, {mistake}));
  };
  for (const unsigned order : {0u, 1u, 5u}) {
    INFO("order " << order);
    // The tile's node is added to the grid as if no other block had it.
    CHECK_THAT(found_in({"Team::add(channel[first + k] + node_index<D>(a, node), value);",
                         "channel[first + k][node_index<D>(a, node)] += value;"},
                        order),
               ContainsSubstring("mpm_scatter, phase 2: ") && ContainsSubstring("mass of nodes, byte "));
    // A lane adds to the tile while others do.
    CHECK_THAT(found_in({"Team::add(at >= 0 ? tile + k * Tile<D>::nodes + at : to + node_index<D>(a, node), "
                         "values[first + k]);",
                         "*(at >= 0 ? tile + k * Tile<D>::nodes + at : to + node_index<D>(a, node)) += "
                         "values[first + k];"},
                        order),
               ContainsSubstring("mpm_scatter, phase 1: ") && ContainsSubstring("shared memory, byte "));
  }
  // Lanes that join their sums all add to the first one's: run one after the other, they make the right sum.
  CHECK_THAT(found_in({"Join::join(of_lane + lane * count, ", "Join::join(of_lane, "}, 0),
             ContainsSubstring("mpm_energy_of_particles, phase ") && ContainsSubstring("shared memory, byte 0"));
  // All lanes write to one place what stands there: no result shows that.
  const auto planted_after = [&](const std::string& line) {
    return found_in({line, line + " a.particles.field[0][0] += 0;"}, 0);
  };
  CHECK_THAT(planted_after("if (!keep_volume_ratio<Scene>(a, p, state)) report(a, p);"),
             ContainsSubstring("mpm_stress_0, phase 0: ") && ContainsSubstring("position of particles, byte 0"));
  CHECK_THAT(planted_after("if (!keep_volume_ratio<Scene>(a, p, state)) return report(a, p, part_of_strain);"),
             ContainsSubstring("mpm_advance_0, phase 0: ") && ContainsSubstring("position of particles, byte 0"));
}

TEST_CASE("no two lanes of a phase meet on one address", "[device][races]") {
  std::set<std::string> launched;
  const std::vector<Mix> flat = every_kernel(2);
  for (const Mix& mix : flat) check_no_races(mix, "double", 3, launched);
  check_that_all_were_launched(flat, launched);
}

TEST_CASE("no two lanes of a phase meet on one address in three dimensions, and in float", "[device][races][slow]") {
  std::set<std::string> launched;
  for (const int dimension : {2, 3})
    for (const Mix& mix : every_kernel(dimension)) check_no_races(mix, "float", 3, launched);
}
