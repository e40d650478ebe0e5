#pragma once
// The exact balance of the angular momentum L of FLIP's particles, and of PIC's under XPIC, on quadratic B-splines.
//
// With S the gather and S+ the mass-weighted scatter, a step of FLIP is v' = v + dt S a, x' = x + dt u, u = S (S+ v +
// dt a), a_i = f_i / m_i; one of XPIC(m) on PIC is v' = u = S v_m + dt S a, v_m = sum_{j<m} (I - S+ S)^j S+ v. With c_i
// the centre of the mass that node i holds, and sum_i x_i x f_i = 0 because stress is symmetric, exactly
//
//   L' - L = dt sum_i (c_i - x_i) x f_i  +  dt sum_p m u x v'  +  sum_p m x x (S v_m - v)
//            lumped masses                  motion                filter (zero for FLIP)
//
// Motion is zero for XPIC and of order dt^2 a step for FLIP: m u x v' sums to dt sum_i f_i x S+ v and dt sum_p m u x
// S a. AFLIP and ASFLIP obey it as FLIP does: their L counts v alone, and v' - v = dt S a.

#include <array>
#include <cmath>
#include <map>

#include "support/catch.hpp"
#include "support/scene.hpp"

namespace mpm::test {

using Vectors = std::vector<std::array<double, 2>>;

inline double cross(const std::array<double, 2>& a, const std::array<double, 2>& b) {
  return a[0] * b[1] - a[1] * b[0];
}

inline Vectors pairs(const std::vector<double>& flat) {
  Vectors list(flat.size() / 2);
  for (std::size_t p = 0; p < list.size(); ++p) list[p] = {flat[2 * p], flat[2 * p + 1]};
  return list;
}

/// The moment sum a x b.
inline double moment(const Vectors& a, const Vectors& b) {
  double sum = 0;
  for (std::size_t p = 0; p < a.size(); ++p) sum += cross(a[p], b[p]);
  return sum;
}

/// Quadratic B-splines about particles of equal mass, written anew from the formulas.
class Nodes {
 public:
  Nodes(const Vectors& position, double cell) : cell_(cell) {
    for (const auto& x : position) {
      double w[2][3], g[2][3], base[2];
      for (int c = 0; c < 2; ++c) {
        base[c] = std::floor(x[c] / cell - 0.5);
        const double d = x[c] / cell - base[c];
        w[c][0] = 0.5 * (1.5 - d) * (1.5 - d), w[c][1] = 0.75 - (d - 1) * (d - 1),
        w[c][2] = 0.5 * (d - 0.5) * (d - 0.5);
        g[c][0] = (d - 1.5) / cell, g[c][1] = 2 * (1 - d) / cell, g[c][2] = (d - 0.5) / cell;
      }
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          links_.push_back(
              {number(base[0] + i, base[1] + j), w[0][i] * w[1][j], {g[0][i] * w[1][j], w[0][i] * g[1][j]}});
    }
    mass.resize(place.size());
    for (const Link& link : links_) mass[link.node] += link.weight;
    centre = scatter(position);
  }

  /// The scatter S+ v.
  Vectors scatter(const Vectors& v) const {
    Vectors at(place.size());
    for (std::size_t k = 0; k < links_.size(); ++k)
      for (int c = 0; c < 2; ++c) at[links_[k].node][c] += links_[k].weight * v[k / 9][c] / mass[links_[k].node];
    return at;
  }
  /// The gather S v.
  Vectors gather(const Vectors& v) const {
    Vectors at(links_.size() / 9);
    for (std::size_t k = 0; k < links_.size(); ++k)
      for (int c = 0; c < 2; ++c) at[k / 9][c] += links_[k].weight * v[links_[k].node][c];
    return at;
  }
  /// The force -sum V0 tau grad w over the particle's mass; tau is xx, xy, yy.
  Vectors force(const std::vector<std::array<double, 3>>& tau, double volume_over_mass) const {
    Vectors at(place.size());
    for (std::size_t k = 0; k < links_.size(); ++k) {
      const auto& [node, weight, gradient] = links_[k];
      const auto& t = tau[k / 9];
      at[node][0] -= volume_over_mass * (t[0] * gradient[0] + t[1] * gradient[1]);
      at[node][1] -= volume_over_mass * (t[1] * gradient[0] + t[2] * gradient[1]);
    }
    return at;
  }

  std::vector<double> mass;  ///< mass of each node in particles
  Vectors place, centre;     ///< x_i, c_i

