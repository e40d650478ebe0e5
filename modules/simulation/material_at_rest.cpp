#include "simulation/material_at_rest.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "plan/field_list.hpp"
#include "plugin/extension_of.hpp"

namespace mpm {
namespace {

/// The time within which a material is strained to its first state, s: so long that what relaxes has relaxed and no stress
/// is left of the rate. A power of two changes no bit of the strain.
constexpr double ages = 0x1p40;

}  // namespace

MaterialAtRest::MaterialAtRest(const Experiment& experiment, const Plugin& material,
                               const std::vector<double>& parameters, std::vector<double> temperature,
                               std::size_t count)
    : experiment_(experiment),
      material_(material),
      parameters_(parameters),
      count_(count),
      stride_((count + MPM_LANES - 1) / MPM_LANES * MPM_LANES),
      temperature_(std::move(temperature)) {
  const int D = experiment.dimension;
  gradient_.resize(stride_ * D * D), around_.resize(stride_), volume_ratio_.resize(stride_);
  stress_.resize(stride_ * (D == 2 ? 4 : 6));
  if (!temperature_.empty()) temperature_.resize(stride_, temperature_.back());
  for (const mpm_state& declared : material.state()) {
    const int components = state_components(kept_shape(declared, experiment.axisymmetric()), D);
    Field field;
    field.first = FieldList::first_of(declared);
    std::vector<double>& values = rest_.emplace_back();
    for (int k = 0; k < components; ++k) values.insert(values.end(), stride_, first_value(field, k, D, 0));
  }
}

bool MaterialAtRest::strain(std::span<const std::array<double, 9>> F) {
  const auto D = static_cast<std::size_t>(experiment_.dimension);
  for (std::size_t k = 0; k < stride_; ++k) {
    const std::array<double, 9>& of = F[std::min(k, count_ - 1)];  // the last one pads
    for (std::size_t i = 0; i < D; ++i)
      for (std::size_t j = 0; j < D; ++j)
        gradient_[(i * D + j) * stride_ + k] = (of[3 * i + j] - (i == j ? 1 : 0)) / ages;
    around_[k] = (of[8] - 1) / ages;
  }
  fields_ = rest_;
  std::vector<void*> pointers;
  for (auto& field : fields_) pointers.push_back(field.data());
  mpm_material_batch batch{};
  batch.count = batch.stride = static_cast<std::uint32_t>(stride_);
  batch.dimension = static_cast<std::uint32_t>(D);
  batch.dt = ages;
  batch.velocity_gradient = gradient_.data();
  if (experiment_.axisymmetric()) batch.velocity_gradient_zz = around_.data();
  if (!temperature_.empty()) batch.temperature = temperature_.data();
  batch.state = pointers.data();
  batch.kirchhoff_stress = stress_.data();
  batch.volume_ratio = volume_ratio_.data();
  const std::int32_t inverted = material_.material().update[MPM_SCALAR_DOUBLE][D - 2](parameters_.data(), &batch);
  first_inverted_ = inverted < 0 ? count_ : std::min(static_cast<std::size_t>(inverted), count_ - 1);
  for (std::size_t p = 0; p < first_inverted_ && p < count_; ++p)
    if (!(volume_ratio_[p] > 0)) first_inverted_ = p;
  return first_inverted_ == count_;
}

namespace {

/// Newton's method for one symmetric F a particle, all particles at once; derivatives by differences.
class StressSolver {
 public:
  StressSolver(const Experiment& experiment, MaterialAtRest& material, std::span<const std::array<double, 6>> stress,
               std::span<std::array<double, 9>> F)
      : material_(material), wanted_(stress), F_(F) {
    if (experiment.dimension == 3)
      entries_ = {{0, 0, 0, 0}, {1, 1, 1, 1}, {2, 2, 2, 2}, {1, 2, 3, 3}, {0, 2, 4, 4}, {0, 1, 5, 5}};
    else
      entries_ = {{0, 0, 0, 0}, {1, 1, 1, 1}, {0, 1, 3, 5}};
    if (experiment.axisymmetric()) entries_.push_back({2, 2, 2, 2});
  }

  std::size_t solve() {
    residuals_.resize(F_.size()), slopes_.resize(F_.size());
    for (int round = 0; round < most_rounds; ++round) {
      if (!material_.strain(F_)) return material_.first_inverted();
      for (std::size_t p = 0; p < F_.size(); ++p) residuals_[p] = residual(p);
      find_slopes();
      std::size_t open = F_.size();
      for (std::size_t p = F_.size(); p-- > 0;)
        if (!reached(p)) open = p, advance(p);
      if (open == F_.size()) return open;
      last_open_ = open;
    }
    return last_open_;
  }

