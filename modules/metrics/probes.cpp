#include "metrics/probes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mpm {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double reach = 2;  ///< radius of a fit in particle spacings

Vector3 minus(const Vector3& a, const Vector3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double dot(const Vector3& a, const Vector3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector3 position_of(const BodyView& view, std::size_t p) {
  const auto D = static_cast<std::size_t>(view.experiment.dimension);
  Vector3 x{};
  std::copy_n(&view.state.position[p * D], D, x.begin());
  return x;
}

/// A weighted fit of a + b.d, with d the distance from a place, by its normal equations.
struct Fit {
  double matrix[4][4] = {}, right[4] = {};
  bool material = false;  ///< a particle lies near

  void add(double weight, const double (&basis)[4], double value) {
    for (int i = 0; i < 4; ++i) {
      right[i] += weight * basis[i] * value;
      for (int j = 0; j < 4; ++j) matrix[i][j] += weight * basis[i] * basis[j];
    }
  }

  /// The value at the place, by elimination from the last unknown to the first.
  double value(int dimension) const {
    if (!material) return none;
    constexpr double singular = 1e-8;  // of a diagonal: the particles around lie on a line or in a plane
    Fit reduced = *this;
    for (int k = dimension; k > 0; --k) {
      const double pivot = reduced.matrix[k][k];
      if (!(pivot > singular * matrix[k][k]) || !(pivot > singular * matrix[0][0] * 1e-4))
        return right[0] / matrix[0][0];
      for (int i = 0; i < k; ++i) {
        const double factor = reduced.matrix[i][k] / pivot;
        for (int j = 0; j < k; ++j) reduced.matrix[i][j] -= factor * reduced.matrix[k][j];
        reduced.right[i] -= factor * reduced.right[k];
      }
    }
    return reduced.right[0] / reduced.matrix[0][0];
  }
};

/// Cubic B-spline of unit integral over cells, at d cells.
double spline(double d) {
  const double x = std::abs(d);
  if (x >= 2) return 0;
  return x < 1 ? 2.0 / 3 - x * x + x * x * x / 2 : (2 - x) * (2 - x) * (2 - x) / 6;
}

/// Calls visit(view, particle, weight in 1/m, distance from the section's point) for the particles near a section.
template <class Visit>
void for_each_near(Views& views, const ProbeSpecification& probe, const std::vector<int>& bodies, Visit visit) {
  const double h = views.experiment().grid.cell_size;
  for (const int body : bodies) {
    const BodyView& view = views.of(body);
    for (std::size_t p = 0; p < view.count; ++p) {
      const Vector3 d = minus(position_of(view, p), probe.point);
      if (const double weight = spline(dot(d, probe.normal) / h) / h; weight > 0) visit(view, p, weight, d);
    }
  }
}

std::vector<int> bodies_of(const Experiment& experiment, int body) {
  if (body >= 0) return {body};
  std::vector<int> all;
  for (int k = 0; k < static_cast<int>(experiment.bodies.size()); ++k) all.push_back(k);
  return all;
}

}  // namespace

Views::Views(const Simulation& simulation) : simulation_(simulation), views_(simulation.experiment().bodies.size()) {}

const BodyView& Views::of(int body) {
  auto& view = views_[static_cast<std::size_t>(body)];
  if (!view) view = std::make_unique<BodyView>(simulation_, body);
  return *view;
}

const std::vector<double>& Views::values(int body, const std::string& name) {
  const auto [place, is_new] = values_.try_emplace({body, name});
  if (is_new) place->second = quantity(experiment(), body, of(body).state, name);
  return place->second;
}

std::vector<int> bodies_with(const Experiment& experiment, int body, const std::string& quantity) {
  std::vector<int> bodies = bodies_of(experiment, body);
  std::erase_if(bodies, [&](int k) {
    const std::vector<std::string> names = quantity_names(experiment, k);
    return std::find(names.begin(), names.end(), quantity) == names.end();
  });
  return bodies;
}

std::vector<double> values_along(Views& views, const std::string& quantity, int body, const Vector3& first,
                                 const Vector3& last, int count) {
  const Experiment& experiment = views.experiment();
  const int D = experiment.dimension;
  const Vector3 way = minus(last, first);
  const double length = std::sqrt(dot(way, way)), apart = count > 1 ? length / (count - 1) : 0.0;
  Vector3 along{};
  for (int c = 0; c < 3; ++c) along[c] = length > 0 ? way[c] / length : 0.0;
  std::vector<Fit> fits(static_cast<std::size_t>(count));
  for (const int k : bodies_with(experiment, body, quantity)) {
    const BodyView& view = views.of(k);
    const std::vector<double>& values = views.values(k, quantity);
    const double seeded = std::pow(view.state.volume, 1.0 / D);
    for (std::size_t p = 0; p < view.count; ++p) {
      const double volume = view.state.volume * view.material.volume_ratio[p];
      const double spacing = std::max(seeded, std::pow(volume, 1.0 / D)), R = reach * spacing;
      const Vector3 from_first = minus(position_of(view, p), first);
      const double way_along = dot(from_first, along);
      if (way_along < -R || way_along > length + R) continue;
      if (dot(from_first, from_first) - way_along * way_along > R * R) continue;
      const int begin = apart > 0 ? std::max(0, static_cast<int>(std::ceil((way_along - R) / apart))) : 0;
      const int end = apart > 0 ? std::min(count - 1, static_cast<int>(std::floor((way_along + R) / apart))) : 0;
      for (int i = begin; i <= end; ++i) {
        double basis[4] = {1, 0, 0, 0}, r2 = 0;
        for (int c = 0; c < D; ++c) {
          const double d = from_first[c] - i * apart * along[c];
          r2 += d * d;
          basis[c + 1] = d / R;
        }
        if (r2 >= R * R) continue;
        const double share = 1 - r2 / (R * R);
        fits[static_cast<std::size_t>(i)].add(volume * share * share, basis, values[p]);
        if (r2 <= spacing * spacing) fits[static_cast<std::size_t>(i)].material = true;
      }
    }
  }
  std::vector<double> result;
  for (const Fit& fit : fits) result.push_back(fit.value(D));
  return result;
}

SectionSums section_sums(Views& views, const ProbeSpecification& probe) {
  const Experiment& experiment = views.experiment();
  const int D = experiment.dimension;
  SectionSums sums;
  for_each_near(views, probe, bodies_of(experiment, probe.body),
                [&](const BodyView& view, std::size_t p, double weight, const Vector3& d) {
                  const double* t = &view.material.stress[p * (D == 2 ? 4 : 6)];
                  const double full[3][3] = {{t[0], t[D == 2 ? 3 : 5], D == 2 ? 0 : t[4]},
                                             {t[D == 2 ? 3 : 5], t[1], D == 2 ? 0 : t[3]},
                                             {D == 2 ? 0 : t[4], D == 2 ? 0 : t[3], t[2]}};
                  const double V = weight * view.initial_volume(p);  // Kirchhoff stresses are of initial volumes
                  Vector3 force{};
                  for (int a = 0; a < D; ++a)
                    for (int b = 0; b < D; ++b) force[a] += V * full[a][b] * probe.normal[b];
                  sums.area += V * view.material.volume_ratio[p];
                  for (int a = 0; a < 3; ++a) {
                    sums.force[a] += force[a];
                    const int b = (a + 1) % 3, c = (a + 2) % 3;
                    sums.moment[a] += d[b] * force[c] - d[c] * force[b];
                  }
                });
  return sums;
}

double section_mean(Views& views, const ProbeSpecification& probe, const std::string& quantity) {
  double sum = 0, area = 0;
  for_each_near(views, probe, bodies_with(views.experiment(), probe.body, quantity),
                [&](const BodyView& view, std::size_t p, double weight, const Vector3&) {
                  const double V = weight * view.initial_volume(p) * view.material.volume_ratio[p];
                  sum += V * views.values(view.body, quantity)[p], area += V;
                });
  return sum / area;
}

}  // namespace mpm
