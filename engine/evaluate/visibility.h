#pragma once

#include <set>

#include "engine/sequence/sequence.h"

namespace planecast::engine {

/// Labels of a sequence with mask images (a synthetic one) that cover at least `min_share` of some
/// image, every `step`-th frame looked at. Empty if it has no masks.
std::set<int> labels_in_view(Sequence& sequence, double min_share = 0.01, int step = 5);

}  // namespace planecast::engine
