// Studies: the rays, what is counted and timed, limits, and the paper's table.

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <fstream>
#include <set>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"
#include "kerf/render/camera.h"
#include "kerf/render/render_scene.h"
#include "kerf/study/paper.h"
#include "kerf/study/tables.h"
#include "kerf/study/turn.h"
#include "tests/support/error_of.h"
#include "tests/support/folder.h"
#include "tests/support/random_scene.h"

namespace kerf::test {
namespace {

/// Random triangles before a wall, and a camera that sees them all.
StudyScene small_scene(uint32_t triangles = 2000) {
  const RandomTriangles random(triangles);
  Mesh mesh;
  mesh.vertices = random.vertices;
  for (const TriangleCorners& corners : random.triangles)
    mesh.triangles.push_back({corners[0], corners[1], corners[2]});
  StudyScene scene;
  scene.name = "random";
  scene.description.is_lit = false;
  scene.description.materials.emplace_back();
  scene.description.objects.push_back({std::move(mesh), 0, true, "random"});
  scene.camera = {.eye = {0, 0, 40}, .look_at = {0, 0, 0}, .up = {0, 1, 0}, .fov = 40};
  return scene;
}

StudyOptions quick(std::vector<std::string> rows) {
  StudyOptions options;
  options.rows = std::move(rows);
  options.width = 60;
  options.height = 40;
  options.repeat = 3;
  options.with_overlap = false;
  return options;
}

constexpr RayKind kAllKinds[] = {RayKind::primary, RayKind::shadow, RayKind::ambient_occlusion, RayKind::diffuse};

std::vector<StudyRays> rays_of(const StudyScene& scene) {
  return make_study_rays(scene.description, scene.camera, 60, 40, kAllKinds);
}

bool is_equal(const Ray& a, const Ray& b) {
  return a.origin == b.origin && a.direction == b.direction && a.t_min == b.t_min && a.t_max == b.t_max &&
         a.mask == b.mask;
}

void expect_equal(const std::vector<StudyRays>& a, const std::vector<StudyRays>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].kind, b[k].kind);
    EXPECT_EQ(a[k].any_hit, b[k].any_hit);
    ASSERT_EQ(a[k].rays.size(), b[k].rays.size());
    for (size_t i = 0; i < a[k].rays.size(); ++i) ASSERT_TRUE(is_equal(a[k].rays[i], b[k].rays[i])) << k << ' ' << i;
  }
}

TEST(StudyRays, AreTheSameForAnyNumberOfThreads) {
  const StudyScene scene = small_scene();
  const std::vector<StudyRays> rays = rays_of(scene);
  for (const int threads : {1, 3}) {
    std::vector<StudyRays> again;
    with_threads(threads, [&] { again = rays_of(scene); });
    expect_equal(rays, again);
  }
}

TEST(StudyRays, StartOnWhatThePrimaryRaysHitAndLeaveIt) {
  const StudyScene study_scene = small_scene();
  const std::vector<StudyRays> rays = rays_of(study_scene);
  ASSERT_EQ(rays.size(), 4U);
  EXPECT_EQ(rays[0].rays.size(), 60U * 40U);
  const Scene scene = build_scene(study_scene.description);
  std::vector<Vec3f> normals;
  std::vector<Vec3d> places;
  for (const Ray& ray : rays[0].rays) {
    const Hit hit = scene.closest_hit(ray);
    if (!hit) continue;
    const Vec3f normal = scene.normal(hit);
    normals.push_back(dot(normal, ray.direction) > 0 ? -normal : normal);
    places.push_back(to_double(ray.origin) + to_double(ray.direction) * double{hit.t});
  }
  EXPECT_GT(places.size(), 100U);
  std::set<float> reaches;
  for (size_t k = 1; k < 4; ++k) {
    ASSERT_EQ(rays[k].rays.size(), places.size()) << rays[k].kind;
    for (size_t i = 0; i < places.size(); ++i) {
      const Ray& ray = rays[k].rays[i];
      const Vec3d offset = to_double(ray.origin) - places[i];
      EXPECT_LT(dot(offset, offset), 1e-8) << rays[k].kind;
      EXPECT_GT(dot(ray.direction, normals[i]), -1e-6F) << rays[k].kind;
    }
  }
  for (const Ray& ray : rays[2].rays) reaches.insert(ray.t_max);
  const Vec3d diagonal = to_double(scene.bounds().extent());
  ASSERT_EQ(reaches.size(), 1U);
  EXPECT_NEAR(*reaches.begin(), 0.1 * std::sqrt(dot(diagonal, diagonal)), 1e-4);
  EXPECT_TRUE(std::isinf(rays[3].rays[0].t_max));
}

