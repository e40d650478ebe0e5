#pragma once
// Reads what bodies are made of from files that the experiment names.

#include "experiment/experiment.hpp"
#include "experiment/parameter.hpp"

namespace mpm {

/// The path that a key `file` names, from the folder of the experiment file; nothing, with a problem recorded, when it is
/// no file that can be read. Notes it among the context's inputs, and writes it absolute into `resolved`.
std::optional<std::filesystem::path> input_file(const Fields& fields, ReadContext& context, OrderedJson& resolved);

/// A closed surface or a picture; null, with a problem recorded, when it is not usable.
GeometryPointer read_surface(const Fields& fields, ReadContext& context, OrderedJson& resolved);
GeometryPointer read_mask(const Fields& fields, ReadContext& context, OrderedJson& resolved);

/// Reads a table of points: columns x, y, in 3-D z, m, and `volume` or `mass` (kg), in plane strain per metre of depth, in
/// axisymmetric scenes of the whole ring. Throws std::runtime_error with the path and the line, MachineError.
std::vector<SeededPoint> read_seeded_points(const std::filesystem::path& path, int dimension,
                                            const GridSpecification& grid, double density, bool& have_volumes);

}  // namespace mpm
