// What transfers make of one particle's gathered moments, by the formulas of their papers, and what they promise.

#include <cmath>
#include <string>
#include <type_traits>
#include <utility>

#include "kernel/lanes.hpp"
#include "support/catch.hpp"
#include "transfers/aflip/aflip.hpp"
#include "transfers/apic/apic.hpp"
#include "transfers/asflip/asflip.hpp"
#include "transfers/flip/flip.hpp"
#include "transfers/mls/mls.hpp"
#include "transfers/pic/pic.hpp"
#include "transfers/polypic/polypic.hpp"
#include "transfers/rpic/rpic.hpp"
#include "transfers/tpic/tpic.hpp"

namespace {

using namespace mpm;
using namespace mpm::test;

/// The spin that RPIC makes of an affine field and a second moment.
template <int D, class T>
Mat<D, T> spin_of(const Mat<D, T>& affine, const Mat<D, T>& moment) {
  GatheredMoments<D, T> moments{};
  moments.affine = affine, moments.second_moment = moment;
  Vec<D, T> v{}, advection{};
  Rpic::State<D, T> state{};
  Rpic::gather<D, T>({}, moments, T(0), v, state, advection);
  return state.spin;
}

template <int D, class T>
Mat<D, T> multiple_of_identity(T value) {
  Mat<D, T> m{};
  for (int i = 0; i < D; ++i) m(i, i) = value;
  return m;
}

/// Largest entry of W M + M W - (C M - (C M)^T), which vanishes for the spin W of Jiang et al. 2015, section 5.2.
template <int D>
double spin_error(const Mat<D, double>& C, const Mat<D, double>& M) {
  const Mat<D, double> W = spin_of(C, M);
  double worst = 0;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) {
      double left = 0, right = 0;
      for (int k = 0; k < D; ++k) {
        left += W(i, k) * M(k, j) + M(i, k) * W(k, j);
        right += C(i, k) * M(k, j) - C(j, k) * M(k, i);
      }
      worst = larger(worst, larger(std::abs(left - right), std::abs(W(i, j) + W(j, i))));
    }
  return worst;
}

/// Largest W / w over moments from 1 down to nothing, W the spin that comes back of a spin w in any plane of two axes; a
/// NaN counts as 2.
template <int D, class T>
double largest_returned_spin() {
  double largest = 0;
  for (int halvings = 0; halvings <= 140; ++halvings) {
    const T moment = halvings == 140 ? T(0) : static_cast<T>(std::ldexp(1.0, -halvings));
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < i; ++j) {
        Mat<D, T> C{};
        C(i, j) = T(3), C(j, i) = T(-3);
        const double back = spin_of(C, multiple_of_identity<D>(moment))(i, j) / 3;
        largest = larger(largest, std::isfinite(back) && back >= 0 ? back : 2.0);
      }
  }
  return largest;
}

template <class Transfer>
bool replaces_motion() {
  return (Transfer::traits & MPM_REPLACES_MOTION) != 0;
}

/// The names of the transfers that have a trait.
std::string transfers_with(unsigned trait) {
  const std::pair<const char*, unsigned> transfers[] = {
      {"pic", Pic::traits},         {"flip", Flip::traits},   {"apic", Apic::traits},
      {"mls", Mls::traits},         {"tpic", Tpic::traits},   {"rpic", Rpic::traits},
      {"polypic", Polypic::traits}, {"aflip", Aflip::traits}, {"asflip", Asflip::traits}};
  std::string names;
  for (const auto& [name, traits] : transfers)
    if (traits & trait) names += (names.empty() ? "" : " ") + std::string(name);
  return names;
}

}  // namespace

TEST_CASE("RPIC's spin has the angular momentum of the gathered field, whatever the second moment") {
  CHECK(spin_error<2>({{1, 2, -3, 5}}, {{0.25, 0.1, 0.1, 0.75}}) <= 1e-14);
  CHECK(spin_error<2>({{-4, 1, 6, 2}}, {{1.5, -0.3, -0.3, 0.2}}) <= 1e-14);
  CHECK(spin_error<3>({{1, 2, -3, 5, 4, 0.5, -2, 7, 3}}, {{0.5, 0.1, -0.2, 0.1, 0.75, 0.05, -0.2, 0.05, 1.25}}) <=
        1e-14);
  CHECK(spin_error<3>({{0, -2, 4, 1, 3, -6, 8, 0.25, 1}}, {{2, -0.4, 0.3, -0.4, 1, 0.6, 0.3, 0.6, 0.7}}) <= 1e-14);
}

TEST_CASE("RPIC's spin fades where the second moment vanishes, and is never more than the field's") {
  CHECK(largest_returned_spin<2, double>() <= 1 + 1e-15);
  CHECK(largest_returned_spin<3, double>() <= 1 + 1e-15);
  CHECK(largest_returned_spin<2, float>() <= 1 + 3e-7);
  CHECK(largest_returned_spin<3, float>() <= 1 + 3e-7);
  // A particle at 1e-9 cells from a node of tents, with f (1 - f) = 1e-9, keeps its spin in double precision.
  Mat<2, double> C{};
  C(1, 0) = 3, C(0, 1) = -3;
  CHECK(std::abs(spin_of(C, multiple_of_identity<2>(1e-9))(1, 0) - 3) <= 1e-14);
}

