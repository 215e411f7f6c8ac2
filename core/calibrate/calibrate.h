#pragma once
#include "core/calibrate/joint_adjustment.h"
#include "core/dataset/frame_range.h"
#include "core/dataset/sequence.h"
namespace hermite {
int prototype_calibrate(const Sequence& sequence, const Trajectory& trajectory, FrameRange range, std::size_t most);
}
