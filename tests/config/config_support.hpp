#pragma once
// Reads experiment texts from a real file and gives back the whole error text, with the file's name as FILE.

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "config/fake_plugins.hpp"
#include "experiment/read.hpp"
#include "support/temporary_folder.hpp"

namespace mpm::test {

inline std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

/// The text as a file in the folder.
inline std::filesystem::path experiment_file(const TemporaryFolder& folder, std::string_view text) {
  const std::filesystem::path path = folder / "experiment.json";
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

/// Two discs with contact, touching most of the format.
inline const char* const two_discs = R"json(// Two discs
{
  "title": "Two elastic discs",
  "dimension": 2,
  "constants": {"A": 0.05, "w": "30 deg"},
  "grid": {
    "cell_size": "25 mm",
    "domain": [[0, 0], [1, 1]],
    "boundaries": {"all": "slip", "x_min": {"type": "prescribed", "velocity": ["A*sin(t)", 0]}}
  },
  "node_conditions": [
    {"type": "separate", "lower": [0, 0], "upper": [1, 0], "axis": "y", "side": "-"},
    {"type": "prescribed", "lower": [0, 0], "upper": [1, 0], "velocity": [null, "2 cm/s"]}
  ],
  "shape": {"type": "bspline_quadratic"},
  "transfer": {"type": "flip", "pic_fraction": 0.1},
  "contact": {"type": "coulomb", "friction": 0.3},
  "materials": {
    "rubber": {"type": "neo_hookean", "youngs_modulus": "1 kPa", "density": "1 g/cm^3"}
  },
  "bodies": [
    {"name": "left", "material": "rubber", "particles_per_cell_axis": 3, "jitter": 0.1,
     "geometry": {"type": "ball", "centre": [0.2, 0.2], "radius": "20 cm"},
     "velocity": ["0.1 m/s", "A*x"]},
    {"name": "right", "material": "rubber",
     "geometry": {"type": "difference", "of": [
       {"type": "ball", "centre": [0.7, 0.7], "radius": 0.2},
       {"type": "half_space", "point": [0.7, 0.7], "normal": [1, 1]}]}}
  ],
  "gravity": [0, "-9.81 m/s^2"],
  "body_force": ["A*X", "pi*t"],
  "solver": {"stress_update": "modified_last", "time_step": "1 ms", "end_time": 3.5},
  "output": {"frames": 40, "vtk": true},
  "figures": ["energy", "contact"],
  "compare": {
    "exact": {"type": "rolling", "start": "2 ms"},
    "expect": [{"metric": "energy.total.final_over_initial", "at_least": 0.98}]
  }
}
)json";

inline Experiment read_text(const std::string& text, std::vector<std::string> overrides = {}) {
  const TemporaryFolder folder;
  return read_experiment(experiment_file(folder, text), components(), options(std::move(overrides)));
}

/// The words of the InputError that reading throws; "accepted" when it throws none.
inline std::string errors_with(const std::string& text, const ReadOptions& options) {
  const TemporaryFolder folder;
  const std::filesystem::path file = experiment_file(folder, text);
  try {
    read_experiment(file, components(), options);
  } catch (const InputError& error) {
    return replaced(error.what(), file.string(), "FILE");
  }
  return "accepted";
}
inline std::string errors(const std::string& text, std::vector<std::string> overrides = {}) {
  return errors_with(text, options(std::move(overrides)));
}

/// The errors of the two discs with a part of the text replaced.
inline std::string errors_after(std::string_view from, std::string_view to) {
  const std::string changed = replaced(two_discs, from, to);
  return changed == two_discs ? "nothing was replaced" : errors(changed);
}

}  // namespace mpm::test
