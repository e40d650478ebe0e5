// What backends tell plugins though no plugin of the build reads it, and what they make of answers that none of the build
// gives.

#include <set>

#include "parity/parity.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

std::set<std::uint32_t> told;
const mpm_material* material_asked = nullptr;
const mpm_filter* filter_asked = nullptr;
const mpm_shape* shape_asked = nullptr;
const mpm_contact* law_asked = nullptr;
double share_left = 1;  ///< of the increment that the first pass of growing_increment leaves
int pairs_beside_held = 0, momenta_of_held = 0;

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

template <int precision, int D>
void note_capacity(const void* parameters, const mpm_list_batch* batch) {
  told.insert(batch->capacity);
  shape_asked->evaluate_list[precision][D - 2](parameters, batch);
}
/// Adds a node without weight to each list, as many cells farther along x than any other.
template <int cells>
void reach_farther(const void* parameters, const mpm_list_batch* batch) {
  shape_asked->evaluate_list[MPM_LANES_DOUBLE][0](parameters, batch);
  for (std::uint32_t lane = 0; lane < batch->count; ++lane) {
    const auto added = static_cast<std::uint32_t>(batch->node_count[lane]++);
    const auto node = [&](std::uint32_t k, std::uint32_t axis) -> std::int32_t& {
      return batch->node[(k * 2 + axis) * batch->stride + lane];
    };
    node(added, 0) = node(0, 0) + cells, node(added, 1) = node(0, 1);
    for (std::uint32_t k = 1; k < added; ++k) node(added, 0) = std::max(node(added, 0), node(k, 0) + cells);
    static_cast<double*>(batch->weight)[added * batch->stride + lane] = 0;
    for (std::uint32_t axis = 0; batch->gradient && axis < 2; ++axis)
      static_cast<double*>(batch->gradient)[(added * 2 + axis) * batch->stride + lane] = 0;
  }
}
/// Leaves a share of the increment in the first pass, and doubles what is left in the second.
void growing_increment(const void*, const mpm_filter_batch* batch) {
  const double factor = batch->iteration == 1 ? share_left : 2;
  for (std::uint32_t c = 0; c < batch->dimension; ++c)
    for (std::uint32_t i = 0; i < batch->count; ++i)
      static_cast<double*>(batch->increment)[c * batch->stride + i] *= factor;
}
std::int32_t two_passes(const void*) {
  return 2;
}
/// Counts the pairs of which a body has an infinite mass, and those of them in which it has a momentum.
template <int precision>
void note_held(const void* parameters, const mpm_contact_batch* batch) {
  for (std::uint32_t i = 0; i < batch->count; ++i) {
    if (std::isfinite(static_cast<const double*>(batch->mass_b)[i])) continue;
    ++pairs_beside_held;
    for (std::uint32_t c = 0; c < batch->dimension; ++c)
      momenta_of_held += static_cast<const double*>(batch->momentum_b)[c * batch->stride + i] != 0;
  }
  law_asked->apply[precision][0](parameters, batch);
}
/// Gives nothing, and says of both values of the law's state what stage it is.
void reach_by_stage(const void*, const mpm_contact_batch* batch) {
  for (std::uint32_t i = 0; i < batch->count; ++i) {
    for (std::uint32_t c = 0; c < batch->dimension; ++c)
      static_cast<double*>(batch->impulse)[c * batch->stride + i] = 0;
    static_cast<double*>(batch->dissipated)[i] = static_cast<double*>(batch->stored)[i] = 0;
    batch->status[i] = MPM_APART;
    for (std::uint32_t k = 0; k < MPM_CONTACT_STATES; ++k)
      static_cast<double*>(batch->reached)[k * batch->stride + i] = batch->stage == MPM_AFTER_FORCES ? 0.25 : 0.5;
  }
}

