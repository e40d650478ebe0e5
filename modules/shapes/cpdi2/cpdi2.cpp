#include "cpdi2.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    shape<mpm::Cpdi2>,
    {"cpdi2", "1.0.0",
     "CPDI2: tents at the corners of a domain whose corners move with the grid; neighbours stay joined",
     "Sadeghirad, Brannon & Guilkey (2013), Int. J. Numer. Meth. Engng 95:928-952",
     R"(Each particle keeps the corners x_c of a quadrilateral (hexahedron in 3-D), at the start those of its box. After every step
they have moved with the multilinear velocity of the grid at their own place, and the particle is the centroid of its domain.
With Q_c the multilinear functions of the corners and <> the mean over the domain:

    w_i = sum_c <Q_c> N_i(x_c),    grad w_i = sum_c <grad Q_c> N_i(x_c)

Both means are exact (in 2-D: areas and edge normals; in 3-D 8 Gauss points integrate the trilinear map without error). Affine
fields are reproduced whatever the domain's form. A corner that neighbours share moves alike for both: no gaps or overlaps
open under any motion, as they do with `cpdi`, whose parallelogram knows only the particle's own F. Where the motion is affine
both are the same to rounding.

The centroid of a bent domain moves a little otherwise than the mean of its corners' velocities, by terms of second order in
its size, so the centre of mass follows the momentum to that order and not to rounding. Momentum itself is kept to rounding.
Particles whose own velocity moves them (`asflip`) take their corners along.

A domain that turns inside out (a corner reaches the opposite edge) ends the run with exit code 3: choose `cpdi`, whose
parallelograms cannot fold before the material inverts, or smaller steps and stiffer material. Corners cost 8 (24) numbers a
particle. Lists of nodes only, without boxes: slower than `cpdi`.)",
     "Cpdi2"})