TEST_CASE("transfers say whether velocity and state follow from what is gathered alone") {
  CHECK(replaces_motion<Pic>());
  CHECK(replaces_motion<Apic>());
  CHECK(replaces_motion<Mls>());
  CHECK(replaces_motion<Tpic>());
  CHECK(replaces_motion<Rpic>());
  CHECK(replaces_motion<Polypic>());
  CHECK_FALSE(replaces_motion<Flip>());
  CHECK_FALSE(replaces_motion<Aflip>());
  CHECK_FALSE(replaces_motion<Asflip>());
}

TEST_CASE("FLIP and AFLIP give back what a particle keeps and a share of PIC or APIC, by hand") {
  // u = (2, -1), the increment (0.5, 0.25), v = (4, 3): FLIP's velocity is (4.5, 3.25), and a quarter of the way from there to u
  // is (3.875, 2.1875).
  GatheredMoments<2, double> moments{};
  moments.velocity = {{2, -1}}, moments.velocity_increment = {{0.5, 0.25}}, moments.affine = {{1, 2, -3, 5}};
  Vec<2, double> v{{4, 3}}, advection{};
  Flip::State<2, double> none{};
  Flip::gather<2, double>({0.25}, moments, 0.1, v, none, advection);
  CHECK(v[0] == 3.875);
  CHECK(v[1] == 2.1875);
  CHECK(advection[0] == 2);
  CHECK(advection[1] == -1);
  Aflip::State<2, double> affine{};
  v = {{4, 3}}, advection = {};
  Aflip::gather<2, double>({0.25}, moments, 0.1, v, affine, advection);
  CHECK(v[0] == 3.875);
  CHECK(v[1] == 2.1875);
  CHECK(advection[0] == 2);
  CHECK(advection[1] == -1);
  for (int k = 0; k < 4; ++k) CHECK(affine.affine_velocity.m[k] == moments.affine.m[k]);
}

TEST_CASE("ASFLIP moves a particle by a share of what it keeps, the larger one where its surroundings open, by hand") {
  // As above v - u is (1.875, 3.1875). ln J goes from 0.01 by dt tr C, 0.1 times 0.1 in 2-D and 0.1 times 0.6 in 3-D.
  const auto check = [](auto dimension, double log_ratio, double threshold, double beta) {
    constexpr int D = decltype(dimension)::value;
    GatheredMoments<D, double> moments{};
    Vec<D, double> v{}, advection{};
    moments.velocity[0] = 2, moments.velocity[1] = -1, v[0] = 4, v[1] = 3;
    moments.velocity_increment[0] = 0.5, moments.velocity_increment[1] = 0.25;
    const double rates[] = {0.3, -0.2, 0.5};
    for (int i = 0; i < D; ++i) moments.affine(i, i) = rates[i];
    moments.affine(0, 1) = 7;
    Asflip::State<D, double> state{};
    state.log_volume_ratio = 0.01;
    Asflip::gather<D, double>({0.25, 0.25, 0.5, threshold}, moments, 0.1, v, state, advection);
    CAPTURE(D, threshold);
    CHECK(state.log_volume_ratio == Approx(log_ratio).epsilon(1e-14));
    CHECK(v[0] == 3.875);
    CHECK(v[1] == 2.1875);
    CHECK(advection[0] == Approx(2 + beta * 1.875).epsilon(1e-14));
    CHECK(advection[1] == Approx(-1 + beta * 3.1875).epsilon(1e-14));
    for (int k = 0; k < D * D; ++k) CHECK(state.affine_velocity.m[k] == moments.affine.m[k]);
  };
  const std::integral_constant<int, 2> plane;
  const std::integral_constant<int, 3> space;
  check(plane, 0.02, 0.025, 0.25);  // pressed together
  check(plane, 0.02, 0.015, 0.5);
  check(space, 0.07, 0.075, 0.25);
  check(space, 0.07, 0.065, 0.5);
}

TEST_CASE("transfers read of the grid what the formulas of their papers have") {
  CHECK(transfers_with(MPM_GATHERS_AFFINE) == "apic mls rpic polypic aflip asflip");
  CHECK(transfers_with(MPM_GATHERS_GRADIENT) == "tpic");
  CHECK(transfers_with(MPM_GATHERS_INCREMENT) == "flip aflip asflip");  // v- beside v+
  CHECK(transfers_with(MPM_SCATTERS_AFFINE) == "apic mls tpic rpic polypic aflip asflip");
  // Of what FLIP keeps beside it the affine part holds no energy: AFLIP and ASFLIP start it with the gradient alone.
  CHECK(transfers_with(MPM_AFFINE_CARRIES_ENERGY) == "apic mls tpic rpic polypic");
  CHECK(transfers_with(MPM_STARTS_WITH_GRADIENT) == "aflip asflip");
  CHECK(transfers_with(MPM_STRESS_BY_AFFINE) == "mls");
  CHECK(transfers_with(MPM_STRAIN_BY_AFFINE) == "mls");
  CHECK(transfers_with(MPM_READS_SECOND_MOMENT) == "rpic");
  CHECK(transfers_with(MPM_KEEPS_SPIN_ONLY) == "rpic");
}
