#pragma once
// What the checks of all kinds share: guarded batch arrays, seeded inputs, parameter samples and the record of
// findings.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "conformance/conformance.hpp"
#include "kernel/tensor.hpp"
#include "plugin/extensions.h"

namespace mpm::conformance {

inline constexpr int full = MPM_BATCH;  ///< entries of a full batch

using Vector3 = Vec<3, double>;
using Matrix3 = Mat<3, double>;

Matrix3 transposed(const Matrix3& a);
Matrix3 scaled(const Matrix3& a, double factor);
Matrix3 sum(const Matrix3& a, const Matrix3& b);
Matrix3 inverse(const Matrix3& a);
/// The contraction a : b.
double contraction(const Matrix3& a, const Matrix3& b);
Vector3 product(const Matrix3& a, const Vector3& b);
double dot(const Vector3& a, const Vector3& b);
double magnitude(const Vector3& a);
double largest_difference(const Matrix3& a, const Matrix3& b);

/// One instantiation of a plugin: the entry that is called and the dimension it is called in.
struct Variant {
  mpm_precision precision = MPM_SCALAR_DOUBLE;
  int dimension = 2;

  bool single() const { return precision == MPM_LANES_FLOAT; }
  double epsilon() const { return single() ? 0x1p-23 : 0x1p-52; }
  int symmetric() const { return dimension == 2 ? 4 : 6; }
  std::string name() const;
};
/// Every precision and dimension the descriptor declares.
std::vector<Variant> variants_of(const mpm_descriptor& descriptor);

/// The largest of a series of errors; a NaN stays.
struct Worst {
  double value = 0;
  int lane = -1;
  void add(double error, int at = -1) {
    if (std::isnan(value) || error <= value) return;
    value = error;
    lane = at;
  }
};

/// Findings by name, each its worst case over repeated calls.
class Findings {
 public:
  explicit Findings(ConformanceProgress progress = {}) : progress_(std::move(progress)) {}

  /// Says what is run next: a group of checks, its variant, and the parameters (as `where` of the findings).
  void running(const std::string& group) const;
  void running(const char* group, const Variant& variant, const std::string& where) const;
  void at_most(const std::string& check, const Variant& variant, const Worst& measured, double bound,
               const std::string& detail);
  void at_most(const std::string& check, double measured, double bound, const std::string& detail);
  void require(const std::string& check, bool holds, const std::string& detail);
  /// Reports a number worth knowing that no bound applies to.
  void report(const std::string& check, double measured, const std::string& detail);
  std::vector<ConformanceFinding> take() { return std::move(findings_); }

 private:
  ConformanceProgress progress_;
  std::vector<ConformanceFinding> findings_;
};

/// Seeded numbers that do not depend on the standard library, all exactly representable as float, so that every
/// precision of a plugin can be given the same input.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double uniform(double low, double high);
  /// A number evenly spread over orders of magnitude.
  double logarithmic(double low, double high);
  Vector3 direction(int dimension);
  Matrix3 matrix(int dimension, double size);
  /// A rotation about a random axis; in 2-D about z. It is orthogonal to double rounding, so not representable as
  /// float.
  Matrix3 rotation(int dimension);

 private:
  std::uint64_t next();
  std::uint64_t state_;
};

enum class Element { single_precision, double_precision, index };
inline Element element_of(const Variant& v) {
  return v.single() ? Element::single_precision : Element::double_precision;
}

/// One batch array [component][stride] between guard bytes; lanes from count to stride are guards too.
class Array {
 public:
  Array() = default;
  Array(Element element, int components, std::uint32_t count);

  double operator()(int component, int lane) const;
  void set(int component, int lane, double value);
  void* data();
  const void* data() const { return const_cast<Array*>(this)->data(); }
  int components() const { return components_; }
  std::uint32_t stride() const { return stride_; }

  bool guards_intact() const;
  /// Whether no element still holds the bytes that the array was created with.
  bool all_written() const;
  bool operator==(const Array& other) const;

 private:
  struct alignas(64) Line {
    unsigned char bytes[64];
  };
  const unsigned char* element(int component, int lane) const;
  static constexpr int guard_lines = 4;

  Element element_ = Element::double_precision;
  int components_ = 0;
  std::uint32_t count_ = 0, stride_ = 0;
  std::vector<Line> lines_;
};

/// A filled parameter block, 8-byte doubles at the declared offsets.
struct ParameterSample {
  std::vector<double> block;
  std::string text;  ///< "youngs_modulus=1000 poisson_ratio=0.3"

  const void* data() const { return block.data(); }
};
/// Every combination of choices, with defaults where there are some and then with random values inside the ranges, none
/// of which the plugin refuses.
std::vector<ParameterSample> sample_parameters(const Plugin& plugin, Random& random);
/// What a plugin refuses of a block (mpm.refusal): the first refusal in plane strain, around an axis and in 3-D, as far as
/// it works there. Its `parameter` is null where nothing is.
mpm_refusal refusal_of(const Plugin& plugin, const ParameterSample& sample);
/// The place in a block of the parameter that a refusal names, or -1.
int place_of(const Plugin& plugin, const mpm_refusal& refusal);
/// The value of a parameter in a block, or `otherwise` when the plugin has none of that name.
double parameter_value(const Plugin& plugin, const ParameterSample& sample, std::string_view name, double otherwise);

/// What a new particle holds in one component of a state field.
double initial_value(const mpm_state& field, int component, int dimension);

/// Checks of the parameters that a plugin refuses.
void check_refusals(const Plugin& plugin, Findings& findings);
void check_shape(const Plugin& plugin, Findings& findings);
void check_list_shape(const Plugin& plugin, Findings& findings);
void check_transfer(const Plugin& plugin, Findings& findings);
void check_filter(const Plugin& plugin, Findings& findings);
void check_contact(const Plugin& plugin, Findings& findings);
void check_normal(const Plugin& plugin, Findings& findings);
void check_detection(const Plugin& plugin, Findings& findings);
void check_material(const Plugin& plugin, Findings& findings);
/// Checks the operation counts that a plugin of any kind says of itself.
void check_costs(const Plugin& plugin, Findings& findings);

}  // namespace mpm::conformance
