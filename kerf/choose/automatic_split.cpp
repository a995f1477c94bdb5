#include "kerf/choose/automatic_split.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"
#include "kerf/choose/split_guide.h"
#include "kerf/references/box_around.h"
#include "kerf/references/fit_limit.h"
#include "kerf/references/split_each.h"

namespace kerf {
namespace {

constexpr size_t kSamples = 4096;      // of small references, that judge planes with all large ones; if that is more:
constexpr size_t kSampleShare = 64;    // one of so many
constexpr size_t kCandidateShare = 2;  // of so many the largest may be cut
constexpr size_t kThresholdProbes = 65536;
constexpr size_t kGrain = 16384;
// Where the pieces pass the cap, twice the gain is asked for until they fit, then less again in a few steps.
constexpr double kPlaneGain = 0.02, kStrictest = 0x1p30;
constexpr int kSteps = 5;

/// The boxes of a scene as a whole.
struct Areas {
  std::vector<float> of;  ///< each reference's half area / that of the box around all
  double whole = 0;       ///< half area of the box around all
  double sum = 0;         ///< of `of`

  /// Predicted cost of a random line through n references whose half areas add up to `areas` times the whole.
  static double cost(double n, double areas) { return std::log2(n + 1) + areas; }

  /// An area that about every `share`-th reference passes, judged by evenly spaced probes.
  float passed_by(size_t share) const {
    const size_t step = (of.size() + kThresholdProbes - 1) / kThresholdProbes;
    std::vector<float> probes;
    for (size_t i = 0; i < of.size(); i += step) probes.push_back(of[i]);
    const size_t rank = std::min(probes.size() - 1, probes.size() / share);
    std::nth_element(probes.begin(), probes.begin() + static_cast<ptrdiff_t>(rank), probes.end(), std::greater<>());
    return probes[rank];
  }
};

Areas measure(std::span<const Reference> references) {
  Areas areas;
  areas.of.resize(references.size());
  const size_t blocks = (references.size() + kGrain - 1) / kGrain;
  areas.whole = half_area(box_around(references));
  std::vector<double> sums(blocks);
  parallel_for(references.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const double share = half_area(references[i].bounds()) / areas.whole;
      areas.of[i] = static_cast<float>(share);
      sums[begin / kGrain] += share;
    }
  });
  for (const double sum : sums) areas.sum += sum;
  return areas;
}

/// The references that the guide is for, all of which may be cut: the larger half, and a sample of all, which judges.
std::vector<GuidedReference> to_guide(std::span<const Reference> whole, const Areas& areas) {
  const size_t rate = std::clamp<size_t>(whole.size() / kSamples, 1, kSampleShare);
  const float large = areas.passed_by(rate), candidate = areas.passed_by(kCandidateShare);
  std::vector<GuidedReference> guided;
  for (uint32_t i = 0; i < whole.size(); ++i) {
    const bool is_large = areas.of[i] > large;
    if (is_large || i % rate == 0) {
      guided.push_back({whole[i], i, is_large ? 1.0F : static_cast<float>(rate)});
    } else if (areas.of[i] >= candidate) {
      guided.push_back({whole[i], i, 0});
    }
  }
  return guided;
}

/// All references in the caller's order, each that went through the guide replaced by its pieces.
std::vector<Reference> gather(std::span<const Reference> whole, const GuidedPieces& pieces) {
  std::vector<uint32_t> begins(whole.size() + 1);  // first how many pieces each has, then where they begin
  for (const auto& cell : pieces.cells) {
    for (const GuidedReference& guided : cell) ++begins[guided.place];
  }
  uint32_t begin = 0;
  for (uint32_t& count : begins) {
    if (&count != &begins.back()) count = std::max<uint32_t>(1, count);
    begin += std::exchange(count, begin);
  }
  std::vector<Reference> all(begins.back());
  for (size_t i = 0; i < whole.size(); ++i) all[begins[i]] = whole[i];
  for (const auto& cell : pieces.cells) {
    for (const GuidedReference& guided : cell) all[begins[guided.place]++] = guided.reference;
  }
  return all;
}

