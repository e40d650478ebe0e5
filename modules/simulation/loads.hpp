#pragma once
// What loads make of the particles that carry them, for all backends: a particle gives each of its nodes w b + S grad w.
//
// A force acts at a point of the body beside the particle that is nearest to it, at r from its centre. The field of the
// nodes' velocities there, to first order about the particle, is sum v (w + r . grad w); what has the same power is
// b = sum f and S = sum f (x) r, so that work on every affine motion is exact, no node is pushed that the particle does
// not reach, and none that has no mass. Points and normals follow the particle's deformation F: r = F r0, and the
// area vector n da = cof(F) N dA (Nanson).

#include <array>
#include <cstdint>
#include <vector>

#include "operators/loads.hpp"
#include "simulation/backend.hpp"
#include "simulation/failure.hpp"

namespace mpm {

/// The entries of the ledger that the works of forces from outside have, in the order of ExternalForce.
inline constexpr std::array<double Ledger::*, external_force_count> external_rows{
    &Ledger::body_force, &Ledger::surface_load, &Ledger::point_load, &Ledger::spring, &Ledger::dashpot};
constexpr double Ledger::*row_of(ExternalForce force) {
  return external_rows[static_cast<std::size_t>(force)];
}

/// A particle as its loads see it. Tensors are row-major with the dimension of the scene.
struct LoadedParticle {
  Vector3 x{}, X{}, v{};      ///< m, m at the start, m/s
  std::array<double, 9> F{};  ///< deformation gradient; only where Experiment::loaded_at_points
};

/// What a particle gives a node: w b + S grad w.
struct LoadCoefficients {
  Vector3 b{};                ///< N
  std::array<double, 9> S{};  ///< N m, row-major with the dimension of the scene
};

/// The loads of one body, taken to its particles where they are seeded.
class BodyLoads {
 public:
  BodyLoads(const Experiment& experiment, int body, const SeededBody& seeds);

  bool gives(ExternalForce force) const { return gives_[static_cast<std::size_t>(force)]; }
  bool any() const;
  /// Whether particles give S, and keep the deformation gradient that it needs.
  bool at_points() const { return !first_.empty(); }
  /// Whether forces per mass depend on where a particle is, and on where it began.
  bool accelerations_use_position() const;
  bool accelerations_use_initial_position() const;
  /// The acceleration of a particle by forces per mass, N/kg, at the time of a step's begin. Notes one that is not finite.
  Vector3 acceleration(std::size_t id, const Vector3& x, const Vector3& X, double time, FirstFailure& failures) const;
  /// The same of many particles, an array a component; ids[p] is the index of seeding. In the
  /// precision of the places; lanes hold twice as many floats.
  template <class T>
  void accelerations(std::size_t count, const std::int32_t* ids, const PointArrays<T>& at, double time,
                     const std::array<T*, 3>& result, FirstFailure& failures) const;
  /// Notes which formulas give a particle no finite acceleration, the first one where that does not show.
  void note_acceleration(std::size_t id, const Vector3& x, const Vector3& X, double time, FirstFailure& failures) const;

  /// What particles carry of loads at points: those of the particle with the index `id` of seeding are
  /// shares()[first_shares()[id]] to shares()[first_shares()[id + 1]]. Both are empty where nothing acts at points.
  const std::vector<LoadShare<double>>& shares() const { return shares_; }
  const std::vector<std::uint32_t>& first_shares() const { return first_; }

  /// The failure of the first load at points that a particle carries whose formula gives no number, as a backend has found
  /// of one of them; of the first one with a formula where none shows it here. Throws std::bad_optional_access without any.
  Failure failed_formula(std::size_t id, const LoadedParticle& particle, double time) const;

  /// Evaluates a kind of force that acts at points, at the time of a step's begin: calls give(p, coefficients) for those
  /// of `count` particles that carry some, after read(p, particle) has filled the particle, and notes those whose load is
  /// not finite. ids[p] is the index of seeding, or p itself where ids is null. Returns whether any carries some.
  template <class Read, class Give>
  bool evaluate(ExternalForce force, int count, const std::int32_t* ids, double time, Read&& read, Give&& give,
                FirstFailure& failures) const {
    bool any = false;
    for (int p = 0; p < count; ++p) {
      const std::size_t id = static_cast<std::size_t>(ids ? ids[p] : p);
      if (!carries(force, id)) continue;
      LoadedParticle particle;
      read(p, particle);
      give(p, dimension_ == 2 ? coefficients<2>(force, id, particle, time, failures)
                              : coefficients<3>(force, id, particle, time, failures));
      any = true;
    }
    return any;
  }

 private:
  using Share = LoadShare<double>;
  /// A force per mass; `load` is null for that of the whole scene.
  struct PerMass {
    const VectorExpression* expression;
    const Load* load;
  };
  /// Whether all values are numbers that the scene's precision holds.
  bool all_held(const Vector3& values) const;
  bool carries(ExternalForce force, std::size_t id) const;
  template <int D>
  LoadCoefficients coefficients(ExternalForce force, std::size_t id, const LoadedParticle& particle, double time,
                                FirstFailure& failures) const;
  void take_shares(const SeededBody& seeds);
  Surface pieces_of(const Load& load) const;

  const Experiment& experiment_;
  int body_, dimension_;
  double spacing_;  ///< m, of the particles as they are seeded
  std::array<bool, external_force_count> gives_{};
  std::vector<PerMass> accelerations_;  ///< all that act on the body
  std::vector<std::uint32_t> first_;    ///< first share of each particle, by the index of seeding, and the end of all
  std::vector<Share> shares_;
};

}  // namespace mpm
