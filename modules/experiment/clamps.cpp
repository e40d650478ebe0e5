#include "experiment/clamps.hpp"

#include <algorithm>
#include <cmath>

#include "plugin/extension_of.hpp"
#include "support/numbers.hpp"

namespace mpm {
ClampWatch::ClampWatch(const Plugin& material, const std::vector<double>& parameters)
    : material_(&material), parameters_(&parameters), table_(extension_of<mpm_material_clamps>(material)) {
  if (!table_) return;
  const std::size_t count = std::min(table_->count, MPM_CLAMPS);
  bounds_.resize(count), seen_.resize(count);
  table_->bounds(parameters.data(), bounds_.data());
}

bool ClampWatch::is_waiting() const {
  for (std::size_t k = 0; k < seen_.size(); ++k)
    if (seen_[k].particles == 0 && !std::isnan(bounds_[k])) return true;
  return false;
}

void ClampWatch::look(mpm_clamp_batch batch, double time) {
  if (!is_waiting() || batch.count == 0) return;
  std::vector<std::uint32_t> acting(batch.stride);
  batch.acting = acting.data();
  table_->find[batch.dimension - 2](parameters_->data(), &batch);
  for (std::size_t k = 0; k < seen_.size(); ++k) {
    if (seen_[k].particles > 0) continue;
    const long particles =
        std::count_if(acting.begin(), acting.begin() + batch.count, [&](std::uint32_t bits) { return bits >> k & 1; });
    if (particles > 0) seen_[k] = {time, particles};
  }
}

void ClampWatch::set_seen(std::span<const Seen> seen) {
  std::copy_n(seen.begin(), std::min(seen.size(), seen_.size()), seen_.begin());
}

std::string ClampWatch::text_of(std::size_t k) const {
  const mpm_clamp& clamp = table_->clamps[k];
  return std::string(clamp.where) + " " + support::three_digits(bounds_[k]) + clamp.unit + ", " + clamp.what;
}

std::vector<std::string> ClampWatch::acted() const {
  std::vector<std::string> all;
  for (std::size_t k = 0; k < seen_.size(); ++k)
    if (seen_[k].particles > 0) all.push_back(text_of(k));
  return all;
}

std::vector<std::string> ClampWatch::warnings(const std::string& name) const {
  std::vector<std::string> all;
  for (std::size_t k = 0; k < seen_.size(); ++k) {
    if (seen_[k].particles == 0) continue;
    all.push_back("material \"" + name + "\" was clamped from t = " + support::three_digits(seen_[k].time) + " s on (" +
                  std::to_string(seen_[k].particles) + (seen_[k].particles == 1 ? " particle" : " particles") +
                  " then): " + text_of(k) + " (mpm describe " + std::string(material_->id()) + ")");
  }
  return all;
}

}  // namespace mpm
