// Numbers out of text: the nearest float, always.

#include "kerf/io/text_number.h"

#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace kerf::test {
namespace {

/// The whole text as a number; the test fails where not all of it is one.
float parse(const std::string& text) {
  const std::vector<char> bytes(text.begin(), text.end());  // so that the address sanitizer sees a read behind it
  float value = 0;
  const char* end = parse_float(bytes.data(), bytes.data() + bytes.size(), value);
  EXPECT_EQ(end, bytes.data() + bytes.size()) << text;
  return value;
}

uint32_t bits(float value) { return std::bit_cast<uint32_t>(value); }

void expect_nearest(const std::string& text) {
  float expected = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), expected);
  ASSERT_EQ(error, std::errc{}) << text;
  EXPECT_EQ(bits(parse(text)), bits(expected)) << text;
}

TEST(TextNumber, ReadsEveryForm) {
  EXPECT_EQ(parse("1"), 1.0F);
  EXPECT_EQ(parse("+1"), 1.0F);
  EXPECT_EQ(parse("-1e-3"), -1e-3F);
  EXPECT_EQ(parse(".5"), 0.5F);
  EXPECT_EQ(parse("5."), 5.0F);
  EXPECT_EQ(parse("1E+2"), 100.0F);
  EXPECT_EQ(parse("000000000000000000000000000001.5"), 1.5F);
  EXPECT_EQ(parse("inf"), std::numeric_limits<float>::infinity());
  EXPECT_EQ(parse("-Infinity"), -std::numeric_limits<float>::infinity());
  EXPECT_TRUE(std::isnan(parse("nan")) && std::isnan(parse("-NaN")) && std::isnan(parse("+nan(ind)")));
  EXPECT_EQ(bits(parse("-0")), 0x80000000U);
  EXPECT_EQ(bits(parse("-0.000e5")), 0x80000000U);
}

TEST(TextNumber, StopsWhereTheNumberEnds) {
  const auto rest = [](const std::string& text) {
    float value = 0;
    const char* end = parse_float(text.data(), text.data() + text.size(), value);
    return end == nullptr ? "none" : std::string(end, text.data() + text.size());
  };
  EXPECT_EQ(rest("1 2"), " 2");
  EXPECT_EQ(rest("1.5.5"), ".5");
  EXPECT_EQ(rest("1e"), "e");
  EXPECT_EQ(rest("1e+"), "e+");
  EXPECT_EQ(rest("1e5x"), "x");
  EXPECT_EQ(rest("0x10"), "x10");
  for (const char* none : {"", "+", "-", ".", "e5", "--1", "+-1", "-+1", "x", " 1", "-.e1"})
    EXPECT_EQ(rest(none), "none") << none;
}

TEST(TextNumber, BeyondTheRangeOfAFloatIsInfinityOrZero) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(parse("1e39"), kInfinity);
  EXPECT_EQ(parse("-1e999"), -kInfinity);
  EXPECT_EQ(parse("1e99999999999999999999999"), kInfinity);
  EXPECT_EQ(parse(std::string(400, '9')), kInfinity);
  EXPECT_EQ(parse(std::string(400, '9') + "e-10"), kInfinity);
  EXPECT_EQ(parse("0.00001e400"), kInfinity);
  EXPECT_EQ(bits(parse("1e-99")), 0U);
  EXPECT_EQ(bits(parse("-1e-999")), 0x80000000U);
  EXPECT_EQ(bits(parse("1e-99999999999999999999999")), 0U);
  EXPECT_EQ(bits(parse("0." + std::string(400, '0') + "1")), 0U);
  EXPECT_EQ(bits(parse("0." + std::string(400, '0') + "1e100")), 0U);
  EXPECT_EQ(parse("0e999999"), 0.0F);
}

TEST(TextNumber, TheEdgesOfAFloatAreExact) {
  for (const char* text :
       {"3.4028234e38", "3.4028235e38", "3.4028235677e38", "340282346638528859811704183484516925440", "1.17549435e-38",
        "1.17549428e-38", "1.1754942e-38", "1.4e-45", "0.71e-45", "16777217", "16777219", "16777217.0000001",
        "33554435", "9007199254740993", "9007199254740992", "1.00000005960464477539", "1.0000000596046448"}) {
    expect_nearest(text);
  }
}

TEST(TextNumber, IsTheNearestFloatForAnyDigits) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 200000; ++i) {
    const int size = 1 + static_cast<int>(random() % 20);
    std::string text = random() % 2 == 0 ? "-" : "";
    const int point = static_cast<int>(random() % static_cast<uint64_t>(size + 1));
    for (int digit = 0; digit < size; ++digit) {
      if (digit == point) text += '.';
      text += static_cast<char>('0' + random() % 10);
    }
    if (random() % 2 == 0) text += "e" + std::to_string(static_cast<int>(random() % 37) - 22);
    if (text != "." && text != "-.") expect_nearest(text);
  }
}

TEST(TextNumber, IsTheNearestFloatNextToTheMiddleBetweenTwo) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 200000; ++i) {
    const float low = std::ldexp(static_cast<float>(1 + random() % 16777215), static_cast<int>(random() % 60) - 50);
    const double middle = (static_cast<double>(low) + std::nextafter(low, 1e30F)) / 2;
    char text[64];
    std::snprintf(text, sizeof text, "%.*g", 8 + static_cast<int>(random() % 10), middle);
    expect_nearest(text);
    std::snprintf(text, sizeof text, "%.*f", static_cast<int>(random() % 20), middle);
    expect_nearest(text);
  }
}

}  // namespace
}  // namespace kerf::test
