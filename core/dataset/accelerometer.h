// What an accelerometer beside a recorded camera felt: accelerometer.txt of the TUM benchmark,
// lines "time ax ay az" in seconds and m/s^2, at rest 9.8 upwards. Pure functions.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace hermite::dataset {

inline constexpr const char* kAccelerometerFile = "accelerometer.txt";

// The sensor of a Kinect v1 has x left, y up and z forward, as libfreenect and the benchmark write
// it: fr1/desk begins with (-0.1, 7.2, -6.7), where its ground truth has the camera look down by 40
// degrees.
Eigen::Matrix3d camera_from_kinect_accelerometer();

struct TimedAcceleration {
  double timestamp_s = 0;
  Eigen::Vector3d acceleration_m_s2 = Eigen::Vector3d::Zero();
};

// In ascending time. kCorruptData, naming the line.
Result<std::vector<TimedAcceleration>> parse_accelerations(const std::string& text);
std::string format_accelerations(const std::vector<TimedAcceleration>& felt);

// Returns for each frame the mean since the frame before, but of kMostFelt_s at most; nullopt where
// nothing was felt. Both lists ascend in time.
inline constexpr double kMostFelt_s = 0.1;
std::vector<std::optional<Eigen::Vector3d>> felt_before(const std::vector<double>& frame_times_s,
                                                        const std::vector<TimedAcceleration>& felt);

}  // namespace hermite::dataset
