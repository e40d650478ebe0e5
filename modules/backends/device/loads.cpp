#include "backends/device/device_backend.hpp"

#include <algorithm>
#include <cmath>

#include "experiment/axis_names.hpp"
#include "simulation/grips.hpp"
#include "simulation/imposed_value.hpp"

namespace mpm::device {
namespace {

/// Fills in the particles of a body as their loads see them, from values that it waits for.
template <class T>
class LoadedParticles {
 public:
  explicit LoadedParticles(const Body<T>& body)
      : body_(body),
        position_(body.arrays.read("position")),
        velocity_(body.arrays.read("velocity")),
        deformation_(body.arrays.read("deformation")) {}

  void read(int p, LoadedParticle& particle) const {
    const auto n = static_cast<std::size_t>(body_.count), D = static_cast<std::size_t>(body_.dimension);
    const auto at = static_cast<std::size_t>(p);
    particle.x = particle.X = body_.vector(position_, at);
    particle.v = body_.vector(velocity_, at);
    for (std::size_t c = 0; c < D && !body_.initial_position.empty(); ++c)
      particle.X[c] = body_.initial_position[at * D + c];
    for (std::size_t k = 0; k < D * D && !deformation_.empty(); ++k) particle.F[k] = deformation_[k * n + at];
  }

 private:
  const Body<T>& body_;
  std::vector<T> position_, velocity_, deformation_;
};

}  // namespace

template <class T>
void DeviceBackend<T>::scatter_grips(const Body<T>& body) {
  run("tell_gripped", arguments_of(body), body, Checks::grip);
  for (std::size_t k = 0; k < experiment_.grips.size(); ++k) {
    Arguments<T> a = arguments_of(body);
    a.grip = static_cast<int>(k);
    run_blocks("scatter_grip", a, body);
  }
}

template <class T>
void DeviceBackend<T>::refuse_told(const Body<T>& body, int p) const {
  const auto at = static_cast<std::size_t>(p);
  LoadedParticle particle;
  LoadedParticles<T>(body).read(p, particle);
  const Grip& grip = experiment_.grips[static_cast<std::size_t>(body.arrays.read("grip")[at]) - 1];
  velocity_of(experiment_, grip, particle.x, particle.X, end_);
  // The host found a number, which a kernel in float did not, at the very end of the range.
  const Vector3 told = body.vector(body.arrays.read("told_velocity"), at);
  std::size_t c = 0;
  while (c < 2 && (!grip.held[c] || std::isfinite(told[c]))) ++c;
  throw ImposedValueFailure(experiment_, {grip.pointer + "/velocity/" + std::to_string(c),
                                          std::string("velocity along ") + axis_names[c],
                                          "m/s",
                                          told[c],
                                          end_,
                                          {particle.x.begin(), particle.x.begin() + experiment_.dimension}});
}

template <class T>
void DeviceBackend<T>::note_gripped(const Body<T>& body, const StepInfo& step, const Tally<1>& energy) {
  for (std::size_t k = 0; k < experiment_.grips.size(); ++k) {
    Arguments<T> a = arguments_of(body);
    a.grip = static_cast<int>(k);
    const Tally<7> sums = sum<7>("given_to_gripped", a, body.count);
    later([this, k, dt = step.dt, sums, energy] {
      GivenToGripped given;
      std::copy_n(sums->data(), 3, given.impulse.data());
      std::copy_n(sums->data() + 3, 3, given.moment.data());
      reactions_.give_particles(experiment_.support_of_grip(k), given, dt);
      (*energy)[0] += (*sums)[6];
    });
  }
}

template <class T>
void DeviceBackend<T>::scatter_loads(const Body<T>& body, Arguments<T> a) {
  const BodyLoads& loads = loads_of(body);
  for (const ExternalForce kind : external_forces) {
    if (!loads.gives(kind)) continue;
    if (kind == ExternalForce::body_force) {
      run_blocks("scatter_body_force", a, body, Checks::force);
      continue;
    }
    a.load_field = number_of(fields_[body.field].arrays.fields(), field_of(kind));
    a.load_kind = static_cast<int>(kind), a.dashpots = kind == ExternalForce::dashpot;
    run_blocks("scatter_load", a, body, Checks::load);
  }
}

template <class T>
Failure DeviceBackend<T>::failed_force(const Body<T>& body, int p) const {
  LoadedParticle failed;
  LoadedParticles<T>(body).read(p, failed);
  FirstFailure failures;
  loads_of(body).note_acceleration(static_cast<std::size_t>(p), failed.x, failed.X, time_, failures);
  note_loads(body, failures);
  return *failures.first();
}

template <class T>
Failure DeviceBackend<T>::failed_load(const Body<T>& body, int p) const {
  FirstFailure failures;
  note_loads(body, failures);
  if (failures.first()) return *failures.first();
  // The host finds numbers in double precision where a kernel in float does not.
  LoadedParticle failed;
  LoadedParticles<T>(body).read(p, failed);
  return loads_of(body).failed_formula(static_cast<std::size_t>(p), failed, time_);
}

template <class T>
void DeviceBackend<T>::note_loads(const Body<T>& body, FirstFailure& failures) const {
  const LoadedParticles<T> particles(body);
  const auto read = [&](int p, LoadedParticle& particle) { particles.read(p, particle); };
  const auto give = [](int, const LoadCoefficients&) {};
  for (const ExternalForce kind : external_forces)
    if (kind != ExternalForce::body_force)
      loads_of(body).evaluate(kind, body.count, nullptr, time_, read, give, failures);
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device