/// How the predicted cost fell: first by the guide's planes, then by cuts in its cells, the most saving first.
SplitChoice explain(std::span<const Reference> whole, std::span<const Reference> pieces, const Areas& areas,
                    const GuidedPieces& guided) {
  const auto n = static_cast<double>(whole.size());
  double sum = 0;
  for (const Reference& piece : pieces) sum += half_area(piece.bounds()) / areas.whole;
  auto count = static_cast<double>(pieces.size());
  SplitChoice choice;
  choice.curve.push_back({count / n, Areas::cost(count, sum)});
  for (const GainCurve::Bucket& bucket : guided.curve.buckets) {  // backwards, the least saving first
    if (bucket.references == 0) continue;
    count -= static_cast<double>(bucket.references);
    sum += bucket.saved / areas.whole;
    choice.curve.push_back({count / n, Areas::cost(count, sum)});
  }
  choice.curve.push_back({1, Areas::cost(n, areas.sum)});
  std::reverse(choice.curve.begin(), choice.curve.end());
  return choice;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string reason_of(const SplitChoice& choice, bool capped, double cap, const GuideRules& rules) {
  const SplitChoice::Step &from = choice.curve.front(), &to = choice.curve.back();
  const std::string limit = "the cap of " + number(cap) + " lets no more be cut";
  if (to.references_per_primitive <= 1) return "nothing is cut: " + (capped ? limit : "no cut would save enough");
  const std::string what = number(to.references_per_primitive) +
                           " references per primitive lower the predicted cost from " + number(from.cost) + " to " +
                           number(to.cost);
  return what + (capped ? "; " + limit
                        : "; 1 % more would lower it by less than " + number(rules.scene_gain) + " % of itself");
}

/// What the guide makes of a scene, asked for more or less gain.
class Attempts {
 public:
  Attempts(const SplitInput& input, const Areas& areas, size_t most)
      : input_(input), to_cut_(to_guide(input.whole, areas)), most_(most) {
    const auto n = static_cast<double>(input.whole.size());
    rules_.scene_unit = Areas::cost(n, areas.sum) / n * areas.whole;
  }

  const GuideRules& rules() const { return rules_; }

  /// The pieces for `strictness` times the gain; nothing if they are too many.
  std::optional<GuidedPieces> at(double strictness) {
    // What the whole scene gains goes first: it is what few references are best spent on.
    const double more = strictness * strictness * strictness;
    rules_.cell_gain = GuideRules{}.cell_gain * more;
    rules_.scene_gain = GuideRules{}.scene_gain * strictness;
    rules_.plane_gain = kPlaneGain * (more - 1);
    GuidedPieces pieces = guide_splits(to_cut_, input_.geometries, input_.clipper, rules_, input_.limit);
    size_t count = input_.whole.size() - to_cut_.size();
    for (const auto& cell : pieces.cells) count += cell.size();
    if (count > most_) return std::nullopt;
    return pieces;
  }

  /// The most pieces found that fit, when at(1) are too many; nothing if none do.
  std::optional<GuidedPieces> fitting() {
    if (most_ <= input_.whole.size()) return std::nullopt;
    double too_many = 1, fits = 1;  // of strictness
    std::optional<GuidedPieces> best;
    while (!best && fits < kStrictest) best = at(fits *= 2);
    for (int step = 0; step < kSteps && best; ++step) {
      const double between = std::sqrt(std::max(too_many, fits / 2) * fits);
      if (auto pieces = at(between)) {
        best = std::move(pieces);
        fits = between;
      } else {
        too_many = between;
      }
    }
    return best;
  }

 private:
  const SplitInput& input_;
  std::vector<GuidedReference> to_cut_;
  size_t most_;
  GuideRules rules_;
};

}  // namespace

SplitResult split_automatically(const SplitInput& input, const AutomaticSplit& options) {
  if (!(options.cap >= 1)) {
    throw Error(ErrorCode::invalid_option, "early_split",
                "cap is " + std::to_string(options.cap) + "; it must be at least 1 reference per primitive");
  }
  const std::span<const Reference> whole = input.whole;
  SplitResult result{{whole.begin(), whole.end()}, std::numeric_limits<double>::quiet_NaN(), false, SplitChoice{}};
  // At the peak: the references for the guide, the pieces of two attempts, and the outcome.
  input.limit.check(whole.size() * (sizeof(GuidedReference) + 2 * sizeof(Reference)) +
                    most_references(whole.size(), options.cap) * sizeof(GuidedReference));
  const Areas areas = measure(whole);
  if (whole.empty() || !(areas.whole > 0)) {
    result.choice->curve = {{1, 0}};
    result.choice->reason = "nothing is cut: there is nothing with a volume or an area";
    return result;
  }
  Attempts attempts(input, areas, most_references(whole.size(), options.cap));
  std::optional<GuidedPieces> pieces = attempts.at(1);
  result.capped = !pieces;
  if (!pieces) pieces = attempts.fitting();
  if (pieces) result.references = gather(whole, *pieces);
  result.choice = explain(whole, result.references, areas, pieces.value_or(GuidedPieces{}));
  result.choice->reason = reason_of(*result.choice, result.capped, options.cap, attempts.rules());
  return result;
}

std::vector<Reference> split_references(const TriangleMesh& mesh, const AutomaticSplit& options, bool skip_invalid) {
  const Geometry geometry{mesh};
  const std::span<const Geometry> geometries(&geometry, 1);
  PrimitiveReferences whole = make_references(geometries, skip_invalid);
  return split_automatically({geometries, whole.references, geometry_clipper(geometries), {}}, options).references;
}

}  // namespace kerf
