// The section that says how a device works.

#include "experiment/device_settings.hpp"

#include "config/config_support.hpp"
#include "support/catch.hpp"

using namespace mpm;
using namespace mpm::test;

TEST_CASE("a device sums fast unless the experiment asks for the same bits in every run", "[config]") {
  CHECK_FALSE(sums_deterministically(read_text(two_discs)));
  CHECK_FALSE(read_text(two_discs).resolved.contains("device"));
  CHECK_FALSE(sums_deterministically(read_text(two_discs, {"/backend=cuda", "/device={}"})));
  CHECK_FALSE(sums_deterministically(read_text(two_discs, {"/backend=cuda", R"(/device={"sums": "fast"})"})));
  const Experiment asked = read_text(two_discs, {"/backend=cuda", R"(/device={"sums": "deterministic"})"});
  CHECK(sums_deterministically(asked));
  CHECK(asked.resolved["device"]["sums"] == "deterministic");
}

TEST_CASE("other backends than the device's refuse its section by name", "[config]") {
  for (const std::string backend : {"cpu", "reference"})
    CHECK(errors(two_discs, {"/backend=" + backend, R"(/device={"sums": "deterministic"})"})
              .find("\"device\" says how backend \"cuda\" works, and the backend is \"" + backend +
                    "\": remove it, or choose --backend cuda") != std::string::npos);
  CHECK(errors(two_discs, {"/backend=cuda", R"(/device={"sums": "quick"})"}).find("\"fast\"") != std::string::npos);
}
