#pragma once
// An experiment as read, checked and resolved: everything the plan needs, nothing of JSON left to interpret.

#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiment/expression.hpp"
#include "experiment/geometry.hpp"
#include "experiment/input_file.hpp"
#include "experiment/loads.hpp"
#include "experiment/particle_changes.hpp"
#include "experiment/vector3.hpp"
#include "plugin/registry.hpp"

namespace mpm {

enum class Precision { single, double_ };
enum class StressUpdate { first, last, modified_last, averaged };  ///< USF, USL, MUSL, USAVG
enum class PassChoice { automatic, separate, fused };  ///< whether a gather may also scatter for the next step

/// A plugin chosen in the file, with its filled parameter block.
struct Component {
  const Plugin* plugin = nullptr;
  std::vector<double> parameters;  ///< the block of doubles handed over the boundary, parameter_bytes / 8 long
  std::string pointer;             ///< JSON pointer of the choice, for messages and the plan

  /// The value of a parameter by name. Throws std::out_of_range when the plugin has none of that name.
  double parameter(std::string_view name) const;
};

/// What the third direction of a 2-D experiment is: out of the plane, or around the axis (x = r >= 0, y the axis).
enum class Symmetry { plane_strain, axisymmetric };

struct GridSpecification {
  double cell_size = 0;  ///< m, cubic cells
  Vector3 lower{}, upper{};
  std::array<int, 3> cells{1, 1, 1};           ///< whole cells a side
  Symmetry symmetry = Symmetry::plane_strain;  ///< symmetry of a 2-D experiment
};

enum class ConditionType { free, stick, slip, separate, prescribed, periodic };

/// How heat comes in at a wall or into a box of nodes.
enum class HeatExchange { none, fixed_temperature, flux, convection, heating };

struct ThermalCondition {
  HeatExchange exchange = HeatExchange::none;
  /// A number at (x, y, z, t): the temperature that is held or lies beyond the wall, K; the flux into the body, W/m^2;
  /// or the power that all nodes of a box share by their mass, W (in plane strain a metre of depth).
  ScalarExpression value;
  double coefficient = 0;  ///< coefficient of convection, W/(m^2 K)
  std::string pointer;
};

/// What holds on a face of the domain. Stick, slip and separate mirror the material beyond the wall (docs/method.md).
struct FaceCondition {
  ConditionType type = ConditionType::slip;
  std::optional<VectorExpression> velocity;  ///< velocity of the wall, m/s, for `prescribed` (function of t, x, y, z)
  std::string pointer;
  ThermalCondition thermal;
};

/// The name of a face of the domain in files: "x_min", "x_max" ...
std::string face_name(int axis, int side);

/// Whether heat comes in through the wall by a flux, so that the area of it that a body covers counts.
inline bool passes_heat(const FaceCondition& face) {
  return face.thermal.exchange == HeatExchange::flux || face.thermal.exchange == HeatExchange::convection;
}

/// What holds on the nodes inside a box.
struct BoxCondition {
  ConditionType type = ConditionType::stick;
  Vector3 lower{}, upper{};  ///< m
  int axis = 0;              ///< held axis of `slip`, and of `separate` with its sign
  int side = 1;              ///< `separate`: +1 lets material leave towards +axis only
  std::array<bool, 3> held{true, true,
                           true};  ///< `prescribed`: components that are given (null in the file leaves one free)
  std::optional<VectorExpression> velocity;
  std::string pointer, name;  ///< the name is that of its reaction
  ThermalCondition thermal;
};

/// What may hold the material: a wall of the domain, a box of nodes, a grip or a rigid body. Its number is its place in
/// Experiment::supports.
struct Support {
  std::string name;
  bool holds = false;  ///< its condition gives velocities; free and periodic faces and thermal boxes give none
};
inline constexpr int number_of_walls = 6;
constexpr int support_of_wall(int axis, int side) {
  return 2 * axis + side;
}
constexpr int support_of_box(int box) {
  return number_of_walls + box;
}

/// Particles of a body that move as they are told: those that lie in a region at the start.
struct Grip {
  std::string name;  ///< that of its reaction
  int body = 0;      ///< index into Experiment::bodies
  std::shared_ptr<const Geometry> region;
  std::array<bool, 3> held{true, true, true};  ///< components that are given (null in the file leaves one free)
  VectorExpression velocity;                   ///< m/s, function of x, y, z, initial X, Y, Z, and t
  std::string pointer;
};

/// A rigid body that moves as it is told and meets material by a law of its own.
struct RigidBodySpecification {
  std::string name;                          ///< that of its reaction
  std::shared_ptr<const Geometry> geometry;  ///< where it lies at the start
  Vector3 about{};                           ///< its point of reference at the start, m
  VectorExpression velocity;                 ///< of its point of reference, m/s, function of t
  VectorExpression angular_velocity;         ///< rad/s, function of t; in 2-D its only component is that about z
  Component contact;
  std::string pointer;

