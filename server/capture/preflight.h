// Is this camera fit for scanning, and is it held well? Looked at before the scan begins. One thread at a time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/evaluate/depth_survey.h"
#include "core/evaluate/registration_check.h"
#include "server/capture/camera.h"

namespace hermite {

inline constexpr int kPreflightFrames = 30;  // a second of a Kinect

class Preflight {
 public:
  explicit Preflight(const CameraDescription& camera);

  // A frame of the camera, in order; `host_s`: any clock of this machine when it arrived. `left_out`: of the camera so far.
  void add(const RgbdFrame& frame, double host_s, const LeftOut& left_out = {});
  int frame_count() const { return static_cast<int>(frames_.size()); }

  // What is wrong, in sentences for whoever holds the camera, the most important first; empty when all is well. CHECKs frame_count().
  // Depth: none, little, unit, registration, too near. Times: rate, gaps, the host's clock, colour that is missing. Exposure.
  std::vector<std::string> doubts() const;

  // "30 frames at 29.9 Hz, 81 % of the pixels have depth, 0.62 to 3.40 m"
  std::string summary() const;

 private:
  struct Seen {
    double time_s, host_s;
    double mean_grey;  // 0 to 255
  };
  double rate_hz() const;  // by the median step; 0 for one frame
  void add_time_doubts(std::vector<std::string>& doubts) const;
  void add_picture_doubts(std::vector<std::string>& doubts) const;

  const CameraDescription camera_;
  std::vector<Seen> frames_;
  LeftOut left_out_;
  DepthValues depth_;
  RegistrationCheck registration_;
};

}  // namespace hermite
