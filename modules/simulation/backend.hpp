#pragma once
// A backend executes the passes of the plan, gives the particles as doubles, and says what it measured on the way.

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "plan/plan.hpp"
#include "plugin/extension_of.hpp"
#include "simulation/archive.hpp"
#include "simulation/failure.hpp"

namespace mpm {

/// What seeds name a field by: its id, which two plugins may share.
inline std::string seed_key(const Field& field) {
  return field.origin == Origin::host       ? field.id
         : field.origin == Origin::material ? "material/" + field.id
                                            : "transfer/" + field.id;
}

/// Consecutive particles of a body, as they were seeded.
struct SeedBatch {
  std::size_t first = 0, count = 0;  ///< in the order of seeding
  const double* position = nullptr;  ///< count*dimension, m, particle-major
  const double* velocity = nullptr;  ///< count*dimension, m/s
  /// The gradient of the initial velocity, count*dimension*dimension, 1/s, row = component. It starts the affine
  /// velocity of transfers that carry one (MPM_AFFINE_CARRIES_ENERGY, MPM_STARTS_WITH_GRADIENT: state 0), so that no
  /// spin is lost in the first step. With MPM_KEEPS_SPIN_ONLY it is the antisymmetric part; else it is null.
  const double* velocity_gradient = nullptr;
  /// Other fields of the plan that start as seeded, by seed_key; count*components, particle-major. Where they hold an
  /// initial position, `position` is a displaced one.
  std::vector<std::pair<std::string, const double*>> others = {};

  /// Where the particles are in the undeformed body.
  const double* undeformed() const {
    for (const auto& [id, first] : others)
      if (id == "initial_position") return first;
    return position;
  }
  /// The values that a field starts with; null where the seeds have none.
  const double* values(const Field& field) const {
    const std::string key = seed_key(field);
    for (const auto& [id, first] : others)
      if (id == key) return first;
    if (key == "position" || key == "initial_position") return position;
    return key == "velocity" ? velocity : nullptr;
  }
};

/// The seeds of all particles of a body, in arrays as in SeedBatch.
struct SeedArrays {
  std::vector<double> position, velocity, velocity_gradient;
};

/// The particles of one body as they were seeded. All have one volume and mass, times their `size` where the plan has that
/// field. They are made batch by batch when a
/// backend asks, so that no second copy of a large body is ever held.
struct SeededBody {
  double volume = 0;  ///< initial, m^3 (m^2 per metre of depth in 2-D, of circumference in axisymmetric scenes)
  double mass = 0;    ///< kg
  std::size_t dimension = 2, particles = 0;
  bool with_gradient = false;  ///< batches carry the gradient of the velocity
  bool with_size = false;      ///< batches carry sizes; else those of an axisymmetric scene are 2 pi r
  std::function<void(const std::function<void(const SeedBatch&)>&)> make;

  std::size_t count() const { return particles; }
  /// Calls visit(batch) in the order of seeding, with the same batches each time.
  void for_each_batch(const std::function<void(const SeedBatch&)>& visit) const { make(visit); }
  void replace(SeedArrays all) {
    particles = all.position.size() / dimension;
    with_gradient = !all.velocity_gradient.empty(), with_size = false;
    make = [all = std::move(all), count = particles](const std::function<void(const SeedBatch&)>& visit) {
      visit({0, count, all.position.data(), all.velocity.data(),
             all.velocity_gradient.empty() ? nullptr : all.velocity_gradient.data()});
    };
  }
  /// The values of all particles in a field that starts as seeded; empty where the seeds have none.
  std::vector<double> values(const Field& field) const {
    std::vector<double> all;
    for_each_batch([&](const SeedBatch& batch) {
      if (const double* const first = batch.values(field))
        all.insert(all.end(), first, first + batch.count * static_cast<std::size_t>(field.components));
    });
    return all;
  }
  /// Collects all seeds at once, for backends that keep doubles anyway.
  SeedArrays arrays() const {
    SeedArrays all;
    for_each_batch([&](const SeedBatch& batch) {
      const auto append = [&](std::vector<double>& values, const double* first, std::size_t components) {
        if (first) values.insert(values.end(), first, first + batch.count * components);
      };
      append(all.position, batch.position, dimension);
      append(all.velocity, batch.velocity, dimension);
      append(all.velocity_gradient, batch.velocity_gradient, dimension * dimension);
    });
    return all;
  }
};

/// The state of one body in doubles, particle-major, in the order of seeding, whatever the backend's own order and
/// precision.
struct BodyState {
  std::vector<double> position, velocity, initial_position;                   ///< m, m/s, m (empty unless planned)
  std::map<std::string, std::vector<double>> transfer_state, material_state;  ///< by declared field name
  // Velocity and transfer_state may be empty after a step that is not observed.
  double volume = 0, mass = 0;  ///< values of a particle of size 1, as seeded
  std::vector<double> size;     ///< n: factor of both, in axisymmetric scenes m of circumference; empty unless planned
  double size_of(std::size_t p) const { return size.empty() ? 1.0 : size[p]; }
  std::vector<double> domain;  ///< n*dimension*dimension, m, columns are semi-sides; empty unless planned
  /// The corners of each particle's domain, n*points*dimension, m from the particle; empty unless Plan::sample_points.
  std::vector<double> corners;
  /// The second moment of the shape at each particle's position, n*dimension*dimension, m^2; empty unless
  /// StencilNeeds::second_moment.
  std::vector<double> second_moment;
  std::map<std::string, std::vector<double>> host_state;  ///< by id: saved fields without a member of their own

