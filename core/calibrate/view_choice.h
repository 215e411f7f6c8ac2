// Which frames of a recording calibration looks at, and which of them beside which. Pure functions.
#pragma once

#include <cstdint>
#include <vector>

#include "core/calibrate/joint_adjustment.h"
#include "core/dataset/frame_range.h"
#include "core/dataset/sequence.h"

namespace hermite {

struct ChosenFrame {
  std::int64_t index = 0;
  Rigid3 world_from_camera;
};

// Whether the camera has turned by 8 degrees or moved by 15 cm, or both by half: neighbours share most of what they see.
bool is_another_view(const Rigid3& world_from_earlier, const Rigid3& world_from_camera);

// A frame wherever there is another view since the one before. Where that would be more than `max_count`, the first so many: farther apart
// they would not hang together. Frames without a pose at their time are passed over. Ascending.
std::vector<ChosenFrame> choose_frames(const Sequence& sequence, FrameRange range, const Trajectory& trajectory, std::size_t max_count);

// first < second in each.
struct ChosenPairs {
  std::vector<ViewPair> fitted, held_back;
};

// Each view beside at most kMostEarlierViews before it that see a quarter of the same surface, spread evenly over those: near ones, which
// hang together, and far ones, which tell. A fifth is held back, never of neighbours.
inline constexpr std::size_t kMostEarlierViews = 12;
ChosenPairs choose_pairs(const std::vector<CalibrationView>& views, const Camera& camera);

// Those whose views both are of the first half of so many, or of the second.
std::vector<ViewPair> pairs_of_half(const std::vector<ViewPair>& pairs, std::size_t view_count, bool is_second);

}  // namespace hermite
