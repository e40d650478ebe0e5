// Normals from volume gradients, one pair at a time, by hand: the larger gradient, the mean of equal ones, and each body's own.

#include <cmath>

#include "normals/own_gradient/own_gradient.hpp"
#include "normals/volume_gradient/volume_gradient.hpp"
#include "support/catch.hpp"

namespace {

using namespace mpm;

template <class Normal>
NormalResult<2, double> result(const Vec<2, double>& gradient_a, const Vec<2, double>& gradient_b) {
  NormalPair<2, double> pair{};
  pair.volume_gradient_a = gradient_a, pair.volume_gradient_b = gradient_b;
  NormalResult<2, double> found{};
  Normal::find({}, pair, found);
  return found;
}

void check(const Vec<2, double>& found, double x, double y) {
  CHECK(found[0] == Approx(x).margin(1e-15));
  CHECK(found[1] == Approx(y).margin(1e-15));
}

}  // namespace

TEST_CASE("the volume gradient takes the normal of the larger one, and the mean of two that are as large") {
  check(result<VolumeGradient>({{3, 4}}, {{-1, 0}}).normal, 0.6, 0.8);
  check(result<VolumeGradient>({{1, 0}}, {{-3, 4}}).normal, 0.6, -0.8);
  // (3, 4) and (5, 0) are as long: their sum (8, 4) is the direction.
  check(result<VolumeGradient>({{3, 4}}, {{-5, 0}}).normal, 2 / std::sqrt(5.0), 1 / std::sqrt(5.0));
}

TEST_CASE("own normals are those of each body, and none is found where either body or their mean has none") {
  const NormalResult<2, double> both = result<OwnGradient>({{3, 4}}, {{-2, 0}});
  check(both.own_a, 0.6, 0.8);
  check(both.own_b, 1, 0);
  check(both.normal, 2 / std::sqrt(5.0), 1 / std::sqrt(5.0));
  CHECK(both.found == 1);
  CHECK(result<OwnGradient>({{3, 4}}, {{0, 0}}).found == 0);
  CHECK(result<OwnGradient>({{0, 0}}, {{-2, 0}}).found == 0);
  CHECK(result<OwnGradient>({{2, 0}}, {{3, 0}}).found == 0);  // the sides face away from one another
  CHECK((OwnGradient::traits & MPM_OWN_NORMALS) != 0);
}
