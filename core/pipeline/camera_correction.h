// Says how the calibration of a scan's camera was corrected. Pure.
#pragma once

#include <string>

#include "core/math/camera.h"

namespace hermite::pipeline {

// Names each parameter that differs, with its change.
std::string camera_correction_message(const Camera& given, const Camera& corrected);

}  // namespace hermite::pipeline