 private:
  static constexpr int most_rounds = 40;
  static constexpr double step = 1e-6, longest = 0.1;  ///< of entries of F
  struct Entry {
    int i, j, of_boundary, of_file;  ///< of F, and the component of the stress here and there
  };
  using Values = std::array<double, 6>;

  Values residual(std::size_t p) const {
    Values r{};
    for (std::size_t k = 0; k < entries_.size(); ++k)
      r[k] = material_.cauchy(p, entries_[k].of_boundary) - wanted_[p][entries_[k].of_file];
    return r;
  }

  void find_slopes() {
    std::vector<std::array<double, 9>> there(F_.begin(), F_.end());
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      const auto [i, j, of_boundary, of_file] = entries_[k];
      for (const double side : {step, -step}) {
        for (std::size_t p = 0; p < F_.size(); ++p) {
          there[p] = F_[p];
          there[p][3 * i + j] += side;
          if (i != j) there[p][3 * j + i] += side;
        }
        material_.strain(there);
        for (std::size_t p = 0; p < F_.size(); ++p)
          for (std::size_t m = 0; m < entries_.size(); ++m) {
            double& slope = slopes_[p][m][k];
            slope = (side > 0 ? 0 : slope) + material_.cauchy(p, entries_[m].of_boundary) / (2 * side);
          }
      }
    }
  }

  /// Up to 1e-10 of the stress that is wanted and what rounding leaves of stiff materials.
  bool reached(std::size_t p) const {
    double wanted = 0, stiffness = 0, off = 0;
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      if (!std::isfinite(wanted_[p][entries_[k].of_file]) || !std::isfinite(residuals_[p][k])) return false;
      wanted = std::max(wanted, std::abs(wanted_[p][entries_[k].of_file]));
      off = std::max(off, std::abs(residuals_[p][k]));
      for (std::size_t m = 0; m < entries_.size(); ++m) stiffness = std::max(stiffness, std::abs(slopes_[p][k][m]));
    }
    return off <= 1e-10 * wanted + 1e-14 * stiffness;
  }

  /// Takes Newton's step, shortened where it would be long.
  void advance(std::size_t p) {
    const std::size_t n = entries_.size();
    double matrix[6][7] = {};
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b < n; ++b) matrix[a][b] = slopes_[p][a][b];
      matrix[a][n] = -residuals_[p][a];
    }
    for (std::size_t a = 0; a < n; ++a) {  // Gauss, the largest entry first
      std::size_t best = a;
      for (std::size_t b = a; b < n; ++b)
        if (std::abs(matrix[b][a]) > std::abs(matrix[best][a])) best = b;
      std::swap(matrix[a], matrix[best]);
      if (matrix[a][a] == 0) return;  // no step: the particle stays open
      for (std::size_t b = 0; b < n; ++b) {
        const double factor = b == a ? 0 : matrix[b][a] / matrix[a][a];
        for (std::size_t c = a; c <= n; ++c) matrix[b][c] -= factor * matrix[a][c];
      }
    }
    double largest = 0;
    for (std::size_t k = 0; k < n; ++k) largest = std::max(largest, std::abs(matrix[k][n] / matrix[k][k]));
    if (!std::isfinite(largest)) return;
    const double share = largest > longest ? longest / largest : 1;
    for (std::size_t k = 0; k < n; ++k) {
      const double change = share * matrix[k][n] / matrix[k][k];
      F_[p][3 * entries_[k].i + entries_[k].j] += change;
      if (entries_[k].i != entries_[k].j) F_[p][3 * entries_[k].j + entries_[k].i] += change;
    }
  }

  MaterialAtRest& material_;
  std::span<const std::array<double, 6>> wanted_;
  std::span<std::array<double, 9>> F_;
  std::vector<Entry> entries_;
  std::vector<Values> residuals_;
  std::vector<std::array<Values, 6>> slopes_;
  std::size_t last_open_ = 0;
};

}  // namespace

std::size_t deform_to_stress(const Experiment& experiment, MaterialAtRest& material,
                             std::span<const std::array<double, 6>> stress, std::span<std::array<double, 9>> F) {
  std::fill(F.begin(), F.end(), std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1});
  return StressSolver(experiment, material, stress, F).solve();
}

}  // namespace mpm
