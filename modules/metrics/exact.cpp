#include "metrics/exact.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

namespace mpm {
namespace {

using std::numbers::pi;

double value(const ExactChoice& choice, const std::string& name) {
  for (const auto& [known, number] : choice.values)
    if (known == name) return number;
  throw std::out_of_range("exact solution \"" + choice.type + "\" has no parameter \"" + name + "\"");
}

/// Free flight: symplectic Euler under gravity, exactly x = X + V t + g t (t + dt)/2 after whole steps dt.
class FreeFall final : public ExactSolution {
 public:
  FreeFall(const Experiment& experiment, double dt) : gravity_(experiment.gravity), dt_(dt) {}
  Vector3 position(const Vector3& X, const Vector3& V, double t) const override {
    Vector3 x;
    for (int c = 0; c < 3; ++c) x[c] = X[c] + V[c] * t + 0.5 * gravity_[c] * t * (t + dt_);
    return x;
  }
  Vector3 velocity(const Vector3&, const Vector3& V, double t) const override {
    return {V[0] + gravity_[0] * t, V[1] + gravity_[1] * t, V[2] + gravity_[2] * t};
  }

 private:
  Vector3 gravity_;
  double dt_;
};

/// Rigid rotation of a body in the x-y plane.
class RigidRotation final : public ExactSolution {
 public:
  RigidRotation(const ExactChoice& choice)
      : omega_(value(choice, "angular_velocity")), centre_{value(choice, "centre_x"), value(choice, "centre_y")} {}
  Vector3 position(const Vector3& X, const Vector3&, double t) const override {
    const double c = std::cos(omega_ * t), s = std::sin(omega_ * t), x = X[0] - centre_[0], y = X[1] - centre_[1];
    return {centre_[0] + c * x - s * y, centre_[1] + s * x + c * y, X[2]};
  }
  Vector3 velocity(const Vector3& X, const Vector3& V, double t) const override {
    const Vector3 x = position(X, V, t);
    return {-omega_ * (x[1] - centre_[1]), omega_ * (x[0] - centre_[0]), 0};
  }

 private:
  double omega_, centre_[2];
};

/// A fixed-free bar along x from the lower face, small strain, u = v0/w sin(b x) sin(w t), b = (2 mode - 1) pi
/// / 2L.
class BarVibration final : public ExactSolution {
 public:
  BarVibration(const ExactChoice& choice)
      : amplitude_(value(choice, "velocity_amplitude")),
        b_((2 * value(choice, "mode") - 1) * pi / (2 * value(choice, "length"))),
        omega_(b_ * std::sqrt(value(choice, "youngs_modulus") / value(choice, "density"))) {}
  Vector3 position(const Vector3& X, const Vector3&, double t) const override {
    return {X[0] + amplitude_ / omega_ * std::sin(b_ * X[0]) * std::sin(omega_ * t), X[1], X[2]};
  }
  Vector3 velocity(const Vector3& X, const Vector3&, double t) const override {
    return {amplitude_ * std::sin(b_ * X[0]) * std::cos(omega_ * t), 0, 0};
  }

 private:
  double amplitude_, b_, omega_;
};

/// A manufactured wave (Wallstedt & Guilkey 2008): u_i = A sin(pi X_i) sin(c pi t + phase + phi_i), phi = (0, pi, 0), on the
/// unit square or cube.
class AxisAlignedWave final : public ExactSolution {
 public:
  AxisAlignedWave(const ExactChoice& choice, int dimension)
      : amplitude_(value(choice, "amplitude")),
        speed_(value(choice, "wave_speed")),
        phase_(value(choice, "phase")),
        dimension_(dimension) {}
  Vector3 position(const Vector3& X, const Vector3&, double t) const override {
    Vector3 x = X;
    for (int c = 0; c < dimension_; ++c)
      x[c] += amplitude_ * std::sin(pi * X[c]) * std::sin(speed_ * pi * t + phase(c));
    return x;
  }
  Vector3 velocity(const Vector3& X, const Vector3&, double t) const override {
    Vector3 v{};
    for (int c = 0; c < dimension_; ++c)
      v[c] = amplitude_ * speed_ * pi * std::sin(pi * X[c]) * std::cos(speed_ * pi * t + phase(c));
    return v;
  }

 private:
  double phase(int component) const { return component == 1 ? phase_ + pi : phase_; }
  double amplitude_, speed_, phase_;
  int dimension_;
};

/// A manufactured wave with free faces: u_i = A cos(pi X_i)^2 sin(c pi t + phi_i), phi = (0, pi, 0), along the axes of the
/// unit square or cube about the origin, which are turned about z. Displacement and stretch vanish at the faces, so that a
/// material of Poisson's ratio 0 leaves them without stress, whatever their direction.
class TurnedWave final : public ExactSolution {
 public:
  TurnedWave(const ExactChoice& choice, int dimension)
      : amplitude_(value(choice, "amplitude")),
        speed_(value(choice, "wave_speed")),
        cosine_(std::cos(value(choice, "angle"))),
        sine_(std::sin(value(choice, "angle"))),
        dimension_(dimension) {}
  Vector3 position(const Vector3& X, const Vector3&, double t) const override {
    Vector3 place = to_axes(X);
    for (int c = 0; c < dimension_; ++c) place[c] += profile(place[c]) * std::sin(speed_ * pi * t + phase(c));
    return from_axes(place);
  }
  Vector3 velocity(const Vector3& X, const Vector3&, double t) const override {
    const Vector3 place = to_axes(X);
    Vector3 v{};
    for (int c = 0; c < dimension_; ++c) v[c] = speed_ * pi * profile(place[c]) * std::cos(speed_ * pi * t + phase(c));
    return from_axes(v);
  }

