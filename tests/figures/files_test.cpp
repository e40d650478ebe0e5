// The files a figure leaves behind: picture, vector twin and table; and what happens when they cannot be written.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "render/colours.hpp"
#include "render/frame.hpp"
#include "render/image.hpp"
#include "render/plot.hpp"
#include "support/catch.hpp"
#include "support/files.hpp"
#include "support/temporary_folder.hpp"

using namespace mpm::render;
using mpm::test::TemporaryFolder;
namespace fs = std::filesystem;

namespace {

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  REQUIRE(file);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<std::string> lines_of(const fs::path& path) {
  std::istringstream text(text_of(path));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

std::size_t count_pixels(const Image& image, int r, int g, int b, int tolerance = 3) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
    count += std::abs(image.rgb[i] - r) <= tolerance && std::abs(image.rgb[i + 1] - g) <= tolerance &&
             std::abs(image.rgb[i + 2] - b) <= tolerance;
  }
  return count;
}

bool is_white(const Image& image, int x, int y) {
  const auto* p = image.at(x, y);
  return p[0] == 255 && p[1] == 255 && p[2] == 255;
}

/// Whether every element that is opened is closed, in order; attributes and entities are not looked into.
bool is_balanced_xml(const std::string& text) {
  std::vector<std::string> open;
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1)) {
    const std::size_t end = text.find('>', at);
    if (end == std::string::npos) return false;
    if (text[at + 1] == '?' || text[end - 1] == '/') continue;
    const bool closes = text[at + 1] == '/';
    const std::size_t begin = at + (closes ? 2 : 1);
    const std::string name = text.substr(begin, text.find_first_of(" >", begin) - begin);
    if (!closes) {
      open.push_back(name);
    } else if (open.empty() || open.back() != name) {
      return false;
    } else {
      open.pop_back();
    }
  }
  return open.empty();
}

Plot two_lines() {
  Plot plot;
  plot.title = "Which keeps <more> energy & why?";
  plot.x_label = "time t (s)";
  plot.y_label = "kinetic energy T (J)";
  plot.footnote = "experiment two_discs.json";
  plot.width = 800;
  plot.height = 500;
  Series a{"APIC", {}, {}}, b{"FLIP", {}, {}};
  for (int i = 0; i <= 100; ++i) {
    a.x.push_back(i * 0.1 / 3);
    a.y.push_back(2.5 * std::exp(-i * 0.01));
    b.x.push_back(i * 0.1 / 3);
    b.y.push_back(2.5 * std::exp(-i * 0.02));
  }
  plot.series = {a, b};
  return plot;
}

ParticleFrame one_particle(int dimension) {
  ParticleFrame frame;
  frame.dimension = dimension;
  frame.upper = {1, 1, 1};
  frame.positions.assign(static_cast<std::size_t>(dimension), 0.5);
  frame.half_size = {0.25};
  frame.values = {1};
  frame.quantity = "body";
  frame.map = ColourMap::categorical;
  frame.categories = {"left", "right"};
  frame.width = 640;
  frame.height = 400;
  return frame;
}

}  // namespace

TEST_CASE("a figure has the size asked for, a white ground and its series' colours", "[figures]") {
  const TemporaryFolder folder;
  write_figure(two_lines(), folder / "energy");
  const Image image = read_png(folder / "energy.png");
  CHECK(image.width == 800);
  CHECK(image.height == 500);
  for (const int x : {0, 799}) {
    for (const int y : {0, 499}) CHECK(is_white(image, x, y));
  }
  CHECK(count_pixels(image, 0x00, 0x72, 0xB2) > 300);
  CHECK(count_pixels(image, 0xD5, 0x5E, 0x00) > 300);
}

TEST_CASE("a picture larger than one tile has no seam", "[figures]") {
  const TemporaryFolder folder;
  Plot plot = two_lines();
  plot.width = 2600;
  plot.height = 1000;
  write_figure(plot, folder / "wide");
  const Image image = read_png(folder / "wide.png");
  REQUIRE(image.width == 2600);
  // The axis runs through the seam at 2048 with one colour.
  int row = -1;
  for (int y = 500; y < 1000 && row < 0; ++y) {
    if (image.at(1000, y)[0] < 140 && image.at(1010, y)[0] < 140 && image.at(1005, y)[0] < 140) row = y;
  }
  REQUIRE(row > 0);
  for (int x = 2030; x < 2066; ++x) CHECK(image.at(x, row)[0] < 140);
}

