#include "metrics/mapped_grid.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "simulation/boundary.hpp"

namespace mpm {
namespace {

constexpr std::size_t batch_size = 1024;

/// Arrays [component][particle] of some particles of a body, in cells, padded to whole lanes with the last.
class Batch {
 public:
  Batch(const Experiment& experiment, int body, const BodyState& state, std::size_t first, std::size_t count)
      : count_(count), stride_((count + MPM_LANES - 1) / MPM_LANES * MPM_LANES), D_(experiment.dimension) {
    const double h = experiment.grid.cell_size;
    const auto D = static_cast<std::size_t>(D_);
    const auto at = [&](const std::vector<double>& values, std::size_t components) {
      std::vector<double> array(values.empty() ? 0 : components * stride_);
      for (std::size_t p = 0; p < stride_ && !values.empty(); ++p)
        for (std::size_t c = 0; c < components; ++c)
          array[c * stride_ + p] = values[(first + std::min(p, count - 1)) * components + c] / h;
      return array;
    };
    position = at(state.position, D);
    for (std::size_t a = 0; a < D; ++a)
      for (std::size_t p = 0; p < stride_; ++p) position[a * stride_ + p] -= experiment.grid.lower[a] / h;
    domain = at(state.domain, D * D);
    corners = at(state.corners, D * (D == 2 ? 4 : 8));
    half_size.assign(D * stride_, 0.5 / experiment.bodies[body].particles_per_cell_axis);
  }

  /// Calls visit(particle of the batch, node, weight) for all nodes of all particles.
  void for_each_node(const Component& shape, const std::function<void(std::size_t, const int (&)[3], double)>& visit) {
    if (shape.plugin->shape().form == MPM_NODE_LIST)
      visit_list(shape, visit);
    else
      visit_product(shape, visit);
  }

 private:
  using Visit = std::function<void(std::size_t, const int (&)[3], double)>;

  const double* if_needed(const Component& shape, std::uint32_t need, const std::vector<double>& array) const {
    return shape.plugin->descriptor->needs & need ? array.data() : nullptr;
  }

  void visit_product(const Component& shape, const Visit& visit) {
    const mpm_shape& table = shape.plugin->shape();
    const std::size_t K = table.width, D = static_cast<std::size_t>(D_);
    std::vector<std::int32_t> base(D * stride_);
    std::vector<double> offset(D * stride_), weight(D * K * stride_), gradient(D * K * stride_), moment(D * stride_);
    const auto n = static_cast<std::uint32_t>(stride_);
    const mpm_shape_batch batch{n,
                                n,
                                static_cast<std::uint32_t>(D),
                                0,
                                position.data(),
                                if_needed(shape, MPM_NEEDS_HALF_SIZE, half_size),
                                if_needed(shape, MPM_NEEDS_DOMAIN, domain),
                                base.data(),
                                offset.data(),
                                weight.data(),
                                gradient.data(),
                                table.second_moment_kind == MPM_MOMENT_PER_PARTICLE ? moment.data() : nullptr};
    table.evaluate[MPM_SCALAR_DOUBLE](shape.parameters.data(), &batch);
    const auto w = [&](std::size_t axis, std::size_t node, std::size_t p) {
      return weight[(axis * K + node) * stride_ + p];
    };
    for (std::size_t p = 0; p < count_; ++p)
      for (std::size_t k = 0; k < (D == 3 ? K : 1); ++k)
        for (std::size_t j = 0; j < K; ++j)
          for (std::size_t i = 0; i < K; ++i) {
            const std::size_t at[3] = {i, j, k};
            int node[3] = {0, 0, 0};
            double product = 1;
            for (std::size_t a = 0; a < D; ++a) {
              node[a] = base[a * stride_ + p] + static_cast<int>(at[a]);
              product *= w(a, at[a], p);
            }
            visit(p, node, product);
          }
  }

