#define GL_GLEXT_PROTOTYPES
#include "render/scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <GL/gl.h>
#include <GL/glext.h>

#include "render/ambient_occlusion.hpp"
#include "render/chart.hpp"
#include "render/ground_shadow.hpp"
#include "render/osmesa_context.hpp"

namespace mpm::render {
namespace {

constexpr int kSamples = 2;                        ///< samples a pixel in each direction
constexpr Vec3 kViewDirection{0.42, -0.83, 0.36};  ///< from the domain towards the eye
constexpr Vec3 kToLight{-0.35, -0.40, 0.85};       ///< normalised where it is used
constexpr Colour kGround{0.93, 0.93, 0.93};
constexpr double kGroundOverhang = 0.05;  ///< fraction of the longer side of the domain's floor

double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec3 minus(const Vec3& a, const Vec3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vec3 unit(const Vec3& a) {
  const double length = std::sqrt(dot(a, a));
  return {a[0] / length, a[1] / length, a[2] / length};
}

std::array<Vec3, 8> corners_of(const Vec3& lo, const Vec3& hi) {
  std::array<Vec3, 8> corners;
  for (int k = 0; k < 8; ++k) {
    corners[static_cast<std::size_t>(k)] = {k & 1 ? hi[0] : lo[0], k & 2 ? hi[1] : lo[1], k & 4 ? hi[2] : lo[2]};
  }
  return corners;
}

/// A ball is one square facing the eye; the fragment program finds the exact point of the sphere.
constexpr const char* kVertexProgram = R"(#version 120
varying vec3 centre, ray;
varying float radius;
void main() {
  centre = (gl_ModelViewMatrix * gl_Vertex).xyz;
  radius = gl_MultiTexCoord0.z;
  vec3 forward = normalize(centre);
  vec3 right = normalize(cross(forward, vec3(0.0, 1.0, 0.0)));
  vec3 up = cross(right, forward);
  float distance2 = dot(centre, centre);
  float half_side = radius * sqrt(distance2 / max(distance2 - radius * radius, 0.01 * distance2));
  ray = centre + (gl_MultiTexCoord0.x * right + gl_MultiTexCoord0.y * up) * half_side;
  gl_Position = gl_ProjectionMatrix * vec4(ray, 1.0);
  gl_FrontColor = gl_Color;
})";

constexpr const char* kFragmentProgram = R"(#version 120
uniform vec3 to_light;
uniform float writes_normals;
varying vec3 centre, ray;
varying float radius;
void main() {
  vec3 forward = normalize(ray);
  float along = dot(forward, centre);
  vec3 miss = centre - along * forward;
  float chord2 = radius * radius - dot(miss, miss);
  if (chord2 < 0.0) discard;
  vec3 point = (along - sqrt(chord2)) * forward;
  vec3 normal = (point - centre) / radius;
  vec4 clip = gl_ProjectionMatrix * vec4(point, 1.0);
  gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;
  float lambert = 0.5 * dot(normal, to_light) + 0.5;
  float shine = pow(max(dot(normal, normalize(to_light - forward)), 0.0), 24.0);
  // The added light keeps the dark end of a colour map from looking flat.
  vec3 lit = gl_Color.rgb * mix(0.60, 1.02, lambert) + 0.09 * lambert * lambert + 0.08 * shine;
  gl_FragColor = vec4(writes_normals > 0.5 ? 0.5 * normal + 0.5 : lit, 1.0);
})";

GLuint compiled(GLenum kind, const char* source) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint is_good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &is_good);
  if (is_good) return shader;
  char log[1024] = "";
  glGetShaderInfoLog(shader, sizeof log, nullptr, log);
  throw std::runtime_error(std::string("OpenGL could not compile the program that draws balls: ") + log);
}

