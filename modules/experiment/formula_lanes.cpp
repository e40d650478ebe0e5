// The arithmetic of formulas in lanes. This file is compiled without contraction, so a point has the same bits wherever
// it stands in a batch, however long that is, and on every machine that the program is compiled for.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "experiment/formula_program.hpp"
#include "kernel/lanes.hpp"

namespace mpm::formula {
namespace {

constexpr int width = lane_bytes / static_cast<int>(sizeof(double));
static_assert(pack_size % width == 0);

typedef double Wide __attribute__((vector_size(lane_bytes)));
typedef std::uint64_t Bits __attribute__((vector_size(lane_bytes)));

constexpr std::uint64_t sign_bit = std::uint64_t(1) << 63;

inline Wide load(const Values& from, int p) {
  return *reinterpret_cast<const Wide*>(from.values + (p & from.mask));
}
inline void store(double* to, Wide value) {
  *reinterpret_cast<Wide*>(to) = value;
}
inline Wide all(double value) {
  return value - Wide{};
}
inline Wide magnitude(Wide a) {
  return (Wide)((Bits)a & ~sign_bit);
}
inline Wide one_where(Bits mask) {
  return (Wide)(mask & (Bits)all(1));
}
inline Wide choose(Bits mask, Wide yes, Wide no) {
  return (Wide)((mask & (Bits)yes) | (~mask & (Bits)no));
}

// ---- functions ------------------------------------------------------------------------------------------------------
// Reductions and polynomials are those of fdlibm (Sun Microsystems, 1993), whose errors are below 1 ulp; here for all
// lanes without a branch, and so in a range that holds almost every argument. The C library does the others.

/// Whole numbers are added to this to have them in the low bits.
constexpr double shifter = 0x1.8p52;

constexpr double largest_angle = 12000;  ///< rad, below 2^13 pi / 2

/// Sine and cosine for |x| <= largest_angle: pi / 2 in parts of 33 bits, whose multiples are exact.
inline void sine_and_cosine(Wide x, Wide& sine, Wide& cosine) {
  const Wide shifted = x * 0x1.45f306dc9c883p-1 + shifter, n = shifted - shifter;
  const Bits quadrant = (Bits)shifted;
  const Wide first = x - n * 1.57079632673412561417e+00, part = n * 6.07710050630396597660e-11;
  const Wide second = first - part, rest = n * 2.02226624879595063154e-21 - ((first - second) - part);
  const Wide r = second - rest, low = (second - r) - rest;
  const Wide z = r * r, cube = z * r;
  const Wide s =
      8.33333333332248946124e-03 +
      z * (-1.98412698298579493134e-04 +
           z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)));
  const Wide c = z * (4.16666666666666019037e-02 +
                      z * (-1.38888888888741095749e-03 +
                           z * (2.48015872894767294178e-05 +
                                z * (-2.75573143513906633035e-07 +
                                     z * (2.08757232129817482790e-09 - z * 1.13596475577881948265e-11)))));
  const Wide half = 0.5 * z, near_one = 1.0 - half;
  const Wide of_sine = r - ((z * (0.5 * low - cube * s) - low) - cube * -1.66666666666666324348e-01);
  const Wide of_cosine = near_one + (((1.0 - near_one) - half) + (z * c - r * low));
  const Bits swapped = -(quadrant & 1);
  sine = (Wide)((Bits)choose(swapped, of_cosine, of_sine) ^ ((quadrant & 2) << 62));
  cosine = (Wide)((Bits)choose(swapped, of_sine, of_cosine) ^ (((quadrant + 1) & 2) << 62));
}

constexpr double least_exponent = -708, largest_exponent = 709;

inline Wide exponential(Wide x) {
  const Wide shifted = x * 1.44269504088896338700 + shifter, n = shifted - shifter;
  const Wide high = x - n * 6.93147180369123816490e-01, low = n * 1.90821492927058770002e-10, r = high - low;
  const Wide t = r * r;
  const Wide c =
      r -
      t * (1.66666666666666019037e-01 +
           t * (-2.77777777770155933842e-03 +
                t * (6.61375632143793436117e-05 + t * (-1.65339022054652515390e-06 + t * 4.13813679705723846039e-08))));
  const Wide y = 1.0 - ((low - (r * c) / (2.0 - c)) - high);
  return (Wide)((Bits)y + (((Bits)shifted - (Bits)all(shifter)) << 52));
}

