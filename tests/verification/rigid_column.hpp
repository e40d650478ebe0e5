#pragma once
// A block between rigid plates.

namespace mpm::test::rigid_column {

/// A block between slip walls: uniaxial strain along y, with the modulus M = E (1 - nu) / ((1 + nu)(1 - 2 nu)).
inline const char* column = R"J({
  "title": "column between rigid plates", "dimension": 2,
  "grid": {"cell_size": 0.05, "domain": [[0, -0.5], [0.2, 1.5]], "boundaries": {"all": "slip"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
  "materials": {"m": {"type": "linear_elastic", "youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [{"name": "column", "material": "m", "geometry": {"type": "box", "lower": [0, 0], "upper": [0.2, 1]}}],
  "rigid_bodies": [
    {"name": "anvil", "geometry": {"type": "box", "lower": [-0.2, -0.4], "upper": [0.4, 0]},
     "contact": {"type": "frictionless"}},
    {"name": "press", "geometry": {"type": "box", "lower": [-0.2, 1], "upper": [0.4, 1.4]}, "velocity": [0, 0],
     "contact": {"type": "frictionless"}}],
  "solver": {"time_step": "auto", "end_time": 0.3}})J";

}  // namespace mpm::test::rigid_column
