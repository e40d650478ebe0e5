#include "experiment/scattered_places.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace mpm {

void Scattered::throw_points(const Geometry& region, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) / 9007199254740992.0; };
  const auto [lower, upper] = region.bounds();
  while (points_.size() < count) {
    Vector3 x{};
    for (int c = 0; c < dimension_; ++c) x[c] = lower[c] + uniform() * (upper[c] - lower[c]);
    if (region.contains(x)) points_.push_back(x);
  }
}

std::array<long, 3> Scattered::cell_of(const Vector3& x) const {
  std::array<long, 3> cell{};
  for (int c = 0; c < dimension_; ++c) cell[c] = static_cast<long>(std::floor(x[c] / spacing_));
  return cell;
}

/// Looks in shells of cells around x until no farther one can hold a nearer point.
std::size_t Scattered::nearest(const Vector3& x) const {
  const std::array<long, 3> at = cell_of(x);
  std::size_t best = points_.size();
  double least = INFINITY;
  for (long shell = 0; best == points_.size() || least > std::pow(spacing_ * static_cast<double>(shell - 1), 2);
       ++shell) {
    const long deep = dimension_ == 2 ? 0 : shell;
    for (long k = -deep; k <= deep; ++k)
      for (long j = -shell; j <= shell; ++j)
        for (long i = -shell; i <= shell; ++i) {
          if (std::max({std::abs(i), std::abs(j), std::abs(k)}) != shell) continue;
          const std::array<long, 3> cell{at[0] + i - first_cell_[0], at[1] + j - first_cell_[1],
                                         at[2] + k - first_cell_[2]};
          if (std::min({cell[0], cell[1], cell[2]}) < 0 || cell[0] >= cells_[0] || cell[1] >= cells_[1] ||
              cell[2] >= cells_[2])
            continue;
          for (const std::size_t p : near_[(cell[2] * cells_[1] + cell[1]) * cells_[0] + cell[0]]) {
            double distance = 0;
            for (int c = 0; c < dimension_; ++c) distance += std::pow(points_[p][c] - x[c], 2);
            if (distance < least) least = distance, best = p;
          }
        }
  }
  return best;
}

void Scattered::sort_into_cells() {
  std::array<long, 3> last{};
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const std::array<long, 3> cell = cell_of(points_[p]);
    for (int c = 0; c < 3; ++c) {
      first_cell_[c] = p == 0 ? cell[c] : std::min(first_cell_[c], cell[c]);
      last[c] = p == 0 ? cell[c] : std::max(last[c], cell[c]);
    }
  }
  for (int c = 0; c < 3; ++c) cells_[c] = last[c] - first_cell_[c] + 1;
  near_.assign(static_cast<std::size_t>(cells_[0] * cells_[1] * cells_[2]), {});
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const std::array<long, 3> cell = cell_of(points_[p]);
    near_[((cell[2] - first_cell_[2]) * cells_[1] + cell[1] - first_cell_[1]) * cells_[0] + cell[0] - first_cell_[0]]
        .push_back(p);
  }
}

void Scattered::assign() {
  sort_into_cells();
  volumes_.assign(points_.size(), 0.0), moments_.assign(points_.size(), Vector3{});
  for (const Piece& sample : samples_) {
    const std::size_t p = nearest(sample.middle);
    volumes_[p] += sample.volume;
    for (int c = 0; c < dimension_; ++c) moments_[p][c] += sample.volume * sample.middle[c];
  }
}

void Scattered::keep_heavier_than(double least) {
  for (std::size_t p = points_.size(); p-- > 0;)
    if (volumes_[p] < least) points_.erase(points_.begin() + static_cast<std::ptrdiff_t>(p));
}

void Scattered::relax(int times) {
  for (int round = 0; round <= times; ++round) {
    assign();
    for (std::size_t p = 0; p < points_.size(); ++p)
      for (int c = 0; volumes_[p] > 0 && c < dimension_; ++c) points_[p][c] = moments_[p][c] / volumes_[p];
  }
  const std::size_t before = points_.size();
  std::vector<double> volumes;
  for (const double volume : volumes_)
    if (volume > 0) volumes.push_back(volume);
  keep_heavier_than(1e-300);
  if (points_.size() != before) volumes_ = volumes;
  match();
}

void Scattered::share_out(double least) {
  for (std::size_t before = 0; before != points_.size();) {
    assign();
    before = points_.size();
    keep_heavier_than(least);
  }
  match();
}

/// Brings the sum of the volumes and their middle to those of the region.
void Scattered::match() {
  double sum = 0;
  for (const double volume : volumes_) sum += volume;
  for (double& volume : volumes_) volume *= all_.volume / sum;
  if (points_.size() > static_cast<std::size_t>(dimension_)) tilt();
}

/// Multiplies volumes by 1 + a . (x - mean), which leaves their sum, with the a that gives the middle.
void Scattered::tilt() {
  double matrix[3][4] = {};
  Vector3 mean{};
  for (std::size_t p = 0; p < points_.size(); ++p)
    for (int c = 0; c < dimension_; ++c) mean[c] += volumes_[p] * points_[p][c] / all_.volume;
  for (std::size_t p = 0; p < points_.size(); ++p)
    for (int a = 0; a < dimension_; ++a)
      for (int b = 0; b < dimension_; ++b)
        matrix[a][b] += volumes_[p] * (points_[p][a] - mean[a]) * (points_[p][b] - mean[b]);
  for (int a = 0; a < dimension_; ++a) matrix[a][3] = all_.moment[a] - all_.volume * mean[a];
  for (int a = 0; a < dimension_; ++a) {  // Gauss: the matrix is symmetric and positive unless points lie on a line
    if (!(matrix[a][a] > 0)) return;
    for (int b = 0; b < dimension_; ++b) {
      if (b == a) continue;
      const double factor = matrix[b][a] / matrix[a][a];
      for (int c = a; c < 4; ++c) matrix[b][c] -= factor * matrix[a][c];
    }
  }
  for (std::size_t p = 0; p < points_.size(); ++p) {
    double factor = 1;
    for (int a = 0; a < dimension_; ++a) factor += matrix[a][3] / matrix[a][a] * (points_[p][a] - mean[a]);
    volumes_[p] *= std::max(factor, 0.1);
  }
}

}  // namespace mpm
