#include "core/evaluate/depth_consistency.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/dataset/associate.h"
#include "core/evaluate/trajectory_error.h"

namespace hermite::evaluate {
namespace {

using Eigen::Vector3d;

constexpr double kRadian_per_deg = M_PI / 180;
const double kMinSlantCosine = std::cos(kMaxSlant_deg * kRadian_per_deg);
const double kMinNormalCosine = std::cos(kMaxNormalAngle_deg * kRadian_per_deg);
// As fractions of the image width: a window of 9 pixels and every 8th pixel for images 640 pixels
// wide.
constexpr int kWindowRadiusShare = 160, kSampleShare = 80;

// Index of the recorded pixel for each pixel of the undistorted image; -1 outside.
using StraightPixels = std::vector<std::ptrdiff_t>;

StraightPixels straight_pixels(const Camera& camera) {
  StraightPixels sources;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector2d at = camera.distort(x, y);
      const double column = std::round(at.x()), row = std::round(at.y());
      const bool inside = column >= 0 && row >= 0 && column < camera.width && row < camera.height;
      sources.push_back(inside ? static_cast<std::ptrdiff_t>(row) * camera.width +
                                     static_cast<std::ptrdiff_t>(column)
                               : -1);
    }
  return sources;
}

// A point of the surface with its unit normal, away from the camera; both in the camera frame.
struct Patch {
  Vector3d point, normal;
};

// The surface that a frame saw.
class View {
 public:
  View(const DepthImage& depth, const Camera& camera, const StraightPixels& sources)
      : camera_(camera),
        radius_(std::max(1, camera.width / kWindowRadiusShare)),
        inverse_depth_(camera.width, camera.height) {
    const auto width = static_cast<std::size_t>(camera.width);
    for (std::size_t i = 0; i < sources.size(); ++i) {
      const double measured_m =
          sources[i] < 0
              ? 0
              : depth.pixels[static_cast<std::size_t>(sources[i])] / camera.depth_units_per_metre;
      const double rho2 =
          camera.rho2(static_cast<double>(i % width), static_cast<double>(i / width));
      const double depth_m = camera.depth_correction.true_depth_m(measured_m, rho2);
      const bool usable = depth_m >= kNearestConsistent_m && depth_m <= kFarthestConsistent_m;
      inverse_depth_.pixels[i] = usable ? static_cast<float>(1 / depth_m) : 0.0f;
    }
  }

  // Returns std::nullopt at edges, on slanted surfaces, without depth and outside the image.
  std::optional<Patch> patch(int x, int y) const {
    if (x < radius_ || y < radius_ || x >= camera_.width - radius_ || y >= camera_.height - radius_)
      return std::nullopt;
    const float middle = inverse_depth_.at(x, y),
                most = middle * static_cast<float>(kMaxWindowSpread);
    if (middle == 0) return std::nullopt;
    double sum = 0, along_x = 0, along_y = 0, squares = 0;
    for (int dy = -radius_; dy <= radius_; ++dy)
      for (int dx = -radius_; dx <= radius_; ++dx) {
        const float value = inverse_depth_.at(x + dx, y + dy);
        if (std::abs(value - middle) > most) return std::nullopt;
        sum += static_cast<double>(value);
        along_x += dx * static_cast<double>(value);
        along_y += dy * static_cast<double>(value);
        squares += dx * dx;
      }
    const int side = 2 * radius_ + 1;
    return plane(x, y, sum / (side * side), along_x / squares, along_y / squares);
  }

  // Returns the patch at the pixel onto which the point projects.
  std::optional<Patch> patch_at(const Vector3d& point) const {
    const Eigen::Vector2d pixel = camera_.project(point);
    if (!(pixel.x() > 0 && pixel.y() > 0 && pixel.x() < camera_.width &&
          pixel.y() < camera_.height))
      return std::nullopt;
    return patch(static_cast<int>(std::lround(pixel.x())),
                 static_cast<int>(std::lround(pixel.y())));
  }

  // Returns patches at pixels all over the image.
  std::vector<Patch> samples() const {
    std::vector<Patch> patches;
    const int step = std::max(1, camera_.width / kSampleShare);
    for (int y = step / 2; y < camera_.height; y += step)
      for (int x = step / 2; x < camera_.width; x += step)
        if (const std::optional<Patch> found = patch(x, y)) patches.push_back(*found);
    return patches;
  }

