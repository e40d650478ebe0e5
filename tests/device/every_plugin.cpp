// Every plugin of the registry on the host-run device, against the reference backend.

#include "device/device_support.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::vector<std::string> precisions{"double", "float"};

/// Compiles compositions of these mixes in both precisions, side by side.
void prepare(const std::vector<Mix>& mixes, const std::vector<std::string>& in = precisions) {
  std::vector<device::Choice> choices;
  std::set<std::string> texts;
  for (const Mix& mix : mixes)
    for (const std::string& precision : in) {
      const device::Choice choice = device_choice_of(device_experiment(mix.text(), precision));
      if (texts.insert(device::compose(choice).hash).second) choices.push_back(choice);
    }
  Programs::shared().prepare(choices);
}

void check_every_pair(int dimension) {
  std::vector<Mix> mixes;
  const std::vector<std::string> orders{"last", "first", "modified_last", "averaged"};
  for (const Plugin* shape : plugins().of_kind(MPM_SHAPE))
    for (const Plugin* transfer : plugins().of_kind(MPM_TRANSFER)) {
      Mix mix = mix_with(*shape, dimension);
      mix.transfer = device_choice(*transfer);
      mix.stress_update = orders[mixes.size() % orders.size()];
      if (!is_refused(mix)) mixes.push_back(mix);
    }
  prepare(mixes, {"double"});
  for (const Mix& mix : mixes) check_on_device(mix, {"double"});
}

}  // namespace

TEST_CASE("every plugin runs on the host-run device as on the reference backend", "[device]") {
  std::vector<Mix> mixes;
  for (const Plugin& plugin : plugins().plugins())
    for (const int dimension : {2, 3}) mixes.push_back(mix_with(plugin, dimension));
  REQUIRE(mixes.size() >= 2 * 11);
  prepare(mixes);
  for (const Mix& mix : mixes) check_on_device(mix);
}

TEST_CASE("every shape runs with every transfer on the host-run device", "[device]") {
  check_every_pair(2);
}

TEST_CASE("every shape runs with every transfer on the host-run device in 3-D", "[device][slow]") {
  check_every_pair(3);
}
