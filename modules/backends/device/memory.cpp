#include "backends/device/memory.hpp"

#include <algorithm>

#include "backends/device/compose.hpp"
#include "backends/device/fields.hpp"
#include "backends/device/results.hpp"
#include "backends/device/sorting.hpp"
#include "experiment/device_settings.hpp"
#include "simulation/contact_impulse.hpp"
#include "simulation/contact_points.hpp"

namespace mpm::device {
namespace {

/// What grows with each particle and each node.
std::vector<TakenMemory> taken_by_each(const Experiment& experiment, const Plan& plan,
                                       const std::vector<std::size_t>& particles, std::size_t nodes) {
  const double scalar = experiment.precision == Precision::single ? sizeof(float) : sizeof(double);
  std::vector<TakenMemory> all;
  const auto add = [&](const std::vector<Field>& fields, int body, double count) {
    for (const Field& field : fields)
      all.push_back({field.id, body, field.components, field.components * count * scalar,
                     field.lifetime != Lifetime::saved && field.lifetime != Lifetime::seeded});
  };
  for (std::size_t body = 0; body < particles.size(); ++body) {
    const double count = static_cast<double>(particles[body]);
    add(particle_fields(experiment, plan, static_cast<int>(body)), static_cast<int>(body), count);
    const BlockRoom room(0, particles[body]);
    all.push_back({"blocks", static_cast<int>(body), 2, static_cast<double>(room.of_particles) * sizeof(int), true});
  }
  const double all_nodes = static_cast<double>(nodes) * experiment.field_count;
  add(node_fields(experiment, plan), TakenMemory::of_nodes, all_nodes);
  all.push_back({"folded", TakenMemory::of_nodes, 1, all_nodes * sizeof(int), true});
  if (ContactPoints(experiment).needed()) {
    const double pairs = 0.5 * experiment.field_count * (experiment.field_count - 1);
    all.push_back({"contact", TakenMemory::of_nodes, 2 + experiment.dimension,
                   static_cast<double>(nodes) * pairs * ((2 + experiment.dimension) * scalar + sizeof(int)), true});
  }
  if (experiment.measures_traction()) {
    const double pairs = 0.5 * experiment.field_count * (experiment.field_count - 1);
    const int numbers = experiment.dimension + 1;
    all.push_back(
        {"welds", TakenMemory::of_nodes, numbers, static_cast<double>(nodes) * pairs * numbers * sizeof(double), true});
  }
  if (records_nodes(experiment)) {
    const double pairs = 0.5 * experiment.field_count * (experiment.field_count - 1);
    const int numbers = 2 + 2 * experiment.dimension;
    all.push_back({"contact nodes", TakenMemory::of_nodes, numbers,
                   static_cast<double>(nodes) * pairs * (numbers * scalar + sizeof(int)), true});
  }
  if (sums_deterministically(experiment)) {
    const int channels = most_channels(choice_of(experiment, plan));
    all.push_back({"exact sums", TakenMemory::of_nodes, 2 * channels,
                   2.0 * channels * static_cast<double>(nodes) * sizeof(std::uint64_t), true});
  }
  return all;
}

}  // namespace

std::vector<TakenMemory> taken_by_one(const Experiment& experiment, const Plan& plan) {
  std::vector<TakenMemory> all =
      taken_by_each(experiment, plan, std::vector<std::size_t>(experiment.bodies.size(), 1), 1);
  all.push_back({"active", TakenMemory::of_nodes, 1, static_cast<double>(experiment.field_count) / nodes_of_run, true});
  return all;
}

std::vector<TakenMemory> taken_memory(const Experiment& experiment, const Plan& plan, const SceneSize& size) {
  std::vector<TakenMemory> all = taken_by_each(experiment, plan, size.particles, size.nodes);
  for (std::size_t body = 0; body < size.particles.size(); ++body) {
    const BlockRoom room(size.blocks, size.particles[body]);
    const std::size_t ints = room.of_table + room.of_chunks + room.of_list + room.state;
    all.push_back({"tables of blocks", static_cast<int>(body), 1, static_cast<double>(ints) * sizeof(int), true});
  }
  const std::size_t runs = (size.nodes + nodes_of_run - 1) / nodes_of_run;
  all.push_back({"active", TakenMemory::of_nodes, 1, static_cast<double>(runs) * experiment.field_count, true});
  const std::size_t sums = room_for_sums(size) + Results::numbers;
  all.push_back({"sums", TakenMemory::of_run, 1, static_cast<double>(sums) * sizeof(double), true});
  return all;
}

std::size_t room_for_sums(const SceneSize& size) {
  std::size_t most = size.nodes;
  for (const std::size_t count : size.particles) most = std::max(most, count);
  return most_sums * (most / static_cast<std::size_t>(size.lanes) + 1);
}

void refuse_what_does_not_fit(const Device& device, const Experiment& experiment, const Plan& plan,
                              const SceneSize& size) {
  std::vector<TakenMemory> taken = taken_memory(experiment, plan, size);
  const auto owner = [&](const TakenMemory& field) {
    if (field.body == TakenMemory::of_run) return std::string("the run");
    return field.body < 0 ? "the nodes" : "the particles of " + experiment.bodies[field.body].name;
  };
  double asked = 0;
  for (const TakenMemory& field : taken) asked += field.bytes;
  const auto free = static_cast<double>(device.free_bytes());
  if (asked <= free) return;
  std::stable_sort(taken.begin(), taken.end(),
                   [](const TakenMemory& a, const TakenMemory& b) { return a.bytes > b.bytes; });
  constexpr std::size_t told = 3;
  std::string most;
  for (std::size_t k = 0; k < std::min(told, taken.size()); ++k)
    most +=
        (k == 0 ? "" : ", ") + taken[k].field + " of " + owner(taken[k]) + " (" + bytes_in_words(taken[k].bytes) + ")";
  throw DeviceError("this run needs " + bytes_in_words(asked) + " on device " + device.name() + ", which has " +
                    bytes_in_words(free) + " free; most is taken by " + most +
                    ": use larger cells, fewer particles a cell, --set /precision=float, a device with more memory, or "
                    "--backend cpu");
}

}  // namespace mpm::device
