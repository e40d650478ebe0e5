#include "linear_elastic.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::LinearElastic>,
    {"linear_elastic", "1.0.0", "Small-strain isotropic elasticity: the teaching baseline, wrong under rotation",
     "Hooke's law; e.g. Timoshenko & Goodier (1970), Theory of Elasticity, ch. 1",
     R"(eps = sym(F) - I, sigma = lambda tr(eps) I + 2 mu eps, psi = mu eps:eps + lambda/2 (tr eps)^2. Plane strain in
2-D. Valid for small strains AND small rotations: a rigid rotation by theta makes the false stress 2 (lambda + mu)(cos theta - 1)
in its plane. Use neo_hookean as soon as a body turns.)",
     "LinearElastic"})
