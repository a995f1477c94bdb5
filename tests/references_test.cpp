// References of whole primitives: bounds, and what is left out or refused.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "kerf/references/reference.h"
#include "tests/support/error_of.h"
#include "tests/support/soup.h"

namespace kerf::test {
namespace {

TEST(MakeReferences, CountsAndNamesWhatIsWrong) {
  Soup soup = random_soup(20000, 15);  // more than two blocks
  soup.vertices[3 * 9000].x = std::numeric_limits<float>::infinity();
  soup.triangles[9001][2] = 60000;
  soup.triangles[17000] = {0, 0, 1};
  const Sphere spheres[] = {{{0, 0, 0}, 1}, {{0, 0, 0}, -1}, {{0, 0, 0}, 0}, {{0, 0, 1e37F}, 1}};
  const Parallelogram shapes[] = {{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 0, 0}, {1e36F, 0, 0}, {1e36F, 1, 0}}};
  const Geometry geometries[] = {
      {Strided<Sphere>(spheres, 1)}, {soup.mesh()}, {Strided<Sphere>(spheres, 4)}, {Strided<Parallelogram>(shapes, 2)}};
  const std::string text = error_of(ErrorCode::invalid_geometry, [&] { make_references(geometries); });
  EXPECT_NE(text.find("geometry 1, triangle 9000"), std::string::npos) << text;
  EXPECT_NE(text.find("not finite"), std::string::npos) << text;
  EXPECT_NE(text.find(" 5 such"), std::string::npos) << text;
  const PrimitiveReferences kept = make_references(geometries, true);
  EXPECT_EQ(kept.invalid, 5U);
  EXPECT_EQ(kept.degenerate, 3U);
  ASSERT_EQ(kept.references.size(), 1U + 19997U + 1U);
  EXPECT_TRUE(
      std::is_sorted(kept.references.begin(), kept.references.end(), [](const Reference& a, const Reference& b) {
        return std::pair(a.geometry, a.primitive) < std::pair(b.geometry, b.primitive);
      }));
  for (const Reference& r : kept.references) {
    EXPECT_EQ(r.bounds(), primitive_bounds(geometries[r.geometry], r.primitive));
    EXPECT_EQ(find_defect(geometries[r.geometry], r.primitive), Defect::none);
  }
}

}  // namespace
}  // namespace kerf::test
