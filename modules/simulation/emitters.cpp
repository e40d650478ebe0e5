#include "simulation/emitters.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "experiment/diagnostics.hpp"
#include "simulation/formula_problem.hpp"
#include "simulation/seeding.hpp"

namespace mpm {
namespace {

/// From this share of a batch on, particles in its way are worth a warning.
constexpr double much = 0.1;

double speed_of(const Emitter& emitter) {
  const Vector3& v = emitter.velocity;
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/// Batches stand up to a step's way in front of their region, which has a cell of room there.
void refuse_long_step(const Experiment& experiment, const Emitter& emitter) {
  if (!experiment.solver.time_step) return;
  const double way = speed_of(emitter) * *experiment.solver.time_step;
  if (way > experiment.grid.cell_size)
    throw InputError({problem_at(experiment, emitter.pointer + "/velocity",
                                 "moves by " + number_text(way / experiment.grid.cell_size) + " cells in a step of " +
                                     number_text(*experiment.solver.time_step) +
                                     " s, and a batch may be on its way for a step before it is there; take a shorter "
                                     "/solver/time_step, or \"auto\"")});
}

/// The particles that fill the emitter's region, of the body's seeding and of a volume as the body's particles have it.
Newcomers fill(const Experiment& experiment, const Emitter& emitter, const SeededBody& of_body) {
  const Experiment filled = filled_by(experiment, emitter);
  const SeededBody seeded = seed_body(filled, emitter.body);
  const auto D = static_cast<std::size_t>(experiment.dimension);
  Newcomers batch;
  seeded.for_each_batch([&](const SeedBatch& seeds) {
    batch.position.insert(batch.position.end(), seeds.position, seeds.position + seeds.count * D);
    const auto components_of = [&](const std::string& key) {
      return key == "domain" ? D * D : key == "corners" ? D << D : key == "deformation" ? D * D : 1;
    };
    for (const auto& [key, first] : seeds.others) {
      std::vector<double>& values = batch.others[key];
      values.insert(values.end(), first, first + seeds.count * components_of(key));
    }
  });
  for (double& size : batch.others["size"]) size *= seeded.volume / of_body.volume;
  for (std::size_t p = 0; p < seeded.count(); ++p)
    batch.velocity.insert(batch.velocity.end(), emitter.velocity.begin(),
                          emitter.velocity.begin() + static_cast<std::ptrdiff_t>(D));
  for (const double T : batch.others.count("temperature") ? batch.others.at("temperature") : std::vector<double>())
    if (!(std::isfinite(T) && T >= 0))
      throw InputError(
          {problem_at(experiment, experiment.bodies[static_cast<std::size_t>(emitter.body)].pointer + "/temperature",
                      "is " + number_text(T) + " K where emitter " + in_quotes(emitter.name) + " fills its region")});
  batch.initial_position = batch.position;
  batch.count = seeded.count();
  return batch;
}

}  // namespace

Experiment filled_by(const Experiment& experiment, const Emitter& emitter) {
  Experiment filled = experiment;
  BodySpecification& body = filled.bodies[static_cast<std::size_t>(emitter.body)];
  body.geometry = emitter.geometry, body.starts_empty = false;
  filled.grips.clear();
  return filled;
}

Emitters::Emitters(const Experiment& experiment, const std::vector<SeededBody>& seeds)
    : experiment_(experiment), dimension_(static_cast<std::size_t>(experiment.dimension)) {
  for (const Emitter& emitter : experiment.emitters) {
    refuse_long_step(experiment, emitter);
    Source& source = sources_.emplace_back();
    source.emitter = &emitter;
    source.batch = fill(experiment, emitter, seeds[static_cast<std::size_t>(emitter.body)]);
  }
}

bool Emitters::due(double time) const {
  return std::any_of(sources_.begin(), sources_.end(),
                     [&](const Source& source) { return source.emitter->batches_until(time) > source.emitted; });
}

Newcomers Emitters::moved(const Source& source, double way) const {
  Newcomers batch = source.batch;
  for (std::size_t k = 0; k < batch.position.size(); ++k)
    batch.position[k] += way * source.emitter->velocity[k % dimension_];
  return batch;
}

void Emitters::begin(std::vector<SeededBody>& seeds) {
  for (Source& source : sources_)
    for (const long due = source.emitter->batches_until(0); source.emitted < due; ++source.emitted) {
      std::size_t inside = 0;
      for (const SeededBody& present : seeds)
        present.for_each_batch(
            [&](const SeedBatch& batch) { inside += count_inside(source, 0, batch.position, batch.count); });
      note(source, inside, 0);
      SeededBody& body = seeds[static_cast<std::size_t>(source.emitter->body)];
      const auto batch = std::make_shared<const Newcomers>(source.batch);
      const auto zeros = std::make_shared<const std::vector<double>>(
          body.with_gradient ? batch->velocity.size() * dimension_ : 0, 0.0);
      const std::size_t first = body.particles;
      body.particles += source.batch.count;
      body.make = [before = body.make, batch, zeros, first,
                   count = source.batch.count](const std::function<void(const SeedBatch&)>& visit) {
        before(visit);
        SeedBatch seeds{first, count, batch->position.data(), batch->velocity.data(),
                        zeros->empty() ? nullptr : zeros->data()};
        for (const auto& [key, values] : batch->others) seeds.others.emplace_back(key, values.data());
        visit(seeds);
      };
    }
}

double Emitters::speed_between(double from, double until) const {
  double speed = 0;
  for (const Source& source : sources_)
    if (source.emitter->until > from && source.emitter->from < until)
      speed = std::max(speed, speed_of(*source.emitter));
  return speed;
}

/// How many of these places are where a batch comes to that has moved on for `way` seconds.
std::size_t Emitters::count_inside(const Source& source, double way, const double* position, std::size_t count) const {
  std::size_t inside = 0;
  for (std::size_t p = 0; p < count; ++p) {
    Vector3 x{};
    for (std::size_t c = 0; c < dimension_; ++c)
      x[c] = position[p * dimension_ + c] - way * source.emitter->velocity[c];
    inside += source.emitter->geometry->contains(x);
  }
  return inside;
}

/// Notes how many particles are in the way of a batch.
void Emitters::note(Source& source, std::size_t inside, double time) const {
  const double share = static_cast<double>(inside) / static_cast<double>(source.batch.count);
  source.occupied = std::max(source.occupied, share);
  if (share > much && source.first_occupied < 0) source.first_occupied = time;
}

void Emitters::emit(double time, const ParticleState& present, std::vector<Newcomers>& newcomers) {
  for (Source& source : sources_) {
    const Emitter& emitter = *source.emitter;
    Newcomers& of_body = newcomers[static_cast<std::size_t>(emitter.body)];
    for (const long due = emitter.batches_until(time); source.emitted < due; ++source.emitted) {
      const double way = time - emitter.due(source.emitted);
      std::size_t inside = 0;
      for (const ParticleState::OfBody& body : present.bodies())
        inside += count_inside(source, way, body.position.data(), body.count);
      for (const Newcomers& others : newcomers)
        inside += count_inside(source, way, others.position.data(), others.count);
      note(source, inside, time);
      of_body.append(moved(source, way));
      const std::size_t count = present.bodies()[static_cast<std::size_t>(emitter.body)].count + of_body.count;
      if (count > static_cast<std::size_t>(emitter.max_particles))
        throw RunFailure({Cause::too_many_particles, emitter.body, 0, -1, static_cast<double>(emitter.max_particles)});
    }
  }
}

std::vector<std::string> Emitters::warnings() const {
  std::vector<std::string> all;
  for (const Source& source : sources_)
    if (source.first_occupied >= 0)
      all.push_back("emitter \"" + source.emitter->name +
                    "\" filled a region in which particles were left, from t = " + number_text(source.first_occupied) +
                    " s on, up to " + number_text(std::round(100 * source.occupied)) +
                    " % of what it emits: they overlap and press one another apart; emit where the flow leaves, or "
                    "slower");
  return all;
}

void Emitters::save(ArchiveWriter& archive) const {
  for (const Source& source : sources_) {
    archive.put("emitted_batches", source.emitted);
    archive.put("occupied", source.occupied);
    archive.put("first_occupied", source.first_occupied);
  }
}

void Emitters::restore(ArchiveReader& archive) {
  for (Source& source : sources_) {
    archive.get("emitted_batches", source.emitted);
    archive.get("occupied", source.occupied);
    archive.get("first_occupied", source.first_occupied);
  }
}

}  // namespace mpm
