#include "polypic.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    transfer<mpm::Polypic>,
    {"polypic", "1.0.0",
     "Polynomial particle-in-cell: APIC plus higher polynomials of the velocity around the particle",
     "Fu, Guo, Gast, Jiang & Teran (2017), ACM Trans. Graph. 36(6):222",
     R"(The particle carries v, the affine velocity C of `apic`, and coefficients c of further polynomials of d = node - particle:
it gives nodes w m (v + C d + sum c P(d)). Each P is a product of one polynomial an axis, 1, d, d^2 - (sum w d^3 / D) d - D ...,
orthogonal under that axis's weights, in cells, so each coefficient is taken back by itself: c = sum w P v+ / sum w P^2 (of
the highest power that the nodes bear: the finite difference, which is the same and divides by no vanishing weight).

`multilinear` has powers up to 1: d_x d_y in 2-D (2 more scalars a particle), four functions in 3-D (12 more). `full` has as
many as the shape has nodes along an axis: on quadratic splines 6 functions in 2-D (12 scalars) and 23 in 3-D (69), on cubic
ones 13 and 60, on `linear` the multilinear ones. It is lossless: particles that rest give the grid back every velocity that
they took, one particle a stencil as well as many.

Every P beyond the affine ones is orthogonal to 1 and to d: momentum and angular momentum are those of `apic`, kept to rounding.
The coefficients count as kinetic energy, m/2 |c|^2 sum w P^2 each, and start as zero.

When to use it: flows whose vortices `apic` damps. Less damping is also less damping of noise: `full` keeps everything that
the grid holds, and a particle's own modes at lightly loaded nodes with it. It costs about as many sums as it has functions.

Refused: shapes that list their nodes (they have no axes), and `full` on shapes with a particle size, whose outer weights
vanish within the stencil: what the grid holds there is not this particle's. With a filter at every step the
projection is the transfer's own round trip, polynomials included; `full` leaves a filter nothing to do where one particle has a stencil for itself.)",
     "Polypic"})