TEST_CASE("the table holds exactly what is shown", "[figures]") {
  const TemporaryFolder folder;
  const Plot plot = two_lines();
  write_figure(plot, folder / "energy");
  const auto lines = lines_of(folder / "energy.csv");
  REQUIRE(lines.size() == 1 + 2 * 101);
  CHECK(lines[0] == "series,kind,time t (s),kinetic energy T (J),error,point");
  for (std::size_t i = 0; i < 101; ++i) {
    std::istringstream row(lines[1 + i]);
    std::string label, kind, x, y;
    std::getline(row, label, ',');
    std::getline(row, kind, ',');
    std::getline(row, x, ',');
    std::getline(row, y, ',');
    CHECK(label == "APIC");
    CHECK(kind == "computed");
    CHECK(std::strtod(x.c_str(), nullptr) == plot.series[0].x[i]);
    CHECK(std::strtod(y.c_str(), nullptr) == plot.series[0].y[i]);
  }
}

TEST_CASE("the vector twin is well formed and holds its words as text", "[figures]") {
  const TemporaryFolder folder;
  write_figure(two_lines(), folder / "energy");
  const std::string svg = text_of(folder / "energy.svg");
  CHECK(is_balanced_xml(svg));
  for (const char* words : {">Which keeps &lt;more&gt; energy &amp; why?<", ">time t (s)<", ">kinetic energy T (J)<",
                            ">APIC<", ">FLIP<", ">experiment two_discs.json<"}) {
    CHECK(svg.find(words) != std::string::npos);
  }
}

TEST_CASE("points that cannot be shown are left out, and the footnote says so", "[figures]") {
  const TemporaryFolder folder;
  Plot plot = two_lines();
  plot.log_y = true;
  plot.series[0].y[3] = std::numeric_limits<double>::quiet_NaN();
  plot.series[0].y[4] = std::numeric_limits<double>::infinity();
  plot.series[1].y[5] = -1;
  write_figure(plot, folder / "log");
  CHECK(lines_of(folder / "log.csv").size() == 1 + 2 * 101 - 3);
  const std::string svg = text_of(folder / "log.svg");
  CHECK(svg.find("2 points not finite, left out") != std::string::npos);
  CHECK(svg.find("1 point not above zero, left out") != std::string::npos);
  CHECK(svg.find("nan") == std::string::npos);
  CHECK(svg.find("inf\"") == std::string::npos);
}

TEST_CASE("empty, single and constant data still make a figure", "[figures]") {
  const TemporaryFolder folder;
  const int kind = GENERATE(0, 1, 2, 3);
  Plot plot = two_lines();
  if (kind == 0) plot.series.clear();
  if (kind == 1) plot.series = {{"nothing", {}, {}}};
  if (kind == 2) plot.series = {{"one point", {1}, {2}}};
  if (kind == 3) plot.series = {{"constant", {0, 1}, {0, 0}}};
  plot.log_x = plot.slope_triangles = false;
  REQUIRE_NOTHROW(write_figure(plot, folder / "bare"));
  const std::string svg = text_of(folder / "bare.svg");
  if (kind < 2) CHECK(svg.find("no data to show") != std::string::npos);
  CHECK(svg.find("nan") == std::string::npos);
}

TEST_CASE("convergence: the fitted order stands on the triangle", "[figures]") {
  const TemporaryFolder folder;
  Plot plot = two_lines();
  Series s{"second order", {}, {}};
  for (int i = 0; i < 5; ++i) {
    s.x.push_back(0.1 / (1 << i));
    s.y.push_back(3 * s.x.back() * s.x.back());
  }
  plot.series = {s};
  plot.log_x = plot.log_y = plot.slope_triangles = true;
  write_figure(plot, folder / "order");
  CHECK(text_of(folder / "order.svg").find(">2.00<") != std::string::npos);
}

