#pragma once
// The deformation and the state of material that particles begin with.

#include <array>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "simulation/formula_problem.hpp"

namespace mpm {

class MaterialAtRest;

/// Finds what a body's particles begin with, a batch at a time. F is I + grad u of the initial displacement, or what the
/// file gives, or what makes the material have the given stress. The material's state is that after one strain from rest,
/// so slowly that no stress depends on the rate.
class InitialState {
 public:
  InitialState(const Experiment& experiment, int body) : experiment_(experiment), body_(experiment.bodies[body]) {}

  /// `X` are the undeformed places, `x` those after the displacement; temperatures and melted fractions may be empty.
  /// Throws InputError.
  void find(std::span<const Vector3> X, std::span<const Vector3> x, std::span<const double> temperature,
            std::span<const double> melted);

  const std::array<double, 9>& deformation_gradient(std::size_t p) const { return F_[p]; }
  /// Where a step along an axis comes from: column `axis` of (I + grad u)^-1.
  Vector3 undeformed(std::size_t p, std::size_t axis) const;
  /// The material's state by name, particle-major.
  const std::map<std::string, std::vector<double>>& fields() const { return fields_; }

 private:
  void differentiate(std::span<const Vector3> X);
  void take_given(std::span<const Vector3> X);
  void strain(std::span<const Vector3> X, std::span<const double> temperature, const std::vector<std::size_t>& chosen,
              bool liquid);
  void take_stress(std::span<const Vector3> X, const std::vector<std::size_t>& chosen, MaterialAtRest& rest,
                   std::vector<std::array<double, 9>>& F) const;

  const Experiment& experiment_;
  const BodySpecification& body_;
  std::vector<std::array<double, 9>> F_, displaced_;  ///< row-major 3 x 3; I + grad u
  std::map<std::string, std::vector<double>> fields_;
};

/// Throws InputError at a key of a body.
[[noreturn]] void refuse_body(const Experiment& experiment, const BodySpecification& body, const std::string& key,
                              const std::string& message);
/// A key of a body under which a formula stands, or a list of them.
struct BodyKey {
  std::string name;
  bool is_list = false;
};
/// Throws InputError where a formula of the place X that a particle has before it is moved, m, gives no finite number.
template <class Expression>
void refuse_not_finite(const Experiment& experiment, const BodySpecification& body, const BodyKey& key,
                       const Expression& expression, const Vector3& X) {
  if (const auto found = expression.not_finite(X, X, 0))
    refuse_body(experiment, body, pointer_of(key.name, key.is_list, found->component),
                not_finite_text(point_text(experiment, X), found->why));
}

}  // namespace mpm
