#include "drive/drive.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "experiment/diagnostics.hpp"

namespace mpm::drive {
namespace {

constexpr int most_open = 6;
/// One number an open component.
struct Open {
  std::array<double, most_open> v{};
  double& operator[](std::size_t k) { return v[k]; }
  double operator[](std::size_t k) const { return v[k]; }
};
using Slope = std::array<Open, most_open>;  ///< [open component], the derivative of each stress

Matrix sum(const Matrix& a, const Matrix& b, double factor = 1) {
  Matrix r;
  for (int k = 0; k < 9; ++k) r.m[k] = a.m[k] + factor * b.m[k];
  return r;
}

Matrix scaled(const Matrix& a, double factor) {
  return sum(Matrix{}, a, factor);
}

double contraction(const Symmetric& a, const Matrix& b) {
  double r = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r += a(i, j) * b(i, j);
  return r;
}

double largest(const Symmetric& a) {
  double r = 0;
  for (const double value : a.s) r = std::max(r, std::abs(value));
  return r;
}

/// The shortest x with A x = b, or nearest to it: by singular values (one-sided Jacobi), those below 1e-13 of the largest
/// left out. A fluid leaves sides open that no stress tells apart; they then move alike. Column k of A is columns[k].
Open shortest_solution(Slope columns, const Open& b, std::size_t n) {
  Slope right{};
  for (std::size_t k = 0; k < n; ++k) right[k][k] = 1;
  const auto dot = [&](const Open& x, const Open& y) {
    double r = 0;
    for (std::size_t k = 0; k < n; ++k) r += x[k] * y[k];
    return r;
  };
  for (int sweep = 0; sweep < 30; ++sweep)
    for (std::size_t p = 0; p < n; ++p)
      for (std::size_t q = p + 1; q < n; ++q) {
        const double pp = dot(columns[p], columns[p]), qq = dot(columns[q], columns[q]),
                     pq = dot(columns[p], columns[q]);
        if (std::abs(pq) <= 1e-16 * std::sqrt(pp * qq)) continue;
        const double ratio = (qq - pp) / (2 * pq);
        const double t = (ratio >= 0 ? 1 : -1) / (std::abs(ratio) + std::sqrt(1 + ratio * ratio));
        const double c = 1 / std::sqrt(1 + t * t), s = c * t;
        for (Slope* of : {&columns, &right})
          for (std::size_t k = 0; k < n; ++k) {
            const double x = (*of)[p][k], y = (*of)[q][k];
            (*of)[p][k] = c * x - s * y;
            (*of)[q][k] = s * x + c * y;
          }
      }
  double most = 0;
  for (std::size_t k = 0; k < n; ++k) most = std::max(most, std::sqrt(dot(columns[k], columns[k])));
  Open x;
  for (std::size_t k = 0; k < n; ++k) {
    const double squared = dot(columns[k], columns[k]);
    if (!(std::sqrt(squared) > 1e-13 * most)) continue;
    const double share = dot(columns[k], b) / squared;
    for (std::size_t m = 0; m < n; ++m) x[m] += share * right[k][m];
  }
  return x;
}

/// One step of a stage: what it imposes, and Newton's search for what it leaves open.
class StepProblem {
 public:
  StepProblem(const MaterialPoint& point, const Stage& stage, const Matrix& F, double dt, double modulus, Slopes slopes)
      : point_(point),
        stage_(stage),
        n_(stage.stresses.size()),
        dt_(dt),
        modulus_(modulus),
        by_tangent_(slopes == Slopes::tangent && point.has_tangent()),
        inverse_F_(inverse(F)) {}

  /// The imposed part of the change of F, or of dt L.
  Matrix imposed{};
  Open wanted;  ///< the prescribed stresses, Pa
  long iterations = 0;

  /// The increment dt L that belongs to open components: a change of F is taken on F itself.
  Matrix increment(const Open& open) const {
    Matrix change = imposed;
    for (std::size_t k = 0; k < n_; ++k) change(stage_.stresses[k].i, stage_.stresses[k].j) += open[k];
    return stage_.motion == Motion::velocity_gradient ? change : change * inverse_F_;
  }

