// One launch takes particles from one scatter to the next where nothing looks at them between: when it may, that it does
// what launches apart do, and what it saves.

#include "backends/device/traffic.hpp"
#include "device/covering.hpp"
#include "support/temporary_folder.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const std::string no_ledger = R"(/output={"ledger": false})", with_ledger = R"(/output={"ledger": true})",
                  apart = R"(/solver/passes="separate")";

Mix with(const std::vector<std::string>& overrides, int dimension = 2) {
  Mix mix;
  mix.dimension = dimension, mix.overrides = overrides;
  return mix;
}

Advance advance_of(const Mix& mix) {
  return make_plan(device_experiment(mix.text(), "double", mix.overrides)).advance;
}

bool has_entry(const Mix& mix, const std::string& name) {
  const device::Choice choice = device_choice_of(device_experiment(mix.text(), "double", mix.overrides));
  const std::vector<std::string> entries = device::compose(choice).entries;
  return std::count(entries.begin(), entries.end(), name) > 0;
}

/// The largest difference of all particles after 14 steps, at once and apart, in epsilons.
double difference_to_apart(Mix mix, const std::string& precision) {
  INFO(mix.name() << " " << precision);
  mix.overrides.push_back(no_ledger);
  CHECK(advance_of(mix) == Advance::at_once);
  DeviceScene together(mix.text(), precision, {}, mix.overrides);
  mix.overrides.push_back(apart);
  CHECK(advance_of(mix) == Advance::apart);
  DeviceScene one_by_one(mix.text(), precision, {}, mix.overrides);
  together.run(), one_by_one.run();
  double worst = 0;
  for (int body = 0; body < 2; ++body)
    worst = larger(worst, state_difference(together.experiment, one_by_one.body(body), together.body(body)));
  return worst / epsilon_of(precision);
}

device::StepTraffic traffic_of(const Mix& mix) {
  device_setup();  // so that the usual devices are not set later
  const TemporaryFolder folder;
  setenv("MPM_CACHE", folder.path().c_str(), 1);
  const device::StepTraffic counted = device::count_traffic(device_experiment(mix.text(), "double", mix.overrides), 2);
  unsetenv("MPM_CACHE");
  use_usual_devices();
  return counted;
}

}  // namespace

TEST_CASE("particles advance in one launch unless something looks at them between", "[device][advance]") {
  CHECK(advance_of(with({no_ledger})) == Advance::at_once);
  CHECK(advance_of(with({with_ledger})) == Advance::unless_accounted);
  CHECK(advance_of(with({no_ledger, apart})) == Advance::apart);
  CHECK(advance_of(with({no_ledger, R"(/contact={"type": "coulomb", "friction": 0.2})"})) == Advance::at_once);
  CHECK(advance_of(with({no_ledger, R"(/filter={"type": "fmpm", "order": 2})"})) == Advance::at_once);
  CHECK(advance_of(with({no_ledger, R"(/shape={"type": "cpdi"})"})) == Advance::at_once);
  CHECK(advance_of(with({no_ledger, R"(/shape={"type": "cpdi2"})"})) == Advance::apart);
  CHECK(advance_of(with({no_ledger, R"(/solver/dilation="averaged")"})) == Advance::apart);
  for (const std::string order : {"first", "modified_last", "averaged"})
    CHECK(advance_of(with({no_ledger, set("/solver/stress_update", '"' + order + '"')})) == Advance::apart);
  CHECK(
      advance_of(with(
          {no_ledger,
           R"(/grips=[{"body": "a", "where": {"type": "half_space", "point": [0.22, 0], "normal": [1, 0]}, "velocity": [1, 0]}])"})) ==
      Advance::apart);
  Mix warm = warm_mix(2, R"({"type": "flip"})");
  warm.overrides.push_back(no_ledger);
  CHECK(advance_of(warm) == Advance::apart);

  // What is not launched is neither composed nor kept.
  CHECK(has_entry(with({no_ledger}), "mpm_advance_0"));
  for (const std::string phase : {"mpm_gather", "mpm_strain_0", "mpm_move"}) {
    CHECK(!has_entry(with({no_ledger}), phase));
    CHECK(has_entry(with({no_ledger, apart}), phase));
    CHECK(has_entry(with({with_ledger}), phase));
  }
  CHECK(has_entry(with({with_ledger}), "mpm_advance_0"));
  CHECK(!has_entry(with({no_ledger, apart}), "mpm_advance_0"));
  const auto fields =
      device_choice_of(device_experiment(with({no_ledger}).text(), "double", {no_ledger})).particle_fields;
  for (const std::string waits : {"velocity_gradient", "advection_velocity"}) {
    CHECK(device::number_of(fields, waits) < 0);
    const Mix mix = with({no_ledger, apart});
    CHECK(device::number_of(device_choice_of(device_experiment(mix.text(), "double", mix.overrides)).particle_fields,
                            waits) >= 0);
  }
}

