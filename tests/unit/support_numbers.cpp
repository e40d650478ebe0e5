// Numbers as texts that a program reads back.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "support/catch.hpp"
#include "support/numbers.hpp"

using namespace mpm::support;

TEST_CASE("the shortest text of a double reads back as the same bits", "[support]") {
  CHECK(shortest(0.1) == "0.1");
  CHECK(shortest(0.1 + 0.2) == "0.30000000000000004");
  CHECK(shortest(-0.0) == "-0");
  CHECK(shortest(1e22) == "1e+22");
  CHECK(shortest(5e-324) == "5e-324");
  CHECK(shortest(std::numeric_limits<double>::infinity()) == "inf");
  std::string text = "x,";
  append_shortest(text, 2.5);
  CHECK(text == "x,2.5");
  append_shortest(text, 0.1f);  // not 0.10000000149011612, which is the double next to it
  CHECK(text == "x,2.50.1");
}

TEST_CASE("seventeen digits, as %.17g of C writes them", "[support]") {
  CHECK(full_precision(0.1) == "0.10000000000000001");
  CHECK(full_precision(0.1 + 0.2) == "0.30000000000000004");
  CHECK(full_precision(3.0) == "3");
  CHECK(full_precision(1e-5) == "1.0000000000000001e-05");
  for (const double value : {1.0 / 3.0, -6.02214076e23, 4.9406564584124654e-322})
    CHECK(std::strtod(full_precision(value).c_str(), nullptr) == value);
}

TEST_CASE("three significant digits, as %.3g of C writes them", "[support]") {
  for (const double value : {0.0, -1.0, 1234.0, 999.5, 0.00012345, 1e-5, 6.02214076e23, 2.0 / 3.0, 100.0, 1e300}) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    CHECK(three_digits(value) == text);
  }
}

TEST_CASE("fixed notation, and its zeros", "[support]") {
  CHECK(fixed_point(2.5, 2) == "2.50");
  CHECK(fixed_point(-0.004, 2) == "-0.00");
  CHECK(fixed_point(2.5, -1) == "2");
  CHECK(fixed_point(std::numeric_limits<double>::max(), 0).size() == 309);
  CHECK(without_trailing_zeros("2.50") == "2.5");
  CHECK(without_trailing_zeros("3.00") == "3");
  CHECK(without_trailing_zeros("300") == "300");
}

TEST_CASE("a text is a number as a whole or not at all", "[support]") {
  CHECK(number_in(" +2.5e-3\r") == 0.0025);
  CHECK(number_in("-0.1") == -0.1);
  CHECK(number_in("1e400") == std::nullopt);
  for (const char* text : {"", "  ", "2,5", "1 2", "0x10", "five", "1e"}) {
    CAPTURE(text);
    CHECK_FALSE(number_in(text));
  }
}
