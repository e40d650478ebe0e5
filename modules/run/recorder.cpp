#include "run/recorder.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <numbers>
#include <span>

#include "metrics/particle_quantities.hpp"
#include "output/checkpoint_file.hpp"
#include "output/film.hpp"
#include "output/vtk.hpp"
#include "run/contact_nodes.hpp"
#include "simulation/rigid_outline.hpp"
#include "support/files.hpp"
#include "support/parallel.hpp"

namespace mpm::app {
namespace {

/// Frames are held until the end, when the colour scale of the whole run is known; beyond this they are drawn at once.
constexpr std::size_t held_bytes_limit = 512u << 20;
/// A thread that draws holds about 100 MB.
constexpr int most_drawing_threads = 8;

std::string numbered(const char* stem, std::size_t index) {
  char name[64];
  std::snprintf(name, sizeof name, "%s_%04zu", stem, index);
  return name;
}

std::pair<double, double> range_of(const std::vector<float>& values, std::pair<double, double> range) {
  for (const float value : values)
    if (std::isfinite(value)) range = {std::min<double>(range.first, value), std::max<double>(range.second, value)};
  return range;
}

/// The edges of rigid bodies where they are now, as far as they lie in the domain or near it; none in 3-D.
std::vector<float> outlines_of(const Simulation& simulation) {
  const Experiment& experiment = simulation.experiment();
  std::vector<float> outlines;
  for (std::size_t k = 0; experiment.dimension == 2 && k < experiment.rigid_bodies.size(); ++k)
    for (const auto& [from, to] : edges_of(experiment, k, simulation.backend().rigid_bodies()[k]))
      for (const double number : {from[0], from[1], to[0], to[1]}) outlines.push_back(static_cast<float>(number));
  return outlines;
}

/// Half the side of every particle's box as it is drawn, m.
std::vector<float> half_sizes_of(const Simulation& simulation) {
  const Experiment& experiment = simulation.experiment();
  std::vector<float> sizes;
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
    const BodySpecification& specification = experiment.bodies[body];
    const BodyState state = simulation.backend().body_state(body);
    const std::size_t count = state.position.size() / experiment.dimension;
    const double half = 0.5 * experiment.grid.cell_size / specification.particles_per_cell_axis;
    sizes.insert(sizes.end(), count, static_cast<float>(half));
    if (specification.seeding.kind == SeedingKind::lattice && !specification.takes_particles_in) continue;
    const int D = experiment.dimension;
    for (std::size_t p = 0; p < count; ++p) {
      const double around = experiment.axisymmetric() ? 2 * std::numbers::pi * state.position[p * D] : 1;
      sizes[sizes.size() - count + p] =
          static_cast<float>(std::pow(state.volume * state.size_of(p) / around, 1.0 / D) / 2);
    }
  }
  return sizes;
}

}  // namespace

Recorder::Recorder(const Simulation& simulation, const Metrics& metrics, const output::RunFolder& folder)
    : simulation_(simulation),
      metrics_(metrics),
      folder_(folder),
      particles_(simulation, folder),
      kept_snapshots_(folder.root() / "checkpoint/snapshots.records"),
      rows_(simulation, metrics),
      profiles_(simulation, metrics, folder.root() / "probes") {}

void Recorder::use_threads(int threads) {
  threads_ = std::clamp(threads, 1, most_drawing_threads);
  particles_.use_threads(threads);
}

void Recorder::start() {
  start_rows();
  profiles_.start();
}

void Recorder::start_rows() {
  csv_.emplace(folder_.root() / "metrics.csv", metrics_.columns());
}

void Recorder::save(ArchiveWriter& archive) {
  csv_->sync();
  while (kept_snapshots_.count() < snapshots_.size()) {
    const Snapshot& snapshot = snapshots_[kept_snapshots_.count()];
    ArchiveWriter record;
    record.put("time", snapshot.time);
    record.put("step", snapshot.step);
    record.put("positions", snapshot.positions);
    record.put("values", snapshot.values);
    record.put("domain_axes", snapshot.domain_axes);
    record.put("contact_nodes", snapshot.contact_nodes);
    record.put("outlines", snapshot.outlines);
    record.put("half_sizes", snapshot.half_sizes);
    kept_snapshots_.append({record.bytes().data(), record.bytes().size()});
  }
  archive.put("rows", csv_->bytes());
  archive.put("snapshots", kept_snapshots_.index());
  archive.put("last_row", last_row_);
  archive.put("frames_taken", frames_taken_);
  archive.put("frames_drawn", frames_drawn_);
  archive.put("bytes_held", bytes_held_);
  archive.put("vtk_files", vtk_files_.size());
  for (const auto& [time, name] : vtk_files_) {
    archive.put("vtk_time", time);
    archive.put("vtk_name", name);
  }
  particles_.save(archive);
  rows_.save(archive);
  profiles_.save(archive);
}