TEST(StudyRays, ComeBackFromAFile) {
  const Folder folder;
  const std::string path = folder.path("rays.npy");
  const std::vector<StudyRays> rays = rays_of(small_scene(200));
  save_rays(path, rays);
  expect_equal(load_rays(path), rays);
  save_rays(path, {});
  EXPECT_TRUE(load_rays(path).empty());
}

TEST(StudyRays, AFileThatIsDamagedIsRefused) {
  const Folder folder;
  const std::string path = folder.path("rays.npy"), cut = folder.path("cut.npy");
  save_rays(path, rays_of(small_scene(50)));
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  const auto refusal = [&](const std::string& content) {
    std::ofstream(cut, std::ios::binary) << content;
    return error_of(ErrorCode::file, [&] { load_rays(cut); });
  };
  for (const size_t size : {size_t{0}, size_t{5}, size_t{9}, size_t{40}, size_t{200}, bytes.size() - 1}) {
    EXPECT_NE(refusal(bytes.substr(0, size)), "") << size;
  }
  EXPECT_NE(refusal(bytes + "x").find("behind its end"), std::string::npos);
  std::string other_kind = bytes;
  other_kind[bytes.size() - 4] = 9;
  EXPECT_NE(refusal(other_kind).find("kind 9"), std::string::npos);
  std::string many = bytes;
  many.replace(many.find("'shape': ("), 13, "'shape': (999");
  EXPECT_NE(refusal(many), "");
}

TEST(Study, CountsRepeatExactlyAndAgreeWithTheScene) {
  const StudyScene scene = small_scene();
  StudyOptions options = quick({"binned_sah", "early_split(budget=2)+binned_sah", "brute_force"});
  options.kinds.assign(std::begin(kAllKinds), std::end(kAllKinds));
  const std::vector<StudyResult> results = study(scene, options), again = study(scene, options);
  ASSERT_EQ(results.size(), 12U);
  ASSERT_EQ(again.size(), 12U);
  const std::vector<StudyRays> rays = rays_of(scene);
  for (size_t i = 0; i < results.size(); ++i) {
    const StudyResult& r = results[i];
    const StudyRays& kind = rays[i / 3];
    EXPECT_TRUE(r.finished);
    EXPECT_EQ(r.row, options.rows[i % 3]);
    EXPECT_EQ(r.rays, kind.kind);
    EXPECT_EQ(r.triangles, 2000U);
    EXPECT_EQ(r.nodes_per_ray, again[i].nodes_per_ray);
    EXPECT_EQ(r.triangles_per_ray, again[i].triangles_per_ray);
    EXPECT_EQ(r.hits, again[i].hits);
    EXPECT_EQ(r.tree_hash, again[i].tree_hash);
    EXPECT_EQ(r.hits, results[i - i % 3].hits) << "the same hits in every row";
    EXPECT_EQ(r.trace_seconds.count, 3);
    EXPECT_LE(r.trace_seconds.least, r.trace_seconds.median);
    EXPECT_LE(r.trace_seconds.median, r.trace_seconds.most);
    EXPECT_GT(r.build_seconds.median, 0);
    const Scene built = build_scene(scene.description, {.structure = r.row});
    TraceCounts counts;
    for (const Ray& ray : kind.rays)
      kind.any_hit ? void(built.any_hit(ray, counts)) : void(built.closest_hit(ray, counts));
    const auto count = static_cast<double>(kind.rays.size());
    EXPECT_EQ(r.nodes_per_ray, static_cast<double>(counts.nodes) / count);
    EXPECT_EQ(r.triangles_per_ray, static_cast<double>(counts.primitives) / count);
    EXPECT_EQ(r.boxes_per_ray, static_cast<double>(counts.boxes) / count);
  }
  for (size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(results[3 * k].speedup, 1);
    for (size_t i = 1; i < 3; ++i) EXPECT_GT(results[3 * k + i].speedup, 0);
  }
  EXPECT_NEAR(results[1].references_per_triangle, 2, 0.01);
}

