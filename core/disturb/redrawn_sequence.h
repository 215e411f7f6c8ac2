// A sequence whose images are modified frame by frame: the base class of disturbances of depth and
// colour together.
#pragma once

#include "core/dataset/changed_sequence.h"

namespace hermite::disturb {

// JPEG quality of the colour images of disturbances.
inline constexpr int kDisturbedJpegQuality = 95;

class RedrawnSequence : public dataset::ChangedSequence {
 public:
  using dataset::ChangedSequence::ChangedSequence;
  // The colour becomes a JPEG if redraw() has changed it.
  Result<dataset::RecordedFrame> read(std::int64_t index) const override;

 private:
  // Both images are those of the original frame, of equal size.
  virtual Status redraw(DepthImage& depth, ColorImage& color, std::int64_t index) const = 0;
};

}  // namespace hermite::disturb
