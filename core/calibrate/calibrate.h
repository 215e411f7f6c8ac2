// Self-calibration: finds errors of a recording's camera in the recording itself, namely of focal
// length, principal point, lens distortion (its first term), the parameters of DepthCorrection, and
// the time at which rows of its images are taken (core/math/image_timing.h). A wrong camera
// distorts surfaces differently from each viewpoint, so views from different places contradict each
// other, whatever their poses.
//
// A factor of all depths cannot be found: it is the scale of the world, and all views agree at any
// scale. Nor can any error whose effect is the same in all chosen views, because the camera did not
// rotate or approach; that parameter is then not significant.
//
// Views are chosen along the trajectory, some pairs of them are held out, and poses and camera are
// adjusted jointly to the rest (joint_adjustment.h). Parameters are fixed one after another and the
// rest is adjusted again, until each remaining parameter
//   - is plausible, that is, cameras can be off by that much: otherwise it compensates for
//     something else, such as a rolling shutter or unsynchronised images;
//   - is significant, and large enough to matter;
//   - is confirmed by each half of the recording, as far as that half determines it;
//   - makes the held-out pairs agree better than without it;
// and until all together agree better than the given camera with poses adjusted to it. Otherwise
// the camera is not changed.
//
// Pure: the same frames and poses give the same parameters, bit for bit, for any number of threads.
// Takes about 50 MB and 5 to 15 s of CPU time, whatever the length of the recording.
#pragma once

#include <string>
#include <vector>

#include "core/calibrate/joint_adjustment.h"
#include "core/calibrate/pair_agreement.h"
#include "core/dataset/frame_range.h"
#include "core/dataset/sequence.h"

namespace hermite::calibrate {

struct FoundNumber {
  // "focal_factor", "cx_px", "cy_px", "k1", "bend", "inverse_offset_per_m", "depth_readout_s",
  // "color_readout_s", "color_delay_s".
  std::string name;
  double value = 0;  // the change of the given camera's parameter; of a factor, the part beyond 1
  double deviation = 0;
  bool is_applied = false;
  std::string reason;  // why it is not applied, as text
};

struct Calibration {
  // The given camera with the applied parameters, and the deviations of what may still be wrong.
  Camera camera;
  bool is_applied = false;
  std::string reason;  // why nothing is applied, as text
  // All, in the order of CameraNumber; empty if there was too little data.
  std::vector<FoundNumber> numbers;
  std::size_t view_count = 0, fitted_pair_count = 0, held_back_pair_count = 0;
  // Agreement of the held-out pairs: with the given camera and with the result, each with poses
  // adjusted to it.
  PairAgreement before, after;
};

struct CalibrateOptions {
  std::size_t max_view_count = 48;  // at least 2
  unsigned thread_count = 2;        // at least 1; does not affect the result
};

// Calibrates from a recording. `trajectory` has poses of tracked frames only, at their timestamps.
// Other frames, and frames that cannot be read, are skipped.
Calibration calibrate(const dataset::Sequence& sequence, dataset::FrameRange range,
                      const dataset::Trajectory& trajectory, const CalibrateOptions& options = {});

// Calibrates from chosen views, in the order of time. `camera` is that of the unrectified frames.
Calibration calibrate(const std::vector<CalibrationView>& views, const Camera& camera,
                      const CalibrateOptions& options = {});

// {"applied", "reason", "views", "pairs_fitted", "pairs_held_back", "numbers": {name: {"value",
// "deviation", "applied", "reason"}}, "held_back": {"before": {"median_m", "rms_m", "relative_rms",
// "points"}, "after": ...}}
std::string format_calibration_json(const Calibration& calibration);

}  // namespace hermite::calibrate
