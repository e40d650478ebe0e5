// The grid, its faces, and conditions on boxes of nodes.
#include <cmath>

#include "experiment/axis_names.hpp"
#include "experiment/reader.hpp"
#include "experiment/thermal.hpp"

namespace mpm {
namespace {

ConditionType condition_type(const std::string& name) {
  if (name == "free" || name == "thermal") return ConditionType::free;
  if (name == "stick") return ConditionType::stick;
  if (name == "separate") return ConditionType::separate;
  if (name == "prescribed") return ConditionType::prescribed;
  if (name == "periodic") return ConditionType::periodic;
  return ConditionType::slip;
}

std::string cells_text(double count, double cell) {
  return number_text(count * cell) + " m (" + number_text(count) + (count == 1 ? " cell)" : " cells)");
}

/// Says why a side is no whole number of cells, and which sizes would be.
std::string uneven_side(int axis, double length, double cell) {
  const double exact = length / cell, below = std::floor(exact), above = std::ceil(exact);
  char rounded[32];
  std::snprintf(rounded, sizeof rounded, "%.6g", exact);
  return std::string("the domain is ") + number_text(length) + " m along " + axis_names[axis] + ", which is " +
         rounded + " cells of " + number_text(cell) +
         " m; nearest whole: " + (below >= 1 ? cells_text(below, cell) + " or " : "") + cells_text(above, cell);
}

}  // namespace

void ExperimentReader::read_grid(const Node* node) {
  if (!node) return;
  const Fields fields(node, grid_section(), context_);
  experiment_.grid.cell_size = fields.number("cell_size");
  experiment_.grid.symmetry = static_cast<Symmetry>(fields.choice("symmetry"));
  grid_good_ = read_domain(fields);
  OrderedJson& resolved = resolved_["grid"] = fields.resolved;
  resolved["boundaries"] = read_boundaries(fields.node("boundaries"));
}

bool ExperimentReader::read_domain(const Fields& fields) {
  if (!fields.valid("domain")) return false;
  GridSpecification& grid = experiment_.grid;
  grid.lower = fields.points("domain")[0];
  grid.upper = fields.points("domain")[1];
  const Node& place = *fields.node("domain");
  bool good = context_.dimension != 0;
  for (int axis = 0; axis < context_.dimension; ++axis) {
    const double length = grid.upper[axis] - grid.lower[axis];
    if (!(length > 0)) {
      problem(place, std::string("the upper corner is not above the lower one along ") + axis_names[axis] + ": " +
                         number_text(grid.lower[axis]) + " to " + number_text(grid.upper[axis]) + " m");
      good = false;
      continue;
    }
    if (!fields.valid("cell_size")) return false;
    const double exact = length / grid.cell_size, whole = std::round(exact);
    if (!(exact <= most_cells_a_side)) {
      problem(place, std::string("more than ") + std::to_string(most_cells_a_side) + " cells along " +
                         axis_names[axis] + " (" + number_text(length) + " m of " + number_text(grid.cell_size) +
                         " m)");
      good = false;
    } else if (whole < 1 || std::abs(exact - whole) > 1e-6 * std::max(1.0, whole * 1e-3)) {
      problem(place, uneven_side(axis, length, grid.cell_size));
      good = false;
    } else {
      grid.cells[axis] = static_cast<int>(whole);
    }
  }
  return good;
}

OrderedJson ExperimentReader::read_boundaries(const Node* node) {
  const Fields fields(node, boundaries_section(context_.dimension), context_);
  OrderedJson resolved = OrderedJson::object();
  FaceCondition standard;
  OrderedJson standard_resolved = "slip";
  standard.pointer = node ? node->pointer : "/grid";
  if (fields.given("all")) standard_resolved = read_face(*fields.node("all"), standard);
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      FaceCondition& face = experiment_.faces[axis][side];
      if (axis >= std::max(context_.dimension, 2)) {
        face.type = ConditionType::free;
        continue;
      }
      const std::string name = face_name(axis, side);
      face = standard;
      resolved[name] = fields.given(name) ? read_face(*fields.node(name), face) : standard_resolved;
    }
  }
  check_periodic(fields);
  return resolved;
}