TEST_CASE("a ledger stacks its causes and draws the residual apart", "[figures]") {
  const TemporaryFolder folder;
  StackedPlot plot;
  plot.title = "Where does the energy go?";
  plot.x_label = "time t (s)";
  plot.y_label = "energy E (J)";
  plot.x = {0, 1, 2};
  plot.areas = {{"kinetic", {}, {3, 2, 1}}, {"lost", {}, {0, -1, -2}}};
  plot.lines = {{"residual", {}, {0, 1e-13, -2e-13}}};
  plot.width = 800;
  plot.height = 500;
  write_figure(plot, folder / "ledger");
  const auto lines = lines_of(folder / "ledger.csv");
  REQUIRE(lines.size() == 4);
  CHECK(lines[0] == "time t (s),kinetic (J),lost (J),residual (J)");
  CHECK(lines[3] == "2,1,-2,-2.0000000000000001e-13");
  CHECK(text_of(folder / "ledger.svg").find("residual, drawn apart (10⁻¹⁵ J)") != std::string::npos);
  const Image image = read_png(folder / "ledger.png");
  CHECK(count_pixels(image, 0x00, 0x72, 0xB2) > 10000);
  plot.areas[0].y.pop_back();
  CHECK_THROWS_AS(write_figure(plot, folder / "ledger"), std::invalid_argument);
}

TEST_CASE("a map of stability colours its cells and refuses outcomes without a name", "[figures]") {
  const TemporaryFolder folder;
  OutcomeMap map;
  map.title = "Which time step is stable?";
  map.x_label = "cell size h (m)";
  map.y_label = "Courant number C (–)";
  map.x = {0.1, 0.2};
  map.y = {0.5, 1.0, 1.5};
  map.outcome = {0, 0, 0, 1, 1, -1};
  map.outcomes = {"bounded", "gained energy"};
  map.limits = {{"C = 1", {0, 1}, {1, 1}}};
  map.width = 800;
  map.height = 500;
  write_figure(map, folder / "map");
  CHECK(lines_of(folder / "map.csv").size() == 1 + 6 + 2);
  const std::string svg = text_of(folder / "map.svg");
  CHECK(is_balanced_xml(svg));
  for (const char* words : {">bounded<", ">gained energy<", ">not run<", ">C = 1<"})
    CHECK(svg.find(words) != std::string::npos);
  const Image image = read_png(folder / "map.png");
  const std::size_t bounded = count_pixels(image, 64, 149, 197), gained = count_pixels(image, 223, 134, 64);
  CHECK(static_cast<double>(bounded) / static_cast<double>(gained) == Approx(1.5).epsilon(0.1));
  map.outcome[0] = 2;
  CHECK_THROWS_WITH(write_figure(map, folder / "map"), "the map has an outcome 2 without a name");
}

TEST_CASE("a heat map writes each number in its cell and says what it does not show", "[figures]") {
  const TemporaryFolder folder;
  HeatMap map;
  map.title = "Which pair is the most exact?";
  map.x_label = "transfer";
  map.y_label = "shape";
  map.value_label = "error e (m)";
  map.x_names = {"pic", "flip", "apic"};
  map.y_names = {"linear", "gimp"};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  map.values = {0.25, 2.5, nan, nan, -1, 25};
  map.notes = {"", "gained energy", "refused", "", "", ""};
  map.log_scale = true;
  map.width = 800;
  map.height = 500;
  write_figure(map, folder / "heat");
  const auto lines = lines_of(folder / "heat.csv");
  CHECK(lines == std::vector<std::string>{"shape,transfer,error e (m),note", "linear,pic,0.25,",
                                          "linear,flip,2.5,gained energy", "linear,apic,,refused", "gimp,pic,,not run",
                                          "gimp,flip,-1,", "gimp,apic,25,"});
  const std::string svg = text_of(folder / "heat.svg");
  CHECK(is_balanced_xml(svg));
  for (const char* words : {">0.25<", ">2.5<", ">gained energy<", ">refused<", ">not run<", ">−1<", ">25<",
                            ">error e (m)<", ">1 cell not above zero or not finite, without colour<"})
    CHECK(svg.find(words) != std::string::npos);
  CHECK(svg.find("nan") == std::string::npos);
  // Least and greatest have the ends of the colours, the geometric mean the middle.
  const Image image = read_png(folder / "heat.png");
  for (const double t : {0.0, 0.5, 1.0}) {
    const Colour c = viridis(t);
    CHECK(count_pixels(image, int(255 * c.r), int(255 * c.g), int(255 * c.b)) > 10000);
  }
  map.values.pop_back();
  CHECK_THROWS_WITH(write_figure(map, folder / "heat"), "a heat map of 3 x 2 cells has 5 values");
}

