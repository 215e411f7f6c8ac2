// A lens darkens the corners of its images, so the appearance of a point depends on where in the
// image it is. The shading is learned from the scan itself, as in online photometric calibration
// (Bergmann, Wang, Cremers 2018): from points seen at two distances from the image centre, in
// frames with known pose and depth. It is used as soon as it is significant.
//
// Runs on the host. One thread at a time.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/track/seen_twice.h"

namespace hermite::track {

// Factors, 0 to 1, by which grey values are darkened, at 256 equidistant squared distances from the
// principal point; the last one is the farthest corner.
using ShadingTable = std::array<float, 256>;

class LensShading {
 public:
  LensShading();

  // Returns the factors by which frames are to be divided now.
  const ShadingTable& table() const { return table_; }

  // Returns the same by pixel of this camera's image, row major.
  std::vector<float> of_pixels(const shared::Intrinsics& camera) const;

  // Returns the view with grey values as the sensor measured them, before division by table().
  frame::CoarseView as_measured(frame::CoarseView view) const;

  // Learns from the grey values of two views as measured. Returns whether table() has changed.
  bool learn(const frame::CoarseView& now, const EarlierView::Comparison& comparison);

  void save(ByteWriter& bytes) const;
  // Restores table() as well.
  void restore(ByteReader& bytes);

 private:
  bool update_table();

  // Normal equations for the logarithm of the darkening, a polynomial of the squared distance
  // without constant term.
  Eigen::Matrix3d information_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_hand_side_ = Eigen::Vector3d::Zero();
  double weight_ = 0;
  Eigen::Vector3d coefficients_ = Eigen::Vector3d::Zero();
  ShadingTable table_;
};

// Returns the index into a ShadingTable for a pixel of this camera's image.
std::uint8_t shading_index(const shared::Intrinsics& camera, double x, double y);

}  // namespace hermite::track