GLuint ball_program() {
  const GLuint program = glCreateProgram();
  for (const GLuint shader :
       {compiled(GL_VERTEX_SHADER, kVertexProgram), compiled(GL_FRAGMENT_SHADER, kFragmentProgram)}) {
    glAttachShader(program, shader);
    glDeleteShader(shader);  // with the program
  }
  glLinkProgram(program);
  GLint is_good = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &is_good);
  if (!is_good) throw std::runtime_error("OpenGL could not link the program that draws balls");
  return program;
}

struct BallVertex {
  float centre[3], corner[3], colour[3];
};

std::vector<BallVertex> ball_vertices(const std::vector<Ball>& balls) {
  constexpr float corners[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  std::vector<BallVertex> vertices;
  vertices.reserve(balls.size() * 4);
  for (const Ball& b : balls) {
    for (const auto& c : corners) {
      vertices.push_back({{float(b.centre[0]), float(b.centre[1]), float(b.centre[2])},
                          {c[0], c[1], float(b.radius)},
                          {float(b.colour.r), float(b.colour.g), float(b.colour.b)}});
    }
  }
  return vertices;
}

void draw_balls(const std::vector<BallVertex>& vertices) {
  if (vertices.empty()) return;
  constexpr GLsizei stride = sizeof(BallVertex);
  glEnableClientState(GL_VERTEX_ARRAY);
  glEnableClientState(GL_TEXTURE_COORD_ARRAY);
  glEnableClientState(GL_COLOR_ARRAY);
  glVertexPointer(3, GL_FLOAT, stride, vertices.front().centre);
  glTexCoordPointer(3, GL_FLOAT, stride, vertices.front().corner);
  glColorPointer(3, GL_FLOAT, stride, vertices.front().colour);
  glDrawArrays(GL_QUADS, 0, static_cast<GLsizei>(vertices.size()));
  glDisableClientState(GL_VERTEX_ARRAY);
  glDisableClientState(GL_TEXTURE_COORD_ARRAY);
  glDisableClientState(GL_COLOR_ARRAY);
}

void set_view(const Camera& camera, int samples) {
  const Box& v = camera.view();
  glViewport(0, 0, static_cast<int>(v.width()) * samples, static_cast<int>(v.height()) * samples);
  const double n = camera.near_plane(), per_pixel = n / camera.scale();
  glMatrixMode(GL_PROJECTION);
  glLoadIdentity();
  glFrustum((v.x0 - camera.axis().x) * per_pixel, (v.x1 - camera.axis().x) * per_pixel,
            (camera.axis().y - v.y1) * per_pixel, (camera.axis().y - v.y0) * per_pixel, n, camera.far_plane());
  glMatrixMode(GL_MODELVIEW);
  glLoadMatrixd(camera.matrix().data());
}

unsigned shadow_texture(const GroundShadow& shadow) {
  unsigned texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_LUMINANCE, shadow.size, shadow.size, 0, GL_LUMINANCE, GL_FLOAT,
               shadow.light.data());
  return texture;
}

void draw_ground(const GroundShadow& s, double z) {
  const double points[4][4] = {{0, 0, s.x0, s.y0}, {1, 0, s.x1, s.y0}, {1, 1, s.x1, s.y1}, {0, 1, s.x0, s.y1}};
  glBegin(GL_QUADS);
  for (const auto& p : points) glTexCoord2d(p[0], p[1]), glVertex3d(p[2], p[3], z);
  glEnd();
}

void draw_edges(const Vec3& lo, const Vec3& hi, double width) {
  const auto corners = corners_of(lo, hi);
  glLineWidth(static_cast<float>(width));
  glColor3d(0.45, 0.45, 0.45);
  glBegin(GL_LINES);
  for (std::size_t a = 0; a < 8; ++a) {
    for (const std::size_t bit : {1, 2, 4}) {
      if (a & bit) continue;
      glVertex3dv(corners[a].data());
      glVertex3dv(corners[a | bit].data());
    }
  }
  glEnd();
}

