#pragma once

#include <gtest/gtest.h>

#include <string>

#include "kerf/base/error.h"

namespace kerf::test {

/// The message of the Error that f() throws, which must have this code.
template <class F>
std::string error_of(ErrorCode code, F&& f) {
  try {
    f();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

}  // namespace kerf::test
