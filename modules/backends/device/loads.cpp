#include "backends/device/device_backend.hpp"

#include <algorithm>

namespace mpm::device {

template <class T>
void DeviceBackend<T>::scatter_grips(Body<T>& body, double end) {
  look();  // what the particles are told may be impossible only because they are
  const std::size_t D = experiment_.dimension;
  const std::vector<T> position = body.arrays.read("position"), numbers = body.arrays.read("grip");
  std::vector<T> told(position.size());
  for (std::size_t p = 0; p < numbers.size(); ++p) {
    if (!(numbers[p] > T(0))) continue;
    const Vector3 x = body.vector(position, p);
    Vector3 X = x;
    for (std::size_t c = 0; c < D && !body.initial_position.empty(); ++c) X[c] = body.initial_position[p * D + c];
    const Vector3 velocity =
        velocity_of(experiment_, experiment_.grips[static_cast<std::size_t>(numbers[p]) - 1], x, X, end);
    for (std::size_t c = 0; c < D; ++c) told[c * numbers.size() + p] = static_cast<T>(velocity[c]);
  }
  body.arrays.write("told_velocity", told);
  for (std::size_t k = 0; k < experiment_.grips.size(); ++k) {
    Arguments<T> a = arguments_of(body);
    a.grip = static_cast<int>(k);
    run_blocks("scatter_grip", a, body);
  }
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
  const BodyLoads& loads = loads_[static_cast<std::size_t>(&body - bodies_.data())];
  FirstFailure failures;
  for (const ExternalForce kind : external_forces) {
    if (!loads.gives(kind)) continue;
    look();  // a particle that has failed has no place to evaluate formulas at
    for (const int given : {body.number("load_force"), body.number("load_moment")})
      if (given >= 0) body.arrays.fill(given, 0);
    kind == ExternalForce::body_force ? evaluate_body_force(body, loads, time, failures)
                                      : evaluate_loads(body, loads, kind, time, failures);
    a.load_field = number_of(fields_[body.field].arrays.fields(), field_of(kind));
    run_blocks("scatter_load", a, body);
  }
  failures.raise();
}

template <class T>
void DeviceBackend<T>::evaluate_body_force(Body<T>& body, const BodyLoads& loads, double time, FirstFailure& failures) {
  const std::size_t D = experiment_.dimension, n = static_cast<std::size_t>(body.count);
  const std::vector<T> position = body.arrays.read("position"), around = body.arrays.read("size");
  std::vector<double> x(D * n), X(D * n), values(D * n);
  PointArrays at;
  std::array<double*, 3> result{};
  for (std::size_t c = 0; c < D; ++c) {
    for (std::size_t p = 0; p < n; ++p) {
      x[c * n + p] = body.component(position, p, c);
      X[c * n + p] = body.initial_position.empty() ? x[c * n + p] : body.initial_position[p * D + c];
    }
    at.x[c] = x.data() + c * n, at.X[c] = X.data() + c * n, result[c] = values.data() + c * n;
  }
  loads.accelerations(n, nullptr, at, time, result, failures);
  std::vector<T> force(D * n);
  for (std::size_t k = 0; k < D * n; ++k)
    force[k] = static_cast<T>(double(body.mass) * (around.empty() ? 1.0 : double(around[k % n])) * values[k]);
  body.arrays.write("load_force", force);
}

template <class T>
void DeviceBackend<T>::evaluate_loads(Body<T>& body, const BodyLoads& loads, ExternalForce kind, double time,
                                      FirstFailure& failures) {
  const std::size_t D = experiment_.dimension, n = static_cast<std::size_t>(body.count);
  const std::vector<T> position = body.arrays.read("position"), velocity = body.arrays.read("velocity"),
                       deformation = body.arrays.read("deformation");
  std::vector<T> force(D * n), moment(D * D * n);
  const auto read = [&](int p, LoadedParticle& particle) {
    particle.x = particle.X = body.vector(position, static_cast<std::size_t>(p));
    particle.v = body.vector(velocity, static_cast<std::size_t>(p));
    for (std::size_t c = 0; c < D && !body.initial_position.empty(); ++c)
      particle.X[c] = body.initial_position[p * D + c];
    for (std::size_t k = 0; k < D * D; ++k) particle.F[k] = deformation[k * n + p];
  };
  const auto give = [&](int p, const LoadCoefficients& given) {
    for (std::size_t c = 0; c < D; ++c) force[c * n + p] = static_cast<T>(given.b[c]);
    for (std::size_t k = 0; k < D * D; ++k) moment[k * n + p] = static_cast<T>(given.S[k]);
  };
  loads.evaluate(kind, body.count, nullptr, time, read, give, failures);
  body.arrays.write("load_force", force), body.arrays.write("load_moment", moment);
}

template class DeviceBackend<float>;
template class DeviceBackend<double>;

}  // namespace mpm::device
