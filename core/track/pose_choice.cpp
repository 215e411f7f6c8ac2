#include "core/track/pose_choice.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hermite::track {

namespace {

// Above this share of the best fit, another pose is a rival. Between bare walls the true pose
// had 1.47, where 55 % of the frame overlap with a correlation of 0.98, and a false one 1.08, with
// 68 % and 0.84.
constexpr double kRivalShare = 0.85;

// Within these limits the next frame decides.
constexpr double kSamePose_m = 0.05, kSamePose_rad = 3 * M_PI / 180;

// Along a bare wall depth fits everywhere, so that the image must tell the poses apart. What agrees
// in depth counts as much as an image with a correlation of 0.93.
double fit_of(const Agreement& a) { return a.overlap * a.agreeing * (1 + image_information(a)); }

bool is_same_pose(const Rigid3& a, const Rigid3& b) {
  const Rigid3 between = inverse(a) * b;
  return between.translation.norm() < kSamePose_m && angle_rad(between.rotation) < kSamePose_rad;
}

bool fits_better(const OdometryResult& a, const OdometryResult& b) {
  return fit_of(a.agreement) > fit_of(b.agreement);
}

}  // namespace

void add_pose(std::vector<OdometryResult>& poses, OdometryResult result) {
  const auto same =
      std::find_if(poses.begin(), poses.end(), [&result](const OdometryResult& other) {
        return is_same_pose(result.reference_from_camera, other.reference_from_camera);
      });
  if (same == poses.end())
    poses.push_back(std::move(result));
  else if (fits_better(result, *same))
    *same = std::move(result);
}

OdometryResult best_pose(std::vector<OdometryResult> poses, const TrackOptions& options) {
  std::stable_sort(poses.begin(), poses.end(), fits_better);
  const double best = fit_of(poses.front().agreement);
  poses.front().is_ambiguous =
      std::any_of(poses.begin() + 1, poses.end(), [best, &options](const OdometryResult& rival) {
        return fit_of(rival.agreement) > kRivalShare * best &&
               is_believable(rival.agreement, rival.reference_from_camera, options);
      });
  return std::move(poses.front());
}

}  // namespace hermite::track
