#pragma once
// Particles that lie on no lattice: thrown at random, each with the part of the region that is nearest to it.

#include <cstdint>
#include <vector>

#include "experiment/measure.hpp"

namespace mpm {

class Scattered {
 public:
  /// `samples` are small pieces that fill the region; `all` is what it holds as a whole.
  Scattered(int dimension, double spacing, std::vector<Piece> samples, Measured all)
      : dimension_(dimension), spacing_(spacing), samples_(std::move(samples)), all_(all) {}

  /// Throws points evenly into the region.
  void throw_points(const Geometry& region, std::size_t count, std::uint64_t seed);
  /// Moves each point to the middle of the samples that are nearest to it, so many times (Lloyd 1982). Volumes are those of
  /// these parts then, and their sum and middle those of the region.
  void relax(int times);
  /// Leaves points where they are. Volumes are those of the parts, tilted so that their middle is the region's; points
  /// that would hold less than `least` are taken out.
  void share_out(double least);

  const std::vector<Vector3>& points() const { return points_; }
  const std::vector<double>& volumes() const { return volumes_; }

 private:
  void assign();
  std::size_t nearest(const Vector3& x) const;
  std::array<long, 3> cell_of(const Vector3& x) const;
  void sort_into_cells();
  void match();
  void tilt();
  void keep_heavier_than(double least);

  int dimension_;
  double spacing_;
  std::vector<Piece> samples_;
  Measured all_;
  std::vector<Vector3> points_, moments_;
  std::vector<double> volumes_;
  // Points by cells of one spacing, in rows within a box of cells.
  std::array<long, 3> first_cell_{}, cells_{1, 1, 1};
  std::vector<std::vector<std::size_t>> near_;
};

}  // namespace mpm
