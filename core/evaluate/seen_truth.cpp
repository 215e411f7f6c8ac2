#include "core/evaluate/seen_truth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>
#include <unordered_set>

#include "core/base/parallel.h"
#include "core/dataset/associate.h"
#include "core/evaluate/drawn_depth.h"
#include "core/evaluate/true_surface.h"
#include "core/math/counted_random.h"
#include "core/source/open_sequence.h"
#include "core/synthetic/synthetic_camera.h"

namespace hermite::evaluate {

namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kSeenCell_m = 0.02;
// Normals are compared between points of this spacing that are at most this far apart.
constexpr double kNormalSpacing_m = 0.01, kCreaseReach_m = 0.015;
// Normals of depth are computed over this many pixels to each side.
constexpr int kNormalReach_px = 2;
constexpr double kSameSurfaceShare = 0.03;
// A face at a grazing angle may be the gap between two surfaces.
constexpr double kLeastCosine = 0.25;
constexpr double kMostMoved_m = 0.15;
constexpr double kMostTurned_rad = 10 * std::numbers::pi / 180;
constexpr std::uint64_t kViewSeed = 24;
constexpr int kWideView_px = 320;

std::uint64_t voxel_of(const Vector3d& point, double side_m) {
  const Vector3i cell = (point / side_m).array().floor().cast<int>();
  const auto bits = [](int value) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(value) & 0x1fffffu);
  };
  return bits(cell.x()) | bits(cell.y()) << 21 | bits(cell.z()) << 42;
}

struct PointWithNormal {
  Vector3d position_m;
  Vector3d normal;  // unit
};

// The truth while it is being collected.
struct Gathering {
  std::shared_ptr<const synthetic::SyntheticRoom> room;  // nullptr: the depth is the truth
  std::vector<Triangle> triangles;                       // of the depth
  std::vector<Vector3d> samples;
  std::unordered_set<std::uint64_t> sampled;
  std::vector<PointWithNormal> normals;
  std::unordered_map<std::uint64_t, std::uint32_t> normals_by_voxel;
};

Vector3d normal_of_depth(const DepthImage& depth, const Camera& camera, int x, int y) {
  if (x < kNormalReach_px || y < kNormalReach_px || x + kNormalReach_px >= depth.width ||
      y + kNormalReach_px >= depth.height)
    return Vector3d::Zero();
  const auto point = [&](int u, int v) {
    return camera.unproject(u, v, depth.at(u, v) / camera.depth_units_per_metre);
  };
  const Vector3d here = point(x, y), left = point(x - kNormalReach_px, y),
                 right = point(x + kNormalReach_px, y), up = point(x, y - kNormalReach_px),
                 down = point(x, y + kNormalReach_px);
  const auto [low, high] = std::minmax({here.z(), left.z(), right.z(), up.z(), down.z()});
  if (low <= 0 || high - low > kSameSurfaceShare * low) return Vector3d::Zero();
  const Vector3d normal = (down - up).cross(right - left).normalized();
  return -normal.dot(here.normalized()) >= kLeastCosine ? normal : Vector3d::Zero();
}

void add_frame(const DepthImage& depth, const Camera& camera, const Rigid3& world_from_camera,
               Gathering& gathering) {
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      if (depth.at(x, y) == 0) continue;
      const Vector3d point =
          world_from_camera * camera.unproject(x, y, depth.at(x, y) / camera.depth_units_per_metre);
      if (gathering.sampled.insert(voxel_of(point, kSampleSpacing_m)).second)
        gathering.samples.push_back(point);
      const std::uint64_t voxel = voxel_of(point, kNormalSpacing_m);
      if (gathering.normals_by_voxel.contains(voxel)) continue;
      const Vector3d normal = normal_of_depth(depth, camera, x, y);
      if (normal.isZero()) continue;
      gathering.normals_by_voxel.emplace(voxel,
                                         static_cast<std::uint32_t>(gathering.normals.size()));
      gathering.normals.push_back({point, world_from_camera.rotation * normal});
    }
  if (!gathering.room)
    append_depth_triangles(depth, camera, world_from_camera, camera.width > kWideView_px ? 2 : 1,
                           gathering.triangles);
}

std::vector<Vector3d> creases_of(const Gathering& gathering) {
  const double most = std::cos(30 * std::numbers::pi / 180),
               least = std::cos(150 * std::numbers::pi / 180);
  const auto bends_towards = [&](const PointWithNormal& point, const Vector3d& near) {
    const auto found = gathering.normals_by_voxel.find(voxel_of(near, kNormalSpacing_m));
    if (found == gathering.normals_by_voxel.end()) return false;
    const PointWithNormal& other = gathering.normals[found->second];
    const double cosine = other.normal.dot(point.normal);
    return cosine < most && cosine > least &&
           (other.position_m - point.position_m).norm() <= kCreaseReach_m;
  };
  const auto is_crease = [&](const PointWithNormal& point) {
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x)
          if (bends_towards(point, point.position_m + kNormalSpacing_m * Vector3d(x, y, z)))
            return true;
    return false;
  };
  std::vector<Vector3d> creases;
  for (const PointWithNormal& point : gathering.normals)
    if (is_crease(point)) creases.push_back(point.position_m);
  return creases;
}

Camera half_of(Camera camera) {
  if (camera.width <= kWideView_px) return camera;
  camera.width /= 2;
  camera.height /= 2;
  camera.fx /= 2;
  camera.fy /= 2;
  camera.cx = (camera.cx - 0.5) / 2;
  camera.cy = (camera.cy - 0.5) / 2;
  return camera;
}

