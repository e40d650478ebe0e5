#include "experiment/surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mpm {
namespace {

constexpr double pi = std::numbers::pi;

/// How many pieces a length is divided into, a multiple of `of`, which keeps symmetries.
int pieces_of(double length, double spacing, int of = 1) {
  return of * std::max(1, static_cast<int>(std::ceil(length / spacing / of - 1e-9)));
}

Vector3 moved(const Vector3& from, double by, const Vector3& along) {
  return {from[0] + by * along[0], from[1] + by * along[1], from[2] + by * along[2]};
}

double norm(const Vector3& v) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/// The direction of an angle about an axis.
Vector3 direction(int axis, double angle) {
  Vector3 result{};
  result[(axis + 1) % 3] = std::cos(angle), result[(axis + 2) % 3] = std::sin(angle);
  return result;
}

/// A flat rectangle across an axis.
void add_face(Surface& surface, int axis, double at, int side, const Vector3& lower, const Vector3& upper,
              double spacing) {
  const int b = (axis + 1) % 3, c = (axis + 2) % 3;
  const int m = pieces_of(upper[b] - lower[b], spacing), n = pieces_of(upper[c] - lower[c], spacing);
  SurfacePiece piece;
  piece.area = (upper[b] - lower[b]) / m * ((upper[c] - lower[c]) / n);
  piece.normal[axis] = side, piece.point[axis] = at;
  for (int j = 0; j < m; ++j)
    for (int k = 0; k < n; ++k) {
      piece.point[b] = lower[b] + (upper[b] - lower[b]) * (j + 0.5) / m;
      piece.point[c] = lower[c] + (upper[c] - lower[c]) * (k + 0.5) / n;
      surface.push_back(piece);
    }
}

/// The part of a line within a box, as shares of the way from `from` along `way`; first > second where there is none.
std::pair<double, double> clipped(int dimension, const Vector3& from, const Vector3& way, const Vector3& lower,
                                  const Vector3& upper) {
  double first = -1e300, last = 1e300;
  for (int i = 0; i < dimension; ++i) {
    if (way[i] == 0) {
      if (from[i] < lower[i] || from[i] > upper[i]) return {1, 0};
      continue;
    }
    const double a = (lower[i] - from[i]) / way[i], b = (upper[i] - from[i]) / way[i];
    first = std::max(first, std::min(a, b)), last = std::min(last, std::max(a, b));
  }
  return {first, last};
}

}  // namespace

void add_circle(Surface& surface, const Vector3& centre, double radius, int side, double spacing) {
  const int n = pieces_of(2 * pi * radius, spacing, 4);
  for (int k = 0; k < n; ++k) {
    const Vector3 out = direction(2, 2 * pi * (k + 0.5) / n);
    surface.push_back({moved(centre, radius, out), moved({}, side, out), 2 * pi * radius / n});
  }
}

void add_sphere(Surface& surface, const Vector3& centre, double radius, double spacing) {
  const int bands = pieces_of(pi * radius, spacing, 2);
  for (int band = 0; band < bands; ++band) {
    // A band's area is that of its height on the cylinder around the sphere.
    const double low = -std::cos(pi * band / bands), high = -std::cos(pi * (band + 1) / bands);
    const double z = 0.5 * (low + high), r = std::sqrt(1 - z * z);
    const int n = pieces_of(2 * pi * radius * r, spacing, 4);
    for (int k = 0; k < n; ++k) {
      Vector3 out = moved({}, r, direction(2, 2 * pi * (k + 0.5) / n));
      out[2] = z;
      surface.push_back({moved(centre, radius, out), out, 2 * pi * radius * radius * (high - low) / n});
    }
  }
}

void add_cylinder(Surface& surface, const Vector3& centre, double radius, int axis, double length, int side,
                  double spacing) {
  const int around = pieces_of(2 * pi * radius, spacing, 4), along = pieces_of(length, spacing);
  for (int k = 0; k < around; ++k) {
    const Vector3 out = direction(axis, 2 * pi * (k + 0.5) / around);
    Vector3 point = moved(centre, radius, out);
    for (int j = 0; j < along; ++j) {
      point[axis] = centre[axis] - length / 2 + length * (j + 0.5) / along;
      surface.push_back({point, moved({}, side, out), 2 * pi * radius / around * (length / along)});
    }
  }
}

