#include "server/scan/pipeline_messages.h"

#include <fmt/core.h>

#include <algorithm>

namespace hermite::server {

namespace {

wire::TrackingStatus wire_status(track::TrackingStatus status) {
  if (status == track::TrackingStatus::kTracked) return wire::TrackingStatus::kTracked;
  return status == track::TrackingStatus::kWeak ? wire::TrackingStatus::kWeak
                                                : wire::TrackingStatus::kLost;
}

wire::MapEvent wire_event(pipeline::MapEvent event) {
  switch (event) {
    case pipeline::MapEvent::kNone: return wire::MapEvent::kNone;
    case pipeline::MapEvent::kLost: return wire::MapEvent::kLost;
    case pipeline::MapEvent::kFoundAgain: return wire::MapEvent::kFoundAgain;
    case pipeline::MapEvent::kNewPart: return wire::MapEvent::kNewPart;
    case pipeline::MapEvent::kJoined: return wire::MapEvent::kJoined;
    case pipeline::MapEvent::kLoopClosed: return wire::MapEvent::kLoopClosed;
    case pipeline::MapEvent::kRecalibrated: return wire::MapEvent::kRecalibrated;
  }
  return wire::MapEvent::kNone;
}

}  // namespace

wire::FrameResult wire_result(const pipeline::FrameResult& result, std::uint64_t sequence,
                              double frame_ms) {
  wire::FrameResult sent;
  sent.sequence = sequence;
  sent.timestamp_s = result.timestamp_s;
  sent.world_from_camera = result.world_from_camera;
  sent.status = wire_status(result.status);
  sent.reason = result.reason;
  sent.inlier_count = static_cast<std::uint64_t>(result.inlier_count);
  sent.inlier_ratio = result.inlier_ratio;
  sent.residual_rms_m = result.residual_rms_m;
  sent.surfel_count = static_cast<std::uint64_t>(result.surfel_count);
  sent.frame_ms = frame_ms;
  sent.in_submap = wire::PoseInSubmap{result.submap, result.submap_from_camera};
  sent.event = wire_event(result.event);
  sent.correction_m = result.correction_m;
  if (result.uncertainty)
    sent.uncertainty = wire::PoseUncertainty{result.uncertainty->position_sigma_m(),
                                             result.uncertainty->rotation_sigma_rad()};
  return sent;
}

wire::SubmapPoses wire_poses(const pipeline::Pipeline& pipeline) {
  wire::SubmapPoses poses;
  for (const pipeline::SubmapPose& pose : pipeline.submap_poses())
    poses.poses.push_back({pose.submap, pose.world_from_submap, pose.component});
  return poses;
}

bool same_poses(const wire::SubmapPoses& a, const wire::SubmapPoses& b) {
  const auto same = [](const wire::SubmapPose& x, const wire::SubmapPose& y) {
    return x.submap == y.submap && x.part == y.part &&
           x.world_from_submap.translation == y.world_from_submap.translation &&
           x.world_from_submap.rotation.coeffs() == y.world_from_submap.rotation.coeffs();
  };
  return std::equal(a.poses.begin(), a.poses.end(), b.poses.begin(), b.poses.end(), same);
}

std::vector<wire::PoseInSubmap> wire_past(const pipeline::Pipeline& pipeline) {
  std::vector<wire::PoseInSubmap> past;
  for (const pipeline::AnchoredPose& pose : pipeline.anchored_poses())
    past.push_back({pose.submap, pose.submap_from_camera});
  return past;
}

void measure(const pipeline::PipelineStatistics& statistics, ModelUpdate& update) {
  const adjust::MappingCounts counts = statistics.mapping.value_or(adjust::MappingCounts{});
  update.keyframes = static_cast<std::uint64_t>(counts.keyframes);
  update.loops = static_cast<std::uint64_t>(counts.loops());
  update.up = statistics.up;
  for (const auto& [purpose, bytes] : statistics.gpu_memory_bytes)
    update.gpu_memory_bytes += static_cast<std::uint64_t>(bytes);
  update.device_memory_bytes = static_cast<std::uint64_t>(statistics.device_memory_bytes);
}

std::string remark_about_map(const pipeline::PipelineStatistics& statistics) {
  std::string remark = statistics.calibration_doubt.empty() ? statistics.camera_correction
                                                            : statistics.calibration_doubt;
  if (!statistics.up_problem.empty())
    remark += (remark.empty() ? "" : "; ") + statistics.up_problem;
  const std::int64_t parts = statistics.mapping.value_or(adjust::MappingCounts{}).components;
  if (parts < 2) return remark;
  if (!remark.empty()) remark += "; ";
  return fmt::format(
      "{}the map is in {} parts that could not be joined: the camera never saw enough of two at "
      "once",
      remark, parts);
}

}  // namespace hermite::server