  /// Looks for the open components from a first guess; they stay in `open`. Returns whether they were found.
  bool solve(Open& open) {
    Trial now = attempt(open);
    if (!now.response.is_admissible) open = Open(), now = attempt(open);
    began_ = now.response;
    for (int round = 0; round < 60 && now.response.is_admissible; ++round) {
      missing_ = now.missing;
      if (reached(now)) return true;
      ++iterations;
      Found next = search(open, now, slopes(open, now));
      // At the tip of a cone the tangent may be the one of a loose material: it gives way to the stiffer side.
      if (!(next.trial.size < now.size))
        if (const Found other = search(open, now, stiffer_slopes(open)); other.trial.size < next.trial.size)
          next = other;
      open = next.open, now = next.trial;
    }
    return false;
  }

  /// The answer that the search began from, with the open components as the step before left them. Where the material
  /// does not take that state no stress was found, and none missed.
  const Response& began() const { return began_; }

  /// The stress that misses its value by most, in words, after a search that failed.
  std::string miss_text() const {
    std::size_t worst = 0;
    for (std::size_t k = 1; k < n_; ++k)
      if (!(std::abs(missing_[k]) <= std::abs(missing_[worst]))) worst = k;
    const Prescribed& at = stage_.stresses[worst];
    return std::string("stress ") + "xyz"[at.i] + "xyz"[at.j] + " is to be " + number_text(wanted[worst]) +
           " Pa and misses it by " + number_text(std::abs(missing_[worst])) + " Pa";
  }

 private:
  struct Trial {
    Response response;
    Open missing;     ///< wanted less found, Pa
    double size = 0;  ///< of the largest of them
  };

  struct Found {
    Open open;
    Trial trial;
  };

  /// Takes Newton's step, halved until the stress misses less; else the share of it that misses least.
  Found search(const Open& open, const Trial& now, const Slope& slope) const {
    const Open step = shortest_solution(slope, now.missing, n_);
    Found best{open, now};
    double least = INFINITY;
    for (double share = 1; share > 1e-3; share /= 2) {
      Open next = open;
      for (std::size_t k = 0; k < n_; ++k) next[k] += share * step[k];
      const Trial trial = attempt(next);
      if (!trial.response.is_admissible || !(trial.size < least)) continue;
      best = {next, trial}, least = trial.size;
      if (trial.size < now.size) break;
    }
    return best;
  }

  Trial attempt(const Open& open) const {
    Trial trial{point_.trial(scaled(increment(open), 1 / dt_), dt_), {}, 0};
    for (std::size_t k = 0; k < n_; ++k) {
      trial.missing[k] = wanted[k] - trial.response.cauchy(stage_.stresses[k].i, stage_.stresses[k].j);
      trial.size = std::max(trial.size, std::abs(trial.missing[k]));
    }
    return trial;
  }

  bool reached(const Trial& trial) const {
    double scale = largest(trial.response.kirchhoff) / std::abs(trial.response.volume_ratio);
    for (std::size_t k = 0; k < n_; ++k) scale = std::max(scale, std::abs(wanted[k]));
    return trial.size <= 1e-12 * scale + 1e-13 * modulus_;
  }

  /// The change of dt L with an open component.
  Matrix direction(std::size_t k) const {
    Matrix one{};
    one(stage_.stresses[k].i, stage_.stresses[k].j) = 1;
    return stage_.motion == Motion::velocity_gradient ? one : one * inverse_F_;
  }

  /// The derivative of each stress by each open component.
  Slope slopes(const Open& open, const Trial& at) const {
    Slope result{};
    const Matrix H = increment(open);
    for (std::size_t k = 0; k < n_; ++k)
      result[k] = by_tangent_ ? tangent(H, direction(k), at.response) : difference(H, direction(k), h, -h);
    return result;
  }

