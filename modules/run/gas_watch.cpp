#include "run/gas_watch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "kernel/equation_of_state.hpp"
#include "metrics/particle_quantities.hpp"
#include "simulation/boundary.hpp"
#include "simulation/rigid_place.hpp"
#include "support/numbers.hpp"

namespace mpm::app {
namespace {

using support::three_digits;

using Cell = std::array<int, 3>;
using Cells = std::set<Cell>;

bool declares(const Plugin& plugin, std::string_view name) {
  const auto& declared = plugin.parameters();
  return std::any_of(declared.begin(), declared.end(), [&](const mpm_parameter& p) { return p.name == name; });
}

bool is_gas(const Component& material) {
  if (!declares(*material.plugin, "heat_capacity_ratio")) return false;
  if (!declares(*material.plugin, "equation_of_state")) return true;
  const auto form = static_cast<EquationOfState>(static_cast<int>(material.parameter("equation_of_state")));
  return form == EquationOfState::stiffened_gas || form == EquationOfState::ideal_gas;
}

/// The pressure at rest, p0, Pa. A stiffened gas has the sum of it and another number.
std::optional<double> pressure_at_rest(const Component& gas) {
  if (declares(*gas.plugin, "pressure")) return gas.parameter("pressure");
  const auto form = static_cast<EquationOfState>(static_cast<int>(gas.parameter("equation_of_state")));
  if (form != EquationOfState::ideal_gas) return {};
  return gas.parameter("bulk_modulus") / gas.parameter("heat_capacity_ratio");
}

/// The cell within the domain whose image beyond a periodic face this one is.
Cell wrapped(const Experiment& experiment, Cell cell) {
  for (int c = 0; c < experiment.dimension; ++c)
    if (experiment.faces[c][0].type == ConditionType::periodic) {
      const int cells = experiment.grid.cells[c];
      cell[c] = (cell[c] % cells + cells) % cells;
    }
  return cell;
}

Cell cell_of(const Experiment& experiment, const double* position) {
  Cell cell{};
  for (int c = 0; c < experiment.dimension; ++c)
    cell[c] = static_cast<int>(std::floor((position[c] - experiment.grid.lower[c]) / experiment.grid.cell_size + 1e-9));
  return wrapped(experiment, cell);
}

Cells cells_of(const Experiment& experiment, const BodyState& state) {
  Cells cells;
  for (std::size_t p = 0; p < state.position.size(); p += static_cast<std::size_t>(experiment.dimension))
    cells.insert(cell_of(experiment, &state.position[p]));
  return cells;
}

/// The middle of a cell, or nothing where it lies beyond the domain.
std::optional<Vector3> middle_of(const Experiment& experiment, const Cell& cell) {
  Vector3 x{};
  for (int c = 0; c < experiment.dimension; ++c) {
    x[c] = experiment.grid.lower[c] + (cell[c] + 0.5) * experiment.grid.cell_size;
    if (x[c] < experiment.grid.lower[c] || x[c] > experiment.grid.upper[c]) return {};
  }
  return x;
}

/// Which cells nothing lies in: no particle, no rigid body; those beyond the domain are not empty.
class Room {
 public:
  explicit Room(const Simulation& simulation) : simulation_(simulation) {
    for (int body = 0; body < static_cast<int>(simulation.experiment().bodies.size()); ++body)
      taken_.merge(cells_of(simulation.experiment(), simulation.backend().body_state(body)));
  }
  /// Whether two empty cells in a row begin beside a cell.
  bool is_open_at(const Cell& cell) const {
    for (int axis = 0; axis < simulation_.experiment().dimension; ++axis)
      for (const int side : {-1, 1}) {
        Cell near = cell, far = cell;
        near[axis] += side, far[axis] += 2 * side;
        if (is_empty(wrapped(simulation_.experiment(), near)) && is_empty(wrapped(simulation_.experiment(), far)))
          return true;
      }
    return false;
  }

 private:
  bool is_empty(const Cell& cell) const {
    const Experiment& experiment = simulation_.experiment();
    const std::optional<Vector3> middle = middle_of(experiment, cell);
    if (!middle || taken_.count(cell) > 0) return false;
    for (std::size_t k = 0; k < experiment.rigid_bodies.size(); ++k) {
      const RigidBodySpecification& rigid = experiment.rigid_bodies[k];
      const Vector3 place = place_at_start(rigid, simulation_.backend().rigid_bodies()[k], *middle);
      if (rigid.geometry->distance(place) < experiment.grid.cell_size) return false;
    }
    return true;
  }

