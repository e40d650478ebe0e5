// Labels keep out of each other's way; lines are cut and thinned without changing their look.
#include <algorithm>
#include <cmath>
#include <random>

#include "render/chart.hpp"
#include "render/colours.hpp"
#include "render/font.hpp"
#include "render/polyline.hpp"
#include "render/svg_canvas.hpp"
#include "support/catch.hpp"

using namespace mpm::render;

TEST_CASE("spread leaves labels that are apart where they are", "[figures]") {
  const std::vector<double> centres{10, 50, 90}, sizes{20, 20, 20};
  const auto placed = spread(centres, sizes, 0, 100);
  REQUIRE(placed);
  CHECK(*placed == centres);
}

TEST_CASE("spread separates coinciding labels about their common place", "[figures]") {
  const auto placed = spread(std::vector<double>{50, 50}, std::vector<double>{20, 20}, 0, 100);
  REQUIRE(placed);
  CHECK((*placed)[0] == Approx(40));
  CHECK((*placed)[1] == Approx(60));
}

TEST_CASE("spread never overlaps, never leaves the range, keeps the order", "[figures]") {
  std::mt19937 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t n = 1 + random() % 12;
    std::vector<double> centres, sizes(n, 8);
    for (std::size_t i = 0; i < n; ++i) centres.push_back(std::uniform_real_distribution<>(-20, 130)(random));
    const auto placed = spread(centres, sizes, 0, 100);
    REQUIRE(placed);
    for (std::size_t i = 0; i < n; ++i) {
      CHECK((*placed)[i] >= 4 - 1e-9);
      CHECK((*placed)[i] <= 96 + 1e-9);
      for (std::size_t j = 0; j < n; ++j) {
        if (i == j) continue;
        CHECK(std::fabs((*placed)[i] - (*placed)[j]) >= 8 - 1e-9);
        if (centres[i] < centres[j]) CHECK((*placed)[i] < (*placed)[j]);
      }
    }
  }
  CHECK_FALSE(spread(std::vector<double>(11, 50.0), std::vector<double>(11, 10.0), 0, 100));
}

TEST_CASE("end labels of nearly coinciding lines do not overlap", "[figures]") {
  const SvgCanvas canvas(1600, 1000, "");
  const Theme theme = theme_for(1600, 1000);
  const Box plot{100, 100, 1300, 880};
  std::vector<EndLabel> labels;
  for (int k = 0; k < 6; ++k) labels.push_back({"series " + std::to_string(k), kInk, {1300, 300.0 + k}});
  const auto boxes = end_label_boxes(canvas, theme, labels, plot);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    CHECK(boxes[i].x0 > plot.x1);
    for (std::size_t j = 0; j < i; ++j) CHECK_FALSE(boxes[i].overlaps(boxes[j]));
  }
}

TEST_CASE("end labels give way to a legend when they cannot fit", "[figures]") {
  const SvgCanvas canvas(1600, 1000, "");
  const Theme theme = theme_for(1600, 1000);
  CHECK(end_label_room(canvas, theme, std::vector<std::string>{"APIC", "FLIP"}, 700));
  CHECK_FALSE(end_label_room(canvas, theme, std::vector<std::string>(40, "APIC"), 700));
  CHECK_FALSE(end_label_room(canvas, theme, std::vector<std::string>{std::string(120, 'm')}, 700));
}

TEST_CASE("text is never smaller than 1/45 of the height", "[figures]") {
  for (const int height : {400, 1000, 4000}) CHECK(theme_for(1600, height).text >= height / 45.0);
}

TEST_CASE("wrapped text fits its width and loses no word", "[figures]") {
  const SvgCanvas canvas(1600, 1000, "");
  const auto lines = wrapped(canvas, "one two three four five six seven", 20, 150);
  std::string all;
  for (const auto& line : lines) {
    CHECK(canvas.measure_text(line, 20) <= 150);
    all += (all.empty() ? "" : " ") + line;
  }
  CHECK(lines.size() > 1);
  CHECK(all == "one two three four five six seven");
  CHECK(wrapped(canvas, "displacement (10⁻³ m)", 20, 150) == std::vector<std::string>{"displacement", "(10⁻³ m)"});
}

TEST_CASE("shortened text fits, and is cut between letters", "[figures]") {
  const SvgCanvas canvas(1600, 1000, "");
  CHECK(shortened(canvas, "short", 20, 400) == "short");
  for (double width = 30; width < 200; width += 7) {
    const std::string text = shortened(canvas, "αβγ δεζ ηθι αβγ δεζ", 20, width);
    CHECK(canvas.measure_text(text, 20) <= width);
    for (const char32_t c : decode_utf8(text)) CHECK(c != U'\uFFFD');
    CHECK(text.find(" …") == std::string::npos);
  }
}

