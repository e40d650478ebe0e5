// Checks of contact detections: exchange of the bodies, bodies that move apart, and what their traits say.

#include <algorithm>
#include <array>

#include "conformance/support.hpp"

namespace mpm::conformance {
namespace {

/// What a node knows of two bodies along their normal, in cells: means lie inside edges, and particles end near them.
struct Seen {
  double mean_a, mean_b, edge_a, edge_b, surface_a, surface_b;
};
using AllSeen = std::array<Seen, full>;

AllSeen random_places(Random& random) {
  AllSeen all;
  for (Seen& seen : all) {
    const double face_a = random.uniform(-1, 1), face_b = face_a + random.uniform(-0.5, 1);
    seen.edge_a = face_a, seen.edge_b = face_b;
    seen.mean_a = face_a - random.uniform(0.2, 0.6), seen.mean_b = face_b + random.uniform(0.2, 0.6);
    seen.surface_a = face_a + random.uniform(-0.1, 0.1), seen.surface_b = face_b + random.uniform(-0.1, 0.1);
  }
  return all;
}

/// The same pairs seen from the other body.
AllSeen exchanged(AllSeen all) {
  for (Seen& seen : all)
    seen = {-seen.mean_b, -seen.mean_a, -seen.edge_b, -seen.edge_a, -seen.surface_b, -seen.surface_a};
  return all;
}

/// Body b farther along the normal, by a number of cells that float holds.
AllSeen parted(AllSeen all, double distance) {
  for (Seen& seen : all) seen.mean_b += distance, seen.edge_b += distance, seen.surface_b += distance;
  return all;
}

struct GapBatch {
  Variant variant;
  int count;
  Array mean_a, mean_b, edge_a, edge_b, surface_a, surface_b, gap;

  GapBatch(const Variant& v, const AllSeen& all, int entries) : variant(v), count(entries) {
    for (Array* values : {&mean_a, &mean_b, &edge_a, &edge_b, &surface_a, &surface_b, &gap})
      *values = Array(element_of(v), 1, static_cast<std::uint32_t>(entries));
    for (int lane = 0; lane < entries; ++lane) {
      const Seen& seen = all[lane];
      mean_a.set(0, lane, seen.mean_a), mean_b.set(0, lane, seen.mean_b);
      edge_a.set(0, lane, seen.edge_a), edge_b.set(0, lane, seen.edge_b);
      surface_a.set(0, lane, seen.surface_a), surface_b.set(0, lane, seen.surface_b);
    }
  }