 private:
  static double phase(int component) { return component == 1 ? pi : 0; }
  double profile(double x) const { return amplitude_ * std::cos(pi * x) * std::cos(pi * x); }
  Vector3 to_axes(const Vector3& x) const {
    return {cosine_ * x[0] + sine_ * x[1], -sine_ * x[0] + cosine_ * x[1], x[2]};
  }
  Vector3 from_axes(const Vector3& x) const {
    return {cosine_ * x[0] - sine_ * x[1], sine_ * x[0] + cosine_ * x[1], x[2]};
  }
  double amplitude_, speed_, cosine_, sine_;
  int dimension_;
};

/// The generalised vortex (Brannon, Kamojjala & Sadeghirad 2011): the ring 0.75 <= R <= 1.25 m about the origin, each
/// circle turned by G sin(pi t / T) h(R), h = (1 - 16 (R - 1)^2)^2; h and h' vanish at both edges. h = 0 beyond them.
class GeneralisedVortex final : public ExactSolution {
 public:
  GeneralisedVortex(const ExactChoice& choice)
      : amplitude_(value(choice, "amplitude")), time_(value(choice, "duration")) {}
  Vector3 position(const Vector3& X, const Vector3&, double t) const override {
    const double angle = amplitude_ * std::sin(pi * t / time_) * profile(X), c = std::cos(angle), s = std::sin(angle);
    return {c * X[0] - s * X[1], s * X[0] + c * X[1], X[2]};
  }
  Vector3 velocity(const Vector3& X, const Vector3& V, double t) const override {
    const double rate = amplitude_ * pi / time_ * std::cos(pi * t / time_) * profile(X);
    const Vector3 x = position(X, V, t);
    return {-rate * x[1], rate * x[0], 0};
  }

 private:
  static double profile(const Vector3& X) {
    const double q = std::hypot(X[0], X[1]) - 1, root = std::max(0.0, 1 - 16 * q * q);
    return root * root;
  }
  double amplitude_, time_;
};

struct Entry {
  ExactDescription description;
  std::function<std::unique_ptr<ExactSolution>(const Experiment&, double)> make;
};

ParameterSpec number(const char* name, const char* unit, const char* doc) {
  return parameter(name, ParameterType::number, unit, doc);
}

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all{
      {{"free_fall", "rigid flight under gravity, exact for the discrete scheme with a fixed step", {}},
       [](const Experiment& e, double dt) { return std::make_unique<FreeFall>(e, dt); }},
      {{"rigid_rotation",
        "rotation without deformation in the x-y plane",
        {number("angular_velocity", "1/s", "angular velocity").needed(),
         number("centre_x", "m", "centre of rotation").needed(),
         number("centre_y", "m", "centre of rotation").needed()}},
       [](const Experiment& e, double) { return std::make_unique<RigidRotation>(*e.exact); }},
      {{"bar_vibration",
        "axial vibration of a fixed-free bar along x, small strain",
        {number("velocity_amplitude", "m/s", "initial velocity of the tip").needed(),
         parameter("mode", ParameterType::integer, "", "number of the mode, from 1").from(1).standard(1),
         number("length", "m", "length of the bar").above(0).needed(),
         number("youngs_modulus", "Pa", "Young's modulus").above(0).needed(),
         number("density", "kg/m^3", "density").above(0).needed()}},
       [](const Experiment& e, double) { return std::make_unique<BarVibration>(*e.exact); }},
      {{"axis_aligned_wave",
        "manufactured solution u_i = A sin(pi X_i) sin(c pi t + phase + phi_i) on the unit square or cube",
        {number("amplitude", "m", "amplitude A").needed(),
         number("wave_speed", "m/s", "c = sqrt(E / density)").above(0).needed(),
         number("phase", "", "phase at t = 0, rad").standard(0)}},
       [](const Experiment& e, double) { return std::make_unique<AxisAlignedWave>(*e.exact, e.dimension); }},
      {{"turned_wave",
        "manufactured solution u_i = A cos(pi X_i)^2 sin(c pi t + phi_i) on the unit square or cube about the origin, "
        "turned about z, with free faces where Poisson's ratio is 0",
        {number("amplitude", "m", "amplitude A").needed(),
         number("wave_speed", "m/s", "c = sqrt(E / density)").above(0).needed(),
         number("angle", "", "angle of the axes X_i about z, rad").needed()}},
       [](const Experiment& e, double) { return std::make_unique<TurnedWave>(*e.exact, e.dimension); }},
      {{"generalised_vortex",
        "manufactured solution on the ring 0.75 <= R <= 1.25 m about the origin: circles turn by G sin(pi t / T) (1 - "
        "16 (R - 1)^2)^2",
        {number("amplitude", "", "angle G that the middle circle turns, rad").needed(),
         number("duration", "s", "time T until all is back in its place").above(0).needed()}},
       [](const Experiment& e, double) { return std::make_unique<GeneralisedVortex>(*e.exact); }}};
  return all;
}

}  // namespace

std::vector<ExactDescription> exact_solutions() {
  std::vector<ExactDescription> descriptions;
  for (const Entry& entry : entries()) descriptions.push_back(entry.description);
  return descriptions;
}

std::unique_ptr<ExactSolution> make_exact_solution(const Experiment& experiment, double dt) {
  if (!experiment.exact) return nullptr;
  for (const Entry& entry : entries())
    if (entry.description.name == experiment.exact->type) return entry.make(experiment, dt);
  throw std::out_of_range("no exact solution is named \"" + experiment.exact->type + "\"");
}

}  // namespace mpm
