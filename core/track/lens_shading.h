// A lens darkens its corners: what a place looks like depends on where in the image it is. Learned from the scan itself, as in online
// photometric calibration (Bergmann, Wang, Cremers 2018): places seen at two distances from the image's centre, in frames whose poses and
// depth are known. Used as soon as it is known better than by chance.
//
// Host only, no GPU. One thread at a time.
#pragma once

#include <Eigen/Core>
#include <array>

#include "core/base/byte_stream.h"
#include "core/track/seen_twice.h"

namespace hermite {

// Grey values are darker by this factor, 0 to 1, at 256 squared distances from the principal point: the last is the farthest corner.
using ShadingTable = std::array<float, 256>;

class LensShading {
 public:
  LensShading();

  // What frames are to be divided by now.
  const ShadingTable& table() const { return table_; }

  // The view with grey values as the sensor had them, before they were divided by table().
  CoarseView as_measured(CoarseView view) const;

  // From the grey values of two views as measured. Returns whether table() has changed.
  bool learn(const CoarseView& now, const EarlierView::Comparison& comparison);

  void save(ByteWriter& bytes) const;
  // table() is what it was when saved.
  void restore(ByteReader& bytes);

 private:
  bool update_table();

  // Normal equations of the logarithm of the darkening, a polynomial without constant in the squared distance.
  Eigen::Matrix3d information_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_hand_side_ = Eigen::Vector3d::Zero();
  double weight_ = 0;
  Eigen::Vector3d coefficients_ = Eigen::Vector3d::Zero();
  ShadingTable table_;
};

// Index into a ShadingTable for a pixel of an image of this camera.
std::uint8_t shading_index(const shared::Intrinsics& camera, double x, double y);

}  // namespace hermite