  const Simulation& simulation_;
  Cells taken_;
};

}  // namespace

GasWatch::GasWatch(const Simulation& simulation) : simulation_(simulation) {
  const Experiment& experiment = simulation.experiment();
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
    const Component& material = experiment.materials[experiment.bodies[body].material].component;
    if (!is_gas(material)) continue;
    const MaterialQuantities now = material_quantities(experiment, body, simulation.backend().body_state(body));
    // A body that is filled later begins at rest.
    const double largest =
        now.volume_ratio.empty() ? 1 : *std::max_element(now.volume_ratio.begin(), now.volume_ratio.end());
    gases_.push_back({body, pressure_at_rest(material), largest});
  }
  const auto is_one_gas = [&](const Component& a, const Component& b) {
    return a.plugin == b.plugin && a.parameters == b.parameters;
  };
  const auto material_of = [&](std::size_t gas) -> const Component& {
    return experiment.materials[experiment.bodies[gases_[gas].body].material].component;
  };
  for (std::size_t a = 0; a < gases_.size(); ++a)
    for (std::size_t b = a + 1; b < gases_.size(); ++b)
      if (!is_one_gas(material_of(a), material_of(b)) ||
          experiment.bodies[gases_[a].body].field != experiment.bodies[gases_[b].body].field)
        meetings_.push_back({static_cast<int>(a), static_cast<int>(b)});
}

void GasWatch::look() {
  for (Gas& gas : gases_)
    if (gas.expanded == 0) look_for_expansion(gas);
  look_for_meetings();
}

void GasWatch::look_for_expansion(Gas& gas) {
  const Experiment& experiment = simulation_.experiment();
  const BodyState state = simulation_.backend().body_state(gas.body);
  const MaterialQuantities now = material_quantities(experiment, gas.body, state);
  std::optional<Room> room;  // most rows need none
  for (std::size_t p = 0; p < now.volume_ratio.size(); ++p) {
    const double J = now.volume_ratio[p];
    if (!(J > gas_expands * gas.largest_ratio) || J <= gas.expanded) continue;
    if (!room) room.emplace(simulation_);
    if (room->is_open_at(cell_of(experiment, &state.position[p * static_cast<std::size_t>(experiment.dimension)])))
      gas.expanded = J;
  }
}

void GasWatch::look_for_meetings() {
  const Experiment& experiment = simulation_.experiment();
  std::vector<std::optional<Cells>> known(gases_.size());  // found once a row, where a gas still may meet another
  const auto cells = [&](int gas) -> const Cells& {
    if (!known[gas]) known[gas] = cells_of(experiment, simulation_.backend().body_state(gases_[gas].body));
    return *known[gas];
  };
  for (Meeting& meeting : meetings_) {
    if (meeting.met) continue;
    const Cells &first = cells(meeting.first), &second = cells(meeting.second);
    meeting.met = std::any_of(first.begin(), first.end(), [&](const Cell& cell) {
      for (int axis = 0; axis < experiment.dimension; ++axis)
        for (const int side : {-1, 0, 1}) {
          Cell near = cell;
          near[axis] += side;
          if (second.count(wrapped(experiment, near)) > 0) return true;
        }
      return false;
    });
  }
}

std::vector<std::string> GasWatch::warnings() const {
  const Experiment& experiment = simulation_.experiment();
  const auto name = [&](const Gas& gas) { return "\"" + experiment.bodies[gas.body].name + "\""; };
  std::vector<std::string> all;
  for (const Gas& gas : gases_) {
    if (gas.expanded == 0) continue;
    all.push_back("gas " + name(gas) + " expanded freely, to J = " + three_digits(gas.expanded) +
                  " from J = " + three_digits(gas.largest_ratio) +
                  " at most: pressures are those above the pressure at rest, which lies on every free surface, so that "
                  "this is no vacuum and the gas stops at its own density at rest; confine it by walls or a piston, or "
                  "fill what is around it with gas (docs/plugins.md#ideal_gas)");
  }
  for (const Meeting& meeting : meetings_) {
    if (!meeting.met) continue;
    const Gas &a = gases_[meeting.first], &b = gases_[meeting.second];
    std::string text = "gas " + name(a) + " met gas " + name(b) + ": ";
    if (a.pressure && b.pressure && std::abs(*a.pressure - *b.pressure) > 1e-6 * *a.pressure)
      text += "their pressures at rest, " + three_digits(*a.pressure) + " and " + three_digits(*b.pressure) +
              " Pa, differ, and each is in balance at its own: give both one, and the density that each has there; ";
    text += experiment.bodies[a.body].field == experiment.bodies[b.body].field
                ? "with one velocity for both, their boundary is known to no better than a cell, and the density of "
                  "the lighter one rings there; do not read numbers within two cells of it"
                : "contact only pushes, so that gases part where they expand, into gaps with the pressure at rest; "
                  "leave the contact out, so that both have one velocity";
    all.push_back(text + " (docs/papers.md#a-shock-tube)");
  }
  return all;
}

void GasWatch::save(ArchiveWriter& archive) const {
  for (const Gas& gas : gases_) {
    archive.put("gas_began", gas.largest_ratio);
    archive.put("gas_expanded", gas.expanded);
  }
  for (const Meeting& meeting : meetings_) archive.put("gases_met", meeting.met);
}

void GasWatch::restore(ArchiveReader& archive) {
  for (Gas& gas : gases_) {
    archive.get("gas_began", gas.largest_ratio);
    archive.get("gas_expanded", gas.expanded);
  }
  for (Meeting& meeting : meetings_) archive.get("gases_met", meeting.met);
}

}  // namespace mpm::app