// Displaces a camera. The displacement is halved up to three times until the way there stays
// kSurfaceReach_m away from surfaces; if it still does not, the camera is not displaced.
Rigid3 moved_aside(const Rigid3& world_from_camera, int view, const SeenTruth& truth) {
  Vector6d twist;
  for (int i = 0; i < 6; ++i)
    twist[i] = (2 * unit_uniform(frame_key(kViewSeed, view), static_cast<std::uint64_t>(i)) - 1) *
               (i < 3 ? kMostMoved_m : kMostTurned_rad);
  const auto is_free = [&](const Vector6d& way) {
    for (const double share : {0.25, 0.5, 0.75, 1.0})
      if (truth.distance_m((world_from_camera * exp_se3(share * way)).translation) <
          kSurfaceReach_m)
        return false;
    return true;
  };
  for (int attempt = 0; attempt < 4; ++attempt, twist *= 0.5)
    if (is_free(twist)) return world_from_camera * exp_se3(twist);
  return world_from_camera;
}

Image<float> true_depth_m(const Gathering& gathering, const Camera& camera,
                          const Rigid3& world_from_camera) {
  if (!gathering.room) return drawn_depth_m(gathering.triangles, camera, world_from_camera);
  const DepthImage depth = gathering.room->render(camera, world_from_camera).depth;
  Image<float> depth_m(camera.width, camera.height);
  for (std::size_t i = 0; i < depth.pixels.size(); ++i)
    depth_m.pixels[i] = static_cast<float>(depth.pixels[i] / camera.depth_units_per_metre);
  return depth_m;
}

// `seen`: the voxels that the recording shows.
BesideView view_beside(const Rigid3& world_from_recorded, int view, const Gathering& gathering,
                       const std::unordered_set<std::uint64_t>& seen, const SeenTruth& truth) {
  const Rigid3 world_from_camera = moved_aside(world_from_recorded, view, truth);
  Image<float> depth_m = true_depth_m(gathering, truth.view_camera, world_from_camera);
  for (int y = 0; y < depth_m.height; ++y)
    for (int x = 0; x < depth_m.width; ++x) {
      float& here_m = depth_m.at(x, y);
      const Vector3d point =
          world_from_camera * truth.view_camera.unproject(x, y, static_cast<double>(here_m));
      if (here_m > 0 && !seen.contains(voxel_of(point, kSeenCell_m))) here_m = 0;
    }
  return {world_from_camera, std::move(depth_m)};
}

void add_views(const dataset::Sequence& sequence, const Gathering& gathering, int count,
               SeenTruth& truth) {
  truth.view_camera = half_of(sequence.camera());
  if (sequence.frame_count() == 0 || count <= 0) return;
  std::unordered_set<std::uint64_t> seen;
  for (const Vector3d& sample : gathering.samples) seen.insert(voxel_of(sample, kSeenCell_m));
  std::vector<std::optional<BesideView>> views(static_cast<std::size_t>(count));
  in_parallel(views.size(), [&](std::size_t i) {
    const int view = static_cast<int>(i);
    const std::int64_t frame = view * sequence.frame_count() / count;
    const auto pose = dataset::pose_at(sequence.groundtruth(), sequence.timestamp_s(frame),
                                       dataset::kMaxAssociationGap_s);
    if (pose) views[i] = view_beside(*pose, view, gathering, seen, truth);
  });
  for (std::optional<BesideView>& view : views)
    if (view) truth.views.push_back(*std::move(view));
}

// Returns nullptr for a source that is not synthetic.
Result<std::shared_ptr<const synthetic::SyntheticRoom>> synthetic_room_of(
    const std::string& source) {
  static const std::string kPrefix = "synthetic";
  const std::string base = source::source_without_suffixes(source);
  if (base.rfind(kPrefix, 0) != 0) return std::shared_ptr<const synthetic::SyntheticRoom>();
  const auto options = synthetic::parse_synthetic_options(
      base.size() > kPrefix.size() ? base.substr(kPrefix.size() + 1) : "");
  if (!options.ok()) return options.error();
  return std::make_shared<const synthetic::SyntheticRoom>(
      or_throw(synthetic::SyntheticRoom::create(options->scene, options->changes)));
}

}  // namespace

Result<SeenTruth> seen_truth(const dataset::Sequence& sequence, const std::string& source,
                             const SeenTruthOptions& options) {
  if (sequence.groundtruth().empty())
    return Error{ErrorCode::kNotFound, source + " has no true poses: there is no true surface"};
  Gathering gathering;
  auto room = synthetic_room_of(source);
  if (!room.ok()) return room.error();
  gathering.room = *room;
  for (std::int64_t i = 0; i < sequence.frame_count(); i += options.frame_stride) {
    const auto pose = dataset::pose_at(sequence.groundtruth(), sequence.timestamp_s(i),
                                       dataset::kMaxAssociationGap_s);
    const Result<dataset::RecordedFrame> frame = sequence.read(i);
    if (pose && frame.ok()) add_frame(frame->depth, sequence.camera(), *pose, gathering);
  }
  SeenTruth truth;
  if (gathering.room) {
    truth.distance_m = [room = gathering.room](const Vector3d& point) {
      return std::min(room->surface_distance(point), kSurfaceReach_m);
    };
  } else {
    const auto grid = std::make_shared<const TriangleSurface>(gathering.triangles, kSurfaceReach_m);
    truth.distance_m = [grid](const Vector3d& point) { return grid->distance_m(point); };
  }
  truth.samples = gathering.samples;
  truth.creases = creases_of(gathering);
  add_views(sequence, gathering, options.view_count, truth);
  return truth;
}

}  // namespace hermite::evaluate
