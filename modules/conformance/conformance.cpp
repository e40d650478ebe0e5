#include "conformance/conformance.hpp"

#include <cctype>
#include <cstring>
#include <sstream>

#include "conformance/support.hpp"

namespace mpm {
namespace {

using conformance::Findings;

bool lower_case_name(const char* name) {
  if (!name || !std::islower(static_cast<unsigned char>(*name))) return false;
  for (const char* c = name; *c; ++c)
    if (!std::islower(static_cast<unsigned char>(*c)) && !std::isdigit(static_cast<unsigned char>(*c)) && *c != '_')
      return false;
  return true;
}

bool default_in_range(const mpm_parameter& p) {
  const double x = p.default_value;
  if (p.flags & MPM_REQUIRED) return true;
  if (p.type == MPM_CHOICE || p.type == MPM_BOOLEAN) return x >= 0;
  const bool above = p.flags & MPM_ABOVE_MINIMUM ? x > p.minimum : x >= p.minimum;
  return above && (p.flags & MPM_BELOW_MAXIMUM ? x < p.maximum : x <= p.maximum);
}

/// Checks that what `mpm describe` prints is there, and that every entry which the descriptor offers exists.
void check_descriptor(const Plugin& plugin, Findings& findings) {
  const mpm_descriptor& d = *plugin.descriptor;
  findings.require("id_is_lower_case", lower_case_name(d.id), d.id);
  findings.require("summary_citation_manual", *d.summary && *d.citation && *d.manual, "texts are not empty");
  findings.require("functor_source", *d.functor_name && std::strstr(d.source, d.functor_name),
                   "the embedded source names the functor");
  for (const mpm_parameter& p : plugin.parameters()) {
    findings.require("parameter_names", lower_case_name(p.name), p.name);
    findings.require("parameter_docs", *p.doc != 0, p.name);
    findings.require("parameter_defaults", default_in_range(p), p.name);
  }
  for (const mpm_state& s : plugin.state()) {
    findings.require("state_names", lower_case_name(s.name), s.name);
    findings.require("state_docs", *s.doc != 0, s.name);
  }
}

bool has_entries(const Plugin& plugin, const conformance::Variant& v) {
  const int axis = v.dimension - 2;
  switch (plugin.descriptor->kind) {
    case MPM_SHAPE:
      return plugin.shape().form == MPM_NODE_LIST ? plugin.shape().evaluate_list[v.precision][axis] != nullptr
                                                  : plugin.shape().evaluate[v.precision] != nullptr;
    case MPM_TRANSFER:
      return plugin.transfer().scatter[v.precision][axis] && plugin.transfer().gather[v.precision][axis];
    case MPM_FILTER:
      return plugin.filter().update[v.precision][axis];
    case MPM_CONTACT:
      return plugin.contact().apply[v.precision][axis];
    case MPM_NORMAL:
      return plugin.normal().traits & MPM_LOOKS_AT_POINTS ? plugin.normal().from_points[axis] != nullptr
                                                          : plugin.normal().from_sums[v.precision][axis] != nullptr;
    case MPM_DETECTION:
      return plugin.detection().find[v.precision];
    case MPM_MATERIAL:
      return plugin.material().update[v.precision][axis];
    default:
      return false;
  }
}

}  // namespace

std::vector<ConformanceFinding> check_plugin(const Plugin& plugin, const ConformanceProgress& progress) {
  Findings findings(progress);
  check_descriptor(plugin, findings);
  findings.require("variants", !conformance::variants_of(*plugin.descriptor).empty(),
                   "at least one precision and one dimension is declared");
  bool callable = true;
  for (const conformance::Variant& v : conformance::variants_of(*plugin.descriptor)) callable &= has_entries(plugin, v);
  findings.require("entry_points", callable, "every declared precision and dimension has an entry point");
  if (!callable) return findings.take();
  conformance::check_refusals(plugin, findings);
  conformance::check_costs(plugin, findings);
  switch (plugin.descriptor->kind) {
    case MPM_SHAPE:
      conformance::check_shape(plugin, findings);
      break;
    case MPM_TRANSFER:
      conformance::check_transfer(plugin, findings);
      break;
    case MPM_FILTER:
      conformance::check_filter(plugin, findings);
      break;
    case MPM_CONTACT:
      conformance::check_contact(plugin, findings);
      break;
    case MPM_NORMAL:
      conformance::check_normal(plugin, findings);
      break;
    case MPM_DETECTION:
      conformance::check_detection(plugin, findings);
      break;
    case MPM_MATERIAL:
      conformance::check_material(plugin, findings);
      break;
    default:
      findings.require("kind", false, "kind " + std::to_string(plugin.descriptor->kind) + " has no checks");
  }
  return findings.take();
}

std::string to_string(const ConformanceFinding& finding) {
  std::ostringstream text;
  text << (finding.passed ? "passed " : "FAILED ") << finding.check << ": measured " << finding.measured << ", bound "
       << finding.bound;
  if (!finding.detail.empty()) text << " (" << finding.detail << ")";
  return text.str();
}

}  // namespace mpm
