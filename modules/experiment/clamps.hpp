#pragma once
// The clamps of a material that acted (extension mpm.material.clamps), each of which a run warns of once.

#include <span>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "plugin/extensions.h"

namespace mpm {

/// The clamps of one material with one set of parameters. Both must outlive it.
class ClampWatch {
 public:
  ClampWatch(const Plugin& material, const std::vector<double>& parameters);

  /// Whether there is a clamp that can act with these parameters and has not yet. Where none is, a look is for nothing.
  bool is_waiting() const;
  /// Looks at particles at a time (s); `acting` of the batch is the watch's own.
  void look(mpm_clamp_batch batch, double time);

  /// What was seen of a clamp when it first acted; no particles where it never did.
  struct Seen {
    double time = 0;
    long particles = 0;
  };
  std::span<const Seen> seen() const { return seen_; }
  void set_seen(std::span<const Seen> seen);

  /// Where each clamp that acted begins, and what it does.
  std::vector<std::string> acted() const;
  /// A sentence for each of them. `name` is the material's in the experiment.
  std::vector<std::string> warnings(const std::string& name) const;

  const Plugin& material() const { return *material_; }
  const std::vector<double>& parameters() const { return *parameters_; }

 private:
  std::string text_of(std::size_t clamp) const;

  const Plugin* material_;
  const std::vector<double>* parameters_;
  const mpm_material_clamps* table_;
  std::vector<double> bounds_;
  std::vector<Seen> seen_;
};

}  // namespace mpm
