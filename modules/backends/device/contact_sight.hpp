#pragma once
// What a device keeps where contact looks at particles (kernels/contact_points.hpp): the bodies as nodes look at them, the
// rows in which lanes keep what their nodes see, and what was found of each pair.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "backends/device/device_arrays.hpp"
#include "operators/contact_points.hpp"
#include "simulation/boundary.hpp"
#include "simulation/contact_impulse.hpp"
#include "simulation/contact_points.hpp"

namespace mpm::device {

/// The lanes that look at particles at the same time, and the rows in which these keep what they see.
struct SightRoom {
  int teams = 1, lanes_of_team = 1;
  int row_length = 0;  ///< particles; 0 where the normal looks at none
  int dimension = 2;

  SightRoom(const Experiment& experiment, std::size_t nodes, int lanes)
      : lanes_of_team(lanes), dimension(experiment.dimension) {
    const ContactPoints points(experiment);
    if (!points.needed()) return;
    if (points.gives_normal()) row_length = usual_row(experiment, points);
    // Fields meet at a small part of the nodes.
    constexpr std::size_t share_of_nodes = 16, most_lanes = 16384, most_bytes = std::size_t{256} << 20;
    const std::size_t fitting = most_bytes / std::max(bytes_of_row(), sizeof(double)),
                      wanted = std::min({nodes / share_of_nodes + 1, most_lanes, fitting});
    teams = static_cast<int>(std::max<std::size_t>(1, (wanted + lanes - 1) / static_cast<std::size_t>(lanes)));
  }

  int lanes() const { return teams * lanes_of_team; }
  std::size_t bytes_of_row() const { return static_cast<std::size_t>(row_length) * dimension * sizeof(double); }
  /// The numbers of all rows.
  std::size_t numbers() const { return static_cast<std::size_t>(lanes()) * bytes_of_row() / sizeof(double); }

 private:
  /// Half as many again as a node sees in bodies as they were seeded; where bodies are mixed it sees twice as many.
  static int usual_row(const Experiment& experiment, const ContactPoints& points) {
    int per_axis = 1;
    for (const BodySpecification& body : experiment.bodies) per_axis = std::max(per_axis, body.particles_per_cell_axis);
    const bool list = experiment.shape.plugin->shape().form == MPM_NODE_LIST;
    const double reach = std::max(points.reach() + (list ? 0.5 / per_axis : 0.0), least_reach);
    return static_cast<int>(std::ceil(1.5 * std::pow(2 * reach * per_axis, experiment.dimension)));
  }
};

template <class T>
class ContactSight {
 public:
  /// `row_length` is that of the rows in place of what the scene asks for; -1 for that.
  ContactSight(Device& device, const Experiment& experiment, const Arguments<T>& scene,
               const std::vector<Body<T>>& bodies, int lanes, int row_length)
      : points_(experiment),
        experiment_(experiment),
        room_(experiment, static_cast<std::size_t>(scene.node_count), lanes),
        bodies_(device, "the bodies that meet"),
        numbers_(device, "the bodies that meet", 1 + bodies.size()),
        meeting_(device, "nodes that meet", static_cast<std::size_t>(scene.node_count)),
        rows_(device, "rows of particles") {
    if (row_length >= 0) room_.row_length = row_length;
    rows_.resize(room_.numbers());
    const auto nodes = static_cast<std::size_t>(scene.node_count);
    for (int k = 0; k < experiment.field_count * (experiment.field_count - 1) / 2; ++k)
      pairs_.emplace_back(device, nodes, experiment.dimension);
    std::vector<SeenBody<T>> table;
    for (int field = 0; field < experiment.field_count; ++field) {
      first_.push_back(static_cast<int>(table.size()));
      for (std::size_t body = 0; body < bodies.size(); ++body)
        if (bodies[body].field == field && bodies[body].count > 0)
          place_.push_back(body), table.push_back(seen(bodies[body], body));
    }
    first_.push_back(static_cast<int>(table.size()));
    bodies_.upload(table);
  }

  /// The teams that look at particles.
  int teams() const { return room_.teams; }
  /// Forgets how far lists reach, and the nodes at which a pair met.
  void forget_reach() const { numbers_.fill(0, 1, numbers_.count() - 1); }
  void forget_nodes() const { numbers_.fill(0, 0, 1); }
  /// How nodes look at fields a < b, at the device's addresses.
  SeenParticles<T> of(int a, int b) const {
    SeenParticles<T> seen = common();
    const int fields[2] = {a, b};
    for (int k = 0; k < 2; ++k) {
      seen.bodies[k] = bodies_.data() + first_[fields[k]];
      seen.count[k] = first_[fields[k] + 1] - first_[fields[k]];
    }
    const Pair& pair = pairs_[pair_index(a, b, experiment_.field_count)];
    seen.valid = pair.valid.data(), seen.values = pair.values.data();
    return seen;
  }
  /// Calls visit(number of the body, how it is looked at) for all bodies with particles.
  template <class Visit>
  void for_each_body(Visit visit) const {
    for (std::size_t k = 0; k < place_.size(); ++k) {
      SeenParticles<T> seen = common();
      seen.bodies[0] = bodies_.data() + k, seen.count[0] = 1;
      visit(place_[k], seen);
    }
  }

 private:
  struct Pair {
    DeviceArray<int> valid;
    DeviceArray<T> values;
    Pair(Device& device, std::size_t nodes, int dimension)
        : valid(device, "contact", nodes), values(device, "contact", static_cast<std::size_t>(2 + dimension) * nodes) {}
  };

  SeenParticles<T> common() const {
    SeenParticles<T> seen{};
    for (std::size_t c = 0; c < 3; ++c) seen.lower[c] = experiment_.grid.lower[c];
    seen.cell_size = experiment_.grid.cell_size, seen.reach = points_.reach();
    seen.meeting_count = numbers_.data(), seen.meeting = meeting_.data();
    seen.rows = rows_.data(), seen.row_length = room_.row_length, seen.lanes = room_.lanes();
    return seen;
  }
  /// A domain is given in cells; else the deformation gradient and half the undeformed side make one.
  SeenBody<T> seen(const Body<T>& body, std::size_t number) const {
    SeenBody<T> seen{};
    const bool by_domain = body.number("domain") >= 0;
    seen.position = body.arrays.of(std::string_view("position")), seen.stride = body.count;
    seen.sides = body.arrays.of(std::string_view(by_domain ? "domain" : points_.sees_surfaces() ? "deformation" : ""));
    seen.half_side = by_domain ? 1.0 : points_.half_side(body.volume);
    if (!by_domain && !experiment_.axisymmetric()) seen.size = body.arrays.of(std::string_view("size"));
    seen.nearest = numbers_.data() + 1 + number;
    seen.blocks = body.blocks.table();
    return seen;
  }

  ContactPoints points_;
  const Experiment& experiment_;
  SightRoom room_;
  DeviceArray<SeenBody<T>> bodies_;  ///< those with particles, field by field
  std::vector<int> first_;           ///< [field] the first of its bodies, and their number
  std::vector<std::size_t> place_;   ///< the number of each body in the experiment
  DeviceArray<int> numbers_;         ///< the nodes at which a pair meets, then how far each body's lists reach
  DeviceArray<int> meeting_;
  DeviceArray<double> rows_;
  std::vector<Pair> pairs_;  ///< [pair_index]
};

}  // namespace mpm::device
