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
// Polynomials are those of fdlibm (Sun Microsystems, 1993); here for all lanes without a branch, and so in a range that
// holds almost every argument. The C library does the others.

/// Whole numbers are added to this to have them in the low bits.
constexpr double shifter = 0x1.8p52;

constexpr double largest_angle = 12000;  ///< rad, below 2^13 pi / 2

/// Sine and cosine for |x| <= largest_angle: pi / 2 in parts of 40 bits, whose multiples up to 2^13 are exact.
inline void sine_and_cosine(Wide x, Wide& sine, Wide& cosine) {
  const Wide shifted = x * 0x1.45f306dc9c883p-1 + shifter, n = shifted - shifter;
  const Bits quadrant = (Bits)shifted;
  const Wide r = ((x - n * 0x1.921fb54442000p+0) - n * 0x1.a308d31318000p-41) - n * 0x1.8a2e03707344ap-81;
  const Wide z = r * r;
  const Wide s =
      -1.66666666666666324348e-01 +
      z * (8.33333333332248946124e-03 +
           z * (-1.98412698298579493134e-04 +
                z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10))));
  const Wide c = z * (4.16666666666666019037e-02 +
                      z * (-1.38888888888741095749e-03 +
                           z * (2.48015872894767294178e-05 +
                                z * (-2.75573143513906633035e-07 +
                                     z * (2.08757232129817482790e-09 - z * 1.13596475577881948265e-11)))));
  const Wide half = 0.5 * z, near_one = 1.0 - half;
  const Wide of_sine = (Wide)((Bits)(r + (z * r) * s) | ((Bits)r & sign_bit));  // also of -0
  const Wide of_cosine = near_one + (((1.0 - near_one) - half) + z * c);
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

/// Calls visit(p) for the first point of every pack.
template <class Visit>
inline void for_each_pack(int lanes, Visit visit) {
#pragma GCC unroll 4
  for (int p = 0; p < lanes; p += width) visit(p);
}

/// The values of a pack, which are the same for all of them where `same`.
template <bool same>
inline Wide get(const Values& values, int p) {
  return *reinterpret_cast<const Wide*>(values.values + (same ? 0 : p));
}

template <class Function>
void unary(const Step& step, int lanes) {
  const Values a = step.of[0];
  double* const to = step.to;
  for_each_pack(lanes, [&](int p) { store(to + p, Function{}(get<false>(a, p))); });
}

template <class Function, bool same_a, bool same_b>
void binary(const Step& step, int lanes) {
  const Values a = step.of[0], b = step.of[1];
  double* const to = step.to;
  for_each_pack(lanes, [&](int p) { store(to + p, Function{}(get<same_a>(a, p), get<same_b>(b, p))); });
}

template <class Function, class Next, bool same_a, bool same_b, bool same_c>
void chained(const Step& step, int lanes) {
  const Values a = step.of[0], b = step.of[1], c = step.of[2];
  double* const to = step.to;
  for_each_pack(lanes, [&](int p) {
    store(to + p, Next{}(Function{}(get<same_a>(a, p), get<same_b>(b, p)), get<same_c>(c, p)));
  });
}

/// Leaves points beyond a range, and what is not a number, to `exact`.
template <class Function, class Exact>
void within(const Step& step, int lanes, double lower, double upper, Function function, Exact exact) {
  const Values a = step.of[0];
  Bits outside{};
  for_each_pack(lanes, [&](int p) {
    const Wide x = get<false>(a, p);
    outside |= ~((Bits)(x >= lower) & (Bits)(x <= upper));
    function(x, p);
  });
  std::uint64_t any = 0;
  for (int i = 0; i < width; ++i) any |= outside[i];
  if (any == 0) return;
  for (int p = 0; p < lanes; ++p)
    if (const double x = a[p]; !(x >= lower && x <= upper)) exact(x, p);
}

template <bool with_sine, bool with_cosine>
void circular(const Step& step, int lanes) {
  double *const to = step.to, *const cosine_to = with_sine ? step.cosine_to : step.to;
  within(
      step, lanes, -largest_angle, largest_angle,
      [&](Wide x, int p) {
        Wide sine, cosine;
        sine_and_cosine(x, sine, cosine);
        if (with_sine) store(to + p, sine);
        if (with_cosine) store(cosine_to + p, cosine);
      },
      [&](double x, int p) {
        if (with_sine) to[p] = std::sin(x);
        if (with_cosine) cosine_to[p] = std::cos(x);
      });
}

void exponential(const Step& step, int lanes) {
  double* const to = step.to;
  within(
      step, lanes, least_exponent, largest_exponent, [&](Wide x, int p) { store(to + p, exponential(x)); },
      [&](double x, int p) { to[p] = std::exp(x); });
}

void logarithm(const Step& step, int lanes) {
  constexpr double least = std::numeric_limits<double>::min(), largest = std::numeric_limits<double>::max();
  double* const to = step.to;
  within(
      step, lanes, least, largest, [&](Wide x, int p) { store(to + p, logarithm(x)); },
      [&](double x, int p) { to[p] = std::log(x); });
}

/// Whole powers in lanes, as long as no part of a product is too large or too small to be split.
void whole_power(const Step& step, int lanes) {
  constexpr double least = 1e-200, largest = 1e200;
  double* const to = step.to;
  for_each_pack(lanes, [&](int p) { store(to + p, whole_power(get<false>(step.of[0], p), step.exponent)); });
  for (int p = 0; p < lanes; ++p)
    if (const double size = std::abs(to[p]); !(size >= least && size <= largest))
      to[p] = std::pow(step.of[0][p], step.exponent);
}

