// The energy ledger: whoever gives a node an impulse notes it, and at the end of each stage of the step (before the
// forces, after them, in a filter) the works of these are booked. Nothing is taken for the rest of something else, so
// that kinetic energies, works, stresses and stored energies are measured apart and must agree.

#include "backends/reference/reference_backend.hpp"

namespace mpm::reference {

void ReferenceBackend::record(VectorField& impulse, VectorField& standing, std::size_t i, const Vector& given) {
  if (!records_) return;
  impulse[i] += given;
  if (keeps_constraints_) standing[i] += given;
}

/// Notes that a filter's loop takes back what conditions and contact have given the node so far. The rest of
/// `constrained` came with the filter's correction.
void ReferenceBackend::take_back(std::size_t i) {
  Vector of_filter = mass_[i] * constrained_[i];
  const auto take = [&](bool planned, VectorField& impulse, VectorField& standing) {
    if (!planned) return;
    impulse[i] -= standing[i];
    of_filter -= standing[i];
    standing[i].setZero();
  };
  take(plan_.node_field("standing_boundary_impulse"), boundary_impulse_, standing_boundary_impulse_);
  take(plan_.node_field("standing_contact_impulse"), contact_impulse_, standing_contact_impulse_);
  filter_impulse_[i] -= of_filter;
}

/// Books a work on the nodes.
void ReferenceBackend::book(double Ledger::*row, double work) {
  ledger_.*row += work;
  works_ += work;
}

double ReferenceBackend::particle_kinetic_energy() const {
  double sum = 0;
  for (const Particles& body : bodies_) sum += body.kinetic_energy();
  return sum;
}

/// Compares what the particles have with what the nodes were given.
void ReferenceBackend::book_scattered_sums() {
  double mass = 0;
  Vector momentum = Vector::Zero();
  for (const Particles& body : bodies_)
    for (std::size_t p = 0; p < body.count(); ++p) {
      mass += body.mass(p);
      momentum += body.mass(p) * body.column(body.velocity, p);
    }
  for_each_node([&](std::size_t i) {
    mass -= mass_[i];
    momentum -= momentum_[i];
  });
  ledger_.mass_book += mass;
  ledger_.momentum_book += momentum.norm();
}

void ReferenceBackend::book_scatter() {
  scattered_energy_ = grid_.kinetic_energy();
  works_ = 0;
  ledger_.scatter += scattered_energy_ - particle_kinetic_energy();
}

/// Books the works of the stage's impulses at the mean of the velocities before and after them, and forgets them.
void ReferenceBackend::book_impulses() {
  struct Row {
    double Ledger::*row;
    VectorField* impulse;
  };
  std::vector<Row> rows;
  for (const auto& [row, impulse, id] : {std::tuple{&Ledger::boundary, &boundary_impulse_, "boundary_impulse"},
                                         std::tuple{&Ledger::contact, &contact_impulse_, "contact_impulse"},
                                         std::tuple{&Ledger::filter, &filter_impulse_, "filter_impulse"}})
    if (plan_.node_field(id)) rows.push_back({row, impulse});
  for_each_node([&](std::size_t i) {
    if (mass_[i] <= 0) return;
    Vector all = Vector::Zero();
    for (const Row& row : rows) all += (*row.impulse)[i];
    const Vector mean = velocity_[i] - all / (2 * mass_[i]);
    for (const Row& row : rows) {
      book(row.row, (*row.impulse)[i].dot(mean));
      (*row.impulse)[i].setZero();
    }
  });
}

/// Books the works of a filter's loop, and what they do not explain of the kinetic energy.
void ReferenceBackend::book_filter() {
  const double works = works_, before = energy_after_;
  book_impulses();
  energy_after_ = grid_.kinetic_energy();
  ledger_.filter_book += energy_after_ - before - (works_ - works);
  works_ = works + energy_after_ - before;
}

/// Books the works of forces and of the impulses after them at the mean of v- and v+, and forgets the impulses.
void ReferenceBackend::book_forces(double dt) {
  const bool held = plan_.node_field("boundary_impulse"), meets = plan_.node_field("contact_impulse"),
             damps = plan_.node_field("damping_impulse");
  for_each_node([&](std::size_t i) {
    if (mass_[i] <= 0) return;
    const Vector mean = 0.5 * (velocity_before_[i] + velocity_[i]);
    book(&Ledger::internal_force, dt * internal_force_[i].dot(mean));
    for (const External& external : external_forces_) book(external.row, dt * (*external.force)[i].dot(mean));
    for (int c = 0; c < 3; ++c)
      book(experiment_.gravity_has_potential(c) ? &Ledger::gravity : &Ledger::gravity_without_potential,
           dt * weight_[i][c] * mean[c]);
    if (held) book(&Ledger::boundary, boundary_impulse_[i].dot(mean)), boundary_impulse_[i].setZero();
    if (meets) book(&Ledger::contact, contact_impulse_[i].dot(mean)), contact_impulse_[i].setZero();
    if (damps) book(&Ledger::damping, damping_impulse_[i].dot(mean)), damping_impulse_[i].setZero();
  });
  lumped_power_ = power_of_forces(dt);
  lumped_lift_ = power_of_weight(dt);
  energy_after_ = grid_.kinetic_energy();
}

/// The work of the stresses' forces at the velocity of the nodes as it is now, J.
double ReferenceBackend::power_of_forces(double dt) {
  double sum = 0;
  for_each_node([&](std::size_t i) {
    if (mass_[i] > 0) sum += dt * internal_force_[i].dot(velocity_[i]);
  });
  return sum;
}

/// The work of gravity, where it has a potential, at the velocity of the nodes as it is now, J.
double ReferenceBackend::power_of_weight(double dt) {
  double sum = 0;
  for_each_node([&](std::size_t i) {
    if (mass_[i] <= 0) return;
    for (int c = 0; c < 3; ++c)
      if (experiment_.gravity_has_potential(c)) sum += dt * weight_[i][c] * velocity_[i][c];
  });
  return sum;
}

/// Books what strain before the forces stored less by the filtered velocity, the one of now, than by the one kept
/// aside. Neither forces nor velocities are folded yet, so that ghosts count.
void ReferenceBackend::book_filtered_strain(double dt) {
  for_each_node([&](std::size_t i) {
    ledger_.filtered_strain -= early_share_ * dt * internal_force_[i].dot(velocity_[i] - unfiltered_[i]);
  });
}

void ReferenceBackend::book_gather(const Pass& pass, double dt) {
  const double gathered = grid_.kinetic_energy();
  ledger_.gather += particle_kinetic_energy() - gathered - given_to_gripped_;
  ledger_.boundary += given_to_gripped_;
  ledger_.grid_book += gathered - scattered_energy_ - works_;
  ledger_.filtered_gravity -= power_of_weight(dt) - lumped_lift_;
  if (pass.has(Act::strain)) ledger_.filtered_strain -= pass.share * (power_of_forces(dt) - lumped_power_);
}

}  // namespace mpm::reference
