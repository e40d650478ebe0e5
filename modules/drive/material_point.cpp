#include "drive/material_point.hpp"

#include <cmath>
#include <string_view>

#include "plan/field_list.hpp"
#include "plugin/extension_of.hpp"

namespace mpm::drive {
namespace {

/// The letters of a state field's component, behind a blank; none for a scalar.
std::string letters(mpm_state_shape shape, int component, int dimension) {
  constexpr const char *axes[] = {" x", " y", " z"}, *plane[] = {" xx", " xy", " yx", " yy", " zz"},
                       *space[] = {" xx", " xy", " xz", " yx", " yy", " yz", " zx", " zy", " zz"},
                       *flat[] = {" xx", " yy", " zz", " xy"}, *full[] = {" xx", " yy", " zz", " yz", " xz", " xy"};
  switch (shape) {
    case MPM_STATE_SCALAR:
      return "";
    case MPM_STATE_VECTOR:
      return axes[component];
    case MPM_STATE_SYMMETRIC:
      return (dimension == 2 ? flat : full)[component];
    default:
      return (dimension == 2 ? plane : space)[component];
  }
}

}  // namespace

Matrix inverse(const Matrix& a) {
  Matrix r;
  const double over = 1 / determinant(a);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int p = (j + 1) % 3, q = (j + 2) % 3, s = (i + 1) % 3, t = (i + 2) % 3;
      r(i, j) = over * (a(p, s) * a(q, t) - a(p, t) * a(q, s));
    }
  return r;
}

MaterialPoint::MaterialPoint(const Component& material, int dimension) : material_(material), dimension_(dimension) {
  const auto* tangent = extension_of<mpm_material_tangent>(*material.plugin);
  if (tangent && !tangent->refusal && tangent->evaluate[MPM_SCALAR_DOUBLE][dimension - 2]) tangent_ = tangent;
  for (const mpm_state& declared : material.plugin->state()) {
    const mpm_state_shape shape = kept_shape(declared, false);
    const int components = state_components(shape, dimension);
    mpm::Field first;
    first.first = FieldList::first_of(declared);
    Field& field = fields_.emplace_back(components);
    const bool is_known = std::string_view(declared.name) == "deformation_gradient";
    for (int k = 0; k < components; ++k) {
      field[k].fill(first_value(first, k, dimension, 0));
      if (!is_known)
        columns_.push_back({declared.name + letters(shape, k, dimension), declared.unit, fields_.size() - 1, k});
    }
  }
}

MaterialPoint::Field MaterialPoint::lanes_of(const Matrix& matrix) const {
  Field field(dimension_ * dimension_);
  for (int i = 0; i < dimension_; ++i)
    for (int j = 0; j < dimension_; ++j) field[i * dimension_ + j].fill(matrix(i, j));
  return field;
}

Symmetric MaterialPoint::symmetric_of(const Field& field) const {
  Symmetric result{};
  for (int i = 0; i < 3; ++i) result(i, i) = field[i][0];
  if (dimension_ == 2)
    result(0, 1) = field[3][0];
  else
    for (int k = 3; k < 6; ++k) result.s[k] = field[k][0];
  return result;
}

std::vector<void*> MaterialPoint::pointers_to(std::vector<Field>& fields) {
  std::vector<void*> pointers;
  for (Field& field : fields) pointers.push_back(field.data());
  return pointers;
}

Response MaterialPoint::update(std::vector<Field>& fields, const Matrix* velocity_gradient, double dt) const {
  Field gradient, stress(dimension_ == 2 ? 4 : 6), scalars(4);
  std::vector<void*> state = pointers_to(fields);
  mpm_material_batch batch{};
  batch.count = batch.stride = MPM_LANES;
  batch.dimension = static_cast<std::uint32_t>(dimension_);
  batch.dt = dt;
  if (velocity_gradient) gradient = lanes_of(*velocity_gradient), batch.velocity_gradient = gradient.data();
  batch.state = state.data();
  batch.kirchhoff_stress = stress.data();
  batch.stored_energy = &scalars[0];
  batch.dissipated_energy = &scalars[1];
  batch.wave_speed = &scalars[2];
  batch.volume_ratio = &scalars[3];
  const auto& entry = material_.plugin->material().update[MPM_SCALAR_DOUBLE][dimension_ - 2];
  Response response;
  response.is_taken = entry(material_.parameters.data(), &batch) < 0;
  response.is_admissible = response.is_taken;
  response.kirchhoff = symmetric_of(stress);
  response.stored = scalars[0][0];
  response.dissipated = velocity_gradient ? scalars[1][0] : 0;
  response.wave_speed = scalars[2][0];
  response.volume_ratio = scalars[3][0];
  for (const double value : {response.stored, response.dissipated, response.wave_speed, response.volume_ratio})
    response.is_admissible &= std::isfinite(value);
  for (const double value : response.kirchhoff.s) response.is_admissible &= std::isfinite(value);
  return response;
}

Response MaterialPoint::look() const {
  std::vector<Field> copy = fields_;
  return update(copy, nullptr, 0);
}

Response MaterialPoint::trial(const Matrix& velocity_gradient, double dt) const {
  std::vector<Field> copy = fields_;
  return update(copy, &velocity_gradient, dt);
}

Response MaterialPoint::advance(const Matrix& velocity_gradient, double dt) {
  return update(fields_, &velocity_gradient, dt);
}

void MaterialPoint::look_for_clamps(ClampWatch& watch, double time) const {
  std::vector<Field> copy = fields_;
  const std::vector<void*> state = pointers_to(copy);
  mpm_clamp_batch batch{};
  batch.count = 1, batch.stride = MPM_LANES;
  batch.dimension = static_cast<std::uint32_t>(dimension_);
  batch.state = state.data();
  watch.look(batch, time);
}

Symmetric MaterialPoint::stress_change(const Matrix& velocity_gradient, double dt, const Matrix& direction) const {
  std::vector<Field> copy = fields_;
  const std::vector<void*> pointers = pointers_to(copy);
  const std::vector<const void*> state(pointers.begin(), pointers.end());
  const Field gradient = lanes_of(velocity_gradient), change = lanes_of(direction);
  Field stress(dimension_ == 2 ? 4 : 6);
  mpm_tangent_batch batch{};
  batch.count = batch.stride = MPM_LANES;
  batch.dimension = static_cast<std::uint32_t>(dimension_);
  batch.dt = dt;
  batch.velocity_gradient = gradient.data();
  batch.direction = change.data();
  batch.state = state.data();
  batch.stress_change = stress.data();
  tangent_->evaluate[MPM_SCALAR_DOUBLE][dimension_ - 2](material_.parameters.data(), &batch);
  return symmetric_of(stress);
}

}  // namespace mpm::drive
