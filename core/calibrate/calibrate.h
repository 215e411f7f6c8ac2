// What is wrong with the camera of a recording, found in the recording itself: focal length, centre, and what DepthCorrection has. A camera
// that is wrong bends what it sees, otherwise from each place; views that lie apart then contradict each other, whatever their poses.
//
// Not to be found: a factor of all depths. It is the scale of the world, and all views agree in any. Nor whatever is alike in all views
// that were chosen, since the camera did not turn or come nearer: that number is then not significant.
//
// Views are chosen along the way, some of their pairs are held back, and poses and camera are adjusted together (joint_adjustment.h) to the
// rest. Of the numbers that were free, one after the other is taken back and the rest adjusted anew, until each that is left
//   is believable: a camera can be off by so much. Else it stands for something that no camera is: a rolling shutter, frames out of step,
//   is significant, and large enough to matter,
//   is what either half of the recording says too, as far as it says anything,
//   makes the pairs that were held back agree better than they do without it,
// and together they agree better than with the camera as it was, with poses adjusted to that. Otherwise the camera is left as it was.
//
// Pure: the same frames and poses give the same numbers, bit for bit, whatever the number of threads. Takes some 50 MB, and 5 to 15 s of a
// processor whatever the length of the recording.
#pragma once

#include <string>
#include <vector>

#include "core/calibrate/joint_adjustment.h"
#include "core/dataset/frame_range.h"
#include "core/dataset/sequence.h"

namespace hermite {

struct FoundNumber {
  std::string name;  // "focal_factor", "cx_px", "cy_px", "bend", "inverse_offset_per_m"
  double value = 0;  // of the camera that was given it is the change; of a factor what is beyond 1
  double deviation = 0;
  bool is_applied = false;
  std::string reason;  // in words, why not
};

struct Calibration {
  Camera camera;  // the one given, with what is applied
  bool is_applied = false;
  std::string reason;                // in words, why nothing is
  std::vector<FoundNumber> numbers;  // all, in the order of CameraNumber; empty where there was too little to look at
  std::size_t view_count = 0, fitted_pair_count = 0, held_back_pair_count = 0;
  PairAgreement before, after;  // of the pairs held back: poses adjusted with the camera as it was, and with what is applied
};

struct CalibrateOptions {
  std::size_t max_view_count = 48;  // at least 2
  unsigned thread_count = 2;        // at least 1; changes nothing but the time
};

// `trajectory` has poses of tracked frames only, at their times; others are passed over. Frames that cannot be read are too.
Calibration calibrate(const Sequence& sequence, FrameRange range, const Trajectory& trajectory, const CalibrateOptions& options = {});

// The same of views that were chosen already, in the order of time. `camera` as frames arrive.
Calibration calibrate(const std::vector<CalibrationView>& views, const Camera& camera, const CalibrateOptions& options = {});

// {"applied", "reason", "views", "pairs_fitted", "pairs_held_back", "numbers": {name: {"value", "deviation", "applied", "reason"}},
// "held_back": {"before": {"median_m", "rms_m", "mean_depth_m", "points"}, "after": ...}}
std::string format_calibration_json(const Calibration& calibration);

}  // namespace hermite
