// Bodies of every seeding, and bodies that begin deformed, on both backends.

#include "parity/parity.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The parity scene with both bodies seeded in one way.
Mix seeded(const std::string& seeding, int dimension = 2) {
  Mix mix;
  mix.dimension = dimension;
  for (const char* body : {"/bodies/0", "/bodies/1"}) {
    mix.overrides.push_back(set(body + std::string("/seeding"), seeding));
    if (seeding != "partial" && seeding != "fitted") mix.overrides.push_back(set(body + std::string("/jitter"), "0"));
  }
  return mix;
}

Mix deformed(int dimension) {
  Mix mix;
  mix.dimension = dimension;
  mix.overrides = {
      set("/bodies/0/initial_displacement",
          dimension == 2 ? R"J(["0.01*sin(9*X)", "0.02*X*Y"])J" : R"J(["0.01*sin(9*X)", "0.02*X*Y", "0.01*Z"])J"),
      R"(/bodies/1/initial_stress={"xx": "-40+30*Y", "xy": 20})"};
  return mix;
}

}  // namespace

TEST_CASE("parity of every seeding on every kind of shape", "[parity][seeding]") {
  for (const std::string seeding : {"fitted", "partial", "random", "blue_noise"})
    for (const std::string shape : {"bspline_quadratic", "gimp", "gimp_contiguous", "cpdi", "cpdi2"})
      for (const std::string transfer : {"flip", "apic", "mls"}) {
        Mix mix = seeded(seeding);
        mix.shape = "{\"type\": \"" + shape + "\"}", mix.transfer = "{\"type\": \"" + transfer + "\"}";
        check_parity(mix);
      }
  for (const std::string seeding : {"fitted", "partial"}) check_parity(seeded(seeding, 3));
}

TEST_CASE("parity of particles of many sizes with contact, filters, forces and orders of a step", "[parity][seeding]") {
  for (const std::string order : {"last", "first", "modified_last", "averaged"})
    for (const std::string contact : {"", R"({"type": "coulomb", "friction": 0.2})"}) {
      Mix mix = seeded("partial");
      mix.stress_update = order, mix.contact = contact;
      mix.more = R"(, "body_force": ["0.3*y", "0.2*x+t"], "output": {"ledger": true})";
      check_parity(mix);
    }
  Mix filtered = seeded("partial");
  filtered.filter = R"({"type": "fmpm", "order": 2})";
  check_parity(filtered);
  Mix one = seeded("partial");  // the other body's particles are equal
  one.overrides.pop_back();
  check_parity(one);
  Mix rings = seeded("partial");
  rings.overrides.insert(rings.overrides.end(), {set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]")});
  rings.contact = R"({"type": "coulomb", "friction": 0.2})";
  check_parity(rings);
  for (const std::string& material : variants(MPM_MATERIAL)) {
    Mix mix = seeded("partial");
    mix.material = material;
    check_parity(mix);
  }
}

TEST_CASE("parity of bodies that begin deformed", "[parity][seeding]") {
  for (const int dimension : {2, 3}) check_parity(deformed(dimension));
  for (const std::string shape : {"gimp_contiguous", "cpdi", "cpdi2"}) {
    Mix mix = deformed(2);
    mix.shape = "{\"type\": \"" + shape + "\"}";
    check_parity(mix);
  }
  Mix rings = deformed(2);
  rings.overrides.insert(rings.overrides.end(), {set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]")});
  check_parity(rings);
}

TEST_CASE("scenes of many sizes go on from what was saved, bit by bit, on any number of threads", "[parity][seeding]") {
  for (const std::string backend : {"reference", "cpu"})
    for (const bool frozen : {false, true}) {
      INFO(backend << (frozen ? " frozen" : ""));
      Mix mix = seeded("partial");
      mix.overrides.push_back(set("/backend", backend));
      if (frozen) mix.overrides.insert(mix.overrides.end(), {"/gravity=[0, 0]", "/bodies/0/frozen=true"});
      Scene whole(mix.text(), mix.overrides), resumed(mix.text(), mix.overrides, 2);
      whole.run_steps(7);
      ArchiveWriter archive;
      whole.simulation.save(archive);
      ArchiveReader reader(archive.bytes());
      resumed.simulation.restore(reader);
      whole.run_steps(7), resumed.run_steps(7);
      CHECK(!whole.body().size.empty());
      CHECK(whole.body().size == resumed.body().size);
      CHECK(different(all_results(whole.simulation), all_results(resumed.simulation)) == 0);
    }
}
