// A keyframe's depth, kept as a grid of small planes when its image is gone. Keyframes are aligned
// with each other by them (depth_links.h).
#pragma once

#include <array>
#include <vector>

#include "core/base/image.h"
#include "core/math/camera.h"

namespace hermite::adjust {

// Cells of the image. Their number across is the same for every image size: 80x60 for an image of
// 4:3. The grid begins at the top left; the remainder at the right and at the bottom has no cells.
struct DepthGrid {
  int cell_px = 0;  // side length
  int columns = 0, rows = 0;

  std::size_t count() const {
    return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
  int center_px(int column_or_row) const { return column_or_row * cell_px + cell_px / 2; }
};
DepthGrid depth_grid_of(const Camera& camera);

// Plane in the camera frame as the normal over its distance: its points satisfy plane . point = 1
// [1/m]. Zero means that no reliable plane was found.
using DepthPlane = std::array<float, 3>;

// Returns one plane per cell, row major. `depth` is rectified and has the camera's size. A cell has
// a plane if all pixels in and around it have depth in the trusted range (features.h), its pixels
// lie in a plane seen at less than 72 degrees from its normal, and there is no crease in or around
// it: the mean of a corner lies off the corner, towards the side of which more is seen, and so
// differs between views. Thread-safe.
std::vector<DepthPlane> fit_depth_planes(const DepthImage& depth, const Camera& camera);

}  // namespace hermite::adjust
