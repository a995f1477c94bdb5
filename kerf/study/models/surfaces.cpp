#include "kerf/study/models/surfaces.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf {
namespace {

constexpr double kPi = std::numbers::pi;

Vec3d lerp(Vec3d a, Vec3d b, double t) { return a * (1 - t) + b * t; }
Vec3d unit(Vec3d v) { return v / std::sqrt(dot(v, v)); }

Curve line(Vec3d a, Vec3d b) {
  return [=](double t) { return lerp(a, b, t); };
}

/// About `center`, from the angle `from` to `to`, in the plane of x and `up`.
Curve arc(Vec3d center, double radius, double from, double to, Vec3d up) {
  return [=](double t) {
    const double angle = from + (to - from) * t;
    return center + Vec3d{1, 0, 0} * (radius * std::cos(angle)) + up * (radius * std::sin(angle));
  };
}

Surface ruled(Curve a, Curve b) {
  return [a = std::move(a), b = std::move(b)](double u, double v) { return lerp(a(u), b(u), v); };
}

Surface turned_over(Surface surface) {
  return [surface = std::move(surface)](double u, double v) { return surface(v, u); };
}

double part_of(uint32_t k, uint32_t pieces, double t) { return (k + t) / pieces; }

struct Frame {
  Vec3d origin, x, y;
  Vec3d point(Vec3d p) const { return origin + x * p.x + y * p.y; }
};

Frame frame_at(const Sweep& sweep, double t) {
  constexpr double kStep = 1e-4;
  // A loop goes on where it began.
  const double before = sweep.is_loop ? t - kStep : std::max(t - kStep, 0.0);
  const double after = sweep.is_loop ? t + kStep : std::min(t + kStep, 1.0);
  const Vec3d along = unit(sweep.path(after) - sweep.path(before));
  const Vec3d x = unit(cross(sweep.upright, along));
  const double scale = sweep.scale(t);
  return {sweep.path(t), x * scale, cross(along, x) * scale};
}

}  // namespace

std::vector<Curve> rounded_profile(const std::vector<ProfilePoint>& points) {
  std::vector<Curve> curves;
  Vec3d at{points[0].r, 0, points[0].z};
  for (size_t i = 1; i < points.size(); ++i) {
    const Vec3d corner{points[i].r, 0, points[i].z};
    if (points[i].fillet > 0 && i + 1 < points.size()) {
      const Vec3d in = unit(corner - Vec3d{points[i - 1].r, 0, points[i - 1].z});
      const Vec3d out = unit(Vec3d{points[i + 1].r, 0, points[i + 1].z} - corner);
      const double turn = std::atan2(in.x * out.z - in.z * out.x, dot(in, out));  // to the left
      const double back = points[i].fillet * std::tan(std::abs(turn) / 2);
      const double side = turn > 0 ? 1 : -1;
      const Vec3d begin = corner - in * back;
      const Vec3d center = begin + Vec3d{-in.z, 0, in.x} * (points[i].fillet * side);
      const double from = std::atan2(begin.z - center.z, begin.x - center.x);
      if (dot(begin - at, begin - at) > 0) curves.push_back(line(at, begin));
      curves.push_back(arc(center, points[i].fillet, from, from + turn, {0, 0, 1}));
      at = corner + out * back;
    } else {
      curves.push_back(line(at, corner));
      at = corner;
    }
  }
  return curves;
}

void add_revolved(Faces& faces, const std::vector<ProfilePoint>& profile, const Transform& place) {
  for (const Curve& curve : rounded_profile(profile)) {
    faces.emplace_back([curve, place](double u, double v) {
      const Vec3d p = curve(v);
      return place.point({p.x * std::cos(2 * kPi * u), p.x * std::sin(2 * kPi * u), p.z});
    });
  }
}

void add_cylinder(Faces& faces, double radius, double height, const Transform& place) {
  add_revolved(faces, {{0, 0}, {radius, 0}, {radius, height}, {0, height}}, place);
}

void add_box(Faces& faces, Vec3d low, Vec3d high) {
  const auto sheet = [=](double z) {
    return [=](double s, double t) { return Vec3d{low.x + (high.x - low.x) * s, low.y + (high.y - low.y) * t, z}; };
  };
  add_sheets(faces, {sheet(high.z), sheet(low.z), {0, 1}, {0, 1}, {}});
}

void add_sweep(Faces& faces, const Sweep& sweep) {
  for (const Curve& profile : sweep.profile) {
    for (uint32_t k = 0; k < sweep.pieces; ++k) {
      faces.emplace_back(
          [=](double u, double v) { return frame_at(sweep, part_of(k, sweep.pieces, v)).point(profile(u)); });
    }
    if (sweep.is_loop) continue;
    const Frame begin = frame_at(sweep, 0), end = frame_at(sweep, 1);
    faces.push_back(
        turned_over(ruled([=](double t) { return begin.point(profile(t)); }, [=](double) { return begin.origin; })));
    faces.push_back(ruled([=](double t) { return end.point(profile(t)); }, [=](double) { return end.origin; }));
  }
}

std::vector<Curve> circle_profile(double radius) { return {arc({}, radius, 0, 2 * kPi, {0, 1, 0})}; }

