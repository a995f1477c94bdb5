#pragma once

#include <vector>

#include "kerf/base/box3.h"
#include "kerf/study/figures/projection.h"

namespace kerf {

/// The parts of a box's twelve edges that a camera sees, as lines of the picture: in front of the camera, within the
/// picture and not behind what distance_picture() says is seen there.
std::vector<std::vector<Point2>> visible_edges(const Box3f& box, const Projection& projection, const Image& distances);

}  // namespace kerf
