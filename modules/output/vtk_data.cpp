#include "output/vtk_data.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <set>
#include <stdexcept>

#include "output/html.hpp"
#include "support/files.hpp"
#include "support/numbers.hpp"
#include "support/parallel.hpp"

namespace mpm::output {
namespace {

/// Bytes that are compressed at a time: blocks of one array are independent, so that several threads may work on them.
constexpr std::size_t block_bytes = 1 << 18;
/// zlib's fastest level: mantissas of a simulation hardly get smaller by more work.
constexpr int zlib_level = 1;

const char* type_name(const VtkNumbers& numbers) {
  constexpr const char* names[] = {"Float32", "Float64", "Int32", "UInt8"};
  return names[numbers.index()];
}

std::size_t count_of(const VtkNumbers& numbers) {
  return std::visit([](const auto& values) { return values.size(); }, numbers);
}

std::string_view bytes_of(const VtkNumbers& numbers) {
  return std::visit(
      [](const auto& values) {
        return std::string_view(reinterpret_cast<const char*>(values.data()), values.size() * sizeof values[0]);
      },
      numbers);
}

void append_count(std::string& bytes, std::uint64_t count) {
  char raw[sizeof count];
  std::memcpy(raw, &count, sizeof count);
  bytes.append(raw, sizeof count);
}

std::string compressed(std::string_view block) {
  uLongf size = compressBound(static_cast<uLong>(block.size()));
  std::string out(size, '\0');
  const int result =
      compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(block.data()),
                static_cast<uLong>(block.size()), zlib_level);
  if (result != Z_OK) throw std::runtime_error("zlib could not compress a block: " + std::string(zError(result)));
  out.resize(size);
  return out;
}

/// Collects a file: XML that names arrays, then their bytes one after another.
class VtkFile {
 public:
  VtkFile(const char* type, const VtkEncoding& encoding) : type_(type), encoding_(encoding) {
    xml_ = std::string("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<VTKFile type=\"") + type +
           "\" version=\"1.0\" byte_order=\"" + byte_order + "\" header_type=\"UInt64\"" +
           (encoding.compress ? " compressor=\"vtkZLibDataCompressor\"" : "") + ">\n";
  }

  void text(const std::string& xml) { xml_ += xml; }

  /// The arrays must outlive the file. `attributes` begin with a blank.
  void array(const std::string& name, int components, const VtkNumbers& numbers, const std::string& attributes = "") {
    xml_ += std::string("        <DataArray type=\"") + type_name(numbers) + "\" Name=\"" + escape_html(name) +
            "\" NumberOfComponents=\"" + std::to_string(components) + "\"" + attributes +
            " format=\"appended\" offset=\"";
    offsets_.push_back(xml_.size());
    xml_ += "\"/>\n";
    arrays_.push_back(&numbers);
  }

  void time(const VtkNumbers& value) {
    text("    <FieldData>\n");
    array("TimeValue", 1, value, " NumberOfTuples=\"1\"");
    text("    </FieldData>\n");
  }

  /// One entry for each of `count` points or cells.
  void data(const char* section, const std::vector<VtkArray>& arrays, std::size_t count) {
    std::set<std::string> taken;
    text(std::string("      <") + section + ">\n");
    for (const VtkArray& one : arrays) {
      if (one.components < 1 || count_of(one.numbers) != count * static_cast<std::size_t>(one.components))
        throw std::invalid_argument("field '" + one.name + "' holds " + std::to_string(count_of(one.numbers)) +
                                    " numbers, not " + std::to_string(one.components) + " for each of " +
                                    std::to_string(count) + " entries");
      std::string name = one.name.empty() ? "field" : one.name;
      for (int i = 2; !taken.insert(name).second; ++i) name = one.name + " " + std::to_string(i);
      array(name, one.components, one.numbers);
    }
    text(std::string("      </") + section + ">\n");
  }

  void write(const std::filesystem::path& path) {
    xml_ += std::string("  </") + type_ + ">\n  <AppendedData encoding=\"raw\">\n_";
    std::string appended;
    std::vector<std::size_t> starts;
    const std::vector<std::string> blocks = encoding_.compress ? compressed_blocks() : std::vector<std::string>();
    std::size_t block = 0;
    for (const VtkNumbers* numbers : arrays_) {
      starts.push_back(appended.size());
      const std::string_view bytes = bytes_of(*numbers);
      if (encoding_.compress) {
        append_compressed(appended, bytes.size(), blocks, block);
      } else {
        append_count(appended, bytes.size());
        appended += bytes;
      }
    }
    for (std::size_t k = offsets_.size(); k-- > 0;) xml_.insert(offsets_[k], std::to_string(starts[k]));
    support::write_atomically(path, {xml_, appended, "\n  </AppendedData>\n</VTKFile>\n"},
                              support::Durability::of_program);
  }

