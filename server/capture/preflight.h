// Checks before a scan whether the camera is fit for scanning and held well. One thread at a time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/evaluate/depth_survey.h"
#include "core/evaluate/registration_check.h"
#include "server/capture/camera.h"

namespace hermite::client {

inline constexpr int kPreflightFrames = 30;  // one second of a Kinect

class Preflight {
 public:
  explicit Preflight(const CameraDescription& camera);

  // Adds a frame of the camera, in order. `host_s`: time of arrival by any clock of this machine.
  // `left_out`: of the camera so far.
  void add(const frame::RgbdFrame& frame, double host_s, const LeftOut& left_out = {});
  int frame_count() const { return static_cast<int>(frames_.size()); }

  // Returns what is wrong, in sentences for the person who holds the camera, the most important
  // first; empty if all is well. CHECKs frame_count(). Checks depth: none, little, unit,
  // registration, too near; timestamps: rate, gaps, the host's clock, missing colour; and exposure.
  std::vector<std::string> doubts() const;

  // Returns for example "30 frames at 29.9 Hz, 81 % of the pixels have depth, 0.62 to 3.40 m".
  std::string summary() const;

 private:
  struct Seen {
    double time_s, host_s;
    double mean_grey;  // 0 to 255
  };
  double rate_hz() const;  // from the median time step; 0 for one frame
  void add_time_doubts(std::vector<std::string>& doubts) const;
  void add_image_doubts(std::vector<std::string>& doubts) const;

  const CameraDescription camera_;
  std::vector<Seen> frames_;
  LeftOut left_out_;
  evaluate::DepthValues depth_;
  evaluate::RegistrationCheck registration_;
};

}  // namespace hermite::client
