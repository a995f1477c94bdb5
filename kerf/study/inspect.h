#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/io/camera.h"
#include "kerf/io/scene_description.h"
#include "kerf/scene/scene.h"

namespace kerf {

/// early_split(auto)+binned_sah, or binned_sah where the structure inspected has more references than primitives.
inline constexpr std::string_view kAutomaticTrial = "auto";
inline constexpr std::string_view kNoTrial = "none";

struct InspectOptions {
  BuildOptions build;
  uint32_t width = 320, height = 240;                ///< of the picture whose rays are traced
  size_t top = 10;                                   ///< primitives that are named
  std::string trial = std::string(kAutomaticTrial);  ///< a pipeline to trace the same rays in, or a word from above
  double overlap_seconds = 60;                       ///< when to give up on the end-point overlap of a structure
};

/// A primitive, with what a user needs to find it and to see what is wrong with it.
struct InspectedPrimitive {
  uint32_t object = 0, primitive = 0;  ///< numbers from 0, as in a Hit
  std::string_view kind;               ///< see kind_name()
  std::string place;                   ///< where its object is from
  std::string material;                ///< its name, empty where it has none
  std::vector<Vec3d> corners;          ///< of a sphere: its centre
  double radius = 0;                   ///< of a sphere
  double longest_edge = 0;             ///< of a sphere: its diameter
  double thinness = 0;                 ///< longest edge over the height on it; of a sphere 1
  double surface = 0;                  ///< of a flat one: both sides
  double box_area = 0;                 ///< of all six faces of its own box
  uint32_t references = 0;             ///< leaf slots that name it
  uint64_t tests = 0;                  ///< rays' tests of it
  uint64_t hits = 0;                   ///< rays that end on it; all other tests of it were in vain

  /// The chance that a random line through its box meets it (Crofton): the ratio of their surfaces.
  double fill() const { return box_area > 0 ? surface / box_area : 0; }
};

/// Medians over primitives.
struct TypicalPrimitive {
  double longest_edge = 0, thinness = 0, box_area = 0, fill = 0;
};

/// The fewest primitives that together take at least this share of all tests.
struct TestShare {
  double share = 0;
  size_t primitives = 0;
};

/// What the same rays cost in a structure, on average. Counts repeat exactly, times do not.
struct RayCosts {
  double nodes = 0, boxes = 0, primitives = 0;
  double seconds = 0;  ///< of one thread; median of several runs over some of the rays
};

/// What is known of a scene and its structure, all of it measured.
struct Inspection {
  size_t objects = 0;
  BuildReport report;
  std::optional<double> overlap;  ///< see end_point_overlap(); none: not finished in the time for it
  double root_area = 0;           ///< of the six faces of the box around everything

  size_t primary_rays = 0, diffuse_rays = 0;
  uint64_t hits = 0;   ///< rays that hit something
  uint64_t tests = 0;  ///< of primitives, by all rays
  RayCosts costs;
  bool is_attributed = false;  ///< it is known which primitives were tested; else nothing is named

  std::vector<TestShare> shares;                ///< for growing shares
  std::vector<InspectedPrimitive> most_tested;  ///< by falling tests, equal ones by number
  std::vector<InspectedPrimitive> most_wasted;  ///< by falling box_area - surface
  TypicalPrimitive typical;                     ///< of all
  TypicalPrimitive typical_costly;              ///< of the fewest that take half of all tests

  double surface = 0;     ///< summed over primitives
  double box_area = 0;    ///< of their own boxes, likewise
  double leaf_area = 0;   ///< of the leaves' boxes, times their slots
  double top_wasted = 0;  ///< of box_area - surface: that of most_wasted

  std::vector<uint64_t> leaves_by_depth;  ///< entry i: leaves at depth i
  std::vector<uint64_t> leaves_by_size;   ///< entry i: leaves with i slots
  Box3f largest_leaf;                     ///< the first of those with most slots

  struct Bytes {
    size_t vertices = 0, indices = 0, shapes = 0;  ///< the caller's: of meshes, and of spheres and parallelograms
    size_t slots = 0, nodes = 0;                   ///< the structure's; nodes: and all else
  } bytes;

  struct Trial {
    BuildReport report;
    RayCosts costs;
    std::optional<double> overlap;
    size_t split = 0;  ///< primitives with several references
  };
  std::optional<Trial> trial;
};

/// Builds the scene, shoots a primary ray through every pixel and a diffuse one from each of their hits, and says which
/// primitives they cost how much. The same, times apart, for any number of threads. Throws Error as build_scene() and
/// CameraRays do.
Inspection inspect(const SceneDescription& scene, const Camera& camera, const InspectOptions& options = {});

}  // namespace kerf
