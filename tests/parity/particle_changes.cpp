// Emitters, sinks and changes of material: cpu beside the reference, and a run that was saved between two of them.

#include "simulation/particle_changes.hpp"
#include "parity/heat_scenes.hpp"
#include "parity/particle_change_scenes.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Whether every kind of change has come about, so that a comparison is one of them.
void check_that_all_changed(const Mix& mix) {
  Scene scene(mix.text(), on_reference(mix));
  const std::size_t first = scene.simulation.particle_count();
  scene.run();
  const ParticleChanges& changes = *scene.simulation.particle_changes();
  INFO(mix.name());
  CHECK(changes.emitted().particles > 0);
  CHECK(changes.removed().particles > 0);
  CHECK(changes.changed().particles > 0);
  CHECK(static_cast<double>(scene.simulation.particle_count()) ==
        static_cast<double>(first) + changes.emitted().particles - changes.removed().particles);
}

Mix around_axis() {
  Mix mix;
  mix = with_particle_changes(mix);
  mix.overrides.push_back("/grid/symmetry=axisymmetric");
  mix.overrides.push_back("/gravity=[0, -1.3]");
  mix.overrides.push_back("/emitters/0/velocity=[0, -4]");
  mix.overrides.push_back(R"(/emitters/0/geometry={"type": "box", "lower": [0.6, 0.65], "upper": [0.8, 0.8]})");
  return mix;
}

}  // namespace

TEST_CASE("particles come, go and change their material alike on cpu and reference", "[parity]") {
  for (const int dimension : {2, 3})
    for (const std::string transfer : {R"({"type": "apic"})", R"({"type": "mls"})", R"({"type": "flip"})"})
      for (const std::string contact : {"", R"({"type": "coulomb", "friction": 0.2})"}) {
        Mix mix;
        mix.dimension = dimension, mix.transfer = transfer, mix.contact = contact;
        mix = with_particle_changes(mix);
        check_that_all_changed(mix);
        check_parity(mix);
      }
}

TEST_CASE("particles come and go alike on cpu and reference, whatever they carry", "[parity]") {
  std::vector<Mix> mixes(6);
  mixes[0].shape = R"({"type": "cpdi"})";
  mixes[1].shape = R"({"type": "gimp"})", mixes[1].stress_update = "modified_last";
  mixes[2].transfer = R"({"type": "polypic", "basis": "full"})";
  mixes[3].filter = R"({"type": "fmpm", "order": 2, "every_steps": 3})";
  mixes[4] = warm(mixes[4]);
  mixes[5].shape = R"({"type": "cpdi2"})";
  for (Mix& mix : mixes) {
    mix = with_particle_changes(mix);
    check_that_all_changed(mix);
    check_parity(mix);
  }
  check_that_all_changed(around_axis());
  check_parity(around_axis());
}

TEST_CASE("a run that was saved between two changes of its particles goes on bit for bit", "[parity]") {
  for (const std::string step : {"0.009", "auto"})
    for (const std::string precision : {"double", "float"}) {
      Mix mix;
      mix.dimension = precision == "double" ? 2 : 3;
      mix.transfer = R"({"type": "mls"})";
      mix = with_particle_changes(mix);
      mix.overrides.push_back(set("/precision", precision));
      mix.overrides.push_back(set("/solver/time_step", step));
      mix.overrides.push_back(R"(/output={"colour_by": "displacement"})");  // initial places are kept
      CpuRun whole(mix.text(), mix.overrides, 1);
      whole.steps(14);
      for (const long at : {1, 5, 7, 12}) {
        INFO(at);
        CpuRun first(mix.text(), mix.overrides, 1), second(mix.text(), mix.overrides, 2);
        first.steps(at);
        ArchiveWriter archive;
        first.simulation.save(archive);
        second.steps(3);  // steps to be forgotten
        ArchiveReader reader(archive.bytes());
        second.simulation.restore(reader);
        CHECK(reader.at_end());
        CHECK(different(all_results(first.simulation), all_results(second.simulation)) == 0);
        second.steps(14 - at);
        CHECK(second.simulation.particle_count() == whole.simulation.particle_count());
        CHECK(different(all_results(whole.simulation), all_results(second.simulation)) == 0);
        CHECK(different(values_of(whole.simulation.ledger()), values_of(second.simulation.ledger())) == 0);
        for (int body : {0, 1})
          CHECK(different(whole.simulation.backend().body_state(body).initial_position,
                          second.simulation.backend().body_state(body).initial_position) == 0);
      }
    }
}

TEST_CASE("particles take along where they began to a body that asks for it alone", "[parity]") {
  Mix mix;
  mix = with_particle_changes(mix);
  mix.more += R"(, "loads": [{"type": "body_force", "body": "b", "acceleration": ["3*X", "Y"]}])";
  check_that_all_changed(mix);
  check_parity(mix);
  Mix moved;  // whoever has moved far goes over, whatever the output asks for
  moved.overrides = {
      R"(/bodies/0/becomes={"body": "b", "when": {"quantity": "displacement", "above": 0.04}, "every_steps": 4})"};
  Scene silent(moved.text(), on_reference(moved));
  silent.run();
  moved.overrides.push_back(R"(/output={"colour_by": "displacement"})");
  Scene coloured(moved.text(), on_reference(moved));
  coloured.run();
  CHECK(silent.simulation.particle_changes()->changed().particles > 0);
  CHECK(silent.simulation.particle_changes()->changed().particles ==
        coloured.simulation.particle_changes()->changed().particles);
}

TEST_CASE("particles change alike in a run that nobody looks at", "[parity]") {
  Mix mix;
  mix.transfer = R"({"type": "mls"})";  // which may leave velocities out of steps that nobody looks at
  mix = with_particle_changes(mix);
  CpuRun watched(mix.text(), mix.overrides, 1), unwatched(mix.text(), mix.overrides, 1);
  unwatched.simulation.observe_when([](double, long) { return false; });
  watched.steps(14), unwatched.steps(14);
  CHECK(unwatched.simulation.finished());
  CHECK(different(all_results(watched.simulation), all_results(unwatched.simulation)) == 0);
  CHECK(different(values_of(watched.simulation.ledger()), values_of(unwatched.simulation.ledger())) == 0);
}

TEST_CASE("bodies that begin empty, or lose all they have, run alike on cpu and reference", "[parity]") {
  for (const int dimension : {2, 3})
    for (const std::string contact : {"", R"({"type": "coulomb", "friction": 0.2})"}) {
      Mix mix;
      mix.dimension = dimension, mix.contact = contact;
      mix.overrides = {
          "/bodies/1/geometry=null", "/bodies/1/jitter=0",
          R"(/bodies/0/becomes={"body": "b", "when": {"quantity": "position_x", "above": 0.4}, "every_steps": 6})",
          R"(/sinks=[{"body": "b", "every_steps": 9, "geometry": {"type": "half_space", "point": [0, 0)" +
              std::string(dimension == 3 ? ", 0" : "") + R"(], "normal": [0, -1)" + (dimension == 3 ? ", 0" : "") +
              "]}}]"};
      check_parity(mix);
      Scene scene(mix.text(), on_reference(mix));
      CHECK(scene.simulation.particle_count(1) == 0);
      scene.run_steps(8);
      CHECK(scene.simulation.particle_count(1) > 0);
      scene.run_steps(2);
      CHECK(scene.simulation.particle_count(1) == 0);
    }
}