void add_cap(Surface& surface, const Vector3& centre, double inner, double outer, int axis, double length, int end,
             double spacing) {
  const int rings = pieces_of(outer - inner, spacing);
  for (int ring = 0; ring < rings; ++ring) {
    const double low = inner + (outer - inner) * ring / rings, high = inner + (outer - inner) * (ring + 1) / rings;
    const int n = pieces_of(2 * pi * high, spacing, 4);
    const double area = pi * (high * high - low * low) / n;
    // The centroid of a sector lies farther in than the middle of its rim.
    const double angle = pi / n, from_axis = 2.0 / 3 * (high * high * high - low * low * low) /
                                             (high * high - low * low) * std::sin(angle) / angle;
    for (int k = 0; k < n; ++k) {
      SurfacePiece piece{moved(centre, from_axis, direction(axis, 2 * pi * (k + 0.5) / n)), {}, area};
      piece.point[axis] = centre[axis] + end * length / 2;
      piece.normal[axis] = end;
      surface.push_back(piece);
    }
  }
}

void add_edge(Surface& surface, const Vector3& from, const Vector3& to, const Vector3& normal, double spacing) {
  const Vector3 way = moved(to, -1, from);
  const double length = norm(way);
  const int n = pieces_of(length, spacing);
  for (int k = 0; k < n; ++k) surface.push_back({moved(from, (k + 0.5) / n, way), normal, length / n});
}

void add_box(Surface& surface, int dimension, const Vector3& lower, const Vector3& upper, double spacing) {
  if (dimension == 2) {
    const Vector3 right{upper[0], lower[1], 0}, left{lower[0], upper[1], 0}, low{lower[0], lower[1], 0},
        high{upper[0], upper[1], 0};
    add_edge(surface, low, right, {0, -1, 0}, spacing);
    add_edge(surface, right, high, {1, 0, 0}, spacing);
    add_edge(surface, left, high, {0, 1, 0}, spacing);
    return add_edge(surface, low, left, {-1, 0, 0}, spacing);
  }
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {-1, 1})
      add_face(surface, axis, (side < 0 ? lower : upper)[axis], side, lower, upper, spacing);
}

void add_plane(Surface& surface, int dimension, const Vector3& point, const Vector3& normal, const Vector3& lower,
               const Vector3& upper, double spacing) {
  Vector3 out = normal;
  if (dimension == 2) out[2] = 0;
  out = moved({}, 1 / norm(out), out);
  if (dimension == 2) {
    const Vector3 way{-out[1], out[0], 0};
    const auto [first, last] = clipped(2, point, way, lower, upper);
    if (first < last) add_edge(surface, moved(point, first, way), moved(point, last, way), out, spacing);
    return;
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(out[axis]) != 1) continue;
    if (point[axis] < lower[axis] || point[axis] > upper[axis]) return;
    return add_face(surface, axis, point[axis], out[axis] > 0 ? 1 : -1, lower, upper, spacing);
  }
  // The plane is covered by squares about the middle of the box; those whose centre lies in the box stay.
  const int least = static_cast<int>(
      std::min_element(out.begin(), out.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }) -
      out.begin());
  Vector3 axis{};
  axis[least] = 1;
  Vector3 u = moved(axis, -out[least], out);
  u = moved({}, 1 / norm(u), u);
  const Vector3 v{out[1] * u[2] - out[2] * u[1], out[2] * u[0] - out[0] * u[2], out[0] * u[1] - out[1] * u[0]};
  Vector3 middle{};
  double height = 0;
  for (int i = 0; i < 3; ++i) middle[i] = 0.5 * (lower[i] + upper[i]), height += (middle[i] - point[i]) * out[i];
  middle = moved(middle, -height, out);
  const int n = pieces_of(0.5 * norm(moved(upper, -1, lower)), spacing);
  for (int j = -n; j < n; ++j)
    for (int k = -n; k < n; ++k) {
      const Vector3 at = moved(moved(middle, (j + 0.5) * spacing, u), (k + 0.5) * spacing, v);
      bool inside = true;
      for (int i = 0; i < 3; ++i) inside = inside && at[i] >= lower[i] && at[i] <= upper[i];
      if (inside) surface.push_back({at, out, spacing * spacing});
    }
}

Surface surface_of_whole(const std::vector<Surface>& of_parts, const std::function<bool(const Vector3&)>& contains,
                         const std::vector<std::function<bool(const Vector3&)>>& parts, double spacing) {
  Surface whole;
  const double beside = 1e-6 * spacing;
  for (std::size_t part = 0; part < of_parts.size(); ++part)
    for (SurfacePiece piece : of_parts[part]) {
      const Vector3 out = moved(piece.point, beside, piece.normal), in = moved(piece.point, -beside, piece.normal);
      const bool before = contains(in), beyond = contains(out);
      if (before == beyond) continue;
      const bool known = std::any_of(parts.begin(), parts.begin() + static_cast<std::ptrdiff_t>(part),
                                     [&](const auto& other) { return other(in) != other(out); });
      if (known) continue;
      if (beyond) piece.normal = moved({}, -1, piece.normal);
      whole.push_back(piece);
    }
  return whole;
}

}  // namespace mpm
