// What backends tell plugins though no plugin of the build reads it.

#include <set>

#include "parity/parity.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

std::set<std::uint32_t> told;
const mpm_material* material_asked = nullptr;
const mpm_filter* filter_asked = nullptr;

template <int precision, int D>
std::int32_t note_dimension(const void* parameters, const mpm_material_batch* batch) {
  told.insert(batch->dimension);
  return material_asked->update[precision][D - 2](parameters, batch);
}
template <int precision, int D>
void note_iteration(const void* parameters, const mpm_filter_batch* batch) {
  told.insert(batch->iteration);
  filter_asked->update[precision][D - 2](parameters, batch);
}

/// A plugin of the build that calls functions of a table of ours.
class Noting {
 public:
  Noting(const Plugin& noted, const void* table) : descriptor_(*noted.descriptor), plugin(noted) {
    descriptor_.kind_table = table;
    plugin.descriptor = &descriptor_;
  }
  Noting(const Noting&) = delete;
  Noting& operator=(const Noting&) = delete;

 private:
  mpm_descriptor descriptor_;

 public:
  Plugin plugin;
};

void run(const Experiment& experiment) {
  told.clear();
  Simulation simulation(experiment, backend_factory(1));
  for (int step = 0; step < 2; ++step) simulation.step();
}

}  // namespace

TEST_CASE("a material is told the dimension of its batch", "[parity]") {
  const Plugin& law = *plugins().find(MPM_MATERIAL, "neo_hookean");
  material_asked = &law.material();
  mpm_material table = *material_asked;
  const auto note = [&]<int precision>() {
    table.update[precision][0] = note_dimension<precision, 2>;
    table.update[precision][1] = note_dimension<precision, 3>;
  };
  note.operator()<MPM_LANES_DOUBLE>();
  note.operator()<MPM_SCALAR_DOUBLE>();
  const Noting noting(law, &table);
  for (const std::string backend : {"reference", "cpu"})
    for (const unsigned dimension : {2u, 3u}) {
      INFO(backend << " " << dimension);
      Mix mix;
      mix.dimension = static_cast<int>(dimension);
      Experiment experiment = experiment_from(mix.text(), {set("/backend", backend), "/precision=double"});
      for (MaterialSpecification& material : experiment.materials) material.component.plugin = &noting.plugin;
      run(experiment);
      CHECK(told == std::set<std::uint32_t>{dimension});
    }
}

TEST_CASE("a filter is told the number of its pass, from one, by both hosts", "[parity]") {
  const Plugin& fmpm = *plugins().find(MPM_FILTER, "fmpm");
  filter_asked = &fmpm.filter();
  mpm_filter table = *filter_asked;
  table.update[MPM_LANES_DOUBLE][0] = note_iteration<MPM_LANES_DOUBLE, 2>;
  table.update[MPM_SCALAR_DOUBLE][0] = note_iteration<MPM_SCALAR_DOUBLE, 2>;
  const Noting noting(fmpm, &table);
  for (const std::string backend : {"reference", "cpu"}) {
    INFO(backend);
    Mix mix;
    mix.filter = R"({"type": "fmpm", "order": 4})";
    Experiment experiment = experiment_from(mix.text(), {set("/backend", backend), "/precision=double"});
    experiment.filter->plugin = &noting.plugin;
    run(experiment);
    CHECK(told == std::set<std::uint32_t>{1, 2, 3});
  }
}
