// Every plugin of the registry on the host-run device, against the reference backend: in every run several in one scene, in
// the slow part each in scenes of its own, and with each other.

#include "device/covering.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::vector<std::string> precisions{"double", "float"};

/// Compiles compositions of these mixes in both precisions, side by side.
void prepare(const std::vector<Mix>& mixes, const std::vector<std::string>& in = precisions) {
  if (!makes_all_checks()) return;
  std::vector<device::Choice> choices;
  std::set<std::string> texts;
  for (const Mix& mix : mixes)
    for (const std::string& precision : in) {
      const device::Choice choice = device_choice_of(device_experiment(mix.text(), precision));
      if (texts.insert(device::compose(choice).hash).second) choices.push_back(choice);
    }
  Programs::shared().prepare(choices);
}

/// Shapes with transfers, every so manieth pair: 1 for all.
void check_pairs(int dimension, std::size_t every) {
  std::vector<Mix> mixes;
  const std::vector<std::string> orders{"last", "first", "modified_last", "averaged"};
  const auto shapes = plugins().of_kind(MPM_SHAPE), transfers = plugins().of_kind(MPM_TRANSFER);
  for (std::size_t s = 0; s < shapes.size(); ++s)
    for (std::size_t t = 0; t < transfers.size(); ++t) {
      if ((s + t) % every != 0) continue;
      Mix mix = mix_with(*shapes[s], dimension);
      mix.transfer = device_choice(*transfers[t]);
      mix.stress_update = orders[mixes.size() % orders.size()];
      if (!is_refused(mix)) mixes.push_back(mix);
    }
  prepare(mixes, {"double"});
  for (const Mix& mix : mixes) check_on_device(mix, {"double"});
}

/// Whether the plan of the mix has this plugin.
bool holds(const Mix& mix, const Plugin& plugin) {
  const Experiment experiment = experiment_from(mix.text());
  std::vector<const Plugin*> held{experiment.shape.plugin, experiment.transfer.plugin};
  if (experiment.filter) held.push_back(experiment.filter->plugin);
  if (experiment.contact) held.push_back(experiment.contact->plugin);
  if (experiment.contact_normal) held.push_back(experiment.contact_normal->plugin);
  if (experiment.contact_detection) held.push_back(experiment.contact_detection->plugin);
  for (const MaterialSpecification& material : experiment.materials) held.push_back(material.component.plugin);
  return std::count(held.begin(), held.end(), &plugin) > 0;
}

}  // namespace

TEST_CASE("every plugin runs on the host-run device as on the reference backend", "[device]") {
  std::vector<Mix> mixes;
  for (const int dimension : {2, 3}) {
    const std::vector<Mix> once = every_plugin_once(dimension);
    for (const Plugin& plugin : plugins().plugins()) {
      INFO(plugin.id() << " in " << dimension << "-D");
      CHECK(std::any_of(once.begin(), once.end(), [&](const Mix& mix) { return holds(mix, plugin); }));
    }
    mixes.insert(mixes.end(), once.begin(), once.end());
  }
  prepare(mixes);
  for (const Mix& mix : mixes) check_on_device(mix);
}

TEST_CASE("every plugin by itself runs on the host-run device as on the reference backend", "[device][slow]") {
  std::vector<Mix> mixes;
  for (const Plugin& plugin : plugins().plugins())
    for (const int dimension : {2, 3}) mixes.push_back(mix_with(plugin, dimension));
  REQUIRE(mixes.size() >= 2 * 11);
  prepare(mixes);
  for (const Mix& mix : mixes) check_on_device(mix);
}

TEST_CASE("every shape runs with a third of the transfers on the host-run device", "[device]") {
  check_pairs(2, 3);
}

TEST_CASE("every shape runs with every transfer on the host-run device", "[device][slow]") {
  check_pairs(2, 1);
}

TEST_CASE("every shape runs with every transfer on the host-run device in 3-D", "[device][slow]") {
  check_pairs(3, 1);
}