/// Everything that one pass over the scene needs.
struct Stage {
  std::vector<BallVertex> balls;
  GroundShadow shadow;
  Vec3 lo, hi, up, light;  ///< up and light are seen from the eye
  unsigned texture = 0;
  GLuint program = 0;
  double line_width = 1;  ///< samples

  void draw(bool writes_normals) const {
    glClearColor(1, 1, 1, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    if (writes_normals) {
      glColor3d(0.5 * up[0] + 0.5, 0.5 * up[1] + 0.5, 0.5 * up[2] + 0.5);
    } else {
      glEnable(GL_TEXTURE_2D);
      glColor3d(kGround.r, kGround.g, kGround.b);
    }
    // The ground is set back a little, or the domain's lower edges would sink into it here and there.
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(2, 8);
    draw_ground(shadow, lo[2]);
    glDisable(GL_POLYGON_OFFSET_FILL);
    glDisable(GL_TEXTURE_2D);
    glUseProgram(program);
    glUniform3f(glGetUniformLocation(program, "to_light"), float(light[0]), float(light[1]), float(light[2]));
    glUniform1f(glGetUniformLocation(program, "writes_normals"), writes_normals ? 1.0f : 0.0f);
    draw_balls(balls);
    glUseProgram(0);
  }
};

/// Takes the first sample of each pixel, so that a pixel never mixes two surfaces.
GeometryBuffer geometry_of(const Camera& camera, const std::vector<float>& depth,
                           const std::vector<std::uint8_t>& normals) {
  const Box& view = camera.view();
  GeometryBuffer g{static_cast<int>(view.width()), static_cast<int>(view.height()), {}, {}};
  const double n = camera.near_plane(), f = camera.far_plane();
  for (int y = 0; y < g.height; ++y) {
    for (int x = 0; x < g.width; ++x) {
      const std::size_t at =
          static_cast<std::size_t>(y * kSamples) * g.width * kSamples + static_cast<std::size_t>(x) * kSamples;
      if (depth[at] >= 1) {
        g.position.push_back({0, 0, 0});
        g.normal.push_back({0, 0, 1});
        continue;
      }
      const double z = n * f / (f - depth[at] * (f - n));  // distance in front of the eye
      const double px = view.x0 + x + 0.25 - camera.axis().x, py = camera.axis().y - view.y0 - y - 0.25;
      g.position.push_back({float(px / camera.scale() * z), float(py / camera.scale() * z), float(-z)});
      const std::uint8_t* c = normals.data() + 4 * at;
      g.normal.push_back({c[0] / 127.5f - 1, c[1] / 127.5f - 1, c[2] / 127.5f - 1});
    }
  }
  return g;
}

Image shaded(const std::vector<std::uint8_t>& rgba, const GeometryBuffer& g, const std::vector<float>& open) {
  Image image(g.width, g.height);
  for (int y = 0; y < g.height; ++y) {
    for (int x = 0; x < g.width; ++x) {
      int sum[3] = {};
      for (int j = 0; j < kSamples; ++j) {
        for (int i = 0; i < kSamples; ++i) {
          const std::size_t at = static_cast<std::size_t>(y * kSamples + j) * g.width * kSamples +
                                 static_cast<std::size_t>(x * kSamples + i);
          for (int c = 0; c < 3; ++c) sum[c] += rgba[4 * at + static_cast<std::size_t>(c)];
        }
      }
      const float light = open[static_cast<std::size_t>(y) * g.width + x] / (kSamples * kSamples);
      for (int c = 0; c < 3; ++c)
        image.at(x, y)[c] = static_cast<std::uint8_t>(std::lround(static_cast<float>(sum[c]) * light));
    }
  }
  return image;
}

double median_radius(const std::vector<Ball>& balls, double fallback) {
  std::vector<double> radii;
  for (const Ball& b : balls) radii.push_back(b.radius);
  if (radii.empty()) return fallback;
  std::nth_element(radii.begin(), radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2), radii.end());
  return radii[radii.size() / 2];
}

}  // namespace