TEST_CASE("a heat map takes out a power of ten, and never shows a part of a number", "[figures]") {
  const TemporaryFolder folder;
  HeatMap map;
  map.value_label = "error e (m)";
  map.width = 800;
  map.height = 500;
  map.x_names = {"a", "b"};
  map.y_names = {"c"};
  map.values = {2e-5, 4.56789e-6};
  write_figure(map, folder / "small");
  const std::string svg = text_of(folder / "small.svg");
  for (const char* words : {">20<", ">4.57<", ">error e (10⁻⁶ m)<"}) CHECK(svg.find(words) != std::string::npos);
  // The map has far more cells than text fits.
  map.x_names.assign(60, "a long name of a column");
  map.y_names.assign(60, "a long name of a row");
  map.values.assign(3600, 0.125);
  map.values[0] = 1;
  write_figure(map, folder / "many");
  const std::string many = text_of(folder / "many.svg");
  CHECK(many.find("3600 cells without room for the whole text") != std::string::npos);
  CHECK(many.find(">0.1<") == std::string::npos);
  // Rows of one line of text have room for it, and nothing says that they had none.
  HeatMap rows;
  rows.title = "A title", rows.footnote = "a footnote";
  rows.x_label = "strain", rows.y_label = "material", rows.value_label = "largest stable step over h/c at rest";
  rows.x_names.assign(8, "a strain of two lines");
  rows.y_names.assign(25, "a material");
  rows.values.assign(200, 0.847);
  write_figure(rows, folder / "rows");
  const std::string whole = text_of(folder / "rows.svg");
  CHECK(whole.find(">0.847<") != std::string::npos);
  CHECK(whole.find("without room") == std::string::npos);
  map.x_names.clear();
  map.values.clear();
  write_figure(map, folder / "none");
  CHECK(text_of(folder / "none.svg").find("no data to show") != std::string::npos);
}

TEST_CASE("small multiples share axes, looks and one legend", "[figures]") {
  const TemporaryFolder folder;
  Multiples m;
  m.title = "How fast?";
  m.x_label = "cell size h (m)";
  m.y_label = "error e (m)";
  m.log_x = m.log_y = m.slope_triangles = true;
  m.width = 1200;
  m.height = 800;
  const auto line = [](const char* label, double order) {
    Series s{label, {}, {}};
    for (const double x : {0.1, 0.05, 0.025}) s.x.push_back(x), s.y.push_back(std::pow(x, order));
    return s;
  };
  m.panels = {{"linear", {line("PIC", 1), line("FLIP", 2)}}, {"cubic", {line("FLIP", 3)}}, {"none", {}}};
  m.panels[0].series[0].y[1] = -1;
  write_figure(m, folder / "multiples");
  const auto rows = lines_of(folder / "multiples.csv");
  REQUIRE(rows.size() == 1 + 2 + 3 + 3);
  CHECK(rows[0] == "panel,series,kind,cell size h (m),error e (m),error,point");
  CHECK(rows[6].substr(0, 20) == "cubic,FLIP,computed,");
  const std::string svg = text_of(folder / "multiples.svg");
  CHECK(is_balanced_xml(svg));
  for (const char* words : {">linear<", ">cubic<", ">none<", ">PIC<", ">FLIP<", ">cell size h (m)<", ">error e (m)<",
                            ">2.00<", ">3.00<", ">no data to show<"}) {
    const auto at = svg.find(words);
    REQUIRE(at != std::string::npos);
    CHECK(svg.find(words, at + 1) == std::string::npos);  // the words stand there once
  }
  CHECK(svg.find("1 point not above zero, left out") != std::string::npos);
  m.panels[1].series[0].y.pop_back();
  CHECK_THROWS_WITH(write_figure(m, folder / "multiples"), "panel 'cubic', series 'FLIP': 3 values of x, but 2 of y");
  // Orders stand above small panels, with one digit where two have no room; none is left out for want of the second.
  const std::vector<Series> four{line("PIC", 1), line("FLIP", 2), line("APIC", 1.5), line("MLS", 0.5)};
  m.panels.assign(8, {"shape", {four[0], four[1]}});
  write_figure(m, folder / "small");
  CHECK(text_of(folder / "small.svg").find(">2.00<") != std::string::npos);
  m.panels.assign(8, {"shape", four});
  write_figure(m, folder / "small");
  const std::string small = text_of(folder / "small.svg");
  for (const char* words : {">1.0<", ">2.0<", ">1.5<", ">0.5<"}) CHECK(small.find(words) != std::string::npos);
  CHECK(small.find("…") == std::string::npos);
  CHECK(small.find(">2.00<") == std::string::npos);
  m.panels.assign(500, {"one", {line("FLIP", 2)}});
  CHECK_THROWS_AS(write_figure(m, folder / "multiples"), std::invalid_argument);
  m.panels.clear();
  write_figure(m, folder / "multiples");
  CHECK(text_of(folder / "multiples.svg").find("no data to show") != std::string::npos);
}

