// Moves momentum, mass and forces from particles to grid, and velocities back.

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "backends/reference/reference_backend.hpp"

namespace mpm::reference {

void ReferenceBackend::scatter(const Pass& pass, const StepInfo& step) {
  if (pass.remap()) grid_.reset({"mass", "momentum"});
  for (std::size_t number = 0; number < bodies_.size(); ++number) {
    Particles& body = bodies_[number];
    if (!pass.remap() && pass.has(Act::scatter_momentum)) body.find_stencils(grid_);
    if (pass.has(Act::scatter_momentum)) scatter_momentum(body, step.time, pass.remap());
    if (pass.has(Act::scatter_force) || pass.has(Act::scatter_contact)) body.evaluate_stress();
    if (pass.has(Act::scatter_force) && plan_.does(Act::average_mean_stress))
      body.take_mean_stress(gathered(body, mean_stress_));
    if (pass.has(Act::scatter_force)) scatter_force(body);
    if (pass.has(Act::scatter_force)) scatter_loads(body, loads_[number], step.time);
    if (pass.has(Act::scatter_contact)) scatter_contact_fields(body);
    if (pass.has(Act::scatter_heat)) scatter_heat(body);
    if (pass.has(Act::scatter_momentum) && !pass.remap()) scatter_grips(body, step.time + step.dt);
  }
  if (!pass.has(Act::scatter_momentum)) return;
  if (accounted_ && !pass.remap()) book_scattered_sums();
  grid_.sum_images();
  if (pass.has(Act::scatter_heat)) account(heat_ledger_.scatter, sum(heat_) - heat_of_particles());
  if (accounted_ && !pass.remap()) book_scatter();
}

/// Gives each node w m, its weight, and the momentum as the transfer gives it.
void ReferenceBackend::scatter_momentum(Particles& body, double time, bool remap) {
  const Vector gravity = to_eigen(experiment_.gravity_at(time));
  body.scatter_coefficients();
  for (std::size_t p = 0; p < body.count(); ++p)
    for (const StencilNode& s : body.stencil(p)) {
      const std::size_t i = grid_.at(body.field(), s.index);
      mass_[i] += s.weight * body.mass(p);
      if (!remap) weight_[i] += s.weight * body.mass(p) * gravity;
    }
  scatter_affine(body, momentum_);
}

/// Gives each node w (b + A d), and sum w c P over the polynomials beyond affine.
void ReferenceBackend::scatter_affine(Particles& body, VectorField& momentum) {
  const bool affine = experiment_.transfer.plugin->transfer().traits & MPM_SCATTERS_AFFINE;
  const int D = experiment_.dimension;
  for (std::size_t p = 0; p < body.count(); ++p) {
    const Vector b = body.column(body.b, p);
    const Matrix A = affine ? body.matrix(body.A, p) : Matrix(Matrix::Zero());
    for (const StencilNode& s : body.stencil(p))
      momentum[grid_.at(body.field(), s.index)] += s.weight * (b + A * s.distance);
    for (int k = 0; k < plan_.basis_functions; ++k)
      for (std::size_t n = 0; n < body.stencil(p).size(); ++n)
        for (int c = 0; c < D; ++c)
          momentum[grid_.at(body.field(), body.stencil(p)[n].index)][c] +=
              body.higher_basis(p).given(k, static_cast<Eigen::Index>(n)) * body.higher(k * D + c, p);
  }
}

/// Moves each corner by the multilinear velocity of the nodes, and by what moves the particle beyond the gathered one.
void ReferenceBackend::gather_corners(Particles& body, const StepInfo& step) {
  const int D = experiment_.dimension;
  const double h = experiment_.grid.cell_size;
  const Array& corners = body.values("corners");
  Array& moved = body.values("moved_corners");
  for (std::size_t p = 0; p < body.count(); ++p) {
    const Vector own = body.column(body.advection, p) - body.column(body.gathered_velocity, p);
    for (int corner = 0; corner < plan_.sample_points; ++corner) {
      Vector velocity = own;
      Vector place = Vector::Zero(), lower = Vector::Zero();
      for (int a = 0; a < D; ++a) {
        place[a] = (body.position(a, p) - experiment_.grid.lower[a]) / h + corners(corner * D + a, p);
        lower[a] = std::floor(place[a]);
      }
      for (int which = 0; which < 1 << D; ++which) {
        double weight = 1;
        Eigen::Vector3i node = lower.cast<int>();
        for (int a = 0; a < D; ++a) {
          const bool upper = which >> a & 1;
          weight *= upper ? place[a] - lower[a] : 1 - (place[a] - lower[a]);
          node[a] += upper;
        }
        if (weight != 0) velocity += weight * velocity_[grid_.at(body.field(), grid_.index(node))];
      }
      for (int a = 0; a < D; ++a) moved(corner * D + a, p) = corners(corner * D + a, p) + step.dt / h * velocity[a];
    }
  }
}

/// Gathers the coefficients of the polynomials beyond affine in the given velocity.
void ReferenceBackend::gather_higher(Particles& body, const VectorField& velocities) {
  const int D = experiment_.dimension;
  if (plan_.basis_functions > 0) body.gathered_higher.setZero();
  for (std::size_t p = 0; p < body.count(); ++p)
    for (int k = 0; k < plan_.basis_functions; ++k)
      for (std::size_t n = 0; n < body.stencil(p).size(); ++n)
        for (int c = 0; c < D; ++c)
          body.gathered_higher(k * D + c, p) += body.higher_basis(p).taken(k, static_cast<Eigen::Index>(n)) *
                                                velocities[grid_.at(body.field(), body.stencil(p)[n].index)][c];
}

/// Adds f = -V0 tau grad w, or -V0 tau (w D^-1 d) when the transfer takes stress by the affine term, around an axis
/// also -w V0 tau_zz / r e_r.
void ReferenceBackend::scatter_force(Particles& body) {
  const bool by_affine = experiment_.transfer.plugin->transfer().traits & MPM_STRESS_BY_AFFINE;
  for (std::size_t p = 0; p < body.count(); ++p) {
    const Matrix tau = body.symmetric(body.stress, p);
    const Vector hoop = body.hoop_force(p);
    for (const StencilNode& s : body.stencil(p)) {
      const std::size_t i = grid_.at(body.field(), s.index);
      internal_force_[i] += s.weight * hoop - body.volume(p) * (tau * (by_affine ? s.affine : s.gradient));
    }
  }
}

/// Adds what loads give: w m a of forces per mass, w b + S grad w of those that act at points. Throws
/// RunFailure.
void ReferenceBackend::scatter_loads(Particles& body, const BodyLoads& loads, double time) {
  const int D = experiment_.dimension, count = static_cast<int>(body.count());
  const bool keeps_start = plan_.particle_field(body.number(), "initial_position") != nullptr;
  FirstFailure failures;
  const auto read = [&](int p, LoadedParticle& particle) {
    for (int c = 0; c < D; ++c) {
      particle.x[c] = body.position(c, p), particle.v[c] = body.velocity(c, p);
      particle.X[c] = keeps_start ? body.values("initial_position")(c, p) : particle.x[c];
    }
    for (int k = 0; loads.at_points() && k < D * D; ++k) particle.F[k] = body.values("deformation")(k, p);
  };
  for (const External& external : external_forces_) {
    if (!loads.gives(external.kind)) continue;
    const auto scatter = [&](std::size_t p, const Vector& b, const Matrix& S) {
      for (const StencilNode& s : body.stencil(p))
        (*external.force)[grid_.at(body.field(), s.index)] += s.weight * b + S * s.gradient;
    };
    if (external.kind == ExternalForce::body_force) {
      for (int p = 0; p < count; ++p) {
        LoadedParticle particle;
        read(p, particle);
        const Vector3 acceleration =
            loads.acceleration(static_cast<std::size_t>(p), particle.x, particle.X, time, failures);
        scatter(p, body.mass(p) * to_eigen(acceleration), Matrix::Zero());
      }
      continue;
    }
    const auto give = [&](int p, const LoadCoefficients& given) {
      Matrix S = Matrix::Zero();
      for (int i = 0; i < D; ++i)
        for (int j = 0; j < D; ++j) S(i, j) = given.S[D * i + j];
      scatter(p, to_eigen(given.b), S);
    };
    loads.evaluate(external.kind, count, nullptr, time, read, give, failures);
  }
  failures.raise();
}

void ReferenceBackend::scatter_contact_fields(Particles& body) {
  for (std::size_t p = 0; p < body.count(); ++p) {
    const double volume = body.volume(p) * body.volume_ratio(0, p);
    const double section = body.axisymmetric() ? volume / (2 * std::numbers::pi * body.position(0, p)) : volume;
    Vector moved = Vector::Zero();
    Matrix gradient = Matrix::Zero();
    if (sums_displacements_) {
      const int D = experiment_.dimension;
      moved = body.column(body.position, p) - body.column(body.values("initial_position"), p);
      gradient.topLeftCorner(D, D) =
          Eigen::MatrixXd::Identity(D, D) - body.matrix(body.values("deformation"), p).topLeftCorner(D, D).inverse();
    }
    for (const StencilNode& s : body.stencil(p)) {
      const std::size_t i = grid_.at(body.field(), s.index);
      // These are gradients of the section: a ring's volume grows away from the axis.
      volume_gradient_[i] += section * s.gradient;
      if (sums_mass_gradients_) mass_gradient_[i] += section / volume * body.mass(p) * s.gradient;
      if (sums_mass_positions_) mass_position_[i] -= s.weight * body.mass(p) * s.distance;
      if (sums_displacements_) mass_displacement_[i] += s.weight * body.mass(p) * (moved + gradient * s.distance);
      for (int k = 0; k < contact_states_; ++k) {
        mass_state_[i][k] += s.weight * body.mass(p) * body.values("contact_state")(k, p);
        mass_gain_[i][k] += s.weight * body.mass(p) * body.values("contact_gain")(k, p);
      }
    }
  }
}

/// Gives nodes the mass of gripped particles, the momentum that these have now, and the one that they are told to have
/// at a time, the end of the step.
void ReferenceBackend::scatter_grips(Particles& body, double time) {
  if (experiment_.grips.empty()) return;
  for (std::size_t p = 0; p < body.count(); ++p) {
    const int grip = static_cast<int>(body.values("grip")(0, p)) - 1;
    if (grip < 0) continue;
    const std::string id = grip_field(static_cast<std::size_t>(grip));
    const Vector now = body.column(body.velocity, p), then = velocity_of_gripped(body, p, time);
    for (const StencilNode& s : body.stencil(p)) {
      const std::size_t i = grid_.at(body.field(), s.index);
      grid_.scalar(id + "_mass")[i] += s.weight * body.mass(p);
      grid_.vector(id)[i] += s.weight * body.mass(p) * then;
      grid_.vector(id + "_before")[i] += s.weight * body.mass(p) * now;
    }
  }
}

/// The velocity that a gripped particle is told to have at a time; components that its grip leaves free are anything.
Vector ReferenceBackend::velocity_of_gripped(Particles& body, std::size_t p, double time) const {
  const Grip& grip = experiment_.grips[static_cast<std::size_t>(body.values("grip")(0, p)) - 1];
  const Vector x = body.column(body.position, p);
  const Vector X = plan_.particle_field(0, "initial_position") ? body.column(body.values("initial_position"), p) : x;
  return to_eigen(velocity_of(experiment_, grip, as_array(x), as_array(X), time));
}

/// Gives gripped particles the velocity that they are told to have, and lets it move them.
void ReferenceBackend::move_gripped(Particles& body, const StepInfo& step) {
  for (std::size_t p = 0; p < body.count(); ++p) {
    const int number = static_cast<int>(body.values("grip")(0, p)) - 1;
    if (number < 0) continue;
    const Grip& grip = experiment_.grips[static_cast<std::size_t>(number)];
    const Vector told = velocity_of_gripped(body, p, step.time + step.dt), gathered = body.column(body.velocity, p);
    Vector velocity = gathered, advection = body.column(body.advection, p);
    for (int c = 0; c < experiment_.dimension; ++c)
      if (grip.held[c]) velocity[c] = advection[c] = told[c];
    body.set(body.velocity, p, velocity);
    body.set(body.advection, p, advection);
    GivenToGripped given;
    given.add(body.mass(p), as_array(body.column(body.position, p)), as_array(gathered), as_array(velocity));
    given_to_gripped_ += given.energy;
    reactions_.give_particles(experiment_.support_of_grip(static_cast<std::size_t>(number)), given, step.dt);
  }
}

void ReferenceBackend::gather(const Pass& pass, const StepInfo& step) {
  double heat = 0;
  given_to_gripped_ = 0;
  for (Particles& body : bodies_) {
    gather_moments(body, velocity_);
    const Array before = body.velocity;
    body.gather(step.dt);
    if (step.filtered) body.take_gathered_velocity(before, experiment_.filter_schedule.moves_by_mean);
    if (!experiment_.grips.empty()) move_gripped(body, step);
    if (plan_.sample_points > 0) gather_corners(body, step);
    if (pass.has(Act::gather_heat)) gather_heat(body, step), heat += body.heat();
    if (pass.has(Act::strain)) strain(body, pass.share * step.dt);
  }
  if (accounted_) book_gather(pass, step.dt);
  if (pass.has(Act::gather_heat)) account(heat_ledger_.gather, heat - heat_after_);
  if (pass.has(Act::move)) move(step);
  if (pass.has(Act::change_phase)) change_phase();
}

/// Gathers sum w v, sum w (v - v-), C = sum v (x) w D^-1 d and L = sum v (x) grad w of a velocity, v+ as a rule.
void ReferenceBackend::gather_moments(Particles& body, const VectorField& velocities) {
  const bool strain_by_affine = experiment_.transfer.plugin->transfer().traits & MPM_STRAIN_BY_AFFINE;
  for (std::size_t p = 0; p < body.count(); ++p) {
    Vector velocity = Vector::Zero(), increment = Vector::Zero();
    Matrix affine = Matrix::Zero(), gradient = Matrix::Zero();
    for (const StencilNode& s : body.stencil(p)) {
      const std::size_t i = grid_.at(body.field(), s.index);
      const Vector& v = velocities[i];
      velocity += s.weight * v;
      increment += s.weight * (v - velocity_before_[i]);
      affine += v * s.affine.transpose();
      gradient += v * s.gradient.transpose();
    }
    body.set(body.gathered_velocity, p, velocity);
    body.set(body.gathered_increment, p, increment);
    body.set(body.gathered_affine, p, affine);
    body.set(body.gathered_gradient, p, gradient);
    body.set(body.velocity_gradient, p, strain_by_affine ? affine : gradient);
  }
  gather_higher(body, velocities);
}

void ReferenceBackend::strain(const Pass& pass, const StepInfo& step) {
  if (accounted_ && pass.remap()) ledger_.remapped_strain -= pass.share * (power_of_forces(step.dt) - lumped_power_);
  if (pass.stage == Stage::before_forces) early_share_ = pass.share;
  for (Particles& body : bodies_) {
    gather_moments(body, velocity_);
    strain(body, pass.share * step.dt);
  }
}

void ReferenceBackend::strain(Particles& body, double dt) {
  if (plan_.does(Act::average_dilation)) body.mean_dilation = gathered(body, dilation_);
  const StrainEnergies energies = body.strain(dt, accounted_);
  if (accounted_) ledger_.enter_strain(body.dissipation(), energies);
  account(heat_ledger_.dissipation, body.share_of_heat() * energies.dissipated);
}

}  // namespace mpm::reference
