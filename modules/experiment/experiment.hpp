#pragma once
// An experiment as read, checked and resolved: everything the plan needs, nothing of JSON left to interpret.

#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiment/expression.hpp"
#include "experiment/geometry.hpp"
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
  std::string pointer;
  ThermalCondition thermal;
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

struct MaterialSpecification {
  std::string name;
  Component component;
  std::optional<Thermal> thermal;
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
  std::optional<VectorExpression> initial_displacement_gradient;  ///< unused until a case needs it
  std::optional<ScalarExpression> temperature;                    ///< initial temperature, K, function of x, y, z
  std::string pointer;
};

struct SolverSpecification {
  std::string type = "explicit";
  StressUpdate stress_update = StressUpdate::last;
  std::optional<double> time_step;  ///< s; nothing: automatic
  double courant = 0.3;             ///< fraction of h / (wave speed + particle speed) when automatic
  double end_time = 0;              ///< s
  PassChoice passes = PassChoice::automatic;
  long max_steps = 1000000000;  ///< stops with an error message when reached before end_time
};

/// When a filter acts and what acts on it. One of the three intervals is given; the others are zero.
struct FilterSchedule {
  int every_steps = 1;
  double every_time = 0;         ///< s
  double every_courant = 0;      ///< cells that the fastest wave crosses
  bool constrain_always = true;  ///< conditions and contact act on every increment, else at the end only
  bool moves_by_mean = false;    ///< particles move with the mean of their velocities, else with the gathered one
  double tolerance = 0;          ///< the loop ends when |increment| <= tolerance |first|, mass norms; 0: never
};

struct OutputSpecification {
  int metrics_every = 10;           ///< steps between rows of metrics.csv
  int frames = 0;                   ///< pictures over the run, first and last included
  std::string colour_by = "speed";  ///< attribute that colours the frames
  bool vtk = false;                 ///< a .vtu beside each frame
  bool film = false;
  bool ledger = true;              ///< the energy ledger
  int ledger_every = 1;            ///< steps between its entries, each counted that many times
  double checkpoint_seconds = 60;  ///< seconds of the wall clock between checkpoints; 0: none by the clock
  long checkpoint_steps = 0;       ///< steps between checkpoints; 0: none by steps
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
  unsigned seed = 1;  ///< seed of particle jitter, when that is asked for

  GridSpecification grid;
  std::array<std::array<FaceCondition, 2>, 3> faces;  ///< [axis][0 lower, 1 upper]
  std::vector<BoxCondition> boxes;

  Component shape, transfer;
  std::optional<Component> filter, contact;
  FilterSchedule filter_schedule;
  std::string contact_normal, contact_detection;  ///< names of the host's choices, empty without contact
  int field_count = 1;
  std::vector<std::string> field_names;  ///< one a field; with contact only

  std::vector<MaterialSpecification> materials;
  std::vector<BodySpecification> bodies;

  Vector3 gravity{};                           ///< m/s^2
  std::optional<VectorExpression> body_force;  ///< N/kg at (x, y, z), initial (X, Y, Z), t
  std::string body_force_pointer;

  SolverSpecification solver;
  OutputSpecification output;
  std::vector<std::string> figures;
  std::optional<ExactChoice> exact;
  std::vector<Expectation> expectations;
  Limits limits;

  nlohmann::ordered_json resolved;  ///< the file with overrides applied and every default filled: re-runnable

  /// Whether particles carry a temperature: then every body's material conducts, and every body has one.
  bool has_temperature() const;
  bool axisymmetric() const { return grid.symmetry == Symmetry::axisymmetric; }
  /// A particle that leaves along a periodic axis has its height again: gravity along it does work without a potential.
  bool gravity_has_potential(int axis) const { return faces[axis][0].type != ConditionType::periodic; }
  /// Whether a wall of the domain is of this type.
  bool any_face(ConditionType type) const;
  /// Whether material may leave a wall or a box.
  bool separates() const;

  /// The place of a JSON pointer's value, "file:line:column", for messages that arise after reading.
  std::string where(std::string_view pointer) const;
  std::vector<std::pair<std::string, std::pair<int, int>>> positions;  ///< JSON pointer -> line, column
};

}  // namespace mpm
