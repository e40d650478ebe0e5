#include "cpdi.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    shape<mpm::Cpdi>,
    {"cpdi", "1.0.0", "CPDI: tents at the corners of a domain that deforms with F; exact for affine fields",
     "Sadeghirad, Brannon & Burghardt (2011), Int. J. Numer. Meth. Engng 86:1435-1456, eqs. 17-20",
     R"(Each particle keeps a parallelogram (parallelepiped in 3-D) with semi-side vectors R = F R0, R0 its box at the
start. A node's weight is the mean of its tent over the 4 (8) corners; its gradient is the mean gradient, over the domain, of the
multilinear field through the corners' values:

    w_i = sum_s N_i(x + R s)/n,    grad w_i = R^-T sum_s s N_i(x + R s)/n,    s = (+-1, ...), n = 2^D

Both are exact for affine fields whatever F is, so domains that stretch over many cells still see each other: no numerical
fracture as with `gimp`. Where a domain straddles no grid line its gradients equal those of `gimp`; elsewhere in 2-D and 3-D they
do not. Under non-affine motion the corners that neighbours shared at the start drift apart.

Corners are not stored: 4 (9) numbers a particle hold R, which the host advances with the velocity gradient that strains the
particle. Corners that share a node are merged: at most 16 (64) nodes a particle, 9 (27) or fewer in the undeformed state.

A domain that has collapsed (|det R| within 64 rounding errors of 0 against the product of its sides) has no R^-1. Its gradients
are then the mean of the tents' own gradients at the corners, which is also exact for affine fields; nothing divides by zero.

The second moment is a full matrix a particle, summed from the weights, for APIC and MLS-MPM.

Particles whose nodes fit a box of 4 an axis, nearly all in practice, are computed together on the cpu backend; each of the others
takes a list of its nodes, at some ten times the cost.)",
     "Cpdi"})
