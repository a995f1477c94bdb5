#include "kerf/study/inspect_text.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

namespace kerf {
namespace {

constexpr double kLarge = 4;      // times the median of all: edges that are worth a word
constexpr double kThin = 10;      // longest edge over height
constexpr double kSlanted = 0.5;  // of the median of all: boxes that hold little
constexpr double kFew = 0.02;     // of all: primitives that take half of all tests
constexpr size_t kMostBars = 16;
constexpr double kLongestBar = 50;  // letters

/// "66,447".
std::string grouped(uint64_t n) {
  std::string text = std::to_string(n);
  for (size_t at = text.size(); at > 3;) text.insert(at -= 3, ",");
  return text;
}

/// Three digits, without an exponent where a reader can do without.
std::string number(double x) {
  return std::abs(x) >= 999.5 && std::abs(x) < 1e7 ? fmt::format("{:.0f}", x) : fmt::format("{:.3g}", x);
}

std::string percent(double share) {
  const double x = 100 * share;
  if (x >= 9.95 && (x <= 90.05 || x == 100)) return fmt::format("{:.0f} %", x);
  if (x >= 0.095 || x == 0) return fmt::format("{:.1f} %", x);
  return fmt::format("{:.2g} %", x);
}

/// "1 triangle", "2 triangles".
std::string counted(uint64_t n, const std::string& word) { return grouped(n) + " " + word + (n == 1 ? "" : "s"); }

double share_of(double part, double whole) { return whole > 0 ? part / whole : 0; }

std::string bytes_text(size_t bytes) {
  const auto x = static_cast<double>(bytes);
  if (x < 1e5) return grouped(bytes) + " B";
  return x < 1e8 ? fmt::format("{:.1f} MB", x / 1e6) : fmt::format("{:.0f} MB", x / 1e6);
}

/// "triangle" where there is nothing else.
std::string word_of(const Inspection& i) { return i.bytes.shapes > 0 ? "primitive" : "triangle"; }

size_t kept(const Inspection& i) { return i.report.primitives - i.report.invalid - i.report.degenerate; }

std::string ray_finding(const Inspection& i) {
  return fmt::format(
      "A ray visits {:.1f} nodes and tests {:.1f} {}s on average. {} of the tests are in vain: the ray does not end "
      "there.",
      i.costs.nodes, i.costs.primitives, word_of(i),
      percent(1 - share_of(static_cast<double>(i.hits), static_cast<double>(i.tests))));
}

/// What distinguishes those that cost much; the figures decide about the words.
std::string costly_finding(const Inspection& i) {
  const TypicalPrimitive &costly = i.typical_costly, &all = i.typical;
  std::vector<std::string> words;
  if (costly.longest_edge >= kLarge * all.longest_edge) words.emplace_back("large");
  if (costly.thinness >= kThin) words.emplace_back("long and thin");
  if (costly.fill <= kSlanted * all.fill) words.emplace_back("aslant in their boxes");
  std::string what;
  for (const std::string& word : words) what += (what.empty() ? "" : ", ") + word;
  return fmt::format(
      "They are {}: in the middle (median) their longest edge is {} (of all: {}), that is {} times their height (of "
      "all: {}), and a random line through the box of one meets it with a chance of {} (of all: {}).",
      what.empty() ? "much like all others" : what, number(costly.longest_edge), number(all.longest_edge),
      number(costly.thinness), number(all.thinness), percent(costly.fill), percent(all.fill));
}

double top_tests(const Inspection& i) {
  uint64_t sum = 0;
  for (const InspectedPrimitive& p : i.most_tested) sum += p.tests;
  return static_cast<double>(sum);
}

void add_test_findings(const Inspection& i, std::vector<std::string>& all) {
  if (!i.is_attributed) {
    all.push_back(
        fmt::format("{} does not tell which {}s it tests, so none is named.", i.report.structure, word_of(i)));
    return;
  }
  const auto of_all = [&](size_t n) { return share_of(static_cast<double>(n), static_cast<double>(kept(i))); };
  for (const TestShare& share : i.shares) {
    if (share.share != 0.5) continue;
    const double part = of_all(share.primitives);
    all.push_back(fmt::format("{}: half of all tests are of {} ({}). {}",
                              part <= kFew ? "A few stand out" : "The cost is spread over many",
                              counted(share.primitives, word_of(i)), percent(part), costly_finding(i)));
  }
  if (const size_t top = i.most_tested.size(); top > 0) {
    all.push_back(fmt::format("The {} most tested of {} ({}) cost{} {} of the {} tests.", grouped(top),
                              counted(kept(i), word_of(i)), percent(of_all(top)), top == 1 ? "s" : "",
                              percent(share_of(top_tests(i), static_cast<double>(i.tests))), word_of(i)));
  }
}

std::string box_finding(const Inspection& i) {
  const std::string text = fmt::format("The boxes around the {}s have {} times the surface of what they hold",
                                       word_of(i), number(share_of(i.box_area, i.surface)));
  if (i.most_wasted.empty()) return text + ".";
  return text + fmt::format("; {} of the excess is that of the worst {}.",
                            percent(share_of(i.top_wasted, i.box_area - i.surface)), grouped(i.most_wasted.size()));
}

std::string trial_finding(const Inspection& i) {
  const Inspection::Trial& trial = *i.trial;
  return fmt::format(
      "Tried: {} has {:.2f} references per {} ({} split). The same rays visit {:.1f} nodes and test {:.1f} {}s there, "
      "in "
      "{:.0f} ns instead of {:.0f}: {:.2f} times as fast.",
      trial.report.structure, trial.report.references_per_primitive, word_of(i), grouped(trial.split),
      trial.costs.nodes, trial.costs.primitives, word_of(i), 1e9 * trial.costs.seconds, 1e9 * i.costs.seconds,
      share_of(i.costs.seconds, trial.costs.seconds));
}

class Text {
 public:
  template <class... Args>
  void line(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
    text_ += '\n';
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

std::string point(Vec3d p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z); }

/// Where it is: its object unless there is but one, its material, its corners.
std::string where(const InspectedPrimitive& p, const Inspection& i) {
  std::string text;
  if (i.objects > 1) text += fmt::format("object {} ({}) ", p.object, p.place);
  if (!p.material.empty()) text += fmt::format("'{}' ", p.material);
  if (p.kind != "triangle") text += fmt::format("{} ", p.kind);
  for (const Vec3d corner : p.corners) text += point(corner) + " ";
  if (p.radius > 0) text += fmt::format("radius {} ", number(p.radius));
  text.pop_back();
  return text;
}

void add_tested(Text& text, const Inspection& i) {
  if (i.most_tested.empty()) return;
  text.line("\nThe {}s that rays test most; numbers from 0 in the order of their object, with the corners", word_of(i));
  text.line("{:>4} {:>10} {:>11} {:>8} {:>8} {:>8} {:>5} {:>8} {:>8} {:>8}", "", "number", "tests", "share", "sum",
            "in vain", "refs", "longest", "thinness", "in box");
  double sum = 0;
  for (size_t n = 0; n < i.most_tested.size(); ++n) {
    const InspectedPrimitive& p = i.most_tested[n];
    const double share = share_of(static_cast<double>(p.tests), static_cast<double>(i.tests));
    sum += share;
    text.line("{:>4} {:>10} {:>11} {:>8} {:>8} {:>8} {:>5} {:>8} {:>8} {:>8}", n + 1, p.primitive, grouped(p.tests),
              percent(share), percent(sum),
              percent(1 - share_of(static_cast<double>(p.hits), static_cast<double>(p.tests))), p.references,
              number(p.longest_edge), number(p.thinness), percent(p.fill()));
    text.line("{:>15} {}", "", where(p, i));
  }
}

void add_wasted(Text& text, const Inspection& i) {
  if (i.most_wasted.empty()) return;
  text.line("\nThe {}s whose boxes waste most area", word_of(i));
  text.line("{:>4} {:>10} {:>11} {:>8} {:>8} {:>8} {:>5} {:>8} {:>8} {:>8}", "", "number", "box area", "share", "sum",
            "tests", "refs", "longest", "thinness", "in box");
  double sum = 0;
  for (size_t n = 0; n < i.most_wasted.size(); ++n) {
    const InspectedPrimitive& p = i.most_wasted[n];
    const double share = share_of(p.box_area - p.surface, i.box_area - i.surface);
    sum += share;
    text.line("{:>4} {:>10} {:>11} {:>8} {:>8} {:>8} {:>5} {:>8} {:>8} {:>8}", n + 1, p.primitive, number(p.box_area),
              percent(share), percent(sum), i.is_attributed ? grouped(p.tests) : "?", p.references,
              number(p.longest_edge), number(p.thinness), percent(p.fill()));
    text.line("{:>15} {}", "", where(p, i));
  }
}

/// Bars for stretches of a histogram: of one length, or each twice as long as the one before.
void add_histogram(Text& text, std::span<const uint64_t> counts, bool doubling) {
  struct Bar {
    size_t first, last;
    uint64_t count;
  };
  std::vector<Bar> bars;
  size_t begin = 0;
  while (begin < counts.size() && counts[begin] == 0) ++begin;
  const size_t length = (counts.size() - begin + kMostBars - 1) / kMostBars;
  for (size_t at = begin; at < counts.size();) {
    const size_t width = !doubling || counts.size() <= kMostBars ? length : std::max<size_t>(1, at - 1);
    const size_t end = std::min(counts.size(), at + width);
    Bar bar{at, end - 1, 0};
    for (; at < end; ++at) bar.count += counts[at];
    bars.push_back(bar);
  }
  uint64_t most = 0;
  for (const Bar& bar : bars) most = std::max(most, bar.count);
  for (const Bar& bar : bars) {
    const auto letters =
        static_cast<size_t>(std::ceil(kLongestBar * static_cast<double>(bar.count) / static_cast<double>(most)));
    const std::string range =
        bar.first == bar.last ? std::to_string(bar.first) : fmt::format("{}-{}", bar.first, bar.last);
    text.line("{:>11} {:>11} {}", range, grouped(bar.count), std::string(letters, '#'));
  }
}

void add_costs(Text& text, const char* name, const RayCosts& costs, const BuildReport& report,
               const std::optional<double>& overlap) {
  text.line("{:<6} {:>7.3f} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.0f} {:>9.1f} {:>9} {:>9}   {}", name,
            report.references_per_primitive, costs.nodes, costs.boxes, costs.primitives, 1e9 * costs.seconds,
            report.sah_cost, overlap ? fmt::format("{:.2f}", *overlap) : "?", bytes_text(report.bytes),
            report.structure);
}

void add_structure(Text& text, const Inspection& i) {
  const BuildReport& r = i.report;
  text.line("\n{:<6} {:>7} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}   structure", "", "R", "nodes/ray", "boxes/ray",
            "tests/ray", "ns/ray", "SAH cost", "overlap", "bytes");
  add_costs(text, "this", i.costs, r, i.overlap);
  if (i.trial) add_costs(text, "trial", i.trial->costs, i.trial->report, i.trial->overlap);
  text.line("");
  const auto row = [&](const char* name, const std::string& value) { text.line("{:<28} {}", name, value); };
  row((word_of(i) + "s").c_str(), fmt::format("{}; {} without area, {} dropped as invalid", grouped(r.primitives),
                                              grouped(r.degenerate), grouped(r.invalid)));
  row("references", fmt::format("{} (R = {:.3f})", grouped(r.references), r.references_per_primitive));
  row("surface, both sides", number(i.surface));
  row("area of their own boxes", number(i.box_area));
  row("area of leaves times slots", number(i.leaf_area));
  row("area of the box around all", number(i.root_area));
  row("nodes, leaves", fmt::format("{}, {}", grouped(r.nodes), grouped(r.leaves)));
  row("deepest leaf, largest leaf",
      fmt::format("{}, {} slots from {} to {}", r.depth, r.largest_leaf, point(to_double(i.largest_leaf.lower)),
                  point(to_double(i.largest_leaf.upper))));
  row("bytes of the geometry",
      fmt::format("{} vertices, {} indices, {} spheres and parallelograms", bytes_text(i.bytes.vertices),
                  bytes_text(i.bytes.indices), bytes_text(i.bytes.shapes)));
  row("bytes of the structure",
      fmt::format("{} nodes and all else, {} slots", bytes_text(i.bytes.nodes), bytes_text(i.bytes.slots)));
  row("instruction set", r.instruction_set);
  row("rays",
      fmt::format("{} primary, {} diffuse; {} hit", grouped(i.primary_rays), grouped(i.diffuse_rays), grouped(i.hits)));
  text.line("\nDepth of leaves");
  add_histogram(text, i.leaves_by_depth, false);
  text.line("\nSlots in leaves");
  add_histogram(text, i.leaves_by_size, true);
}

/// Automatic splitting: the predicted cost as it fell, and why it ended there.
void add_choice(Text& text, const BuildReport& report) {
  if (!report.choice) return;
  const std::vector<SplitChoice::Step>& curve = report.choice->curve;
  text.line("\nHow far {} went: the predicted cost of a random line over references per primitive", report.structure);
  for (const SplitChoice::Step& step : curve) {
    const auto letters = static_cast<size_t>(std::ceil(kLongestBar * share_of(step.cost, curve.front().cost)));
    text.line("{:>11.3f} {:>11} {}", step.references_per_primitive, number(step.cost), std::string(letters, '#'));
  }
  text.line("{}", report.choice->reason);
}

}  // namespace

std::vector<std::string> findings(const Inspection& i) {
  if (kept(i) == 0) return {"There is nothing to hit."};
  std::vector<std::string> all;
  if (i.tests > 0) {
    add_test_findings(i, all);
    all.push_back(ray_finding(i));
  } else {
    all.emplace_back("No ray reached a leaf: the camera sees nothing of it, so no cost is known.");
  }
  all.push_back(box_finding(i));
  if (i.trial && i.tests > 0) all.push_back(trial_finding(i));
  return all;
}

std::string inspection_text(const Inspection& i) {
  Text text;
  for (const std::string& finding : findings(i)) text.line("- {}", finding);
  if (kept(i) == 0) return text.take();
  add_tested(text, i);
  if (!i.shares.empty()) {
    text.line("\nShare of all tests, and the fewest {}s that take it", word_of(i));
    for (const TestShare& share : i.shares) {
      text.line("{:>10} {:>11} {:>8}", fmt::format("{:.0f} %", 100 * share.share), grouped(share.primitives),
                percent(share_of(static_cast<double>(share.primitives), static_cast<double>(kept(i)))));
    }
  }
  add_wasted(text, i);
  add_structure(text, i);
  add_choice(text, i.report);
  if (i.trial) add_choice(text, i.trial->report);
  return text.take();
}

}  // namespace kerf
