// The door for Python: experiments that are read and changed, simulations that are stepped, and their particles as
// NumPy arrays. mpm_sandbox/__init__.py adds what needs no C++: run folders, recorded runs, studies.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "backends/make_backend.hpp"
#include "experiment/diagnostics.hpp"
#include "metrics/metrics.hpp"
#include "metrics/particle_quantities.hpp"
#include "mpm/cli.hpp"
#include "run/start_checks.hpp"
#include "support/files.hpp"
#include "support/processors.hpp"

namespace py = pybind11;

namespace mpm::app {
namespace {

/// The plugins, loaded once: what is read with them refers to them.
const Registry& registry() {
  static const Registry loaded = load_registry();
  return loaded;
}

using Values = std::vector<double>;
using ExperimentPointer = std::shared_ptr<const Experiment>;
using StatePointer = std::shared_ptr<const BodyState>;

ExperimentPointer read(const std::string& file, const std::string* text, const std::vector<std::string>& overrides) {
  RunOptions options;
  options.overrides = overrides;
  const ReadOptions offered = read_options(registry(), options);
  return std::make_shared<const Experiment>(
      text ? read_experiment_text(*text, file, ComponentLookup(registry()), offered)
           : read_experiment(file, registry(), offered));
}

/// A view of values that belong to `owner`, which lives as long as the array. It is read only: a change would reach
/// nobody.
template <class Owner>
py::array_t<double> view(const Values& values, std::size_t components, const std::shared_ptr<Owner>& owner) {
  using Holder = std::shared_ptr<Owner>;
  const py::capsule keeps(new Holder(owner), [](void* held) { delete static_cast<Holder*>(held); });
  const auto rows = static_cast<py::ssize_t>(components == 0 ? 0 : values.size() / components);
  std::vector<py::ssize_t> shape{rows};
  if (components != 1) shape.push_back(static_cast<py::ssize_t>(components));
  py::array_t<double> array(shape, values.data(), keeps);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// Values that were computed for one array alone.
py::array_t<double> view_of(Values values) {
  const auto owner = std::make_shared<const Values>(std::move(values));
  return view(*owner, 1, owner);
}

/// The particles of one body as they stood at one moment, in the order of seeding.
class Particles {
 public:
  Particles(ExperimentPointer experiment, int body, BodyState state)
      : experiment_(std::move(experiment)), body_(body), state_(std::make_shared<const BodyState>(std::move(state))) {}

  std::size_t count() const { return state_->position.size() / dimension(); }
  const std::string& body() const { return experiment_->bodies[static_cast<std::size_t>(body_)].name; }
  py::array_t<double> position() const { return view(state_->position, dimension(), state_); }
  py::array_t<double> velocity() const { return view(state_->velocity, dimension(), state_); }
  py::array_t<double> initial_position() const {
    if (state_->initial_position.empty())
      throw py::key_error("the scene keeps no initial positions: nothing in the experiment reads them");
    return view(state_->initial_position, dimension(), state_);
  }
  py::array_t<double> mass() const { return times_ring(state_->mass); }
  py::array_t<double> volume() const { return times_ring(state_->volume); }

  /// A quantity by the names that output/colour_by takes.
  py::array_t<double> quantity(const std::string& name) const {
    const std::vector<std::string> names = quantity_names(registry());
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw py::key_error("no quantity is called " + in_quotes(name) + suggestion(name, names, quoted_list(names)));
    return view_of(mpm::quantity(*experiment_, body_, *state_, name));
  }
  /// Kirchhoff stress: xx yy zz xy, in 3-D xx yy zz yz xz xy.
  py::array_t<double> stress() const {
    const auto owner = std::make_shared<const MaterialQuantities>(material_quantities(*experiment_, body_, *state_));
    return view(owner->stress, owner->stress.size() / std::max<std::size_t>(count(), 1), owner);
  }

  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto* fields : {&state_->material_state, &state_->transfer_state, &state_->host_state})
      for (const auto& [name, values] : *fields) all.push_back(name);
    return all;
  }
  py::array_t<double> state(const std::string& name) const {
    for (const auto* fields : {&state_->material_state, &state_->transfer_state, &state_->host_state})
      if (const auto found = fields->find(name); found != fields->end())
        return view(found->second, found->second.size() / std::max<std::size_t>(count(), 1), state_);
    throw py::key_error("no state is called " + in_quotes(name) + suggestion(name, names(), quoted_list(names())));
  }