  /// The array that holds the values of a particle field.
  std::vector<double>& of(const Field& field) {
    if (field.origin == Origin::transfer) return transfer_state[field.id];
    if (field.origin == Origin::material) return material_state[field.id];
    for (const auto& [id, values] : {std::pair{"position", &position}, std::pair{"velocity", &velocity},
                                     std::pair{"initial_position", &initial_position}, std::pair{"size", &size},
                                     std::pair{"domain", &domain}, std::pair{"corners", &corners}})
      if (field.id == id) return *values;
    return host_state[field.id];
  }
};

/// What the strain of a body's particles in one step did to energy, J.
struct StrainEnergies {
  double dissipated = 0;         ///< by the material and its artificial viscosity
  double artificial = 0;         ///< share of that which artificial viscosity dissipated
  double power = 0, stored = 0;  ///< work of the stresses on the strain, and change of the stored energy

  void add(const StrainEnergies& other) {
    dissipated += other.dissipated, artificial += other.artificial;
    power += other.power, stored += other.stored;
  }
};

/// The energy that each cause has given, J, summed over the steps that the ledger takes. Each cause records what it
/// applies where it applies it; the last entries say whether these records explain what was measured (docs/method.md, the
/// ledger).
struct Ledger {
  double scatter = 0, gather = 0;      ///< exact differences of kinetic energy across the transfers
  double internal_force = 0;           ///< dt f.(v- + v+)/2 of the stresses
  double gravity = 0, body_force = 0;  ///< the same of the external forces
  double gravity_without_potential =
      0;  ///< the same of gravity that has none: along periodic axes, or changing in time
  double surface_load = 0, point_load = 0, spring = 0, dashpot = 0;  ///< the same (simulation/loads.hpp)
  double boundary = 0, contact = 0;                                  ///< J.(v- + v+)/2 of impulses
  double rigid_bodies = 0;          ///< share of contact that is work of rigid bodies, J times their own velocity
  double damping = 0;               ///< the same of what damping takes
  double friction = 0;              ///< share of contact that the law turned to heat (positive), as particles keep it
  double friction_taken_back = 0;   ///< more of it, before the forces, that gathering increments undoes (FLIP)
  double interface = 0;             ///< share of contact that the springs of the law took up (negative: gave back)
  double material = 0;              ///< dissipated by the materials and their artificial viscosity (positive)
  double artificial_viscosity = 0;  ///< share of that which artificial viscosity dissipated
  double plastic_work = 0, viscous_flow = 0, damage = 0;  ///< shares of it, by what the law says (dissipation_of)
  double phase_change = 0;                                ///< share of it that was stored and went with a phase
  double filter = 0;                                      ///< J.(v + v_filtered)/2 of the filter's impulses
  double filtered_strain = 0;   ///< what strain by the filtered velocity stores less than by the unfiltered one
  double filtered_gravity = 0;  ///< potential energy that particles gain less as the filtered velocity moves them
  double remapped_strain = 0;   ///< what strain by the remapped velocity (MUSL) stores less than by v+
  double second_moment = 0;  ///< change of the affine part's kinetic energy, as D changes with the place of a particle
  double stress_power = 0;   ///< work of the stresses on the strain of the particles
  double stored = 0;         ///< stored by the materials while they strain
  double emitted = 0, removed = 0;  ///< energy of particles that emitters bring, less that of those that sinks take
  double changed_material = 0;      ///< what particles gain as they go over to another body
  // These books are zero to rounding, or as the step goes to zero, in a program without a fault.
  double grid_book = 0;      ///< change of the grid's kinetic energy before and by the forces, less the works above
  double filter_book = 0;    ///< the same over the filter's loops
  double material_book = 0;  ///< stress power less what the materials stored and dissipated
  double mass_book = 0;      ///< kg, mass of the particles less that of the nodes after the scatter
  double momentum_book = 0;  ///< kg m/s, size of the momentum that the scatter loses, summed over steps

