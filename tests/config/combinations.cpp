// What runs together: few refusals, each with its reason, and the page in the docs that says so.

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "plan/compatibility.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;

namespace {

const char* const filtered_flip = R"J({ "dimension": 2,
  "grid": {"cell_size": 0.1, "domain": [[0, 0], [1, 1]]},
  "shape": {"type": "linear"}, "transfer": {"type": "flip"},
  "filter": {"type": "fmpm", "order": 4},
  "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1000, "poisson_ratio": 0.3, "density": 1000}},
  "bodies": [{"name": "b", "material": "m", "geometry": {"type": "box", "lower": [0.2, 0.2], "upper": [0.4, 0.4]}}],
  "solver": {"end_time": 1}})J";

}  // namespace

TEST_CASE("few mixes are refused, and for stated reasons", "[combinations]") {
  const std::vector<Mix> mixes = all_mixes(test::plugins());
  std::set<std::string> reasons;
  std::set<std::pair<std::string, std::string>> pairs, expected;
  std::size_t refused = 0, without_effect = 0;
  // Transfers of the FLIP family refuse a filter at every step: nothing of them would be left.
  for (const char* transfer : {"flip", "aflip", "asflip"})
    for (const char* filter : {"fmpm", "xpic"}) expected.insert({transfer, filter});
  for (const Mix& mix : mixes)
    without_effect += mix.filter && mix.filtered_every_step &&
                      expected.count({std::string(mix.transfer->id()), std::string(mix.filter->id())}) > 0;
  // Polynomials need axes, and those above the multilinear ones weights that do not vanish within the stencil.
  std::size_t without_basis = 0;
  std::set<std::string> shapes_without_basis;
  for (const Mix& mix : mixes) {
    const std::string shape(mix.shape->id()), transfer(mix.transfer->id());
    const bool list = shape == "cpdi" || shape == "cpdi2";
    const bool sized = shape == "gimp" || shape == "gimp_contiguous" || shape == "b2gimp";
    if (transfer != "polypic" || !(list || (sized && mix.basis_order > 1))) continue;
    ++without_basis;
    shapes_without_basis.insert(shape);
    const auto refusal = refusal_of(mix);
    REQUIRE(refusal.has_value());
    CHECK(refusal->at == MPM_TRANSFER);
    CHECK(refusal->reason.find("shape \"" + shape + "\"") != std::string::npos);
  }
  CHECK(shapes_without_basis.size() >= 4);
  for (const Mix& mix : mixes)
    if (const auto refusal = refusal_of(mix)) {
      ++refused;
      if (mix.transfer->id() == "polypic") continue;
      reasons.insert(refusal->reason);
      pairs.insert({std::string(mix.transfer->id()), mix.filter ? std::string(mix.filter->id()) : ""});
      CHECK(refusal->reason.find(mix.transfer->id()) != std::string::npos);
    }
  CHECK(without_basis > 0);
  CHECK(pairs == expected);
  CHECK(reasons.size() == expected.size());
  CHECK(refused == without_effect + without_basis);
}

TEST_CASE("a refused mix names the place, both components and a remedy", "[combinations]") {
  try {
    make_plan(test::experiment_from(filtered_flip));
    FAIL("the mix was not refused");
  } catch (const InputError& error) {
    CHECK(
        std::string(error.what()) ==
        "test.json:4:13: /filter: filter \"fmpm\" at every step leaves nothing of transfer \"flip\", whose increments "
        "it would replace each time; filter periodically (\"every_steps\": 4) or choose transfer \"pic\"");
  }
  CHECK_NOTHROW(make_plan(test::experiment_from(filtered_flip, {"/filter/every_steps=4"})));
}

TEST_CASE("a filter and a ledger that skip the same steps are refused", "[combinations]") {
  const auto message = [](int every_steps, int ledger_every) -> std::string {
    const std::string filter = R"(/filter={"type": "fmpm", "order": 4, "every_steps": )" + std::to_string(every_steps);
    const std::string output = R"(/output={"ledger_every": )" + std::to_string(ledger_every) + "}";
    try {
      make_plan(test::experiment_from(filtered_flip, {filter + "}", output, R"(/transfer/type="apic")"}));
      return "accepted";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  CHECK(message(10, 1) == "accepted");
  CHECK(message(1, 10) == "accepted");
  CHECK(message(10, 7) == "accepted");
  const std::string refused = message(10, 8);
  CHECK(refused.find("/output/ledger_every: 8 and /filter/every_steps 10 have the divisor 2 in common") !=
        refused.npos);
}

TEST_CASE("the page of combinations is that of the program", "[combinations]") {
  const std::filesystem::path folder(MPM_BUILD_DIR), printed = folder / "combinations.txt";
  const std::string command =
      "'" + (folder / "bin" / "mpm").string() + "' list --combinations > '" + printed.string() + "'";
  REQUIRE(std::system(command.c_str()) == 0);
  const auto read = [](const std::filesystem::path& file) {
    std::stringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  };
  const std::string page = read(std::filesystem::path(MPM_SOURCE_DIR) / "docs" / "combinations.md");
  INFO("docs/generate_combinations.sh writes the page anew");
  CHECK(page.find(read(printed)) != std::string::npos);
  CHECK(page.size() > 200);
}
