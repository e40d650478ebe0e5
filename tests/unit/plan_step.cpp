// The plan of a step that another solver than the explicit one writes: what it holds, what is refused by name, and what
// operators say of the fields that they use.

#include <algorithm>
#include <map>
#include <stdexcept>

#include "plan/step_builder.hpp"
#include "solvers/solver.hpp"
#include "support/catch.hpp"
#include "support/scene.hpp"

using namespace mpm;

namespace {

const char* const block = R"json({
  "dimension": 2,
  "grid": {"cell_size": 0.25, "domain": [[0, 0], [1, 1]], "boundaries": {"all": "slip"}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "apic"},
  "materials": {"a": {"type": "neo_hookean", "density": 1000, "youngs_modulus": 1e4, "poisson_ratio": 0.2}},
  "bodies": [{"name": "b", "material": "a", "geometry": {"type": "box", "lower": [0.25, 0.25], "upper": [0.75, 0.75]}}],
  "solver": {"end_time": 1}, "output": {"ledger": false}
})json";

const char* const slab = R"json({
  "dimension": 2,
  "grid": {"cell_size": 0.25, "domain": [[0, 0], [1, 1]], "boundaries": {"all": {"type": "slip", "temperature": 280}}},
  "shape": {"type": "bspline_quadratic"}, "transfer": {"type": "flip"},
  "materials": {"a": {"type": "von_mises", "density": 1000, "youngs_modulus": 1e4, "poisson_ratio": 0.2,
    "yield_stress": 20, "thermal": {"conductivity": 2, "heat_capacity": 10, "dissipation_to_heat": 0.9,
      "phase_change": {"temperature": 290, "latent_heat": 1000, "melted": {"youngs_modulus": 1e3}}}}},
  "bodies": [{"name": "b", "material": "a", "temperature": 280,
    "geometry": {"type": "box", "lower": [0.25, 0.25], "upper": [0.75, 0.75]}}],
  "solver": {"end_time": 1}, "output": {"ledger": false}
})json";

/// The plan of a scene whose step a toy solver writes.
Plan plan_of(const std::vector<std::string>& overrides, const std::function<void(StepBuilder&)>& step) {
  return assemble_plan(mpm::test::experiment_from(block, overrides), step);
}

/// The words of the std::logic_error that planning throws.
std::string fault_of(const std::function<void(StepBuilder&)>& step) {
  try {
    plan_of({}, step);
  } catch (const std::logic_error& fault) {
    return fault.what();
  }
  return "accepted";
}

void scatter(StepBuilder& step) {
  step.perform(Act::clear, "/solver/type \"toy\"");
  step.perform(Act::scatter_momentum, "/solver/type \"toy\"");
  step.perform(Act::scatter_force, "/solver/type \"toy\"");
  step.perform(Act::divide, "/solver/type \"toy\"");
}

void gather_and_move(StepBuilder& step) {
  step.perform(Act::gather, "/solver/type \"toy\"", Stage::after_forces);
  step.perform(Act::move, "/solver/type \"toy\"", Stage::after_forces);
}

/// The values of one kind that an operator of the slab's step uses.
bool uses(const FieldNames Operator::*kind, Act act, const std::string& name,
          const std::vector<std::string>& overrides = {}) {
  const Plan plan = make_plan(mpm::test::experiment_from(slab, overrides));
  const Operator* operation = plan.find(act);
  REQUIRE(operation);
  const FieldNames& names = operation->*kind;
  return std::count(names.begin(), names.end(), name) > 0;
}

const std::vector<std::vector<std::string>> scenes{{},
                                                   {"/backend=reference"},
                                                   {"/output/ledger=true"},
                                                   {"/transfer/type=\"flip\"", "/backend=reference"},
                                                   {"/shape/type=\"gimp_contiguous\""},
                                                   {"/shape/type=\"gimp_contiguous\"", "/backend=reference"},
                                                   {"/shape/type=\"cpdi2\""},
                                                   {R"(/body_force=["X", "0"])"}};

}  // namespace

TEST_CASE("a step without a gather has a plan, whose passes stay apart because the solver has none", "[plan]") {
  for (const std::vector<std::string>& overrides : scenes) {
    INFO(::Catch::Detail::stringify(overrides));
    const Plan plan = plan_of(overrides, [](StepBuilder& step) {
      scatter(step);
      step.perform(Act::strain, "/solver/type \"toy\"");
    });
    CHECK_FALSE(plan.fused());
    CHECK(plan.why_not_fused == "/solver/type \"explicit\": no gather ends its step");
    CHECK(plan.does(Act::strain));
  }
}