TEST(Study, ARowOverItsLimitIsNotFinishedAndTheOthersAre) {
  const StudyScene scene = small_scene();
  StudyOptions options = quick({"binned_sah", "binned_sah(leaf=255,depth=1)", "sweep_sah"});
  options.limit_bytes = 100000;
  const std::vector<StudyResult> results = study(scene, options);
  ASSERT_EQ(results.size(), 3U);
  for (const StudyResult& result : results) EXPECT_FALSE(result.finished) << result.row;
  EXPECT_NE(results[0].why_not.find("100000"), std::string::npos) << results[0].why_not;

  options.limit_bytes = static_cast<size_t>(-1);
  options.rows = {"binned_sah(leaf=255,depth=1)", "sweep_sah"};
  const std::vector<StudyResult> some = study(scene, options);
  EXPECT_FALSE(some[0].finished);
  EXPECT_NE(some[0].why_not.find("depth of at least"), std::string::npos) << some[0].why_not;
  EXPECT_TRUE(some[1].finished);
  EXPECT_EQ(some[1].speedup, 1) << "the first that finished";
  const std::string text = text_tables(some);
  EXPECT_NE(text.find("not finished: "), std::string::npos) << text;
  EXPECT_NE(csv_table(some).find(",false,"), std::string::npos);
}

TEST(Study, TimeIsALimitToo) {
  const StudyScene scene = small_scene(20000);
  StudyOptions options = quick({"brute_force"});
  options.width = options.height = 400;
  options.limit_seconds = 0.05;
  const std::vector<StudyResult> results = study(scene, options);
  ASSERT_EQ(results.size(), 1U);
  EXPECT_FALSE(results[0].finished);
  EXPECT_NE(results[0].why_not.find("time allowed"), std::string::npos) << results[0].why_not;
}

TEST(Study, AnInterruptKeepsWhatIsFinished) {
  const StudyScene scene = small_scene();
  StudyOptions options = quick({"binned_sah", "sweep_sah"});
  options.progress = [&](double done, std::string_view what) {
    EXPECT_GE(done, 0);
    EXPECT_LE(done, 1);
    EXPECT_NE(what.find("_sah"), std::string_view::npos);
    return what.find("trace sweep_sah") == std::string_view::npos;  // two builds, two counts, one row timed
  };
  const std::vector<StudyResult> results = study(scene, options);
  ASSERT_EQ(results.size(), 2U);
  EXPECT_TRUE(results[0].finished);
  EXPECT_EQ(results[0].trace_seconds.count, 1);
  EXPECT_FALSE(results[1].finished);
  EXPECT_EQ(results[1].why_not, "it was interrupted");
}

TEST(Study, RefusesARowThatIsNoPipeline) {
  EXPECT_NE(
      error_of(ErrorCode::invalid_option, [] { study(small_scene(), quick({"binned_shah"})); }).find("binned_sah"),
      std::string::npos);
}

TEST(Study, TakesAnEmptyScene) {
  StudyScene scene = small_scene();
  scene.description.objects.clear();
  for (const StudyResult& result : study(scene, quick({"binned_sah", "brute_force"}))) {
    EXPECT_TRUE(result.finished);
    EXPECT_EQ(result.hits, 0U);
    EXPECT_EQ(result.triangles, 0U);
  }
}