  void visit_list(const Component& shape, const Visit& visit) {
    const mpm_shape& table = shape.plugin->shape();
    const std::size_t D = static_cast<std::size_t>(D_), capacity = table.capacity[D - 2];
    std::vector<std::int32_t> counts(stride_), nodes(capacity * D * stride_);
    std::vector<double> weight(capacity * stride_), gradient(capacity * D * stride_), moment(D * D * stride_);
    const auto n = static_cast<std::uint32_t>(stride_);
    const mpm_list_batch batch{n,
                               n,
                               static_cast<std::uint32_t>(D),
                               static_cast<std::uint32_t>(capacity),
                               position.data(),
                               if_needed(shape, MPM_NEEDS_HALF_SIZE, half_size),
                               if_needed(shape, MPM_NEEDS_DOMAIN, domain),
                               counts.data(),
                               nodes.data(),
                               weight.data(),
                               gradient.data(),
                               table.second_moment_kind == MPM_MOMENT_PER_PARTICLE ? moment.data() : nullptr,
                               corners.empty() ? nullptr : corners.data()};
    table.evaluate_list[MPM_SCALAR_DOUBLE][D - 2](shape.parameters.data(), &batch);
    for (std::size_t p = 0; p < count_; ++p)
      for (std::size_t k = 0; k < static_cast<std::size_t>(std::max(counts[p], 0)); ++k) {
        int node[3] = {0, 0, 0};
        for (std::size_t a = 0; a < D; ++a) node[a] = nodes[(k * D + a) * stride_ + p];
        visit(p, node, weight[k * stride_ + p]);
      }
  }

  std::size_t count_, stride_;
  int D_;
  std::vector<double> position, half_size, domain, corners;
};

/// Sums on the nodes of the domain, with images folded as they come.
class Nodes {
 public:
  Nodes(const Experiment& experiment, double time, MappedGrid& grid)
      : experiment_(experiment), time_(time), grid_(grid) {
    for (int a = 0; a < experiment.dimension; ++a) grid_.nodes[a] = experiment.grid.cells[a] + 1;
    total_ = static_cast<std::size_t>(grid_.nodes[0]) * grid_.nodes[1] * grid_.nodes[2];
    grid_.fields.resize(static_cast<std::size_t>(experiment.field_count));
    for (MappedGrid::Field& field : grid_.fields) {
      field.mass.assign(total_, 0.0);
      field.velocity.assign(3 * total_, 0.0);
    }
  }

  /// Adds a mass that moves with a velocity; what lies outside a domain without images is left out.
  void add(int field, const int (&at)[3], double mass, Vector3 velocity) {
    int node[3] = {at[0], at[1], at[2]};
    for (int a = 0; a < experiment_.dimension; ++a) {
      const int cells = experiment_.grid.cells[a];
      const int side = node[a] < 0 ? 0 : node[a] > cells ? 1 : -1;
      const bool periodic = experiment_.faces[a][0].type == ConditionType::periodic;
      if (periodic) {
        node[a] = image_of(node[a], cells, true);
      } else if (side >= 0) {
        const FaceCondition& face = experiment_.faces[a][side];
        if (!folds(face.type)) return;
        int foot[3] = {node[0], node[1], node[2]};
        foot[a] = side == 0 ? 0 : cells;
        const Vector3 wall = wall_velocity(face, foot);
        for (int c = 0; c < experiment_.dimension; ++c)
          velocity[c] = mirrored(velocity[c], mirror_sign(face.type, a, c), wall[c]);
        node[a] = image_of(node[a], cells, false);
      }
    }
    const std::size_t k = index(node);
    MappedGrid::Field& sums = grid_.fields[static_cast<std::size_t>(field)];
    sums.mass[k] += mass;
    for (std::size_t c = 0; c < 3; ++c) sums.velocity[3 * k + c] += mass * velocity[c];
  }

