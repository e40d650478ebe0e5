// Every study in experiments/studies and experiments/papers: the file is read, its first combination passes the checks of `mpm check`, and none of
// the others is refused but for what the list of combinations names.

#include <cmath>

#include "cli/program.hpp"
#include "experiment/diagnostics.hpp"
#include "mpm/cli.hpp"
#include "solvers/solver.hpp"
#include "study/study.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const fs::path root = MPM_SOURCE_DIR;

bool is_study(const fs::path& file) {
  const Json json = Json::parse(slurp(file), nullptr, false, true);
  return json.is_object() && json.contains("base") && json.contains("axes");
}

std::vector<fs::path> shipped() {
  std::vector<fs::path> studies;
  for (const char* folder : {"experiments/studies", "experiments/papers"})  // the extremes: extremes.cpp
    for (const auto& entry : fs::directory_iterator(root / folder))
      if (entry.path().extension() == ".json" && is_study(entry.path())) studies.push_back(entry.path());
  std::sort(studies.begin(), studies.end());
  return studies;
}

/// Whether a refusal is one that docs/combinations.md names, or that a study's page quotes.
bool is_known_refusal(const std::string& reason) {
  static const std::string cracks = slurp(root / "docs/studies/crack_bands.md");
  if (const char* words = "holds more elastic energy than its crack dissipates"; has(reason, words))
    return has(cracks, words);
  static const std::string page = slurp(root / "docs/combinations.md");
  for (const char* words : {"leaves nothing of transfer", "carries products of polynomials along the axes",
                            "takes them from all nodes of a stencil"})
    if (has(reason, words)) return has(page, words);
  return false;
}

/// Why a combination cannot be run; empty when it can.
std::string refusal(const study::Study& study, const study::Combination& combination) {
  ReadOptions options = app::read_options(plugins(), {});
  options.overrides = combination.overrides;
  if (const auto& b = study.bisection) options.overrides.push_back(b->pointer + "=" + Json(b->from * b->scale).dump());
  try {
    const Experiment experiment = read_experiment(study.base, plugins(), options);
    make_plan(experiment);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace

TEST_CASE("shipped studies are read, and what they combine runs together") {
  const auto studies = shipped();
  REQUIRE(studies.size() >= 9);
  for (const fs::path& file : studies) {
    INFO(file.string());
    const study::Study study = study::read_study(file);
    CHECK(!study.figures.empty());
    const auto combinations = study::expand(study);
    REQUIRE(!combinations.empty());
    CHECK(refusal(study, combinations.front()) == "");
    for (const study::Combination& combination : combinations) {
      const std::string reason = refusal(study, combination);
      INFO(combination.name << ": " << reason);
      CHECK((reason.empty() || is_known_refusal(reason)));
    }
  }
}

TEST_CASE("shipped studies are in the table of docs/studies.md") {
  const std::string page = slurp(root / "docs/studies.md");
  for (const fs::path& file : shipped()) {
    INFO(file.string());
    CHECK(has(page, "| `" + fs::relative(file, root).string() + "` |"));
  }
}

TEST_CASE("the bar of the studies of cracks dissipates what its law of softening says, and its band is one cell") {
  // Of an exponential law what is left at the strain kappa is sigma (eps_s + kappa / 2) a unit of volume, here 2e-3 of all. Waves
  // in what is left of the bar change the opening by 1e-3 at most, and with it what is left by 1e-2 of itself.
  constexpr double opening = 9.6e-3, area = 0.2, energy = 1e-3, strength = 0.8, young = 1000, band = 0.1;
  constexpr double kappa = opening / band, slope = energy / (band * strength) - strength / young / 2;
  const double stress = strength * std::exp(-(kappa - strength / young) / slope);
  const double left = stress * (slope + kappa / 2) * band;
  for (const auto& [law, dissipated] :
       {std::pair{"linear", energy}, std::pair{"exponential", energy - left}, std::pair{"bilinear", energy}}) {
    INFO(law);
    const Folder folder;
    const Result run =
        call(folder, {"run", (root / "experiments/studies/cracking_bar.json").string(), "--out", "out", "--threads",
                      "1", "--set", "/compare/expect=[]", "--set", std::string("/materials/weak/softening=") + law,
                      "--set", std::string("/materials/whole/softening=") + law});
    INFO(run.err);
    REQUIRE(run.code == 0);
    const Json summary = json_in(folder / "out/summary.json");
    CHECK(summary["energy"]["ledger"]["damage"].get<double>() == Approx(dissipated * area).epsilon(2e-5));
    const double width = opening / std::log(summary["stability"]["largest_volume_ratio"].get<double>());
    CHECK(width == Approx(band).epsilon(0.001));
  }
}