 private:
  std::size_t dimension() const { return static_cast<std::size_t>(experiment_->dimension); }
  py::array_t<double> times_ring(double of_one) const {
    Values values(count());
    for (std::size_t p = 0; p < values.size(); ++p) values[p] = of_one * state_->size_of(p);
    return view_of(std::move(values));
  }

  ExperimentPointer experiment_;
  int body_;
  StatePointer state_;
};

/// A run without a folder: nothing is recorded but what is asked for.
class Stepper {
 public:
  Stepper(ExperimentPointer experiment, int threads)
      : experiment_(std::move(experiment)),
        simulation_(*experiment_,
                    backend_factory(threads > 0 ? threads : support::available_processors(), threads <= 0)),
        metrics_(simulation_) {
    (void)check_start(simulation_);
  }

  /// Takes steps until the end, at most so many; a Ctrl-C ends it between two steps.
  void step(long count) {
    for (; count > 0 && !simulation_.finished(); --count) take_step();
  }
  void run_until(double time) {
    while (simulation_.time() < time * (1 - 1e-12) && !simulation_.finished()) take_step();
  }

  Particles particles(const std::string& name) const {
    std::vector<std::string> names;
    for (const BodySpecification& body : experiment_->bodies) {
      if (body.name == name)
        return {experiment_, static_cast<int>(names.size()),
                simulation_.backend().body_state(static_cast<int>(names.size()))};
      names.push_back(body.name);
    }
    throw py::key_error("there is no body " + in_quotes(name) +
                        suggestion(name, names, "bodies: " + quoted_list(names)));
  }
  /// The columns of metrics.csv as they would stand now.
  std::vector<std::pair<std::string, double>> metrics() const {
    const std::vector<std::string> columns = metrics_.columns();
    const Values row = metrics_.row(metrics_.measure());
    std::vector<std::pair<std::string, double>> pairs;
    for (std::size_t k = 0; k < row.size(); ++k) pairs.emplace_back(columns[k], row[k]);
    return pairs;
  }
  py::bytes save() const {
    ArchiveWriter archive;
    simulation_.save(archive);
    return {archive.bytes().data(), archive.bytes().size()};
  }
  void restore(const std::string& bytes) {
    ArchiveReader archive({bytes.data(), bytes.size()});
    simulation_.restore(archive);
  }

  const Simulation& simulation() const { return simulation_; }
  const ExperimentPointer& experiment() const { return experiment_; }

 private:
  void take_step() {
    {
      const py::gil_scoped_release others_may_run;
      simulation_.step();
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }

  ExperimentPointer experiment_;
  Simulation simulation_;
  Metrics metrics_;
};

/// Steps, and says why a run cannot go on in the words of `mpm run`.
template <class Steps>
void in_words(Stepper& run, const py::object& failed, Steps steps) {
  std::string text;
  try {
    return steps();
  } catch (const RunFailure& stopped) {
    text = failure_text(stopped.failure, run.simulation()) +
           "\nremedy: " + remedy_for(stopped.failure, run.simulation().experiment());
  } catch (const ImposedValueFailure& stopped) {
    text = failure_text(stopped.imposed, run.simulation()) + "\nremedy: " + impossible_value_remedy;
  }
  PyErr_SetString(failed.ptr(), text.c_str());
  throw py::error_already_set();
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  module.doc() = "Experiments, simulations and particles of the MPM Sandbox.";
  py::register_exception<InputError>(module, "InputError", PyExc_ValueError);
  py::register_exception<PluginError>(module, "PluginError", PyExc_RuntimeError);
  py::register_exception<ArchiveError>(module, "ArchiveError", PyExc_ValueError);
  py::register_exception<support::MachineError>(module, "MachineError", PyExc_OSError);
  const py::object failed = py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc(
      "mpm_sandbox.RunFailed", "The run became unstable or invalid.", PyExc_RuntimeError, nullptr));
  module.attr("RunFailed") = failed;

