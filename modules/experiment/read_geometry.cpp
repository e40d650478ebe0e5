// Geometry as the file writes it.
#include <cmath>

#include "experiment/axis_names.hpp"
#include "experiment/read_files.hpp"
#include "experiment/reader.hpp"

namespace mpm {
namespace {

GeometryPointer read_box(const Fields& fields, ReadContext& context) {
  const Vector3 &lower = fields.vector("lower"), &upper = fields.vector("upper");
  if (!fields.valid("lower") || !fields.valid("upper")) return nullptr;
  bool good = true;
  for (int axis = 0; axis < context.dimension; ++axis) {
    if (lower[axis] < upper[axis]) continue;
    good = false;
    context.problem(fields.place("upper"), std::string("the upper corner is not above the lower one along ") +
                                               axis_names[axis] + ": " + number_text(lower[axis]) + " to " +
                                               number_text(upper[axis]) + " m");
  }
  return good ? make_box(context.dimension, lower, upper) : nullptr;
}

GeometryPointer read_ring(const Fields& fields, const Node& node, ReadContext& context) {
  bool good = fields.valid("centre") && fields.valid("inner_radius") && fields.valid("outer_radius");
  const double inner = fields.number("inner_radius"), outer = fields.number("outer_radius");
  if (good && inner >= outer) {
    context.problem(fields.place("outer_radius"), "out of range: expected a length (m) above the inner radius of " +
                                                      number_text(inner) + ", got " + number_text(outer));
    good = false;
  }
  for (const char* key : {"axis", "length"}) {
    if (context.dimension == 2 && fields.given(key)) {
      context.problem(*fields.node(key), in_quotes(key) + " has no meaning in 2-D, where a ring is an annulus");
    } else if (context.dimension == 3 && !fields.given(key)) {
      context.problem(node.at, child_pointer(node.pointer, key),
                      "missing key; a ring in 3-D is a tube with axis and length");
    }
    good &= context.dimension == 2 || (fields.given(key) && fields.valid(key));
  }
  if (!good) return nullptr;
  return make_ring(context.dimension, fields.vector("centre"), inner, outer, fields.choice("axis"),
                   fields.number("length"));
}

GeometryPointer read_polygon(const Fields& fields, ReadContext& context) {
  if (!fields.valid("points")) return nullptr;
  const std::vector<Vector3>& points = fields.points("points");
  const Node& place = *fields.node("points");
  const auto [first, second] = crossing_edges(points);
  if (first >= 0) {
    const auto edge = [&](int i) {
      return std::to_string(i) + "-" + std::to_string((i + 1) % static_cast<int>(points.size()));
    };
    context.problem(place, "the polygon crosses or touches itself: edges " + edge(first) + " and " + edge(second) +
                               " (points count from 0)");
    return nullptr;
  }
  if (polygon_area(points) == 0) {
    context.problem(place, "the polygon has no area");
    return nullptr;
  }
  return make_polygon(points);
}

GeometryPointer read_half_space(const Fields& fields, ReadContext& context) {
  if (!fields.valid("point") || !fields.valid("normal")) return nullptr;
  const Vector3& normal = fields.vector("normal");
  if (normal == Vector3{}) {
    context.problem(fields.place("normal"), "the normal is zero; it has to point out of the material");
    return nullptr;
  }
  return make_half_space(context.dimension, fields.vector("point"), normal);
}

GeometryPointer read_combined(const Fields& fields, const std::string& name, ReadContext& context,
                              OrderedJson& resolved) {
  const Node* list = fields.node("of");
  if (!list) return nullptr;
  if (list->type != Node::Type::array) {
    context.problem(*list, "expected a list of geometries, got " + describe_value(*list));
    return nullptr;
  }
  const std::size_t least = name == "union" ? 1 : 2;
  bool good = list->items.size() >= least;
  if (!good) {
    context.problem(*list, "a" + std::string(name[0] == 'i' ? "n " : " ") + name + " takes at least " +
                               std::to_string(least) + (least == 1 ? " geometry, got " : " geometries, got ") +
                               std::to_string(list->items.size()));
  }
  std::vector<GeometryPointer> parts;
  resolved["of"] = OrderedJson::array();
  for (const Node& item : list->items) {
    OrderedJson part;
    parts.push_back(read_geometry(item, context, part));
    resolved["of"].push_back(std::move(part));
    good &= parts.back() != nullptr;
  }
  if (!good) return nullptr;
  if (name == "union") return make_union(std::move(parts));
  return name == "difference" ? make_difference(std::move(parts)) : make_intersection(std::move(parts));
}

GeometryPointer read_placed(const Fields& fields, const std::string& name, ReadContext& context,
                            OrderedJson& resolved) {
  const Node* of = fields.node("of");
  if (!of) return nullptr;
  GeometryPointer part = read_geometry(*of, context, resolved["of"]);
  if (!part) return nullptr;
  const std::array<Vector3, 3> unturned{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  if (name == "shifted")
    return fields.valid("by") ? make_placed(std::move(part), unturned, {}, fields.vector("by")) : nullptr;
  Vector3 axis{0, 0, 1}, about = middle_of(*part);
  if (fields.given("axis") && context.dimension == 2) {
    context.problem(*fields.node("axis"), "\"axis\" has no meaning in 2-D, where all turns in the plane");
    return nullptr;
  }
  if (fields.given("axis")) axis = fields.vector("axis");
  if (fields.given("axis") && fields.valid("axis") && axis == Vector3{}) {
    context.problem(*fields.node("axis"), "the axis is zero");
    return nullptr;
  }
  if (fields.given("about")) about = fields.vector("about");
  for (const char* key : {"angle", "about", "axis"})
    if (!fields.valid(key) && (fields.given(key) || std::string_view(key) == "angle")) return nullptr;
  resolved["about"] = OrderedJson::array();
  for (int c = 0; c < context.dimension; ++c) resolved["about"].push_back(about[c]);
  return make_placed(std::move(part), rotation_about(axis, fields.number("angle")), about, {});
}

}  // namespace

GeometryPointer read_geometry(const Node& node, ReadContext& context, OrderedJson& resolved) {
  static const std::vector<Section> kinds = geometry_kinds();
  const Section* kind = choose_kind(node, kinds, "geometry", false, context);
  if (!kind) return nullptr;
  const Fields fields(&node, *kind, context);
  resolved = fields.resolved;
  const std::string& name = kind->name;
  if (name == "ball") {
    if (!fields.valid("centre") || !fields.valid("radius")) return nullptr;
    return make_ball(context.dimension, fields.vector("centre"), fields.number("radius"));
  }
  if (name == "box") return read_box(fields, context);
  if (name == "ring") return read_ring(fields, node, context);
  if (name == "polygon") return read_polygon(fields, context);
  if (name == "half_space") return read_half_space(fields, context);
  if (name == "stl") return read_surface(fields, context, resolved);
  if (name == "mask") return read_mask(fields, context, resolved);
  if (name == "turned" || name == "shifted") return read_placed(fields, name, context, resolved);
  return read_combined(fields, name, context, resolved);
}

}  // namespace mpm
