#include "anisotropic_damage.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::AnisotropicDamage>,
    {"anisotropic_damage", "1.0.0", "Elastic solid that cracks on a plane, and stays whole along it",
     "Nairn, Hammerquist & Aimene (2017), Numerical implementation of anisotropic damage mechanics, Int. J. Numer. "
     "Methods Eng. 112:1848; Bazant & Oh (1983), Crack band theory for fracture of concrete, Mater. Struct. 16:155; "
     "how both "
     "strengths fade together: Park, Paulino & Roesler (2009), A unified potential-based cohesive model of mixed-mode "
     "fracture, J. Mech. Phys. Solids 57:891",
     R"(psi = E:C:E/2 - d_n M <x>^2/2 - d_s 2 mu |gamma|^2,   E = ln V,   n = R n0,   M = lambda + 2 mu
x = n.E n + nu/(1 - nu) (tr E - n.E n),   gamma = E n - (n.E n) n,   tau = R (g o dpsi/d ln U) R^T

C is that of `hencky`, which this solid is until it cracks. Where its largest principal stress exceeds
`tensile_strength` ft a crack begins across that stress, with the normal n0 in the undeformed body, and keeps this
plane. Across it the solid bears (1 - d_n) M x where it is pulled, along it (1 - d_s) 2 mu gamma; pressed, it bears
all of M x. Pulled or pressed along its plane the body is whole: this is what sets it apart from `damage`, whose one
number weakens all directions. g is z/sinh(z) between principal directions whose strains differ by z, and 1 on the
diagonal, as ln U and its derivative have different axes here.

Two laws of softening (`linear`, `exponential`, `bilinear`, as `damage` has them) say how both stresses fall:

    opening     f(kappa) of ft, Gc = `fracture_energy` and E, kappa the strain ln s of uniaxial tension along n
    sliding     f(gamma_s) of `shear_strength` ts, Gs = `shear_fracture_energy` and mu, gamma_s = 2 |gamma|

kappa and gamma_s are the largest so far, and what is left of each stiffness is that of its own law times the share of
its strength that the other law has left:  1 - d_n = (1 - D_n(kappa)) f(gamma_s)/ts,   1 - d_s = (1 - D_s(gamma_s))
f(kappa)/ft. A plane that has parted has no shear strength left, nor one that has slid apart tension; before that both
fade together. So a plane that only opens dissipates Gc, one that only slides Gs, and one that has lost half of its
tension and then slides, closed, half of Gs more.

**Why shear begins no crack.** Of planes of largest shear there are two, at equal angles to the stresses and equal in
rank. Which of them a pressed solid slides along is a matter of friction, which this law does not have. Shear softens the
plane that tension has opened. In pure shear the largest principal stress is the shear stress, so that a crack begins at
ft across that. Solids that slide under pressure are other laws (`mohr_coulomb`).

Both laws are scaled by the band width b = `band_cells` times the cell size, as in `damage`: a crack dissipates its
energy a unit of area on any grid. Cells are refused, with the largest usable size, unless b < 2 E Gc/ft^2 and b < 2
mu Gs/ts^2 (1.2 in place of 2 for `bilinear`): a wider band would snap back.

Exact in uniaxial tension along n and in shear of the closed plane, in components of the logarithmic strain, and so is
what these dissipate in steps of any length. Dissipation: M <x>^2/2 dd_n + 2 mu |gamma|^2 dd_s, never negative.

**One plane, fixed.** Where the principal stresses turn after the crack has begun, the plane does not: what it still
bears grows with the strain along its law, and tension builds up askew of it, without limit along it (stress locking).
A second crack across the first one does not begin. Of equal principal stresses rounding chooses the plane. n turns
with R, and not as a surface of the body: where a crack slides by tenths of the band both differ, and an open one then
bears stress. It closes without friction.

In 2-D the plane may also be that of the drawing, or, in axisymmetric scenes, the one through the axis (cracks that
hoop stress opens): its `crack_normal` is then zero, and `opening_strain` above 0
tells it from a solid without a crack.

State: F, n0, kappa, gamma_s, d_n, d_s. Stress goes to the origin on unloading, without a strain that stays. J <= 0 is
refused: the run stops and names the particle. In single precision strains have 1e-7 of rounding: ft/E and ts/mu must
be well above that.

Wave speed: that of `hencky`, as the second derivative of psi by E is that of C less what is never negative; with
stresses as the crack leaves them, and mu plus their largest difference where there is a crack. No proof is known for
waves askew of the axes; none of those that tests try is faster.)",
     "AnisotropicDamage"})
