#include "logistic_regression.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    normal<mpm::LogisticRegression>,
    {"logistic_regression", "1.0.0",
     "The plane across which a logistic curve goes from -1 in one body to +1 in the other",
     "Nairn, Hammerquist & Smith (2020), Comput. Methods Appl. Mech. Engrg. 362:112859",
     R"(As `linear_regression`, with the curve f(z) = 2 / (1 + exp(-z)) - 1 of z = b + s . x in place of the plane itself: the
least sum of w (c - f)^2 + `penalty` s^2. Particles far from the surface then count no more than that they are on their
side. Found by Newton's steps, each halved until it goes down, from linear regression on, while the penalty falls from 1.)",
     "LogisticRegression"})
