#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kerf/base/box3.h"
#include "kerf/geometry/geometry.h"
#include "kerf/geometry/hit.h"
#include "kerf/geometry/ray.h"
#include "kerf/geometry/ray_columns.h"
#include "kerf/references/split_result.h"
#include "kerf/scene/memory_need.h"
#include "kerf/scene/presets.h"
#include "kerf/scene/refit.h"
#include "kerf/scene/structure.h"
#include "kerf/trace/trace_table.h"

namespace kerf {

/// How Scene::build() works.
struct BuildOptions {
  /// A preset, or a pipeline: perhaps a splitter, then a builder,
  /// perhaps optimisers and perhaps a layout, or a structure,
  /// joined by '+', options in parentheses; see menu().
  std::string structure{kDefaultStructure};
  int threads = 0;            ///< 0: as many as the caller's arena has
  bool skip_invalid = false;  ///< drop primitives that are not finite or have a bad index, instead of an error
  bool refittable = false;    ///< keep what refit() needs, and primitives that may get an area
  /// When to give up. A limit on bytes below what is possible is refused before work starts, see Scene::memory_need();
  /// where it allows fewer references than a splitter or spatial_split would make, fewer are made, and
  /// BuildReport::short_of_room says so.
  WorkLimit limit = {};
  /// Called with the share that is done, from 0 at once to 1 at the end, and what is being done; returns false to
  /// cancel the build, which then throws Error(stopped). From whichever thread works, one at a time, some 20 times a
  /// second at most; the share never falls. What it throws comes out of build().
  WorkMeter::Progress progress = nullptr;
};

/// What a build did and what came of it.
struct BuildReport {
  std::string structure;                ///< the pipeline in its canonical spelling
  size_t primitives = 0;                ///< that the caller gave
  size_t invalid = 0;                   ///< of those: dropped because of skip_invalid
  size_t degenerate = 0;                ///< of those: without area, so never hit; left out, if not `refittable`
  size_t references = 0;                ///< in the leaves
  double references_per_primitive = 0;  ///< R: references / (primitives that were not dropped or left out); 0 if none
  /// The limit that the splitter used: a surface area, or refine's edge length or area; infinite without a splitter,
  /// NaN where it was chosen for each part of the scene.
  double sa_max = 0;
  /// The limit asked for would have passed the cap on references, or the room for them, so the splitter raised it.
  bool capped = false;
  /// Stages of the pipeline, splitter and builder, that would have cut more, as their options allow, had BuildOptions::
  /// limit left room for more references; empty where it made no difference, though it may be below what the options
  /// allow.
  std::vector<std::string> short_of_room;
  std::optional<SplitChoice> choice;  ///< of automatic splitting: how far it went, and why
  size_t bytes = 0;                   ///< of what rays are traced through, without the caller's memory
  size_t peak_bytes = 0;              ///< the most that the build's large arrays took at once, the outcome's included
  size_t nodes = 0, leaves = 0;
  uint32_t depth = 0;           ///< edges from the root to the deepest leaf
  uint32_t largest_leaf = 0;    ///< slots
  double sah_cost = 0;          ///< see Structure::cost()
  uint64_t tree_hash = 0;       ///< equal for equal trees; 0 without a tree
  std::string instruction_set;  ///< that queries run on, by its name in instruction_sets(): "scalar" without vectors
  struct Seconds {
    double references = 0, split = 0, build = 0, optimise = 0, layout = 0, total = 0;
  } seconds;
};

/// BuildReport::short_of_room in a clause, such as "the limit of bytes left spatial_split no room to cut as the options
/// allow"; it must not be empty.
std::string room_sentence(std::span<const std::string> short_of_room);

/// Primitives and what finds which of them rays hit.
///
///     kerf::Scene scene;
///     scene.add(kerf::TriangleMesh{vertices, triangles});
///     scene.build();
///     kerf::Hit hit = scene.closest_hit({.origin = {0, 0, 5}, .direction = {0, 0, -1}});
///
/// The scene looks at the caller's memory: vertices and indices must stay unchanged until the next build, refit or the
/// scene's end, though some layouts (bvh4, bvh8, quantised_bvh8) trace copies of triangles. Queries are const and may
/// come from any number of threads. Their outcome depends on neither the structure, the instruction set, the number of
/// threads nor the caller's floating-point mode; among equally near primitives the one with the smaller geometry, then
/// primitive number is hit.
class Scene {
 public:
  Scene();
  ~Scene();
  Scene(Scene&& other) noexcept;
  Scene& operator=(Scene&& other) noexcept;

