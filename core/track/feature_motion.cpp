#include "core/track/feature_motion.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/track/reprojection.h"

namespace hermite::track {

namespace {

// Windows of nine by nine pixels are compared; at each level, steps are made until one is
// negligible.
constexpr int kRadius_px = 4, kMaxSteps = 8;
constexpr double kConverged_px = 0.03;
// A corner that is followed back must return to within this distance; mean absolute grey difference
// below this.
constexpr double kReturns_px = 0.5, kAlike_grey = 12;
// Bound for the accumulated drift of a corner from frame to frame, within which its first patch is
// found again.
constexpr double kPatchIsNear_px = 1;

// Corner errors follow Student's t distribution as in the odometry. A minimum number of corners
// must agree within three deviations; the deviation is at most two image pixels, because half of
// the wrongly followed corners are farther off.
constexpr double kDegreesOfFreedom = 5, kFirstDeviation_px = 8, kLeastDeviation_px = 0.3,
                 kMostDeviation_px = 2;
// Standard deviation of a corner combined with dense terms: the error of tracking between frames
// that exceeds its noise.
constexpr double kTermDeviation_px = 0.5;
constexpr double kNearest_m = 0.05;
// The share of the corners that must have been followed for a motion without translation to be
// accepted; between images of different places a few corners match by chance.
constexpr double kFollowedShare = 0.25;
constexpr int kLeastCorners = 12, kSteps = 12;

// Prior of the motion between two frames, in effect for directions that the corners do not
// determine: a camera moves by decimetres and turns by tenths of a radian.
constexpr double kPriorTranslation_m = 0.3, kNoTranslation_m = 1e-6, kPriorRotation_rad = 0.5;

bool has_window(const frame::GreyImage& image, const Eigen::Vector2d& at, int margin) {
  return at.x() >= kRadius_px + margin && at.y() >= kRadius_px + margin &&
         at.x() < image.width - 1 - kRadius_px - margin &&
         at.y() < image.height - 1 - kRadius_px - margin;
}

constexpr int kSide = 2 * kRadius_px + 1;
// Half the size of a patch: window, gradients, and one pixel for interpolation.
constexpr int kReach = kRadius_px + 2;
using Window = std::array<double, kSide * kSide>;

// Returns interpolated grey values at Side x Side positions one pixel apart, centred on `at`; all
// of them have the same interpolation weights.
template <int Side>
std::array<double, Side * Side> sample(const frame::GreyImage& image, const Eigen::Vector2d& at) {
  const double first_x = at.x() - Side / 2, first_y = at.y() - Side / 2;
  const int left = static_cast<int>(first_x), top = static_cast<int>(first_y);
  const double a = first_x - left, b = first_y - top;
  std::array<double, Side * Side> result;
  std::array<double, Side> above, row;
  for (int y = 0; y <= Side; ++y) {
    const std::uint8_t* pixels =
        &image.pixels[static_cast<std::size_t>(top + y) * static_cast<std::size_t>(image.width) +
                      static_cast<std::size_t>(left)];
    for (int x = 0; x < Side; ++x)
      row[static_cast<std::size_t>(x)] = (1 - a) * pixels[x] + a * pixels[x + 1];
    for (int x = 0; y > 0 && x < Side; ++x)
      result[static_cast<std::size_t>((y - 1) * Side + x)] =
          (1 - b) * above[static_cast<std::size_t>(x)] + b * row[static_cast<std::size_t>(x)];
    above = row;
  }
  return result;
}

// Returns the grey values of the window around a position, minus their mean.
Window window_of(const frame::GreyImage& image, const Eigen::Vector2d& at) {
  Window window = sample<kSide>(image, at);
  double sum = 0;
  for (const double grey : window) sum += grey;
  for (double& grey : window) grey -= sum / (kSide * kSide);
  return window;
}

// Moves `place` to where `to` matches `from` at `source`. Returns false if it leaves the image, or
// if the window has too little texture.
bool refine(const frame::GreyImage& from, const frame::GreyImage& to, const Eigen::Vector2d& source,
            Eigen::Vector2d& place, double& misfit_grey) {
  if (!has_window(from, source, 1)) return false;
  constexpr int kWide = kSide + 2;  // with the neighbours for the gradients
  const std::array<double, kWide* kWide> around = sample<kWide>(from, source);
  Window wanted;
  std::array<Eigen::Vector2d, kSide * kSide> gradient;
  double sum = 0;
  Eigen::Matrix2d tensor = Eigen::Matrix2d::Zero();
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (std::size_t y = 0; y < kSide; ++y)
    for (std::size_t x = 0; x < kSide; ++x) {
      const double* here = &around[(y + 1) * kWide + x + 1];
      wanted[y * kSide + x] = *here;
      sum += *here;
      Eigen::Vector2d& g = gradient[y * kSide + x];
      g = 0.5 * Eigen::Vector2d(here[1] - here[-1], here[kWide] - here[-kWide]);
      mean += g / (kSide * kSide);
    }
  for (double& grey : wanted) grey -= sum / (kSide * kSide);
  for (Eigen::Vector2d& g : gradient) {
    g -= mean;
    tensor += g * g.transpose();
  }
  const double determinant = tensor.determinant();
  if (!(determinant > 1e-3 * tensor.trace() * tensor.trace()) || tensor.trace() < kSide * kSide)
    return false;
  const Eigen::Matrix2d inverse = tensor.inverse();
  for (int step = 0; step < kMaxSteps; ++step) {
    if (!has_window(to, place, 0)) return false;
    const Window seen = window_of(to, place);
    Eigen::Vector2d pull = Eigen::Vector2d::Zero();
    misfit_grey = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const double difference = seen[i] - wanted[i];
      pull += difference * gradient[i];
      misfit_grey += std::abs(difference) / static_cast<double>(seen.size());
    }
    const Eigen::Vector2d move = inverse * pull;
    place -= move;
    if (move.norm() < kConverged_px) break;
  }
  return has_window(to, place, 0);
}

// Follows a corner without the check backwards.
std::optional<Eigen::Vector2d> lead(const frame::ImageFeatures& from,
                                    const frame::ImageFeatures& to, const Eigen::Vector2d& source) {
  Eigen::Vector2d flow = Eigen::Vector2d::Zero();
  double misfit_grey = 0;
  for (std::size_t level = from.levels.size(); level-- > 0;) {
    // A pixel of a coarse level is centred on the finer pixels that it covers.
    const double scale = std::ldexp(1.0, static_cast<int>(level));
    const Eigen::Vector2d start = ((source.array() + 0.5) / scale - 0.5).matrix();
    Eigen::Vector2d place = start + flow;
    const bool found = refine(from.levels[level], to.levels[level], start, place, misfit_grey);
    if (!found && level == 0) return std::nullopt;
    if (found) flow = place - start;
    if (level > 0) flow *= 2;
  }
  if (misfit_grey > kAlike_grey) return std::nullopt;
  return source + flow;
}

// Solves for frame_from_earlier, starting at the identity. With `turn_only`, corners are taken to
// be infinitely far.
std::optional<FeatureMotion> solve(const std::vector<FollowedCorner>& corners, const Camera& camera,
                                   bool turn_only) {
  Rigid3 frame_from_earlier;
  double deviation_px = kFirstDeviation_px;
  int agreeing = 0;
  for (int step = 0; step < kSteps; ++step) {
    NormalEquations system =
        motion_prior(turn_only ? kNoTranslation_m : kPriorTranslation_m, kPriorRotation_rad);
    double weighted_px2 = 0;
    agreeing = 0;
    for (const FollowedCorner& corner : corners) {
      const Eigen::Vector3d p = frame_from_earlier * corner.point_in_earlier;
      if (p.z() < kNearest_m) continue;
      const Eigen::Vector2d error = camera.project(p) - corner.pixel;
      const double scaled2 = error.squaredNorm() / (deviation_px * deviation_px),
                   likely = kDegreesOfFreedom / (kDegreesOfFreedom + scaled2);
      add_reprojection(system, camera, p, error, likely / (deviation_px * deviation_px));
      weighted_px2 += likely * error.squaredNorm();
      agreeing += scaled2 < 9 ? 1 : 0;
    }
    frame_from_earlier =
        exp_se3(system.hessian.ldlt().solve(system.right_hand_side)) * frame_from_earlier;
    deviation_px = std::clamp(std::sqrt(weighted_px2 / (2 * static_cast<double>(corners.size()))),
                              kLeastDeviation_px, deviation_px);
  }
  if (agreeing < kLeastCorners || 2 * agreeing < static_cast<int>(corners.size()) ||
      deviation_px > (turn_only ? kFirstDeviation_px : kMostDeviation_px))
    return std::nullopt;
  FeatureMotion motion{inverse(frame_from_earlier), turn_only, agreeing, deviation_px, camera, {}};
  if (turn_only) motion.earlier_from_frame.translation.setZero();
  return motion;
}

}  // namespace