  /// Enters what the strain of a body of this material did in a step.
  void enter_strain(double Ledger::*dissipation, const StrainEnergies& energies);
  /// Enters stored energy that particles lost as they took the parameters of their other phase.
  void enter_phase_change(double lost);
  Ledger plus(const Ledger& other) const;
  Ledger times(double factor) const;
  /// The change of the total energy that the causes explain.
  double explained() const;
};

/// An entry of a ledger with its name, and how the sum of all changes by it: of the total energy, +1 where it is given,
/// -1 where it is lost, 0 where it is a part of another entry or reappears as potential energy. Sums, files and tests go
/// over the lists of entries: a new entry is a member and a line here, and a member without its line does not compile.
template <class AnyLedger>
struct LedgerEntry {
  const char* name;
  double AnyLedger::*value;
  int sign = 1;
  int turn = 0;  ///< entries are summed by turns; the rounding of the residual depends on their order
  const char* unit = "J";
};
inline constexpr LedgerEntry<Ledger> ledger_entries[] = {
    {"scatter", &Ledger::scatter},
    {"gather", &Ledger::gather},
    {"internal force", &Ledger::internal_force, 0},
    {"gravity", &Ledger::gravity, 0},
    {"body force", &Ledger::body_force, 1, 3},
    {"surface load", &Ledger::surface_load, 1, 3},
    {"point load", &Ledger::point_load, 1, 3},
    {"spring", &Ledger::spring, 1, 3},
    {"dashpot", &Ledger::dashpot, 1, 3},
    {"gravity without potential", &Ledger::gravity_without_potential, 1, 3},
    {"boundary", &Ledger::boundary, 1, 2},
    {"contact", &Ledger::contact, 1, 2},
    {"rigid bodies", &Ledger::rigid_bodies, 1, 2},
    {"damping", &Ledger::damping, 1, 2},
    {"friction", &Ledger::friction, 0},
    {"friction taken back", &Ledger::friction_taken_back, 0},
    {"interface springs", &Ledger::interface, 0},
    {"material dissipation", &Ledger::material, -1, 4},
    {"artificial viscosity", &Ledger::artificial_viscosity, 0},
    {"plastic work", &Ledger::plastic_work, 0},
    {"viscous flow", &Ledger::viscous_flow, 0},
    {"damage", &Ledger::damage, 0},
    {"phase change", &Ledger::phase_change, 0},
    {"filter", &Ledger::filter, 1, 1},
    {"filtered strain", &Ledger::filtered_strain, 1, 5},
    {"filtered gravity", &Ledger::filtered_gravity, 1, 5},
    {"remapped strain", &Ledger::remapped_strain, 1, 5},
    {"second moment", &Ledger::second_moment, 1, 5},
    {"emitted", &Ledger::emitted, 1, 6},
    {"removed", &Ledger::removed, 1, 6},
    {"changed material", &Ledger::changed_material, 1, 6},
    {"stress power", &Ledger::stress_power, 0},
    {"stored", &Ledger::stored, 0},
    {"grid book", &Ledger::grid_book, 0},
    {"filter book", &Ledger::filter_book, 0},
    {"material book", &Ledger::material_book, 0},
    {"mass book", &Ledger::mass_book, 0, 0, "kg"},
    {"momentum book", &Ledger::momentum_book, 0, 0, "kg m/s"}};
static_assert(sizeof(Ledger) == std::size(ledger_entries) * sizeof(double));

/// Rows of what materials dissipate, in the order of mpm_dissipation_cause.
inline constexpr double Ledger::*dissipation_rows[] = {&Ledger::plastic_work, &Ledger::viscous_flow, &Ledger::damage};
/// The rows whose sum is material dissipation, where every law names its cause.
inline constexpr double Ledger::*shares_of_dissipation[] = {dissipation_rows[0], dissipation_rows[1],
                                                            dissipation_rows[2], &Ledger::phase_change,
                                                            &Ledger::artificial_viscosity};
inline const char* name_of(double Ledger::*row) {
  for (const auto& entry : ledger_entries)
    if (entry.value == row) return entry.name;
  return "";
}

/// The row of what a material dissipates, by its extension mpm.material.dissipation; null where it names no cause.
inline double Ledger::*dissipation_of(const Plugin& material) {
  const auto* const table = extension_of<mpm_material_dissipation>(material);
  if (!table || table->cause < 1 || table->cause > std::size(dissipation_rows)) return nullptr;
  return dissipation_rows[table->cause - 1];
}

inline void Ledger::enter_strain(double Ledger::*dissipation, const StrainEnergies& energies) {
  material += energies.dissipated;
  artificial_viscosity += energies.artificial;
  if (dissipation) this->*dissipation += energies.dissipated - energies.artificial;
  stress_power += energies.power;
  stored += energies.stored;
  material_book += energies.power - energies.stored - energies.dissipated;
}
inline void Ledger::enter_phase_change(double lost) {
  material += lost;
  phase_change += lost;
  stored -= lost;
}
inline Ledger Ledger::plus(const Ledger& other) const {
  Ledger sum;
  for (const auto& [name, value, sign, turn, unit] : ledger_entries) sum.*value = this->*value + other.*value;
  return sum;
}
inline Ledger Ledger::times(double factor) const {
  Ledger product;
  for (const auto& [name, value, sign, turn, unit] : ledger_entries) product.*value = factor * this->*value;
  return product;
}

inline double Ledger::explained() const {
  double sum = 0;
  for (int now = 0; now < static_cast<int>(std::size(ledger_entries)); ++now)
    for (const auto& [name, value, sign, turn, unit] : ledger_entries)
      if (turn == now) sum += sign * this->*value;
  return sum;
}

/// A record of what the filter did in the last step in which it acted.
struct FilterRecord {
  long iterations = 0;
  double first_norm = 0,
         last_norm = 0;       ///< mass norm of the increment, sqrt(sum m v*.v*), kg^1/2 m/s: at the start, now
  double largest_growth = 0;  ///< largest ratio over the run of a norm to the one before; above 1 a constraint or a
                              ///< negative weight has broken the contraction