TEST_CASE("particles that advance at once go where those of launches apart go", "[device][advance]") {
  for (const int dimension : {2, 3}) {
    Mix mix = with({}, dimension);
    CHECK(difference_to_apart(mix, "double") <= device_bound(mix));
    CHECK(difference_to_apart(mix, "float") <= device_bound(mix));
  }
  Mix contact = with({R"(/contact={"type": "coulomb", "friction": 0.2})"});
  contact.close = true, contact.transfer = R"({"type": "mls"})";
  contact.shape = R"({"type": "gimp_contiguous"})";
  contact.boundaries = R"({"all": "slip", "x_min": "periodic", "x_max": "periodic"})";
  CHECK(difference_to_apart(contact, "double") <= device_bound(contact));
  Mix filtered = with({R"(/filter={"type": "fmpm", "order": 3, "every_steps": 2})"});
  filtered.transfer = R"({"type": "flip"})", filtered.shape = R"({"type": "cpdi"})";
  CHECK(difference_to_apart(filtered, "double") <= device_bound(filtered));
  Mix by_mean = with({R"(/filter={"type": "fmpm", "order": 3, "every_steps": 2, "position_update": "mean_velocity"})"});
  by_mean.transfer = R"({"type": "flip"})";
  CHECK(difference_to_apart(by_mean, "double") <= device_bound(by_mean));
  Mix rings = with({set("/grid/symmetry", "axisymmetric"), set("/gravity", "[0, -1.3]"),
                    set("/materials/m/artificial_viscosity", "{}")});
  CHECK(difference_to_apart(rings, "double") <= device_bound(rings));
  Mix polynomials = with({});
  polynomials.transfer = R"({"type": "polypic", "basis": "full"})";
  CHECK(difference_to_apart(polynomials, "double") <= device_bound(polynomials));
}

// In three dimensions, in scalars a particle: apart, the gradient of the velocity and the velocity that moves it are
// written and read again (2 x 9, 2 x 3), the stress reads the deformation gradient (9) and writes the volume ratio once
// more (1), and the move and the search for blocks read the position once more each (2 x 3). What a launch reads beside
// particles makes some hundredths of a byte.
TEST_CASE("particles that advance at once cross memory once", "[device][advance][traffic]") {
  Mix mix = with({no_ledger}, 3);
  mix.transfer = R"({"type": "mls"})";
  const device::StepTraffic together = traffic_of(mix);
  mix.overrides.push_back(apart);
  const device::StepTraffic one_by_one = traffic_of(mix);
  const auto bytes = [](const device::StepTraffic& traffic, const std::vector<std::string>& kernels) {
    double sum = 0;
    for (const std::string& kernel : kernels) {
      const auto found = traffic.kernels.find(kernel);
      if (found != traffic.kernels.end()) sum += found->second.bytes();
    }
    return sum / (traffic.steps * static_cast<double>(traffic.particles));
  };
  const double before = bytes(one_by_one, {"gather", "strain_0", "move", "stress_0", "find_blocks"});
  const double after = bytes(together, {"advance_0", "gather", "strain_0", "move", "stress_0", "find_blocks"});
  std::printf("  bytes a particle-step between two scatters: %.1f apart, %.1f at once; of the step: %.1f and %.1f\n",
              before, after, one_by_one.bytes_per_particle_step(), together.bytes_per_particle_step());
  CHECK(before - after == Approx(8 * (2 * 9 + 2 * 3 + 9 + 1 + 2 * 3)).margin(1));
  CHECK(together.launches_per_step() == one_by_one.launches_per_step() - 2 * 4);  // two bodies
}

TEST_CASE("a run whose particles advance at once goes on from its checkpoint bit for bit", "[device][advance]") {
  for (const std::string precision : {"double", "float"})
    for (const std::string& output : {no_ledger, with_ledger}) {
      INFO(precision << " " << output);
      const std::vector<std::string> overrides{output};
      DeviceScene whole(Mix{}.text(), precision, {}, overrides), part(Mix{}.text(), precision, {}, overrides);
      const int half = 7;
      for (int k = 0; k < half; ++k) whole.simulation.step();
      ArchiveWriter archive;
      whole.simulation.save(archive);
      ArchiveReader reader(archive.bytes());
      part.simulation.restore(reader);
      CHECK(reader.at_end());
      for (int k = 0; k < half; ++k) whole.simulation.step(), part.simulation.step();
      for (int body = 0; body < 2; ++body) {
        const BodyState expected = whole.body(body), found = part.body(body);
        CHECK((found.position == expected.position));
        CHECK((found.velocity == expected.velocity));
        CHECK((found.material_state == expected.material_state));
        CHECK((found.transfer_state == expected.transfer_state));
      }
    }
}
