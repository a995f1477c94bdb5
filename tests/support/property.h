// RapidCheck with one seed for all runs, so that a test that fails once fails always, and what the properties draw.

#pragma once

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <sstream>

#include "kerf/base/box3.h"

namespace kerf::test {

/// Checks a RapidCheck property with `runs` cases; a failure shows the smallest counterexample found.
template <class Property>
void check_property(int runs, Property&& property) {
  const testing::TestInfo& info = *testing::UnitTest::GetInstance()->current_test_info();
  rc::detail::TestMetadata metadata;
  metadata.id = std::string(info.test_suite_name()) + "." + info.name();
  metadata.description = metadata.id;
  rc::detail::TestParams params;
  params.seed = 2007;
  params.maxSuccess = runs;
  const rc::detail::TestResult result = rc::detail::checkTestable(std::forward<Property>(property), metadata, params);
  if (result.template is<rc::detail::SuccessResult>()) return;
  std::ostringstream text;
  rc::detail::printResultMessage(result, text);
  ADD_FAILURE() << text.str();
}

/// A whole number in [least, most], whatever RapidCheck's size is; shrinks towards `least`.
inline int draw_int(int least, int most) {
  return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(least, most + 1));
}

/// A float in [-1, 1] with up to 24 bits; shrinks towards 0.
inline float draw_unit() {
  constexpr int kSteps = 1 << 24;
  const int size = draw_int(0, kSteps);
  return std::ldexp(static_cast<float>(draw_int(0, 1) == 0 ? size : -size), -24);
}

inline Vec3f draw_vector() {
  const float x = draw_unit(), y = draw_unit(), z = draw_unit();
  return {x, y, z};
}

/// A float in [0, 1).
inline float draw_share() { return std::ldexp(static_cast<float>(draw_int(0, (1 << 24) - 1)), -24); }

}  // namespace kerf::test