 private:
  // With 1/z = w + a (u - x) + b (v - y), substituting u = fx X / z + cx and multiplying by z gives
  // the plane n.p = 1.
  std::optional<Patch> plane(int x, int y, double w, double a, double b) const {
    const Vector3d scaled(a * camera_.fx, b * camera_.fy,
                          w + a * (camera_.cx - x) + b * (camera_.cy - y));
    const Vector3d point = camera_.unproject(x, y, 1 / w);
    const double slant_cosine = 1 / (scaled.norm() * point.norm());
    if (slant_cosine < kMinSlantCosine) return std::nullopt;
    return Patch{point, scaled.normalized()};
  }

  const Camera camera_;
  const int radius_;            // pixels
  Image<float> inverse_depth_;  // 1/m, 0: none
};

// Distances of one pair under one trajectory.
struct PairDistances {
  std::vector<double> distances_m;
  double overlap = 0;

  bool count() const {
    return distances_m.size() >= kMinConsistentPoints && overlap >= kMinConsistentOverlap;
  }
};

PairDistances pair_distances(const std::vector<Patch>& first, const View& second,
                             const Rigid3& second_from_first) {
  PairDistances pair;
  for (const Patch& patch : first) {
    const Vector3d point = second_from_first * patch.point;
    if (point.z() < kNearestConsistent_m / 2) continue;
    const std::optional<Patch> there = second.patch_at(point);
    if (!there || std::abs(point.z() - there->point.z()) > kMaxDepthGap_m) continue;
    if (there->normal.dot(second_from_first.rotation * patch.normal) < kMinNormalCosine) continue;
    pair.distances_m.push_back(
        std::min(std::abs(there->normal.dot(point - there->point)), kMaxConsistent_m));
  }
  if (!first.empty())
    pair.overlap = static_cast<double>(pair.distances_m.size()) / static_cast<double>(first.size());
  return pair;
}

// The poses of a frame, one per trajectory; empty if one has none.
using FramePoses = std::vector<Rigid3>;

// Returns one entry per trajectory.
std::vector<PairDistances> all_distances(const std::vector<Patch>& first,
                                         const FramePoses& world_from_first, const View& second,
                                         const FramePoses& world_from_second) {
  std::vector<PairDistances> pairs;
  for (std::size_t t = 0; t < world_from_first.size(); ++t)
    pairs.push_back(
        pair_distances(first, second, inverse(world_from_second[t]) * world_from_first[t]));
  return pairs;
}

// Intermediate results of one spacing.
struct Gathered {
  SpacingConsistency result;
  std::vector<std::vector<double>> distances_m;  // by trajectory
  std::vector<double> overlap_sum;
  std::vector<std::int64_t> better_count;

  Gathered(std::int64_t spacing, std::size_t trajectory_count)
      : distances_m(trajectory_count),
        overlap_sum(trajectory_count),
        better_count(trajectory_count) {
    result.spacing_frames = spacing;
  }

  void add(const std::vector<PairDistances>& pairs) {
    ++result.tried_count;
    if (!std::all_of(pairs.begin(), pairs.end(),
                     [](const PairDistances& pair) { return pair.count(); }))
      return;
    ++result.pair_count;
    std::vector<double> medians_m;
    for (std::size_t t = 0; t < pairs.size(); ++t) {
      distances_m[t].insert(distances_m[t].end(), pairs[t].distances_m.begin(),
                            pairs[t].distances_m.end());
      overlap_sum[t] += pairs[t].overlap;
      medians_m.push_back(statistics_of(pairs[t].distances_m).median);
    }
    const auto best = std::min_element(medians_m.begin(), medians_m.end());
    const bool alone = std::count(medians_m.begin(), medians_m.end(), *best) == 1;
    if (medians_m.size() > 1 && alone)
      ++better_count[static_cast<std::size_t>(best - medians_m.begin())];
  }

  SpacingConsistency summary() {
    const auto count = static_cast<double>(result.pair_count);
    for (std::size_t t = 0; t < distances_m.size() && result.pair_count > 0; ++t) {
      const ErrorStatistics statistics = statistics_of(std::move(distances_m[t]));
      result.trajectories.push_back({statistics.median, statistics.rmse, overlap_sum[t] / count,
                                     static_cast<double>(better_count[t]) / count});
    }
    return result;
  }
};

Status check_arguments(const std::vector<dataset::Trajectory>& trajectories,
                       const ConsistencyOptions& options) {
  if (trajectories.empty() || options.spacings.empty())
    return Error{ErrorCode::kInvalidArgument, "consistency needs a trajectory and a spacing"};
  for (const std::int64_t spacing : options.spacings)
    if (spacing < 1)
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("a spacing of {} frames: needed is at least 1", spacing)};
  CHECK(options.max_first_frames >= 1, "no frames to begin with");
  for (std::size_t t = 0; t < trajectories.size(); ++t)
    if (const Status status = validate(trajectories[t], "trajectory " + std::to_string(t + 1));
        !status.ok())
      return status;
  return Done{};
}