 private:
  struct Link {
    std::size_t node;
    double weight;
    std::array<double, 2> gradient;
  };
  std::size_t number(double i, double j) {
    const auto [at, fresh] = known_.try_emplace({i, j}, place.size());
    if (fresh) place.push_back({i * cell_, j * cell_});
    return at->second;
  }
  double cell_;
  std::vector<Link> links_;
  std::map<std::pair<double, double>, std::size_t> known_;
};

/// The unseen part (I - S S+) v.
inline Vectors unseen(const Nodes& nodes, const Vectors& v) {
  Vectors rest = nodes.gather(nodes.scatter(v));
  for (std::size_t p = 0; p < v.size(); ++p)
    for (int c = 0; c < 2; ++c) rest[p][c] = v[p][c] - rest[p][c];
  return rest;
}

/// The loss d_m of a rigid turn r: <r, (I - S S+)^m r> / <r, r>.
inline double taken_of_turn(const Vectors& position, double cell, int order) {
  const Nodes nodes(position, cell);
  Vectors turn;
  for (const auto& x : position) turn.push_back({-x[1], x[0]});
  const double whole = moment(position, turn);
  for (int m = 0; m < order; ++m) turn = unseen(nodes, turn);
  return moment(position, turn) / whole;
}

/// The particles of every body, Neo-Hookean and of equal mass.
struct Solid {
  Solid(const Scene& scene, double modulus, double poisson) {
    const double mu = modulus / (2 * (1 + poisson)), lambda = modulus * poisson / ((1 + poisson) * (1 - 2 * poisson));
    for (std::size_t body = 0; body < scene.experiment.bodies.size(); ++body) {
      const BodyState state = scene.body(static_cast<int>(body));
      for (const auto& x : pairs(state.position)) position.push_back(x);
      for (const auto& v : pairs(state.velocity)) velocity.push_back(v);
      volume_over_mass = state.volume / state.mass;
      add_stresses(state.material_state.at("deformation_gradient"), lambda, mu);
    }
  }
  double spin() const { return moment(position, velocity); }

  Vectors position, velocity;
  std::vector<std::array<double, 3>> stress;  ///< Kirchhoff stress: xx, xy, yy
  double volume_over_mass = 0;

 private:
  void add_stresses(const std::vector<double>& F, double lambda, double mu) {
    for (const double* f = F.data(); f != F.data() + F.size(); f += 4) {
      const double pressure = lambda * std::log(f[0] * f[3] - f[1] * f[2]) - mu;
      stress.push_back({mu * (f[0] * f[0] + f[1] * f[1]) + pressure, mu * (f[0] * f[2] + f[1] * f[3]),
                        mu * (f[2] * f[2] + f[3] * f[3]) + pressure});
    }
  }
};

/// The parts of the change of L over a run, over L at the start.
struct SpinBalance {
  double lumping = 0, motion = 0, filter = 0;
  double change = 0;  ///< change that the run shows
  double gap = 0;     ///< largest change in a step that the parts do not explain
  double torque = 0;  ///< largest torque of a step's forces about the nodes; none in exact arithmetic
};

/// Adds one step, from the particles before and after it. `order` 0 means no filter.
inline void add_step(const Solid& before, const Solid& after, double cell, double dt, int order, double whole,
                     SpinBalance& sum) {
  const Vectors &x = before.position, &v = before.velocity;
  const Nodes nodes(x, cell);
  const Vectors force = nodes.force(before.stress, before.volume_over_mass);
  const double lumping = dt * moment(nodes.centre, force) / whole;
  sum.torque = larger(sum.torque, std::abs(dt * moment(nodes.place, force) / whole));

  Vectors moved = after.position;
  for (std::size_t p = 0; p < x.size(); ++p)
    for (int c = 0; c < 2; ++c) moved[p][c] -= x[p][c];
  const double motion = moment(moved, after.velocity) / whole;

  Vectors rest = v;  // (I - S S+)^m v, which the filter takes
  for (int m = 0; m < order; ++m) rest = unseen(nodes, rest);
  const double filter = order > 0 ? -moment(x, rest) / whole : 0;

  const double change = (after.spin() - before.spin()) / whole;
  sum.lumping += lumping, sum.motion += motion, sum.filter += filter, sum.change += change;
  sum.gap = larger(sum.gap, std::abs(change - lumping - motion - filter));
}

/// Runs the scene to its end.
inline SpinBalance spin_balance(Scene& scene, double modulus, double poisson, int order = 0) {
  Solid before(scene, modulus, poisson);
  const double whole = before.spin();
  SpinBalance sum;
  while (!scene.simulation.finished()) {
    scene.simulation.step();
    Solid after(scene, modulus, poisson);
    add_step(before, after, scene.experiment.grid.cell_size, scene.simulation.last_time_step(), order, whole, sum);
    before = std::move(after);
  }
  return sum;
}

/// Prints a row: parts, their sum, the run's, the gap. Checks that the balance closes.
inline void check_balance(const std::string& name, const SpinBalance& b) {
  std::printf("  %-12s %11.3e %11.3e %11.3e | %11.3e %11.3e | %.1e\n", name.c_str(), b.lumping, b.motion, b.filter,
              b.lumping + b.motion + b.filter, b.change, b.gap);
  INFO(name);
  CHECK(b.gap < 1e-12);
  CHECK(b.torque < 1e-12);
}

}  // namespace mpm::test
