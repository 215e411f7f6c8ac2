// Relative poses of submaps from the depth of their keyframes: points of one against planes of the
// other, wherever they overlap. This adds information where there are few landmarks, and between
// views that are far apart in time.
#pragma once

#include <cstdint>
#include <vector>

#include "core/adjust/bundle.h"
#include "core/adjust/sparse_map.h"

namespace hermite::adjust {

// Returns a link for every two of these submaps whose keyframes overlap; `from` and `to` are
// indices into `submaps`. A link is one Gauss-Newton step from the current relative pose, with the
// information of that step. Along directions in which the surfaces are flat, its information is
// only an artefact of normal noise, a hundredth of the rest. The step is valid as long as surfaces
// are at most 4 cm apart: close loops or adjust landmarks first. Call it again from the new poses;
// three rounds suffice.
//
// The disagreement of the links at the current layout, beyond what noise explains, lowers the
// information of all of them, because sensors with warped depth contradict themselves. Pure
// function. It takes about 0.4 ms per two keyframes that overlap, and compares each with at most 40
// others.
std::vector<BundleLink> depth_links(const SparseMap& map,
                                    const std::vector<std::uint32_t>& submaps);

}  // namespace hermite::adjust
