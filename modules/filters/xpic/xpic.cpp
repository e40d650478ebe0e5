#include "xpic.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(filter<mpm::Xpic>,
                  {"xpic", "1.0.0",
                   "XPIC(m): filters the grid velocity before the forces; removes null-space noise, keeps the rest",
                   "Hammerquist & Nairn (2017), Comput. Methods Appl. Mech. Engrg. 318:724-753",
                   R"(With S the gather grid -> particles and S+ the mass-weighted scatter back,

    v = sum_{j<m} (I - S+S)^j S+ V,    then  V <- S v + dt S a

v replaces the grid velocity before the forces, moves the particles and replaces their velocity. Order 1 is PIC. As m grows, all
that the grid can carry is kept and only the null space of the transfer (velocities that the grid cannot see) is removed.

Computed in increments: v* = v, then m - 1 times v* <- v* - S+S v*, v <- v + v*. Each order costs one gather and one scatter. The
mass norm of v* is the convergence monitor: with weights that are not negative it cannot grow; where it does (conditions, contact,
negative weights) the run says so.

With a transfer: S+S is the transfer's own round trip of v*. `pic` and `flip` give the series above (`flip` keeps its particle
velocity only in steps that are not filtered, so filter every few steps to mix the two; so do `aflip` and `asflip`). `apic`, `mls`
and `tpic` round-trip affine parts too, `rpic` rigid ones, so S+S is nearer to I and a low order is enough.

Dissipation does not fall steadily with the order: in impacts, orders below 4 may dissipate more than FLIP. The longest stable step
at order 2 is that of PIC or a little less: 1/sqrt(2) h/c at one particle a cell in the middle of it.)",
                   "Xpic"})
