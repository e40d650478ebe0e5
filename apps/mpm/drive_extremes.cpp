#include "mpm/drive_extremes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <map>

#include "drive/extremes.hpp"
#include "drive/results.hpp"
#include "experiment/diagnostics.hpp"
#include "mpm/bench_suite.hpp"
#include "mpm/stop_on_signal.hpp"
#include "render/plot.hpp"
#include "support/numbers.hpp"

namespace mpm::app {
namespace {

namespace fs = std::filesystem;

drive::ExtremeSize size_of(const DriveOptions& options) {
  drive::ExtremeSize size;
  size.duration = options.duration, size.cycles = options.cycles;
  return size;
}

constexpr std::array suffixes{".png", ".svg", ".csv"};

/// Where figures go. Refuses what stands in the way before anything is computed, and removes figures that are replaced.
void begin_folder(const DriveOptions& options, const std::vector<std::string>& names) {
  if (options.out.empty()) return;
  const std::string out = options.out.string();
  std::error_code error;
  const fs::file_status found = fs::status(options.out, error);
  if (fs::exists(found) && !fs::is_directory(found)) refuse_input(out, "is a file; choose a folder with --out");
  fs::create_directories(options.out, error);
  if (error)
    refuse_input(out, "cannot be made (" + error.message() + "); choose another folder, or a shorter name, with --out");
  for (const std::string& name : names)
    for (const char* suffix : suffixes) {
      const fs::path figure = options.out / (name + suffix);
      if (!fs::exists(figure, error)) continue;
      if (!options.replace)
        refuse_input(out, "holds " + figure.filename().string() + " already; add --replace, or choose another folder");
      if (!fs::remove(figure, error))
        refuse_input(figure.string(), "cannot be replaced (" + error.message() + "); choose another folder with --out");
    }
  const fs::path probe = options.out / ".probe";
  if (!std::ofstream(probe).put(' ')) refuse_input(out, "cannot be written to; choose another folder with --out");
  fs::remove(probe, error);
}

/// What to type for the same figures.
std::string command_of(const DriveOptions& options) {
  std::string command = "mpm drive " + options.id + " --extremes";
  for (const std::string& parameter : options.parameters) command += " --param " + parameter;
  if (options.duration != 1) command += " --duration " + number_text(options.duration);
  if (options.dimension) command += " --dimension " + std::to_string(options.dimension);
  if (!options.cell_size.empty()) command += " --cell-size " + options.cell_size;
  return command;
}

constexpr double rounding = 1e-12;  ///< of the stiffness at rest: a stress below is zero

bool is_of_volume(const drive::Extreme& row) {
  return row.kind == drive::ExtremeKind::volume;
}

/// The pressure of a change of volume and the von Mises stress of others, Pa; zero below rounding.
double stress_of(const drive::Extreme& row, const drive::Response& state) {
  const double stress = is_of_volume(row) ? pressure(state) : von_mises_stress(state);
  return std::abs(stress) < rounding * row.stiffness ? 0 : stress;
}

/// Two figures of one material: all that its paths pass through.
void draw_paths(const DriveOptions& options, const std::vector<drive::Extreme>& rows) {
  constexpr double apart = 0.05;  // of the logarithms of two points, at least
  const auto plot = [&](const char* title, const char* x, const char* y) {
    render::Plot figure;
    figure.title = options.id + ": " + title;
    figure.x_label = x, figure.y_label = y;
    figure.log_x = figure.log_y = true;
    figure.footnote = command_of(options);
    return figure;
  };
  render::Plot volume = plot("pressed to a millionth, torn to a million times its volume", "volume ratio J",
                             "pressure, tension (Pa)"),
               shape =
                   plot("drawn, pressed flat and sheared at its volume", "stretch, or shear", "von Mises stress (Pa)");
  const auto add = [](render::Plot& figure, const char* label, double x, double y) {
    auto series = std::find_if(figure.series.begin(), figure.series.end(),
                               [&](const render::Series& other) { return other.label == label; });
    if (series == figure.series.end()) series = figure.series.insert(series, {label});
    if (!series->x.empty() && std::abs(std::log(x / series->x.back())) < apart) return;
    series->x.push_back(x), series->y.push_back(y);
  };
  for (const drive::Extreme& row : rows)
    for (const auto& [size, state] : row.course) {
      const double stress = stress_of(row, state);
      if (stress == 0) continue;
      if (is_of_volume(row))
        add(volume, stress < 0 ? "tension" : "pressure", size, std::abs(stress));
      else
        add(shape,
            row.kind == drive::ExtremeKind::shear ? "sheared"
            : size < 1                            ? "pressed flat"
                                                  : "drawn",
            size, stress);
    }
  for (const auto& [figure, name] : {std::pair{&volume, "extremes_volume"}, std::pair{&shape, "extremes_shape"}}) {
    if (figure->series.empty()) {
      std::printf("no figure %s: there is no stress anywhere\n", name);
      continue;
    }
    render::write_figure(*figure, options.out / name);
    std::printf("figure: %s.png\n", (options.out / name).c_str());
  }
}

/// A row of each material, a column of each path: the logarithm of the stress at its end over the stiffness at rest. As many
/// materials as have room for their numbers share a figure.
class ExtremesMap {
 public:
  explicit ExtremesMap(const DriveOptions& options) : options_(options) {
    map_.x_label = "in " + std::to_string(drive::ExtremeSize{}.steps) + " steps", map_.y_label = "material";
    map_.value_label = "decimal logarithm of the stress at the end over the stiffness at rest";
    map_.x_names = {"J = 10⁻⁶", "J = 10⁶", "drawn by 10⁴", "pressed to 10⁻⁴", "sheared by 10⁴"};
    map_.digits = 2, map_.width = 1800, map_.height = 1200;
    map_.footnote = "J: size of the pressure; at J = 1: von Mises stress · " + command_of(options);
  }

