#pragma once

#include "kerf/base/work_limit.h"
#include "kerf/scene/scene.h"

namespace kerf {

/// The end-point overlap of a structure (Aila, Karras, Laine: On Quality Metrics of Bounding Volume Hierarchies, 2013):
/// the cost that rays have because their ends lie on surfaces inside boxes that those surfaces do not belong to,
///
///     EPO = sum over nodes n of C(n) * area((S \ Q(n)) within n) / area(S)
///
/// with S the surfaces of all primitives, one over another counted each, Q(n) those of primitives that have a reference
/// below n, C(n) 1 for an inner node and the number of slots for a leaf; so in the unit of Structure::cost(). Boxes are
/// closed: what lies in a face counts. 0 where no surface reaches into a leaf or an inner node that does not hold it,
/// as in a grid, and in a scene without area. Triangles and parallelograms are clipped in double; spheres, invalid and
/// degenerate primitives are left out. Parallel, the same for any number of threads. Throws Error (stopped) at the
/// limit, and Error (not_built).
double end_point_overlap(const Scene& scene, const WorkLimit& limit = {});

}  // namespace kerf
