#include "conformance/support.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <sstream>

#include "plugin/extension_of.hpp"

namespace mpm::conformance {

// ---- small algebra -----------------------------------------------------------------------------------------------

Matrix3 transposed(const Matrix3& a) {
  Matrix3 r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r(i, j) = a(j, i);
  return r;
}

Matrix3 scaled(const Matrix3& a, double factor) {
  Matrix3 r;
  for (int k = 0; k < 9; ++k) r.m[k] = factor * a.m[k];
  return r;
}

Matrix3 sum(const Matrix3& a, const Matrix3& b) {
  Matrix3 r;
  for (int k = 0; k < 9; ++k) r.m[k] = a.m[k] + b.m[k];
  return r;
}

Matrix3 inverse(const Matrix3& a) {
  Matrix3 r;
  const double scale = 1 / determinant(a);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int p = (j + 1) % 3, q = (j + 2) % 3, s = (i + 1) % 3, t = (i + 2) % 3;
      r(i, j) = scale * (a(p, s) * a(q, t) - a(p, t) * a(q, s));
    }
  return r;
}

double contraction(const Matrix3& a, const Matrix3& b) {
  double r = 0;
  for (int k = 0; k < 9; ++k) r += a.m[k] * b.m[k];
  return r;
}

Vector3 product(const Matrix3& a, const Vector3& b) {
  Vector3 r{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r[i] += a(i, j) * b[j];
  return r;
}

double dot(const Vector3& a, const Vector3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double magnitude(const Vector3& a) {
  return std::sqrt(dot(a, a));
}

double largest_difference(const Matrix3& a, const Matrix3& b) {
  Worst worst;
  for (int k = 0; k < 9; ++k) worst.add(std::abs(a.m[k] - b.m[k]));
  return worst.value;
}

// ---- variants and findings ---------------------------------------------------------------------------------------

std::string Variant::name() const {
  static const char* const precisions[] = {"lanes float", "lanes double", "scalar double"};
  return std::string(precisions[precision]) + (dimension == 2 ? ", 2-D" : ", 3-D");
}

std::vector<Variant> variants_of(const mpm_descriptor& descriptor) {
  std::vector<Variant> variants;
  for (unsigned precision = 0; precision < MPM_PRECISIONS; ++precision)
    for (int dimension : {2, 3}) {
      const bool offered = (descriptor.precisions >> precision & 1) && (descriptor.dimensions >> (dimension - 2) & 1);
      if (offered) variants.push_back({static_cast<mpm_precision>(precision), dimension});
    }
  return variants;
}

void Findings::running(const std::string& group) const {
  if (progress_) progress_(group);
}

void Findings::running(const char* group, const Variant& variant, const std::string& where) const {
  running(std::string(group) + " [" + variant.name() + "]" + where);
}

void Findings::at_most(const std::string& check, const Variant& variant, const Worst& measured, double bound,
                       const std::string& detail) {
  at_most(check + " [" + variant.name() + "]", measured.value, bound,
          measured.lane < 0 ? detail : detail + ", lane " + std::to_string(measured.lane));
}

void Findings::at_most(const std::string& check, double measured, double bound, const std::string& detail) {
  const ConformanceFinding now{check, measured <= bound, measured, bound, detail};
  const auto earlier = std::find_if(findings_.begin(), findings_.end(),
                                    [&](const ConformanceFinding& finding) { return finding.check == check; });
  if (earlier == findings_.end()) return findings_.push_back(now);
  const auto severity = [](const ConformanceFinding& f) {
    return f.bound > 0 && std::isfinite(f.bound) ? f.measured / f.bound : f.measured;
  };
  const bool worse = earlier->passed != now.passed ? earlier->passed : severity(now) > severity(*earlier);
  if (worse) *earlier = now;
}

void Findings::require(const std::string& check, bool holds, const std::string& detail) {
  at_most(check, holds ? 0 : 1, 0, detail);
}

void Findings::report(const std::string& check, double measured, const std::string& detail) {
  at_most(check, measured, std::numeric_limits<double>::infinity(), detail);
}

// ---- random ------------------------------------------------------------------------------------------------------

std::uint64_t Random::next() {  // splitmix64: Steele, Lea & Flood (2014)
  std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

double Random::uniform(double low, double high) {
  const double unit = static_cast<double>(next() >> 11) * 0x1p-53;
  return static_cast<float>(low + (high - low) * unit);
}

double Random::logarithmic(double low, double high) {
  return static_cast<float>(std::exp(uniform(std::log(low), std::log(high))));
}

Vector3 Random::direction(int dimension) {
  for (;;) {
    Vector3 v{};
    for (int i = 0; i < dimension; ++i) v[i] = uniform(-1, 1);
    const double length = std::sqrt(dot(v, v));
    if (length < 0.1 || length > 1) continue;
    for (int i = 0; i < dimension; ++i) v[i] /= length;
    return v;
  }
}

Matrix3 Random::matrix(int dimension, double size) {
  Matrix3 r{};
  for (int i = 0; i < dimension; ++i)
    for (int j = 0; j < dimension; ++j) r(i, j) = uniform(-size, size);
  return r;
}

Matrix3 Random::rotation(int dimension) {  // by the formula of Rodrigues
  Vector3 axis{};
  axis[2] = 1;
  if (dimension == 3) axis = direction(3);
  const double angle = uniform(-3, 3), c = std::cos(angle), s = std::sin(angle);
  Matrix3 r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r(i, j) = (1 - c) * axis[i] * axis[j] + (i == j ? c : 0);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    r(j, i) += s * axis[k];
    r(k, i) -= s * axis[j];
  }
  return r;
}

// ---- arrays ------------------------------------------------------------------------------------------------------

namespace {
constexpr unsigned char guard_byte = 0xa5;
std::size_t bytes_of(Element element) {
  return element == Element::double_precision ? 8 : 4;
}
bool is_guard(const unsigned char* bytes, std::size_t size) {
  return std::all_of(bytes, bytes + size, [](unsigned char byte) { return byte == guard_byte; });
}
}  // namespace

Array::Array(Element element, int components, std::uint32_t count)
    : element_(element), components_(components), count_(count), stride_(count + MPM_LANES) {
  const std::size_t bytes = bytes_of(element) * components * stride_;
  lines_.resize((bytes + 63) / 64 + 2 * guard_lines);
  std::memset(static_cast<void*>(lines_.data()), guard_byte, lines_.size() * 64);
}

void* Array::data() {
  return lines_.empty() ? nullptr : lines_.data() + guard_lines;
}

const unsigned char* Array::element(int component, int lane) const {
  const std::size_t index = static_cast<std::size_t>(component) * stride_ + static_cast<std::size_t>(lane);
  return static_cast<const unsigned char*>(data()) + bytes_of(element_) * index;
}

double Array::operator()(int component, int lane) const {
  const unsigned char* source = element(component, lane);
  double value;
  float single;
  std::int32_t index;
  switch (element_) {
    case Element::double_precision:
      std::memcpy(&value, source, sizeof value);
      return value;
    case Element::single_precision:
      std::memcpy(&single, source, sizeof single);
      return single;
    default:
      std::memcpy(&index, source, sizeof index);
      return index;
  }
}

void Array::set(int component, int lane, double value) {
  unsigned char* target = const_cast<unsigned char*>(element(component, lane));
  const float single = static_cast<float>(value);
  if (element_ == Element::double_precision)
    std::memcpy(target, &value, sizeof value);
  else
    std::memcpy(target, &single, sizeof single);
}

bool Array::guards_intact() const {
  if (lines_.empty()) return true;
  const auto* first = lines_.data()->bytes;
  const auto* last = first + lines_.size() * 64;
  const auto* end = element(components_, 0);
  if (!is_guard(first, guard_lines * 64) || !is_guard(end, static_cast<std::size_t>(last - end))) return false;
  for (int c = 0; c < components_; ++c)
    if (!is_guard(element(c, static_cast<int>(count_)), bytes_of(element_) * (stride_ - count_))) return false;
  return true;
}

bool Array::all_written() const {
  for (int c = 0; c < components_; ++c)
    for (std::uint32_t lane = 0; lane < count_; ++lane)
      if (is_guard(element(c, static_cast<int>(lane)), bytes_of(element_))) return false;
  return true;
}

bool Array::operator==(const Array& other) const {
  if (lines_.size() != other.lines_.size()) return false;
  return lines_.empty() || std::memcmp(lines_.data(), other.lines_.data(), lines_.size() * 64) == 0;
}

// ---- parameters --------------------------------------------------------------------------------------------------

namespace {

int choices_in(const mpm_parameter& p) {
  return p.type == MPM_CHOICE ? 1 + static_cast<int>(std::count(p.choices, p.choices + std::strlen(p.choices), '|'))
                              : 1;
}

bool named(const mpm_parameter& p, const char* part) {
  return std::strstr(p.name, part) != nullptr;
}

/// A value of engineering size inside the declared range: by name where a name says more than the range.
double sensible_value(const mpm_parameter& p, double stiffness, Random& random) {
  if (named(p, "youngs_modulus")) return stiffness;
  if (named(p, "poisson")) return random.uniform(0, 0.45);
  if (named(p, "density")) return random.logarithmic(100, 10000);
  if (named(p, "tensile_strength")) return stiffness * random.logarithmic(1e-3, 0.03);
  if (std::strcmp(p.unit, "Pa") == 0) return stiffness * random.logarithmic(1e-3, 0.3);
  if (std::strcmp(p.unit, "Pa/m") == 0) return random.logarithmic(1e2, 1e9);  // from free to held in a step
  if (std::strcmp(p.unit, "Pa s") == 0) return random.logarithmic(1e-3, 1e4);
  const bool below = std::isfinite(p.minimum), above = std::isfinite(p.maximum);
  if (below && above) return random.uniform(p.minimum, p.maximum);
  if (named(p, "friction")) return random.uniform(0, 1);
  if (below) return p.minimum + random.logarithmic(0.1, 10);
  if (above) return p.maximum - random.logarithmic(0.1, 10);
  return random.uniform(-1, 1);
}

ParameterSample sample(const Plugin& plugin, int combination, bool defaults, Random& random) {
  ParameterSample s;
  s.block.assign(std::max<std::size_t>(1, (plugin.descriptor->parameter_bytes + 7) / 8), 0.0);
  const double stiffness = random.logarithmic(1e3, 1e9);
  std::ostringstream text;
  for (const mpm_parameter& p : plugin.parameters()) {
    double value = p.default_value;
    const int choices = choices_in(p);
    if (p.type == MPM_CHOICE)
      value = combination % choices;
    else if (p.type == MPM_BOOLEAN && !defaults)
      value = random.uniform(0, 1) < 0.5 ? 0 : 1;
    else if ((p.flags & MPM_REQUIRED) || !defaults)
      value = sensible_value(p, stiffness, random);
    if (p.type == MPM_INTEGER) value = std::round(value);
    combination /= choices;
    s.block[p.offset / sizeof(double)] = value;
    text << (text.tellp() > 0 ? " " : "") << p.name << "=" << value;
  }
  if (const auto* cell_size = extension_of<mpm_material_cell_size>(plugin)) {
    const double value = random.logarithmic(1e-3, 1);
    s.block[cell_size->offset / sizeof(double)] = value;
    text << " cell_size=" << value;
  }
  s.text = text.str();
  return s;
}

/// Moves values that the plugin refuses to the accepted side of their limits, well away from them.
void accept(const Plugin& plugin, Random& random, ParameterSample& sample) {
  constexpr int most = 32;
  for (int k = 0; k < most; ++k) {
    const mpm_refusal refusal = refusal_of(plugin, sample);
    const int place = place_of(plugin, refusal);
    if (place < 0 || !std::isfinite(refusal.limit)) return;
    double& value = sample.block[static_cast<std::size_t>(place)];
    const bool towards_zero = value > refusal.limit ? refusal.limit > 0 : refusal.limit < 0;
    value = refusal.limit * (towards_zero ? random.uniform(0.1, 0.5) : random.uniform(1.1, 2));
    sample.text += std::string(" ") + refusal.parameter + "=" + std::to_string(value);
  }
}

}  // namespace

mpm_refusal refusal_of(const Plugin& plugin, const ParameterSample& sample) {
  mpm_refusal refusal{nullptr, nullptr, 0};
  const auto* table = extension_of<mpm_refusals>(plugin);
  if (!table || !table->ask) return refusal;
  const bool around_axis =
      plugin.descriptor->kind == MPM_MATERIAL && (plugin.material().traits & MPM_STRAINS_AROUND_AXIS);
  for (const mpm_refusal_case& scene : {mpm_refusal_case{2, 0}, mpm_refusal_case{2, 1}, mpm_refusal_case{3, 0}}) {
    if (!(plugin.descriptor->dimensions & (scene.dimension == 2 ? MPM_2D : MPM_3D))) continue;
    if (scene.axisymmetric && !around_axis) continue;
    table->ask(sample.data(), &scene, &refusal);
    if (refusal.parameter) break;
  }
  return refusal;
}

int place_of(const Plugin& plugin, const mpm_refusal& refusal) {
  if (!refusal.parameter) return -1;
  for (const mpm_parameter& p : plugin.parameters())
    if (std::strcmp(p.name, refusal.parameter) == 0) return static_cast<int>(p.offset / sizeof(double));
  const auto* cells = extension_of<mpm_material_cell_size>(plugin);
  return cells && std::strcmp(refusal.parameter, "cell_size") == 0 ? static_cast<int>(cells->offset / sizeof(double))
                                                                   : -1;
}

std::vector<ParameterSample> sample_parameters(const Plugin& plugin, Random& random) {
  constexpr int most = 24;  // keeps a plugin with many choices checkable in seconds
  int combinations = 1;
  for (const mpm_parameter& p : plugin.parameters()) combinations = std::min(most / 2, combinations * choices_in(p));
  std::vector<ParameterSample> samples;
  for (int k = 0; k < combinations; ++k)
    for (bool defaults : {true, false}) {
      samples.push_back(sample(plugin, k, defaults, random));
      accept(plugin, random, samples.back());
    }
  return samples;
}

double parameter_value(const Plugin& plugin, const ParameterSample& sample, std::string_view name, double otherwise) {
  for (const mpm_parameter& p : plugin.parameters())
    if (name == p.name) return sample.block[p.offset / sizeof(double)];
  return otherwise;
}

double initial_value(const mpm_state& field, int component, int dimension) {
  if (field.initial != MPM_INITIAL_IDENTITY) return field.initial == MPM_INITIAL_ONE ? 1 : 0;
  if (field.shape == MPM_STATE_SYMMETRIC) return component < 3;
  if (field.shape == MPM_STATE_DEFORMATION && component == 4) return 1;  // zz in 2-D, yy in 3-D
  return component % (dimension + 1) == 0 &&
         (field.shape != MPM_STATE_DEFORMATION || component < dimension * dimension);
}

}  // namespace mpm::conformance
