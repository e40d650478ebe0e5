#include "experiment/surface_mesh.hpp"

#include "support/numbers.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mpm {
namespace {

using support::infinity;

Vector3 minus(const Vector3& a, const Vector3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double dot(const Vector3& a, const Vector3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double squared_to_segment(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 edge = minus(b, a), arm = minus(p, a);
  const double length = dot(edge, edge), along = length > 0 ? std::clamp(dot(arm, edge) / length, 0.0, 1.0) : 0;
  const Vector3 off{arm[0] - along * edge[0], arm[1] - along * edge[1], arm[2] - along * edge[2]};
  return dot(off, off);
}

double squared_to_triangle(const Vector3& p, const Triangle& t) {
  const Vector3 normal = cross(minus(t[1], t[0]), minus(t[2], t[0]));
  const double size = dot(normal, normal);
  bool above = size > 0;
  for (int c = 0; c < 3 && above; ++c) above = dot(cross(minus(t[(c + 1) % 3], t[c]), minus(p, t[c])), normal) >= 0;
  if (above) return std::pow(dot(minus(p, t[0]), normal), 2) / size;
  return std::min(
      {squared_to_segment(p, t[0], t[1]), squared_to_segment(p, t[1], t[2]), squared_to_segment(p, t[2], t[0])});
}

/// A box around triangles, in a tree whose leaves hold a few.
struct Branch {
  Vector3 lower{infinity, infinity, infinity}, upper{-infinity, -infinity, -infinity};
  std::size_t first = 0, last = 0;  ///< triangles
  std::size_t left = 0, right = 0;  ///< branches; 0: a leaf
};

class Enclosed final : public Geometry {
 public:
  explicit Enclosed(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) { grow(0, triangles_.size()); }
  bool contains(const Vector3& point) const override {
    // A ray that comes near an edge may count both triangles or none: another one is taken then.
    const Vector3 rays[] = {{0.8017, 0.5345, 0.2673},
                            {-0.2113, 0.7887, 0.5774},
                            {0.1543, -0.6172, 0.7715},
                            {-0.6364, -0.3182, -0.7027},
                            {0.0891, 0.4454, -0.8909}};
    bool inside = false;
    for (const Vector3& ray : rays) {
      bool sure = true;
      int crossings = 0;
      count(0, point, ray, crossings, sure);
      inside = crossings % 2 == 1;
      if (sure) break;
    }
    return inside;
  }
  std::pair<Vector3, Vector3> bounds() const override { return {branches_[0].lower, branches_[0].upper}; }
  double distance(const Vector3& point) const override {
    double squared = infinity;
    approach(0, point, squared);
    return contains(point) ? -std::sqrt(squared) : std::sqrt(squared);
  }
  std::pair<double, double> extent(const Vector3& direction) const override {
    std::pair<double, double> ends{infinity, -infinity};
    for (const Triangle& triangle : triangles_)
      for (const Vector3& corner : triangle) {
        const double along = dot(direction, corner);
        ends = {std::min(ends.first, along), std::max(ends.second, along)};
      }
    return ends;
  }
  Surface surface(double spacing, const std::pair<Vector3, Vector3>&) const override {
    Surface pieces;
    for (const Triangle& triangle : triangles_) {
      const std::size_t before = pieces.size();
      add_facet(pieces, triangle, spacing);
      if (pieces.size() == before) continue;
      Vector3 beside{};
      for (int c = 0; c < 3; ++c) beside[c] = pieces[before].point[c] + 1e-6 * spacing * pieces[before].normal[c];
      if (!contains(beside)) continue;  // files need not turn their facets outwards
      for (std::size_t k = before; k < pieces.size(); ++k)
        for (double& x : pieces[k].normal) x = -x;
    }
    return pieces;
  }

 private:
  /// Adds a triangle, halved across its longest edge until no edge is longer than the spacing.
  static void add_facet(Surface& pieces, const Triangle& t, double spacing) {
    int longest = 0;
    double most = 0;
    for (int c = 0; c < 3; ++c)
      if (const Vector3 edge = minus(t[(c + 1) % 3], t[c]); dot(edge, edge) > most) most = dot(edge, edge), longest = c;
    const Vector3 &a = t[longest], &b = t[(longest + 1) % 3], &opposite = t[(longest + 2) % 3];
    if (most > spacing * spacing) {
      const Vector3 middle{0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])};
      add_facet(pieces, {a, middle, opposite}, spacing);
      add_facet(pieces, {middle, b, opposite}, spacing);
      return;
    }
    const Vector3 twice = cross(minus(t[1], t[0]), minus(t[2], t[0]));
    const double size = std::sqrt(dot(twice, twice));
    if (size == 0) return;
    SurfacePiece piece;
    for (int c = 0; c < 3; ++c) piece.point[c] = (t[0][c] + t[1][c] + t[2][c]) / 3, piece.normal[c] = twice[c] / size;
    piece.area = 0.5 * size;
    pieces.push_back(piece);
  }

  std::size_t grow(std::size_t first, std::size_t last) {
    const std::size_t number = branches_.size();
    Branch branch;
    branch.first = first, branch.last = last;
    for (std::size_t k = first; k < last; ++k)
      for (const Vector3& corner : triangles_[k])
        for (int c = 0; c < 3; ++c) {
          branch.lower[c] = std::min(branch.lower[c], corner[c]);
          branch.upper[c] = std::max(branch.upper[c], corner[c]);
        }
    branches_.push_back(branch);
    if (last - first <= 4) return number;
    const Vector3 size = minus(branch.upper, branch.lower);
    const auto axis = std::max_element(size.begin(), size.end()) - size.begin();
    const std::size_t middle = (first + last) / 2;
    const auto at = [&](std::size_t k) { return triangles_.begin() + static_cast<std::ptrdiff_t>(k); };
    std::nth_element(at(first), at(middle), at(last), [&](const Triangle& a, const Triangle& b) {
      return a[0][axis] + a[1][axis] + a[2][axis] < b[0][axis] + b[1][axis] + b[2][axis];
    });
    const std::size_t left = grow(first, middle), right = grow(middle, last);
    branches_[number].left = left, branches_[number].right = right;
    return number;
  }

  static double squared_to_box(const Branch& branch, const Vector3& p) {
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += std::pow(std::max({branch.lower[c] - p[c], 0.0, p[c] - branch.upper[c]}), 2);
    return sum;
  }

  void approach(std::size_t number, const Vector3& p, double& least) const {
    const Branch& branch = branches_[number];
    if (branch.left == 0) {
      for (std::size_t k = branch.first; k < branch.last; ++k)
        least = std::min(least, squared_to_triangle(p, triangles_[k]));
      return;
    }
    std::pair<double, std::size_t> near{squared_to_box(branches_[branch.left], p), branch.left};
    std::pair<double, std::size_t> far{squared_to_box(branches_[branch.right], p), branch.right};
    if (far < near) std::swap(near, far);
    if (near.first < least) approach(near.second, p, least);
    if (far.first < least) approach(far.second, p, least);
  }

  static bool meets(const Branch& branch, const Vector3& p, const Vector3& ray) {
    double from = 0, to = infinity;
    for (int c = 0; c < 3; ++c) {
      const double a = (branch.lower[c] - p[c]) / ray[c], b = (branch.upper[c] - p[c]) / ray[c];
      from = std::max(from, std::min(a, b)), to = std::min(to, std::max(a, b));
    }
    return from <= to;
  }

  void count(std::size_t number, const Vector3& p, const Vector3& ray, int& crossings, bool& sure) const {
    const Branch& branch = branches_[number];
    if (!meets(branch, p, ray)) return;
    if (branch.left != 0) {
      count(branch.left, p, ray, crossings, sure);
      return count(branch.right, p, ray, crossings, sure);
    }
    for (std::size_t k = branch.first; k < branch.last; ++k) {  // Moeller and Trumbore (1997)
      const Triangle& t = triangles_[k];
      const Vector3 e1 = minus(t[1], t[0]), e2 = minus(t[2], t[0]), across = cross(ray, e2), arm = minus(p, t[0]);
      const double determinant = dot(e1, across);
      if (determinant == 0) continue;
      const Vector3 q = cross(arm, e1);
      const double u = dot(arm, across) / determinant, v = dot(ray, q) / determinant;
      const double along = dot(e2, q) / determinant, nearest = std::min({u, v, 1 - u - v});
      if (along <= 0) continue;
      if (std::abs(nearest) < 1e-9) sure = false;
      if (nearest >= 0) ++crossings;
    }
  }

  std::vector<Triangle> triangles_;
  std::vector<Branch> branches_;
};

}  // namespace

GeometryPointer make_enclosed(std::vector<Triangle> triangles) {
  return std::make_shared<Enclosed>(std::move(triangles));
}

}  // namespace mpm
