// The arithmetic of formulas in lanes. This file is compiled without contraction, so a point has the same bits wherever
// it stands in a batch, however long that is, and on every machine that the program is compiled for.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "experiment/formula_program.hpp"
#include "kernel/lanes.hpp"

namespace mpm::formula {
namespace {

template <class T>
inline constexpr int width = Lanes<T>::width;
static_assert(pack_size<double> % width<double> == 0 && pack_size<float> % width<float> == 0);

template <class T>
using Wide = typename LaneTypes<T>::Vector;
template <class T>
using Bits = typename LaneTypes<T>::Bits;

template <class T>
constexpr bool is_float = sizeof(T) == 4;
template <class T>
constexpr int mantissa_bits = is_float<T> ? 23 : 52;
template <class T>
constexpr int last_bit = is_float<T> ? 31 : 63;
template <class T>
using Bit = std::make_unsigned_t<typename LaneTypes<T>::Integer>;
template <class T>
constexpr Bit<T> sign_bit = Bit<T>(1) << last_bit<T>;

template <class T>
inline Wide<T> load(const Values<T>& from, int p) {
  return *reinterpret_cast<const Wide<T>*>(from.values + (p & from.mask));
}
template <class T>
inline void store(T* to, Wide<T> value) {
  *reinterpret_cast<Wide<T>*>(to) = value;
}
template <class T>
inline Wide<T> all(T value) {
  return value - Wide<T>{};
}
template <class T>
inline Wide<T> magnitude(Wide<T> a) {
  return (Wide<T>)((Bits<T>)a & ~sign_bit<T>);
}
template <class T>
inline Wide<T> one_where(Bits<T> mask) {
  return (Wide<T>)(mask & (Bits<T>)all<T>(1));
}
template <class T>
inline Wide<T> choose(Bits<T> mask, Wide<T> yes, Wide<T> no) {
  return (Wide<T>)((mask & (Bits<T>)yes) | (~mask & (Bits<T>)no));
}

// ---- functions ------------------------------------------------------------------------------------------------------
// Polynomials are those of fdlibm (Sun Microsystems, 1993), in float those of its float functions (Cygnus Support, 1993);
// here for all lanes without a branch, and so in a range that holds almost every argument. The C library does the others.

/// Whole numbers are added to this to have them in the low bits.
template <class T>
constexpr T shifter = is_float<T> ? T(0x1.8p23) : T(0x1.8p52);

template <class T>
constexpr T largest_angle = is_float<T> ? T(800) : T(12000);  ///< rad, below 2^9 and 2^13 quarter turns

/// x less n quarter turns, of which the first parts have so few bits that their products with n are exact.
inline Wide<double> without_turns(Wide<double> x, Wide<double> n) {
  return ((x - n * 0x1.921fb54442000p+0) - n * 0x1.a308d31318000p-41) - n * 0x1.8a2e03707344ap-81;
}
inline Wide<float> without_turns(Wide<float> x, Wide<float> n) {
  return (((x - n * 0x1.921p+0f) - n * 0x1.f6ap-13f) - n * 0x1.11p-26f) - n * 0x1.68c234p-39f;
}

/// (sin r - r) / r^3 by z = r^2, |r| below an eighth of a turn.
inline Wide<double> sine_series(Wide<double> z) {
  return -1.66666666666666324348e-01 +
         z * (8.33333333332248946124e-03 +
              z * (-1.98412698298579493134e-04 +
                   z * (2.75573137070700676789e-06 +
                        z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10))));
}
inline Wide<float> sine_series(Wide<float> z) {
  return -1.6666667163e-01f + z * (8.3333337680e-03f + z * (-1.9841270114e-04f + z * 2.7557314297e-06f));
}
/// cos r - 1 + z / 2 by z = r^2.
inline Wide<double> cosine_series(Wide<double> z) {
  return z * (z * (4.16666666666666019037e-02 +
                   z * (-1.38888888888741095749e-03 +
                        z * (2.48015872894767294178e-05 +
                             z * (-2.75573143513906633035e-07 +
                                  z * (2.08757232129817482790e-09 - z * 1.13596475577881948265e-11))))));
}
inline Wide<float> cosine_series(Wide<float> z) {
  return z * (z * (4.1666667908e-02f + z * (-1.3888889225e-03f + z * (2.4801587642e-05f - z * 2.7557314297e-07f))));
}

/// Sine and cosine for |x| <= largest_angle.
template <class T>
inline void sine_and_cosine(Wide<T> x, Wide<T>& sine, Wide<T>& cosine) {
  const Wide<T> shifted = x * T(0x1.45f306dc9c883p-1) + shifter<T>, n = shifted - shifter<T>;
  const Bits<T> quadrant = (Bits<T>)shifted;
  const Wide<T> r = without_turns(x, n), z = r * r;
  const Wide<T> half = T(0.5) * z, near_one = T(1) - half;
  const Wide<T> of_sine =
      (Wide<T>)((Bits<T>)(r + (z * r) * sine_series(z)) | ((Bits<T>)r & sign_bit<T>));  // also of -0
  const Wide<T> of_cosine = near_one + (((T(1) - near_one) - half) + cosine_series(z));
  const Bits<T> swapped = -(quadrant & 1);
  constexpr int to_sign = last_bit<T> - 1;
  sine = (Wide<T>)((Bits<T>)choose<T>(swapped, of_cosine, of_sine) ^ ((quadrant & 2) << to_sign));
  cosine = (Wide<T>)((Bits<T>)choose<T>(swapped, of_sine, of_cosine) ^ (((quadrant + 1) & 2) << to_sign));
}

template <class T>
constexpr T least_exponent = is_float<T> ? T(-87) : T(-708);
template <class T>
constexpr T largest_exponent = is_float<T> ? T(88) : T(709);

/// r less the series of r coth(r / 2), by t = r^2, as the exponential needs it.
inline Wide<double> exponential_series(Wide<double> r, Wide<double> t) {
  return r - t * (1.66666666666666019037e-01 +
                  t * (-2.77777777770155933842e-03 +
                       t * (6.61375632143793436117e-05 +
                            t * (-1.65339022054652515390e-06 + t * 4.13813679705723846039e-08))));
}
inline Wide<float> exponential_series(Wide<float> r, Wide<float> t) {
  return r - t * (1.6666625440e-01f + t * -2.7667332906e-03f);
}

template <class T>
inline Wide<T> exponential(Wide<T> x) {
  constexpr T ln2_high = is_float<T> ? T(6.9314575195e-01) : T(6.93147180369123816490e-01);
  constexpr T ln2_low = is_float<T> ? T(1.4286067653e-06) : T(1.90821492927058770002e-10);
  const Wide<T> shifted = x * T(1.44269504088896338700) + shifter<T>, n = shifted - shifter<T>;
  const Wide<T> high = x - n * ln2_high, low = n * ln2_low, r = high - low;
  const Wide<T> c = exponential_series(r, r * r);
  const Wide<T> y = T(1) - ((low - (r * c) / (T(2) - c)) - high);
  return (Wide<T>)((Bits<T>)y + (((Bits<T>)shifted - (Bits<T>)all<T>(shifter<T>)) << mantissa_bits<T>));
}

/// log((1 + s) / (1 - s)) / s - 2 by z = s^2.
inline Wide<double> logarithm_series(Wide<double> z) {
  const Wide<double> w = z * z;
  const Wide<double> odd =
      w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
  const Wide<double> even =
      z * (6.666666666666735130e-01 +
           w * (2.857142874366239149e-01 + w * (1.818357216161805012e-01 + w * 1.479819860510058591e-01)));
  return odd + even;
}
inline Wide<float> logarithm_series(Wide<float> z) {
  const Wide<float> w = z * z;
  return w * (4.0000972152e-01f + w * 2.4279078841e-01f) + z * (6.6666662693e-01f + w * 2.8498786688e-01f);
}

/// The natural logarithm of normal positive numbers.
template <class T>
inline Wide<T> logarithm(Wide<T> x) {
  constexpr Bit<T> one = is_float<T> ? Bit<T>(0x3f800000) : Bit<T>(0x3ff0000000000000),
                   root_of_half = is_float<T> ? Bit<T>(0x3f3504f3) : Bit<T>(0x3fe6a09e00000000);
  constexpr Bit<T> mantissa_mask = (Bit<T>(1) << mantissa_bits<T>)-1;
  // A whole number in the low bits of this one is added to it.
  constexpr T base = is_float<T> ? T(0x1p23) : T(0x1p52);
  constexpr Bit<T> base_bits = is_float<T> ? Bit<T>(0x4b000000) : Bit<T>(0x4330000000000000);
  constexpr T bias = is_float<T> ? T(127) : T(1023);
  constexpr T ln2_high = is_float<T> ? T(6.9313812256e-01) : T(6.93147180369123816490e-01);
  constexpr T ln2_low = is_float<T> ? T(9.0580006145e-06) : T(1.90821492927058770002e-10);
  const Bits<T> bits = (Bits<T>)x + (one - root_of_half);
  const Wide<T> mantissa = (Wide<T>)((bits & mantissa_mask) + root_of_half);
  const Wide<T> k = (Wide<T>)((bits >> mantissa_bits<T>) | base_bits) - (base + bias);
  const Wide<T> f = mantissa - T(1), s = f / (T(2) + f), half = T(0.5) * f * f, r = logarithm_series(s * s);
  return k * ln2_high - ((half - (s * (half + r) + k * ln2_low)) - f);
}

/// The largest whole number not above x.
template <class T>
inline Wide<T> floor_of(Wide<T> x) {
  constexpr T whole = is_float<T> ? T(0x1p23) : T(0x1p52);  // no number from here on has a fraction
  const Bits<T> sign = (Bits<T>)x & sign_bit<T>;
  const Wide<T> size = magnitude<T>(x);
  const Wide<T> near = (Wide<T>)((Bits<T>)((size + whole) - whole) | sign);
  const Wide<T> below = near - one_where<T>((Bits<T>)(near > x));
  return choose<T>((Bits<T>)(size < whole), (Wide<T>)((Bits<T>)below | sign), x);
}

/// A number as the sum of two, of which the second is what the first has lost.
template <class T>
struct Sum {
  Wide<T> high, low;
};

template <class T>
inline Sum<T> product(Sum<T> a, Sum<T> b) {
  const auto split = [](Wide<T> x) {  // into halves whose products are exact (Dekker 1971)
    const Wide<T> t = x * (is_float<T> ? T(4097) : T(134217729)), high = t - (t - x);
    return Sum<T>{high, x - high};
  };
  const Wide<T> p = a.high * b.high;
  const Sum<T> x = split(a.high), y = split(b.high);
  const Wide<T> lost = ((x.high * y.high - p) + x.high * y.low + x.low * y.high) + x.low * y.low;
  const Wide<T> low = lost + (a.high * b.low + a.low * b.high), high = p + low;
  return {high, low - (high - p)};
}

template <class T>
inline Wide<T> whole_power(Wide<T> x, int exponent) {
  Sum<T> square{x, Wide<T>{}}, result{all<T>(1), Wide<T>{}};
  for (unsigned n = static_cast<unsigned>(std::abs(exponent));;) {
    if (n & 1) result = product(result, square);
    n >>= 1;
    if (n == 0) break;
    square = product(square, square);
  }
  if (exponent > 0) return result.high;
  const Wide<T> inverse = T(1) / result.high;
  return inverse - inverse * (result.low * inverse);
}

// ---- loops ----------------------------------------------------------------------------------------------------------

/// Calls visit(p) for the first point of every pack.
template <class T, class Visit>
inline void for_each_pack(int lanes, Visit visit) {
#pragma GCC unroll 4
  for (int p = 0; p < lanes; p += width<T>) visit(p);
}

/// The values of a pack, which are the same for all of them where `same`.
template <bool same, class T>
inline Wide<T> get(const Values<T>& values, int p) {
  return *reinterpret_cast<const Wide<T>*>(values.values + (same ? 0 : p));
}

template <class T, class Function>
void unary(const Step<T>& step, int lanes) {
  const Values<T> a = step.of[0];
  T* const to = step.to;
  for_each_pack<T>(lanes, [&](int p) { store<T>(to + p, Function{}(get<false>(a, p))); });
}

template <class T, class Function, bool same_a, bool same_b>
void binary(const Step<T>& step, int lanes) {
  const Values<T> a = step.of[0], b = step.of[1];
  T* const to = step.to;
  for_each_pack<T>(lanes, [&](int p) { store<T>(to + p, Function{}(get<same_a>(a, p), get<same_b>(b, p))); });
}

template <class T, class Function, class Next, bool same_a, bool same_b, bool same_c>
void chained(const Step<T>& step, int lanes) {
  const Values<T> a = step.of[0], b = step.of[1], c = step.of[2];
  T* const to = step.to;
  for_each_pack<T>(lanes, [&](int p) {
    store<T>(to + p, Next{}(Function{}(get<same_a>(a, p), get<same_b>(b, p)), get<same_c>(c, p)));
  });
}

/// Leaves points beyond a range, and what is not a number, to `exact`.
template <class T, class Function, class Exact>
void within(const Step<T>& step, int lanes, T lower, T upper, Function function, Exact exact) {
  const Values<T> a = step.of[0];
  Bits<T> outside{};
  for_each_pack<T>(lanes, [&](int p) {
    const Wide<T> x = get<false>(a, p);
    outside |= ~((Bits<T>)(x >= lower) & (Bits<T>)(x <= upper));
    function(x, p);
  });
  Bit<T> any = 0;
  for (int i = 0; i < width<T>; ++i) any |= outside[i];
  if (any == 0) return;
  for (int p = 0; p < lanes; ++p)
    if (const T x = a[p]; !(x >= lower && x <= upper)) exact(static_cast<double>(x), p);
}

template <class T, bool with_sine, bool with_cosine>
void circular(const Step<T>& step, int lanes) {
  T *const to = step.to, *const cosine_to = with_sine ? step.cosine_to : step.to;
  within<T>(
      step, lanes, -largest_angle<T>, largest_angle<T>,
      [&](Wide<T> x, int p) {
        Wide<T> sine, cosine;
        sine_and_cosine<T>(x, sine, cosine);
        if (with_sine) store<T>(to + p, sine);
        if (with_cosine) store<T>(cosine_to + p, cosine);
      },
      [&](double x, int p) {
        if (with_sine) to[p] = static_cast<T>(std::sin(x));
        if (with_cosine) cosine_to[p] = static_cast<T>(std::cos(x));
      });
}

template <class T>
void exponentials(const Step<T>& step, int lanes) {
  T* const to = step.to;
  within<T>(
      step, lanes, least_exponent<T>, largest_exponent<T>,
      [&](Wide<T> x, int p) { store<T>(to + p, exponential<T>(x)); },
      [&](double x, int p) { to[p] = static_cast<T>(std::exp(x)); });
}

template <class T>
void logarithms(const Step<T>& step, int lanes) {
  constexpr T least = std::numeric_limits<T>::min(), largest = std::numeric_limits<T>::max();
  T* const to = step.to;
  within<T>(
      step, lanes, least, largest, [&](Wide<T> x, int p) { store<T>(to + p, logarithm<T>(x)); },
      [&](double x, int p) { to[p] = static_cast<T>(std::log(x)); });
}

/// Whole powers in lanes, as long as no part of a product is too large or too small to be split.
template <class T>
void whole_powers(const Step<T>& step, int lanes) {
  constexpr T least = is_float<T> ? T(1e-20) : T(1e-200), largest = is_float<T> ? T(1e20) : T(1e200);
  T* const to = step.to;
  for_each_pack<T>(lanes, [&](int p) { store<T>(to + p, whole_power<T>(get<false>(step.of[0], p), step.exponent)); });
  for (int p = 0; p < lanes; ++p)
    if (const T size = std::abs(to[p]); !(size >= least && size <= largest))
      to[p] = static_cast<T>(std::pow(static_cast<double>(step.of[0][p]), step.exponent));
}

template <class T>
void square_root(const Step<T>& step, int lanes) {
  const T* const from = step.of[0].values;
  T* const __restrict to = step.to;
  for (int p = 0; p < lanes; ++p) to[p] = std::sqrt(from[p]);
}

template <class T>
void alternative(const Step<T>& step, int lanes) {
  const Values<T> condition = step.of[0], yes = step.of[1], no = step.of[2];
  for_each_pack<T>(lanes, [&](int p) {
    store<T>(step.to + p, choose<T>((Bits<T>)(load(condition, p) != T(0)), load(yes, p), load(no, p)));
  });
}

template <class T>
void by_library(const Step<T>& step, int lanes) {
  const Values<T> a = step.of[0], b = step.of[operands(step.operation) > 1 ? 1 : 0];
  for (int p = 0; p < lanes; ++p) step.to[p] = static_cast<T>(value_of(step.operation, a[p], b[p], 0));
}

// ---- choice ---------------------------------------------------------------------------------------------------------

/// What instructions do to packs.
template <class T>
struct Functions {
  using W = Wide<T>;
  using B = Bits<T>;
  static constexpr auto sum = [](W x, W y) { return x + y; };
  static constexpr auto difference = [](W x, W y) { return x - y; };
  static constexpr auto reversed_difference = [](W x, W y) { return y - x; };
  static constexpr auto simple_product = [](W x, W y) { return x * y; };
  static constexpr auto quotient = [](W x, W y) { return x / y; };
  static constexpr auto smaller = [](W x, W y) { return choose<T>((B)(y < x), y, x); };
  static constexpr auto larger = [](W x, W y) { return choose<T>((B)(x < y), y, x); };
  static constexpr auto less = [](W x, W y) { return one_where<T>((B)(x < y)); };
  static constexpr auto greater = [](W x, W y) { return one_where<T>((B)(x > y)); };
  static constexpr auto less_or_equal = [](W x, W y) { return one_where<T>((B)(x <= y)); };
  static constexpr auto greater_or_equal = [](W x, W y) { return one_where<T>((B)(x >= y)); };
  static constexpr auto equal = [](W x, W y) { return one_where<T>((B)(x == y)); };
  static constexpr auto unequal = [](W x, W y) { return one_where<T>((B)(x != y)); };
  static constexpr auto both = [](W x, W y) { return one_where<T>((B)(x != T(0)) & (B)(y != T(0))); };
  static constexpr auto either = [](W x, W y) { return one_where<T>((B)(x != T(0)) | (B)(y != T(0))); };
  static constexpr auto negative = [](W x) { return -x; };
  static constexpr auto size = [](W x) { return magnitude<T>(x); };
  static constexpr auto whole_below = [](W x) { return floor_of<T>(x); };
};

/// Which of the values of an instruction are the same at all points.
struct Same {
  bool a, b, c;
};

template <class T, class Function>
Work<T> binary_work(Function, Same same) {
  if (same.a) return &binary<T, Function, true, false>;
  return same.b ? &binary<T, Function, false, true> : &binary<T, Function, false, false>;
}

template <class T, class Function, class Next>
Work<T> chained_work(Function, Next, Same same) {
  if (same.a)
    return same.c ? &chained<T, Function, Next, true, false, true> : &chained<T, Function, Next, true, false, false>;
  if (same.b)
    return same.c ? &chained<T, Function, Next, false, true, true> : &chained<T, Function, Next, false, true, false>;
  return same.c ? &chained<T, Function, Next, false, false, true> : &chained<T, Function, Next, false, false, false>;
}

template <class T, class Function>
Work<T> arithmetic_work(Function function, Then then, Same same) {
  using F = Functions<T>;
  switch (then) {
    case Then::nothing:
      break;
    case Then::add:
      return chained_work<T>(function, F::sum, same);
    case Then::subtract:
      return chained_work<T>(function, F::difference, same);
    case Then::subtract_from:
      return chained_work<T>(function, F::reversed_difference, same);
    case Then::multiply:
      return chained_work<T>(function, F::simple_product, same);
  }
  return binary_work<T>(function, same);
}

template <class T>
Work<T> comparison_work(Operation operation, Same same) {
  using F = Functions<T>;
  switch (operation) {
    case Operation::less:
      return binary_work<T>(F::less, same);
    case Operation::greater:
      return binary_work<T>(F::greater, same);
    case Operation::less_or_equal:
      return binary_work<T>(F::less_or_equal, same);
    case Operation::greater_or_equal:
      return binary_work<T>(F::greater_or_equal, same);
    case Operation::equal:
      return binary_work<T>(F::equal, same);
    case Operation::unequal:
      return binary_work<T>(F::unequal, same);
    case Operation::both:
      return binary_work<T>(F::both, same);
    case Operation::either:
      return binary_work<T>(F::either, same);
    case Operation::choose:
      return &alternative<T>;
    default:
      return &by_library<T>;
  }
}

template <class T, class Function>
Work<T> unary_work(Function) {
  return &unary<T, Function>;
}

}  // namespace

