// Rigid bodies: reference and cpu, double and float, with and without contact between bodies, every order and filter; and
// runs that are saved and go on.

#include "parity/rigid_scenes.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

void check(const Mix& mix) {
  check_parity(mix);
  Scene reference(mix.text(), {"/backend=reference"});
  reference.run();
  for (const std::string precision : {"double", "float"}) {
    Scene cpu(mix.text(), {"/backend=cpu", set("/precision", precision)});
    cpu.run();
    INFO(mix.name() << " " << precision);
    CHECK(difference_at_rigid_bodies(reference.simulation.backend(), cpu.simulation.backend(), reference.experiment) <=
          (precision == "double" ? 1e-11 : 1e-2));
  }
}

}  // namespace

TEST_CASE("parity beside rigid bodies", "[parity]") {
  for (const int dimension : {2, 3})
    for (const std::string transfer : {"flip", "apic"})
      for (const std::string order : {"last", "first", "modified_last", "averaged"})
        for (const std::string filter :
             {"", R"({"type": "fmpm", "order": 2})", R"({"type": "fmpm", "order": 2, "constraints": "at_end"})",
              R"({"type": "xpic", "order": 2})"})
          for (const bool touch : {false, true}) {
            if (dimension == 3 && (order != "last" || !filter.empty())) continue;  // 2-D has them
            Mix mix = beside_rigid_bodies(dimension);
            mix.stress_update = order, mix.filter = filter;
            mix.transfer = "{\"type\": \"" + transfer + "\"}";
            if (touch) mix.contact = R"({"type": "coulomb", "friction": 0.2})";
            if (!is_refused(mix)) check(mix);
          }
}

TEST_CASE("parity of a weld to a rigid body, and of the shapes", "[parity]") {
  for (const std::string shape : {"bspline_quadratic", "bspline_cubic", "gimp", "cpdi"}) {
    Mix mix = beside_rigid_bodies(2);
    mix.shape = "{\"type\": \"" + shape + "\"}";
    check(mix);
    mix.overrides = {R"(/rigid_bodies/0/contact={"type": "stick"})"};
    check_parity(mix);
  }
}

TEST_CASE("a restored run beside rigid bodies goes on bit for bit", "[parity]") {
  for (const int dimension : {2, 3})
    for (const std::string precision : {"double", "float"}) {
      const std::string text = beside_rigid_bodies(dimension).text();
      const std::vector<std::string> overrides{set("/precision", precision), "/solver/end_time=0.5"};
      CpuRun whole(text, overrides, 1), part(text, overrides, 1), resumed(text, overrides, 2);
      whole.steps(14), part.steps(6);
      ArchiveWriter archive;
      part.simulation.save(archive);
      ArchiveReader reader(archive.bytes());
      resumed.simulation.restore(reader);
      CHECK(reader.at_end());
      resumed.steps(8);
      CHECK(different(all_results(whole.simulation), all_results(resumed.simulation)) == 0);
      const Backend &a = whole.simulation.backend(), &b = resumed.simulation.backend();
      CHECK(difference_at_rigid_bodies(a, b, resumed.experiment) == 0);
      CHECK(a.rigid_bodies()[1].place != a.rigid_bodies()[0].place);
    }
}
