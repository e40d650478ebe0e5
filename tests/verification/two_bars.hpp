#pragma once
// Two equal bars that meet.

namespace mpm::test {

/// With L = 1 m, E = 1e4 Pa and density 1, c = 100 m/s. At 0.1 m/s each, the bars touch for 2 L / c = 0.02 s with rho c
/// v = 10 Pa.
inline const char* two_bars = R"J({
  "dimension": 2,
  "grid": {"cell_size": 0.01, "domain": [[0, 0], [3, 0.01]],
           "boundaries": {"x_min": "free", "x_max": "free", "y_min": "slip", "y_max": "slip"}},
  "shape": {"type": "linear"}, "transfer": {"type": "flip"}, "contact": {"type": "coulomb"},
  "materials": {"m": {"type": "linear_elastic", "youngs_modulus": 1e4, "poisson_ratio": 0, "density": 1}},
  "bodies": [
    {"name": "left", "material": "m", "velocity": [0.1, 0], "geometry": {"type": "box", "lower": [0.5, 0], "upper": [1.5, 0.01]}},
    {"name": "right", "material": "m", "velocity": [-0.1, 0], "geometry": {"type": "box", "lower": [1.5, 0], "upper": [2.5, 0.01]}}],
  "solver": {"time_step": 3e-5, "end_time": 0.03}, "output": {"ledger": false}})J";

}  // namespace mpm::test
