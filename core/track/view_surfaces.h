// A view cut into surfaces: what may move on its own is one of them. Pure functions, host only, any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/frame/coarse_view.h"

namespace hermite {

// Cut along steps of depth and concave edges, where one thing stands on or before another.
struct ViewSurfaces {
  std::vector<std::uint32_t> of_pixel;   // numbers; 0: no surface, or one of less than a hundredth of the view
  std::vector<std::size_t> pixel_count;  // by number
};
ViewSurfaces surfaces_of(const CoarseView& view);

}  // namespace hermite
