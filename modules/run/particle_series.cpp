#include "run/particle_series.hpp"

#include <chrono>
#include <cstdio>

#include "metrics/contact_traction.hpp"
#include "metrics/mapped_grid.hpp"
#include "metrics/particle_values.hpp"
#include "output/vtk.hpp"
#include "output/vtk_data.hpp"
#include "support/csv.hpp"
#include "support/files.hpp"
#include "support/numbers.hpp"

namespace mpm::app {
namespace {

using Clock = std::chrono::steady_clock;

std::string with_unit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " (" + unit + ")";
}

std::string numbered(const char* stem, std::size_t index, const char* ending) {
  char name[64];
  std::snprintf(name, sizeof name, "%s_%04zu%s", stem, index, ending);
  return name;
}

/// Names of the columns of a field, without the unit.
std::vector<std::string> columns_of(const ParticleField& field) {
  if (field.shape == ParticleField::Shape::scalar) return {field.name};
  std::vector<std::string> names;
  for (const char a : std::string("xyz")) {
    if (field.shape == ParticleField::Shape::vector) names.push_back(field.name + " " + a);
    for (const char b : std::string(field.shape == ParticleField::Shape::tensor ? "xyz" : ""))
      names.push_back(field.name + " " + a + b);
  }
  return names;
}

}  // namespace

bool ParticleSeries::due(double time) const {
  const auto& wanted = simulation_.experiment().particle_output;
  return wanted && times_passed_ < wanted->times.size() && time >= wanted->times[times_passed_] * (1 - 1e-12);
}

void ParticleSeries::record() {
  if (!due(simulation_.time())) return;
  const auto start = Clock::now();
  const Experiment& experiment = simulation_.experiment();
  const ParticleOutput& wanted = *experiment.particle_output;
  std::vector<BodyState> states;
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
    BodyState& state = states.emplace_back(simulation_.backend().body_state(body));
    if (wanted.asks("contact_traction"))
      state.host_state["contact_traction"] =
          contact_traction(experiment, body, state, simulation_.backend().contact_nodes());
  }
  const std::size_t index = particles_.size();
  Files particles = particles_, grids = grids_;
  particles.emplace_back(simulation_.time(), numbered("particles", index, ".vtu"));
  grids.emplace_back(simulation_.time(), numbered("grid", index, ".vti"));
  if (wanted.vtk) write(states, index);
  if (wanted.csv) write_csv(states, numbered("particles", index, ".csv"));
  if (wanted.grid) write_grid(states, grids.back().second);
  if (wanted.vtk) output::write_pvd(folder_.particles() / "particles.pvd", particles);
  if (wanted.grid) output::write_pvd(folder_.particles() / "grid.pvd", grids);
  particles_ = std::move(particles), grids_ = std::move(grids);
  while (due(simulation_.time())) ++times_passed_;
  seconds_ += std::chrono::duration<double>(Clock::now() - start).count();
}

void ParticleSeries::write(const std::vector<BodyState>& states, std::size_t index) const {
  const Experiment& experiment = simulation_.experiment();
  const ParticleOutput& wanted = *experiment.particle_output;
  output::VtkCells cells;
  cells.time = simulation_.time();
  if (wanted.domains) {
    cells.cell = experiment.dimension == 2 ? output::VtkCell::quadrilateral : output::VtkCell::hexahedron;
    cells.points = output::vtk_numbers(particle_domains(experiment, states), wanted.in_double);
  } else {
    cells.points = output::vtk_numbers(particle_positions(experiment, states), wanted.in_double);
  }
  for (ParticleValues& one : particle_values(experiment, states, wanted.fields))
    cells.of_cell.push_back({with_unit(one.field.name, one.field.unit), static_cast<int>(one.field.shape),
                             output::vtk_numbers(std::move(one.values), wanted.in_double)});
  output::write_vtu(folder_.particles() / numbered("particles", index, ".vtu"), cells, {wanted.compress, threads_});
}

void ParticleSeries::write_csv(const std::vector<BodyState>& states, const std::string& name) const {
  const Experiment& experiment = simulation_.experiment();
  const std::vector<double> positions = particle_positions(experiment, states);
  const auto fields = particle_values(experiment, states, experiment.particle_output->fields);
  support::CsvText head;
  std::vector<std::string> cells{"x (m)", "y (m)", "z (m)"};
  for (const ParticleValues& one : fields)
    for (const std::string& column : columns_of(one.field)) cells.push_back(with_unit(column, one.field.unit));
  head.row(cells);
  std::string text = head.text();
  const auto add = [&](const std::vector<double>& values, std::size_t p, std::size_t width) {
    for (std::size_t k = 0; k < width; ++k) {
      support::append_shortest(text, values[p * width + k]);
      text += ',';
    }
  };
  for (std::size_t p = 0; p < positions.size() / 3; ++p) {
    add(positions, p, 3);
    for (const ParticleValues& one : fields) add(one.values, p, static_cast<std::size_t>(one.field.shape));
    text.back() = '\n';
  }
  support::write_atomically(folder_.particles() / name, text, support::Durability::of_program);
}

void ParticleSeries::write_grid(const std::vector<BodyState>& states, const std::string& name) const {
  const Experiment& experiment = simulation_.experiment();
  const ParticleOutput& wanted = *experiment.particle_output;
  MappedGrid grid = mapped_grid(experiment, states, simulation_.time());
  output::VtkImage image;
  image.time = simulation_.time();
  image.spacing = experiment.grid.cell_size;
  image.nodes = grid.nodes;
  for (int a = 0; a < experiment.dimension; ++a) image.origin[a] = experiment.grid.lower[a];
  for (std::size_t k = 0; k < grid.fields.size(); ++k) {
    const std::string of = experiment.field_names.empty() ? "" : " of " + experiment.field_names[k];
    image.of_node.push_back(
        {"mass" + of + " (kg)", 1, output::vtk_numbers(std::move(grid.fields[k].mass), wanted.in_double)});
    image.of_node.push_back(
        {"velocity" + of + " (m/s)", 3, output::vtk_numbers(std::move(grid.fields[k].velocity), wanted.in_double)});
  }
  output::write_vti(folder_.particles() / name, image, {wanted.compress, threads_});
}

void ParticleSeries::save(ArchiveWriter& archive) const {
  archive.put("particle_times_passed", times_passed_);
  archive.put("particle_file_seconds", seconds_);
  archive.put("particle_files", particles_.size());
  for (const auto& [time, name] : particles_) archive.put("particle_file_time", time);
}

void ParticleSeries::restore(ArchiveReader& archive) {
  archive.get("particle_times_passed", times_passed_);
  archive.get("particle_file_seconds", seconds_);
  std::size_t files = 0;
  archive.get("particle_files", files);
  particles_.clear(), grids_.clear();
  for (std::size_t index = 0; index < files; ++index) {
    double time = 0;
    archive.get("particle_file_time", time);
    particles_.emplace_back(time, numbered("particles", index, ".vtu"));
    grids_.emplace_back(time, numbered("grid", index, ".vti"));
  }
}

}  // namespace mpm::app
