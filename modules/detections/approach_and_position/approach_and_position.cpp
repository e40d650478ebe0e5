#include "approach_and_position.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    detection<mpm::ApproachAndPosition>,
    {"approach_and_position", "1.0.0", "Bodies touch where the faces that their mean positions stand for meet",
     "Nairn (2013), CMES - Comput. Model. Eng. Sci. 92:271-299, with the contact offset computed",
     R"(A node knows a body's surface by the mean position of the mass that it sees, which lies inside the body. A model of
rows of particles behind a face, for the scene's shape function and particles a cell, tells where the face is that has
this mean, so that no offset is typed in (`mpm contact-offset`). It knows nothing of how a face is turned against the
grid, nor of how its particles have been stretched.)",
     "ApproachAndPosition"})
