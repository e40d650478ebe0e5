#pragma once
// Makes the plugins that a scene chooses into one self-contained source text for exactly that scene: kernel headers,
// the functors' embedded text, and the entries. g++ (the host-run device) and NVRTC compile the same text.

#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "backends/device/fields.hpp"

namespace mpm::device {

/// The parts of a composition. `filter` and `contact` may be null; `materials` has at least one.
struct Choice {
  int dimension = 2;
  Precision precision = Precision::double_;
  bool axisymmetric = false;
  const Plugin* shape = nullptr;
  const Plugin* transfer = nullptr;
  const Plugin* filter = nullptr;
  const Plugin* contact = nullptr;
  const Plugin *normal = nullptr, *detection = nullptr;  ///< with contact; no detection where the law bypasses it
  std::vector<const Plugin*> materials;
  std::vector<const Plugin*> rigid_laws;            ///< of rigid bodies, each once (number_of_law)
  bool deterministic = false;                       ///< scatters sum to the same bits in any order of lanes
  bool contact_by_particles = false;                ///< nodes look at particles (kernels/contact_points.hpp)
  bool notes_contact = false;                       ///< what contact does at single nodes is written down
  bool loads_at_points = false;                     ///< particles carry loads that act beside them
  bool reactions = false;                           ///< what supports give is summed
  Advance advance = Advance::apart;                 ///< how particles go from one scatter to the next
  int basis_order = 0;                              ///< as in Plan
  std::string formulas;                             ///< functions of the scene (ParticleFormulas), empty without any
  std::vector<Field> node_fields, particle_fields;  ///< numbered (backends/device/fields.hpp); those of any one body

  /// The choice in words for messages: "2-D double: linear apic coulomb neo_hookean".
  std::string name() const;
};

/// The most values that a particle gives to a node in one scatter.
int most_channels(const Choice& choice);

/// The number of a rigid body's law among the choice's.
int number_of_law(const Experiment& experiment, std::size_t body);

/// The choice that a run of the experiment needs; its materials are in the experiment's order.
Choice choice_of(const Experiment& experiment, const Plan& plan);

/// Thrown when a functor's text cannot be composed; the message names the plugin, the line and the remedy.
class ComposeError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Composition {
  std::string name;                                            ///< name of the choice
  std::string text;                                            ///< C++17 without any #include
  std::string hash;                                            ///< SHA-256 of the text, hexadecimal
  std::vector<std::string> entries;                            ///< extern "C" names, one a phase
  std::vector<std::pair<std::string, std::string>> plugins{};  ///< name in compiler messages, and file
};

/// Composes the text of a choice. Throws ComposeError.
Composition compose(const Choice& choice);

/// The key of compiled code in a cache: it covers text, the compiler's name and version, and its options.
std::string cache_key(const Composition& composition, std::string_view compiler,
                      const std::vector<std::string>& options);

/// The text of an embedded kernel header ("kernel/math.hpp"), or null.
const char* embedded_header(std::string_view path);

}  // namespace mpm::device
