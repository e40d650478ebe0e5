#include "particle_surfaces.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    detection<mpm::ParticleSurfaces>,
    {"particle_surfaces", "1.0.0", "Bodies touch where their outermost particles do, as deformed ellipses",
     "Nairn, Hammerquist & Smith (2020), Comput. Methods Appl. Mech. Engrg. 362:112859",
     R"(The gap along the normal between the outermost particles that a node sees of both bodies, each as the ellipse
(ellipsoid in 3-D) inscribed in its deformed domain, less a millionth of a cell for rounding. Particles carry F for it,
or the domain that their shape has. It is exact for flat faces, however they lie and are stretched; the steps of a curved
rim touch it too early.)",
     "ParticleSurfaces"})
