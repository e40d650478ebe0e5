#include "fixed_offset.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(
    detection<mpm::FixedOffset>,
    {"fixed_offset", "1.0.0", "Bodies touch where their mean positions are closer than a given number of cells",
     "Nairn (2013), CMES - Comput. Model. Eng. Sci. 92:271-299",
     R"(The gap is the distance between the mean positions of the mass that a node sees of both bodies, less `offset` cells.
Programs differ in the number: 0.8 is common, and 0.67 and 1 are met. The right one depends on the shape function, the
particles a cell, and where between two nodes the faces are (`mpm contact-offset`), so that none is right everywhere. It
is kept to repeat what other programs do, and to show what it costs.)",
     "FixedOffset"})