  py::class_<Experiment, std::shared_ptr<Experiment>>(module, "Checked")
      .def_readonly("title", &Experiment::title)
      .def_readonly("dimension", &Experiment::dimension)
      .def_property_readonly("file", [](const Experiment& e) { return e.file.string(); })
      .def_property_readonly("bodies",
                             [](const Experiment& e) {
                               std::vector<std::string> names;
                               for (const BodySpecification& body : e.bodies) names.push_back(body.name);
                               return names;
                             })
      .def_property_readonly("resolved_text", [](const Experiment& e) { return e.resolved.dump(2); });
  module.def("read_file", [](const std::string& file, const std::vector<std::string>& overrides) {
    return std::const_pointer_cast<Experiment>(read(file, nullptr, overrides));
  });
  module.def("read_text",
             [](const std::string& text, const std::string& file, const std::vector<std::string>& overrides) {
               return std::const_pointer_cast<Experiment>(read(file, &text, overrides));
             });

  py::class_<Particles>(module, "Particles",
                        "One body's particles at one moment, in the order of seeding. Arrays are "
                        "views of one snapshot: rows are particles, SI units.")
      .def("__len__", &Particles::count)
      .def_property_readonly("body", &Particles::body, "name of the body")
      .def_property_readonly("position", &Particles::position, "m, (n, dimension)")
      .def_property_readonly("velocity", &Particles::velocity, "m/s, (n, dimension)")
      .def_property_readonly("initial_position", &Particles::initial_position,
                             "m, (n, dimension); KeyError where nothing in the experiment asks for it")
      .def_property_readonly("mass", &Particles::mass, "kg, (n); in plane strain a metre of depth")
      .def_property_readonly("volume", &Particles::volume, "initial, m^3, (n); in plane strain a metre of depth")
      .def_property_readonly("stress", &Particles::stress,
                             "Kirchhoff, Pa, (n, 4): xx yy zz xy; 3-D (n, 6): xx yy zz yz xz xy")
      .def("quantity", &Particles::quantity, py::arg("name"), "(n), by the names of output/colour_by; KeyError")
      .def_property_readonly("state_names", &Particles::names, "fields of material, transfer and host")
      .def("state", &Particles::state, py::arg("name"), "(n) or (n, components), a field by name; KeyError");

  py::class_<Stepper>(module, "Simulation", "A run that is stepped from Python and writes no folder.")
      .def(py::init([](const std::shared_ptr<Experiment>& experiment, int threads) {
             return std::make_unique<Stepper>(experiment, threads);
           }),
           py::arg("experiment"), py::arg("threads") = 1)
      .def(
          "step", [failed](Stepper& run, long count) { in_words(run, failed, [&] { run.step(count); }); },
          py::arg("count") = 1, "Takes so many steps, or fewer at the end. RunFailed where the run cannot go on.")
      .def(
          "run_until", [failed](Stepper& run, double time) { in_words(run, failed, [&] { run.run_until(time); }); },
          py::arg("time"), "Steps until a time in s, or the experiment's end. RunFailed.")
      .def("particles", &Stepper::particles, py::arg("body"), "The particles of a body, as they stand now. KeyError.")
      .def(
          "metrics", [](const Stepper& run) { return run.metrics(); },
          "Pairs of a column of metrics.csv and its value.")
      .def("save", &Stepper::save, "All that later steps depend on, as bytes.")
      .def("restore", &Stepper::restore, py::arg("bytes"),
           "Goes on from what a run of the same experiment saved. ArchiveError.")
      .def_property_readonly(
          "time", [](const Stepper& run) { return run.simulation().time(); }, "s")
      .def_property_readonly(
          "time_step", [](const Stepper& run) { return run.simulation().last_time_step(); }, "s, of the last step")
      .def_property_readonly("steps", [](const Stepper& run) { return run.simulation().steps(); })
      .def_property_readonly("finished", [](const Stepper& run) { return run.simulation().finished(); })
      .def_property_readonly("plan", [](const Stepper& run) { return run.simulation().plan().to_text(); });
}

}  // namespace mpm::app