  /// Takes the norm after one more pass. Growth of what is rounding already (relative to the first norm) is ignored.
  void take_norm(double norm, double rounding = 1e-12) {
    if (last_norm > rounding * first_norm) largest_growth = std::max(largest_growth, norm / last_norm);
    last_norm = norm;
    ++iterations;
  }
};

/// A record of what contact did, in the last step and in total. Forces act on the pair's first body.
struct ContactRecord {
  std::array<double, 3> force{};  ///< N, the momentum that particles took from contact in the last step over dt
  long nodes = 0, sticking = 0, slipping = 0;  ///< last step
  double largest_penetration = 0;              ///< m, last step, of pairs in contact
  double momentum_residual = 0;                ///< kg m/s, sum of its impulses: rounding, but with own normals
};

/// The same of one pair of velocity fields. The force acts on its first field.
struct PairRecord {
  std::array<double, 3> force{};               ///< N
  std::array<double, 3> tangential_force{};    ///< N, the force less the parts along the nodes' normals
  double normal_force = 0;                     ///< N, sum of the sizes of those; negative where they pull
  double area = 0;                             ///< m^2 (m in 2-D), of what touches in the last step
  long nodes = 0, sticking = 0, slipping = 0;  ///< last step
  double largest_penetration = 0;              ///< m, last step
  double largest_gap = 0;                      ///< m, last step, that was open where the law acted

