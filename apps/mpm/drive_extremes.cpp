#include "mpm/drive_extremes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

#include "drive/extremes.hpp"
#include "experiment/diagnostics.hpp"
#include "mpm/bench_suite.hpp"
#include "mpm/stop_on_signal.hpp"
#include "output/run_folder.hpp"
#include "render/plot.hpp"
#include "support/files.hpp"
#include "support/numbers.hpp"

namespace mpm::app {
namespace {

namespace fs = std::filesystem;

drive::ExtremeSize size_of(const DriveOptions& options) {
  drive::ExtremeSize size;
  size.duration = options.duration, size.cycles = options.cycles;
  return size;
}

/// Where figures go: refuses what stands in the way before anything is computed.
void begin_folder(const DriveOptions& options, const std::vector<const char*>& names) {
  if (options.out.empty()) return;
  const std::string out = options.out.string();
  if (fs::exists(options.out) && !fs::is_directory(options.out))
    refuse_input(out, "is a file; choose a folder with --out");
  for (const char* name : names)
    if (!options.replace && fs::exists(options.out / (name + std::string(".png"))))
      refuse_input(out, std::string("holds ") + name + ".png already; add --replace, or choose another folder");
  std::error_code error;
  fs::create_directories(options.out, error);
  if (error) throw support::MachineError(out + " cannot be made: " + error.message());
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
void draw_paths(const DriveOptions& options, const std::vector<drive::Extreme>& rows, int dimension) {
  constexpr std::size_t every = 10;  // of the steps of a path, one has a point
  std::map<double, double> pressed, pulling, stretched, sheared;
  for (const drive::Extreme& row : rows)
    for (std::size_t k = every - 1; k < row.course.size(); k += every) {
      const auto& [size, state] = row.course[k];
      const double stress = stress_of(row, state);
      auto& points = is_of_volume(row)                       ? stress < 0 ? pulling : pressed
                     : row.kind == drive::ExtremeKind::shear ? sheared
                                                             : stretched;
      if (stress != 0) points[size] = std::abs(stress);
    }
  const auto plot = [&](const char* title, const char* x, const char* y) {
    render::Plot figure;
    figure.title = options.id + std::string(": ") + title;
    figure.x_label = x, figure.y_label = y;
    figure.log_x = figure.log_y = true;
    figure.footnote = "mpm drive " + options.id + " --extremes" + (dimension == 2 ? ", plane strain" : "");
    return figure;
  };
  const auto write = [&](render::Plot figure, const char* name, const auto&... parts) {
    const auto add = [&](const char* label, const std::map<double, double>& points) {
      render::Series series{label};
      for (const auto& [x, value] : points) series.x.push_back(x), series.y.push_back(value);
      if (!series.x.empty()) figure.series.push_back(series);
    };
    (add(parts.first, *parts.second), ...);
    if (figure.series.empty()) return;
    render::write_figure(figure, options.out / name);
    std::printf("figure: %s.png\n", (options.out / name).c_str());
  };
  write(plot("pressed to a millionth, torn to a million times its volume", "volume ratio J", "pressure, tension (Pa)"),
        "extremes_volume", std::pair{"pressure", &pressed}, std::pair{"tension", &pulling});
  write(plot("drawn, pressed flat and sheared at its volume", "stretch, or shear", "von Mises stress (Pa)"),
        "extremes_shape", std::pair{"stretched", &stretched}, std::pair{"sheared", &sheared});
}

/// A row of each material, a column of each path: the logarithm of the stress at its end over the stiffness at rest.
struct ExtremesMap {
  render::HeatMap map;

  ExtremesMap() {
    map.title = "Every material at its extremes";
    map.x_label = "in 1000 steps", map.y_label = "material";
    map.value_label = "decimal logarithm of the stress at the end over the stiffness at rest";
    map.x_names = {"J = 10⁻⁶: pressure", "J = 10⁶: tension", "drawn by 10⁴", "pressed to 10⁻⁴", "sheared by 10⁴"};
    map.digits = 2, map.height = 1400;
    map.footnote = "grey: no stress · at J = 1 the von Mises stress · mpm drive every --extremes";
  }
  void add(const std::string& material, const std::vector<drive::Extreme>& rows) {
    map.y_names.push_back(material);
    for (const drive::Extreme& row : rows) {
      if (row.course.empty() && row.outcome != drive::Outcome::refused) continue;
      if (row.must_be_refused || row.name == "the same in one step" || row.name.ends_with("cycles")) continue;
      const double share = std::abs(stress_of(row, row.end)) / row.stiffness;
      const bool shown = row.outcome == drive::Outcome::right && share > 0;
      map.values.push_back(shown ? std::log10(share) : std::numeric_limits<double>::quiet_NaN());
      map.notes.push_back(shown ? "" : row.outcome == drive::Outcome::right ? "0" : row.outcome_text());
    }
  }
};

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
  if (!options.out.empty() && !stop_requested()) draw_paths(options, rows, dimension);
  if (!stop_requested()) return all_hold ? done : run_failed;
  std::printf("stopped by a signal before the next extreme\n");
  return interrupted;
}

/// Prints a row of each material that is installed: what it answers at the extremes, or where it fails.
int drive_every_to_extremes(const DriveOptions& options) {
  begin_folder(options, {"extremes"});
  ExtremesMap chart;
  const Registry registry = load_registry();
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
    std::fflush(stdout);
    chart.add(std::string(plugin->id()), rows);
  }
  if (!options.out.empty() && !chart.map.y_names.empty()) {
    render::write_figure(chart.map, options.out / "extremes");
    std::printf("figure: %s.png\n", (options.out / "extremes").c_str());
  }
  return worst;
}

}  // namespace mpm::app
