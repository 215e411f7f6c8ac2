// What may be wrong with a camera, in the forms that the camera check, its file and the stated
// uncertainty have. Pure functions of values. Any thread.
#pragma once

#include "core/calibrate/camera_watch.h"
#include "core/math/camera.h"
#include "core/track/shared_ground.h"

namespace hermite::pipeline {

track::CameraDoubts doubts_of(const calibrate::ShapeErrors& errors);
// At most kMaxCameraDeviation, so that a camera with them is valid.
CameraDeviations deviations_of(const track::CameraDoubts& doubts);

// Returns what is believed of the standard deviations of an earlier calibration: not less than what
// is left of a camera that was found to fit (calibrate::kFitting), since errors that all views have
// in common are not in them (tests/accuracy/LAB.md, "Calibration"). 0, not known, stays 0.
track::CameraDoubts believed(const CameraDeviations& stated);

}  // namespace hermite::pipeline
