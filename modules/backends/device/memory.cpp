#include "backends/device/memory.hpp"

#include <algorithm>

#include "backends/device/fields.hpp"

namespace mpm::device {
namespace {

struct Taken {
  std::string field, owner;
  double bytes;
};

/// What each field takes, bytes.
std::vector<Taken> taken_by_fields(const Experiment& experiment, const Plan& plan,
                                   const std::vector<SeededBody>& seeded, std::size_t nodes) {
  const double scalar = experiment.precision == Precision::single ? sizeof(float) : sizeof(double);
  std::vector<Taken> all;
  const auto add = [&](const std::vector<Field>& fields, const std::string& owner, double count) {
    for (const Field& field : fields) all.push_back({field.id, owner, field.components * count * scalar});
  };
  for (std::size_t body = 0; body < seeded.size(); ++body) {
    const std::string owner = "the particles of " + experiment.bodies[body].name;
    const double count = static_cast<double>(seeded[body].count());
    add(particle_fields(experiment, plan, static_cast<int>(body)), owner, count);
    all.push_back({"blocks", owner, 2 * count * sizeof(int)});
  }
  const double all_nodes = static_cast<double>(nodes) * experiment.field_count;
  add(node_fields(experiment, plan), "the nodes", all_nodes);
  all.push_back({"folded", "the nodes", all_nodes * sizeof(int)});
  return all;
}

}  // namespace

void refuse_what_does_not_fit(const Device& device, const Experiment& experiment, const Plan& plan,
                              const std::vector<SeededBody>& seeded, std::size_t nodes) {
  std::vector<Taken> taken = taken_by_fields(experiment, plan, seeded, nodes);
  double asked = 0;
  for (const Taken& field : taken) asked += field.bytes;
  const auto free = static_cast<double>(device.free_bytes());
  if (asked <= free) return;
  std::stable_sort(taken.begin(), taken.end(), [](const Taken& a, const Taken& b) { return a.bytes > b.bytes; });
  constexpr std::size_t told = 3;
  std::string most;
  for (std::size_t k = 0; k < std::min(told, taken.size()); ++k)
    most +=
        (k == 0 ? "" : ", ") + taken[k].field + " of " + taken[k].owner + " (" + bytes_in_words(taken[k].bytes) + ")";
  throw DeviceError("this run needs " + bytes_in_words(asked) + " on device " + device.name() + ", which has " +
                    bytes_in_words(free) + " free; most is taken by " + most +
                    ": use larger cells, fewer particles a cell, --set /precision=float, a device with more memory, or "
                    "--backend cpu");
}

}  // namespace mpm::device