  /// Adds a geometry and returns its number, from 0. It is seen by queries after the next build().
  uint32_t add(Geometry geometry);
  uint32_t add(const TriangleMesh& mesh, uint32_t mask = 0xFFFFFFFFU) { return add(Geometry{mesh, mask}); }
  uint32_t add(Strided<Sphere> spheres, uint32_t mask = 0xFFFFFFFFU) { return add(Geometry{spheres, mask}); }
  uint32_t add(Strided<Parallelogram> shapes, uint32_t mask = 0xFFFFFFFFU) { return add(Geometry{shapes, mask}); }

  /// Makes what was added ready for queries; an empty scene hits nothing. Throws Error for a pipeline that is wrong
  /// or a KERF_ISA that this machine cannot run (invalid_option), a primitive that is wrong (invalid_geometry, naming
  /// the first and how many) or a limit that was reached or a progress() that returned false (stopped); the scene then
  /// answers as before.
  const BuildReport& build(const BuildOptions& options = {});

  /// Follows vertices that moved, without a new tree: boxes are made anew, what stands in which leaf stays. The tree
  /// gets worse the more the shape changes; the report says by how much. For a scene built with `refittable`. `moved`:
  /// all that was built, of the same kinds and counts, in the same memory or in other, which the scene looks at from
  /// then on. Not while queries run. Throws Error(not_built) before build(), Error(invalid_option) for a scene that was
  /// not built for it, and what RestPose::refit() throws; the scene then looks at the memory that it looked at before.
  const RefitReport& refit(std::span<const Geometry> moved, int threads = 0);
  /// The same for vertices that were changed where they are. After an Error(invalid_geometry) queries may miss what
  /// moved until a refit() that succeeds.
  const RefitReport& refit(int threads = 0);
  /// What a build with these options would take: known before any work is done. Throws Error(invalid_option) for a
  /// pipeline that is wrong.
  MemoryNeed memory_need(const BuildOptions& options = {}) const;

  /// What the last build did. Throws Error(not_built) before the first.
  const BuildReport& report() const;

  /// What rays are traced through.
  const Structure& structure() const;
  /// What was added, as the structure's slots number it.
  std::span<const Geometry> geometries() const;

  /// The box around everything that can be hit; empty where nothing can.
  Box3f bounds() const;

  /// The nearest hit in [t_min, t_max], or a Hit that converts to false. Throws Error(not_built) before build().
  Hit closest_hit(const Ray& ray) const { return table_->closest(data_, ray); }
  /// Whether anything is hit in [t_min, t_max].
  bool any_hit(const Ray& ray) const { return table_->any(data_, ray); }

  /// The same, and adds the work done to `counts`.
  Hit closest_hit(const Ray& ray, TraceCounts& counts) const { return table_->closest_counted(data_, ray, counts); }
  bool any_hit(const Ray& ray, TraceCounts& counts) const { return table_->any_counted(data_, ray, counts); }

  /// The unit normal where a hit of this scene lies; see unit_normal(). Zero for a miss.
  Vec3f normal(const Hit& hit) const;

  /// One result for each ray, in order, on `threads` threads (0: all of the caller's arena; 1: the calling thread).
  /// Throws Error(invalid_argument) if the lengths differ.
  void closest_hit(std::span<const Ray> rays, std::span<Hit> hits, int threads = 0) const;
  void any_hit(std::span<const Ray> rays, std::span<uint8_t> hits, int threads = 0) const;
  /// The same for rays and hits in columns. Throws Error(invalid_argument) that names the first of another length.
  void closest_hit(const RayColumns& rays, const HitColumns& hits, int threads = 0) const;
  void any_hit(const RayColumns& rays, std::span<uint8_t> hits, int threads = 0) const;
  /// On the calling thread, and adds the work done to `counts`.
  void closest_hit(std::span<const Ray> rays, std::span<Hit> hits, TraceCounts& counts) const;
  void any_hit(std::span<const Ray> rays, std::span<uint8_t> hits, TraceCounts& counts) const;

 private:
  struct Added;
  struct Built;
  std::unique_ptr<Added> added_;
  std::unique_ptr<Built> built_;
  const TraceTable* table_;
  const void* data_ = nullptr;
};

}  // namespace kerf
