#include "damage.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    material<mpm::Damage>,
    {"damage", "1.0.0", "Elastic solid that cracks: scalar damage with crack-band scaling",
     "Bazant & Oh (1983), Crack band theory for fracture of concrete, Mater. Struct. 16:155; Simo & Ju (1987), Strain- "
     "and stress-based continuum damage models, Int. J. Solids Struct. 23:821; the split: Freddi & Royer-Carfagni "
     "(2010), "
     "Regularized variational theories of fracture, J. Mech. Phys. Solids 58:1154; bilinear: Petersson (1981), report "
     "TVBM-1006, Lund",
     R"(psi = psi(p) + (1 - d) psi(r),   tau = C (e - d r),   r = e - p,   e = ln V, C and psi those of `hencky`

p is the part of the strain that a solid without any tension would feel, r >= 0 what its cracks would take: of all such r the one
that leaves the least energy psi(e - r). Damage d grows with the largest y = sqrt(2 psi(r)/(lambda + 2 mu)) so far, so that uniaxial
tension has a stress sigma(kappa) at kappa = ln s: E kappa up to `tensile_strength` ft, then

    linear       a straight line down to 0 at kappa = 2 Gc/(ft b)
    exponential  ft exp(-(kappa - ft/E)/eps_s),   eps_s = Gc/(b ft) - ft/(2 E)
    bilinear     lines to ft/3 where a crack is open by 0.8 Gc/ft, and to 0 at 3.6 Gc/ft (concrete)
    table        lines from (0, 1) through the points (opening_1, share_1) and so on to (1, 0)

A table has up to four points. Their openings are over wf, that of a crack without strength, and their shares over ft. wf is not
given: it is Gc/(ft A) with A the area below the lines, so that the crack dissipates Gc whatever the table. Without points it is
`linear`. Openings that do not grow, and shares that do, are refused.

b = `band_cells` times the cell size is the width of the band in which strain localises. The area below sigma(kappa) is Gc/b, so
that a crack through a bar dissipates Gc = `fracture_energy` a unit of area on any grid. It is one cell for linear shapes and two for
quadratic B-splines: bars that crack along the cells then dissipate Gc, and 0.95 to 1.04 Gc. A band that crosses the cells askew is wider: b
does not know it.

A band may not be so wide that it holds more elastic energy at its strength than its crack dissipates (snap-back): b < 2 E Gc/ft^2,
for `bilinear` b < 1.2 E Gc/ft^2, for a table b < E wf m/ft with m the least of opening over loss among its lines. An experiment with larger cells is refused, with the largest usable size.

Exact in uniaxial tension at any strain, in Kirchhoff stress and logarithmic strain, and the dissipated energy for steps of any
length. Damage begins where the largest principal stress is ft, if cracks open in one direction alone (in tension, shear, and strain
confined at the sides); two stresses alike along two axes damage from ft/sqrt(2 (1 - nu)) on. Where no principal stress of the whole
solid pulls there is no damage: nothing is ever crushed.

Closed cracks are as stiff as the whole solid, and without friction.

**Softening is isotropic.** One number d weakens all directions in which anything pulls, so that a particle which a crack
has crossed bears no tension along the crack either, and a second crack across the first one costs nothing there. What is
pressed is not weakened, in whatever direction. `anisotropic_damage` cracks on a plane, and stays whole along it.

State: F, the largest kappa and d. Stress goes to the origin on unloading, without a strain that stays. Dissipation: psi(r) dd, never
negative. J <= 0 is refused: the run stops and names the particle. In single precision strains have 1e-7 of rounding: ft/E must be
well above that.

Wave speed: that of `hencky`, as if undamaged where anything is pressed, else with the share that is left, and never below that at
rest, as cracks close in no time.)",
     "Damage"})
