// Linked into a test program that goes through the menu: Embree's builders stand in it.

#include "kerf/study/embree_builder.h"

namespace kerf::test {
namespace {

[[maybe_unused]] const bool kAdded = [] {
  add_embree_builders();
  return true;
}();

}  // namespace
}  // namespace kerf::test
