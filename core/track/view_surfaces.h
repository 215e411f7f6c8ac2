// Segments a view into surfaces, each of which may move on its own. Pure functions on the host. Any
// thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/frame/coarse_view.h"

namespace hermite::track {

// Segmented at depth steps and concave edges, where one object stands on or in front of another.
struct ViewSurfaces {
  // Numbers; 0: no surface, or one of less than a hundredth of the view.
  std::vector<std::uint32_t> of_pixel;
  std::vector<std::size_t> pixel_count;  // by number
};
ViewSurfaces surfaces_of(const frame::CoarseView& view);

}  // namespace hermite::track
