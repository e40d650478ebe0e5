// Particles and grids as compact VTK XML files: binary data appended, compressed by zlib.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace mpm::output {

/// As VTK's files call the order of this machine's bytes.
inline constexpr const char* byte_order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";

/// The numbers of a data array; their type is that of the file.
using VtkNumbers =
    std::variant<std::vector<float>, std::vector<double>, std::vector<std::int32_t>, std::vector<std::uint8_t>>;

/// One array of a file; the unit belongs into the name: "velocity (m/s)".
struct VtkArray {
  std::string name;
  int components = 1;
  VtkNumbers numbers;  ///< [entry][component], components varying fastest
};

enum class VtkCell { vertex = 1, quadrilateral = 9, hexahedron = 12 };

/// Cells of one kind, each with points of its own in VTK's order: one, four or eight.
struct VtkCells {
  double time = 0;  ///< s
  VtkCell cell = VtkCell::vertex;
  VtkNumbers points;              ///< m, three numbers a point
  std::vector<VtkArray> of_cell;  ///< one entry a cell
};

/// Values of the nodes of a regular grid, x fastest.
struct VtkImage {
  double time = 0;                    ///< s
  std::array<double, 3> origin{};     ///< m
  double spacing = 1;                 ///< m
  std::array<int, 3> nodes{1, 1, 1};  ///< along each axis
  std::vector<VtkArray> of_node;
};

struct VtkEncoding {
  bool compress = true;
  int threads = 1;  ///< at most; the bytes do not depend on it
};

/// Writes an UnstructuredGrid (.vtu); data of vertices are PointData, of other cells CellData. A repeated name gets a
/// number. Throws std::invalid_argument when a size does not match; MachineError when the file cannot be written.
void write_vtu(const std::filesystem::path& path, const VtkCells& cells, const VtkEncoding& encoding);

/// Writes ImageData (.vti) with PointData. Throws as write_vtu does.
void write_vti(const std::filesystem::path& path, const VtkImage& image, const VtkEncoding& encoding);

/// The numbers in 32 or 64 bits.
VtkNumbers vtk_numbers(std::vector<double> values, bool in_double);

}  // namespace mpm::output
