#include "drive/extremes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace mpm::drive {
namespace {

Matrix diagonal(double x, double y, double z) {
  return Matrix{{x, 0, 0, 0, y, 0, 0, 0, z}};
}

Outcome judge(const Response& response, double J, double stiffness) {
  if (!response.is_taken) return Outcome::refused;
  if (!response.is_admissible) return Outcome::not_finite;
  if (!(std::abs(response.volume_ratio / J - 1) < 1e-6)) return Outcome::wrong_volume;
  if (response.stored < -1e-12 * stiffness) return Outcome::negative_energy;
  return Outcome::right;
}

/// The stiffness at rest, density c^2, Pa.
double stiffness_at_rest(const Component& material, const MaterialPoint& point) {
  const double c = point.look().wave_speed;
  for (const mpm_parameter& parameter : material.plugin->parameters())
    if (std::string_view(parameter.name) == "density") return material.parameter("density") * c * c;
  return c * c;
}

class Extremes {
 public:
  Extremes(const Component& material, int dimension, const ExtremeSize& size)
      : material_(material),
        dimension_(dimension),
        size_(size),
        stiffness_(stiffness_at_rest(material, MaterialPoint(material, dimension))) {}

  /// Equal steps f = I + dt L, `steps` of them, that multiply the volume by `ratio` each.
  Extreme follow(std::string name, const Matrix& step, double ratio, int steps, ExtremeKind kind = {}) const {
    Extreme extreme;
    extreme.name = std::move(name), extreme.kind = kind, extreme.steps = steps;
    extreme.stiffness = stiffness_;
    MaterialPoint point(material_, dimension_);
    const double dt = size_.duration / steps;
    Matrix L = step;
    for (int i = 0; i < 3; ++i) L(i, i) -= 1;
    for (double& entry : L.m) entry /= dt;
    extreme.end = point.look();
    ClampWatch watch(*material_.plugin, material_.parameters);
    for (int k = 1; k <= steps; ++k) {
      const Response response = point.advance(L, dt);
      extreme.outcome = judge(response, std::pow(ratio, k), stiffness_);
      if (extreme.outcome != Outcome::right) return extreme;
      if (watch.is_waiting()) point.look_for_clamps(watch, k * dt), extreme.clamps = watch.acted();
      extreme.end = response;
      if (steps == 1) continue;
      const double size = kind == ExtremeKind::volume    ? std::pow(ratio, k)
                          : kind == ExtremeKind::stretch ? std::pow(step(0, 0), k)
                                                         : k * step(0, 1);
      extreme.course.emplace_back(size, response);
    }
    return extreme;
  }

  Extreme must_refuse(std::string name, const Matrix& step) const {
    Extreme extreme = follow(std::move(name), step, 1, 1);
    extreme.must_be_refused = true;
    return extreme;
  }

  /// Small strains to and fro about a state pressed by a hundredth, so slow that no rate gives stress.
  Extreme cycles() const {
    Extreme extreme;
    extreme.name = std::to_string(size_.cycles) + " small cycles";
    constexpr double ages = 1e9;  // s
    MaterialPoint point(material_, dimension_);
    const double inward = std::pow(0.99, 1.0 / 3) - 1;
    point.advance(diagonal(inward, inward, dimension_ == 3 ? inward : 0), 1);
    const Response before = point.advance(Matrix{}, ages);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> between(-1e-4, 1e-4);
    ClampWatch watch(*material_.plugin, material_.parameters);
    for (long k = 0; k < size_.cycles; ++k) {
      Matrix there{}, identity = diagonal(1, 1, 1);
      for (int i = 0; i < dimension_; ++i)
        for (int j = 0; j < dimension_; ++j) there(i, j) = between(random);
      Matrix moved = there;
      for (int i = 0; i < 3; ++i) moved(i, i) += 1;
      Matrix back = inverse(moved);
      for (int k2 = 0; k2 < 9; ++k2) back.m[k2] = (back.m[k2] - identity.m[k2]) / ages, there.m[k2] /= ages;
      for (const Matrix& way : {there, back}) {
        extreme.end = point.advance(way, ages);
        if (watch.is_waiting()) point.look_for_clamps(watch, ages * double(k)), extreme.clamps = watch.acted();
        if (!extreme.end.is_admissible) {
          extreme.outcome = extreme.end.is_taken ? Outcome::not_finite : Outcome::refused;
          return extreme;
        }
      }
    }
    extreme.end = point.advance(Matrix{}, ages);
    extreme.outcome = judge(extreme.end, before.volume_ratio, stiffness_);
    if (extreme.outcome != Outcome::right) return extreme;
    double change = 0;
    for (int c = 0; c < 6; ++c) change = std::max(change, std::abs(extreme.end.kirchhoff.s[c] - before.kirchhoff.s[c]));
    extreme.drift = change / stiffness_ / static_cast<double>(size_.cycles) / std::numeric_limits<double>::epsilon();
    return extreme;
  }