TEST_CASE("a particle is drawn at its true size and place", "[figures]") {
  const TemporaryFolder folder;
  ParticleFrame frame = one_particle(2);
  frame.width = 1600;
  frame.height = 1000;
  frame.values = {1};
  write_frame(frame, folder / "frame");
  const Image image = read_png(folder / "frame.png");
  int left = image.width, right = 0;
  std::size_t count = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const auto* p = image.at(x, y);
      // Only the particle is orange and far from the key at the right.
      if (p[0] != 0xD5 || p[1] != 0x5E || p[2] != 0x00 || x > image.width * 6 / 10) continue;
      left = mpm::test::smaller(left, x);
      right = mpm::test::larger(right, x);
      ++count;
    }
  }
  REQUIRE(count > 0);
  const double side = right - left + 1;
  CHECK(static_cast<double>(count) == Approx(side * side).epsilon(0.05));  // the particle is a square
  // The square is half of the domain, whose edge is the longest dark row of the picture.
  int longest = 0;
  for (int y = 0; y < image.height; ++y) {
    int run = 0;
    for (int x = 0; x < image.width; ++x) {
      run = image.at(x, y)[0] < 160 && image.at(x, y)[2] < 160 && image.at(x, y)[1] < 90 ? run + 1 : 0;
      longest = mpm::test::larger(longest, run);
    }
  }
  CHECK(side / longest == Approx(0.5).margin(0.03));
}

TEST_CASE("frames in two and three dimensions leave their files", "[figures]") {
  const TemporaryFolder folder;
  const int dimension = GENERATE(2, 3);
  ParticleFrame frame = one_particle(dimension);
  frame.half_size = {0.1f};
  write_frame(frame, folder / "frame");
  CHECK(fs::exists(folder / "frame.svg") == (dimension == 2));
  const auto lines = lines_of(folder / "frame.csv");
  REQUIRE(lines.size() == 2);
  CHECK(lines[0] == (dimension == 2 ? "x (m),y (m),half size (m),body" : "x (m),y (m),z (m),half size (m),body"));
  CHECK(lines[1] == (dimension == 2 ? "0.5,0.5,0.1,1" : "0.5,0.5,0.5,0.1,1"));
  const Image image = read_png(folder / "frame.png");
  std::size_t orange = 0;
  for (std::size_t i = 0; i < image.rgb.size(); i += 3)
    orange += image.rgb[i] > 100 && image.rgb[i + 2] < image.rgb[i] / 3;
  CHECK(orange > 300);
  CHECK(is_white(image, 0, 0));
}

