#include "backends/device/memory.hpp"

#include <algorithm>

#include "backends/device/compose.hpp"
#include "backends/device/contact_sight.hpp"
#include "backends/device/fields.hpp"
#include "backends/device/particle_formulas.hpp"
#include "backends/device/results.hpp"
#include "backends/device/sorting.hpp"
#include "experiment/device_settings.hpp"
#include "operators/loads.hpp"
#include "simulation/contact_impulse.hpp"
#include "simulation/contact_points.hpp"

namespace mpm::device {
namespace {

double bytes_of_scalar(const Experiment& experiment) {
  return experiment.precision == Precision::single ? sizeof(float) : sizeof(double);
}

double bytes_of_share(const Experiment& experiment) {
  return experiment.precision == Precision::single ? sizeof(LoadShare<float>) : sizeof(LoadShare<double>);
}

/// What grows with each particle and each node.
std::vector<TakenMemory> taken_by_each(const Experiment& experiment, const Plan& plan,
                                       const std::vector<std::size_t>& particles, std::size_t nodes) {
  const double scalar = bytes_of_scalar(experiment);
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
    if (!experiment.loaded_at_points(static_cast<int>(body)).empty())
      all.push_back({"loads", static_cast<int>(body), 1, count * sizeof(int), false});
  }
  const double all_nodes = static_cast<double>(nodes) * experiment.field_count;
  add(node_fields(experiment, plan), TakenMemory::of_nodes, all_nodes);
  all.push_back({"folded", TakenMemory::of_nodes, 1, all_nodes * sizeof(int), true});
  const double all_pairs = all_nodes * (experiment.field_count - 1) / 2;
  const auto add_to_pairs = [&](const char* what, int numbers, double bytes) {
    all.push_back({what, TakenMemory::of_nodes, numbers, all_pairs * bytes, true});
  };
  const int of_contact = 2 + experiment.dimension, of_weld = 1 + experiment.dimension,
            of_note = 2 + 2 * experiment.dimension;
  if (ContactPoints(experiment).needed()) {
    add_to_pairs("contact", of_contact, of_contact * scalar + sizeof(int));
    all.push_back({"nodes that meet", TakenMemory::of_nodes, 1, static_cast<double>(nodes) * sizeof(int), true});
  }
  if (experiment.measures_traction()) add_to_pairs("welds", of_weld, of_weld * sizeof(double));
  if (records_nodes(experiment)) add_to_pairs("contact nodes", of_note, of_note * scalar + sizeof(int));
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
    if (!experiment.loaded_at_points(static_cast<int>(body)).empty() && !size.load_shares.empty())
      all.push_back({"shares of loads", static_cast<int>(body), 1,
                     static_cast<double>(size.load_shares[body]) * bytes_of_share(experiment) + sizeof(int), false});
    all.push_back({"tables of blocks", static_cast<int>(body), 1, static_cast<double>(ints) * sizeof(int), true});
  }
  const std::size_t runs = (size.nodes + nodes_of_run - 1) / nodes_of_run;
  all.push_back({"active", TakenMemory::of_nodes, 1, static_cast<double>(runs) * experiment.field_count, true});
  if (const SightRoom sight(experiment, size.nodes, size.lanes); sight.row_length > 0)
    all.push_back(
        {"rows of particles", TakenMemory::of_run, 1, static_cast<double>(sight.numbers()) * sizeof(double), true});
  const ParticleFormulas formulas(experiment);
  all.push_back({"formula numbers", TakenMemory::of_run, 1,
                 static_cast<double>(formulas.count()) * bytes_of_scalar(experiment), true});
  const std::size_t sums = room_for_sums(size) + Results::numbers + count_of_totals;
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
