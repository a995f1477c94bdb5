#include "kerf/choose/automatic_split.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"
#include "kerf/choose/split_guide.h"
#include "kerf/references/box_around.h"
#include "kerf/references/split_each.h"

namespace kerf {
namespace {

constexpr size_t kSamples = 4096;      // of small references, that judge planes with all large ones; if that is more:
constexpr size_t kSampleShare = 64;    // one of so many
constexpr size_t kOthers = 8192;       // about twice as many, at most, show how far a cell reaches
constexpr size_t kCandidateShare = 2;  // of so many the largest may be cut
constexpr size_t kThresholdProbes = 65536;
constexpr size_t kGrain = 16384;
// Where the pieces pass the cap, more gain is asked for in growing steps until they fit, then less again in a few.
constexpr double kPlaneGain = 2, kStrictest = 0x1p30;
constexpr int kSteps = 5;

/// The boxes of a scene as a whole.
struct Areas {
  double whole = 0;      ///< half area of the box around all
  double sum = 0;        ///< of the references' half areas / that
  double large = 0;      ///< half area that few pass: they are judges each
  double candidate = 0;  ///< half area below which nothing is cut

  /// Predicted cost of a random line through n references whose half areas add up to `areas` times the whole.
  static double cost(double n, double areas) { return std::log2(n + 1) + areas; }
};

/// Of small references that judge planes, one stands for so many.
size_t sample_rate(size_t references) { return std::clamp<size_t>(references / kSamples, 1, kSampleShare); }

/// The sum of f(reference) over blocks in order.
template <class F>
double sum_of(std::span<const Reference> references, F&& f) {
  std::vector<double> sums((references.size() + kGrain - 1) / kGrain);
  parallel_for(references.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) sums[begin / kGrain] += f(references[i]);
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

Areas measure(std::span<const Reference> references) {
  Areas areas;
  areas.whole = half_area(box_around(references));
  if (!(areas.whole > 0)) return areas;
  areas.sum = sum_of(references, [&](const Reference& r) { return half_area(r.bounds()) / areas.whole; });
  // Evenly spaced probes tell which area every so many-th passes, about.
  const size_t step = (references.size() + kThresholdProbes - 1) / kThresholdProbes;
  std::vector<double> probes;
  for (size_t i = 0; i < references.size(); i += step) probes.push_back(half_area(references[i].bounds()));
  const auto passed_by = [&](size_t share) {
    const auto place = probes.begin() + static_cast<ptrdiff_t>(std::min(probes.size() - 1, probes.size() / share));
    std::nth_element(probes.begin(), place, probes.end(), std::greater<>());
    return *place;
  };
  areas.candidate = std::max(passed_by(kCandidateShare), std::numeric_limits<double>::min());
  areas.large = passed_by(sample_rate(references.size()));
  return areas;
}

/// All large references, and a sample of the others.
Judges choose_judges(std::span<const Reference> whole, const Areas& areas) {
  const size_t rate = sample_rate(whole.size()), others_rate = std::max<size_t>(1, whole.size() / kOthers);
  Judges judges;
  size_t seen = 0;
  for (const Reference& reference : whole) {
    const double area = half_area(reference.bounds());
    if (!(area > 0)) continue;  // costs no ray anything
    if (area > areas.large) {
      judges.add(reference, 1);
    } else if (seen % rate == 0) {
      judges.add(reference, static_cast<float>(rate));
    } else if (seen % others_rate == 0 && area >= areas.candidate) {
      judges.others.push_back(reference.bounds());
    }
    ++seen;
  }
  return judges;
}

/// What a guide made of all references, in the caller's order.
struct GuidedPieces {
  std::vector<Reference> references;
  GainCurve curve;
};

/// How the predicted cost fell: first by the guide's planes, then by cuts in its cells, the most saving first.
SplitChoice explain(std::span<const Reference> whole, std::span<const Reference> pieces, const Areas& areas,
                    const GainCurve& curve) {
  const auto n = static_cast<double>(whole.size());
  double sum = sum_of(pieces, [&](const Reference& piece) { return half_area(piece.bounds()) / areas.whole; });
  auto count = static_cast<double>(pieces.size());
  SplitChoice choice;
  choice.curve.push_back({count / n, Areas::cost(count, sum)});
  for (const GainCurve::Bucket& bucket : curve.buckets) {  // backwards, the least saving first
    if (bucket.references == 0) continue;
    count -= static_cast<double>(bucket.references);
    sum += bucket.saved / areas.whole;
    choice.curve.push_back({count / n, Areas::cost(count, sum)});
  }
  choice.curve.push_back({1, Areas::cost(n, areas.sum)});
  std::reverse(choice.curve.begin(), choice.curve.end());
  return choice;
}

/// Whether all cuts together lower the predicted cost by what each of them should. They do not where triangles are
/// small and well shaped, and the guide's planes cut some all the same.
bool saves_enough(const SplitChoice::Step& from, const SplitChoice::Step& to) {
  return from.cost - to.cost >= GuideRules{}.scene_gain * (to.references_per_primitive - 1) * from.cost;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

bool saves_enough(const SplitChoice& choice) { return saves_enough(choice.curve.front(), choice.curve.back()); }

/// What keeps a splitter from more cuts; empty where nothing does.
std::string stop_of(const SplitResult& result, double cap) {
  if (result.short_of_room) return "the limit of bytes leaves no room for more than " + number(cap) + " of each";
  return result.capped ? "the cap of " + number(cap) + " lets no more be cut" : "";
}

/// `stop`: what kept it from more cuts; empty where nothing did.
std::string reason_of(const SplitChoice& choice, const std::string& stop, const GuideRules& rules) {
  const SplitChoice::Step &from = choice.curve.front(), &to = choice.curve.back();
  if (to.references_per_primitive <= 1) {
    return "nothing is cut: " + (stop.empty() ? "the cuts would not save enough" : stop);
  }
  const std::string what = number(to.references_per_primitive) +
                           " references per primitive lower the predicted cost from " + number(from.cost) + " to " +
                           number(to.cost);
  return what + (stop.empty() ? "; 1 % more would lower it by less than " + number(rules.scene_gain) + " % of itself"
                              : "; " + stop);
}

/// What the guide makes of a scene, asked for more or less gain.
class Attempts {
 public:
  Attempts(const SplitInput& input, const Areas& areas, size_t most)
      : input_(input), areas_(areas), judges_(choose_judges(input.whole, areas)), most_(most) {
    const auto n = static_cast<double>(input.whole.size());
    rules_.scene_unit = Areas::cost(n, areas.sum) / n * areas.whole;
  }

  const GuideRules& rules() const { return rules_; }

  /// The pieces for `strictness` times the gain; nothing if they are too many.
  std::optional<GuidedPieces> at(double strictness) {
    ask_for(strictness);
    const SplitGuide guide(judges_, input_.geometries, rules_, input_.limit);
    std::vector<GainCurve> curves((input_.whole.size() + kSplitGrain - 1) / kSplitGrain);
    auto pieces = split_each(input_.whole, most_, input_.limit, [&](const Reference& reference, const auto& emit) {
      split(guide, reference, curves[static_cast<size_t>(&reference - input_.whole.data()) / kSplitGrain], emit);
    });
    if (!pieces) return std::nullopt;
    GuidedPieces guided{std::move(*pieces), {}};
    for (const GainCurve& curve : curves) guided.curve.add(curve);
    return guided;
  }

  /// The most pieces found that fit, when at(1) are too many; nothing if none do.
  std::optional<GuidedPieces> fitting() {
    if (most_ <= input_.whole.size()) return std::nullopt;
    double too_many = 1, fits = 1, factor = 2;  // of strictness
    std::optional<GuidedPieces> pieces;
    for (; !pieces && fits < kStrictest; factor *= 2) {
      too_many = std::exchange(fits, fits * factor);
      pieces = at(fits);
    }
    if (!pieces) return std::nullopt;
    for (int step = 0; step < kSteps; ++step) {
      const double between = std::sqrt(too_many * fits);
      pieces.reset();  // two attempts at once would take twice the memory
      pieces = at(between);
      (pieces ? fits : too_many) = between;
    }
    return pieces ? std::move(pieces) : at(fits);
  }

  /// Where the pieces of at(1) would lead, however many they are: they are counted, none is kept.
  SplitChoice::Step without_cap() {
    struct Sum {
      double count = 0, areas = 0;
    };
    ask_for(1);
    const SplitGuide guide(judges_, input_.geometries, rules_, input_.limit);
    std::vector<Sum> sums((input_.whole.size() + kSplitGrain - 1) / kSplitGrain);
    parallel_for(input_.whole.size(), kSplitGrain, [&](size_t begin, size_t end) {
      Sum& sum = sums[begin / kSplitGrain];
      GainCurve unused;
      for (size_t i = begin; i < end; ++i) {
        split(guide, input_.whole[i], unused, [&](const Reference& piece) {
          sum.count += 1;
          sum.areas += half_area(piece.bounds()) / areas_.whole;
          return true;
        });
      }
    });
    Sum all;
    for (const Sum& sum : sums) all = {all.count + sum.count, all.areas + sum.areas};
    return {all.count / static_cast<double>(input_.whole.size()), Areas::cost(all.count, all.areas)};
  }

 private:
  void ask_for(double strictness) {
    rules_.cell_gain = GuideRules{}.cell_gain * strictness;
    rules_.scene_gain = GuideRules{}.scene_gain * strictness;
    rules_.plane_gain = kPlaneGain * (strictness - 1);
  }

  template <class Emit>
  void split(const SplitGuide& guide, const Reference& reference, GainCurve& curve, const Emit& emit) const {
    if (half_area(reference.bounds()) < areas_.candidate) return static_cast<void>(emit(reference));
    guide.split(reference, input_.clipper, curve, emit);
  }

  const SplitInput& input_;
  const Areas& areas_;
  Judges judges_;
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
  SplitResult result{{}, std::numeric_limits<double>::quiet_NaN(), false, SplitChoice{}};
  input.limit.check(whole.size() * sizeof(Reference));
  const Areas areas = measure(whole);
  if (!(areas.sum > 0)) {
    result.choice->curve = {{1, 0}};
    result.choice->reason = "nothing is cut: there is nothing with a volume or an area";
    result.references.assign(whole.begin(), whole.end());
    return result;
  }
  const double cap = input.cap(options.cap);
  const SplitChoice::Step nothing_cut{1, Areas::cost(static_cast<double>(whole.size()), areas.sum)};
  Attempts attempts(input, areas, most_references(whole.size(), cap));
  std::optional<GuidedPieces> pieces = attempts.at(1);
  const bool has_less = input.has_less_than(options.cap);
  result.short_of_room = !pieces && has_less && saves_enough(nothing_cut, attempts.without_cap());
  result.capped = result.short_of_room || (!pieces && !has_less);
  if (!pieces) pieces = attempts.fitting();
  if (pieces) {
    result.choice = explain(whole, pieces->references, areas, pieces->curve);
    if (!saves_enough(*result.choice)) pieces.reset();
  }
  if (pieces) {
    result.references = std::move(pieces->references);
  } else {
    result.references.assign(whole.begin(), whole.end());
    result.choice->curve = {nothing_cut};
  }
  result.choice->reason = reason_of(*result.choice, stop_of(result, cap), attempts.rules());
  return result;
}

std::vector<Reference> split_references(const TriangleMesh& mesh, const AutomaticSplit& options, bool skip_invalid) {
  const Geometry geometry{mesh};
  const std::span<const Geometry> geometries(&geometry, 1);
  PrimitiveReferences whole = make_references(geometries, skip_invalid);
  return split_automatically({geometries, whole.references, geometry_clipper(geometries), {}}, options).references;
}

}  // namespace kerf