std::optional<Eigen::Vector2d> follow(const frame::ImageFeatures& earlier,
                                      const frame::ImageFeatures& frame,
                                      const Eigen::Vector2d& corner_px) {
  const auto there = lead(earlier, frame, corner_px);
  if (!there) return std::nullopt;
  const auto back = lead(frame, earlier, *there);
  return back && (*back - corner_px).norm() < kReturns_px ? there : std::nullopt;
}

int patch_side_px() { return 2 * kReach + 1; }

frame::GreyImage patch_around(const frame::GreyImage& image, const frame::Corner& corner) {
  const int x = static_cast<int>(corner.x), y = static_cast<int>(corner.y);
  if (x < kReach || y < kReach || x >= image.width - kReach || y >= image.height - kReach)
    return {};
  frame::GreyImage patch{patch_side_px(), patch_side_px(), {}};
  for (int dy = -kReach; dy <= kReach; ++dy)
    for (int dx = -kReach; dx <= kReach; ++dx) patch.pixels.push_back(image.at(x + dx, y + dy));
  return patch;
}

std::optional<Eigen::Vector2d> find_patch(const frame::GreyImage& patch,
                                          const frame::GreyImage& image,
                                          const Eigen::Vector2d& near_px) {
  if (patch.pixels.empty()) return std::nullopt;
  Eigen::Vector2d place = near_px;
  double misfit_grey = 0;
  if (!refine(patch, image, Eigen::Vector2d::Constant(patch.width / 2), place, misfit_grey) ||
      misfit_grey > kAlike_grey)
    return std::nullopt;
  return (place - near_px).norm() < kPatchIsNear_px ? std::optional(place) : std::nullopt;
}