  /// Of the differences to either side the larger ones.
  Slope stiffer_slopes(const Open& open) const {
    Slope result{};
    const Matrix H = increment(open);
    for (std::size_t k = 0; k < n_; ++k) {
      const Open ahead = difference(H, direction(k), h, 0), behind = difference(H, direction(k), 0, -h);
      double change = 0;
      for (std::size_t m = 0; m < n_; ++m) change += ahead[m] * ahead[m] - behind[m] * behind[m];
      result[k] = change > 0 ? ahead : behind;
    }
    return result;
  }

  /// d sigma = (d tau - tau tr(f^-1 dH)) / J with f = I + H.
  Open tangent(const Matrix& H, const Matrix& change, const Response& at) const {
    const Symmetric rate = point_.stress_change(scaled(H, 1 / dt_), dt_, scaled(change, 1 / dt_));
    const Matrix late = inverse(sum(Matrix::identity(), H)) * change;
    const double growth = late(0, 0) + late(1, 1) + late(2, 2);
    Open slope;
    for (std::size_t k = 0; k < n_; ++k) {
      const auto& [i, j, value, pointer] = stage_.stresses[k];
      slope[k] = (rate(i, j) - at.kirchhoff(i, j) * growth) / at.volume_ratio;
    }
    return slope;
  }

  /// The difference quotient of each stress between two shares of a change.
  Open difference(const Matrix& H, const Matrix& change, double upper, double lower) const {
    const Response ahead = point_.trial(scaled(sum(H, change, upper), 1 / dt_), dt_),
                   behind = point_.trial(scaled(sum(H, change, lower), 1 / dt_), dt_);
    Open slope;
    for (std::size_t k = 0; k < n_; ++k) {
      const auto& [i, j, value, pointer] = stage_.stresses[k];
      slope[k] = (ahead.cauchy(i, j) - behind.cauchy(i, j)) / (upper - lower);
    }
    return slope;
  }

  static constexpr double h = 1e-6;  ///< of dt L, for differences
  const MaterialPoint& point_;
  const Stage& stage_;
  const std::size_t n_;
  const double dt_, modulus_;
  const bool by_tangent_;
  const Matrix inverse_F_;
  Open missing_;
  Response began_;
};

class Follower {
 public:
  Follower(const DriveExperiment& path, Slopes slopes, const std::function<bool()>& stop_requested)
      : path_(path),
        slopes_(slopes),
        stop_requested_(stop_requested),
        point_(path.material(), path.experiment.dimension),
        clamps_(*path.material().plugin, path.material().parameters) {
    course_.columns = point_.columns();
    Row start;
    start.response = point_.look();
    density_ = path.material().parameter("density");
    add(start);
  }

  Course run() {
    if (!course_.rows.front().response.is_admissible)
      return stop(0, 0, 0, "the plugin does not take its own initial state", "check its parameters: mpm test-plugin");
    for (std::size_t k = 0; k < path_.stages.size() && !course_.stop && !course_.is_interrupted; ++k)
      follow_stage(static_cast<int>(k));
    course_.warnings = clamps_.warnings(path_.experiment.materials.front().name);
    return std::move(course_);
  }

 private:
  const Row& last() const { return course_.rows.back(); }

  Course& stop(int stage, int step, double time, std::string reason, std::string remedy) {
    course_.stop = Stop{stage, step, time, std::move(reason), std::move(remedy)};
    return course_;
  }

  void add(Row row) {
    if (clamps_.is_waiting()) point_.look_for_clamps(clamps_, row.time);
    for (const StateColumn& column : point_.columns()) row.state.push_back(point_.value(column));
    course_.rows.push_back(std::move(row));
  }

