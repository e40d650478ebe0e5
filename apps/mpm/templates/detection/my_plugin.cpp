#include "my_plugin.hpp"

#include "plugin/sdk.hpp"

MPM_EXPORT_PLUGIN(detection<mpm::MyPlugin>,
                  {"my_plugin", "0.1.0", "Bodies touch where a film is all that is between their faces",
                   "Nairn (2013), CMES - Comput. Model. Eng. Sci. 92:271-299, with the contact offset computed",
                   "The gap is that between the faces whose rows of particles would have the bodies' mean positions, "
                   "less the thickness of "
                   "a film.",
                   "MyPlugin"})