  /// Divides momenta by masses, lets walls hold what they hold, and copies periodic faces to their other side.
  void finish() {
    for (MappedGrid::Field& field : grid_.fields)
      for (std::size_t k = 0; k < total_; ++k)
        for (std::size_t c = 0; c < 3; ++c)
          field.velocity[3 * k + c] = field.mass[k] > 0 ? field.velocity[3 * k + c] / field.mass[k] : 0.0;
    for (int a = 0; a < experiment_.dimension; ++a)
      for (int side = 0; side < 2; ++side) finish_face(a, side);
  }

 private:
  std::size_t index(const int (&node)[3]) const {
    return static_cast<std::size_t>(node[0]) +
           static_cast<std::size_t>(grid_.nodes[0]) *
               (static_cast<std::size_t>(node[1]) +
                static_cast<std::size_t>(grid_.nodes[1]) * static_cast<std::size_t>(node[2]));
  }

  Vector3 wall_velocity(const FaceCondition& face, const int (&node)[3]) const {
    if (!face.velocity) return {};
    Vector3 x{};
    for (int a = 0; a < experiment_.dimension; ++a)
      x[a] = experiment_.grid.lower[a] + node[a] * experiment_.grid.cell_size;
    return (*face.velocity)(x, x, time_);
  }

  void finish_face(int axis, int side) {
    const FaceCondition& face = experiment_.faces[axis][side];
    int node[3] = {0, 0, 0};
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    node[axis] = side == 0 ? 0 : grid_.nodes[axis] - 1;
    for (node[b] = 0; node[b] < grid_.nodes[b]; ++node[b])
      for (node[c] = 0; node[c] < grid_.nodes[c]; ++node[c]) {
        const Vector3 wall = wall_velocity(face, node);
        for (MappedGrid::Field& field : grid_.fields) finish_node(field, face, axis, side, node, wall);
      }
  }

  void finish_node(MappedGrid::Field& field, const FaceCondition& face, int axis, int side, const int (&node)[3],
                   const Vector3& wall) const {
    const std::size_t k = index(node);
    if (face.type == ConditionType::periodic && side == 1) {
      const int other[3] = {axis == 0 ? 0 : node[0], axis == 1 ? 0 : node[1], axis == 2 ? 0 : node[2]};
      const std::size_t from = index(other);
      field.mass[k] = field.mass[from];
      for (std::size_t c = 0; c < 3; ++c) field.velocity[3 * k + c] = field.velocity[3 * from + c];
    }
    if (!(field.mass[k] > 0)) return;
    const double across = field.velocity[3 * k + static_cast<std::size_t>(axis)];
    for (int c = 0; c < experiment_.dimension; ++c)
      if (wall_holds(static_cast<int>(face.type), axis, side, c, across))
        field.velocity[3 * k + static_cast<std::size_t>(c)] = wall[c];
  }

  const Experiment& experiment_;
  double time_;
  MappedGrid& grid_;
  std::size_t total_ = 0;
};

}  // namespace

MappedGrid mapped_grid(const Experiment& experiment, const std::vector<BodyState>& states, double time) {
  MappedGrid grid;
  Nodes nodes(experiment, time, grid);
  const auto D = static_cast<std::size_t>(experiment.dimension);
  for (std::size_t body = 0; body < states.size(); ++body) {
    const BodyState& state = states[body];
    const std::size_t particles = state.position.size() / D;
    for (std::size_t first = 0; first < particles; first += batch_size) {
      Batch batch(experiment, static_cast<int>(body), state, first, std::min(batch_size, particles - first));
      batch.for_each_node(experiment.shape, [&](std::size_t p, const int(&node)[3], double weight) {
        Vector3 velocity{};
        for (std::size_t c = 0; c < D; ++c) velocity[c] = state.velocity[(first + p) * D + c];
        nodes.add(experiment.bodies[body].field, node, weight * state.mass * state.size_of(first + p), velocity);
      });
    }
  }
  nodes.finish();
  return grid;
}

}  // namespace mpm
