#include <numbers>

#include "experiment/units.hpp"
#include "support/catch.hpp"

using namespace mpm;

namespace {
std::string error_of(const std::string& text, const std::string& unit) {
  try {
    to_si(text, unit);
  } catch (const UnitError& error) {
    return error.what();
  }
  return "accepted";
}
}  // namespace

TEST_CASE("quantities are converted to SI exactly where decimals allow", "[units]") {
  CHECK(to_si("0.5 mm", "m") == 0.0005);
  CHECK(to_si("1 GPa", "Pa") == 1e9);
  CHECK(to_si("1.5 g/cm^3", "kg/m^3") == 1500);
  CHECK(to_si("9.81 m/s^2", "m/s^2") == 9.81);
  CHECK(to_si("-9.81 N/kg", "m/s^2") == -9.81);
  CHECK(to_si("30 deg", "rad") == 30 * std::numbers::pi / 180);
  CHECK(to_si("5%", "") == 0.05);
  CHECK(to_si(" +2e-3  kPa s ", "Pa s") == 2);
  CHECK(to_si("3 kg m s^-2", "N") == 3);
  CHECK(to_si("4 J/(kg K)", "m^2/s^2/K") == 4);
  CHECK(to_si("2 kg·m²/s²", "J") == 2);
  CHECK(to_si("7 µm", "m") == 7e-6);
  CHECK(to_si("1 rad/s", "1/s") == 1);
  CHECK(to_si("12 ms", "any") == 0.012);
  CHECK(to_si("2.22 W/(m K)", "W/(m K)") == 2.22);
  CHECK(to_si("2.09 kJ/(kg K)", "J/(kg K)") == 2090);
  CHECK(to_si("334 kJ/kg", "J/kg") == 334000);
  CHECK(to_si("1.5 W/cm^2", "W/m^2") == 15000);
}

TEST_CASE("quantities of the wrong kind say what was expected", "[units]") {
  CHECK(error_of("3 mm", "Pa") == "expected a pressure (Pa), got a length (mm)");
  CHECK(error_of("3 kg/m^2/s^7", "m") == "expected a length (m), got a quantity (kg/m^2/s^7)");
  CHECK(error_of("30 deg", "") == "expected a number, got an angle (deg)");
  CHECK(error_of("soft", "Pa") == "expected a pressure (Pa), got the string \"soft\"");
  CHECK(error_of("inf m", "m") == "expected a length (m), got the string \"inf m\"");
  CHECK(error_of("5", "Pa") ==
        "expected a pressure (Pa), got the string \"5\" without a unit; drop the quotes for SI, or add one");
  CHECK(error_of("5", "") == "expected a number, got the string \"5\"; drop the quotes");
  CHECK(error_of("5 GPA", "Pa") == "unknown unit \"GPA\"; did you mean \"GPa\"?");
  CHECK(error_of("5 kg", "W/(m K)") == "expected a thermal conductivity (W/(m K)), got a mass (kg)");
  CHECK(error_of("5 kg", "J/(kg K)") == "expected a specific heat capacity (J/(kg K)), got a mass (kg)");
  CHECK(error_of("5 kg", "J/kg") == "expected an energy per mass (J/kg), got a mass (kg)");
  CHECK(error_of("5 W/(m^2 K)", "W/m^2") ==
        "expected a heat flux (W/m^2), got a heat transfer coefficient (W/(m^2 K))");
  CHECK(error_of("20 °C", "K") ==
        "degrees Celsius have another zero and are no unit here; write kelvin, which are 273.15 more");
  CHECK(error_of("5 m^x", "m") == "the unit \"m^x\" is not understood: expected a whole power such as ^2 or ^-1");
  CHECK(error_of("5 kg/(m s", "Pa s") == "the unit \"kg/(m s\" is not understood: a ')' is missing");
  CHECK(error_of("5 m/", "m") == "the unit \"m/\" is not understood: a unit is missing at the end");
  CHECK(error_of("5 ((m^9)^9)^9", "m") == "the unit \"((m^9)^9)^9\" is not understood: a power beyond 99");
  CHECK(error_of("1e300 km^9", "any") == "\"1e300 km^9\" is too large for double precision");
}

TEST_CASE("a quantity is told from an expression", "[units]") {
  CHECK(looks_like_quantity("2 mm"));
  CHECK(looks_like_quantity("-2.5kPa"));
  CHECK_FALSE(looks_like_quantity("2"));
  CHECK_FALSE(looks_like_quantity("2*x"));
  CHECK_FALSE(looks_like_quantity("x"));
  CHECK_FALSE(looks_like_quantity("2e-3*t"));
}