  /// Hands over no more than the traits ask for.
  void find(const Plugin& plugin, const ParameterSample& parameters) {
    const mpm_detection& functions = plugin.detection();
    const auto given = [&](unsigned trait, Array& array) { return functions.traits & trait ? array.data() : nullptr; };
    const mpm_detection_batch batch{static_cast<std::uint32_t>(count),
                                    gap.stride(),
                                    given(MPM_READS_MEAN_POSITION, mean_a),
                                    given(MPM_READS_MEAN_POSITION, mean_b),
                                    given(MPM_READS_EDGES, edge_a),
                                    given(MPM_READS_EDGES, edge_b),
                                    given(MPM_READS_PARTICLE_SURFACES, surface_a),
                                    given(MPM_READS_PARTICLE_SURFACES, surface_b),
                                    gap.data()};
    functions.find[variant.precision](parameters.data(), &batch);
  }
};

GapBatch found_gaps(const Plugin& plugin, const Variant& v, const ParameterSample& parameters, const AllSeen& all,
                    int count = full) {
  GapBatch batch(v, all, count);
  batch.find(plugin, parameters);
  return batch;
}

/// Checks that gaps are numbers, that neither body comes first, and that bodies which move apart are no nearer.
void check_gaps(const Plugin& plugin, const GapBatch& b, const ParameterSample& parameters, const AllSeen& all,
                const std::string& where, Findings& findings) {
  const Variant& v = b.variant;
  const GapBatch e = found_gaps(plugin, v, parameters, exchanged(all)),
                 apart = found_gaps(plugin, v, parameters, parted(all, 0.25));
  Worst exchange, nearer;
  bool finite = true;
  for (int lane = 0; lane < full; ++lane) {
    const double gap = b.gap(0, lane);
    finite &= std::isfinite(gap);
    exchange.add(std::abs(e.gap(0, lane) - gap), lane);
    nearer.add(gap - apart.gap(0, lane), lane);
  }
  const double bound = 16 * v.epsilon();
  findings.require("finite_gap [" + v.name() + "]", finite, "a number for every pair" + where);
  findings.at_most("exchange_of_bodies", v, exchange, bound, "|gap of the exchanged pair - gap|, cells" + where);
  findings.at_most("moving_apart", v, nearer, bound, "gap less that of bodies 1/4 cell farther apart" + where);
}

void check_agreement(const GapBatch& b, const GapBatch& oracle, const std::string& where, Findings& findings) {
  Worst gap;
  for (int lane = 0; lane < full; ++lane) gap.add(std::abs(b.gap(0, lane) - oracle.gap(0, lane)), lane);
  findings.at_most("agrees_with_scalar", b.variant, gap, 64 * b.variant.epsilon(),
                   "|gap - gap of scalar double|" + where);
}

void check_batches(const Plugin& plugin, const GapBatch& whole, const ParameterSample& parameters, const AllSeen& all,
                   const std::string& where, Findings& findings) {
  constexpr int shift = 5;
  AllSeen moved = all;
  std::rotate(moved.begin(), moved.begin() + shift, moved.end());
  const GapBatch m = found_gaps(plugin, whole.variant, parameters, moved);
  bool guards = true, written = true, same = true, inputs = true;
  for (int count = MPM_LANES; count <= full; count += MPM_LANES) {
    const GapBatch untouched(whole.variant, all, count);
    const GapBatch b = found_gaps(plugin, whole.variant, parameters, all, count);
    guards &= b.gap.guards_intact(), written &= b.gap.all_written();
    inputs &= b.mean_a == untouched.mean_a && b.mean_b == untouched.mean_b && b.edge_a == untouched.edge_a &&
              b.edge_b == untouched.edge_b && b.surface_a == untouched.surface_a && b.surface_b == untouched.surface_b;
    for (int lane = 0; lane < count; ++lane)
      same &= b.gap(0, lane) == whole.gap(0, lane) && whole.gap(0, lane) == m.gap(0, (lane + full - shift) % full);
  }
  const std::string variant = " [" + whole.variant.name() + "]";
  findings.require("writes_inside_arrays" + variant, guards, "guards around the gaps" + where);
  findings.require("writes_every_output" + variant, written, "no gap is left out" + where);
  findings.require("inputs_untouched" + variant, inputs, "the places of both bodies" + where);
  findings.require("independent_of_batch" + variant, same,
                   "counts of 16 to 64, whichever pairs share the pack" + where);
}

/// Checks that what the traits ask for is read: what is summed for nobody should not be asked for.
void check_reads(const Plugin& plugin, const GapBatch& b, const ParameterSample& parameters, const AllSeen& all,
                 const std::string& where, Findings& findings) {
  const auto counts = [&](double Seen::*of_a, double Seen::*of_b) {
    AllSeen other = all;
    for (Seen& seen : other) seen.*of_a -= 0.125, seen.*of_b += 0.125;
    const GapBatch changed = found_gaps(plugin, b.variant, parameters, other);
    bool differs = false;
    for (int lane = 0; lane < full; ++lane) differs |= changed.gap(0, lane) != b.gap(0, lane);
    return differs;
  };
  const auto check = [&](unsigned trait, const char* name, double Seen::*of_a, double Seen::*of_b) {
    if (plugin.detection().traits & trait)
      findings.require(std::string("reads_") + name + " [" + b.variant.name() + "]", counts(of_a, of_b),
                       "a trait asks for it, and it changes no gap" + where);
  };
  check(MPM_READS_MEAN_POSITION, "mean_position", &Seen::mean_a, &Seen::mean_b);
  check(MPM_READS_EDGES, "edges", &Seen::edge_a, &Seen::edge_b);
  check(MPM_READS_PARTICLE_SURFACES, "particle_surfaces", &Seen::surface_a, &Seen::surface_b);
}

}  // namespace

void check_detection(const Plugin& plugin, Findings& findings) {
  Random random(20261128);
  for (const ParameterSample& parameters : sample_parameters(plugin, random))
    for (const Variant& v : variants_of(*plugin.descriptor)) {
      const std::string where = parameters.text.empty() ? "" : "; " + parameters.text;
      const AllSeen all = random_places(random);
      findings.running("gaps", v, where);
      const GapBatch b = found_gaps(plugin, v, parameters, all);
      check_gaps(plugin, b, parameters, all, where, findings);
      check_reads(plugin, b, parameters, all, where, findings);
      findings.running("batches", v, where);
      check_batches(plugin, b, parameters, all, where, findings);
      if (v.precision == MPM_SCALAR_DOUBLE || !(plugin.descriptor->precisions >> MPM_SCALAR_DOUBLE & 1)) continue;
      check_agreement(b, found_gaps(plugin, {MPM_SCALAR_DOUBLE, v.dimension}, parameters, all), where, findings);
    }
}

}  // namespace mpm::conformance
