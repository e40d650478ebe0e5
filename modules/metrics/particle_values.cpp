#include "metrics/particle_values.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>

#include "experiment/polynomials.hpp"
#include "metrics/particle_domain.hpp"
#include "metrics/particle_quantities.hpp"

namespace mpm {
namespace {

using Shape = ParticleField::Shape;

std::size_t size_of(Shape shape) {
  return static_cast<std::size_t>(shape);
}

/// Where each of the nine components of a tensor stands among the numbers that are kept; -1: it is zero, -2: one.
std::array<int, 9> places_of(std::uint32_t kept, bool plane_deformation, int dimension) {
  if (kept == MPM_STATE_SYMMETRIC)
    return dimension == 2 ? std::array<int, 9>{0, 3, -1, 3, 1, -1, -1, -1, 2}
                          : std::array<int, 9>{0, 5, 4, 5, 1, 3, 4, 3, 2};
  if (dimension == 3) return {0, 1, 2, 3, 4, 5, 6, 7, 8};
  const int across = kept == MPM_STATE_DEFORMATION ? 4 : plane_deformation ? -2 : -1;
  return {0, 1, -1, 2, 3, -1, -1, -1, across};
}

/// One body's state with what is asked of it more than once.
class Body {
 public:
  Body(const Experiment& experiment, int body, const BodyState& state)
      : experiment_(experiment), body_(body), state_(state), D_(static_cast<std::size_t>(experiment.dimension)) {}

  std::size_t count() const { return state_.position.size() / D_; }

  void append(const ParticleField& field, std::vector<double>& out) {
    const std::size_t start = out.size(), n = count(), width = size_of(field.shape);
    out.resize(start + n * width, std::numeric_limits<double>::quiet_NaN());
    double* to = out.data() + start;
    const auto each = [&](const std::function<double(std::size_t)>& value) {
      for (std::size_t p = 0; p < n; ++p) to[p] = value(p);
    };
    const std::string& name = field.name;
    if (name == "velocity") return vectors(state_.velocity, to);
    if (name == "initial_position") return vectors(state_.initial_position, to);
    if (name == "displacement") return displacements(to);
    if (name == "cauchy_stress" || name == "kirchhoff_stress") return stresses(name == "cauchy_stress", to);
    if (name == "mass") return each([&](std::size_t p) { return state_.mass * state_.size_of(p); });
    if (name == "volume")
      return each([&](std::size_t p) { return state_.volume * state_.size_of(p) * material().volume_ratio[p]; });
    if (name == "volume_ratio") return each([&](std::size_t p) { return material().volume_ratio[p]; });
    if (name == "stored_energy") return each([&](std::size_t p) { return material().stored_energy[p]; });
    if (name == "wave_speed") return each([&](std::size_t p) { return material().wave_speed[p]; });
    if (name == "pressure") return each([&](std::size_t p) { return pressure(p); });
    if (name == "von_mises_stress") return each([&](std::size_t p) { return von_mises(p); });
    if (name == "body" || name == "speed") {
      const std::vector<double> values = quantity(experiment_, body_, state_, name);
      std::copy(values.begin(), values.end(), to);
      return;
    }
    if (const auto kept = state_.host_state.find(name); kept != state_.host_state.end()) {
      std::copy(kept->second.begin(), kept->second.end(), to);
      return;
    }
    const Component& own = experiment_.materials[experiment_.bodies[body_].material].component;
    for (const mpm_state& declared : experiment_.contact_state())
      if (name == declared.name) {
        const std::vector<double> values = quantity(experiment_, body_, state_, name);
        std::copy(values.begin(), values.end(), to);
        return;
      }
    if (!plugin_state(*own.plugin, state_.material_state, name, to) &&
        !plugin_state(*experiment_.transfer.plugin, state_.transfer_state, name, to))
      coefficients(name, to);
  }

  /// The two or three semi-sides of the particle's parallelogram, m, and the corners where the shape carries them.
  void append_domain(std::size_t p, std::vector<double>& out) const {
    // The corners in VTK's order: around the lower face, then around the upper one.
    constexpr int around[8] = {0, 1, 3, 2, 4, 5, 7, 6};
    const std::size_t corners = D_ == 2 ? 4 : 8;
    const std::array<double, 9> sides = semi_sides(experiment_, body_, state_, p);
    for (std::size_t k = 0; k < corners; ++k) {
      const auto c = static_cast<std::size_t>(around[k]);  // at the upper end along axis a where bit a is set
      for (std::size_t i = 0; i < 3; ++i) {
        double x = i < D_ ? state_.position[p * D_ + i] : 0;
        if (i < D_ && !state_.corners.empty()) {
          x += state_.corners[(p * corners + c) * D_ + i];
        } else if (i < D_) {
          for (std::size_t a = 0; a < D_; ++a) x += (c >> a & 1 ? 1 : -1) * sides[3 * i + a];
        }
        out.push_back(x);
      }
    }
  }

 private:
  const MaterialQuantities& material() {
    if (!material_) material_ = material_quantities(experiment_, body_, state_);
    return *material_;
  }
  const double* tau(std::size_t p) { return &material().stress[p * (D_ == 2 ? 4 : 6)]; }

