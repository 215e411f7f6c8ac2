// Finds the part of a frame that an incomplete transfer has left from the frame before: USB cameras
// deliver the old contents of their buffer below the row at which a transfer broke off. Its depth
// is equal to the bit, which the noise of a sensor never is. Runs on the host.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/base/image.h"
#include "core/frame/rgbd_frame.h"

namespace hermite::frame {

// A number for each row of a depth image, equal for equal rows. 0: too little is measured in the
// row to tell it from another.
using RowDigests = std::vector<std::uint64_t>;

// Takes a tenth of a millisecond for 640x480. Any thread.
RowDigests digest_rows(const DepthImage& depth);

// Returns the number of rows at the bottom of a frame that repeat the frame before; 0 if the frame
// is whole. Whole are also frames that repeat all of the frame before, and frames in which rows
// above repeat it as well: those of a camera at rest without noise.
int repeated_row_count(const RowDigests& before, const RowDigests& now);

// Removes the depth of the last `row_count` rows, and continues the row above in the image, which
// leaves nothing to follow there. At least one row stays.
void remove_last_rows(RgbdFrame& frame, int row_count);

// Compares each frame with the one before. One thread at a time.
class TornFrames {
 public:
  // Returns repeated_row_count() of the frame with these rows, and keeps the rows for the next one.
  int next(const RowDigests& rows);
  // Number of frames of which rows were removed.
  std::int64_t count() const { return count_; }

  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

 private:
  RowDigests before_;
  std::int64_t count_ = 0;
};

}  // namespace hermite::frame