/// A plugin of the build that calls functions of a table of ours.
class Noting {
 public:
  Noting(const Plugin& noted, const void* table) : descriptor_(*noted.descriptor), plugin(noted) {
    descriptor_.kind_table = table;
    plugin.descriptor = &descriptor_;
  }
  void declare(std::span<const mpm_state> state) {
    descriptor_.state = state.data(), descriptor_.state_count = static_cast<std::uint32_t>(state.size());
  }
  void drop_extensions() { descriptor_.extension = nullptr; }
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

/// Runs one long particle of "cpdi", whose lists are of a table without boxes of nodes, which would be taken for them.
void run_long(const mpm_shape& table) {
  Noting noting(*plugins().find(MPM_SHAPE, "cpdi"), &table);
  noting.drop_extensions();
  Experiment experiment = experiment_from(R"J({"title": "long", "dimension": 2, "grid": {"cell_size": 1, "domain":
      [[0, 0], [48, 8]], "boundaries": {"all": "free"}}, "shape": {"type": "cpdi"}, "transfer": {"type": "apic"},
      "materials": {"m": {"type": "neo_hookean", "youngs_modulus": 1e-9, "poisson_ratio": 0, "density": 1}}, "bodies":
      [{"name": "a", "material": "m", "geometry": {"type": "box", "lower": [20, 4], "upper": [21, 5]},
      "particles_per_cell_axis": 1, "initial_deformation_gradient": {"xx": 20}, "velocity": [0, 0.1]}],
      "solver": {"time_step": 1, "end_time": 9}})J",
                                          {"/backend=cpu", "/precision=double"});
  experiment.shape.plugin = &noting.plugin;
  run(experiment);
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
    mix.more = R"(, "output": {"reactions": true})";  // which ask the filter what it takes of a projection
    Experiment experiment = experiment_from(mix.text(), {set("/backend", backend), "/precision=double"});
    experiment.filter->plugin = &noting.plugin;
    run(experiment);
    CHECK(told == std::set<std::uint32_t>{1, 2, 3});
  }
}

TEST_CASE("a shape is told how many nodes its own lists hold at most", "[parity]") {
  const Plugin& shape = *plugins().find(MPM_SHAPE, "cpdi2");
  shape_asked = &shape.shape();
  mpm_shape table = *shape_asked;
  const auto note = [&]<int precision>() {
    table.evaluate_list[precision][0] = note_capacity<precision, 2>;
    table.evaluate_list[precision][1] = note_capacity<precision, 3>;
  };
  note.operator()<MPM_LANES_DOUBLE>();
  note.operator()<MPM_SCALAR_DOUBLE>();
  const Noting noting(shape, &table);
  for (const std::string backend : {"reference", "cpu"})
    for (const int dimension : {2, 3}) {
      INFO(backend << " " << dimension);
      Mix mix;
      mix.dimension = dimension, mix.shape = R"({"type": "cpdi2"})";
      Experiment experiment = experiment_from(mix.text(), {set("/backend", backend), "/precision=double"});
      experiment.shape.plugin = &noting.plugin;
      run(experiment);
      CHECK(told == std::set<std::uint32_t>{shape_asked->capacity[dimension - 2]});
    }
}

// The particle's farthest corner lies in the last cell of the block after the neighbour of its own.
TEST_CASE("the grid has the nodes that lists reach beyond corners", "[parity]") {
  shape_asked = &plugins().find(MPM_SHAPE, "cpdi")->shape();
  mpm_shape table = *shape_asked;
  table.evaluate_list[MPM_LANES_DOUBLE][0] = reach_farther<1>;
  ++table.capacity[0], ++table.reach;
  CHECK_NOTHROW(run_long(table));
}

TEST_CASE("a shape whose lists reach farther than it declares is named", "[parity][failure]") {
  shape_asked = &plugins().find(MPM_SHAPE, "cpdi")->shape();
  mpm_shape table = *shape_asked;
  table.evaluate_list[MPM_LANES_DOUBLE][0] = reach_farther<15>;
  ++table.capacity[0];
  CHECK_THROWS_WITH(run_long(table), "shape \"cpdi\" gave a node beyond its declared reach");
}

// What is smaller is rounding, whose growth says nothing. The second pass doubles what the first has left.
TEST_CASE("the growth of an increment counts from 1e-12 of the first one on", "[parity]") {
  mpm_filter table = plugins().find(MPM_FILTER, "fmpm")->filter();
  table.iterations = two_passes;
  table.update[MPM_LANES_DOUBLE][0] = table.update[MPM_SCALAR_DOUBLE][0] = growing_increment;
  const Noting noting(*plugins().find(MPM_FILTER, "fmpm"), &table);
  for (const std::string backend : {"reference", "cpu"})
    for (const bool counts : {true, false}) {
      INFO(backend << " " << counts);
      share_left = counts ? 1.1e-12 : 0.9e-12;
      Mix mix;
      mix.boundaries = R"({"all": "free"})", mix.filter = R"({"type": "fmpm", "order": 4})";
      Experiment experiment = experiment_from(mix.text(), {set("/backend", backend), "/precision=double"});
      experiment.filter->plugin = &noting.plugin;
      Simulation simulation(experiment, backend_factory(1));
      simulation.step();
      const FilterRecord& record = simulation.backend().filter_record();
      CHECK(record.iterations == 2);
      CHECK(record.largest_growth == Approx(counts ? 2 : share_left).epsilon(1e-6));
    }
}