  // These are sums since the run began, N s.
  std::array<double, 3> impulse{}, tangential_impulse{};
  double normal_impulse = 0;
  std::array<double, 3> unbalanced_impulse{};  ///< what both fields gained together: rounding, but with own normals
};

/// A node where two velocity fields a < b met in the last step.
struct ContactNode {
  std::array<int, 3> node{};  ///< its coordinates
  int a = 0, b = 0;           ///< numbers of the fields
  Vector3 normal{};           ///< unit, from a to b; zero where a weld finds none
  double separation = 0;      ///< m, negative where the surfaces overlap
  double area = 0;            ///< m^2 (m in 2-D)
  int status = 0;             ///< mpm_contact_status, after the forces
  Vector3 force{};            ///< N, on a: the momentum that particles take from it over dt
};

/// A record of what a support (a wall or a box of nodes, Experiment::supports) does to the particles: what they took
/// from it in the last step, so that their momentum changes by the sum of all reactions, gravity and loads.
struct Reaction {
  Vector3 force{};    ///< N, momentum given in the last step over dt
  Vector3 moment{};   ///< N m about the origin
  Vector3 impulse{};  ///< N s since the run began
};

/// Where a rigid body is, which follows from its motion since the run began.
struct RigidState {
  Vector3 place{};                                                     ///< of its point of reference, m
  std::array<Vector3, 3> rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< from the start, orthonormal rows
  Vector3 acted_at{};  ///< where the point of reference was in the last step, m: torques are about it

  /// The force, N, and the torque about the point of reference, N m, on the body whose reaction on the material this is.
  Vector3 force_on(const Reaction& reaction) const;
  Vector3 torque_on(const Reaction& reaction) const;
};

/// The heat that came and went since the run began, J. Each row is summed where the heat is applied; content and latent
/// heat of the particles change by the sum of all rows.
struct HeatLedger {
  double scatter = 0;      ///< heat of the nodes less that of the particles that gave it
  double images = 0;       ///< change by mirrored heat and held nodes before the step, which FLIP takes back
  double gather = 0;       ///< heat of the particles less that of the nodes that they took it from
  double walls = 0;        ///< heat from walls that are held at a temperature
  double flux = 0;         ///< heat through walls with a heat flux
  double convection = 0;   ///< heat through walls with convection
  double boxes = 0;        ///< heat into boxes of nodes, and what holds their temperature
  double dissipation = 0;  ///< share of the energy dissipated by the materials that warms them
  double emitted = 0, removed = 0, changed_material = 0;  ///< as in the ledger of the energy
  double sum() const;
  HeatLedger plus(const HeatLedger& other) const;
};
inline constexpr LedgerEntry<HeatLedger> heat_ledger_entries[] = {{"scatter", &HeatLedger::scatter},
                                                                  {"images", &HeatLedger::images},
                                                                  {"gather", &HeatLedger::gather},
                                                                  {"walls", &HeatLedger::walls},
                                                                  {"flux", &HeatLedger::flux},
                                                                  {"convection", &HeatLedger::convection},
                                                                  {"boxes", &HeatLedger::boxes},
                                                                  {"dissipation", &HeatLedger::dissipation},
                                                                  {"emitted", &HeatLedger::emitted},
                                                                  {"removed", &HeatLedger::removed},
                                                                  {"changed material", &HeatLedger::changed_material}};
static_assert(sizeof(HeatLedger) == std::size(heat_ledger_entries) * sizeof(double));

inline double HeatLedger::sum() const {
  double sum = 0;
  for (const auto& [name, value, sign, turn, unit] : heat_ledger_entries) sum += this->*value;
  return sum;
}

inline HeatLedger HeatLedger::plus(const HeatLedger& other) const {
  HeatLedger sum;
  for (const auto& [name, value, sign, turn, unit] : heat_ledger_entries) sum.*value = this->*value + other.*value;
  return sum;
}

/// The entries as rows in the order of the lists.
inline std::vector<ValueRow> rows_of(const Ledger& ledger) {
  std::vector<ValueRow> rows;
  for (const auto& [name, value, sign, turn, unit] : ledger_entries) rows.push_back({name, unit, ledger.*value});
  return rows;
}
inline std::vector<ValueRow> rows_of(const HeatLedger& ledger) {
  std::vector<ValueRow> rows;
  for (const auto& [name, value, sign, turn, unit] : heat_ledger_entries) rows.push_back({name, "J", ledger.*value});
  return rows;
}
/// The values of the entries without their names.
template <class AnyLedger>
std::vector<double> values_of(const AnyLedger& ledger) {
  std::vector<double> values;
  for (const ValueRow& row : rows_of(ledger)) values.push_back(row.value);
  return values;
}

struct TimeStepLimit {
  double speed = 0;       ///< largest wave speed + particle speed, m/s
  double wave_speed = 0;  ///< wave speed of that particle, m/s
  int body = 0;
  std::size_t particle = 0;
};

struct StepInfo {
  double dt = 0, time = 0;  ///< s; time at the start of the step
  long step = 0;
  bool filtered = false;  ///< the filter acts in this step: gathered velocities replace those of the particles
  double next_dt = 0;     ///< dt of the following step, s, where a gather scatters for it
  double next_time = 0;   ///< time at which that step begins, s
  bool observed = true;   ///< the state of the particles is read after this step
};

class Backend {
 public:
  virtual ~Backend() = default;
  virtual std::string_view name() const = 0;

