#include "linear_regression.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    normal<mpm::LinearRegression>,
    {"linear_regression", "1.0.0", "The slope of the plane that fits -1 in one body and +1 in the other",
     "Nairn, Hammerquist & Smith (2020), Comput. Methods Appl. Mech. Engrg. 362:112859",
     R"(The particles of both bodies near the node get the labels c = -1 and +1, and the plane b + s . x that has the least
sum of w (c - b - s . x)^2 + `penalty` s^2 gives the normal s / |s|. The weights w are those of the quadratic B-spline at the
node, whatever the shape of the scene.)",
     "LinearRegression"})