  std::vector<std::function<Extreme()>> all() const {
    const bool flat = dimension_ == 2;
    const int n = size_.steps;
    const double small = size_.smallest_ratio, s = size_.stretch, nan = std::numeric_limits<double>::quiet_NaN();
    const auto even = [flat](double J) {
      const double side = std::pow(J, flat ? 0.5 : 1.0 / 3);
      return diagonal(side, side, flat ? 1 : side);
    };
    const auto drawn = [flat](double stretch) {
      const double side = flat ? 1 / stretch : 1 / std::sqrt(stretch);
      return diagonal(stretch, side, flat ? 1 : side);
    };
    const auto slid = [](double shear) {
      Matrix step = diagonal(1, 1, 1);
      step(0, 1) = shear;
      return step;
    };
    return {[=, this] { return follow("pressed evenly", even(std::pow(small, 1.0 / n)), std::pow(small, 1.0 / n), n); },
            [=, this] { return follow("the same in one step", even(small), small, 1); },
            [=, this] { return follow("torn evenly", even(std::pow(small, -1.0 / n)), std::pow(small, -1.0 / n), n); },
            [=, this] { return follow("the same in one step", even(1 / small), 1 / small, 1); },
            [=, this] { return follow("drawn out", drawn(std::pow(s, 1.0 / n)), 1, n, ExtremeKind::stretch); },
            [=, this] { return follow("the same in one step", drawn(s), 1, 1); },
            [=, this] { return follow("pressed flat", drawn(std::pow(s, -1.0 / n)), 1, n, ExtremeKind::stretch); },
            [=, this] { return follow("the same in one step", drawn(1 / s), 1, 1); },
            [=, this] { return follow("sheared", slid(s / n), 1, n, ExtremeKind::shear); },
            [=, this] { return follow("the same in one step", slid(s), 1, 1); },
            [this] { return must_refuse("turned inside out", diagonal(-1, 1, 1)); },
            [this] { return must_refuse("pressed to nothing", diagonal(0, 1, 1)); },
            [=, this] { return must_refuse("no number", diagonal(nan, 1, 1)); },
            [this] { return cycles(); }};
  }

 private:
  const Component& material_;
  const int dimension_;
  const ExtremeSize size_;
  const double stiffness_;
};

}  // namespace

const char* name_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::right:
      return "right";
    case Outcome::refused:
      return "refused";
    case Outcome::wrong_volume:
      return "WRONG J";
    case Outcome::not_finite:
      return "NOT FINITE";
    default:
      return "NEGATIVE ENERGY";
  }
}

std::string Extreme::outcome_text() const {
  if (must_be_refused && !holds()) return "TAKEN";
  return outcome == Outcome::right && !clamps.empty() ? "right, clamped" : name_of(outcome);
}

std::vector<Extreme> extremes(const Component& material, int dimension, const ExtremeSize& size,
                              const std::function<bool()>& stop) {
  std::vector<Extreme> found;
  const Extremes extremes(material, dimension, size);
  for (const auto& extreme : extremes.all()) {
    if (stop()) break;
    found.push_back(extreme());
  }
  return found;
}

}  // namespace mpm::drive
