#pragma once
// The shape functions of one body's particles as the plugin gives them: a tensor product of weights along the axes, or
// a list of nodes. Both become one list of nodes a particle.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "backends/reference/grid.hpp"

namespace mpm::reference {

/// An array [component][particle], padded with copies of the last particle so that a plugin may compute whole lanes.
using Array = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A node of a particle's stencil.
struct StencilNode {
  std::size_t index = 0;
  double weight = 0;
  Vector gradient = Vector::Zero();  ///< grad w, 1/m
  Vector distance = Vector::Zero();  ///< d = node - particle, m
  Vector affine = Vector::Zero();    ///< w D^-1 d, 1/m; zero where no pass reads it
};
using Stencil = std::vector<StencilNode>;

/// The polynomials beyond affine at the nodes of one particle, in the order of its stencil.
struct HigherBasis {
  Array given, taken;        ///< [function][node]: w P, and w P / sum w P^2
  std::vector<double> norm;  ///< [function] sum w P^2
};

/// The points where the shape of one body is evaluated, in cells.
struct ShapeArguments {
  Array position;   ///< [D], from the grid's lower corner
  Array half_size;  ///< [D]; half the undeformed particle's box
  Array domain;     ///< [D*D]; empty unless planned
  Array corners;    ///< [points*D], from the position; empty unless Plan::sample_points
};

/// The values that the plugin returned for all particles, in cells.
struct ShapeValues {
  std::vector<std::int32_t> node;   ///< tensor product: first node [D][n]; list: every node [capacity][D][n]
  std::vector<std::int32_t> count;  ///< list: nodes of each particle
  Array offset;                     ///< tensor product: position - first node
  Array weight, gradient;           ///< [D][width] or [capacity], [D][width] or [capacity][D]
  Array second_moment;              ///< [D*D] row-major, filled in when the moment is one a particle and planned
};

class Shape {
 public:
  Shape(const Experiment& experiment, const Plan& plan);

  ShapeValues evaluate(const ShapeArguments& at) const;
  /// Finds the nodes of particle p. Throws RunFailure when its domain reaches beyond the grid's padding.
  Stencil stencil(const ShapeValues& values, const ShapeArguments& at, std::size_t p, const Grid& grid, int body) const;
  /// D = sum w d d^T of particle p, m^2; it is zero when each particle has its own and the plan does not want it.
  Matrix second_moment(const ShapeValues& values, const ShapeArguments& at, std::size_t p) const;
  /// The polynomials beyond affine of particle p, whose shape is a tensor product.
  HigherBasis higher_basis(const ShapeValues& values, std::size_t p) const;

 private:
  template <int K>
  HigherBasis higher_basis_of_width(const ShapeValues& values, std::size_t p) const;
  void evaluate_product(const ShapeArguments& at, ShapeValues& values) const;
  void evaluate_list(const ShapeArguments& at, ShapeValues& values) const;
  StencilNode product_node(const ShapeValues& values, std::size_t p, const int (&at)[3],
                           Eigen::Vector3i& coordinates) const;
  StencilNode list_node(const ShapeValues& values, const ShapeArguments& at, std::size_t p, int k,
                        Eigen::Vector3i& coordinates) const;

  const Experiment& experiment_;
  const Plan& plan_;
  const mpm_shape& shape_;
  int dimension_;
  double cell_size_;
};

}  // namespace mpm::reference