  static std::vector<std::string> names(std::size_t materials) {
    std::vector<std::string> all;
    for (std::size_t k = 0; k * rows_of_a_figure < materials; ++k) all.push_back("extremes_" + std::to_string(k + 1));
    return all;
  }

  void add(const std::string& material, const std::vector<drive::Extreme>& rows) {
    map_.y_names.push_back(material);
    for (const drive::Extreme& row : rows) {
      if (row.steps <= 1) continue;
      const double share = std::abs(stress_of(row, row.end)) / row.stiffness;
      const bool shown = row.outcome == drive::Outcome::right && share > 0;
      map_.values.push_back(shown ? std::log10(share) : std::numeric_limits<double>::quiet_NaN());
      map_.notes.push_back(shown ? "" : row.outcome == drive::Outcome::right ? "none" : row.outcome_text());
    }
  }

  void draw() const {
    if (options_.out.empty()) return;
    const std::vector<std::string> all = names(map_.y_names.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
      const std::size_t rows = map_.y_names.size(), first = k * rows / all.size(), last = (k + 1) * rows / all.size();
      const auto part = [&](const auto& values, std::size_t columns) {
        return std::decay_t<decltype(values)>(values.begin() + static_cast<std::ptrdiff_t>(first * columns),
                                              values.begin() + static_cast<std::ptrdiff_t>(last * columns));
      };
      render::HeatMap map = map_;
      map.title = "Materials at their extremes: " + map_.y_names[first] + " to " + map_.y_names[last - 1];
      map.y_names = part(map_.y_names, 1);
      map.values = part(map_.values, map_.x_names.size()), map.notes = part(map_.notes, map_.x_names.size());
      render::write_figure(map, options_.out / all[k]);
      std::printf("figure: %s.png\n", (options_.out / all[k]).c_str());
    }
  }

