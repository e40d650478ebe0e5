#include "experiment/sections.hpp"

#include "experiment/artificial_viscosity.hpp"
#include "experiment/particle_output.hpp"
#include "experiment/records.hpp"
#include "experiment/thermal.hpp"
#include "support/film_formats.hpp"

namespace mpm {
namespace {

using Type = ParameterType;

Section kind(std::string name, std::string doc, std::vector<ParameterSpec> parameters, int only_dimension = 0) {
  return {std::move(name), std::move(doc), std::move(parameters), true, only_dimension};
}

ParameterSpec nested(std::string name, std::string doc, std::string definition) {
  return parameter(std::move(name), Type::nested, "", std::move(doc)).defined_as(std::move(definition));
}

/// Keys of the host's that say when any filter acts, and what acts on it.
std::vector<ParameterSpec> filter_schedule() {
  return {
      parameter("every_steps", Type::integer, "", "Steps from one filtered step to the next.").from(1).to(1e9),
      parameter("every_time", Type::number, "s", "Time from one filtered step to the next.").above(0),
      parameter("every_courant", Type::number, "", "Cells that the fastest wave crosses between filtered steps.")
          .above(0),
      parameter(
          "constraints", Type::choice, "",
          "When conditions and contact act: on every increment, with one-sided impulses taken back where a later one "
          "makes them needless, or kept; or once at the end.")
          .of({"every_increment", "kept_impulses", "at_end"})
          .standard("every_increment"),
      parameter("position_update", Type::choice, "",
                "What moves particles in a filtered step: the filtered velocity that they take, or the mean of the one "
                "that they had and that one.")
          .of({"new_velocity", "mean_velocity"})
          .standard("new_velocity"),
      parameter("tolerance", Type::number, "",
                "The loop ends when the increment's mass norm has fallen to this share of the first; 0: never.")
          .from(0)
          .to(1)
          .standard(0),
  };
}

std::vector<ParameterSpec> joined(std::vector<ParameterSpec> first, const std::vector<ParameterSpec>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

ParameterSpec axis(std::string doc) {
  return parameter("axis", Type::choice, "", std::move(doc)).of({"x", "y", "z"});
}

}  // namespace

Section experiment_section(const ReadOptions& options) {
  return {"experiment",
          "an experiment",
          {
              parameter("$schema", Type::string, "", "Where an editor finds the schema of this file."),
              parameter("title", Type::string, "", "One line that heads report and figures.").standard(""),
              parameter("description", Type::string, "", "What the experiment shows.").standard(""),
              parameter("dimension", Type::integer, "", "2 (plane strain per metre of depth, or axisymmetric) or 3.")
                  .from(2)
                  .to(3)
                  .needed(),
              parameter("precision", Type::choice, "", "Arithmetic of particles and grid.")
                  .of({"double", "float"})
                  .standard("double"),
              parameter("backend", Type::choice, "",
                        "What computes: the plain reference, the fast cpu backend, or cuda, a GPU.")
                  .of(options.backends)
                  .standard("cpu"),
              nested("device", "how a device works", "device"),
              parameter("seed", Type::integer, "", "Seed of the random jitter of particles.")
                  .from(0)
                  .to(4294967295.0)
                  .standard(1),
              nested("constants", "an object of named numbers for expressions", "constants"),
              nested("grid", "a grid", "grid").needed(),
              nested("node_conditions", "a list of conditions on the nodes in a box", "node_conditions"),
              nested("shape", "a shape function", "shape").needed(),
              nested("transfer", "a transfer scheme", "transfer").needed(),
              nested("filter", "a filter of the grid velocity", "filter"),
              nested("contact", "a contact law between velocity fields", "contact"),
              nested("materials", "an object of materials by name", "materials").needed(),
              nested("bodies", "a list of bodies", "bodies").needed(),
              nested("grips", "a list of grips", "grips"),
              nested("rigid_bodies", "a list of rigid bodies", "rigid_bodies"),
              nested("emitters", "a list of emitters", "emitters"),
              nested("sinks", "a list of sinks", "sinks"),
              parameter("gravity", Type::expression_vector, "m/s^2", "Acceleration of every particle, of time t.")
                  .over("t")
                  .standard(0),
              parameter("body_force", Type::expression_vector, "N/kg",
                        "Force per mass at x y z (X Y Z: where the particle began) and time t.")
                  .over("xyzXYZt"),
              nested("loads", "a list of loads on bodies", "loads"),
              nested("damping", "damping of the motion", "damping"),
              nested("solver", "a solver", "solver").needed(),
              nested("output", "output settings", "output"),
              parameter("figures", Type::names, "", "Figures to draw after the run.")
                  .of(options.figures)
                  .made_of(column_figure_section())
                  .standard(OrderedJson::array()),
              nested("compare", "what to compare the results with", "compare"),
              nested("limits", "what a finished run must respect", "limits"),
          }};
}

Section grip_section() {
  return {"grip",
          "a grip",
          {
              parameter("name", Type::string, "", "Name of its reaction; default grip_ and its place."),
              parameter("body", Type::string, "", "Name out of bodies.").needed(),
              nested("where", "a geometry", "geometry").needed(),
              parameter("velocity", Type::expression_vector, "m/s",
                        "Velocity of the particles that lie there at the start, of x y z, X Y Z and t; null leaves a "
                        "component free.")
                  .over("xyzXYZt")
                  .leave_free()
                  .needed(),
          }};
}

Section rigid_body_section(int dimension) {
  const Type turning = dimension == 2 ? Type::expression : Type::expression_vector;
  return {"rigid body",
          "a rigid body",
          {
              parameter("name", Type::string, "", "Name of its force and torque; default rigid_body_ and its place."),
              nested("geometry", "a geometry", "geometry").needed(),
              parameter("velocity", Type::expression_vector, "m/s", "Velocity of its point of reference, of time t.")
                  .over("t")
                  .standard(0),
              parameter("angular_velocity", turning, "rad/s",
                        "Angular velocity, of time t: a number in 2-D, from x to y, a vector in 3-D.")
                  .over("t")
                  .standard(0),
              parameter("about", Type::vector, "m",
                        "Point of reference at the start, for its rotation and torque; default: the middle of the "
                        "geometry's bounds."),
              nested("contact", "a contact law", "rigid_contact").needed(),
          }};
}

Section emitter_section() {
  return {"emitter",
          "an emitter",
          {
              parameter("name", Type::string, "", "Name in messages; default emitter_ and its place."),
              parameter("body", Type::string, "", "Name of the body that it gives particles.").needed(),
              nested("geometry", "a geometry", "geometry").needed(),
              parameter("velocity", Type::vector, "m/s",
                        "Velocity of the particles; the region is filled again as the flow has moved on by its length.")
                  .needed(),
              parameter("from", Type::number, "s", "Time when it is first filled.").from(0).standard(0),
              parameter("until", Type::number, "s", "Time when it ends; default: with the run.").above(0),
              parameter("max_particles", Type::integer, "",
                        "The run stops rather than let the body have more particles than this.")
                  .from(1)
                  .to(2e9)
                  .standard(10000000),
          }};
}

Section sink_section() {
  return {"sink",
          "a sink",
          {
              parameter("name", Type::string, "", "Name in messages; default sink_ and its place."),
              parameter("body", Type::string, "", "Name of the body whose particles it takes; default: any body's."),
              nested("geometry", "a geometry: particles whose centre lies in it are taken out", "geometry").needed(),
              parameter("from", Type::number, "s", "Time when it begins.").from(0).standard(0),
              parameter("until", Type::number, "s", "Time when it ends; default: with the run.").above(0),
              parameter("every_steps", Type::integer, "", "Steps from one look at the particles to the next.")
                  .from(1)
                  .to(1e9)
                  .standard(10),
          }};
}

namespace {
/// When the particles of a body go over to another one.
Section becomes_section() {
  return {"becomes",
          "particles that go over to another body",
          {
              parameter("body", Type::string, "", "Name of the body that they go over to.").needed(),
              parameter("when", Type::nested, "", "What particles go over.")
                  .made_of({"when",
                            "a condition on a particle",
                            {
                                parameter("quantity", Type::string, "",
                                          "Quantity of particles, of those that colour frames.")
                                    .needed(),
                                parameter("above", Type::number, "", "It goes over above this value, in SI units."),
                                parameter("below", Type::number, "", "It goes over below this value, in SI units."),
                            }})
                  .needed(),
              parameter("every_steps", Type::integer, "", "Steps from one look at the particles to the next.")
                  .from(1)
                  .to(1e9)
                  .standard(10),
          }};
}
}  // namespace

Section damping_section() {
  return {"damping",
          "damping of the motion",
          {
              parameter("viscous", Type::number, "1/s", "c of a force -c m v on every node.").from(0).standard(0),
              parameter("local", Type::number, "",
                        "Share of the unbalanced force on a node that acts against its motion, component by component.")
                  .from(0)
                  .below(1)
                  .standard(0),
          }};
}

Section grid_section() {
  return {"grid",
          "a grid",
          {
              parameter("cell_size", Type::number, "m", "Edge of the cubic cells.").above(0).needed(),
              parameter("domain", Type::points, "m", "Lower and upper corner; a whole number of cells a side.")
                  .items(2, 2)
                  .needed(),
              parameter("symmetry", Type::choice, "",
                        "Of 2-D: plane_strain (per metre of depth), or axisymmetric (x is the radius, y the axis).")
                  .of({"plane_strain", "axisymmetric"})
                  .standard("plane_strain"),
              nested("boundaries", "conditions on the faces of the domain", "boundaries"),
          }};
}

Section boundaries_section(int dimension) {
  Section section{"boundaries", "conditions on the faces of the domain", {}};
  section.parameters.push_back(nested("all", "Condition of every face not named.", "face_condition"));
  for (const char* name : {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"}) {
    if (name[0] == 'z' && dimension == 2) continue;
    section.parameters.push_back(nested(name, "Condition of this face.", "face_condition"));
  }
  return section;
}

std::vector<Section> face_condition_kinds() {
  const std::vector<ParameterSpec> heat = wall_heat_parameters();
  return {
      kind("slip", "No motion through the wall, free motion along it.", heat),
      kind("stick", "No motion at the wall.", heat),
      kind("separate", "As slip, but material may leave the wall.", heat),
      kind("free", "No condition.", {}),
      kind("periodic", "Joined to the opposite face.", {}),
      kind("prescribed", "The wall moves at a given velocity.",
           joined({parameter("velocity", Type::expression_vector, "m/s", "Velocity of the wall, of x y z and t.")
                       .over("xyzt")
                       .needed()},
                  heat)),
  };
}

std::vector<Section> node_condition_kinds() {
  const ParameterSpec lower = parameter("lower", Type::vector, "m", "Lower corner of the box of nodes.").needed();
  const ParameterSpec upper = parameter("upper", Type::vector, "m", "Upper corner of the box of nodes.").needed();
  const auto box = [&](std::string name, std::string doc, const std::vector<ParameterSpec>& own) {
    std::vector<ParameterSpec> keys = joined({lower, upper}, own);
    if (name != "thermal")
      keys.push_back(parameter("name", Type::string, "", "Name of the box's reaction; default box_ and its place."));
    return kind(std::move(name), std::move(doc), joined(std::move(keys), box_heat_parameters()));
  };
  return {
      box("stick", "The nodes are held.", {}),
      box("slip", "The nodes are held along one axis.", {axis("Axis that is held.").needed()}),
      box("separate", "The nodes are held along one axis, one way only.",
          {axis("Axis that is held.").needed(),
           parameter("side", Type::choice, "", "Way along the axis that stays open.").of({"+", "-"}).standard("+")}),
      box("prescribed", "The nodes move at a given velocity; null leaves a component free.",
          {parameter("velocity", Type::expression_vector, "m/s", "Velocity, of x y z and t.")
               .over("xyzt")
               .leave_free()
               .needed()}),
      box("thermal", "The nodes move freely, and are held at a temperature or heated.", {}),
  };
}

std::vector<Section> geometry_kinds() {
  const ParameterSpec centre = parameter("centre", Type::vector, "m", "Centre.").needed();
  const ParameterSpec parts = nested("of", "a list of geometries", "geometries").needed();
  const ParameterSpec part = nested("of", "a geometry", "geometry").needed();
  const ParameterSpec file =
      parameter("file", Type::string, "", "Path, from the folder of the experiment file.").needed();
  return {
      kind("ball", "A disc in 2-D, a ball in 3-D.",
           {centre, parameter("radius", Type::number, "m", "Radius.").above(0).needed()}),
      kind("box", "A box along the axes.",
           {parameter("lower", Type::vector, "m", "Lower corner.").needed(),
            parameter("upper", Type::vector, "m", "Upper corner.").needed()}),
      kind("ring", "An annulus in 2-D; in 3-D a tube, a cylinder when inner_radius is 0.",
           {centre, parameter("inner_radius", Type::number, "m", "Inner radius.").from(0).needed(),
            parameter("outer_radius", Type::number, "m", "Outer radius.").above(0).needed(),
            axis("Axis of the tube, in 3-D."),
            parameter("length", Type::number, "m", "Length of the tube, in 3-D.").above(0)}),
      kind("polygon", "A simple polygon, closed by itself.",
           {parameter("points", Type::points, "m", "Corners in order.").items(3, 10000).with_components(2).needed()},
           2),
      kind("half_space", "All on one side of a plane, cut off by the domain.",
           {parameter("point", Type::vector, "m", "A point of the plane.").needed(),
            parameter("normal", Type::vector, "", "Points out of the material; any length but zero.").needed()}),
      kind("union", "What lies in any part.", {parts}),
      kind("difference", "The first part without the others.", {parts}),
      kind("intersection", "What lies in every part.", {parts}),
      kind("turned", "A geometry turned about a point.",
           {part, parameter("angle", Type::number, "rad", "Angle, counted from x to y in 2-D.").needed(),
            parameter("about", Type::vector, "m", "Point that stays; default: the middle of the geometry's bounds."),
            parameter("axis", Type::vector, "", "Axis of the rotation, in 3-D; default: z.").with_components(3)}),
      kind("shifted", "A geometry moved.",
           {part, parameter("by", Type::vector, "m", "Way that it is moved.").needed()}),
      kind("stl", "What a closed surface of triangles encloses.",
           {file, parameter("scale", Type::number, "", "Factor of the file's lengths, so that they are in m.")
                      .above(0)
                      .standard(1)},
           3),
      kind("mask", "The dark, or the bright, parts of a picture.",
           {file, parameter("lower", Type::vector, "m", "Lower left corner of the picture.").needed(),
            parameter("upper", Type::vector, "m", "Upper right corner of the picture.").needed(),
            parameter("threshold", Type::number, "", "Darkness, times opacity, from which on there is material.")
                .above(0)
                .below(1)
                .standard(0.5),
            parameter("inside", Type::choice, "", "Which parts are material.").of({"dark", "bright"}).standard("dark")},
           2),
  };
}

std::vector<Section> seeding_kinds() {
  return {
      kind("lattice", "On the lattice of the cells.", {}),
      kind("fitted", "On a lattice of the body's own, which turns and moves with it.", {}),
      kind("partial", "On the lattice of the cells, each with the volume of its square or cube that is inside.",
           {parameter("smallest_share", Type::number, "",
                      "Lighter particles are merged with a neighbour, as a share of a whole one.")
                .from(0)
                .to(0.5)
                .standard(0.05)}),
      kind("random", "Thrown at random.", {}),
      kind("blue_noise", "Without order, but evenly.",
           {parameter("relaxations", Type::integer, "",
                      "Times that each particle moves to the middle of what is nearest to it.")
                .from(0)
                .to(1000)
                .standard(20)}),
      kind("points", "Where a CSV file says: columns x, y, in 3-D z, and volume or mass.",
           {parameter("file", Type::string, "", "Path, from the folder of the experiment file.").needed()}),
  };
}

Section tensor_section(std::string doc, const std::string& unit, bool symmetric, double diagonal) {
  Section section{"tensor", std::move(doc), {}};
  for (const char a : {'x', 'y', 'z'})
    for (const char b : {'x', 'y', 'z'})
      if (!symmetric || a <= b)
        section.parameters.push_back(parameter({a, b}, Type::expression, unit, "Component, of X Y Z.")
                                         .over("XYZ")
                                         .standard(a == b ? diagonal : 0.0));
  return section;
}

Section body_section() {
  return {"body",
          "a body",
          {
              parameter("name", Type::string, "", "Unique name.").needed(),
              parameter("material", Type::string, "", "Name out of materials.").needed(),
              nested("geometry",
                     "a geometry; not with points of a file, and not where emitters or other bodies give it all its "
                     "particles",
                     "geometry"),
              nested("seeding", "how particles are placed", "seeding").standard("fitted"),
              parameter("particles_per_cell_axis", Type::integer, "", "Particles along each edge of a cell.")
                  .from(1)
                  .to(8)
                  .standard(2),
              parameter("velocity", Type::expression_vector, "m/s",
                        "Initial velocity, of x y z (X Y Z: before the initial displacement).")
                  .over("xyzXYZ")
                  .standard(0),
              parameter("initial_displacement", Type::expression_vector, "m",
                        "Initial displacement, of the undeformed place X Y Z.")
                  .over("XYZ"),
              nested("initial_deformation_gradient", "an initial deformation gradient", "deformation_gradient")
                  .made_of(tensor_section("Initial deformation gradient F; default: that of the displacement.", "",
                                          false, 1)),
              nested("initial_stress", "an initial stress", "stress")
                  .made_of(tensor_section("Initial Cauchy stress.", "Pa", true, 0)),
              body_temperature(),
              parameter("jitter", Type::number, "", "Random shift of each particle, in particle spacings.")
                  .from(0)
                  .to(0.5)
                  .standard(0),
              parameter("frozen", Type::boolean, "",
                        "Particles keep their places, and so their weights; velocities and stresses evolve.")
                  .standard(false),
              parameter("field", Type::string, "",
                        "Velocity field, with contact: bodies that name the same one do not slip on each other. "
                        "Default: the body's name."),
              nested("becomes", "when particles go over to another body", "becomes").made_of(becomes_section()),
          }};
}

std::vector<Section> load_kinds() {
  const ParameterSpec body = parameter("body", Type::string, "", "Name of the body that is loaded.").needed();
  const ParameterSpec where =
      nested("where", "a geometry: the part of the body's surface in it is loaded", "geometry").needed();
  const auto given = [](std::string name, Type type, std::string unit, std::string doc) {
    return parameter(std::move(name), type, std::move(unit), std::move(doc)).over("xyzXYZt").needed();
  };
  const auto load = [&](std::string name, std::string doc, const std::vector<ParameterSpec>& own, int dimension = 0) {
    return kind(std::move(name), std::move(doc), joined({body}, own), dimension);
  };
  return {
      load("traction", "A force per area of the surface as it was at the start.",
           {where, given("traction", Type::expression_vector, "Pa", "Force per area.")}),
      load("pressure", "A pressure on the surface.",
           {where, given("pressure", Type::expression, "Pa", "Pressure; positive presses."),
            parameter("follower", Type::boolean, "",
                      "Whether it acts on the current area along the current normal, or on those of the start.")
                .standard(true)}),
      load("force", "A force at a point; in plane strain per metre of depth, around an axis that of the whole ring.",
           {parameter("at", Type::vector, "m", "The point, where the body is at the start.").needed(),
            given("force", Type::expression_vector, "N", "Force.")}),
      load("line_force", "A force per length of a straight line, 3-D only.",
           {parameter("from", Type::vector, "m", "One end, where the body is at the start.").needed(),
            parameter("to", Type::vector, "m", "The other end.").needed(),
            given("force", Type::expression_vector, "N/m", "Force per length as it was at the start.")},
           3),
      load("body_force", "A force per mass on all of a body.",
           {given("acceleration", Type::expression_vector, "N/kg", "Force per mass.")}),
      load("spring", "Springs and dashpots from a surface to the ground.",
           {where,
            parameter("stiffness", Type::vector, "N/m^3", "Force per area and displacement along each axis.")
                .standard(0),
            parameter("damping", Type::vector, "N s/m^3", "Force per area and velocity along each axis.").standard(0)}),
  };
}

std::vector<Section> solver_kinds(const ReadOptions& options) {
  std::vector<Section> kinds;
  for (const SolverDescription& solver : options.solvers)
    kinds.push_back(kind(solver.name, solver.doc, solver.parameters));
  return kinds;
}

ParameterSpec end_time_parameter() {
  return parameter("end_time", Type::number, "s", "Time simulated.").above(0).needed();
}

ParameterSpec max_steps_parameter() {
  return parameter("max_steps", Type::integer, "", "Stops with an error when reached before end_time.")
      .from(1)
      .to(1e15)
      .standard(1000000000);
}

Section output_section(const ReadOptions& options) {
  ParameterSpec colour = parameter("colour_by", options.colour_quantities.empty() ? Type::string : Type::choice, "",
                                   "Quantity that colours the particles.")
                             .of(options.colour_quantities)
                             .standard("speed");
  Section section{
      "output",
      "output settings",
      {
          parameter("metrics_every", Type::integer, "", "Steps between rows of metrics.csv.")
              .from(1)
              .to(1e9)
              .standard(10),
          parameter("frames", Type::integer, "", "Pictures over the run, first and last included.")
              .from(0)
              .to(100000)
              .standard(0),
          colour,
          parameter("vtk", Type::boolean, "", "Write a VTK file beside each frame.").standard(false),
          particle_output_parameter(),
          parameter("film", Type::choice, "", "Join the frames to a film of this format; true: mp4.")
              .of(support::film_formats())
              .or_boolean()
              .standard(false),
          parameter("reactions", Type::names, "",
                    "Walls, boxes of nodes, grips and rigid bodies whose force on the material is recorded; true: all "
                    "that hold any.")
              .or_boolean()
              .standard(false),
          parameter("ledger", Type::boolean, "", "Keep the energy ledger.").standard(true),
          parameter("ledger_every", Type::integer, "",
                    "Steps between entries of the ledger, each counted that many times; 1: exact at every step.")
              .from(1)
              .to(1e9)
              .standard(1),
          parameter("checkpoint_every", Type::number, "s", "Wall-clock time between checkpoints; 0: none by the clock.")
              .from(0)
              .standard(60),
          parameter("checkpoint_steps", Type::integer, "", "Steps between checkpoints; 0: none by steps.")
              .from(0)
              .to(1e15)
              .standard(0),
      }};
  for (ParameterSpec& spec : record_parameters()) section.parameters.push_back(std::move(spec));
  return section;
}

Section compare_section() {
  return {"compare",
          "what to compare the results with",
          {nested("exact", "an exact solution", "exact"), nested("expect", "a list of expectations", "expectations")}};
}

Section limits_section() {
  return {
      "limits",
      "what a finished run must respect",
      {
          parameter("isolated", Type::boolean, "",
                    "Whether nothing works on the scene from outside; default: as the file says, by body force, moving "
                    "walls and prescribed nodes."),
          parameter("energy_gain", Type::number, "",
                    "Largest gain of an isolated scene at any recorded time, of the energy that it began with.")
              .from(0)
              .or_null()
              .standard(0.01),
          parameter("numerical_loss", Type::number, "",
                    "Largest share of its energy that an isolated scene may lose in transfers, filters, walls and "
                    "contact without a physical cause.")
              .from(0)
              .or_null(),
          parameter("unexplained_loss", Type::number, "",
                    "Largest share of its energy that an isolated scene may lose without a row of the ledger that "
                    "explains it.")
              .from(0)
              .or_null(),
          parameter("volume_ratio", Type::vector, "",
                    "Smallest and largest volume ratio of any particle at any recorded time.")
              .with_components(2)
              .or_null()
              .standard({0.1, 10.0}),
      }};
}

Section expectation_section() {
  return {"expectation",
          "an expectation",
          {
              parameter("metric", Type::string, "", "Dotted path into summary.json.").needed(),
              parameter("at_least", Type::number, "any", "Lower bound."),
              parameter("at_most", Type::number, "any", "Upper bound."),
              parameter("equals", Type::number, "any", "Value, within the tolerance."),
              parameter("tolerance", Type::number, "any", "Allowed distance from `equals`, absolute.").from(0),
          }};
}

Limits limits_of(const Fields& fields, ReadContext& context) {
  Limits limits;
  if (fields.given("isolated")) limits.isolated = fields.boolean("isolated");
  if (!fields.is_null("energy_gain")) limits.energy_gain = fields.number("energy_gain");
  if (fields.given("energy_gain") && limits.energy_gain && fields.given("isolated") && !*limits.isolated)
    context.problem(*fields.node("energy_gain"), "a gain is judged in isolated scenes only, and \"isolated\" is false");
  for (const auto& [key, limit] :
       {std::pair{"numerical_loss", &limits.numerical_loss}, std::pair{"unexplained_loss", &limits.unexplained_loss}}) {
    if (!fields.given(key) || fields.is_null(key)) continue;
    *limit = fields.number(key);
    if (fields.given("isolated") && !*limits.isolated)
      context.problem(*fields.node(key), "a loss is judged in isolated scenes only, and \"isolated\" is false");
  }
  if (fields.is_null("volume_ratio")) return limits;
  const Vector3& range = fields.vector("volume_ratio");
  if (fields.valid("volume_ratio") && !(range[0] < range[1]))
    context.problem(*fields.node("volume_ratio"), "expected the smaller ratio first");
  limits.volume_ratio = {range[0], range[1]};
  return limits;
}

std::vector<Section> exact_kinds(const ReadOptions& options) {
  std::vector<Section> kinds;
  for (const ExactDescription& exact : options.exact) kinds.push_back(kind(exact.name, exact.doc, exact.parameters));
  return kinds;
}

namespace {
/// A plugin with its own keys.
Section plugin_section(const Plugin& plugin) {
  Section section = kind(std::string(plugin.id()), plugin.descriptor->summary ? plugin.descriptor->summary : "", {});
  for (const mpm_parameter& declared : plugin.parameters()) section.parameters.push_back(from_plugin(declared));
  return section;
}
}  // namespace

std::vector<Section> rigid_contact_kinds(const ComponentLookup& components) {
  std::vector<Section> kinds;
  for (const Plugin* plugin : components.of_kind(MPM_CONTACT)) kinds.push_back(plugin_section(*plugin));
  return kinds;
}

std::vector<Section> component_kinds(const ComponentLookup& components, mpm_kind wanted) {
  std::vector<Section> kinds;
  for (const Plugin* plugin : components.of_kind(wanted)) {
    Section section = plugin_section(*plugin);
    if (wanted == MPM_CONTACT) {
      section.parameters.push_back(
          nested("normal", "how the contact normal is found", "normal").standard(standard_normal));
      section.parameters.push_back(
          nested("detection", "when two velocity fields count as touching", "detection").standard(standard_detection));
      section.parameters.push_back(
          parameter(
              "strain_cap", Type::number, "",
              "Largest strain of a cell by one correction of a pair: time step times change of velocity over cell.")
              .above(0));
    }
    if (wanted == MPM_MATERIAL) {
      section.parameters.push_back(thermal_parameter(*plugin));
      section.parameters.push_back(artificial_viscosity_parameter());
    }
    if (wanted == MPM_FILTER) {
      for (const ParameterSpec& spec : filter_schedule()) section.parameters.push_back(spec);
    }
    kinds.push_back(std::move(section));
  }
  return kinds;
}

}  // namespace mpm
