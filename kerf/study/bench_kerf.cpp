#include "kerf/study/bench_kerf.h"

#include <algorithm>

#include "kerf/render/render_scene.h"
#include "kerf/scene/pipeline.h"

namespace kerf {
namespace {

/// The last stage if it is a layout or a structure, else the layout that a tree gets by itself: of a preset, unless it
/// turns out to have very many references.
std::string_view layout_of(const Pipeline& pipeline) {
  const MenuEntry& last = *pipeline.stages.back().entry;
  return last.kind == "layout" || last.kind == "structure" ? last.name
         : pipeline.ends_with_preset                       ? preset_layout(0).name
                                                           : layouts().front().name;
}

/// The preset that the text begins with, else the pipeline without its layout.
std::string quality_of(const std::string& text, const Pipeline& pipeline) {
  std::string first = text.substr(0, text.find('+'));
  for (const PresetEntry& preset : presets()) {
    if (preset.name == first) return first;
  }
  Pipeline rest = pipeline;
  if (rest.stages.size() > 1 && rest.stages.back().entry->kind == "layout") rest.stages.pop_back();
  return rest.text();
}

class KerfPass : public BenchPass {
 public:
  KerfPass(const Scene& scene, const RaysToTrace& rays, Feed feed) : scene_(scene), rays_(rays), feed_(feed) {
    rays.rays.any_hit ? any_.resize(rays.rays.rays.size()) : hits_.resize(rays.rays.rays.size());
  }

  void trace() override {
    const std::span<const Ray> rays = rays_.rays.rays;
    if (feed_ == Feed::batch) {
      rays_.rays.any_hit ? scene_.any_hit(rays, std::span(any_), rays_.threads)
                         : scene_.closest_hit(rays, std::span(hits_), rays_.threads);
      return;
    }
    for_stretches(rays_, rays.size(), 1, [&](size_t begin, size_t end) {
      if (rays_.rays.any_hit) {
        for (size_t i = begin; i < end; ++i) any_[i] = static_cast<uint8_t>(scene_.any_hit(rays[i]));
      } else {
        for (size_t i = begin; i < end; ++i) hits_[i] = scene_.closest_hit(rays[i]);
      }
    });
  }

  std::vector<Hit> hits() const override {
    std::vector<Hit> all = hits_;
    for (const uint8_t is_hit : any_) all.push_back(is_hit != 0 ? Hit{0, 0, 0, 0, 0, kNone} : Hit{});
    return all;
  }

 private:
  const Scene& scene_;
  RaysToTrace rays_;
  Feed feed_;
  std::vector<Hit> hits_;
  std::vector<uint8_t> any_;
};

class KerfSubject : public BenchSubject {
 public:
  KerfSubject(const SceneDescription& scene, const std::string& pipeline, const MeasureOptions& options)
      : description_(scene), pipeline_(pipeline), options_(options) {
    const Pipeline parsed = parse_pipeline(pipeline);
    row_.quality = quality_of(pipeline, parsed);
    row_.layout = layout_of(parsed);
    row_.builder = parsed.text();
  }

  BenchRow describe() const override { return row_; }

  BenchRow build(const WorkLimit& limit) override {
    scene_ = built(limit);
    const BuildReport& report = scene_.report();
    row_.finished = true;
    row_.why_not.clear();
    row_.references = static_cast<double>(report.references);
    row_.short_of_room = report.short_of_room;
    row_.bytes = report.bytes;
    row_.isa = report.instruction_set;
    row_.builds = {report.seconds.total};
    return row_;
  }

  double time_build(const WorkLimit& limit) const override { return built(limit).report().seconds.total; }

  std::vector<Feed> feeds() const override { return {Feed::loop, Feed::batch}; }

  std::unique_ptr<BenchPass> prepare(const RaysToTrace& rays, Feed feed) const override {
    return std::make_unique<KerfPass>(scene_, rays, feed);
  }

 private:
  Scene built(const WorkLimit& limit) const {
    return build_scene(
        description_,
        {.structure = pipeline_, .threads = options_.threads, .skip_invalid = options_.skip_invalid, .limit = limit});
  }

  const SceneDescription& description_;
  std::string pipeline_;
  const MeasureOptions& options_;
  BenchRow row_;
  Scene scene_;
};

}  // namespace

std::unique_ptr<BenchSubject> kerf_subject(const SceneDescription& scene, const std::string& pipeline,
                                           const MeasureOptions& options) {
  return std::make_unique<KerfSubject>(scene, pipeline, options);
}

}  // namespace kerf