  /// The angular velocity at a time, s, of an experiment of so many dimensions, rad/s.
  Vector3 spin_at(double time, int dimension) const;
  /// Whether it ever moves.
  bool moves() const;
};

/// How one phase of a material conducts and stores heat.
struct ThermalProperties {
  double conductivity = 0;   ///< W/(m K)
  double heat_capacity = 0;  ///< J/(kg K)
};

/// Melting and freezing at one temperature. Particles that are melted by half or more have the melted values.
struct PhaseChange {
  double temperature = 0;  ///< K
  double latent_heat = 0;  ///< J/kg
  ThermalProperties melted;
  std::vector<double> melted_parameters;  ///< the material's whole parameter block, its density that of the solid
  std::string pointer;
};

struct Thermal {
  ThermalProperties solid;
  double dissipation_to_heat = 0;  ///< share of the dissipated energy that warms the particle
  std::optional<PhaseChange> phase_change;
  std::string pointer;
};

/// A pressure against fast compression, q = density h r (linear c + quadratic h r) (kernel/artificial_viscosity.hpp).
struct ArtificialViscositySpecification {
  double linear = 0, quadratic = 0;
  std::string pointer;
};

struct MaterialSpecification {
  std::string name;
  Component component;
  std::optional<Thermal> thermal;
  std::optional<ArtificialViscositySpecification> artificial_viscosity;
};

/// How the particles of a body are placed: on the lattice of the cells, on one of the body's own, on that of the cells with
/// the volume that lies inside, without order, evenly without order, where a file says.
enum class SeedingKind { lattice, fitted, partial, random, blue_noise, points };

/// A particle as a file of points gives it.
struct SeededPoint {
  Vector3 place{};
  double volume = 0;  ///< m^3, in plane strain m^2, in axisymmetric scenes of the whole ring; 0: nominal
};

struct SeedingSpecification {
  SeedingKind kind = SeedingKind::fitted;
  double smallest_share = 0.05;  ///< of `partial`: lighter particles are merged, as a share of a whole one
  int relaxations = 20;          ///< of `blue_noise`: times that each particle moves to the middle of its cell
  std::shared_ptr<const std::vector<SeededPoint>> points;  ///< of `points`
  bool points_have_volumes = false;
};

struct BodySpecification {
  std::string name;
  int material = 0;  ///< index into Experiment::materials
  int field = 0;     ///< velocity field this body scatters to (0 without contact; else one a body, or as `field` says)
  std::shared_ptr<const Geometry> geometry;
  int particles_per_cell_axis = 2;
  double jitter = 0;          ///< largest random shift of a particle, in particle spacings
  bool frozen = false;        ///< particles keep their places and domains; velocity and material state evolve
  VectorExpression velocity;  ///< initial velocity, m/s, function of x, y, z
  std::optional<ScalarExpression> temperature;  ///< initial temperature, K, function of x, y, z
  SeedingSpecification seeding;
  std::optional<VectorExpression> displacement;  ///< initial, m, function of X, Y, Z
  std::optional<std::array<ScalarExpression, 9>>
      deformation_gradient;                               ///< initial, row-major 3 x 3, function of X, Y, Z
  std::optional<std::array<ScalarExpression, 6>> stress;  ///< initial, Cauchy, Pa: xx yy zz yz xz xy
  bool starts_empty = false;        ///< it has no geometry: emitters or other bodies give it all its particles
  bool takes_particles_in = false;  ///< they come from emitters or other bodies, and have sizes of their own
  std::optional<Becoming> becomes;  ///< when its particles go over to another body
  std::string pointer;