TEST_CASE("a law is told of a body that a grip holds as one of infinite mass at rest", "[parity]") {
  const Plugin& coulomb = *plugins().find(MPM_CONTACT, "coulomb");
  law_asked = &coulomb.contact();
  mpm_contact table = *law_asked;
  table.apply[MPM_LANES_DOUBLE][0] = note_held<MPM_LANES_DOUBLE>;
  table.apply[MPM_SCALAR_DOUBLE][0] = note_held<MPM_SCALAR_DOUBLE>;
  const Noting noting(coulomb, &table);
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string held : {"a", "b"}) {
      INFO(backend << " " << held);
      Mix mix;
      mix.contact = R"({"type": "coulomb", "friction": 0.2})";
      mix.more = R"(, "grips": [{"body": ")" + held +
                 R"(", "where": {"type": "half_space", "point": [9, 0], "normal": [1, 0]}, "velocity": [0.4, 0.3]}])";
      Experiment experiment = experiment_from(mix.text(), {set("/backend", backend), "/precision=double"});
      experiment.contact->plugin = &noting.plugin;
      pairs_beside_held = momenta_of_held = 0;
      run(experiment);
      CHECK(pairs_beside_held > 0);
      CHECK(momenta_of_held == 0);
    }
}

TEST_CASE("particles keep what a law has reached after the forces, not before", "[parity]") {
  const Plugin& glue = *plugins().find(MPM_CONTACT, "breakable_glue");
  mpm_contact table = glue.contact();
  table.apply[MPM_LANES_DOUBLE][0] = table.apply[MPM_SCALAR_DOUBLE][0] = reach_by_stage;
  const Noting noting(glue, &table);
  for (const std::string backend : {"reference", "cpu"})
    for (const std::string order : {"last", "modified_last"}) {
      INFO(backend << " " << order);
      Mix mix;
      mix.stress_update = order;
      mix.contact = R"({"type": "breakable_glue", "tension_stiffness": 1e3, "compression_stiffness": 1e3,
        "shear_stiffness": 1e3, "normal_strength": 10, "shear_strength": 10})";
      Experiment experiment = experiment_from(mix.text(), {set("/backend", backend), "/precision=double"});
      experiment.contact->plugin = &noting.plugin;
      Simulation simulation(experiment, backend_factory(1));
      for (int step = 0; step < 2; ++step) simulation.step();
      const BodyState state = simulation.backend().body_state(0);
      const std::vector<double>& kept = state.host_state.at("contact_state");
      CHECK(*std::max_element(kept.begin(), kept.end()) == Approx(0.25).epsilon(1e-12));
    }
}

// A chunk of particles hands a plugin its fields in an array of fixed length.
TEST_CASE("a material may have sixteen fields of state on the cpu backend, and no more", "[parity]") {
  const Plugin& law = *plugins().find(MPM_MATERIAL, "neo_hookean");
  const mpm_material table = law.material();
  std::vector<mpm_state> state(law.state().begin(), law.state().end());
  static const char* const names[] = {"s0", "s1",  "s2",  "s3",  "s4",  "s5",  "s6",  "s7", "s8",
                                      "s9", "s10", "s11", "s12", "s13", "s14", "s15", "s16"};
  while (state.size() < 17) state.push_back({names[state.size()], "", "more", MPM_STATE_SCALAR, MPM_INITIAL_ZERO});
  for (const std::size_t count : {16u, 17u}) {
    Noting noting(law, &table);
    noting.declare({state.data(), count});
    Experiment experiment = experiment_from(Mix().text(), {"/backend=cpu", "/precision=double"});
    for (MaterialSpecification& material : experiment.materials) material.component.plugin = &noting.plugin;
    if (count == 16)
      CHECK_NOTHROW(run(experiment));
    else
      CHECK_THROWS_WITH(Simulation(experiment, backend_factory(1)),
                        "the cpu backend takes at most 16 state fields a plugin");
  }
}
