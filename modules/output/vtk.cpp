#include "output/vtk.hpp"

#include <cstdint>
#include <numeric>
#include <set>
#include <stdexcept>

#include "output/html.hpp"
#include "output/vtk_data.hpp"
#include "support/base64.hpp"
#include "support/files.hpp"
#include "support/numbers.hpp"

namespace mpm::output {
namespace {

constexpr std::uint8_t vertex_cell = 1;  ///< VTK_VERTEX

template <typename T>
constexpr const char* type_name();
template <>
constexpr const char* type_name<double>() {
  return "Float64";
}
template <>
constexpr const char* type_name<std::int64_t>() {
  return "Int64";
}
template <>
constexpr const char* type_name<std::uint8_t>() {
  return "UInt8";
}

/// Writes one DataArray, inline: a byte count and the bytes themselves, together in base64.
template <typename T>
void append_array(std::string& xml, const std::string& name, int components, const std::vector<T>& values,
                  const std::string& more_attributes = "") {
  const std::uint64_t size = values.size() * sizeof(T);
  std::string bytes(sizeof size + size, '\0');
  std::copy_n(reinterpret_cast<const char*>(&size), sizeof size, bytes.begin());
  std::copy_n(reinterpret_cast<const char*>(values.data()), size, bytes.begin() + sizeof size);
  xml += std::string("        <DataArray type=\"") + type_name<T>() + "\" Name=\"" + escape_html(name) +
         "\" NumberOfComponents=\"" + std::to_string(components) + "\"" + more_attributes + " format=\"binary\">\n";
  support::append_base64(xml, bytes);
  xml += "\n        </DataArray>\n";
}

std::vector<double> padded_to_three(const std::vector<double>& values, int components) {
  const std::size_t count = values.size() / components;
  std::vector<double> padded(3 * count, 0.0);
  for (std::size_t p = 0; p < count; ++p) {
    for (int c = 0; c < components; ++c) padded[3 * p + c] = values[components * p + c];
  }
  return padded;
}

/// Returns the number of particles, or refuses sizes that would write a file nobody can read.
std::size_t checked_count(const ParticleSnapshot& snapshot) {
  if (snapshot.dimension < 1 || snapshot.dimension > 3) {
    throw std::invalid_argument("a particle snapshot has dimension 1, 2 or 3, not " +
                                std::to_string(snapshot.dimension));
  }
  if (snapshot.positions.size() % snapshot.dimension != 0) {
    throw std::invalid_argument("the positions of a snapshot are not a multiple of its dimension");
  }
  const std::size_t count = snapshot.positions.size() / snapshot.dimension;
  for (const PointField& field : snapshot.fields) {
    if (field.components < 1 || field.values.size() != count * field.components) {
      throw std::invalid_argument("field '" + field.name + "' holds " + std::to_string(field.values.size()) +
                                  " numbers, not " + std::to_string(field.components) + " for each of " +
                                  std::to_string(count) + " particles");
    }
  }
  return count;
}

std::string unique_name(const std::string& wanted, std::set<std::string>& taken) {
  const std::string base = wanted.empty() ? "field" : wanted;
  std::string name = base;
  for (int i = 2; !taken.insert(name).second; ++i) name = base + " " + std::to_string(i);
  return name;
}

void append_fields(std::string& xml, const ParticleSnapshot& snapshot) {
  std::set<std::string> taken;
  xml += "      <PointData>\n";
  for (const PointField& field : snapshot.fields) {
    const std::string name = unique_name(field.name, taken);
    if (snapshot.dimension == 2 && field.components == 2) {
      append_array(xml, name, 3, padded_to_three(field.values, 2));
    } else {
      append_array(xml, name, field.components, field.values);
    }
  }
  xml += "      </PointData>\n";
}

void append_vertices(std::string& xml, std::size_t count) {
  std::vector<std::int64_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0);
  xml += "      <Cells>\n";
  append_array(xml, "connectivity", 1, numbers);
  std::iota(numbers.begin(), numbers.end(), 1);
  append_array(xml, "offsets", 1, numbers);
  append_array(xml, "types", 1, std::vector<std::uint8_t>(count, vertex_cell));
  xml += "      </Cells>\n";
}

std::string file_head(const char* type, const char* version) {
  return std::string("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<VTKFile type=\"") + type + "\" version=\"" +
         version + "\" byte_order=\"" + byte_order + "\" header_type=\"UInt64\">\n";
}

}  // namespace

void write_vtu(const std::filesystem::path& path, const ParticleSnapshot& snapshot) {
  const std::size_t count = checked_count(snapshot);
  const std::string number = std::to_string(count);
  std::string xml = file_head("UnstructuredGrid", "1.0");
  xml += "  <UnstructuredGrid>\n    <FieldData>\n";
  append_array(xml, "TimeValue", 1, std::vector<double>{snapshot.time}, " NumberOfTuples=\"1\"");
  xml += "    </FieldData>\n    <Piece NumberOfPoints=\"" + number + "\" NumberOfCells=\"" + number + "\">\n";
  append_fields(xml, snapshot);
  xml += "      <Points>\n";
  append_array(xml, "Points", 3, padded_to_three(snapshot.positions, snapshot.dimension));
  xml += "      </Points>\n";
  append_vertices(xml, count);
  xml += "    </Piece>\n  </UnstructuredGrid>\n</VTKFile>\n";
  support::write_atomically(path, xml);
}

void write_pvd(const std::filesystem::path& path, const std::vector<std::pair<double, std::string>>& time_and_file) {
  std::string xml = file_head("Collection", "0.1");
  xml += "  <Collection>\n";
  for (const auto& [time, file] : time_and_file) {
    xml += "    <DataSet timestep=\"" + support::shortest(time) + "\" group=\"\" part=\"0\" file=\"" +
           escape_html(file) + "\"/>\n";
  }
  xml += "  </Collection>\n</VTKFile>\n";
  support::write_atomically(path, xml);
}

}  // namespace mpm::output