template <class T>
Work<T> work_of(const Instruction& instruction) {
  using F = Functions<T>;
  const auto is_same = [&](int i) { return instruction.of[i].kind != Source::Kind::in_register; };
  const Same same{is_same(0), is_same(1), is_same(2)};
  switch (instruction.operation) {
    case Operation::negate:
      return unary_work<T>(F::negative);
    case Operation::abs:
      return unary_work<T>(F::size);
    case Operation::floor:
      return unary_work<T>(F::whole_below);
    case Operation::sqrt:
      return &square_root<T>;
    case Operation::sin:
      return instruction.and_cosine ? &circular<T, true, true> : &circular<T, true, false>;
    case Operation::cos:
      return &circular<T, false, true>;
    case Operation::exp:
      return &exponentials<T>;
    case Operation::log:
      return &logarithms<T>;
    case Operation::whole_power:
      return &whole_powers<T>;
    case Operation::add:
      return arithmetic_work<T>(F::sum, instruction.then, same);
    case Operation::subtract:
      return arithmetic_work<T>(F::difference, instruction.then, same);
    case Operation::multiply:
      return arithmetic_work<T>(F::simple_product, instruction.then, same);
    case Operation::divide:
      return binary_work<T>(F::quotient, same);
    case Operation::min:
      return binary_work<T>(F::smaller, same);
    case Operation::max:
      return binary_work<T>(F::larger, same);
    default:
      return comparison_work<T>(instruction.operation, same);
  }
}

template Work<double> work_of<double>(const Instruction&);
template Work<float> work_of<float>(const Instruction&);

}  // namespace mpm::formula
