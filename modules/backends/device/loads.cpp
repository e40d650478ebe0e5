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
void DeviceBackend<T>::scatter_loads(Body<T>& body, Arguments<T> a, double time) {
  const BodyLoads& loads = loads_of(body);
  if (loads.gives(ExternalForce::body_force)) run_blocks("scatter_body_force", a, body, Checks::force);
  FirstFailure failures;
  for (const ExternalForce kind : external_forces) {
    if (kind == ExternalForce::body_force || !loads.gives(kind)) continue;
    look();  // a particle that has failed has no place to evaluate formulas at
    evaluate_loads(body, loads, kind, time, failures);
    a.load_field = number_of(fields_[body.field].arrays.fields(), field_of(kind));
    run_blocks("scatter_load", a, body);
  }
  failures.raise();
}

template <class T>
void DeviceBackend<T>::evaluate_loads(Body<T>& body, const BodyLoads& loads, ExternalForce kind, double time,
                                      FirstFailure& failures) {
  const std::size_t D = experiment_.dimension, n = static_cast<std::size_t>(body.count);
  const LoadedParticles<T> particles(body);
  std::vector<T> force(D * n), moment(D * D * n);
  const auto read = [&](int p, LoadedParticle& particle) { particles.read(p, particle); };
  const auto give = [&](int p, const LoadCoefficients& given) {
    for (std::size_t c = 0; c < D; ++c) force[c * n + p] = static_cast<T>(given.b[c]);
    for (std::size_t k = 0; k < D * D; ++k) moment[k * n + p] = static_cast<T>(given.S[k]);
  };
  loads.evaluate(kind, body.count, nullptr, time, read, give, failures);
  body.arrays.write("load_force", force), body.arrays.write("load_moment", moment);
}

/// Of all loads on a body that are not finite, the failure is that of the particle with the lowest index: loads at points are
/// looked at too, as they are evaluated after those by mass.
template <class T>
Failure DeviceBackend<T>::failed_force(const Body<T>& body, int p) const {
  const BodyLoads& loads = loads_of(body);
  const LoadedParticles<T> particles(body);
  LoadedParticle failed;
  particles.read(p, failed);
  FirstFailure failures;
  loads.note_acceleration(static_cast<std::size_t>(p), failed.x, failed.X, time_, failures);
  for (const ExternalForce kind : external_forces)
    if (kind != ExternalForce::body_force && loads.gives(kind))
      loads.evaluate(
          kind, body.count, nullptr, time_, [&](int k, LoadedParticle& particle) { particles.read(k, particle); },
          [](int, const LoadCoefficients&) {}, failures);
  return *failures.first();
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device
