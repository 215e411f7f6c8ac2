#include "core/track/pose_guesses.h"

#include <cmath>
#include <utility>

namespace hermite::track {

std::vector<Rigid3> pose_guesses(const Rigid3& turned, const Rigid3& last_motion,
                                 const FeatureMotion* corners, const TrackOptions& options) {
  std::vector<Rigid3> result{corners ? corners->earlier_from_frame : turned};
  if (options.constant_velocity) {
    result.push_back(last_motion);
    if (!corners && options.rotation_prealignment)
      result.push_back({turned.rotation, last_motion.translation});
  }
  return result;
}

std::vector<Rigid3> with_turns(std::vector<Rigid3> guesses) {
  for (const double pitch_deg : {-12.0, 0.0, 12.0})
    for (const double yaw_deg : {-18.0, -9.0, 0.0, 9.0, 18.0})
      guesses.push_back(exp_se3(
          (Vector6d() << 0, 0, 0, pitch_deg * M_PI / 180, yaw_deg * M_PI / 180, 0).finished()));
  return guesses;
}

}  // namespace hermite::track
