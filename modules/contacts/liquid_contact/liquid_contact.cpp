#include "liquid_contact.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    contact<mpm::LiquidContact>,
    {"liquid_contact", "1.0.0", "A liquid that slips along a wall against a viscous traction",
     "Neto, Evans, Bonaccurso, Butt & Craig (2005), Rep. Prog. Phys. 68:2859-2897, eq. 1",
     R"(Bodies that approach and touch press as with `frictionless`. Where they touch, the sliding speed v meets the traction
`viscosity` v / `slip_length`, pressed or not: what a liquid of that viscosity feels whose speed would reach that of the
wall a slip length beyond it. The speed decays exponentially over each step, whatever its length. A short slip length
makes the liquid stick, a long one lets it slide freely. What the traction takes is heat.)",
     "LiquidContact"})
