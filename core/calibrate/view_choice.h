// Choice of the frames and of the pairs of views that calibration uses. Pure functions.
#pragma once

#include <cstdint>
#include <vector>

#include "core/calibrate/joint_adjustment.h"
#include "core/dataset/frame_range.h"
#include "core/dataset/sequence.h"

namespace hermite::calibrate {

struct ChosenFrame {
  std::int64_t index = 0;
  Rigid3 world_from_camera;
};

// Returns whether the camera has rotated by 8 degrees or moved by 15 cm, or half of both; closer
// views show nearly the same.
bool is_another_view(const Rigid3& world_from_earlier, const Rigid3& world_from_camera);

// Chooses a frame whenever it is another view than the last one, in ascending order. If there are
// more than `max_count`, it takes the first ones, because views farther apart would not overlap.
// Frames without a pose at their timestamp are skipped.
std::vector<ChosenFrame> choose_frames(const dataset::Sequence& sequence, dataset::FrameRange range,
                                       const dataset::Trajectory& trajectory,
                                       std::size_t max_count);

// In each pair, first < second.
struct ChosenPairs {
  std::vector<ViewPair> fitted, held_back;
};

// Most earlier views that a view is paired with.
inline constexpr std::size_t kMostEarlierViews = 12;

// Pairs each view with at most kMostEarlierViews earlier ones that share at least a quarter of the
// surface, evenly spread: near ones overlap most and far ones are most informative. A fifth of the
// pairs is held out, but never neighbours.
ChosenPairs choose_pairs(const std::vector<CalibrationView>& views, const Camera& camera);

// Returns the pairs with both views in the first half of `view_count` views, or in the second.
std::vector<ViewPair> pairs_of_half(const std::vector<ViewPair>& pairs, std::size_t view_count,
                                    bool is_second);

}  // namespace hermite::calibrate
