#pragma once
// A material that is strained once from rest.

#include <span>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"

namespace mpm {

/// Particles of one material and phase, each at rest and then strained by F - I, so slowly that no
/// stress depends on the rate.
class MaterialAtRest {
 public:
  /// `temperature` may be empty: the material's reference temperature.
  MaterialAtRest(const Experiment& experiment, const Plugin& material, const std::vector<double>& parameters,
                 std::vector<double> temperature, std::size_t count);

  /// Strains all particles anew. Returns whether all stay admissible; `first_inverted` is one that does not.
  bool strain(std::span<const std::array<double, 9>> F);
  std::size_t first_inverted() const { return first_inverted_; }
  /// Cauchy stress as the boundary orders it: xx yy zz xy, or xx yy zz yz xz xy, Pa.
  double cauchy(std::size_t p, int component) const { return stress_[component * stride_ + p] / volume_ratio_[p]; }
  double state(std::size_t field, std::size_t p, std::size_t component) const {
    return fields_[field][component * stride_ + p];
  }
  std::size_t components(std::size_t field) const { return fields_[field].size() / stride_; }

 private:
  const Experiment& experiment_;
  const Plugin& material_;
  const std::vector<double>& parameters_;
  std::size_t count_, stride_, first_inverted_ = 0;
  std::vector<double> temperature_, gradient_, around_, stress_, volume_ratio_;
  std::vector<std::vector<double>> rest_, fields_;  ///< [component][stride]
};

/// Finds symmetric deformation gradients with which the material has these Cauchy stresses, [6] xx yy zz yz xz xy, Pa. In
/// plane strain zz is free. Returns the first particle for which none is found, or the count.
std::size_t deform_to_stress(const Experiment& experiment, MaterialAtRest& material,
                             std::span<const std::array<double, 6>> stress, std::span<std::array<double, 9>> F);

}  // namespace mpm