TEST_CASE("text upon a colour keeps its contrast", "[figures]") {
  CHECK(text_upon(kWhite) == kBlack);
  CHECK(text_upon(kBlack) == kWhite);
  CHECK(text_upon(viridis(0)) == kWhite);
  CHECK(text_upon(viridis(1)) == kBlack);
}

TEST_CASE("axes: zero is kept when near, a constant gets a span, log positions are even", "[figures]") {
  CHECK(make_axis({0.5, 2.5}, false, 0.05, true, 6).lo == 0);
  CHECK(make_axis({2.4, 2.5}, false, 0.05, true, 6).lo > 2);
  const Axis constant = make_axis({3.0, 3.0}, false, 0.05, true, 6);
  CHECK(constant.lo < 3);
  CHECK(constant.hi > 3);
  CHECK(constant.ticks.major.size() >= 2);
  const Axis log = make_axis({1e-4, 1.0}, true, 0, false, 6);
  CHECK(log.fraction(1e-2) == Approx(0.5));
  const Axis empty = make_axis({}, false, 0.05, true, 6);
  CHECK(empty.lo < empty.hi);
}

TEST_CASE("dashes cover the wanted share of a line, corners included", "[figures]") {
  const std::vector<Point> line{{0, 0}, {30, 0}, {30, 70}};
  double drawn = 0;
  for (const auto& piece : dashes(line, std::vector<double>{6, 4})) {
    for (std::size_t i = 0; i + 1 < piece.size(); ++i) {
      drawn += std::hypot(piece[i + 1].x - piece[i].x, piece[i + 1].y - piece[i].y);
    }
  }
  CHECK(drawn == Approx(60));
}

TEST_CASE("thinning keeps the extremes of every column and the ends", "[figures]") {
  std::vector<Point> line;
  for (int i = 0; i < 100000; ++i) line.push_back({i * 0.01, i == 54321 ? -500.0 : std::sin(i * 0.3)});
  const auto few = thinned(line);
  CHECK(few.size() < 10000);
  CHECK(few.front().x == line.front().x);
  CHECK(few.back().x == line.back().x);
  CHECK(std::any_of(few.begin(), few.end(), [](const Point& p) { return p.y == -500; }));
}

TEST_CASE("a segment crosses a box or it does not", "[figures]") {
  const Box box{0, 0, 10, 10};
  CHECK(crosses({-5, 5}, {15, 5}, box));
  CHECK(crosses({5, 5}, {6, 6}, box));
  CHECK_FALSE(crosses({-5, 12}, {15, 12}, box));
  CHECK_FALSE(crosses({-5, 0}, {0, -5.1}, box));
}

TEST_CASE("the diverging map is white at zero and mirrored in weight", "[figures]") {
  CHECK(diverging(0) == kWhite);
  CHECK(diverging(-1).b > diverging(-1).r);
  CHECK(diverging(1).r > diverging(1).b);
  CHECK(diverging(7) == diverging(1));
}

TEST_CASE("viridis grows lighter all the way", "[figures]") {
  const auto lightness = [](const Colour& c) { return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b; };
  for (int i = 0; i < 100; ++i) CHECK(lightness(viridis(i / 100.0)) < lightness(viridis((i + 1) / 100.0)));
}

TEST_CASE("label colours keep their contrast on white", "[figures]") {
  for (std::size_t k = 0; k < 7; ++k) {
    const Colour c = readable_text(palette(k));
    CHECK(0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b < 0.6);
  }
  CHECK(hex(palette(0)) == "#0072b2");
}

TEST_CASE("UTF-8 is read, broken bytes do not end the text", "[figures]") {
  CHECK(decode_utf8("σ·10⁻³ °−") == std::vector<char32_t>{U'σ', U'·', U'1', U'0', U'⁻', U'³', U' ', U'°', U'−'});
  CHECK(decode_utf8("a\xC3").size() == 2);
  CHECK(decode_utf8("\xFF"
                    "b")
            .back() == U'b');
  for (const auto& place : FontSet::of_this_thread().place("αβγσμρΔ∇∂·°−×⁰¹²³⁴⁵⁶⁷⁸⁹⁻ⁿ₀₉‖√≤", false))
    CHECK(place.glyph != 0);
}
