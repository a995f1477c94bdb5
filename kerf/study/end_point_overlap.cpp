#include "kerf/study/end_point_overlap.h"
namespace kerf {
double end_point_overlap(const Scene&, const WorkLimit&) { return 0; }
}  // namespace kerf
