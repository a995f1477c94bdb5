#pragma once

namespace kerf {

/// Whether this build of Kerf knows Embree.
bool has_embree();

/// Adds `embree_medium` and `embree_high` to the menu, where this build knows Embree: the trees of Embree's own
/// builders, traced as any other Bvh, so that Kerf's are measured against the strongest. They are built on one thread,
/// because Embree's orders differ from run to run with more. To be called once, before anything else uses the menu.
void add_embree_builders();

}  // namespace kerf