void Recorder::restore(ArchiveReader& archive) {
  const std::filesystem::path table = folder_.root() / "metrics.csv";
  std::size_t rows = 0;
  archive.get("rows", rows);
  if (!support::holds_whole_lines(table, rows))
    throw output::CheckpointDamaged(table, "does not hold the rows written before the checkpoint");
  std::string index;
  archive.get("snapshots", index);
  snapshots_.clear();
  for (const std::string& bytes : kept_snapshots_.resume(index)) {
    ArchiveReader record(bytes);
    Snapshot& snapshot = snapshots_.emplace_back();
    record.get("time", snapshot.time);
    record.get("step", snapshot.step);
    record.get("positions", snapshot.positions);
    record.get("values", snapshot.values);
    record.get("domain_axes", snapshot.domain_axes);
    record.get("contact_nodes", snapshot.contact_nodes);
    record.get("outlines", snapshot.outlines);
    record.get("half_sizes", snapshot.half_sizes);
  }
  archive.get("last_row", last_row_);
  archive.get("frames_taken", frames_taken_);
  archive.get("frames_drawn", frames_drawn_);
  archive.get("bytes_held", bytes_held_);
  std::size_t files = 0;
  archive.get("vtk_files", files);
  vtk_files_.clear();
  while (vtk_files_.size() < files) {
    auto& [time, name] = vtk_files_.emplace_back();
    archive.get("vtk_time", time);
    archive.get("vtk_name", name);
  }
  particles_.restore(archive);
  rows_.restore(archive);
  profiles_.check(archive);
  support::cut_to(table, rows);
  start_rows();
  profiles_.restore();
}

bool Recorder::frame_due(double time) const {
  const OutputSpecification& output = simulation_.experiment().output;
  if (output.frames <= 0) return false;
  // Frame k belongs to the first step at or after k / (frames - 1) of the end time: the step is never cut to fit.
  const double next = output.frames == 1 ? 0.0
                                         : simulation_.experiment().solver.end_time *
                                               static_cast<double>(frames_taken_) / (output.frames - 1);
  return frames_taken_ < static_cast<std::size_t>(output.frames) && time >= next * (1 - 1e-12);
}

bool Recorder::due(double time, long steps) const {
  return steps % simulation_.experiment().output.metrics_every == 0 || frame_due(time) || particles_.due(time) ||
         profiles_.due(time);
}

void Recorder::record(bool last) {
  const bool row_due = simulation_.steps() % simulation_.experiment().output.metrics_every == 0 || last;
  if (row_due && last_row_ != simulation_.steps()) record_row();
  if (frame_due(simulation_.time())) record_frame();
  particles_.record();
  profiles_.record();
}

void Recorder::record_row() {
  const Totals totals = metrics_.measure();
  const std::vector<double> row = metrics_.row(totals);
  csv_->row(row);  // what can fail is done before anything is counted
  rows_.take(totals, std::span(row).last(metrics_.chosen().count()));
  last_row_ = simulation_.steps();
}

void Recorder::record_frame() {
  const Experiment& experiment = simulation_.experiment();
  Snapshot snapshot{simulation_.time(), simulation_.steps(), {}, {}, outlines_of(simulation_), {}};
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
    const BodyState state = simulation_.backend().body_state(body);
    const std::vector<double> values = quantity(experiment, body, state, experiment.output.colour_by);
    snapshot.positions.insert(snapshot.positions.end(), state.position.begin(), state.position.end());
    snapshot.values.insert(snapshot.values.end(), values.begin(), values.end());
    for (std::size_t k = 0; experiment.dimension == 2 && k < state.domain.size(); k += 4)
      for (const std::size_t component : {0, 2, 1, 3})  // columns of the matrix are the semi-sides
        snapshot.domain_axes.push_back(static_cast<float>(state.domain[k + component]));
  }
  if (experiment.output.contact_nodes) snapshot.contact_nodes = simulation_.backend().contact_nodes();
  if (simulation_.particle_changes()) snapshot.half_sizes = half_sizes_of(simulation_);
  if (experiment.output.vtk) write_vtk(frames_taken_);
  const std::size_t bytes =
      (snapshot.positions.size() + snapshot.values.size() + snapshot.domain_axes.size()) * sizeof(float);
  if (bytes_held_ + bytes > held_bytes_limit) {
    draw(frame_template(), snapshot, frames_taken_, range_of(snapshot.values, {INFINITY, -INFINITY}));
    ++frames_drawn_;
  } else {
    snapshots_.push_back(std::move(snapshot));
  }
  bytes_held_ += bytes;
  ++frames_taken_;
}

render::ParticleFrame Recorder::frame_template() const {
  const Experiment& experiment = simulation_.experiment();
  const QuantityDescription description = describe_quantity(experiment, experiment.output.colour_by);
  render::ParticleFrame frame;
  frame.dimension = experiment.dimension;
  frame.lower = experiment.grid.lower;
  frame.upper = experiment.grid.upper;
  frame.quantity = description.label;
  frame.unit = description.unit;
  frame.cell_size = experiment.grid.cell_size;
  frame.title = experiment.title;
  frame.footnote = experiment.file.filename().string();  // not the folder: equal experiments have equal pictures
  if (description.name == "body") {
    frame.map = render::ColourMap::categorical;
    for (const BodySpecification& body : experiment.bodies) frame.categories.push_back(body.name);
  } else if (description.name == "pressure") {
    frame.map = render::ColourMap::diverging;
  }
  frame.half_size = half_sizes_of(simulation_);
  return frame;
}

