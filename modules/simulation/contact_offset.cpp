#include "simulation/contact_offset.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "simulation/contact_detection.hpp"

namespace mpm {
namespace {

constexpr int samples_per_cell = 128;  // of the weights, between which lines are drawn
constexpr int reach = 4;               // cells, which is beyond the support of every shape
constexpr int places_of_mean = 64;

/// What a node at zero weighs a row by, as a function of the row's distance along the face's normal.
class ProjectedWeights {
 public:
  ProjectedWeights(const Component& shape, const TouchingFaces& faces)
      : shape_(shape),
        row_{0.5 / faces.particles_per_cell_axis, faces.stretch},
        cosine_(std::abs(std::cos(faces.angle))),
        sine_(std::abs(std::sin(faces.angle))) {
    if (faces.particles_per_cell_axis < 1) throw std::invalid_argument("a cell must hold one particle an axis or more");
    if (!(faces.stretch > 0) || !std::isfinite(faces.stretch)) throw std::invalid_argument("a stretch must be above 0");
    if (cosine_ < sine_) std::swap(cosine_, sine_);
    turned_ = sine_ > 1e-9;
    if (!turned_) return;
    std::vector<double> places;
    for (int k = -reach * samples_per_cell; k <= reach * samples_per_cell; ++k)
      places.push_back(static_cast<double>(k) / samples_per_cell);
    table_ = row_weights(shape_, row_, places);
  }

  std::vector<double> operator()(const std::vector<double>& rows) const {
    if (!turned_) return row_weights(shape_, row_, rows);
    std::vector<double> weights;
    for (const double row : rows) weights.push_back(convolved(row));
    return weights;
  }

 private:
  /// The weight of one axis at a distance, by its table.
  double of_axis(double distance) const {
    const double at = (distance + reach) * samples_per_cell;
    if (!(at > 0) || at >= static_cast<double>(table_.size() - 1)) return 0;
    const auto below = static_cast<std::size_t>(at);
    return table_[below] + (at - static_cast<double>(below)) * (table_[below + 1] - table_[below]);
  }
  /// The integral over u of w(u) w((x - u sin) / cos) / cos, by the trapezoidal rule at the table's places.
  double convolved(double x) const {
    double sum = 0;
    for (std::size_t k = 0; k < table_.size(); ++k) {
      const double u = static_cast<double>(k) / samples_per_cell - reach;
      sum += table_[k] * of_axis((x - u * sine_) / cosine_);
    }
    return sum / (cosine_ * samples_per_cell);
  }

  const Component& shape_;
  const Row row_;
  double cosine_, sine_;
  bool turned_;
  std::vector<double> table_;
};

/// What a node at zero sees of the two bodies.
class Seen {
 public:
  Seen(const Component& shape, const TouchingFaces& faces) : weights_(shape, faces), faces_(faces) {
    if (faces.angle != 0 && shape.plugin->shape().form == MPM_NODE_LIST)
      throw std::invalid_argument("the nodes of " + std::string(shape.plugin->id()) +
                                  " follow no axes: faces along the grid alone");
  }
  /// The mean distance of a body's rows, for its face at `face`.
  double mean(double face) const {
    return mean_of_rows(weights_, face, faces_.stretch, faces_.particles_per_cell_axis);
  }

 private:
  const ProjectedWeights weights_;
  const TouchingFaces faces_;
};

}  // namespace

std::vector<double> contact_offsets(const Component& shape, const TouchingFaces& faces,
                                    const std::vector<double>& places) {
  const Seen seen(shape, faces);
  std::vector<double> offsets;
  for (const double place : places) offsets.push_back(-seen.mean(-place) - seen.mean(place));
  return offsets;
}

std::vector<double> found_gaps(const Component& shape, const TouchingFaces& faces, const std::vector<double>& places) {
  const Seen seen(shape, faces);
  const EdgeModel model(shape, faces.particles_per_cell_axis);
  std::vector<double> gaps;
  for (const double place : places) {
    const double below = seen.mean(place), above = seen.mean(-place);
    gaps.push_back(std::isfinite(below + above) ? -model.edge(above) - model.edge(below) : below + above);
  }
  return gaps;
}

double mean_contact_offset(const Component& shape, const TouchingFaces& faces) {
  std::vector<double> places;
  for (int k = 0; k < places_of_mean; ++k) places.push_back((k + 0.5) / places_of_mean - 0.5);
  double sum = 0;
  for (const double offset : contact_offsets(shape, faces, places)) sum += offset;
  return sum / places_of_mean;
}

}  // namespace mpm
