// How submaps lie to each other by the depth of their keyframes: points of one against planes of another, wherever they overlap. It tells
// more than landmarks do where there are few, and more than tracking does of views that lie apart in time.
#pragma once

#include <cstdint>
#include <vector>

#include "core/adjust/bundle.h"
#include "core/adjust/sparse_map.h"

namespace hermite {

// Of these submaps, every two whose keyframes overlap; `from` and `to` are places in `submaps`. The link is the step of Gauss and Newton
// from where the two lie now, with the information that it has: along what is flat only what the noise of normals pretends, a hundredth. It
// is good as far as depth may be off its surface for a point to be taken for a point of it, 4 cm: landmarks or loops come first. Call it
// again from where it has led to; three times do.
//
// What the links are off by together where everything lies now, beyond what noise explains, lowers the information of all: sensors with
// warped depth contradict themselves. Pure; takes some 0.4 ms for two keyframes that overlap, and each is compared with at most 40.
std::vector<BundleLink> depth_links(const SparseMap& map, const std::vector<std::uint32_t>& submaps);

}  // namespace hermite