TEST_CASE("many small particles are drawn at their true place, within the outline", "[figures]") {
  const TemporaryFolder folder;
  ParticleFrame frame = one_particle(2);
  frame.positions.clear();
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j) {
      frame.positions.push_back(0.255f + 0.01f * static_cast<float>(i));  // the last quarter is outside of the domain
      frame.positions.push_back(0.255f + 0.005f * static_cast<float>(j));
    }
  frame.half_size.assign(10000, 0.005f);
  frame.values.assign(10000, 1);
  frame.width = 1600;
  frame.height = 1000;
  write_frame(frame, folder / "frame");
  const Image image = read_png(folder / "frame.png");
  int left = image.width, right = 0, top = image.height, bottom = 0;
  std::size_t count = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width * 29 / 40; ++x) {
      const auto* p = image.at(x, y);
      if (p[0] != 0xD5 || p[1] != 0x5E || p[2] != 0x00) continue;
      left = mpm::test::smaller(left, x), right = mpm::test::larger(right, x), top = mpm::test::smaller(top, y),
      bottom = mpm::test::larger(bottom, y);
      ++count;
    }
  const double width = right - left + 1, height = bottom - top + 1;
  CHECK(static_cast<double>(count) == Approx(width * height).epsilon(0.001));  // no gap in the rectangle
  CHECK(width / height == Approx(0.75 / 0.505).epsilon(0.01));
  // The outline is as wide beside the particles as elsewhere.
  const auto outline_pixels = [&](int y) {
    int dark = 0;
    for (int x = right - 4; x < right + 8; ++x) dark += image.at(x, y)[0] < 60;
    return dark;
  };
  CHECK(outline_pixels(top - 30) > 0);
  CHECK(outline_pixels((top + bottom) / 2) == outline_pixels(top - 30));
  CHECK(is_white(image, right + 5, (top + bottom) / 2));
}

TEST_CASE("a 3-D frame too small for a scene is refused", "[figures]") {
  const TemporaryFolder folder;
  ParticleFrame frame = one_particle(3);
  frame.width = 64;
  frame.height = 1000;
  CHECK_THROWS_WITH(write_frame(frame, folder / "frame"),
                    "a 3-D frame of 64 x 1000 pixels leaves no room for the scene");
}

TEST_CASE("the same frame gives the same picture", "[figures]") {
  const TemporaryFolder folder;
  const int dimension = GENERATE(2, 3);
  write_frame(one_particle(dimension), folder / "a");
  write_frame(one_particle(dimension), folder / "b");
  CHECK(text_of(folder / "a.png") == text_of(folder / "b.png"));
}

TEST_CASE("frames without a usable particle, and ranges of one value", "[figures]") {
  const TemporaryFolder folder;
  ParticleFrame frame = one_particle(2);
  frame.map = ColourMap::viridis;
  CHECK_NOTHROW(write_frame(frame, folder / "one_value"));
  frame.values[0] = std::numeric_limits<float>::quiet_NaN();
  write_frame(frame, folder / "none");
  CHECK(lines_of(folder / "none.csv").size() == 1);
  CHECK(text_of(folder / "none.svg").find("1 particle not finite, left out") != std::string::npos);
  frame.map = ColourMap::diverging;
  frame.range = {{0, 0}};
  CHECK_NOTHROW(write_frame(frame, folder / "zero_range"));
}

TEST_CASE("arrays that do not match are refused by name", "[figures]") {
  const TemporaryFolder folder;
  Plot plot = two_lines();
  plot.series[1].y.pop_back();
  CHECK_THROWS_WITH(write_figure(plot, folder / "x"), "series 'FLIP': 101 values of x, but 100 of y");
  ParticleFrame frame = one_particle(2);
  frame.positions.push_back(0);
  CHECK_THROWS_WITH(write_frame(frame, folder / "x"), "a frame of 1 values needs 2 coordinates, not 3");
  frame = one_particle(2);
  frame.upper[1] = 0;
  CHECK_THROWS_WITH(write_frame(frame, folder / "x"), "the domain of the frame is empty or not finite along y");
  plot = two_lines();
  plot.width = 5;
  CHECK_THROWS_AS(write_figure(plot, folder / "x"), std::invalid_argument);
  CHECK(fs::is_empty(folder.path()));
}

TEST_CASE("a file that cannot be written is named with the cause, and nothing is left behind", "[figures]") {
  const TemporaryFolder folder;
  const fs::path missing = folder / "no_such_folder" / "energy";
  std::string message;
  try {
    write_figure(two_lines(), missing);
  } catch (const mpm::support::MachineError& error) {
    message = error.what();
  }
  CHECK(message.starts_with("cannot write " + missing.string() + ".png: No such file or directory; "));
  fs::create_directory(folder / "taken.png");
  CHECK_THROWS_AS(write_figure(two_lines(), folder / "taken"), mpm::support::MachineError);
  CHECK(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()) == 1);
}
