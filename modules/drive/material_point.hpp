#pragma once
// One particle of a material by itself: the plugin's state and its plain (scalar, double) entry, which backend reference
// takes too.

#include <array>
#include <string>
#include <vector>

#include "experiment/clamps.hpp"
#include "experiment/experiment.hpp"
#include "kernel/tensor.hpp"
#include "plugin/extensions.h"

namespace mpm::drive {

using Matrix = Mat<3, double>;
using Symmetric = Sym<3, double>;

Matrix inverse(const Matrix& a);

/// What a material answers in one state. Energies are per initial volume.
struct Response {
  Symmetric kirchhoff{};       ///< Pa
  double stored = 0;           ///< J/m^3
  double dissipated = 0;       ///< J/m^3, of the step that led here
  double wave_speed = 0;       ///< m/s
  double volume_ratio = 1;     ///< J
  bool is_taken = false;       ///< the plugin takes the state
  bool is_admissible = false;  ///< and every number is finite

  double cauchy(int i, int j) const { return kirchhoff(i, j) / volume_ratio; }
};

/// A column of the state with its unit: "equivalent_plastic_strain", "plastic_strain xx".
struct StateColumn {
  std::string name, unit;
  std::size_t field;
  int component;
};

/// One particle. Matrices are of three-dimensional space; in two dimensions (plane strain) rows and columns of z are not
/// read. Materials that read a temperature have that of their reference.
class MaterialPoint {
 public:
  /// The particle as a new one is. `material` must outlive it and offer MPM_SCALAR_DOUBLE in this dimension.
  MaterialPoint(const Component& material, int dimension);

  /// The answer in the present state.
  Response look() const;
  /// The answer that a step would give; the state stays.
  Response trial(const Matrix& velocity_gradient, double dt) const;
  /// Advances the state.
  Response advance(const Matrix& velocity_gradient, double dt);

  /// Whether the plugin gives the derivative of its stress (extension mpm.material.tangent).
  bool has_tangent() const { return tangent_ != nullptr; }
  /// The derivative of the trial Kirchhoff stress along a change of the velocity gradient, Pa.
  Symmetric stress_change(const Matrix& velocity_gradient, double dt, const Matrix& direction) const;

  /// Looks which clamps of the material act in the present state.
  void look_for_clamps(ClampWatch& watch, double time) const;

  /// The columns of the state, without the deformation gradient, which the driver knows.
  const std::vector<StateColumn>& columns() const { return columns_; }
  double value(const StateColumn& column) const { return fields_[column.field][column.component][0]; }

 private:
  /// One component of a field: as many equal particles as a batch must have.
  struct alignas(64) Lane : std::array<double, MPM_LANES> {};
  using Field = std::vector<Lane>;

  Response update(std::vector<Field>& fields, const Matrix* velocity_gradient, double dt) const;
  Field lanes_of(const Matrix& matrix) const;
  Symmetric symmetric_of(const Field& field) const;
  static std::vector<void*> pointers_to(std::vector<Field>& fields);

  const Component& material_;
  int dimension_;
  const mpm_material_tangent* tangent_ = nullptr;
  std::vector<Field> fields_;
  std::vector<StateColumn> columns_;
};

}  // namespace mpm::drive
