// A saved and restored run goes on bit for bit on the cpu backend, with another number of workers too.

#include "parity/parity.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

void check_saved(const std::string& text, const std::vector<std::string>& overrides, bool fused = false) {
  if (!is_chosen_check()) return;
  INFO(text);
  CpuRun whole(text, overrides, 1), reference(text, overrides, 1);
  reference.steps(24);
  const std::vector<double> expected = all_results(reference.simulation);
  int scattered = 0;
  for (const long at : {2, 13}) {
    whole.steps(at - whole.simulation.steps());
    scattered += whole.simulation.backend().scattered();
    ArchiveWriter archive;
    whole.simulation.save(archive);
    for (const int threads : {1, 2}) {
      CpuRun resumed(text, overrides, threads);
      if (threads == 2) resumed.steps(5);  // steps to be forgotten, whatever they did
      ArchiveReader reader(archive.bytes());
      resumed.simulation.restore(reader);
      CHECK(reader.at_end());
      CHECK(resumed.simulation.steps() == at);
      CHECK(different(all_results(whole.simulation), all_results(resumed.simulation)) == 0);
      resumed.steps(24 - at);
      CHECK(different(expected, all_results(resumed.simulation)) == 0);
    }
  }
  CHECK((scattered > 0) == fused);  // the run was saved while the grid held the next step's scatter
}

}  // namespace

TEST_CASE("a restored run goes on bit for bit", "[parity]") {
  for (const std::string precision : {"double", "float"}) {
    std::vector<std::string> overrides{set("/precision", precision), "/solver/end_time=0.9"};
    for (const int dimension : {2, 3}) {
      Mix mix;
      mix.dimension = dimension;
      mix.transfer = R"({"type": "mls"})";
      check_saved(mix.text(), overrides, true);
      mix.transfer = R"({"type": "polypic", "basis": "full"})";
      check_saved(mix.text(), overrides, true);
      mix.shape = R"({"type": "gimp"})";
      mix.transfer = R"({"type": "flip"})";
      mix.more = dimension == 2 ? R"J(, "body_force": ["2*sin(3*X)+t", "x-Y*y"])J" : "";
      check_saved(mix.text(), overrides, true);
      mix.contact = R"({"type": "coulomb", "friction": 0.2})";
      mix.filter = R"({"type": "fmpm", "order": 2, "every_steps": 3})";
      check_saved(mix.text(), overrides);
      mix.transfer = R"({"type": "tpic"})", mix.shape = R"({"type": "cpdi"})";
      mix.filter = R"({"type": "xpic", "order": 2, "every_courant": 0.4})";
      for (const std::string order : {"last", "first", "modified_last", "averaged"}) {
        mix.stress_update = order;
        check_saved(mix.text(), overrides);
      }
      mix.shape = R"({"type": "cpdi2"})";
      for (const std::string order : {"last", "modified_last"}) {
        mix.stress_update = order;
        check_saved(mix.text(), overrides);
      }
      // Polynomials are saved where the scatter is a pass of its own, is done twice, and goes through a filter's loop.
      mix.shape = R"({"type": "bspline_cubic"})", mix.transfer = R"({"type": "polypic", "basis": "full"})";
      for (const std::string order : {"last", "modified_last"}) {
        mix.stress_update = order;
        check_saved(mix.text(), overrides);
      }
    }
  }
}

TEST_CASE("a restored run of stretched lists goes on bit for bit", "[parity]") {
  // The first body is as wide as at the end of tests/parity/lists.cpp when it is saved.
  const char* const text = R"J({"title": "stretch", "dimension": 2,
    "grid": {"cell_size": 0.1, "domain": [[0, 0], [2, 1]], "boundaries": {"all": "slip"}},
    "shape": {"type": "cpdi"}, "transfer": {"type": "mls"}, "contact": {"type": "coulomb", "friction": 0.2},
    "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1, "poisson_ratio": 0.3, "density": 1000}},
    "bodies": [{"name": "a", "material": "m", "jitter": 0.1, "geometry": {"type": "box", "lower": [0.9, 0.4], "upper": [1.1, 0.6]},
                "velocity": ["30*(x-1)", "2*(y-0.5)"]},
               {"name": "b", "material": "m", "geometry": {"type": "box", "lower": [1.3, 0.3], "upper": [1.5, 0.5]}}],
    "solver": {"time_step": 0.008, "end_time": 1}})J";
  for (const std::string precision : {"double", "float"}) check_saved(text, {set("/precision", precision)});
}

TEST_CASE("the state after a step that nobody looks at cannot be saved", "[parity]") {
  Mix mix;
  mix.transfer = R"({"type": "mls"})";
  CpuRun run(mix.text(), {}, 1);
  run.simulation.observe_when([](double, long step) { return step != 2; });
  run.steps(2);
  CHECK_FALSE(run.simulation.observed());
  ArchiveWriter archive;
  CHECK_THROWS_AS(run.simulation.save(archive), std::logic_error);
  run.steps(1);
  CHECK(run.simulation.observed());
  CHECK_NOTHROW(run.simulation.save(archive));
}

TEST_CASE("a state of another kind is refused", "[parity]") {
  Mix mix;
  CpuRun written(mix.text(), {set("/precision", "double")}, 1);
  ArchiveWriter archive;
  written.simulation.save(archive);
  const auto restore = [&](const std::string& text, const std::vector<std::string>& overrides, std::size_t bytes) {
    CpuRun run(text, overrides, 1);
    ArchiveReader reader(std::span<const char>(archive.bytes()).subspan(0, bytes));
    run.simulation.restore(reader);
  };
  const std::size_t all = archive.bytes().size();
  CHECK_NOTHROW(restore(mix.text(), {}, all));
  CHECK_THROWS_AS(restore(mix.text(), {set("/precision", "float")}, all), ArchiveError);
  CHECK_THROWS_AS(restore(mix.text(), {}, all - 1), ArchiveError);
  CHECK_THROWS_AS(restore(mix.text(), {}, all / 2), ArchiveError);
  Mix other = mix;
  other.transfer = R"({"type": "flip"})";
  CHECK_THROWS_AS(restore(other.text(), {}, all), ArchiveError);
}