void Recorder::draw(render::ParticleFrame frame, const Snapshot& snapshot, std::size_t index,
                    std::pair<double, double> range) const {
  if (!snapshot.half_sizes.empty()) frame.half_size = snapshot.half_sizes;
  frame.positions = snapshot.positions;
  frame.values = snapshot.values;
  frame.domain_axes = snapshot.domain_axes;
  frame.outlines = snapshot.outlines;
  frame.time = snapshot.time;
  frame.step = snapshot.step;
  if (frame.map == render::ColourMap::diverging) {
    const double limit = std::max(std::abs(range.first), std::abs(range.second));
    range = {-limit, limit};
  }
  if (frame.map != render::ColourMap::categorical && range.first < range.second) frame.range = range;
  const Experiment& experiment = simulation_.experiment();
  if (experiment.dimension == 2) frame.marks = contact_marks(experiment, snapshot.contact_nodes);
  render::write_frame(frame, folder_.frames() / numbered("frame", index));
  if (experiment.output.contact_nodes)
    support::write_atomically(folder_.frames() / (numbered("contact", index) + ".csv"),
                              contact_table(experiment, snapshot.contact_nodes));
}

void Recorder::draw_frames() {
  std::pair<double, double> range{INFINITY, -INFINITY};
  for (const Snapshot& snapshot : snapshots_) range = range_of(snapshot.values, range);
  if (!snapshots_.empty()) {
    const render::ParticleFrame common = frame_template();
    support::for_each_piece(snapshots_.size(), threads_,
                            [&](std::size_t index) { draw(common, snapshots_[index], index, range); });
    frames_drawn_ += snapshots_.size();
  }
  snapshots_.clear();
  const std::string& format = simulation_.experiment().output.film;
  if (format.empty() || frames_drawn_ < 2) return;
  if (!output::write_film(folder_.frames(), folder_.root() / ("film." + format), output::frames_per_second))
    std::cerr << output::no_ffmpeg << "\n";
}

void Recorder::write_vtk(std::size_t index) {
  const Experiment& experiment = simulation_.experiment();
  output::ParticleSnapshot snapshot;
  snapshot.dimension = experiment.dimension;
  snapshot.time = simulation_.time();
  output::PointField velocity{"velocity (m/s)", experiment.dimension, {}};
  std::vector<output::PointField> scalars;
  std::vector<std::string> names{"body", "pressure", "von_mises_stress", "volume_ratio"};
  if (experiment.has_temperature()) names.insert(names.end(), {"temperature", "melted_fraction"});
  for (const MaterialSpecification& material : experiment.materials)
    for (const mpm_state& field : material.component.plugin->state())
      if (field.shape == MPM_STATE_SCALAR && std::find(names.begin(), names.end(), field.name) == names.end())
        names.emplace_back(field.name);
  for (const mpm_state& field : experiment.contact_state()) names.emplace_back(field.name);
  for (const std::string& name : names) {
    const std::string unit = describe_quantity(experiment, name).unit;
    scalars.push_back({unit.empty() ? name : name + " (" + unit + ")", 1, {}});
  }
  for (int body = 0; body < static_cast<int>(experiment.bodies.size()); ++body) {
    const BodyState state = simulation_.backend().body_state(body);
    snapshot.positions.insert(snapshot.positions.end(), state.position.begin(), state.position.end());
    velocity.values.insert(velocity.values.end(), state.velocity.begin(), state.velocity.end());
    for (std::size_t k = 0; k < names.size(); ++k) {
      const auto values = quantity(experiment, body, state, names[k]);
      scalars[k].values.insert(scalars[k].values.end(), values.begin(), values.end());
    }
  }
  snapshot.fields.push_back(std::move(velocity));
  for (auto& scalar : scalars) snapshot.fields.push_back(std::move(scalar));
  const std::string name = numbered("particles", index) + ".vtu";
  output::write_vtu(folder_.vtk() / name, snapshot);
  vtk_files_.resize(index);  // drops what an attempt that failed has left
  vtk_files_.emplace_back(simulation_.time(), name);
  output::write_pvd(folder_.vtk() / "particles.pvd", vtk_files_);
}

std::function<std::function<void()>(Simulation&)> recording_in(const std::filesystem::path& folder) {
  return [folder, number = 0](Simulation& simulation) mutable -> std::function<void()> {
    struct Recording {
      Metrics metrics;
      output::RunFolder folder;
      Recorder recorder;
      Recording(Simulation& s, const std::filesystem::path& place)
          : metrics(s), folder(output::RunFolder::create(place)), recorder(s, metrics, folder) {
        recorder.start();
        recorder.record();
      }
    };
    // A child process may make one too.
    const std::string name = std::to_string(getpid()) + "_" + std::to_string(number++);
    const auto recording = std::make_shared<Recording>(simulation, folder / name);
    return [recording] { recording->recorder.record(); };
  };
}

}  // namespace mpm::app
