#include "fmpm.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    filter<mpm::Fmpm>,
    {"fmpm", "1.0.0", "FMPM(k): filters the grid velocity after the forces by the series of the inverse mass matrix",
     "Nairn & Hammerquist (2021), Comput. Methods Appl. Mech. Engrg. 377:113667; Nairn (2026), arXiv 2604.07307",
     R"(With S the gather grid -> particles and S+ the mass-weighted scatter back, S+S is the consistent mass matrix over
the lumped one, and

    v = sum_{j<k} (I - S+S)^j v+

is its inverse applied to the lumped velocity, cut after k terms; the residual is (I - S+S)^k. v replaces the grid velocity after
the forces, strains and moves the particles and replaces their velocity. Order 1 is PIC.

Computed in increments: v* = v+, then k - 1 times v* <- v* - S+S v*, v <- v + v*. Each order costs one gather and one scatter. The
mass norm of v* is the convergence monitor: with weights that are not negative it cannot grow; where it does (conditions, contact,
negative weights) the run says so.

With a transfer: S+S is the transfer's own round trip of v*. `pic` and `flip` give the series above (`flip` keeps its particle
velocity only in steps that are not filtered, so filter every few steps to mix the two; so do `aflip` and `asflip`). `apic`, `mls`
and `tpic` round-trip affine parts too, `rpic` rigid ones, so S+S is nearer to I and a low order is enough.

Stability is lost with order: at one particle in the middle of each cell the longest step is h/(c sqrt(2 k)) (0.707, 0.5, 0.354 h/c
at k = 1, 2, 4); other layouts lose less. Dissipation does not fall steadily with the order: in impacts, orders below 4 may
dissipate more than FLIP, orders from 4 on less.)",
     "Fmpm"})