  bool deformed() const { return displacement || deformation_gradient || stress; }
  /// Whether particles differ in volume, axisymmetric rings aside.
  bool varies_in_size() const {
    const SeedingKind kind = seeding.kind;
    return takes_particles_in || kind == SeedingKind::partial || kind == SeedingKind::random ||
           kind == SeedingKind::blue_noise || (kind == SeedingKind::points && seeding.points_have_volumes);
  }
  /// Whether a particle's domain begins as something else than the box of the cells' lattice.
  bool seeds_domains() const { return seeding.kind != SeedingKind::lattice || deformed(); }
};

struct SolverSpecification {
  std::string type = "explicit";
  StressUpdate stress_update = StressUpdate::last;
  std::optional<double> time_step;  ///< s; nothing: automatic
  double courant = 0.3;             ///< fraction of h / (wave speed + particle speed) when automatic
  double end_time = 0;              ///< s
  PassChoice passes = PassChoice::automatic;
  bool averages_dilation = false;  ///< nodes average what strains particles, against locking
  long max_steps = 1000000000;     ///< stops with an error message when reached before end_time
};

/// When a filter acts and what acts on it. One of the three intervals is given; the others are zero.
struct FilterSchedule {
  int every_steps = 1;
  double every_time = 0;         ///< s
  double every_courant = 0;      ///< cells that the fastest wave crosses
  bool constrain_always = true;  ///< conditions and contact act on every increment, else at the end only
  bool takes_back = true;        ///< with every increment one-sided laws answer anew, else what they gave stays
  bool moves_by_mean = false;    ///< particles move with the mean of their velocities, else with the gathered one
  double tolerance = 0;          ///< the loop ends when |increment| <= tolerance |first|, mass norms; 0: never
};

/// Particle data in files, at times of their own.
struct ParticleOutput {
  bool vtk = true, csv = false;
  std::vector<std::string> fields;  ///< names out of particle_fields()
  std::vector<double> times;        ///< s, rising; each belongs to the first step at or after it
  bool domains = false;             ///< particles are cells, their deformed domains; else points
  bool grid = false;                ///< an image file of the nodes beside each
  bool compress = true;             ///< by zlib
  bool in_double = false;           ///< numbers of VTK files have 64 bits, else 32
  bool asks(std::string_view field) const;
};

/// What takes energy out of the nodes' motion, each in its way.
struct Damping {
  double viscous = 0;  ///< c, 1/s: a force -c m v
  double local = 0;    ///< share of the unbalanced force that acts against the motion (Cundall 1987)
  std::string pointer;

