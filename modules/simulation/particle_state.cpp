#include "simulation/particle_state.hpp"

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "simulation/saved_state.hpp"

namespace mpm {
namespace {

void append(std::vector<double>& to, const std::vector<double>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

/// Leaves out the values of particles that are marked.
void remove_marked(std::vector<double>& values, const std::vector<bool>& gone, std::size_t components) {
  std::size_t kept = 0;
  for (std::size_t p = 0; p * components < values.size(); ++p) {
    if (gone[p]) continue;
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(p * components), components,
                values.begin() + static_cast<std::ptrdiff_t>(kept * components));
    ++kept;
  }
  values.resize(kept * components);
}

}  // namespace

void Newcomers::append(const Newcomers& more) {
  mpm::append(position, more.position);
  mpm::append(velocity, more.velocity);
  mpm::append(initial_position, more.initial_position);
  for (const auto& [key, values] : more.others)
    if (more.count > 0) {
      const std::size_t components = values.size() / more.count;
      others[key].resize(count * components);
      mpm::append(others[key], values);
    }
  count += more.count;
  for (auto& [key, values] : others)
    if (more.count > 0 && more.others.count(key) == 0) values.resize(values.size() / (count - more.count) * count);
}

void ParticleState::OfBody::remove(const std::vector<bool>& gone, std::size_t dimension) {
  const std::size_t before = count;
  for (std::vector<double>& values : fields)
    if (before > 0) remove_marked(values, gone, values.size() / before);
  remove_marked(position, gone, dimension);
  remove_marked(initial_position, gone, dimension);
  count = position.size() / dimension;
}

ParticleState::ParticleState(const Experiment& experiment, const Plan& plan)
    : experiment_(experiment),
      plan_(plan),
      dimension_(static_cast<std::size_t>(experiment.dimension)),
      single_(experiment.precision == Precision::single),
      fields_(experiment.bodies.size()),
      bodies_(experiment.bodies.size()) {
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
    for_each_saved_field(plan, body,
                         [&](const Field& field) { fields_[static_cast<std::size_t>(body)].push_back(&field); });
    keeps_initial_position_.push_back(plan.particle_field(body, "initial_position") != nullptr);
  }
}

int ParticleState::number(std::size_t body, Origin origin, const std::string& id) const {
  const std::vector<const Field*>& fields = fields_[body];
  const auto found = std::find_if(fields.begin(), fields.end(),
                                  [&](const Field* field) { return field->origin == origin && field->id == id; });
  return found == fields.end() ? -1 : static_cast<int>(found - fields.begin());
}

template <class T>
void ParticleState::read_bodies(ArchiveReader& archive) {
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    OfBody& particles = bodies_[body];
    archive.get("position", particles.position);
    particles.count = particles.position.size() / dimension_;
    particles.fields.clear();
    for (const Field* field : fields_[body]) {
      std::vector<T> values(particles.count * static_cast<std::size_t>(field->components));
      archive.get(field->id, values.data(), values.size());
      particles.fields.emplace_back(values.begin(), values.end());
    }
  }
}

void ParticleState::read(ArchiveReader& archive, const Backend& backend) {
  restore_records(archive, backend);
  std::string arranged_by;
  std::vector<char> arrangement;
  archive.get("arranged_by", arranged_by);
  archive.get("arrangement", arrangement);
  single_ ? read_bodies<float>(archive) : read_bodies<double>(archive);
}

void ParticleState::read(const Backend& backend) {
  ArchiveWriter saved;
  backend.save(saved);
  ArchiveReader archive(saved.bytes());
  read(archive, backend);
  for (std::size_t body = 0; body < bodies_.size(); ++body)
    if (keeps_initial_position_[body])
      bodies_[body].initial_position = backend.body_state(static_cast<int>(body)).initial_position;
}

template <class T>
void ParticleState::write_bodies(ArchiveWriter& archive) const {
  for (std::size_t body = 0; body < bodies_.size(); ++body) {
    const OfBody& particles = bodies_[body];
    auto next = particles.fields.begin();  // save_particles asks for the fields in the same order
    save_particles(archive, plan_, static_cast<int>(body), particles.position, [&](const Field&) {
      const std::vector<double>& values = *next++;
      return std::vector<T>(values.begin(), values.end());
    });
  }
}

void ParticleState::write(ArchiveWriter& archive, const Backend& records) const {
  save_records(archive, records);
  save_arrangement(archive);
  single_ ? write_bodies<float>(archive) : write_bodies<double>(archive);
}

SeededBody ParticleState::seeds(std::size_t body, const SeededBody& of_start, const Newcomers& newcomers) const {
  struct Arrays {
    std::vector<double> position, velocity;
    std::map<std::string, std::vector<double>> others;
  };
  const OfBody& present = bodies_[body];
  const auto arrays = std::make_shared<Arrays>();
  arrays->position = present.position;
  append(arrays->position, newcomers.position);
  const std::size_t count = arrays->position.size() / dimension_;
  for (std::size_t k = 0; k < fields_[body].size(); ++k) {
    const Field& field = *fields_[body][k];
    if (field.first != First::seeded) continue;
    const std::string key = seed_key(field);
    std::vector<double>& values = key == "velocity" ? arrays->velocity : arrays->others[key];
    values = present.fields[k];
    if (key == "velocity")
      append(values, newcomers.velocity);
    else if (const auto given = newcomers.others.find(key); given != newcomers.others.end())
      append(values, given->second);
    values.resize(count * static_cast<std::size_t>(field.components));
  }
  if (keeps_initial_position_[body]) {
    std::vector<double>& values = arrays->others["initial_position"];
    values = present.initial_position;
    append(values, newcomers.initial_position);
    if (values.size() != count * dimension_) throw std::logic_error("particles come without a place where they began");
  }
  SeededBody seeded;
  seeded.volume = of_start.volume, seeded.mass = of_start.mass;
  seeded.dimension = dimension_, seeded.particles = count;
  seeded.with_size = arrays->others.count("size") > 0;
  seeded.make = [arrays, count](const std::function<void(const SeedBatch&)>& visit) {
    if (count == 0) return;
    SeedBatch batch{0, count, arrays->position.data(), arrays->velocity.data(), nullptr};
    for (const auto& [key, values] : arrays->others) batch.others.emplace_back(key, values.data());
    visit(batch);
  };
  return seeded;
}

}  // namespace mpm