std::vector<Curve> rounded_rectangle_profile(double width, double height, double radius) {
  const double x = width / 2 - radius, y = height / 2 - radius;
  const Vec3d centers[] = {{x, y, 0}, {-x, y, 0}, {-x, -y, 0}, {x, -y, 0}};
  std::vector<Curve> curves;
  for (uint32_t i = 0; i < 4; ++i) {
    const Curve corner = arc(centers[i], radius, i * kPi / 2, (i + 1) * kPi / 2, {0, 1, 0});
    const Curve next = arc(centers[(i + 1) % 4], radius, (i + 1) * kPi / 2, (i + 2) * kPi / 2, {0, 1, 0});
    curves.push_back(corner);
    curves.push_back(line(corner(1), next(0)));
  }
  return curves;
}

namespace {

/// Curves in the rectangle of sheets, as points (s, t, 0).
Curve on(const Surface& sheet, const Curve& curve) {
  return [=](double u) {
    const Vec3d p = curve(u);
    return sheet(p.x, p.y);
  };
}

void add_cell(Faces& faces, const Sheets& sheets, uint32_t i, uint32_t j) {
  const Vec3d corners[] = {{sheets.s[i], sheets.t[j], 0},
                           {sheets.s[i + 1], sheets.t[j], 0},
                           {sheets.s[i + 1], sheets.t[j + 1], 0},
                           {sheets.s[i], sheets.t[j + 1], 0}};
  const auto add = [&](const Surface& map) {
    const auto through = [&](const Surface& sheet) {
      return [=](double u, double v) {
        const Vec3d p = map(u, v);
        return sheet(p.x, p.y);
      };
    };
    faces.emplace_back(through(sheets.outer));
    faces.push_back(turned_over(through(sheets.inner)));
  };
  const auto hole =
      std::find_if(sheets.holes.begin(), sheets.holes.end(), [&](const auto& h) { return h.i == i && h.j == j; });
  if (hole == sheets.holes.end()) {
    add(ruled(line(corners[0], corners[1]), line(corners[3], corners[2])));
    return;
  }
  const Vec3d center = (corners[0] + corners[2]) * 0.5;
  const double radius_s = hole->radius_s, radius_t = hole->radius_t;
  for (uint32_t side = 0; side < 4; ++side) {
    const Curve rim = [=](double u) {
      const double angle = kPi * (-0.75 + 0.5 * (side + u));
      return center + Vec3d{radius_s * std::cos(angle), radius_t * std::sin(angle), 0};
    };
    add(ruled(line(corners[side], corners[(side + 1) % 4]), rim));
    faces.push_back(ruled(on(sheets.outer, rim), on(sheets.inner, rim)));
  }
}

/// Joins the sheets along one cell's side of their rim, run through counter-clockwise.
void add_rim(Faces& faces, const Sheets& sheets, Vec3d begin, Vec3d end) {
  const Curve side = line(begin, end);
  if (!sheets.round_rim) {
    faces.push_back(turned_over(ruled(on(sheets.outer, side), on(sheets.inner, side))));
    return;
  }
  faces.push_back(
      turned_over([=, outer = sheets.outer, inner = sheets.inner, rim = sheets.round_rim](double u, double v) {
        const Vec3d p = side(u), a = outer(p.x, p.y), b = inner(p.x, p.y), middle = (a + b) * 0.5, half = (a - b) * 0.5;
        return middle + half * std::cos(kPi * v) + unit(rim(middle)) * (std::sqrt(dot(half, half)) * std::sin(kPi * v));
      }));
}

}  // namespace

void add_sheets(Faces& faces, const Sheets& sheets) {
  const std::vector<double>&s = sheets.s, &t = sheets.t;
  for (uint32_t j = 0; j + 1 < t.size(); ++j) {
    for (uint32_t i = 0; i + 1 < s.size(); ++i) add_cell(faces, sheets, i, j);
  }
  for (size_t i = 0; i + 1 < s.size(); ++i) {
    add_rim(faces, sheets, {s[i], t.front(), 0}, {s[i + 1], t.front(), 0});
    add_rim(faces, sheets, {s[i + 1], t.back(), 0}, {s[i], t.back(), 0});
  }
  for (size_t j = 0; j + 1 < t.size(); ++j) {
    add_rim(faces, sheets, {s.back(), t[j], 0}, {s.back(), t[j + 1], 0});
    add_rim(faces, sheets, {s.front(), t[j + 1], 0}, {s.front(), t[j], 0});
  }
}

Curve bezier_curve(const std::array<Vec3d, 4>& p) {
  return [p](double t) {
    const double s = 1 - t;
    return p[0] * (s * s * s) + p[1] * (3 * s * s * t) + p[2] * (3 * s * t * t) + p[3] * (t * t * t);
  };
}

void place_faces(Faces& faces, size_t first, const Transform& place) {
  for (size_t i = first; i < faces.size(); ++i) {
    faces[i] = [place, surface = std::move(faces[i])](double u, double v) { return place.point(surface(u, v)); };
  }
}

Mesh tessellate_to(const Tessellator& part, uint64_t triangles, const Fineness& shape) {
  const auto scaled = [&](double factor) { return Fineness{shape.max_edge * factor, shape.chord * factor * factor}; };
  constexpr int kSteps = 40;
  double fine = 1e-4, coarse = 1e3;  // the factors between which the count is searched
  for (int i = 0; i < kSteps; ++i) {
    const double middle = std::sqrt(fine * coarse);
    (part.count(scaled(middle)) > triangles ? fine : coarse) = middle;
  }
  const uint64_t above = part.count(scaled(fine)), below = part.count(scaled(coarse));
  return part.mesh(scaled(above - triangles < triangles - std::min(below, triangles) ? fine : coarse));
}

}  // namespace kerf
