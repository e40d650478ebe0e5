// A run that is saved and goes on in another simulation goes on bit for bit: particles, ledger and records.

#include <cstring>

#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const char* blocks = R"J({
  "title": "two blocks", "dimension": 2, "precision": "double", "backend": "reference",
  "grid": {"cell_size": 0.1, "domain": [[0, 0], [2, 1]], "boundaries": {"x_min": "separate", "x_max": "free", "y_min": "slip", "y_max": "free"}},
  "shape": {"type": "linear"}, "transfer": {"type": "apic"},
  "materials": {"m": {"type": "von_mises", "youngs_modulus": 1e5, "poisson_ratio": 0.3, "density": 1000, "yield_stress": 300}},
  "bodies": [
    {"name": "left", "material": "m", "geometry": {"type": "box", "lower": [0.2, 0], "upper": [0.6, 0.4]}, "velocity": ["0.8", "0.3*sin(9*x)"]},
    {"name": "right", "material": "m", "geometry": {"type": "box", "lower": [0.65, 0], "upper": [1.05, 0.4]}, "velocity": ["-0.8", "y"]}],
  "gravity": [0, -9.81],
  "solver": {"time_step": "auto", "courant": 0.15, "end_time": 10}, "output": {"ledger": true}})J";

template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

bool same_bits(const BodyState& a, const BodyState& b) {
  return a.position == b.position && a.velocity == b.velocity && a.initial_position == b.initial_position &&
         a.transfer_state == b.transfer_state && a.material_state == b.material_state && a.domain == b.domain &&
         a.corners == b.corners && a.second_moment == b.second_moment;
}

void check_resume(const std::vector<std::string>& overrides) {
  Scene scene(blocks, overrides), resumed(blocks, overrides);
  scene.run_steps(33);
  ArchiveWriter writer;
  scene.simulation.save(writer);
  scene.run_steps(27);

  ArchiveReader reader(writer.bytes());
  resumed.simulation.restore(reader);
  CHECK(reader.at_end());
  resumed.run_steps(27);
  CHECK(scene.simulation.time() == resumed.simulation.time());
  for (int body = 0; body < 2; ++body) CHECK(same_bits(scene.body(body), resumed.body(body)));
  CHECK(scene.simulation.backend().ledger().material > 0);  // the scene does something
  const Backend &a = scene.simulation.backend(), &b = resumed.simulation.backend();
  CHECK(same_bits(a.ledger(), b.ledger()));
  CHECK(same_bits(a.contact_record(), b.contact_record()));
  CHECK(same_bits(a.filter_record(), b.filter_record()));
  CHECK(scene.metrics.row(scene.metrics.measure()) == resumed.metrics.row(resumed.metrics.measure()));
}

}  // namespace

TEST_CASE("a restored run goes on bit for bit", "[restore]") {
  const std::vector<std::string> filters{
      "/filter=null", R"(/filter={"type":"fmpm","order":3,"every_steps":2,"position_update":"mean_velocity"})",
      R"(/filter={"type":"xpic","order":3,"every_courant":1.5})"};
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string order : {"last", "first", "modified_last", "averaged"})
      for (const std::string contact : {"/contact=null", R"(/contact={"type":"coulomb","friction":0.3})"})
        for (const std::string& filter : filters)
          for (const std::string shape : {"linear", "cpdi"}) {
            INFO(backend << " " << order << " " << contact << " " << filter << " " << shape);
            check_resume({set("/backend", backend), set("/solver/stress_update", order), contact, filter,
                          set("/shape/type", shape)});
          }
}

TEST_CASE("an archive of another scene is refused", "[restore]") {
  Scene scene(blocks), other(blocks, {set("/bodies/0/particles_per_cell_axis", "1")}),
      contact(blocks, {set("/shape/type", "cpdi")});
  ArchiveWriter writer;
  scene.simulation.save(writer);
  ArchiveReader reader(writer.bytes());
  CHECK_THROWS_AS(other.simulation.restore(reader), ArchiveError);
  ArchiveReader again(writer.bytes());
  CHECK_THROWS_AS(contact.simulation.restore(again), ArchiveError);
  ArchiveReader cut(std::span(writer.bytes()).first(writer.bytes().size() / 2));
  CHECK_THROWS_AS(Scene(blocks).simulation.restore(cut), ArchiveError);
}