/// The natural logarithm of normal positive numbers.
inline Wide logarithm(Wide x) {
  constexpr std::uint64_t one = 0x3ff0000000000000, root_of_half = 0x3fe6a09e00000000;
  const Bits bits = (Bits)x + (one - root_of_half);
  const Wide mantissa = (Wide)((bits & 0x000fffffffffffff) + root_of_half);
  const Wide k = (Wide)((bits >> 52) | 0x4330000000000000) - (0x1p52 + 1023);
  const Wide f = mantissa - 1.0, s = f / (2.0 + f), z = s * s, w = z * z, half = 0.5 * f * f;
  const Wide odd = w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
  const Wide even =
      z * (6.666666666666735130e-01 +
           w * (2.857142874366239149e-01 + w * (1.818357216161805012e-01 + w * 1.479819860510058591e-01)));
  const Wide r = odd + even;
  return k * 6.93147180369123816490e-01 - ((half - (s * (half + r) + k * 1.90821492927058770002e-10)) - f);
}

/// The largest whole number not above x.
inline Wide floor_of(Wide x) {
  const Bits sign = (Bits)x & sign_bit;
  const Wide size = magnitude(x);
  const Wide near = (Wide)((Bits)((size + 0x1p52) - 0x1p52) | sign);
  const Wide below = near - one_where((Bits)(near > x));
  return choose((Bits)(size < 0x1p52), (Wide)((Bits)below | sign), x);
}

/// A number as the sum of two, of which the second is what the first has lost.
struct Sum {
  Wide high, low;
};

inline Sum product(Sum a, Sum b) {
  const auto split = [](Wide x) {  // into 26 and 27 bits, whose products are exact (Dekker 1971)
    const Wide t = x * 134217729.0, high = t - (t - x);
    return Sum{high, x - high};
  };
  const Wide p = a.high * b.high;
  const Sum x = split(a.high), y = split(b.high);
  const Wide lost = ((x.high * y.high - p) + x.high * y.low + x.low * y.high) + x.low * y.low;
  const Wide low = lost + (a.high * b.low + a.low * b.high), high = p + low;
  return {high, low - (high - p)};
}

inline Wide whole_power(Wide x, int exponent) {
  Sum square{x, Wide{}}, result{all(1), Wide{}};
  for (unsigned n = static_cast<unsigned>(std::abs(exponent));;) {
    if (n & 1) result = product(result, square);
    n >>= 1;
    if (n == 0) break;
    square = product(square, square);
  }
  if (exponent > 0) return result.high;
  const Wide inverse = 1.0 / result.high;
  return inverse - inverse * (result.low * inverse);
}

// ---- loops ----------------------------------------------------------------------------------------------------------

template <class Function>
void each(double* to, const Values& a, int lanes, Function function) {
  for (int p = 0; p < lanes; p += width) store(to + p, function(load(a, p)));
}

template <class Function>
void each(double* to, const Values& a, const Values& b, int lanes, Function function) {
  for (int p = 0; p < lanes; p += width) store(to + p, function(load(a, p), load(b, p)));
}

/// Leaves points beyond a range, and what is not a number, to `exact`.
template <class Function, class Exact>
void within(const Values& a, int lanes, double lower, double upper, Function function, Exact exact) {
  Bits outside{};
  for (int p = 0; p < lanes; p += width) {
    const Wide x = load(a, p);
    outside |= ~((Bits)(x >= lower) & (Bits)(x <= upper));
    function(x, p);
  }
  std::uint64_t any = 0;
  for (int i = 0; i < width; ++i) any |= outside[i];
  if (any == 0) return;
  for (int p = 0; p < lanes; ++p)
    if (const double x = a[p]; !(x >= lower && x <= upper)) exact(x, p);
}

void by_library(Operation operation, double* to, const Values& a, const Values& b, int lanes) {
  const Values& second = operands(operation) > 1 ? b : a;
  for (int p = 0; p < lanes; ++p) to[p] = value_of(operation, a[p], second[p], 0);
}

void sine(const Instruction& instruction, double* to, double* cosine_to, const Values& a, int lanes) {
  if (instruction.and_cosine)
    within(
        a, lanes, -largest_angle, largest_angle,
        [&](Wide x, int p) {
          Wide s, c;
          sine_and_cosine(x, s, c);
          store(to + p, s), store(cosine_to + p, c);
        },
        [&](double x, int p) { to[p] = std::sin(x), cosine_to[p] = std::cos(x); });
  else
    within(
        a, lanes, -largest_angle, largest_angle,
        [&](Wide x, int p) {
          Wide s, c;
          sine_and_cosine(x, s, c);
          store(to + p, s);
        },
        [&](double x, int p) { to[p] = std::sin(x); });
}

void cosine(double* to, const Values& a, int lanes) {
  within(
      a, lanes, -largest_angle, largest_angle,
      [&](Wide x, int p) {
        Wide s, c;
        sine_and_cosine(x, s, c);
        store(to + p, c);
      },
      [&](double x, int p) { to[p] = std::cos(x); });
}

void exponential(double* to, const Values& a, int lanes) {
  within(
      a, lanes, least_exponent, largest_exponent, [&](Wide x, int p) { store(to + p, exponential(x)); },
      [&](double x, int p) { to[p] = std::exp(x); });
}

