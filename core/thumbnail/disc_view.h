// Draws a cloud as oriented discs in parallel projection. Pure functions.
#pragma once

#include <Eigen/Core>

#include "core/base/image.h"
#include "core/output/cloud.h"

namespace hermite::thumbnail {

// A parallel projection. The frame of the view is x right, y down, z away from whoever looks, in
// metres.
struct ParallelView {
  Eigen::Matrix3f view_from_world = Eigen::Matrix3f::Identity();  // a rotation
  // x and y in the view of the middle of the image.
  Eigen::Vector2f middle_m = Eigen::Vector2f::Zero();
  float pixels_per_m = 100;
  float radius_scale = 1;  // of the discs
};

struct DiscImage {
  ColorImage color;          // the background where there is no disc
  std::size_t drawn_px = 0;  // pixels that show a disc
};

// Draws each point as a disc of its radius times the scale, and at least one pixel. Discs that face
// away are not drawn, so that whoever looks at a room from outside looks into it. A point without a
// normal faces the viewer. CHECK: the size is positive.
DiscImage draw_discs(const output::Cloud& cloud, const ParallelView& view, int width_px,
                     int height_px, Rgb8 background);

}  // namespace hermite::thumbnail
