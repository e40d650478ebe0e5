#pragma once
// A material point along a path: stages of imposed deformation or velocity gradient, of prescribed Cauchy stress, or of
// both, component by component.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drive/material_point.hpp"
#include "experiment/experiment.hpp"
#include "experiment/expression.hpp"

namespace mpm::drive {

/// One component and what it follows: a number or formula of the time t since the stage began, s.
struct Prescribed {
  int i, j;
  ScalarExpression value;
  std::string pointer;  ///< JSON pointer of the value
};

/// What a stage imposes where it prescribes no stress.
enum class Motion {
  deformation_gradient,  ///< components of F at the end of each step; those not named stay as they are
  velocity_gradient      ///< components of L in the middle of each step, 1/s; those not named are zero
};

/// A stage of a path. A shear stress frees the upper component of the motion (xy, xz or yz), and the lower one stays
/// imposed, so that the point does not turn freely.
struct Stage {
  std::string name, pointer;
  double duration = 1;  ///< s
  int steps = 100;
  Motion motion = Motion::deformation_gradient;
  std::vector<Prescribed> imposed;
  std::vector<Prescribed> stresses;  ///< Cauchy stress at the end of each step, Pa; i <= j
};

/// What `mpm run` reads where the solver is a material point. Of `experiment` only title, description, dimension, the one
/// material, expectations, file and the resolved text are filled.
struct DriveExperiment {
  Experiment experiment;
  std::vector<Stage> stages;

  const Component& material() const { return experiment.materials.front().component; }
};

/// The state after a step.
struct Row {
  double time = 0;  ///< s, since the path began
  long step = 0;    ///< since the path began
  int stage = 0;
  Matrix F = Matrix::identity();
  Response response;
  double dissipated = 0, work = 0;  ///< J/m^3, since the path began
  std::vector<double> state;        ///< as the columns of the material point
};

/// Why a path could not be followed to its end.
struct Stop {
  int stage = 0, step = 0;  ///< step of the stage, from 1
  double time = 0;          ///< s, that the step would have ended at
  std::string reason, remedy;
};

struct Course {
  std::vector<StateColumn> columns;
  std::vector<Row> rows;  ///< the start, then a row a step
  std::optional<Stop> stop;
  bool is_interrupted = false;        ///< it was asked to stop before its end
  long iterations = 0;                ///< of Newton's method
  std::vector<std::string> warnings;  ///< of the material's clamps that acted
};

/// How the stress depends on the open components: by the plugin's tangent where it has one, or by central differences.
enum class Slopes { tangent, differences };

/// Follows the path. In each step the open components are found by Newton's method, up to 1e-12 of the stress and the 1e-13
/// of rho c^2 that rounding of the strain leaves. The work is that of the Kirchhoff stress on the velocity gradient, by
/// three Gauss points a step, each a shorter step from the same state.
/// Before each step it asks whether it is to stop.
Course follow(const DriveExperiment& path, Slopes slopes = Slopes::tangent,
              const std::function<bool()>& stop_requested = {});

}  // namespace mpm::drive
