// A sequence whose images are drawn anew, frame by frame: what disturbances of depth and colour together derive from.
#pragma once

#include "core/dataset/changed_sequence.h"

namespace hermite {

// Quality of the colour that disturbances write.
inline constexpr int kDisturbedJpegQuality = 95;

class RedrawnSequence : public ChangedSequence {
 public:
  using ChangedSequence::ChangedSequence;
  // The colour becomes a JPEG where redraw has changed it.
  Result<RecordedFrame> read(std::int64_t index) const override;

 private:
  // Both images are those of the original's frame, of equal size.
  virtual Status redraw(DepthImage& depth, ColorImage& color, std::int64_t index) const = 0;
};

}  // namespace hermite
