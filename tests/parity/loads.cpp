// Loads on both backends, against each other, fused against separate, and resumed.

#include "parity/parity.hpp"
#include "support/results.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// All kinds of loads on the bodies of the parity scene.
Mix loaded(int dimension) {
  Mix mix;
  mix.dimension = dimension;
  const bool flat = dimension == 2;
  mix.more =
      std::string(R"J(, "loads": [
    {"type": "pressure", "body": "a", "where": {"type": "half_space", "point": )J") +
      (flat ? "[0.31, 0], \"normal\": [1, 0.3]}" : "[0.27, 0, 0], \"normal\": [1, 0.3, 0.1]}") +
      R"J(, "pressure": "400+100*sin(9*t)+20*x"},
    {"type": "pressure", "body": "b", "follower": false, "where": {"type": "half_space", "point": )J" +
      (flat ? "[0, 0.6], \"normal\": [0, -1]}" : "[0, 0.4, 0], \"normal\": [0, -1, 0]}") +
      R"J(, "pressure": 300},
    {"type": "traction", "body": "b", "where": {"type": "box", "lower": )J" +
      (flat ? "[0.8, 0.3], \"upper\": [0.9, 0.5]}" : "[0.6, 0.2, 0.2], \"upper\": [0.7, 0.3, 0.4]}") +
      R"J(, "traction": )J" + (flat ? R"J(["200*X", "-300*y+100*t"]})J" : R"J(["200*X", "-300*y+100*t", 50]})J") +
      R"J(, {"type": "force", "body": "a", "at": )J" + (flat ? "[0.4, 0.37]" : "[0.33, 0.27, 0.3]") +
      R"J(, "force": )J" + (flat ? R"J([5, "20*t"]})J" : R"J([1, "4*t", 0.5]})J") +
      R"J(, {"type": "body_force", "body": "b", "acceleration": )J" +
      (flat ? R"J(["X", "t-y"]})J" : R"J(["X", "t-y", "z"]})J") +
      R"J(, {"type": "spring", "body": "b", "where": {"type": "half_space", "point": )J" +
      (flat ? "[0.52, 0], \"normal\": [1, 0]}, \"stiffness\": [2e3, 1e3], \"damping\": [50, 100]}"
            : "[0.42, 0, 0], \"normal\": [1, 0, 0]}, \"stiffness\": [2e3, 1e3, 500], \"damping\": [50, 100, 0]}");
  if (!flat)
    mix.more +=
        R"J(, {"type": "line_force", "body": "b", "from": [0.5, 0.15, 0.25], "to": [0.55, 0.35, 0.4], "force": [2, 3, "-t"]})J";
  mix.more += "]";
  return mix;
}

Mix loaded_ring() {
  Mix mix = loaded(2);
  mix.overrides = {set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]")};
  return mix;
}

/// Forces per mass on all bodies and on one of them, which the ledger alone keeps apart from the stress.
Mix pulled(int dimension, const std::string& output) {
  Mix mix;
  mix.dimension = dimension;
  const bool flat = dimension == 2;
  mix.more = std::string(R"J(, "body_force": ["2*sin(3*X)+t", "x-Y*y")J") + (flat ? "]" : R"J(, "z*X"])J") +
             R"J(, "loads": [{"type": "body_force", "body": "b", "acceleration": )J" +
             (flat ? R"J(["X", "t-y"]})J" : R"J(["X", "t-y", "z"]})J") +
             R"J(, {"type": "body_force", "body": "b", "acceleration": )J" + (flat ? "[0, 0.5]" : "[0, 0.5, -0.2]") +
             "}], \"output\": " + output;
  return mix;
}

Mix pulled_ring(const std::string& output) {
  Mix mix = pulled(2, output);
  mix.overrides = {set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]")};
  return mix;
}

const char* const outputs[] = {R"({"ledger": false})", R"({"ledger_every": 3})", R"({"ledger": true})"};

}  // namespace

TEST_CASE("parity of loads on every shape and transfer", "[parity][loads]") {
  for (const std::string& shape : variants(MPM_SHAPE))
    for (const std::string& transfer : variants(MPM_TRANSFER)) {
      Mix mix = loaded(2);
      mix.shape = shape, mix.transfer = transfer;
      if (!is_refused(mix)) check_parity(mix);
    }
}

TEST_CASE("parity of loads in 3-D, around an axis, in every order, with filters and contact", "[parity][loads]") {
  for (const std::string transfer : {"flip", "apic", "mls"})
    for (const std::string order : {"last", "first", "modified_last", "averaged"})
      for (Mix mix : {loaded(3), loaded_ring()}) {
        if (mix.dimension == 3 && order != "last") continue;
        mix.transfer = "{\"type\": \"" + transfer + "\"}", mix.stress_update = order;
        check_parity(mix);
      }
  for (const std::string type : {"fmpm", "xpic"}) {
    Mix mix = loaded(2);
    mix.filter = "{\"type\": \"" + type + "\", \"order\": 2}";
    mix.contact = R"({"type": "coulomb", "friction": 0.2})";
    check_parity(mix);
  }
  Mix mix = loaded(2);
  mix.boundaries = R"({"all": "separate"})", mix.close = true;
  mix.overrides.push_back(set("/loads/1/where/point", "[0, 0.6]"));
  check_parity(mix);
}

TEST_CASE("parity of forces per mass with the momenta, with the stress and apart", "[parity][loads]") {
  for (const std::string output : outputs) {
    for (const std::string transfer : {"flip", "apic", "mls"})
      for (const std::string order : {"last", "first", "modified_last", "averaged"})
        for (Mix mix : {pulled(2, output), pulled(3, output), pulled_ring(output)}) {
          if (mix.dimension == 3 && order != "last") continue;
          mix.transfer = "{\"type\": \"" + transfer + "\"}", mix.stress_update = order;
          check_parity(mix);
        }
    Mix mix = pulled(2, output);
    mix.filter = R"({"type": "fmpm", "order": 2})", mix.contact = R"({"type": "coulomb", "friction": 0.2})";
    check_parity(mix);
    mix = pulled(2, output);
    mix.boundaries = R"({"all": "separate"})", mix.close = true;
    check_parity(mix);
    mix = pulled(2, output);
    mix.more += R"(, "damping": {"viscous": 2})";
    check_parity(mix);
    mix = loaded(2);
    mix.more += ", \"output\": " + output;
    check_parity(mix);
  }
}

TEST_CASE("loads give the same bits fused and apart, with 1 and 2 threads, and resumed", "[parity][loads]") {
  for (const std::string precision : {"double", "float"})
    for (const std::string transfer : {"apic", "mls", "flip"})
      for (const Mix& base : {loaded(2), loaded(3), loaded_ring(), pulled(2, outputs[0]), pulled(3, outputs[1]),
                              pulled_ring(outputs[0]), pulled(2, outputs[1])}) {
        Mix mix = base;
        mix.transfer = "{\"type\": \"" + transfer + "\"}";
        INFO(precision << " " << mix.name());
        const auto overrides = [&](const std::string& passes) {
          std::vector<std::string> all = mix.overrides;
          all.insert(all.end(), {set("/precision", precision), set("/solver/passes", passes), "/solver/end_time=1"});
          return all;
        };
        CpuRun separate(mix.text(), overrides("separate"), 1), fused(mix.text(), overrides("fused"), 2);
        separate.steps(12), fused.steps(5);
        ArchiveWriter archive;
        fused.simulation.save(archive);
        fused.steps(7);
        CHECK(different(all_results(separate.simulation), all_results(fused.simulation)) == 0);
        CpuRun resumed(mix.text(), overrides("fused"), 1);
        ArchiveReader reader(archive.bytes());
        resumed.simulation.restore(reader);
        resumed.steps(7);
        CHECK(different(all_results(separate.simulation), all_results(resumed.simulation)) == 0);
        CHECK(different(values_of(separate.simulation.ledger()), values_of(resumed.simulation.ledger())) == 0);
      }
}
