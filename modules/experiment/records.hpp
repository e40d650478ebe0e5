#pragma once
// Numbers that an experiment may ask for beside the totals: those of bodies, groups of particles, probes and pairs in
// contact; and figures of columns.

#include "experiment/parameter.hpp"
#include "experiment/read.hpp"

namespace mpm {

/// Keys of the output section: "bodies", "groups", "probes", "contact_pairs".
std::vector<ParameterSpec> record_parameters();
/// What the items of /figures are beside names.
Section column_figure_section();
Section group_section();
Section probe_section(const ReadOptions& options);

}  // namespace mpm