void logarithm(double* to, const Values& a, int lanes) {
  constexpr double least = std::numeric_limits<double>::min(), largest = std::numeric_limits<double>::max();
  within(
      a, lanes, least, largest, [&](Wide x, int p) { store(to + p, logarithm(x)); },
      [&](double x, int p) { to[p] = std::log(x); });
}

/// Whole powers in lanes, as long as no part of a product is too large or too small to be split.
void whole_power(double* to, const Values& a, int exponent, int lanes) {
  constexpr double least = 1e-200, largest = 1e200;
  each(to, a, lanes, [&](Wide x) { return whole_power(x, exponent); });
  for (int p = 0; p < lanes; ++p)
    if (const double size = std::abs(to[p]); !(size >= least && size <= largest)) to[p] = std::pow(a[p], exponent);
}

void run_arithmetic(const Instruction& instruction, double* to, const Values& a, const Values& b, int lanes) {
  switch (instruction.operation) {
    case Operation::negate:
      return each(to, a, lanes, [](Wide x) { return -x; });
    case Operation::sqrt:
      return each(to, a, lanes, [](Wide x) {
        for (int i = 0; i < width; ++i) x[i] = std::sqrt(x[i]);
        return x;
      });
    case Operation::abs:
      return each(to, a, lanes, magnitude);
    case Operation::floor:
      return each(to, a, lanes, floor_of);
    case Operation::add:
      return each(to, a, b, lanes, [](Wide x, Wide y) { return x + y; });
    case Operation::subtract:
      return each(to, a, b, lanes, [](Wide x, Wide y) { return x - y; });
    case Operation::multiply:
      return each(to, a, b, lanes, [](Wide x, Wide y) { return x * y; });
    case Operation::divide:
      return each(to, a, b, lanes, [](Wide x, Wide y) { return x / y; });
    case Operation::min:
      return each(to, a, b, lanes, [](Wide x, Wide y) { return choose((Bits)(y < x), y, x); });
    case Operation::max:
      return each(to, a, b, lanes, [](Wide x, Wide y) { return choose((Bits)(x < y), y, x); });
    default:
      return by_library(instruction.operation, to, a, b, lanes);
  }
}

void run_comparison(const Instruction& instruction, double* to, const Values& a, const Values& b, const Values& c,
                    int lanes) {
  switch (instruction.operation) {
    case Operation::less:
      return each(to, a, b, lanes, [](Wide x, Wide y) { return one_where((Bits)(x < y)); });
    case Operation::greater:
      return each(to, a, b, lanes, [](Wide x, Wide y) { return one_where((Bits)(x > y)); });
    case Operation::less_or_equal:
      return each(to, a, b, lanes, [](Wide x, Wide y) { return one_where((Bits)(x <= y)); });
    case Operation::greater_or_equal:
      return each(to, a, b, lanes, [](Wide x, Wide y) { return one_where((Bits)(x >= y)); });
    case Operation::equal:
      return each(to, a, b, lanes, [](Wide x, Wide y) { return one_where((Bits)(x == y)); });
    case Operation::unequal:
      return each(to, a, b, lanes, [](Wide x, Wide y) { return one_where((Bits)(x != y)); });
    case Operation::both:
      return each(to, a, b, lanes, [](Wide x, Wide y) { return one_where((Bits)(x != 0.0) & (Bits)(y != 0.0)); });
    case Operation::either:
      return each(to, a, b, lanes, [](Wide x, Wide y) { return one_where((Bits)(x != 0.0) | (Bits)(y != 0.0)); });
    default:
      for (int p = 0; p < lanes; p += width) store(to + p, choose((Bits)(load(a, p) != 0.0), load(b, p), load(c, p)));
  }
}

}  // namespace

void Program::run(Space& space, int lanes) const {
  for (const Instruction& instruction : instructions_) {
    double* const to = space.registers[instruction.to].values;
    const Values a = find(instruction.of[0], space), b = find(instruction.of[1], space);
    switch (instruction.operation) {
      case Operation::sin:
        sine(instruction, to, space.registers[instruction.cosine_to].values, a, lanes);
        break;
      case Operation::cos:
        cosine(to, a, lanes);
        break;
      case Operation::exp:
        exponential(to, a, lanes);
        break;
      case Operation::log:
        logarithm(to, a, lanes);
        break;
      case Operation::whole_power:
        whole_power(to, a, instruction.exponent, lanes);
        break;
      case Operation::less:
      case Operation::greater:
      case Operation::less_or_equal:
      case Operation::greater_or_equal:
      case Operation::equal:
      case Operation::unequal:
      case Operation::both:
      case Operation::either:
      case Operation::choose:
        run_comparison(instruction, to, a, b, find(instruction.of[2], space), lanes);
        break;
      default:
        run_arithmetic(instruction, to, a, b, lanes);
    }
  }
}

}  // namespace mpm::formula