OrderedJson ExperimentReader::read_face(const Node& node, FaceCondition& face) {
  static const std::vector<Section> kinds = face_condition_kinds();
  const Section* kind = choose_kind(node, kinds, "boundary condition", true, context_);
  face.pointer = node.pointer;
  if (!kind) return {};
  face.type = condition_type(kind->name);
  const Fields fields(&node, *kind, context_);
  face.velocity.reset();
  OrderedJson resolved = fields.resolved;
  face.thermal = read_thermal_condition(fields, context_, resolved);
  if (face.type != ConditionType::prescribed)
    return face.thermal.exchange == HeatExchange::none ? OrderedJson(kind->name) : resolved;
  if (node.type == Node::Type::string) {
    problem(node, "needs a velocity: {\"type\": \"prescribed\", \"velocity\": [...]}");
  }
  face.velocity = fields.expression("velocity");
  return resolved;
}

void ExperimentReader::check_periodic(const Fields& fields) {
  for (int axis = 0; axis < std::max(context_.dimension, 2); ++axis) {
    const auto& faces = experiment_.faces[axis];
    const bool lower = faces[0].type == ConditionType::periodic, upper = faces[1].type == ConditionType::periodic;
    if (lower == upper) continue;
    const std::string one = face_name(axis, lower ? 0 : 1), other = face_name(axis, lower ? 1 : 0);
    const Node& place = fields.given(one) ? *fields.node(one) : fields.place("all");
    problem(place, in_quotes(one) + " is periodic but " + in_quotes(other) +
                       " is not; periodic joins the two faces of an axis, so set both");
  }
}

void ExperimentReader::read_node_conditions(const Node* node) {
  if (!node || !is_list(*node, "node conditions", true)) return;
  OrderedJson& resolved = resolved_["node_conditions"] = OrderedJson::array();
  for (const Node& item : node->items) resolved.push_back(read_node_condition(item));
}

OrderedJson ExperimentReader::read_node_condition(const Node& node) {
  static const std::vector<Section> kinds = node_condition_kinds();
  const Section* kind = choose_kind(node, kinds, "node condition", false, context_);
  if (!kind) return {};
  const Fields fields(&node, *kind, context_);
  BoxCondition box;
  box.type = condition_type(kind->name);
  box.lower = fields.vector("lower");
  box.upper = fields.vector("upper");
  box.pointer = node.pointer;
  box.name = name_of_box(fields);
  const bool corners = fields.valid("lower") && fields.valid("upper");
  const GridSpecification& grid = experiment_.grid;
  for (int axis = 0; corners && axis < context_.dimension; ++axis) {
    const double low = box.lower[axis], high = box.upper[axis];
    const double slack = 1e-9 * (grid.upper[axis] - grid.lower[axis]);
    if (low > high) {
      problem(fields.place("upper"), std::string("the upper corner lies below the lower one along ") +
                                         axis_names[axis] + ": " + number_text(low) + " to " + number_text(high) +
                                         " m");
    } else if (grid_good_ && (high < grid.lower[axis] - slack || low > grid.upper[axis] + slack)) {
      problem(fields.place("lower"),
              std::string("the box holds no node: it lies outside the domain along ") + axis_names[axis]);
    }
  }
  if (box.type == ConditionType::slip || box.type == ConditionType::separate) {
    box.axis = fields.choice("axis");
    if (fields.valid("axis") && context_.dimension && box.axis >= context_.dimension) {
      problem(fields.place("axis"), "there is no z axis in a 2-D experiment");
    }
  }
  if (box.type == ConditionType::separate) box.side = fields.text("side") == "-" ? -1 : 1;
  if (box.type == ConditionType::prescribed) {
    box.held = fields.held("velocity");
    box.velocity = fields.expression("velocity");
    refuse_nothing_held(fields, box.held, "take the type \"thermal\" for a box that holds a temperature alone");
  }
  OrderedJson resolved = fields.resolved;
  box.thermal = read_thermal_condition(fields, context_, resolved);
  if (kind->name == "thermal" && box.thermal.exchange == HeatExchange::none)
    problem(node, "does nothing: give \"temperature\" or \"heating\"");
  experiment_.boxes.push_back(std::move(box));
  return resolved;
}

}  // namespace mpm