  bool acts() const { return viscous > 0 || local > 0; }
  /// What a step of dt, s, leaves of a velocity, exp(-c dt), and of its change by constant forces, (1 - exp(-c dt)) / (c dt).
  double left_of_velocity(double dt) const;
  double left_of_change(double dt) const;
};

/// Particles whose numbers are summed apart: those that begin in a region.
struct GroupSpecification {
  std::string name;
  int body = -1;                          ///< index of the body that they belong to; -1: any
  std::shared_ptr<const Geometry> where;  ///< null: the whole body
  std::string pointer;
};

/// Where a probe takes its values.
enum class ProbeKind { nearest, place, line, section };

/// Values of particles at one place, each with a column of its own.
struct ProbeSpecification {
  std::string name;
  ProbeKind kind = ProbeKind::nearest;
  std::vector<std::string> quantities;  ///< names that particle quantities have
  int body = -1;                        ///< index of the body that is looked at; -1: all
  Vector3 point{};                      ///< m; where a line begins, a point of a section
  Vector3 end{};                        ///< m, where a line ends
  Vector3 normal{};                     ///< of a section, of length one
  int count = 0;                        ///< points of a line, its ends included
  int profiles = 0;  ///< how many profiles of a line are written over the run, first and last included
  std::string pointer;
};

/// A figure of columns of metrics.csv over time.
struct ColumnFigure {
  std::string name;  ///< stem of its files
  std::string title;
  std::vector<std::string> columns;  ///< headings without unit
  bool log_y = false;
  std::string pointer;
};

struct OutputSpecification {
  int metrics_every = 10;           ///< steps between rows of metrics.csv
  int frames = 0;                   ///< pictures over the run, first and last included
  std::string colour_by = "speed";  ///< attribute that colours the frames
  bool vtk = false;                 ///< a .vtu beside each frame
  std::string film;                 ///< format of the film, which is its ending too; "" for none
  std::vector<int> reactions;       ///< supports whose reaction is recorded
  bool ledger = true;               ///< the energy ledger
  int ledger_every = 1;             ///< steps between its entries, each counted that many times
  double checkpoint_seconds = 60;   ///< seconds of the wall clock between checkpoints; 0: none by the clock
  long checkpoint_steps = 0;        ///< steps between checkpoints; 0: none by steps
  std::vector<int> bodies;          ///< bodies whose numbers have columns of their own
  std::vector<GroupSpecification> groups;
  std::vector<ProbeSpecification> probes;
  bool contact_pairs = false;  ///< contact has columns for each pair of fields
  bool normal_error = false;   ///< pairs have columns for the error of their normals
  bool contact_nodes = false;  ///< the nodes where fields meet are drawn and written with each frame

  /// Whether a probe takes a quantity whose name begins so.
  bool probes_take(std::string_view beginning) const;
};

struct Expectation {
  std::string metric;  ///< dotted path into summary.json, e.g. "energy.total.final_over_initial"
  std::optional<double> at_least, at_most, equals;
  double tolerance = 0;  ///< absolute tolerance of `equals`
  std::string pointer;
};

/// What a finished run must respect at every recorded time, else it is flagged by name.
struct Limits {
  std::optional<bool> isolated;       ///< nothing: as the scene says
  std::optional<double> energy_gain;  ///< limit over the energy that an isolated scene began with; nothing: not judged
  /// The same of energy that transfers, filters, walls and contact lose without a physical cause, and of energy lost
  /// that no row of the ledger explains; nothing: a warning where it is much.
  std::optional<double> numerical_loss, unexplained_loss;
  std::optional<std::array<double, 2>> volume_ratio;  ///< smallest and largest of any particle; nothing: not judged
};

struct ExactChoice {
  std::string type;                                    ///< name in the registry of exact solutions
  std::vector<std::pair<std::string, double>> values;  ///< values of its parameters
  std::string pointer;
};

/// An experiment as it was read. It throws nothing once constructed: reading has validated every value, name and
/// combination.
struct Experiment {
  std::filesystem::path file;
  std::string title, description;
  int dimension = 2;
  Precision precision = Precision::double_;
  std::string backend = "cpu";
  unsigned seed = 1;              ///< seed of particle jitter and of random places, where these are asked for
  std::vector<InputFile> inputs;  ///< files that bodies are read from

  GridSpecification grid;
  std::array<std::array<FaceCondition, 2>, 3> faces;  ///< [axis][0 lower, 1 upper]
  std::vector<BoxCondition> boxes;

  Component shape, transfer;
  std::optional<Component> filter, contact;
  FilterSchedule filter_schedule;
  std::optional<Component> contact_normal, contact_detection;  ///< with contact only
  int field_count = 1;
  std::vector<std::string> field_names;  ///< one a field; with contact only

  std::vector<MaterialSpecification> materials;
  std::vector<BodySpecification> bodies;
  std::vector<Grip> grips;
  std::vector<RigidBodySpecification> rigid_bodies;
  std::vector<Emitter> emitters;
  std::vector<Sink> sinks;

  Vector3 gravity{};  ///< m/s^2, as far as it is constant; zero along axes where it changes
  /// All of gravity, a function of t, where it changes in time along any axis, and along which.
  std::optional<VectorExpression> changing_gravity;
  std::array<bool, 3> gravity_changes{};
  std::optional<VectorExpression> body_force;  ///< N/kg at (x, y, z), initial (X, Y, Z), t
  std::string body_force_pointer;
  Damping damping;
  std::vector<Load> loads;