Result<std::vector<FramePoses>> poses_of_frames(
    const dataset::Sequence& sequence, const std::vector<dataset::Trajectory>& trajectories) {
  std::vector<FramePoses> frames(static_cast<std::size_t>(sequence.frame_count()));
  std::vector<std::int64_t> posed_count(trajectories.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (std::size_t t = 0; t < trajectories.size(); ++t) {
      const auto pose =
          dataset::pose_at(trajectories[t], sequence.timestamp_s(static_cast<std::int64_t>(i)),
                           dataset::kMaxAssociationGap_s);
      if (!pose) continue;
      ++posed_count[t];
      frames[i].push_back(*pose);
    }
    if (frames[i].size() < trajectories.size()) frames[i].clear();
  }
  for (std::size_t t = 0; t < trajectories.size(); ++t)
    if (posed_count[t] == 0)
      return Error{
          ErrorCode::kInvalidArgument,
          fmt::format("trajectory {} has no pose for any frame of {}", t + 1, sequence.name())};
  return frames;
}

class ViewReader {
 public:
  ViewReader(const dataset::Sequence& sequence, std::vector<FramePoses> poses)
      : sequence_(sequence),
        poses_(std::move(poses)),
        sources_(straight_pixels(sequence.camera())) {}

  const FramePoses& poses(std::int64_t index) const {
    return poses_[static_cast<std::size_t>(index)];
  }

  // Returns std::nullopt if the frame has no poses or cannot be read; the other frames suffice.
  std::optional<View> read(std::int64_t index) const {
    if (poses(index).empty()) return std::nullopt;
    const Camera& camera = sequence_.camera();
    const Result<dataset::RecordedFrame> frame = sequence_.read(index);
    if (!frame.ok() || frame->depth.width != camera.width || frame->depth.height != camera.height)
      return std::nullopt;
    return View(frame->depth, camera, sources_);
  }

 private:
  const dataset::Sequence& sequence_;
  const std::vector<FramePoses> poses_;
  const StraightPixels sources_;
};

}  // namespace

Result<std::vector<SpacingConsistency>> depth_consistency(
    const dataset::Sequence& sequence, const std::vector<dataset::Trajectory>& trajectories,
    const ConsistencyOptions& options) {
  if (const Status status = check_arguments(trajectories, options); !status.ok())
    return status.error();
  auto poses = poses_of_frames(sequence, trajectories);
  if (!poses.ok()) return poses.error();
  const ViewReader reader(sequence, *std::move(poses));
  std::vector<Gathered> gathered;
  for (const std::int64_t spacing : options.spacings)
    gathered.emplace_back(spacing, trajectories.size());

  const std::int64_t frame_count = sequence.frame_count();
  const std::int64_t stride =
      (frame_count + options.max_first_frames - 1) / options.max_first_frames;
  for (std::int64_t index = 0; index < frame_count; index += stride) {
    const std::optional<View> first = reader.read(index);
    if (!first) continue;
    const std::vector<Patch> patches = first->samples();
    for (Gathered& spacing : gathered) {
      if (spacing.result.spacing_frames >= frame_count - index) continue;
      const std::int64_t second_index = index + spacing.result.spacing_frames;
      const std::optional<View> second = reader.read(second_index);
      if (second)
        spacing.add(
            all_distances(patches, reader.poses(index), *second, reader.poses(second_index)));
    }
  }
  std::vector<SpacingConsistency> result;
  for (Gathered& spacing : gathered) result.push_back(spacing.summary());
  return result;
}

std::string format_consistency_json(const std::vector<SpacingConsistency>& spacings,
                                    const std::vector<std::string>& names) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const SpacingConsistency& spacing : spacings) {
    nlohmann::ordered_json json;
    json["spacing_frames"] = spacing.spacing_frames;
    json["pairs_tried"] = spacing.tried_count;
    json["pairs"] = spacing.pair_count;
    for (std::size_t t = 0; t < spacing.trajectories.size(); ++t) {
      const Consistency& consistency = spacing.trajectories[t];
      json[names.at(t) + "_median_m"] = consistency.median_m;
      json[names.at(t) + "_rms_m"] = consistency.rms_m;
      json[names.at(t) + "_overlap"] = consistency.overlap;
      if (names.size() > 1) json[names.at(t) + "_better_share"] = consistency.better_share;
    }
    list.push_back(json);
  }
  return nlohmann::ordered_json{{"consistency", list}}.dump(2) + "\n";
}

}  // namespace hermite::evaluate
