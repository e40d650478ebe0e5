#include "asflip.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    transfer<mpm::Asflip>,
    {"asflip", "1.0.0", "Affine separable FLIP: AFLIP whose particles part where material opens",
     "Fei, Guo, Wu, Huang & Gao (2021), ACM Trans. Graph. 40(4):109",
     R"(As `aflip`, and the particle also moves with a share of what the grid smooths away: x += dt (u + beta alpha r), u = sum w v+,
r = v - sum w v-, alpha = 1 - `pic_fraction`. beta = `beta_min` where ln J of the motion is below `threshold` (material pressed
together), else `beta_max`. On the grid alone two particles of one cell cannot part, whatever their velocities; with beta_max = 1
they do. beta_min = beta_max = 0 is `aflip`.

ln J is the transfer's own state, the sum of dt tr C; the paper takes J of the elastic deformation. A material that has flowed open
therefore counts as open until the motion closes it. The paper sets beta to zero inside colliders as well; here walls hold the grid
alone, and a particle that r carries through one leaves the domain, which stops the run: keep beta_min at 0 where bodies press
against walls. Energy at walls, and what v- is: see `aflip`. What is conserved: as `aflip`; positions move with a velocity of the same momentum only where beta is uniform.)",
     "Asflip"})
