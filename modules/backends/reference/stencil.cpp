#include "backends/reference/stencil.hpp"

#include <Eigen/LU>
#include <cmath>

#include "kernel/polynomial_basis.hpp"

namespace mpm::reference {
namespace {

std::uint32_t columns(const Array& array) {
  return static_cast<std::uint32_t>(array.cols());
}

}  // namespace

Shape::Shape(const Experiment& experiment, const Plan& plan)
    : experiment_(experiment),
      plan_(plan),
      shape_(experiment.shape.plugin->shape()),
      dimension_(experiment.dimension),
      cell_size_(experiment.grid.cell_size) {}

ShapeValues Shape::evaluate(const ShapeArguments& at) const {
  ShapeValues values;
  if (plan_.stencil.second_moment) values.second_moment = Array::Zero(dimension_ * dimension_, at.position.cols());
  if (shape_.form == MPM_NODE_LIST)
    evaluate_list(at, values);
  else
    evaluate_product(at, values);
  return values;
}

void Shape::evaluate_product(const ShapeArguments& at, ShapeValues& values) const {
  const auto n = columns(at.position);
  const int D = dimension_, K = static_cast<int>(shape_.width);
  const std::uint32_t needs = experiment_.shape.plugin->descriptor->needs;
  values.node.resize(static_cast<std::size_t>(D) * n);
  values.offset = Array::Zero(D, n), values.weight = Array::Zero(D * K, n), values.gradient = Array::Zero(D * K, n);
  Array diagonal = Array::Zero(D, n);
  const mpm_shape_batch batch{n,
                              n,
                              static_cast<std::uint32_t>(D),
                              0,
                              at.position.data(),
                              needs & MPM_NEEDS_HALF_SIZE ? at.half_size.data() : nullptr,
                              needs & MPM_NEEDS_DOMAIN ? at.domain.data() : nullptr,
                              values.node.data(),
                              values.offset.data(),
                              values.weight.data(),
                              values.gradient.data(),
                              plan_.stencil.second_moment ? diagonal.data() : nullptr};
  shape_.evaluate[MPM_SCALAR_DOUBLE](experiment_.shape.parameters.data(), &batch);
  // As sum w d = 0 along each axis, the product's moment is diagonal.
  for (int a = 0; plan_.stencil.second_moment && a < D; ++a) values.second_moment.row(a * (D + 1)) = diagonal.row(a);
}

void Shape::evaluate_list(const ShapeArguments& at, ShapeValues& values) const {
  const auto n = columns(at.position);
  const int D = dimension_;
  const std::uint32_t capacity = shape_.capacity[D - 2];
  const std::uint32_t needs = experiment_.shape.plugin->descriptor->needs;
  values.count.resize(n);
  values.node.resize(static_cast<std::size_t>(capacity) * D * n);
  values.weight = Array::Zero(capacity, n), values.gradient = Array::Zero(capacity * D, n);
  const mpm_list_batch batch{n,
                             n,
                             static_cast<std::uint32_t>(D),
                             capacity,
                             at.position.data(),
                             needs & MPM_NEEDS_HALF_SIZE ? at.half_size.data() : nullptr,
                             needs & MPM_NEEDS_DOMAIN ? at.domain.data() : nullptr,
                             values.count.data(),
                             values.node.data(),
                             values.weight.data(),
                             values.gradient.data(),
                             plan_.stencil.second_moment ? values.second_moment.data() : nullptr,
                             plan_.sample_points > 0 ? at.corners.data() : nullptr};
  shape_.evaluate_list[MPM_SCALAR_DOUBLE][D - 2](experiment_.shape.parameters.data(), &batch);
}

/// Finds a node of a product: w = prod_c w_c, dw/dx_c = w_c' / h prod_(e != c) w_e.
StencilNode Shape::product_node(const ShapeValues& values, std::size_t p, const int (&at)[3],
                                Eigen::Vector3i& coordinates) const {
  const int D = dimension_, K = static_cast<int>(shape_.width);
  const std::size_t n = values.offset.cols();
  StencilNode node;
  node.weight = 1;
  for (int c = 0; c < D; ++c) {
    coordinates[c] = values.node[c * n + p] + at[c];
    node.distance[c] = cell_size_ * (at[c] - values.offset(c, p));
    node.weight *= values.weight(c * K + at[c], p);
    node.gradient[c] = values.gradient(c * K + at[c], p) / cell_size_;
    for (int e = 0; e < D; ++e)
      if (e != c) node.gradient[c] *= values.weight(e * K + at[e], p);
  }
  return node;
}

StencilNode Shape::list_node(const ShapeValues& values, const ShapeArguments& at, std::size_t p, int k,
                             Eigen::Vector3i& coordinates) const {
  const std::size_t n = values.weight.cols();
  StencilNode node;
  node.weight = values.weight(k, p);
  for (int c = 0; c < dimension_; ++c) {
    coordinates[c] = values.node[(k * dimension_ + c) * n + p];
    node.distance[c] = cell_size_ * (coordinates[c] - at.position(c, p));
    node.gradient[c] = values.gradient(k * dimension_ + c, p) / cell_size_;
  }
  return node;
}

Matrix Shape::second_moment(const ShapeValues& values, const ShapeArguments& at, std::size_t p) const {
  const double h2 = cell_size_ * cell_size_;
  Matrix moment = Matrix::Zero();
  for (int a = 0; a < dimension_; ++a) {
    const double f = at.position(a, p) - std::floor(at.position(a, p));
    if (shape_.second_moment_kind == MPM_MOMENT_IS_GRADIENT) moment(a, a) = h2 * f * (1 - f);
    if (shape_.second_moment_kind == MPM_MOMENT_CONSTANT) moment(a, a) = h2 * shape_.second_moment;
    for (int b = 0; plan_.stencil.second_moment && b < dimension_; ++b)
      moment(a, b) = h2 * values.second_moment(a * dimension_ + b, p);
  }
  return moment;
}

template <int K>
HigherBasis Shape::higher_basis_of_width(const ShapeValues& values, std::size_t p) const {
  const int D = dimension_;
  AxisBasis<K, double> axis[3];
  for (int c = 0; c < D; ++c)
    make_axis_basis<K>(&values.weight(c * K, p), static_cast<int>(values.weight.cols()), values.offset(c, p),
                       plan_.basis_order, axis[c]);
  HigherBasis basis;
  const int nodes = D == 3 ? K * K * K : K * K;
  basis.given = basis.taken = Array::Ones(plan_.basis_functions, nodes);
  basis.norm.assign(plan_.basis_functions, 1.0);
  const auto add = [&](int function, const int* power) {
    for (int c = 0; c < D; ++c) basis.norm[function] *= axis[c].norm[power[c]];
    for (int node = 0; node < nodes; ++node) {
      const int at[3] = {node % K, node / K % K, node / (K * K)};
      for (int c = 0; c < D; ++c) {
        basis.given(function, node) *= axis[c].given[power[c]][at[c]];
        basis.taken(function, node) *= axis[c].taken[power[c]][at[c]];
      }
    }
  };
  if (D == 3)
    for_each_product<3>(plan_.basis_order, add);
  else
    for_each_product<2>(plan_.basis_order, add);
  return basis;
}

HigherBasis Shape::higher_basis(const ShapeValues& values, std::size_t p) const {
  if (shape_.width == 2) return higher_basis_of_width<2>(values, p);
  return shape_.width == 3 ? higher_basis_of_width<3>(values, p) : higher_basis_of_width<4>(values, p);
}

Stencil Shape::stencil(const ShapeValues& values, const ShapeArguments& at, std::size_t p, const Grid& grid,
                       int body) const {
  const int D = dimension_;
  const bool moment_is_gradient = shape_.second_moment_kind == MPM_MOMENT_IS_GRADIENT;
  Matrix inverse = Matrix::Zero();  // inverse of D
  if (!moment_is_gradient && (plan_.stencil.second_moment || shape_.second_moment_kind == MPM_MOMENT_CONSTANT))
    inverse.topLeftCorner(D, D) = second_moment(values, at, p).topLeftCorner(D, D).inverse();
  Stencil stencil;
  const auto add = [&](StencilNode node, const Eigen::Vector3i& coordinates) {
    if (!grid.contains(coordinates)) throw RunFailure({Cause::domain_beyond_grid, body, p});
    node.index = grid.index(coordinates);
    node.affine = moment_is_gradient ? node.gradient : Vector(node.weight * (inverse * node.distance));
    stencil.push_back(node);
  };
  Eigen::Vector3i coordinates = Eigen::Vector3i::Zero();
  if (shape_.form == MPM_NODE_LIST) {
    if (values.count[p] < 1) throw RunFailure({Cause::domain_inside_out, body, p});
    for (int k = 0; k < values.count[p]; ++k) {
      const StencilNode node = list_node(values, at, p, k, coordinates);
      add(node, coordinates);
    }
    return stencil;
  }
  const int K = static_cast<int>(shape_.width);
  for (int c = 0; c < D; ++c)
    if (!(values.weight.col(static_cast<Eigen::Index>(p)).segment(c * K, K).sum() > 0.5))
      throw RunFailure({Cause::domain_outgrew_stencil, body, p});
  for (int k = 0; k < (D == 3 ? K : 1); ++k)
    for (int j = 0; j < K; ++j)
      for (int i = 0; i < K; ++i) {
        const StencilNode node = product_node(values, p, {i, j, k}, coordinates);
        add(node, coordinates);
      }
  return stencil;
}

}  // namespace mpm::reference