std::optional<FeatureMotion> motion_by_corners(const std::vector<FollowedCorner>& all,
                                               const std::vector<FollowedCorner>& with_depth,
                                               std::size_t corner_count, const Camera& camera) {
  auto motion = solve(with_depth, camera, false);
  if (!motion &&
      static_cast<double>(all.size()) > kFollowedShare * static_cast<double>(corner_count))
    motion = solve(all, camera, true);
  if (motion) motion->corners = with_depth;
  return motion;
}

CornerAgreement corners_at(const FeatureMotion& features, const Rigid3& earlier_from_frame) {
  const Rigid3 frame_from_earlier = inverse(earlier_from_frame);
  const auto agrees = [&](const FollowedCorner& corner) {
    const Eigen::Vector3d p = frame_from_earlier * corner.point_in_earlier;
    return p.z() > kNearest_m &&
           (features.camera.project(p) - corner.pixel).norm() < kMostDeviation_px;
  };
  const auto count = std::count_if(features.corners.begin(), features.corners.end(), agrees);
  return {static_cast<int>(count),
          features.corners.empty()
              ? 0
              : static_cast<double>(count) / static_cast<double>(features.corners.size())};
}

bool do_contradict(const std::vector<FollowedCorner>& corners, const Camera& camera,
                   const Rigid3& earlier_from_frame) {
  // Most of at least so many must be off by both this many pixels of the image and this share of
  // their displacement.
  constexpr std::size_t kTellingCorners = 30;
  constexpr double kClearly_px = 10, kMostOfTheWay = 0.75;
  if (corners.size() < kTellingCorners) return false;
  const Rigid3 frame_from_earlier = inverse(earlier_from_frame);
  std::size_t against = 0;
  for (const FollowedCorner& corner : corners) {
    const Eigen::Vector3d point = frame_from_earlier * corner.point_in_earlier;
    const Eigen::Vector2d before = camera.project(corner.point_in_earlier);
    const double off_px =
        point.z() > 0 ? (camera.project(point) - corner.pixel).norm() : kClearly_px;
    against +=
        off_px >= std::max(kClearly_px, kMostOfTheWay * (corner.pixel - before).norm()) ? 1 : 0;
  }
  return 2 * against > corners.size();
}

NormalEquations feature_terms(const FeatureMotion& features, const Rigid3& earlier_from_frame) {
  NormalEquations terms;
  const Camera& camera = features.camera;
  const Rigid3 frame_from_earlier = inverse(earlier_from_frame);
  const double deviation_px = std::max(features.deviation_px, kTermDeviation_px);
  for (const FollowedCorner& corner : features.corners) {
    const Eigen::Vector3d p = frame_from_earlier * corner.point_in_earlier;
    if (p.z() < kNearest_m) continue;
    const Eigen::Vector2d error = camera.project(p) - corner.pixel;
    const double scaled2 = error.squaredNorm() / (deviation_px * deviation_px),
                 likely = kDegreesOfFreedom / (kDegreesOfFreedom + scaled2);
    add_reprojection(terms, camera, p, error, likely / (deviation_px * deviation_px));
  }
  // A step exp(x) of earlier_from_frame is a step exp(-Ad x) of its inverse.
  const Matrix6d change = -adjoint(frame_from_earlier);
  return {change.transpose() * terms.hessian * change, change.transpose() * terms.right_hand_side};
}

}  // namespace hermite::track
