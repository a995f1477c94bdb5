// No include guard on purpose: a kernel file includes this instead of Highway's own headers, after it has defined
// HWY_TARGET_INCLUDE as its own path, and is then compiled once for each instruction set; the best one that the machine
// has is picked at run time. Only code in HWY_NAMESPACE may stand between HWY_BEFORE_NAMESPACE and
// HWY_AFTER_NAMESPACE: an inline function outside might be kept by the linker in its AVX-512 form for everyone.

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