TEST(Paper, TheTableAgreesWithItself) {
  // S is the ratio of the times; a figure copied wrongly would show.
  for (const PaperTableScene& scene : paper_table()) {
    for (const PaperTableRow* row : {&scene.plain, &scene.coarse, &scene.fine, &scene.kd_tree}) {
      const double ratio = scene.plain.figures.trace_seconds / row->figures.trace_seconds;
      EXPECT_NEAR(row->figures.speedup, ratio, 0.011) << scene.name << ' ' << row->label;
    }
  }
}

TEST(Paper, LimitsGiveTheRatiosOfTheTable) {
  const StudyScene scene = small_scene(3000);
  for (const PaperTableScene& paper : paper_table()) {
    StudyOptions options = quick({});
    std::vector<double> ratios;
    for (const PaperStudyRow& row : paper_rows(scene.description, paper)) {
      if (!row.pipeline.starts_with("early_split")) continue;
      options.rows.push_back(row.pipeline);
      ratios.push_back(row.paper->references_per_triangle);
    }
    ASSERT_EQ(ratios.size(), 2U);
    options.repeat = 1;
    const std::vector<StudyResult> results = study(scene, options);
    for (size_t i = 0; i < 2; ++i) EXPECT_NEAR(results[i].references_per_triangle, ratios[i], 0.01 * ratios[i]);
  }
}

TEST(Paper, ASweepGoesFromOneToMany) {
  const StudyScene scene = small_scene();
  StudyOptions options = quick(sweep_rows(scene.description));
  options.repeat = 1;
  const std::vector<StudyResult> results = study(scene, options);
  ASSERT_GE(results.size(), 10U);
  EXPECT_EQ(results.front().references_per_triangle, 1);
  EXPECT_GT(results.back().references_per_triangle, 9);
  for (size_t i = 1; i < results.size(); ++i) {
    EXPECT_GT(results[i].references_per_triangle, results[i - 1].references_per_triangle);
    EXPECT_LT(results[i].sa_max, results[i - 1].sa_max);
  }
}

TEST(Turn, AScenesHitsTurnWithIt) {
  const StudyScene scene = small_scene();
  const Transform turn = turn_by_name("xyz");
  const SceneDescription other = turned(scene.description, turn);
  const Camera camera = turned(scene.camera, turn);
  const Scene before = build_scene(scene.description), after = build_scene(other);
  const CameraRays a(scene.camera, 60, 40), b(camera, 60, 40);
  size_t different = 0, hits = 0;
  for (uint32_t y = 0; y < 40; ++y) {
    for (uint32_t x = 0; x < 60; ++x) {
      const Hit one = before.closest_hit(a.center(x, y)), two = after.closest_hit(b.center(x, y));
      hits += one ? 1 : 0;
      different += static_cast<bool>(one) != static_cast<bool>(two) || (one && one.primitive != two.primitive) ? 1 : 0;
    }
  }
  EXPECT_GT(hits, 80U);
  EXPECT_LE(different, hits / 100) << "only edges move, by a rounding";
  EXPECT_NE(error_of(ErrorCode::invalid_option, [] { turn_by_name("xyzz"); }).find("xyz"), std::string::npos);
}

TEST(Tables, NumbersAreShortAndNamesAreFolded) {
  EXPECT_EQ(bytes_text(999), "999 B");
  EXPECT_EQ(bytes_text(1500), "1.5 kB");
  EXPECT_EQ(bytes_text(23456789), "23 MB");
  EXPECT_EQ(bytes_text(4200000000), "4.2 GB");
  StudyResult result;
  result.scene = "a, \"b\"";
  result.row = "early_split(sa_max=0.000123456,cap=1000)+binned_sah(bins=64,leaf=2)+late_split(budget=1.5,restore=on)";
  result.rays = "primary";
  const std::string text = text_tables({&result, 1});
  EXPECT_NE(text.find("\n  +late_split"), std::string::npos) << text;
  EXPECT_NE(csv_table({&result, 1}).find("\"a, \"\"b\"\"\""), std::string::npos);
  EXPECT_EQ(text_tables({}), "");
}

}  // namespace
}  // namespace kerf::test