TEST_CASE("a step without a strain keeps its passes apart, and so does one that strains before it gathers", "[plan]") {
  for (const std::vector<std::string>& overrides : scenes) {
    INFO(::Catch::Detail::stringify(overrides));
    const Plan rigid = plan_of(overrides, [](StepBuilder& step) {
      scatter(step);
      step.perform(Act::accelerate, "/solver/type \"toy\"", Stage::after_forces);
      gather_and_move(step);
    });
    CHECK(rigid.why_not_fused == "/solver/type \"toy\": strain and move do not share the visit of the gather");
    const Plan apart = plan_of(overrides, [](StepBuilder& step) {
      scatter(step);
      step.perform(Act::accelerate, "/solver/type \"toy\"", Stage::after_forces);
      step.perform(Act::strain, "/solver/sweeps: by the last sweep", Stage::after_forces);
      gather_and_move(step);
    });
    CHECK(apart.why_not_fused == "/solver/sweeps: strain and move do not share the visit of the gather");
    if (const Field* domain = apart.particle_field(0, "strained_domain"))
      CHECK(domain->because == "/solver/sweeps: the weights of a step stay those before its strain");
  }
}

TEST_CASE("a step that goes on after its gather, or scatters nothing before it, keeps its passes apart", "[plan]") {
  const auto to_the_gather = [](StepBuilder& step) {
    step.perform(Act::accelerate, "/solver/type \"toy\"", Stage::after_forces);
    step.perform(Act::gather, "/solver/type \"toy\"", Stage::after_forces);
    step.perform(Act::strain, "/solver/type \"toy\"", Stage::after_forces);
    step.perform(Act::move, "/solver/type \"toy\"", Stage::after_forces);
  };
  const Plan longer = plan_of({}, [&](StepBuilder& step) {
    scatter(step);
    to_the_gather(step);
    step.perform(Act::clear, "/solver/tidies: for the next step");
  });
  CHECK(longer.why_not_fused == "/solver/tidies: the step goes on after its gather");
  CHECK(fault_of([&](StepBuilder& step) {
          step.perform(Act::clear, "/solver/type \"toy\"");
          to_the_gather(step);
        }).starts_with("the step reads what nothing has written: operator \"apply forces\""));
}

TEST_CASE("a step is refused that reads what particles keep within a step before it is written", "[plan]") {
  CHECK(fault_of([](StepBuilder& step) {
          scatter(step);
          step.perform(Act::accelerate, "/solver/type \"toy\"", Stage::after_forces);
          step.perform(Act::move, "/solver/type \"toy\"", Stage::after_forces);
          step.perform(Act::gather, "/solver/type \"toy\"", Stage::after_forces);
          step.perform(Act::strain, "/solver/type \"toy\"", Stage::after_forces);
        }) ==
        "the step reads what nothing has written: operator \"move\" (/solver/type \"toy\") reads "
        "particles/advection_velocity");
  CHECK(fault_of([](StepBuilder& step) {
          scatter(step);
          step.perform(Act::accelerate, "/solver/type \"toy\"", Stage::after_forces);
          step.perform(Act::gather, "/solver/type \"toy\"", Stage::after_forces);
          step.perform(Act::strain, "/solver/type \"toy\"", Stage::after_forces);
          step.perform(Act::move, "/solver/type \"toy\"", Stage::after_forces);
        }) == "accepted");
}

TEST_CASE("a step is refused that does the work of a component that the scene does not have", "[plan]") {
  const auto with = [](Act act) {
    return fault_of([&](StepBuilder& step) {
      scatter(step);
      step.perform(act, "/solver/type \"toy\"");
      step.perform(Act::strain, "/solver/type \"toy\"");
    });
  };
  CHECK(with(Act::project) ==
        "the step does what the scene has no filter for: operator \"project\" (/solver/type \"toy\")");
  CHECK(with(Act::keep_correction) ==
        "the step does what the scene has no filter for: operator \"keep correction\" (/solver/type \"toy\")");
  CHECK(with(Act::scatter_contact) ==
        "the step does what the scene has no contact for: operator \"scatter contact\" (/solver/type \"toy\")");
  CHECK(with(Act::gather_heat) ==
        "the step does what the scene has no temperature for: operator \"gather heat\" (/solver/type \"toy\")");
}

TEST_CASE("every operator that leads a pass has a name, and one that has none is a fault with its number", "[plan]") {
  for (int act = 0; act < act_count; ++act) {
    INFO(act);
    CHECK_FALSE(single(static_cast<Act>(act), "").pass.name().empty());
  }
  CHECK_THROWS_WITH(single(static_cast<Act>(31), "").pass.name(), "operator 31 has no name");
}

TEST_CASE("whoever evaluates a material that melts reads how far its particles have melted", "[plan]") {
  const auto reads = &Operator::reads, writes = &Operator::writes;
  const std::string melted = "particles/melted_fraction", temperature = "particles/temperature";
  for (const Act act : {Act::estimate_time_step, Act::strain, Act::scatter_force, Act::conduct, Act::scatter_heat}) {
    INFO(static_cast<int>(act));
    CHECK(uses(reads, act, melted));
  }
  const std::vector<std::string> pair{
      R"(/bodies=[{"name": "b", "material": "a", "temperature": 280,
                   "geometry": {"type": "box", "lower": [0.25, 0.25], "upper": [0.75, 0.75]}},
                  {"name": "c", "material": "a", "temperature": 280,
                   "geometry": {"type": "box", "lower": [0.75, 0.25], "upper": [1, 0.75]}}])",
      R"(/contact={"type": "coulomb", "friction": 0.3})"};
  CHECK(uses(reads, Act::scatter_contact, melted, pair));
  CHECK(uses(reads, Act::change_phase, "particles/material"));
  CHECK(uses(reads, Act::strain, temperature));
  CHECK(uses(writes, Act::strain, temperature));
  const std::vector<std::string> cold{"/materials/a/thermal/dissipation_to_heat=0"};
  CHECK_FALSE(uses(reads, Act::strain, temperature, cold));
  CHECK_FALSE(uses(writes, Act::strain, temperature, cold));
  CHECK_FALSE(uses(reads, Act::gather, melted));
}