 private:
  static constexpr std::size_t rows_of_a_figure = 13;
  const DriveOptions& options_;
  render::HeatMap map_;
};

/// The clamps that acted, each with the extremes in which it did; a path that is clamped on its way and at once counts once.
std::map<std::string, std::string> clamps_of(const std::vector<drive::Extreme>& rows) {
  std::map<std::string, std::string> names;
  const auto acts = [](const drive::Extreme& row, const std::string& clamp) {
    return std::find(row.clamps.begin(), row.clamps.end(), clamp) != row.clamps.end();
  };
  for (const drive::Extreme& row : rows)
    for (const std::string& clamp : row.clamps) {
      if (row.must_be_refused) continue;
      const drive::Extreme* const on_its_way = row.steps == 1 && &row != &rows.front() ? &row - 1 : nullptr;
      if (on_its_way && acts(*on_its_way, clamp)) continue;
      std::string& text = names[clamp];
      text += (text.empty() ? "" : ", ") + (on_its_way ? on_its_way->name + " in one step" : row.name);
    }
  return names;
}

}  // namespace

/// Prints a row of each extreme. Returns the exit code.
int drive_to_extremes(const DriveOptions& options, const Component& material, int dimension) {
  const drive::ExtremeSize size = size_of(options);
  begin_folder(options, {"extremes_volume", "extremes_shape"});
  const StopOnSignal signals;
  const auto rows = drive::extremes(material, dimension, size, stop_requested);
  std::printf(
      "%s, %d-D, volume ratios of %s to %s, stretches and shears of %s, each in %d steps and in one, within %s s\n",
      options.id.c_str(), dimension, number_text(size.smallest_ratio).c_str(),
      number_text(1 / size.smallest_ratio).c_str(), number_text(size.stretch).c_str(), size.steps,
      number_text(size.duration).c_str());
  std::printf("%-24s%-17s%12s%12s%12s%12s%12s\n", "extreme", "outcome", "J", "pressure", "von Mises", "stored",
              "speed");
  std::printf("%-24s%-17s%12s%12s%12s%12s%12s\n", "", "", "", "(Pa)", "(Pa)", "(J/m^3)", "(m/s)");
  bool all_hold = true;
  for (const drive::Extreme& row : rows) {
    all_hold = all_hold && row.holds();
    std::printf("%-24s%-17s%12s%12s%12s%12s%12s\n", row.name.c_str(), row.outcome_text().c_str(),
                support::exponential(row.end.volume_ratio).c_str(), support::exponential(pressure(row.end)).c_str(),
                support::exponential(von_mises_stress(row.end)).c_str(), support::exponential(row.end.stored).c_str(),
                support::exponential(row.end.wave_speed).c_str());
    if (row.drift > 0) std::printf("  stress drifts by %.2g of stiffness x cycles x rounding\n", row.drift);
  }
  std::printf("The numbers are those of the last state that was taken.\n");
  for (const auto& [clamp, names] : clamps_of(rows))
    std::fprintf(stderr, "warning: material \"%s\" was clamped (%s): %s (mpm describe %s)\n", options.id.c_str(),
                 names.c_str(), clamp.c_str(), options.id.c_str());
  if (!options.out.empty() && !stop_requested()) draw_paths(options, rows);
  if (!stop_requested()) return all_hold ? done : run_failed;
  std::printf("stopped by a signal before the next extreme\n");
  return interrupted;
}

/// Prints a row of each material that is installed: what it answers at the extremes, or where it fails.
int drive_every_to_extremes(const DriveOptions& options) {
  ExtremesMap chart(options);
  const Registry registry = load_registry();
  begin_folder(options, ExtremesMap::names(registry.of_kind(MPM_MATERIAL).size()));
  const BenchSuite suite(registry, false);
  const StopOnSignal signals;
  const drive::ExtremeSize size = size_of(options);
  std::printf("%-25s%24s%24s%12s%12s%12s%12s\n", "", "J = 1e-6", "J = 1e6", "drawn", "pressed", "sheared", "drift of");
  std::printf("%-25s%12s%12s%12s%12s%12s%12s%12s%12s\n", "material", "pressure", "speed", "pressure", "speed", "by 1e4",
              "to 1e-4", "by 1e4", "cycles");
  std::printf("%-25s%12s%12s%12s%12s%36s%12s\n", "", "(Pa)", "(m/s)", "(Pa)", "(m/s)", "von Mises stress (Pa)", "");
  int worst = done;
  for (const Plugin* plugin : registry.of_kind(MPM_MATERIAL)) {
    const int dimension = options.dimension ? options.dimension : plugin->descriptor->dimensions & MPM_3D ? 3 : 2;
    if (const std::string unknown = suite.unknown_parameter(*plugin); !unknown.empty()) {
      std::printf("%-25s  left out, the benchmarks have no value for %s: drive it by its name\n",
                  std::string(plugin->id()).c_str(), unknown.c_str());
      continue;
    }
    const Component material = suite.material(*plugin);
    const auto rows = drive::extremes(material, dimension, size, stop_requested);
    if (stop_requested()) {
      std::printf("stopped by a signal in %s\n", std::string(plugin->id()).c_str());
      return interrupted;
    }
    const auto at = [&](const char* name) -> const drive::Extreme& {
      return *std::find_if(rows.begin(), rows.end(), [&](const drive::Extreme& row) { return row.name == name; });
    };
    std::printf("%-25s", std::string(plugin->id()).c_str());
    for (const char* name : {"pressed evenly", "torn evenly"})
      std::printf("%12.1e%12.1e", pressure(at(name).end) + 0.0, at(name).end.wave_speed);
    for (const char* name : {"drawn out", "pressed flat", "sheared"})
      std::printf("%12.1e", von_mises_stress(at(name).end));
    std::printf("%12.1g\n", rows.back().drift);
    for (const drive::Extreme& row : rows) {
      const bool as_expected = row.must_be_refused ? row.holds() : row.outcome == drive::Outcome::right;
      if (!as_expected) std::printf("  %s: %s\n", row.name.c_str(), row.outcome_text().c_str());
      if (!row.holds()) worst = run_failed;
    }
    for (const auto& [clamp, names] : clamps_of(rows))
      std::printf("  clamped %s: %s\n", clamp.substr(0, clamp.find(", ")).c_str(), names.c_str());
    std::fflush(stdout);
    chart.add(std::string(plugin->id()), rows);
  }
  chart.draw();
  return worst;
}

}  // namespace mpm::app
