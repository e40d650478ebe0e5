#pragma once
// How a device works on an experiment: the section `device` of its file.

#include "experiment/experiment.hpp"
#include "experiment/parameter.hpp"

namespace mpm {

Section device_section();

/// Reads the section into `resolved`, and refuses it on other backends; nothing where the file has none.
void read_device(const Node* node, const Experiment& experiment, ReadContext& context,
                 nlohmann::ordered_json& resolved);

/// Whether particles are summed on nodes to the same bits in any order of the device's lanes.
bool sums_deterministically(const Experiment& experiment);

}  // namespace mpm