  double pressure(std::size_t p) {
    const double* t = tau(p);
    return -(t[0] + t[1] + t[2]) / 3 / material().volume_ratio[p];
  }
  double von_mises(std::size_t p) {
    const double *t = tau(p), mean = (t[0] + t[1] + t[2]) / 3;
    double norm = 0;
    for (int i = 0; i < 3; ++i) norm += (t[i] - mean) * (t[i] - mean);
    for (int i = 3; i < (D_ == 2 ? 4 : 6); ++i) norm += 2 * t[i] * t[i];
    return std::sqrt(1.5 * norm) / material().volume_ratio[p];
  }

  void vectors(const std::vector<double>& values, double* to) const {
    for (std::size_t p = 0; p < count() && !values.empty(); ++p)
      for (std::size_t i = 0; i < 3; ++i) to[3 * p + i] = i < D_ ? values[p * D_ + i] : 0;
  }

  void displacements(double* to) const {
    if (state_.initial_position.empty()) return;
    for (std::size_t p = 0; p < count(); ++p)
      for (std::size_t i = 0; i < 3; ++i)
        to[3 * p + i] = i < D_ ? state_.position[p * D_ + i] - state_.initial_position[p * D_ + i] : 0;
  }

  void stresses(bool cauchy, double* to) {
    const auto places = places_of(MPM_STATE_SYMMETRIC, false, static_cast<int>(D_));
    for (std::size_t p = 0; p < count(); ++p) {
      const double over = cauchy ? material().volume_ratio[p] : 1;
      for (std::size_t k = 0; k < 9; ++k) to[9 * p + k] = places[k] < 0 ? 0 : tau(p)[places[k]] / over;
    }
  }

  /// Takes a declared state; false when the plugin has none of this name.
  bool plugin_state(const Plugin& plugin, const std::map<std::string, std::vector<double>>& states,
                    const std::string& name, double* to) const {
    for (const mpm_state& declared : plugin.state()) {
      if (name != declared.name) continue;
      const std::vector<double>& values = states.at(name);
      const mpm_state_shape kept = kept_shape(declared, experiment_.axisymmetric());
      const auto components = static_cast<std::size_t>(state_components(kept, static_cast<int>(D_)));
      if (kept == MPM_STATE_VECTOR) return vectors(values, to), true;
      if (kept == MPM_STATE_SCALAR) return std::copy(values.begin(), values.end(), to), true;
      const auto places = places_of(kept, declared.shape == MPM_STATE_PLANE_DEFORMATION, static_cast<int>(D_));
      for (std::size_t p = 0; p < count(); ++p)
        for (std::size_t k = 0; k < 9; ++k)
          to[9 * p + k] =
              places[k] < 0 ? (places[k] == -2 ? 1 : 0) : values[p * components + static_cast<std::size_t>(places[k])];
      return true;
    }
    return false;
  }

  /// Takes those of a polynomial beyond the affine ones, which the host keeps for the transfer, all of a particle together.
  void coefficients(const std::string& name, double* to) const {
    const std::vector<std::string> names = polynomial_names(experiment_);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) return;
    const std::vector<double>& values = state_.transfer_state.at(polynomial_coefficients);
    const std::size_t first = static_cast<std::size_t>(found - names.begin()) * D_, all = names.size() * D_;
    for (std::size_t p = 0; p < count() && !values.empty(); ++p)
      for (std::size_t i = 0; i < 3; ++i) to[3 * p + i] = i < D_ ? values[p * all + first + i] : 0;
  }

  const Experiment& experiment_;
  int body_;
  const BodyState& state_;
  std::size_t D_;
  std::optional<MaterialQuantities> material_;
};

std::vector<Body> bodies_of(const Experiment& experiment, const std::vector<BodyState>& states) {
  std::vector<Body> bodies;
  for (std::size_t body = 0; body < states.size(); ++body)
    bodies.emplace_back(experiment, static_cast<int>(body), states[body]);
  return bodies;
}

}  // namespace

std::vector<ParticleValues> particle_values(const Experiment& experiment, const std::vector<BodyState>& states,
                                            const std::vector<std::string>& names) {
  std::vector<ParticleValues> all;
  const std::vector<ParticleField> known = particle_fields(experiment);
  std::vector<Body> bodies = bodies_of(experiment, states);
  for (const std::string& name : names) {
    const auto field = std::find_if(known.begin(), known.end(), [&](const auto& one) { return one.name == name; });
    ParticleValues values{*field, {}};
    for (Body& body : bodies) body.append(*field, values.values);
    all.push_back(std::move(values));
  }
  return all;
}

std::vector<double> particle_positions(const Experiment& experiment, const std::vector<BodyState>& states) {
  const auto D = static_cast<std::size_t>(experiment.dimension);
  std::vector<double> positions;
  for (const BodyState& state : states)
    for (std::size_t k = 0; k < state.position.size(); k += D)
      for (std::size_t i = 0; i < 3; ++i) positions.push_back(i < D ? state.position[k + i] : 0);
  return positions;
}

std::vector<double> particle_domains(const Experiment& experiment, const std::vector<BodyState>& states) {
  std::vector<double> corners;
  for (const Body& body : bodies_of(experiment, states))
    for (std::size_t p = 0; p < body.count(); ++p) body.append_domain(p, corners);
  return corners;
}

}  // namespace mpm