 private:
  static std::size_t blocks_in(std::size_t bytes) { return (bytes + block_bytes - 1) / block_bytes; }

  std::vector<std::string> compressed_blocks() const {
    std::vector<std::string_view> pieces;
    for (const VtkNumbers* numbers : arrays_) {
      const std::string_view bytes = bytes_of(*numbers);
      for (std::size_t at = 0; at < bytes.size(); at += block_bytes) pieces.push_back(bytes.substr(at, block_bytes));
    }
    std::vector<std::string> blocks(pieces.size());
    support::for_each_piece(pieces.size(), encoding_.threads,
                            [&](std::size_t k) { blocks[k] = compressed(pieces[k]); });
    return blocks;
  }

  /// Appends an array's head (number of blocks, their size, that of a last one that is not whole, compressed sizes) and
  /// its blocks, the next ones of all.
  static void append_compressed(std::string& out, std::size_t bytes, const std::vector<std::string>& blocks,
                                std::size_t& next) {
    const std::size_t count = blocks_in(bytes);
    append_count(out, count);
    append_count(out, block_bytes);
    append_count(out, bytes % block_bytes);
    for (std::size_t k = 0; k < count; ++k) append_count(out, blocks[next + k].size());
    for (std::size_t k = 0; k < count; ++k) out += blocks[next + k];
    next += count;
  }

  const char* type_;
  VtkEncoding encoding_;
  std::string xml_;
  std::vector<std::size_t> offsets_;  ///< where the text of an array's offset belongs
  std::vector<const VtkNumbers*> arrays_;
};

std::size_t points_of(VtkCell cell) {
  return cell == VtkCell::vertex ? 1 : cell == VtkCell::quadrilateral ? 4 : 8;
}

std::string extent_of(const VtkImage& image) {
  std::string text;
  for (const int nodes : image.nodes) text += (text.empty() ? "0 " : " 0 ") + std::to_string(nodes - 1);
  return text;
}

}  // namespace

void write_vtu(const std::filesystem::path& path, const VtkCells& cells, const VtkEncoding& encoding) {
  const std::size_t numbers = count_of(cells.points), each = points_of(cells.cell);
  if (numbers % (3 * each) != 0)
    throw std::invalid_argument("the points of a VTK file are not " + std::to_string(each) + " for each cell");
  const std::size_t points = numbers / 3, count = points / each;
  std::vector<std::int32_t> connectivity(points), offsets(count);
  std::iota(connectivity.begin(), connectivity.end(), 0);
  for (std::size_t k = 0; k < count; ++k) offsets[k] = static_cast<std::int32_t>((k + 1) * each);
  const VtkNumbers time = std::vector<double>{cells.time}, joined = std::move(connectivity), ends = std::move(offsets),
                   types = std::vector<std::uint8_t>(count, static_cast<std::uint8_t>(cells.cell));
  VtkFile file("UnstructuredGrid", encoding);
  file.text("  <UnstructuredGrid>\n");
  file.time(time);
  file.text("    <Piece NumberOfPoints=\"" + std::to_string(points) + "\" NumberOfCells=\"" + std::to_string(count) +
            "\">\n");
  file.data(cells.cell == VtkCell::vertex ? "PointData" : "CellData", cells.of_cell, count);
  file.text("      <Points>\n");
  file.array("Points", 3, cells.points);
  file.text("      </Points>\n      <Cells>\n");
  file.array("connectivity", 1, joined);
  file.array("offsets", 1, ends);
  file.array("types", 1, types);
  file.text("      </Cells>\n    </Piece>\n");
  file.write(path);
}

void write_vti(const std::filesystem::path& path, const VtkImage& image, const VtkEncoding& encoding) {
  const VtkNumbers time = std::vector<double>{image.time};
  VtkFile file("ImageData", encoding);
  const std::string extent = extent_of(image), h = support::shortest(image.spacing);
  std::string origin;
  for (const double x : image.origin) origin += (origin.empty() ? "" : " ") + support::shortest(x);
  file.text("  <ImageData WholeExtent=\"" + extent + "\" Origin=\"" + origin + "\" Spacing=\"" + h + " " + h + " " + h +
            "\">\n");
  file.time(time);
  file.text("    <Piece Extent=\"" + extent + "\">\n");
  file.data("PointData", image.of_node,
            static_cast<std::size_t>(image.nodes[0]) * static_cast<std::size_t>(image.nodes[1]) *
                static_cast<std::size_t>(image.nodes[2]));
  file.text("    </Piece>\n");
  file.write(path);
}

VtkNumbers vtk_numbers(std::vector<double> values, bool in_double) {
  if (in_double) return values;
  return std::vector<float>(values.begin(), values.end());
}

}  // namespace mpm::output