  /// Throws RunFailure for the first particle (by comes_before) that is not a number, inverted or outside the domain.
  virtual void execute(const Pass& pass, const StepInfo& step) = 0;

  /// The result of the last estimate_time_step pass.
  virtual TimeStepLimit time_step_limit() const = 0;

  virtual BodyState body_state(int body) const = 0;
  /// The sums over the steps with Plan::accounts_at.
  virtual const Ledger& ledger() const = 0;
  /// The sums over all steps where Plan::has_heat_ledger(); else zeros.
  virtual HeatLedger heat_ledger() const { return {}; }
  virtual const ContactRecord& contact_record() const = 0;
  /// The record of each pair of fields, in the order of pair_index, where /output/contact_pairs asks; else empty.
  virtual const std::vector<PairRecord>& contact_pairs() const = 0;
  /// The nodes where fields met in the last step, where /output/contact_nodes, normal_error or contact_traction asks and the step was to be
  /// observed when it began (Simulation::observe_when); else empty.
  virtual const std::vector<ContactNode>& contact_nodes() const = 0;
  virtual const FilterRecord& filter_record() const = 0;
  /// By the number of the support; empty unless an experiment asks for any.
  virtual const std::vector<Reaction>& reactions() const = 0;
  /// Where the rigid bodies are, in the order of Experiment::rigid_bodies.
  virtual const std::vector<RigidState>& rigid_bodies() const = 0;

  /// Whether the last gather_scatter left the next step's grid. It may refuse (particles must be sorted first): the
  /// next step then scatters as usual.
  virtual bool scattered() const = 0;

  /// Saves everything that a later step depends on (simulation/saved_state.hpp). `restore` wants a backend of the same
  /// experiment and seeds, and throws ArchiveError. The backend that has saved it goes on bit for bit, another one with
  /// its own rounding.
  virtual void save(ArchiveWriter& archive) const = 0;
  virtual void restore(ArchiveReader& archive) = 0;

  /// Starts (or ends) measuring what the passes over particles spend their time on. It costs nothing while it is off.
  virtual void measure_phases(bool) {}
  /// The seconds of all threads together by phase ("weights", "gather", "material" ...) since measuring began; empty
  /// when the backend does not measure.
  virtual std::map<std::string, double> phase_seconds() const { return {}; }

  /// The bytes of particle and grid storage in use.
  virtual std::uint64_t particle_bytes() const = 0;
  virtual std::uint64_t grid_bytes() const = 0;
};

/// Builds the backend that an experiment names (backends/make_backend.hpp).
using BackendFactory = std::function<std::unique_ptr<Backend>(const Experiment&, const Plan&, std::vector<SeededBody>)>;

/// Makers of backends, which keep references to the experiment and the plan. The cpu backend uses `threads` threads, or
/// with `find_number` as many of them as it finds to be fastest.
std::unique_ptr<Backend> make_reference_backend(const Experiment&, const Plan&, std::vector<SeededBody>);
std::unique_ptr<Backend> make_cpu_backend(const Experiment&, const Plan&, std::vector<SeededBody>, int threads,
                                          bool find_number = false);

}  // namespace mpm
