#pragma once
// Values of a scene at places, along lines and over sections, from its particles: the same text for every backend.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "metrics/body_sums.hpp"

namespace mpm {

/// The bodies of a simulation at one time, each looked at once, when it is asked for.
class Views {
 public:
  explicit Views(const Simulation& simulation);
  const Experiment& experiment() const { return simulation_.experiment(); }
  const BodyView& of(int body);
  /// A quantity of all particles of a body.
  const std::vector<double>& values(int body, const std::string& quantity);

 private:
  const Simulation& simulation_;
  std::vector<std::unique_ptr<BodyView>> views_;
  std::map<std::pair<int, std::string>, std::vector<double>> values_;
};

/// The bodies that a probe looks at and whose particles have the quantity.
std::vector<int> bodies_with(const Experiment& experiment, int body, const std::string& quantity);

/// The quantity at each of the points from `first` to `last`, both included, at equal distances: the value there of the
/// linear function that fits the particles around it best (weights V (1 - r^2/R^2)^2, R two particle spacings), so that a
/// linear field is exact; their weighted mean where they lie too badly for that. Not a number where no particle lies
/// within a spacing: there is no material. The spacing is that at the start, or the D-th root of the volume where that
/// has grown beyond it.
std::vector<double> values_along(Views& views, const std::string& quantity, int body, const Vector3& first,
                                 const Vector3& last, int count);

/// What acts in a section: sums over particles with weights of their distance from the plane, the cubic B-spline that is
/// four cells wide. In axisymmetric scenes over whole rings, along the axis alone.
struct SectionSums {
  double area = 0;                 ///< m^2; m in plane strain
  std::array<double, 3> force{};   ///< N: of the material that the normal points to, on the other
  std::array<double, 3> moment{};  ///< N m, about the section's point
};
SectionSums section_sums(Views& views, const ProbeSpecification& probe);
/// The mean of a quantity over a section; not a number where it cuts nothing.
double section_mean(Views& views, const ProbeSpecification& probe, const std::string& quantity);

}  // namespace mpm
