#include "backends/device/device_backend.hpp"

#include <algorithm>
#include <stdexcept>

#include "backends/device/kernels/sums.hpp"  // largest_team
#include "backends/libraries/backend_library.hpp"
#include "experiment/contact_settings.hpp"
#include "experiment/device_settings.hpp"
#include "simulation/boundary.hpp"

namespace mpm::device {
namespace {

/// The scene without what lies on the device.
template <class T>
Arguments<T> described(const Experiment& experiment) {
  const GridSpecification& grid = experiment.grid;
  Arguments<T> scene{};
  scene.cell_size = static_cast<T>(grid.cell_size), scene.strain_cap = static_cast<T>(strain_cap_of(experiment));
  scene.inverse_cell_size = static_cast<T>(1 / grid.cell_size);
  scene.node_count = 1;
  for (int c = 0; c < 3; ++c) {
    const bool used = c < experiment.dimension;
    scene.lower[c] = static_cast<T>(grid.lower[c]);
    scene.gravity_has_potential[c] = experiment.gravity_has_potential(c);
    scene.cells[c] = used ? grid.cells[c] : 0;
    scene.padding[c] = used ? grid_padding_of(experiment.shape.plugin->shape()) : 0;
    scene.extent[c] = scene.cells[c] + 1 + 2 * scene.padding[c];
    scene.node_count *= scene.extent[c];
    for (int side = 0; side < 2; ++side)
      scene.walls[c][side] = used ? static_cast<int>(experiment.faces[c][side].type) : wall_free;
  }
  return scene;
}

/// The teams at work on blocks that one multiprocessor may hold: as many as the limits of its threads allow.
constexpr int teams_of_multiprocessor = 32;

template <class T>
SceneSize size_of(const Arguments<T>& scene, int dimension, const std::vector<SeededBody>& seeded,
                  const std::vector<BodyLoads>& loads, int lanes) {
  SceneSize size{{}, static_cast<std::size_t>(scene.node_count), table_of_blocks(scene, dimension).table, lanes};
  for (const SeededBody& body : seeded) size.particles.push_back(body.count());
  for (const BodyLoads& of_body : loads) size.load_shares.push_back(of_body.shares().size());
  return size;
}

std::vector<BodyLoads> loads_of_bodies(const Experiment& experiment, const std::vector<SeededBody>& seeded) {
  std::vector<BodyLoads> loads;
  for (std::size_t body = 0; body < seeded.size(); ++body)
    loads.emplace_back(experiment, static_cast<int>(body), seeded[body]);
  return loads;
}

/// Opens the device, unless it has too little memory free.
std::unique_ptr<Device> open(const DeviceSetup& setup, const Experiment& experiment, const Plan& plan,
                             const SceneSize& size) {
  if (setup.lanes < 1 || setup.lanes > largest_team)
    throw std::invalid_argument("a team has 1 to " + std::to_string(largest_team) + " lanes");
  auto device = std::make_unique<Device>(*setup.driver, setup.number);
  refuse_what_does_not_fit(*device, experiment, plan, size);
  return device;
}

/// The name of the pass that ends every step.
std::string last_pass_of(const Step& step) {
  if (step.kind == Step::Kind::sequence && !step.children.empty()) return last_pass_of(step.children.back());
  if (step.kind != Step::Kind::pass) throw std::logic_error("the device cannot tell which pass ends a step");
  return step.pass.name();
}

}  // namespace

template <class T>
DeviceBackend<T>::DeviceBackend(const Experiment& experiment, const Plan& plan, const std::vector<SeededBody>& seeded,
                                const DeviceSetup& setup)
    : experiment_(experiment),
      plan_(plan),
      scene_(described<T>(experiment)),
      loads_(loads_of_bodies(experiment, seeded)),
      device_(open(setup, experiment, plan, size_of(scene_, experiment.dimension, seeded, loads_, setup.lanes))),
      lanes_(setup.lanes),
      teams_(setup.teams > 0 ? setup.teams : teams_of_multiprocessor * device_->multiprocessors()),
      shape_parameters_(*device_, "the shape's parameters"),
      transfer_parameters_(*device_, "the transfer's parameters"),
      filter_parameters_(*device_, "the filter's parameters"),
      contact_parameters_(*device_, "the parameters of contact"),
      normal_parameters_(*device_, "the parameters of the contact normal"),
      detection_parameters_(*device_, "the parameters of contact detection"),
      partial_sums_(*device_, "sums"),
      totals_(*device_, "sums", count_of_totals),
      deterministic_(sums_deterministically(experiment)),
      exponents_(*device_, "exact sums"),
      exact_sums_(*device_, "exact sums"),
      results_(*device_),
      formulas_(*device_, experiment, scene_),
      conditions_(*device_, experiment, scene_),
      load_laws_(*device_, "the loads"),
      merges_(!plan.node_field("force")),
      edges_(*device_, experiment),
      contact_impulse_(experiment),
      reactions_(experiment),
      rigid_(*device_, experiment, scene_),
      uses_graphs_(setup.graphs),
      steps_to_forget_(setup.steps_to_forget),
      graphs_(*device_) {
  const Choice choice = choice_of(experiment, plan);
  const Composition composition = compose(choice);
  device_->load(setup.compile(composition, device_->architecture()), composition.name);

  const auto give = [](DeviceArray<double>& array, const Component& component) {
    array.upload(component.parameters);
    return array.data();
  };
  scene_.shape_parameters = give(shape_parameters_, experiment.shape);
  scene_.transfer_parameters = give(transfer_parameters_, experiment.transfer);
  if (experiment.filter) scene_.filter_parameters = give(filter_parameters_, *experiment.filter);
  if (experiment.contact) scene_.contact_parameters = give(contact_parameters_, *experiment.contact);
  if (experiment.contact_normal) scene_.normal_parameters = give(normal_parameters_, *experiment.contact_normal);
  if (experiment.contact_detection)
    scene_.detection_parameters = give(detection_parameters_, *experiment.contact_detection);
  load_laws_.upload(laws_of_loads<T>(experiment));
  scene_.load_laws = load_laws_.data();
  scene_.stop = results_.stop();
  if (deterministic_) {
    const auto channels = static_cast<std::size_t>(most_channels(choice));
    exponents_.resize(channels), exact_sums_.resize(2 * channels * static_cast<std::size_t>(nodes()));
    exact_sums_.clear();
    scene_.exponents = exponents_.data(), scene_.exact_sums = exact_sums_.data();
  }

  if (records_nodes(experiment)) contact_notes_.emplace(*device_, experiment, scene_);
  for (int k = 0; experiment.measures_traction() && k < experiment.field_count * (experiment.field_count - 1) / 2; ++k)
    welds_.emplace_back(*device_, "welds",
                        static_cast<std::size_t>(experiment.dimension + 1) * static_cast<std::size_t>(nodes()));
  if (experiment.has_temperature()) heat_conditions_.emplace(*device_, experiment, scene_);
  for (std::size_t body = 0; body < seeded.size(); ++body) {
    bodies_.emplace_back(*device_, experiment, plan, scene_, static_cast<int>(body), seeded[body], loads_[body]);
  }
  if (choice.contact_by_particles)
    contact_sight_.emplace(*device_, experiment, scene_, bodies_, lanes_, setup.contact_row);
  for (int field = 0; field < experiment.field_count; ++field)
    fields_.emplace_back(*device_, experiment, plan, static_cast<std::size_t>(scene_.node_count));
  partial_sums_.resize(room_for_sums(size_of(scene_, experiment.dimension, seeded, loads_, lanes_)));
  last_pass_ = last_pass_of(plan.step);
  scene_.partial_sums = partial_sums_.data();
  for (int axis = 0; axis < experiment.dimension; ++axis) (periodic(axis) ? images_ : walls_).push_back(axis);
  for (const Field& field : plan.fields)
    folds_forces_ = folds_forces_ || (field.owner == Owner::node && field.folded == Folded::with_force);
}

template <class T>
std::uint64_t DeviceBackend<T>::particle_bytes() const {
  std::uint64_t sum = 0;
  for (const Body<T>& body : bodies_) sum += body.arrays.bytes();
  return sum;
}
template <class T>
std::uint64_t DeviceBackend<T>::grid_bytes() const {
  std::uint64_t sum = 0;
  for (const VelocityField<T>& field : fields_) sum += field.bytes();
  return sum;
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

/// What the library of the backend makes.
// NOLINTNEXTLINE(performance-unnecessary-value-param): one signature for all backends
std::unique_ptr<Backend> make(BackendRequest request) {
  if (request.experiment.precision == Precision::single)
    return std::make_unique<DeviceBackend<float>>(request.experiment, request.plan, request.bodies, *request.device);
  return std::make_unique<DeviceBackend<double>>(request.experiment, request.plan, request.bodies, *request.device);
}

}  // namespace mpm::device
