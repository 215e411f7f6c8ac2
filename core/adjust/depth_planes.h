// What of a keyframe's depth is kept when its image is gone: a grid of small planes, by which keyframes are measured against each other
// (depth_links.h).
#pragma once

#include <array>
#include <vector>

#include "core/base/image.h"
#include "core/math/camera.h"

namespace hermite {

// Cells of the image, as many across it whatever its size: 80x60 of one of 4:3. They begin at the top left; what is left over at the right
// and at the bottom has none.
struct DepthGrid {
  int cell_px = 0;  // a side
  int columns = 0, rows = 0;

  std::size_t count() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  }
  int center_px(int column_or_row) const { return column_or_row * cell_px + cell_px / 2; }
};
DepthGrid depth_grid_of(const Camera& camera);

// The points of the plane, in the camera, are those with plane . point = 1 [1/m]: its normal over its distance. Zero: no plane that could
// be trusted.
using DepthPlane = std::array<float, 3>;

// One a cell, row major. `depth` is rectified and of the camera's size. A cell has a plane where all pixels in and around it have depth in
// the trusted range (features.h), those in it lie in a plane that is seen under 72 degrees at most, and nothing in or around it is creased:
// the mean of a corner lies off the corner, to the side that more is seen of, and so not at the same place from two views. Thread-safe.
std::vector<DepthPlane> fit_depth_planes(const DepthImage& depth, const Camera& camera);

}  // namespace hermite
