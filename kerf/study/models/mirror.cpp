// The mirror: the side mirror of a car as a CAD assembly. It stands in for the part in Ernst and Greiner, "Early Split
// Clipping for Bounding Volume Hierarchies" (2007), at 85,651 and 334,080 triangles. Lengths are in millimetres; the
// glass faces z, y is up, and the car is on the side of -x. Thin walls, ribs and fillets are as in a part that is
// moulded of plastic; everything inside is modelled too.

#include <cmath>
#include <numbers>

#include "kerf/study/models/models.h"
#include "kerf/study/models/surfaces.h"

namespace kerf {
namespace {

constexpr double kWall = 2.5;
constexpr Vec3d kHalf{122, 80, 92};  // of the shell, to its rim and to its back
constexpr double kFlare = 1.0 / 3;   // makes the rim smooth at the corners of its rectangle
constexpr double kTaper = 0.13;      // the shell is lower towards its outer end

/// What is bent less than by this radius is cut by its largest edge, the rest by its chord.
constexpr double kFlatRadius = 2000;

/// Where a map of [-1, 1]^2 lies across the z axis: a rectangle with round corners.
Vec3d across(double s, double t, double inset) {
  const double x = (kHalf.x - inset) * s * (1 - kFlare * t * t), y = (kHalf.y - inset) * t * (1 - kFlare * s * s);
  return {x, y * (1 - kTaper * s), 0};
}

/// The shell, `inset` inside its outer face: polynomial in both parameters, steep at the rim and flat behind.
Surface shell(double inset) {
  return [=](double s, double t) {
    const double depth = (1 - s * s * s * s) * (1 - t * t * t * t) + 0.12 * s * (1 - s * s);
    Vec3d p = across(s, t, inset);
    p.z = -(kHalf.z - inset) * depth;
    return p;
  };
}

Transform at(Vec3d p) {
  Transform place;
  place.translation = p;
  return place;
}

std::vector<double> even(double low, double high, uint32_t cells) {
  std::vector<double> knots;
  for (uint32_t i = 0; i <= cells; ++i) knots.push_back(low + (high - low) * i / cells);
  return knots;
}

/// The housing with the opening for the arm, one for the cable, and four drains.
void add_housing(Faces& faces) {
  Sheets sheets{shell(0), shell(kWall), even(-1, 1, 8), even(-1, 1, 6), {}};
  sheets.holes = {{1, 1, 0.10, 0.13},  {1, 3, 0.03, 0.04},  {2, 0, 0.02, 0.025},
                  {3, 0, 0.02, 0.025}, {4, 0, 0.02, 0.025}, {5, 0, 0.02, 0.025}};
  sheets.round_rim = [](Vec3d) { return Vec3d{0, 0, 1}; };
  add_sheets(faces, sheets);
}

/// The lamp in the housing's back, a strip of lens with a frame of its own.
void add_lamp(Faces& faces) {
  const Sheets lens{shell(-2.5), shell(-0.8), even(-0.2, 0.86, 5), {0.1, 0.24}, {}};
  add_sheets(faces, lens);
  for (int i = 0; i < 14; ++i) {  // its flutes
    const double s = -0.16 + 0.07 * i;
    add_sweep(faces,
              {circle_profile(0.9), [=](double v) { return shell(-2.7)(s + 0.02 * v, 0.115 + 0.11 * v); }, {0, 0, 1}});
  }
}

/// The glass, bent about both axes, and the seal around it.
void add_glass(Faces& faces) {
  const auto sheet = [](double z) {
    return [=](double s, double t) {
      Vec3d p = across(s, t, 7);
      p.z = z - (p.x * p.x + p.y * p.y) / 2800;
      return p;
    };
  };
  Sheets glass{sheet(-3), sheet(-5.2), even(-1, 1, 2), even(-1, 1, 2), {}};
  glass.round_rim = [](Vec3d p) { return Vec3d{p.x, p.y, 0}; };
  add_sheets(faces, glass);
  for (uint32_t side = 0; side < 4; ++side) {
    const auto seal = [=](double v) {
      const double along = 2 * v - 1, fixed = side == 1 || side == 2 ? 1 : -1;
      Vec3d p = side % 2 == 0 ? across(along, fixed, 4.6) : across(fixed, along, 4.6);
      p.z = -4 - (p.x * p.x + p.y * p.y) / 2800;
      return p;
    };
    add_sweep(faces, {circle_profile(1.4), seal, {0, 0, 1}, 2});
  }
}

/// The plate behind the glass: a grid of holes, and rims around them.
void add_carrier(Faces& faces) {
  const auto sheet = [](double z) {
    return [=](double s, double t) {
      Vec3d p = across(s, t, 12);
      p.z = z - (p.x * p.x + p.y * p.y) / 2800;
      return p;
    };
  };
  Sheets plate{sheet(-7), sheet(-9.5), even(-1, 1, 10), even(-1, 1, 6), {}};
  for (uint32_t j = 0; j < 6; ++j) {
    for (uint32_t i = 0; i < 10; ++i) {
      const bool is_full = (i == 0 || i == 9 || j == 0 || j == 5) || (i >= 4 && i <= 5 && j >= 2 && j <= 3);
      if (!is_full) plate.holes.push_back({i, j, 0.06, 0.09});
    }
  }
  add_sheets(faces, plate);
}

/// Ribs across the housing, from behind the carrier to the shell's inside, each with round holes.
void add_ribs(Faces& faces) {
  constexpr double kTop = -16, kThick = 1.8;
  const auto add = [&](bool is_upright, double where, double low, double high, uint32_t cells) {
    const auto sheet = [=](double offset) {
      return [=](double s, double t) {
        const double s_on = is_upright ? where : s, t_on = is_upright ? s : where;
        const Vec3d foot = shell(kWall)(s_on, t_on);
        Vec3d p = foot;
        p.z = foot.z + (kTop - foot.z) * t;
        (is_upright ? p.x : p.y) += offset;
        return p;
      };
    };
    const double side = is_upright ? 1 : -1;
    Sheets rib{sheet(side * kThick / 2), sheet(-side * kThick / 2), even(low, high, cells), {0, 0.15, 0.85, 1}, {}};
    for (uint32_t i = 0; i < cells; ++i) {
      if (i % 2 == 1) rib.holes.push_back({i, 1, 0.3 * (high - low) / cells, 0.2});
    }
    add_sheets(faces, rib);
  };
  for (const double s : {-0.62, -0.4, 0.4, 0.62, 0.8}) add(true, s, -0.75, 0.75, 7);
  for (const double t : {-0.55, 0.0, 0.55}) add(false, t, -0.8, 0.8, 9);
}

constexpr double kScrewLength = 14;

/// A pan head with a socket, a neck and a shank, along z; the head's top is at z = 0.
void add_screw(Faces& faces, double radius, const Transform& place) {
  const double head = 1.9 * radius, high = 1.3 * radius, socket = 0.8 * radius;
  add_revolved(faces,
               {{0, -kScrewLength},
                {0.6 * radius, -kScrewLength, 0.2 * radius},
                {radius, -kScrewLength + radius},
                {radius, -high, 0.2 * radius},
                {head, -high, 0.15 * radius},
                {head, 0, 0.6 * radius},
                {socket, 0, 0.1 * radius},
                {socket, -0.7 * high},
                {0, -0.7 * high - 0.3 * radius}},
               place);
  add_revolved(faces,
               {{1.05 * radius, -high - 0.9},
                {2.3 * radius, -high - 0.9, 0.2},
                {2.3 * radius, -high - 0.1, 0.2},
                {1.05 * radius, -high - 0.1},
                {1.05 * radius, -high - 0.9}},
               place);
}

/// The drive that turns the glass: a stepped can with ball, sockets, two spindles and a spring.
void add_drive(Faces& faces) {
  add_revolved(faces,
               {{0, -58},
                {20, -58, 3},
                {24, -48, 4},
                {34, -44, 3},
                {34, -26, 2},
                {28, -24, 1.5},
                {28, -20, 1.5},
                {16, -19, 2},
                {12, -16},
                {0, -16}},
               {});
  add_revolved(faces, {{0, -15.8}, {9, -15.8, 7}, {11, -9.7, 1}, {0, -9.7}}, {});
  for (const double angle : {20.0, 110.0, 200.0, 290.0}) {
    const Transform turn = rotation(kZ, angle);
    const size_t first = faces.size();
    add_revolved(faces, {{0, -40}, {3.2, -40, 0.6}, {3.2, -12, 0.6}, {2.2, -11}, {0, -11}}, at({41, 0, 0}));
    add_box(faces, {33, -4, -38}, {41, 4, -28});
    add_screw(faces, 1.5, at({29, 8, -22}));
    place_faces(faces, first, turn);
  }
  constexpr uint32_t kHalfTurns = 14;
  const Curve coil = [](double v) {
    const double angle = std::numbers::pi * kHalfTurns * v;
    return Vec3d{14 * std::cos(angle), 14 * std::sin(angle), -12 - 6 * v};
  };
  add_sweep(faces, {circle_profile(0.35), coil, {0, 0, 1}, kHalfTurns});
}

constexpr Vec3d kFoot{-176, -62, -40};

/// Where the middle of the arm runs, from the foot into the housing's opening, and on either side of it.
Vec3d arm_path(double v) { return bezier_curve({kFoot, {-140, -62, -60}, {-105, -50, -102}, {-68, -37, -62}})(v); }

/// The arm to the car, hollow, and its foot with screws and a gasket.
void add_arm(Faces& faces) {
  Sweep arm{rounded_rectangle_profile(30, 22, 7), arm_path, {0, 1, 0}, 3};
  arm.scale = [](double v) { return 1.5 - 0.8 * v; };
  add_sweep(faces, arm);
  const auto foot = [](double x, double grow) {
    return [=](double s, double t) {
      const double y = (46 + grow) * t * (1 - 0.28 * s * s), z = -(60 + grow) * s * (1 - 0.28 * t * t);
      return kFoot + Vec3d{x - 0.0008 * z * z, y, z};
    };
  };
  Sheets plate{foot(0, 0), foot(-6, 0), even(-1, 1, 5), even(-1, 1, 5), {}};
  plate.holes = {{0, 2, 0.07, 0.09}, {4, 1, 0.07, 0.09}, {4, 3, 0.07, 0.09}, {2, 0, 0.05, 0.065}, {2, 4, 0.05, 0.065}};
  const auto outward = [](Vec3d p) { return Vec3d{0, p.y - kFoot.y, p.z - kFoot.z}; };
  plate.round_rim = outward;
  add_sheets(faces, plate);
  Sheets gasket{foot(-6.2, 3), foot(-9, 3), even(-1, 1, 3), even(-1, 1, 3), {{1, 1, 0.25, 0.25}}};
  gasket.round_rim = outward;
  add_sheets(faces, gasket);
  for (const auto& [s, t] : {std::array{-0.8, 0.0}, {0.8, -0.4}, {0.8, 0.4}}) {
    const Vec3d p = foot(4, 0)(s, t);
    add_screw(faces, 3.2, then(rotation(kY, 90), at(p)));
  }
}

/// Cables through the arm to the drive and the lamp, and plugs at their ends.
void add_cables(Faces& faces) {
  constexpr double kCableBegin = -0.2;  // of the arm's path, outside its foot
  for (int i = 0; i < 5; ++i) {
    const double off = 2.6 * (i - 2);
    const auto cable = [=](double v) { return arm_path(kCableBegin + 1.45 * v) + Vec3d{0, off, 0.4 * off}; };
    add_sweep(faces, {circle_profile(1.1), cable, {0, 1, 0}, 4});
  }
  const Curve lamp_wire = bezier_curve({Vec3d{-34, 8, -50}, {-10, 40, -70}, {30, 25, -76}, {60, 14, -70}});
  add_sweep(faces, {circle_profile(1.1), lamp_wire, {0, 1, 0}, 4});
  const Vec3d plug = arm_path(kCableBegin);
  add_box(faces, plug + Vec3d{-11, -10, -8}, plug + Vec3d{0.5, 10, 8});
  for (int i = 0; i < 10; ++i) {  // its pins
    const int column = i % 5, row = i / 5;
    const double y = -8 + 4 * column, z = -3 + 6 * row;
    const size_t first = faces.size();
    add_cylinder(faces, 0.6, 9, rotation(kY, -90));
    place_faces(faces, first, at(plug + Vec3d{-11, y, z}));
  }
}

/// Bosses inside the shell with the screws that hold the carrier's frame.
void add_bosses(Faces& faces) {
  for (const double s : {-0.55, 0.1, 0.55}) {
    for (const double t : {-0.42, 0.42}) {
      const Vec3d p = shell(kWall)(s, t);
      const double base = p.z + 3;
      add_revolved(faces,
                   {{2, base}, {6, base + 0.5, 2}, {4.2, base + 6, 2}, {4.2, -17, 0.5}, {2, -17, 0.3}, {2, base}},
                   at({p.x, p.y, 0}));
      add_screw(faces, 1.9, at({p.x, p.y, -12}));
    }
  }
}

}  // namespace

MadeModel make_mirror(uint64_t triangles, uint64_t) {
  Faces faces;
  add_housing(faces);
  add_lamp(faces);
  add_glass(faces);
  add_carrier(faces);
  add_ribs(faces);
  add_drive(faces);
  add_arm(faces);
  add_cables(faces);
  add_bosses(faces);
  constexpr double kEdge = 10;
  const Tessellator part(std::move(faces));
  return {tessellate_to(part, triangles, {kEdge, kEdge * kEdge / (8 * kFlatRadius)}),
          {{-230, 130, -330}, {-50, -22, -40}, {0, 1, 0}, 38}};
}

}  // namespace kerf
