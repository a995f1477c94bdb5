// No include guard on purpose: a kernel file includes this instead of Highway's own headers, after it has defined
// HWY_TARGET_INCLUDE as its own path, and is then compiled once for each instruction set; which one runs is picked at
// run time. Only code in HWY_NAMESPACE may stand between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE: an inline
// function outside might be kept by the linker in its AVX-512 form for everyone.

#include "kerf/base/simd_targets.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"  // false ones from g++ 12's AVX-512 headers
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wshadow"
#endif
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif

// The function that HWY_EXPORT knows by this name as it was compiled for a kerf::InstructionSet. HWY_DYNAMIC_DISPATCH
// would follow a choice that is the whole program's.
#ifndef KERF_DISPATCH
#define KERF_DISPATCH(function, set) (HWY_DISPATCH_TABLE(function)[(set).place])
#endif