  SolverSpecification solver;
  OutputSpecification output;
  std::vector<std::string> figures;
  std::vector<ColumnFigure> column_figures;
  std::optional<ExactChoice> exact;
  std::vector<Expectation> expectations;
  Limits limits;

  nlohmann::ordered_json resolved;  ///< the file with overrides applied and every default filled: re-runnable

  /// Whether particles carry a temperature: then every body's material conducts, and every body has one.
  bool has_temperature() const;
  bool has_artificial_viscosity() const;  ///< of any material
  bool axisymmetric() const { return grid.symmetry == Symmetry::axisymmetric; }
  /// Gravity in the step that begins at a time, s.
  Vector3 gravity_at(double time) const { return changing_gravity ? (*changing_gravity)({}, {}, time) : gravity; }
  bool has_gravity(int axis) const { return gravity[axis] != 0 || gravity_changes[axis]; }
  bool has_gravity() const { return has_gravity(0) || has_gravity(1) || has_gravity(2); }
  /// A particle that leaves along a periodic axis has its height again: gravity along it does work without a potential.
  /// So does gravity that changes in time.
  bool gravity_has_potential(int axis) const {
    return faces[axis][0].type != ConditionType::periodic && !gravity_changes[axis];
  }
  /// The JSON pointer of the first that gives such a force, to one body or to any; empty where nothing does.
  std::string giver_of(ExternalForce force, int body = -1) const;
  /// The JSON pointer of the first load on a body that acts at points beside particles; empty where none does.
  std::string loaded_at_points(int body = -1) const;
  /// Whether a wall of the domain is of this type.
  bool any_face(ConditionType type) const;
  /// Whether material may leave a wall or a box.
  bool separates() const;
  /// The six faces of the domain, then the boxes of nodes, then the grips, then the rigid bodies; numbered by
  /// support_of_wall, support_of_box, support_of_grip and support_of_rigid_body.
  std::vector<Support> supports() const;
  int support_of_grip(std::size_t grip) const { return support_of_box(static_cast<int>(boxes.size() + grip)); }
  int support_of_rigid_body(std::size_t body) const { return support_of_grip(grips.size() + body); }
  /// Whether anything meets at nodes by a law: bodies that have velocity fields of their own, or rigid bodies.
  bool meets() const { return contact || !rigid_bodies.empty(); }
  /// The JSON pointer of what asks for that, and its law, as reasons name it; of a scene that `meets`.
  std::string why_it_meets() const;
  /// Whether a law joins bodies by springs, which pull by how far they have moved beside one another (MPM_COMPLIANT).
  bool has_compliant_contact() const;
  /// The state that the law of contact keeps on particles; empty where it keeps none.
  std::span<const mpm_state> contact_state() const;
  /// The longest step in which the law of contact acts as its parameters say, s (mpm.contact.step_limit); infinite where
  /// it names none.
  double contact_step_limit() const;
  /// Whether the law asks for the traction that would hold bodies together (MPM_READS_TRACTION).
  bool measures_traction() const;
  /// Whether what supports give is noted: where reactions are asked for, and in scenes with rigid bodies.
  bool notes_reactions() const { return !output.reactions.empty() || !rigid_bodies.empty(); }
  /// Whether a formula of body forces or grips reads where particles began.
  bool reads_initial_position() const;

  /// Whether the number of a body's particles grows, or falls, on the way.
  bool gains_particles(int body) const;
  bool loses_particles(int body) const;
  /// The JSON pointer of the first emitter, sink or change of material that changes the number of a body's particles, or
  /// (-1) of any; empty where it stays.
  std::string changer_of_particles(int body = -1) const;

  /// The place of a JSON pointer's value, "file:line:column", for messages that arise after reading.
  std::string where(std::string_view pointer) const;
  std::vector<std::pair<std::string, std::pair<int, int>>> positions;  ///< JSON pointer -> line, column

  std::optional<ParticleOutput> particle_output;  ///< output/particles
};

}  // namespace mpm
