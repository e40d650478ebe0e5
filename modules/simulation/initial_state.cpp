#include "simulation/initial_state.hpp"

#include <cmath>

#include "experiment/diagnostics.hpp"
#include "plugin/extension_of.hpp"
#include "simulation/material_at_rest.hpp"

namespace mpm {

void refuse_body(const Experiment& experiment, const BodySpecification& body, const std::string& key,
                 const std::string& message) {
  throw InputError({problem_at(experiment, body.pointer + key, message)});
}

Vector3 InitialState::undeformed(std::size_t p, std::size_t axis) const {
  const std::array<double, 9>& F = displaced_[p];
  const auto minor = [&](std::size_t i, std::size_t j) {
    const std::size_t a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
    return F[3 * a + c] * F[3 * b + d] - F[3 * a + d] * F[3 * b + c];
  };
  const double determinant = F[0] * minor(0, 0) + F[1] * minor(0, 1) + F[2] * minor(0, 2);
  return {minor(axis, 0) / determinant, minor(axis, 1) / determinant, minor(axis, 2) / determinant};
}

/// Takes the displacement's gradient by central differences; around an axis rings are stretched by u_r / R.
void InitialState::differentiate(std::span<const Vector3> X) {
  const std::array<double, 9> identity{1, 0, 0, 0, 1, 0, 0, 0, 1};
  displaced_.assign(X.size(), identity);
  if (!body_.displacement) return;
  const int D = experiment_.dimension;
  const double step = 1e-4 * experiment_.grid.cell_size;
  std::vector<Vector3> front(X.size()), back(X.size());
  for (int axis = 0; axis < D; ++axis) {
    std::vector<Vector3> to(X.begin(), X.end()), from = to;
    for (std::size_t p = 0; p < X.size(); ++p) to[p][axis] += step, from[p][axis] -= step;
    body_.displacement->evaluate(to, to, 0, front);
    body_.displacement->evaluate(from, from, 0, back);
    for (std::size_t p = 0; p < X.size(); ++p)
      for (int c = 0; c < D; ++c)
        displaced_[p][3 * c + axis] += (front[p][c] - back[p][c]) / (to[p][axis] - from[p][axis]);
  }
}

void InitialState::take_given(std::span<const Vector3> X) {
  if (!body_.deformation_gradient) return;
  static constexpr const char* names[] = {"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};
  for (std::size_t p = 0; p < X.size(); ++p)
    for (std::size_t k = 0; k < 9; ++k) {
      const ScalarExpression& component = (*body_.deformation_gradient)[k];
      F_[p][k] = component(X[p], X[p], 0);
      if (!std::isfinite(F_[p][k]))
        refuse_not_finite(experiment_, body_, {std::string("/initial_deformation_gradient/") + names[k]}, component,
                          X[p]);
    }
}

void InitialState::find(std::span<const Vector3> X, std::span<const Vector3> x, std::span<const double> temperature,
                        std::span<const double> melted) {
  differentiate(X);
  F_ = displaced_;
  for (std::size_t p = 0; experiment_.axisymmetric() && p < X.size(); ++p) F_[p][8] = x[p][0] / X[p][0];
  take_given(X);
  fields_.clear();
  for (const bool liquid : {false, true}) {
    std::vector<std::size_t> chosen;
    for (std::size_t p = 0; p < X.size(); ++p)
      if (liquid == (!melted.empty() && melted[p] > 0.5)) chosen.push_back(p);
    if (!chosen.empty()) strain(X, temperature, chosen, liquid);
  }
}

/// Strains the chosen particles, which are all of one phase.
void InitialState::strain(std::span<const Vector3> X, std::span<const double> temperature,
                          const std::vector<std::size_t>& chosen, bool liquid) {
  const MaterialSpecification& material = experiment_.materials[body_.material];
  const Plugin& plugin = *material.component.plugin;
  std::vector<double> warm;
  if (!temperature.empty() && extension_of<mpm_material_temperature>(plugin))
    for (const std::size_t p : chosen) warm.push_back(temperature[p]);
  MaterialAtRest rest(experiment_, plugin,
                      liquid ? material.thermal->phase_change->melted_parameters : material.component.parameters, warm,
                      chosen.size());
  std::vector<std::array<double, 9>> F;
  for (const std::size_t p : chosen) F.push_back(F_[p]);
  if (body_.stress) take_stress(X, chosen, rest, F);
  if (!rest.strain(F))
    refuse_body(experiment_, body_,
                body_.deformation_gradient ? "/initial_deformation_gradient"
                : body_.displacement       ? "/initial_displacement"
                                           : "/initial_stress",
                "turns a particle of material " + in_quotes(material.name) + " inside out, or is no number, at " +
                    point_text(experiment_, X[chosen[rest.first_inverted()]]));
  std::size_t number = 0;
  for (const mpm_state& declared : plugin.state()) {
    const std::size_t components = rest.components(number);
    std::vector<double>& values = fields_[declared.name];
    values.resize(X.size() * components);
    for (std::size_t k = 0; k < chosen.size(); ++k)
      for (std::size_t c = 0; c < components; ++c) values[chosen[k] * components + c] = rest.state(number, k, c);
    ++number;
  }
  for (std::size_t k = 0; k < chosen.size(); ++k) F_[chosen[k]] = F[k];
}

void InitialState::take_stress(std::span<const Vector3> X, const std::vector<std::size_t>& chosen, MaterialAtRest& rest,
                               std::vector<std::array<double, 9>>& F) const {
  static constexpr const char* names[] = {"xx", "yy", "zz", "yz", "xz", "xy"};
  std::vector<std::array<double, 6>> stress(chosen.size());
  for (std::size_t k = 0; k < chosen.size(); ++k)
    for (std::size_t c = 0; c < 6; ++c) {
      const Vector3& place = X[chosen[k]];
      stress[k][c] = (*body_.stress)[c](place, place, 0);
      if (!std::isfinite(stress[k][c]))
        refuse_not_finite(experiment_, body_, {std::string("/initial_stress/") + names[c]}, (*body_.stress)[c], place);
    }
  const std::size_t failed = deform_to_stress(experiment_, rest, stress, F);
  if (failed == chosen.size()) return;
  refuse_body(experiment_, body_, "/initial_stress",
              "no deformation from rest gives material " + in_quotes(experiment_.materials[body_.material].name) +
                  " this stress at " + point_text(experiment_, X[chosen[failed]]) +
                  ": the material yields before, or is not stiff enough");
}

}  // namespace mpm