TEST_CASE("a pass says whether it visits particles or nodes, and a fused one both", "[plan]") {
  const auto visits = [](const char* scene) {
    const Plan plan = make_plan(mpm::test::experiment_from(scene));
    std::map<std::string, std::vector<std::string>> by_name;
    const auto json = plan.to_json();
    for (const auto& pass : json["passes"])
      if (pass.contains("visits")) by_name[pass["name"]] = pass["visits"].get<std::vector<std::string>>();
    return by_name;
  };
  const std::vector<std::string> particles{"particles"}, nodes{"nodes"}, both{"particles", "nodes"};
  auto warm = visits(slab), fused = visits(block);
  CHECK(warm["scatter"] == particles);
  CHECK(warm["momentum to velocity"] == nodes);
  CHECK(warm["conduct"] == particles);
  CHECK(warm["heat"] == nodes);
  CHECK(warm["gather and strain"] == particles);
  CHECK(fused["gather, strain and scatter"] == both);
}

TEST_CASE("forces per mass have a field of their own where a ledger or a backend keeps them apart", "[plan]") {
  const std::string force = R"(/body_force=["X", "0"])";
  const std::string load = R"(/loads=[{"type": "body_force", "body": "b", "acceleration": [0, "t"]}])";
  const std::string surface = R"(/loads=[{"type": "force", "body": "b", "at": [0.5, 0.5], "force": [0, "t"]}])";
  const auto plan_with = [](std::vector<std::string> overrides, const std::string& more) {
    overrides.push_back(more);
    return make_plan(mpm::test::experiment_from(block, overrides));
  };
  for (const std::string& given : {force, load}) {
    INFO(given);
    const Plan merged = plan_with({given}, "/output/ledger=false");
    CHECK(!merged.node_field("body_force"));
    CHECK(!merged.node_field("force"));
    const Plan booked = plan_with({given}, "/output/ledger=true");
    REQUIRE(booked.node_field("body_force"));
    CHECK(booked.node_field("body_force")->for_ledger);
    CHECK(booked.node_field("force")->for_ledger);
    const Plan apart = plan_with({given}, "/backend=reference");
    REQUIRE(apart.node_field("body_force"));
    CHECK(!apart.node_field("body_force")->for_ledger);
    CHECK(!apart.node_field("force")->for_ledger);
  }
  const Plan beside = plan_with({force}, surface);
  REQUIRE(beside.node_field("force"));
  CHECK(beside.node_field("point_load"));
  CHECK(!beside.node_field("force")->for_ledger);
  CHECK(!beside.node_field("body_force"));
}

TEST_CASE("a scene without contact holds and does nothing for it, whatever bodies and other choices it has", "[plan]") {
  const std::string apart =
      R"(/bodies=[{"name": "b", "material": "a", "geometry": {"type": "box", "lower": [0, 0], "upper": [0.5, 0.5]}},
                  {"name": "c", "material": "a", "geometry": {"type": "box", "lower": [0.5, 0], "upper": [1, 0.5]}}])";
  /// Fields, operators and fields of velocity beyond the first that contact has asked for.
  const auto asked = [&](std::vector<std::string> overrides) {
    overrides.insert(overrides.begin(), apart);
    const Plan plan = make_plan(mpm::test::experiment_from(block, overrides));
    long count = plan.velocity_fields - 1;
    const auto for_contact = [](const std::string& because) { return because.find("/contact") != because.npos; };
    for (const Field& field : plan.fields) count += field.for_contact || for_contact(field.because) ? 1 : 0;
    for_each_pass(plan.step, [&](const Pass& pass) {
      for (const Operator& operation : pass.operators) count += for_contact(operation.because) ? 1 : 0;
    });
    return count + (plan.does(Act::scatter_contact) ? 1 : 0) + (plan.does(Act::keep_contact_state) ? 1 : 0);
  };
  for (const std::string transfer : {"pic", "flip", "apic", "mls"})
    for (const std::string more :
         {"/output/ledger=false", "/output/ledger=true", R"(/filter={"type": "fmpm", "order": 3, "every_steps": 4})",
          "/solver/stress_update=averaged"})
      for (const std::string shape : {"linear", "bspline_quadratic", "cpdi"}) {
        INFO(transfer << " " << more << " " << shape);
        const std::vector<std::string> scene{"/transfer/type=" + transfer, "/shape/type=" + shape, more};
        CHECK(asked(scene) == 0);
        std::vector<std::string> with = scene;
        with.emplace_back(R"(/contact={"type": "coulomb", "friction": 0.3})");
        CHECK(asked(with) > 5);
      }
}
