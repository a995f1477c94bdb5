#pragma once

// Highway's list of instruction sets, to be included before its other headers: kernels keep vectors in classes, which
// takes vectors of a size that the compiler knows, so they are compiled for none of the others.
#ifndef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#endif
#include <hwy/targets.h>