void square_root(const Step& step, int lanes) {
  const double* const from = step.of[0].values;
  double* const __restrict to = step.to;
  for (int p = 0; p < lanes; ++p) to[p] = std::sqrt(from[p]);
}

void alternative(const Step& step, int lanes) {
  const Values condition = step.of[0], yes = step.of[1], no = step.of[2];
  for_each_pack(
      lanes, [&](int p) { store(step.to + p, choose((Bits)(load(condition, p) != 0.0), load(yes, p), load(no, p))); });
}

void by_library(const Step& step, int lanes) {
  const Values a = step.of[0], b = step.of[operands(step.operation) > 1 ? 1 : 0];
  for (int p = 0; p < lanes; ++p) step.to[p] = value_of(step.operation, a[p], b[p], 0);
}

// ---- choice ---------------------------------------------------------------------------------------------------------

constexpr auto sum = [](Wide x, Wide y) { return x + y; };
constexpr auto difference = [](Wide x, Wide y) { return x - y; };
constexpr auto reversed_difference = [](Wide x, Wide y) { return y - x; };
constexpr auto simple_product = [](Wide x, Wide y) { return x * y; };
constexpr auto quotient = [](Wide x, Wide y) { return x / y; };
constexpr auto smaller = [](Wide x, Wide y) { return choose((Bits)(y < x), y, x); };
constexpr auto larger = [](Wide x, Wide y) { return choose((Bits)(x < y), y, x); };
constexpr auto less = [](Wide x, Wide y) { return one_where((Bits)(x < y)); };
constexpr auto greater = [](Wide x, Wide y) { return one_where((Bits)(x > y)); };
constexpr auto less_or_equal = [](Wide x, Wide y) { return one_where((Bits)(x <= y)); };
constexpr auto greater_or_equal = [](Wide x, Wide y) { return one_where((Bits)(x >= y)); };
constexpr auto equal = [](Wide x, Wide y) { return one_where((Bits)(x == y)); };
constexpr auto unequal = [](Wide x, Wide y) { return one_where((Bits)(x != y)); };
constexpr auto both = [](Wide x, Wide y) { return one_where((Bits)(x != 0.0) & (Bits)(y != 0.0)); };
constexpr auto either = [](Wide x, Wide y) { return one_where((Bits)(x != 0.0) | (Bits)(y != 0.0)); };
constexpr auto negative = [](Wide x) { return -x; };
constexpr auto size = [](Wide x) { return magnitude(x); };
constexpr auto whole_below = [](Wide x) { return floor_of(x); };

/// Which of the values of an instruction are the same at all points.
struct Same {
  bool a, b, c;
};

template <class Function>
Work binary_work(Function, Same same) {
  if (same.a) return &binary<Function, true, false>;
  return same.b ? &binary<Function, false, true> : &binary<Function, false, false>;
}

template <class Function, class Next>
Work chained_work(Function, Next, Same same) {
  if (same.a)
    return same.c ? &chained<Function, Next, true, false, true> : &chained<Function, Next, true, false, false>;
  if (same.b)
    return same.c ? &chained<Function, Next, false, true, true> : &chained<Function, Next, false, true, false>;
  return same.c ? &chained<Function, Next, false, false, true> : &chained<Function, Next, false, false, false>;
}

template <class Function>
Work arithmetic_work(Function function, Then then, Same same) {
  switch (then) {
    case Then::nothing:
      break;
    case Then::add:
      return chained_work(function, sum, same);
    case Then::subtract:
      return chained_work(function, difference, same);
    case Then::subtract_from:
      return chained_work(function, reversed_difference, same);
    case Then::multiply:
      return chained_work(function, simple_product, same);
  }
  return binary_work(function, same);
}

Work comparison_work(Operation operation, Same same) {
  switch (operation) {
    case Operation::less:
      return binary_work(less, same);
    case Operation::greater:
      return binary_work(greater, same);
    case Operation::less_or_equal:
      return binary_work(less_or_equal, same);
    case Operation::greater_or_equal:
      return binary_work(greater_or_equal, same);
    case Operation::equal:
      return binary_work(equal, same);
    case Operation::unequal:
      return binary_work(unequal, same);
    case Operation::both:
      return binary_work(both, same);
    case Operation::either:
      return binary_work(either, same);
    case Operation::choose:
      return &alternative;
    default:
      return &by_library;
  }
}

template <class Function>
Work unary_work(Function) {
  return &unary<Function>;
}

}  // namespace

Work work_of(const Instruction& instruction) {
  const auto is_same = [&](int i) { return instruction.of[i].kind != Source::Kind::in_register; };
  const Same same{is_same(0), is_same(1), is_same(2)};
  switch (instruction.operation) {
    case Operation::negate:
      return unary_work(negative);
    case Operation::abs:
      return unary_work(size);
    case Operation::floor:
      return unary_work(whole_below);
    case Operation::sqrt:
      return &square_root;
    case Operation::sin:
      return instruction.and_cosine ? &circular<true, true> : &circular<true, false>;
    case Operation::cos:
      return &circular<false, true>;
    case Operation::exp:
      return &exponential;
    case Operation::log:
      return &logarithm;
    case Operation::whole_power:
      return &whole_power;
    case Operation::add:
      return arithmetic_work(sum, instruction.then, same);
    case Operation::subtract:
      return arithmetic_work(difference, instruction.then, same);
    case Operation::multiply:
      return arithmetic_work(simple_product, instruction.then, same);
    case Operation::divide:
      return binary_work(quotient, same);
    case Operation::min:
      return binary_work(smaller, same);
    case Operation::max:
      return binary_work(larger, same);
    default:
      return comparison_work(instruction.operation, same);
  }
}

}  // namespace mpm::formula