  void follow_stage(int index) {
    const Stage& stage = path_.stages[index];
    const double began = last().time, dt = stage.duration / stage.steps;
    Open open;  // what the step before found: the next one begins its search there
    for (int step = 1; step <= stage.steps; ++step) {
      if (stop_requested_ && stop_requested_()) {
        course_.is_interrupted = true;
        return;
      }
      const double modulus = density_ * last().response.wave_speed * last().response.wave_speed;
      StepProblem problem(point_, stage, last().F, dt, modulus, slopes_);
      const double end = stage.duration * step / stage.steps;
      if (!impose(stage, step, began, end, dt, problem)) return;
      const bool found = stage.stresses.empty() || problem.solve(open);
      course_.iterations += problem.iterations;
      if (!found && !problem.began().is_admissible)
        return refuse_state(index, step, began + end, problem.increment(open), problem.began());
      if (!found) {
        stop(
            index, step, began + end, "no strain was found with the prescribed stress: " + problem.miss_text(),
            "take more steps; if that does not help the material may have no such state (a stress beyond its strength, "
            "a pull on what does not hold together): prescribe strain in place of that stress");
        return;
      }
      if (!take(index, step, began + end, dt, problem.increment(open))) return;
    }
  }

  /// Puts what the step imposes. Returns false, with the reason kept, where a formula has no finite value.
  bool impose(const Stage& stage, int step, double began, double end, double dt, StepProblem& problem) {
    const int index = static_cast<int>(&stage - path_.stages.data());
    const auto value_of = [&](const Prescribed& prescribed, double time, double& value) {
      value = prescribed.value({}, {}, time);
      if (std::isfinite(value)) return true;
      const auto trouble = prescribed.value.not_finite({}, {}, time);
      stop(index, step, began + end,
           prescribed.pointer + " is not a finite number at t = " + number_text(time) + " s of its stage" +
               (trouble ? ": " + trouble->why : ""),
           "change the formula, or end the stage before");
      return false;
    };
    for (const Prescribed& prescribed : stage.imposed) {
      const bool rate = stage.motion == Motion::velocity_gradient;
      double value = 0;
      if (!value_of(prescribed, rate ? end - dt / 2 : end, value)) return false;
      problem.imposed(prescribed.i, prescribed.j) = rate ? dt * value : value - last().F(prescribed.i, prescribed.j);
    }
    for (std::size_t k = 0; k < stage.stresses.size(); ++k)
      if (!value_of(stage.stresses[k], end, problem.wanted[k])) return false;
    return true;
  }

  /// Advances the point by dt L and books the step. Returns false, with the reason kept, where the state is none.
  bool take(int stage, int step, double time, double dt, const Matrix& H) {
    Row row;
    row.time = time, row.stage = stage, row.step = last().step + 1;
    row.F = sum(last().F, H * last().F);
    row.work = last().work + work_of(H, dt);
    row.response = point_.advance(scaled(H, 1 / dt), dt);
    row.dissipated = last().dissipated + row.response.dissipated;
    if (!row.response.is_admissible || !std::isfinite(row.work)) {
      refuse_state(stage, step, time, H, row.response);
      return false;
    }
    add(std::move(row));
    return true;
  }

  void refuse_state(int stage, int step, double time, const Matrix& H, const Response& response) {
    stop(stage, step, time,
         "the material does not take the state: det F is " + number_text(determinant(sum(last().F, H * last().F))) +
             ", J " + number_text(response.volume_ratio),
         "impose a smaller strain, in smaller steps");
  }

  /// The work of a step per initial volume: the integral over s of tau(s) : H (I + s H)^-1.
  double work_of(const Matrix& H, double dt) const {
    const double far = std::sqrt(0.15);  // of the three points on the interval from 0 to 1
    double work = 0;
    for (const auto& [s, weight] :
         {std::pair{0.5 - far, 5.0 / 18}, std::pair{0.5, 8.0 / 18}, std::pair{0.5 + far, 5.0 / 18}}) {
      const Response there = point_.trial(scaled(H, 1 / dt), s * dt);
      work += weight * contraction(there.kirchhoff, H * inverse(sum(Matrix::identity(), H, s)));
    }
    return work;
  }

  const DriveExperiment& path_;
  const Slopes slopes_;
  const std::function<bool()>& stop_requested_;
  MaterialPoint point_;
  ClampWatch clamps_;
  double density_ = 0;
  Course course_;
};

}  // namespace

Course follow(const DriveExperiment& path, Slopes slopes, const std::function<bool()>& stop_requested) {
  return Follower(path, slopes, stop_requested).run();
}

}  // namespace mpm::drive