Camera::Camera(const Vec3& lo, const Vec3& hi, const Box& inner, const Box& view) : view_(view) {
  const Vec3 centre{(lo[0] + hi[0]) / 2, (lo[1] + hi[1]) / 2, (lo[2] + hi[2]) / 2};
  const Vec3 size = minus(hi, lo);
  const double diagonal = std::sqrt(dot(size, size));
  back_ = unit(kViewDirection);
  right_ = unit(cross({0, 0, 1}, back_));
  up_ = cross(back_, right_);
  const double distance = 2.4 * diagonal;
  for (std::size_t d = 0; d < 3; ++d) eye_[d] = centre[d] + distance * back_[d];
  near_ = distance - diagonal;
  far_ = distance + diagonal;
  Range horizontal, vertical;
  for (const Vec3& corner : corners_of(lo, hi)) {
    const Vec3 p = to_eye(corner);
    horizontal.add(p[0] / -p[2]);
    vertical.add(p[1] / -p[2]);
  }
  const double width = *horizontal.hi - *horizontal.lo, height = *vertical.hi - *vertical.lo;
  scale_ = std::min(inner.width() / width, inner.height() / height);
  axis_x_ = inner.centre().x - scale_ * (*horizontal.hi + *horizontal.lo) / 2;
  axis_y_ = inner.centre().y + scale_ * (*vertical.hi + *vertical.lo) / 2;
}

Vec3 Camera::to_eye(const Vec3& point) const {
  const Vec3 p = minus(point, eye_);
  return {dot(right_, p), dot(up_, p), dot(back_, p)};
}

Point Camera::project(const Vec3& point) const {
  const Vec3 p = to_eye(point);
  return {axis_x_ + scale_ * p[0] / -p[2], axis_y_ - scale_ * p[1] / -p[2]};
}

std::array<double, 16> Camera::matrix() const {
  return {right_[0], up_[0], back_[0], 0, right_[1],          up_[1],          back_[1],          0,
          right_[2], up_[2], back_[2], 0, -dot(right_, eye_), -dot(up_, eye_), -dot(back_, eye_), 1};
}

Image render_scene(const std::vector<Ball>& balls, const Vec3& lo, const Vec3& hi, const Camera& camera,
                   double line_width) {
  const int width = static_cast<int>(camera.view().width()), height = static_cast<int>(camera.view().height());
  OsMesaContext context(width * kSamples, height * kSamples);
  const double overhang = kGroundOverhang * std::max(hi[0] - lo[0], hi[1] - lo[1]);
  const Vec3 origin = camera.to_eye({0, 0, 0}), light = unit(kToLight);
  Stage stage{ball_vertices(balls),
              cast_shadow(balls, light, lo[2], lo[0] - overhang, lo[1] - overhang, hi[0] + overhang, hi[1] + overhang),
              lo,
              hi,
              minus(camera.to_eye({0, 0, 1}), origin),
              minus(camera.to_eye(light), origin)};
  stage.texture = shadow_texture(stage.shadow);
  stage.program = ball_program();
  set_view(camera, kSamples);
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_DITHER);

  stage.draw(true);
  const std::vector<float> depth = context.depth();
  const GeometryBuffer geometry = geometry_of(camera, depth, context.pixels());
  stage.draw(false);
  // The edges come after the geometry was read: a line casts no occlusion.
  draw_edges(lo, hi, line_width * kSamples);
  context.finish();
  glDeleteTextures(1, &stage.texture);
  glDeleteProgram(stage.program);
  const Vec3 size = minus(hi, lo);
  const double longest = std::max({size[0], size[1], size[2]});
  const double ball = median_radius(balls, 0.01 * longest);
  return shaded(context.pixels(), geometry,
                open_sky(geometry, {2.5 * ball, std::max(0.08 * longest, 5 * ball)}, camera.scale()));
}

}  // namespace mpm::render
