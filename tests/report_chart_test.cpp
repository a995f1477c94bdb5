// The parts that reports are made of: numbers, names, axes, places of labels.

#include <gtest/gtest.h>

#include <cmath>

#include "kerf/study/report/axis.h"
#include "kerf/study/report/label_places.h"
#include "kerf/study/report/markup.h"
#include "kerf/study/report/number_text.h"

namespace kerf::report {
namespace {

using Lines = std::vector<std::string>;

TEST(ReportTextTest, Numbers) {
  EXPECT_EQ(number_text(0), "0");
  EXPECT_EQ(number_text(9.999), "10.0");
  EXPECT_EQ(number_text(0.99951), "1.00");
  EXPECT_EQ(number_text(28.64), "28.6");
  EXPECT_EQ(number_text(0.0123456), "0.0123");
  EXPECT_EQ(number_text(-1234567.8),
            "\xE2\x88\x92"
            "1,234,568");
  EXPECT_EQ(number_text(2.5e-7),
            "2.50\xC2\xB7"
            "10\xE2\x81\xBB\xE2\x81\xB7");
  EXPECT_EQ(number_text(INFINITY), "\xE2\x88\x9E");
  EXPECT_EQ(number_text(NAN), "NaN");
  EXPECT_EQ(count_text(0), "0");
  EXPECT_EQ(count_text(1000), "1,000");
  EXPECT_EQ(count_text(123456789), "123,456,789");
  EXPECT_EQ(chosen_text(30), "30");
  EXPECT_EQ(chosen_text(1e6), "1,000,000");
  EXPECT_EQ(chosen_text(0.125), "0.125");
  EXPECT_EQ(chosen_text(INFINITY), "\xE2\x88\x9E");
}

TEST(ReportTextTest, Units) {
  EXPECT_EQ(seconds_text(1.98), "1.98\xC2\xA0s");
  EXPECT_EQ(seconds_text(0.0123), "12.3\xC2\xA0ms");
  EXPECT_EQ(seconds_text(0), "0\xC2\xA0s");
  EXPECT_EQ(bytes_text(27100000), "27.1\xC2\xA0MB");
  EXPECT_EQ(bytes_text(12),
            "12.0\xC2\xA0"
            "B");
  EXPECT_EQ(number_tick(2000), "2k");
  EXPECT_EQ(number_tick(0.25), "0.25");
  EXPECT_EQ(seconds_tick(0.05), "50\xC2\xA0ms");
  EXPECT_EQ(seconds_tick(1000), "1,000\xC2\xA0s");
  EXPECT_EQ(bytes_tick(5e9), "5\xC2\xA0GB");
  EXPECT_EQ(place_text(-0.04), "0");
  EXPECT_EQ(place_text(12.345), "12.3");
}

TEST(ReportTextTest, WhatIsNoTextIsReplaced) {
  const std::string no = "\xEF\xBF\xBD";
  EXPECT_EQ(valid_text("gr\xC3\xBC\xC3\x9F \xF0\x9F\x8C\x8D\n"), "gr\xC3\xBC\xC3\x9F \xF0\x9F\x8C\x8D\n");
  EXPECT_EQ(valid_text(std::string("a\0b", 3)), "a" + no + "b");
  EXPECT_EQ(valid_text("\xC3"), no) << "cut short";
  EXPECT_EQ(valid_text("\xC0\xAF"), no + no) << "longer than it need be";
  EXPECT_EQ(valid_text("\xED\xA0\x80"), no + no + no) << "half of a pair";
  EXPECT_EQ(valid_text("\xEF\xBF\xBF"), no + no + no) << "no character";
  EXPECT_EQ(valid_text("\xF4\x90\x80\x80"), no + no + no + no) << "beyond the last";
  EXPECT_EQ(escaped("<&>\"'"), "&lt;&amp;&gt;&quot;&#39;");
}

TEST(ReportTextTest, NamesAreWrappedAtTheirSigns) {
  EXPECT_EQ(wrapped("", 10, 2), Lines{""});
  EXPECT_EQ(wrapped("binned_sah", 10, 2), Lines{"binned_sah"});
  EXPECT_EQ(wrapped("early+binned_sah", 12, 2), (Lines{"early+", "binned_sah"}));
  EXPECT_EQ(wrapped("abcdefgh", 4, 2), (Lines{"abcd", "efgh"}));
  EXPECT_EQ(wrapped("abcdefghi", 4, 2), (Lines{"abcd", "efg\xE2\x80\xA6"}));
  EXPECT_EQ(wrapped("\xE6\xBC\xA2\xE5\xAD\x97", 2, 2), (Lines{"\xE6\xBC\xA2", "\xE5\xAD\x97"})) << "wide ones";
  for (size_t columns = 2; columns < 30; ++columns) {
    const std::string name = "early_split(sa_max=10,x=\xC3\xBC)+binned_sah(bins=32) \xFF";
    std::string joined;
    for (const std::string& line : wrapped(name, columns, 40)) {
      EXPECT_LE(text_columns(line), columns);
      joined += line;
    }
    EXPECT_EQ(joined, valid_text(name)) << columns;
  }
}

TEST(ReportTextTest, Base64) {
  const auto of = [](const std::string& text) { return base64({text.begin(), text.end()}); };
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foo"), "Zm9v");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
  EXPECT_EQ(of("\xFB\xFF\xFE"), "+//+");
}

void expect_axis(AxisKind kind, const std::vector<double>& values, const std::vector<double>& ticks) {
  const Axis axis = make_axis(kind, values, 5);
  ASSERT_EQ(axis.ticks.size(), ticks.size());
  for (size_t i = 0; i < ticks.size(); ++i) EXPECT_NEAR(axis.ticks[i], ticks[i], 1e-9 * std::abs(ticks[i]));
}

TEST(ReportAxisTest, NiceNumbers) {
  expect_axis(AxisKind::from_zero, {57.5, 24.2}, {0, 20, 40, 60});
  expect_axis(AxisKind::from_zero, {1}, {0, 0.2, 0.4, 0.6, 0.8, 1});
  expect_axis(AxisKind::from_zero, {}, {0, 0.2, 0.4, 0.6, 0.8, 1});
  expect_axis(AxisKind::from_zero, {0}, {0, 0.2, 0.4, 0.6, 0.8, 1});
  expect_axis(AxisKind::linear, {-3, 4}, {-4, -2, 0, 2, 4});
  expect_axis(AxisKind::logarithmic, {1, 13.4}, {1, 2, 5, 10, 20});
  expect_axis(AxisKind::logarithmic, {1000, 1e7}, {1e3, 1e4, 1e5, 1e6, 1e7});
  expect_axis(AxisKind::logarithmic, {3, 3}, {1, 2, 5, 10});
}

TEST(ReportAxisTest, HoldsEveryValueWhateverItIs) {
  constexpr double kSizes[] = {1e-300, 3e-17, 1e-4, 0.3, 1, 7, 99, 1e5, 4e20, 1e300};
  for (const AxisKind kind : {AxisKind::from_zero, AxisKind::linear, AxisKind::logarithmic}) {
    for (const double a : kSizes) {
      for (const double b : kSizes) {
        const Axis axis = make_axis(kind, std::vector<double>{a, b, NAN, INFINITY, -INFINITY}, 5);
        ASSERT_GE(axis.ticks.size(), 2U);
        EXPECT_LT(axis.ticks.size(), 16U);
        for (const double value : {a, b}) {
          EXPECT_TRUE(axis.holds(value));
          EXPECT_GE(axis.place(value), -1e-6) << a << " " << b;
          EXPECT_LE(axis.place(value), 1 + 1e-6) << a << " " << b;
        }
      }
    }
  }
  const Axis axis = make_axis(AxisKind::logarithmic, std::vector<double>{0, -1, 5e-324, NAN}, 5);
  for (const double value : {0.0, -1.0, 5e-324, double{NAN}, double{INFINITY}}) EXPECT_FALSE(axis.holds(value));
}

TEST(ReportAxisTest, LogarithmicWhereValuesDiffer) {
  EXPECT_EQ(axis_kind(std::vector<double>{1, 101}, 100, AxisKind::linear), AxisKind::logarithmic);
  EXPECT_EQ(axis_kind(std::vector<double>{1, 99, 0, NAN, INFINITY}, 100, AxisKind::linear), AxisKind::linear);
  EXPECT_EQ(axis_kind({}, 100, AxisKind::from_zero), AxisKind::from_zero);
}

TEST(ReportLabelTest, NoneCoversAnother) {
  const Area picture{0, 0, 300, 200};
  LabelPlaces places(picture);
  std::vector<Area> placed;
  for (int i = 0; i < 12; ++i) {
    placed.push_back(places.place(100 + i % 3, 100, 14, 12));
    EXPECT_TRUE(picture.contains(placed.back()));
    for (int k = 0; k < i; ++k) EXPECT_FALSE(placed[static_cast<size_t>(k)].overlaps(placed.back())) << i << " " << k;
  }
}

TEST(ReportLabelTest, ColumnsKeepTheirOrderAndDistance) {
  const std::vector<double> middles{50, 50, 10, 52, 99, 98};
  const std::vector<double> placed = spread_column(middles, 12, 10, 100);
  const size_t order[] = {2, 0, 1, 3, 5, 4};
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_GE(placed[order[i]], 10);
    EXPECT_LE(placed[order[i]], 100);
    if (i > 0) {
      EXPECT_GE(placed[order[i]] - placed[order[i - 1]], 12 - 1e-9);
    }
  }
  EXPECT_EQ(spread_column({30, 60}, 12, 0, 100), (std::vector<double>{30, 60})) << "left where there is room";
}

}  // namespace
}  // namespace kerf::report
