#include "proto/wire/server_message.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "proto/wire/fields.h"
#include "proto/wire/without_paths.h"

namespace hermite::wire {

namespace {

Result<ServerMessage> welcome_from(const v1::Welcome& message) {
  Welcome welcome;
  welcome.protocol_minor = message.protocol_minor();
  welcome.server = message.server();
  welcome.scan_id = message.scan_id();
  welcome.max_message_bytes = message.max_message_bytes();
  welcome.frame_credit = message.frame_credit();
  const auto depth_codec = depth_codec_from(message.depth_codec());
  if (!depth_codec)
    return Error{ErrorCode::kUnsupported, fmt::format("welcome.depth_codec is {}, known are 1 to 3",
                                                      static_cast<int>(message.depth_codec()))};
  welcome.depth_codec = *depth_codec;
  for (const int number : message.color_codecs())
    if (const auto codec = color_codec_from(number)) welcome.color_codecs.push_back(*codec);
  welcome.camera = camera_from(message.camera());
  if (Status status = validate(welcome.camera); !status.ok())
    return in_context("welcome", status.error());
  welcome.title = message.title();
  if (Status status = check_text("welcome.resume_token", message.resume_token(), kMaxTokenBytes);
      !status.ok())
    return status.error();
  welcome.resume_token = message.resume_token();
  welcome.resume_window_s = message.resume_window_s();
  welcome.frame_patience_s = message.frame_patience_s();
  return ServerMessage(std::move(welcome));
}

TrackingStatus status_from(v1::TrackingStatus status) {
  if (status == v1::TRACKING_STATUS_TRACKED) return TrackingStatus::kTracked;
  return status == v1::TRACKING_STATUS_WEAK ? TrackingStatus::kWeak : TrackingStatus::kLost;
}

v1::TrackingStatus status_of(TrackingStatus status) {
  if (status == TrackingStatus::kTracked) return v1::TRACKING_STATUS_TRACKED;
  return status == TrackingStatus::kWeak ? v1::TRACKING_STATUS_WEAK : v1::TRACKING_STATUS_LOST;
}

// As in messages.h; scan.proto gives them the same numbers.
MapEvent event_from(v1::MapEvent event) {
  const bool known = event >= v1::MAP_EVENT_NONE && event <= v1::MAP_EVENT_RECALIBRATED;
  return known ? static_cast<MapEvent>(event) : MapEvent::kNone;
}

// What came with minor 1.
Status read_map_fields(const v1::FrameResult& message, FrameResult& result) {
  if (message.has_submap_from_camera()) {
    Result<Rigid3> pose =
        rigid3_from("frame_result.submap_from_camera", message.submap_from_camera());
    if (!pose.ok()) return pose.error();
    result.in_submap = PoseInSubmap{message.submap(), *pose};
  }
  result.event = event_from(message.event());
  result.correction_m = message.correction_m();
  if (!std::isfinite(result.correction_m) || result.correction_m < 0)
    return Error{
        ErrorCode::kInvalidArgument,
        fmt::format("frame_result.correction_m is {:f}, not a distance", result.correction_m)};
  if (message.has_last_tracked())
    result.last_tracked =
        TrackedFrame{message.last_tracked().sequence(), message.last_tracked().timestamp_s()};
  return Done{};
}

Status read_uncertainty(const v1::FrameResult& message, FrameResult& result) {
  if (!message.has_uncertainty()) return Done{};
  const PoseUncertainty stated{message.uncertainty().position_sigma_m(),
                               message.uncertainty().rotation_sigma_rad()};
  for (const auto& [name, sigma] : {std::pair{"position_sigma_m", stated.position_sigma_m},
                                    {"rotation_sigma_rad", stated.rotation_sigma_rad}})
    if (!std::isfinite(sigma) || sigma < 0)
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("frame_result.uncertainty.{} is {:f}, not a standard deviation",
                               name, sigma)};
  result.uncertainty = stated;
  return Done{};
}

Result<ServerMessage> frame_result_from(v1::FrameResult& message) {
  FrameResult result;
  result.sequence = message.sequence();
  result.timestamp_s = message.timestamp_s();
  Result<Rigid3> pose = rigid3_from("frame_result.world_from_camera", message.world_from_camera());
  if (!pose.ok()) return pose.error();
  result.world_from_camera = *pose;
  result.status = status_from(message.status());
  result.reason = std::move(*message.mutable_reason());
  result.inlier_count = message.inlier_count();
  result.inlier_ratio = message.inlier_ratio();
  result.residual_rms_m = message.residual_rms_m();
  result.surfel_count = message.surfel_count();
  result.frame_ms = message.frame_ms();
  if (Status status = read_map_fields(message, result); !status.ok()) return status.error();
  if (Status status = read_uncertainty(message, result); !status.ok()) return status.error();
  return ServerMessage(std::move(result));
}

ServerMessage chunk_from(v1::Chunk& message) {
  const v1::ChunkKey& key = message.key();
  return Chunk{{key.submap(), key.level(), key.x(), key.y(), key.z()},
               message.version(),
               message.point_count(),
               std::move(*message.mutable_draco())};
}

ServerMessage mesh_chunk_from(v1::MeshChunk& message) {
  const v1::MeshCube& cube = message.cube();
  return MeshChunk{{cube.part(), cube.x(), cube.y(), cube.z()},
                   message.version(),
                   message.submap(),
                   message.triangle_count(),
                   std::move(*message.mutable_draco())};
}

Result<ServerMessage> submap_poses_from(const v1::SubmapPoses& message) {
  if (message.poses_size() > static_cast<int>(kMaxSubmaps))
    return Error{ErrorCode::kTooLarge, fmt::format("submap_poses has {} poses, allowed are {}",
                                                   message.poses_size(), kMaxSubmaps)};
  SubmapPoses poses;
  for (const v1::SubmapPose& pose : message.poses()) {
    Result<Rigid3> transform =
        rigid3_from("submap_poses.world_from_submap", pose.world_from_submap());
    if (!transform.ok()) return transform.error();
    poses.poses.push_back({pose.submap(), *transform, pose.part()});
  }
  return ServerMessage(std::move(poses));
}

Result<ServerMessage> scan_state_from(v1::ScanState& message) {
  if (message.phase() < v1::SCAN_PHASE_RUNNING || message.phase() > v1::SCAN_PHASE_INTERRUPTED)
    return Error{ErrorCode::kUnsupported, fmt::format("scan_state.phase is {}, known are 1 to 4",
                                                      static_cast<int>(message.phase()))};
  std::optional<UpDirection> up;
  if (message.has_up()) {
    up = UpDirection{vector3_from(message.up().in_world()), message.up().sigma_rad()};
    if (!(std::abs(up->in_world.norm() - 1) <= 1e-3) || !(up->sigma_rad >= 0))
      return Error{ErrorCode::kInvalidArgument,
                   "scan_state.up is no direction of unit length with its standard deviation"};
  }
  return ServerMessage(
      ScanState{static_cast<ScanPhase>(message.phase()), std::move(*message.mutable_words()),
                message.frames_received(), message.frames_processed(), message.frames_dropped(),
                message.keyframes(), message.loops(), message.paused(), message.can_pause(), up});
}

Result<ServerMessage> trajectory_from(const v1::TrajectoryPart& message) {
  if (message.positions_size() % 3 != 0)
    return Error{ErrorCode::kCorruptData,
                 fmt::format("trajectory_part.positions has {} numbers, which is no multiple of 3",
                             message.positions_size())};
  if (message.submaps_size() > 0 && 3 * message.submaps_size() != message.positions_size())
    return Error{ErrorCode::kCorruptData,
                 fmt::format("trajectory_part.submaps has {} entries for {} positions",
                             message.submaps_size(), message.positions_size() / 3)};
  if (message.positions_in_submaps_size() != 3 * message.submaps_size())
    return Error{ErrorCode::kCorruptData,
                 fmt::format("trajectory_part.positions_in_submaps has {} numbers for {} submaps, "
                             "which is not 3 for each",
                             message.positions_in_submaps_size(), message.submaps_size())};
  return ServerMessage(
      TrajectoryPart{{message.positions().begin(), message.positions().end()},
                     {message.positions_in_submaps().begin(), message.positions_in_submaps().end()},
                     {message.submaps().begin(), message.submaps().end()}});
}

// One overload a body: a new one does not compile until it is written here.
struct Writer {
  v1::ServerMessage& message;

  void operator()(Unknown&) const {}
  void operator()(Welcome& welcome) const {
    v1::Welcome& out = *message.mutable_welcome();
    out.set_protocol_minor(welcome.protocol_minor);
    out.set_server(std::move(welcome.server));
    out.set_scan_id(std::move(welcome.scan_id));
    out.set_max_message_bytes(welcome.max_message_bytes);
    out.set_frame_credit(welcome.frame_credit);
    out.set_depth_codec(static_cast<v1::DepthCodec>(welcome.depth_codec));
    for (const ColorCodec codec : welcome.color_codecs)
      out.add_color_codecs(static_cast<v1::ColorCodec>(codec));
    write_camera(welcome.camera, *out.mutable_camera());
    out.set_title(std::move(welcome.title));
    out.set_resume_token(std::move(welcome.resume_token));
    out.set_resume_window_s(welcome.resume_window_s);
    out.set_frame_patience_s(welcome.frame_patience_s);
  }
  void operator()(FrameResult& result) const {
    v1::FrameResult& out = *message.mutable_frame_result();
    out.set_sequence(result.sequence);
    out.set_timestamp_s(result.timestamp_s);
    write_rigid3(result.world_from_camera, *out.mutable_world_from_camera());
    out.set_status(status_of(result.status));
    out.set_reason(std::move(result.reason));
    out.set_inlier_count(result.inlier_count);
    out.set_inlier_ratio(result.inlier_ratio);
    out.set_residual_rms_m(result.residual_rms_m);
    out.set_surfel_count(result.surfel_count);
    out.set_frame_ms(result.frame_ms);
    if (result.in_submap) {
      out.set_submap(result.in_submap->submap);
      write_rigid3(result.in_submap->submap_from_camera, *out.mutable_submap_from_camera());
    }
    out.set_event(static_cast<v1::MapEvent>(result.event));
    out.set_correction_m(result.correction_m);
    if (result.uncertainty) {
      out.mutable_uncertainty()->set_position_sigma_m(result.uncertainty->position_sigma_m);
      out.mutable_uncertainty()->set_rotation_sigma_rad(result.uncertainty->rotation_sigma_rad);
    }
    if (!result.last_tracked) return;
    out.mutable_last_tracked()->set_sequence(result.last_tracked->sequence);
    out.mutable_last_tracked()->set_timestamp_s(result.last_tracked->timestamp_s);
  }
  void operator()(Credit& credit) const {
    message.mutable_credit()->set_frames_granted(credit.frames_granted);
    message.mutable_credit()->set_durable_frames(credit.durable_frames);
  }
  void operator()(Resumed& resumed) const {
    v1::Resumed& out = *message.mutable_resumed();
    out.set_next_sequence(resumed.next_sequence);
    out.set_frames_granted(resumed.frames_granted);
    out.set_durable_frames(resumed.durable_frames);
  }
  void operator()(NotResumed& refused) const {
    message.mutable_not_resumed()->set_reason(without_paths(refused.reason));
  }
  void operator()(GoAway& away) const {
    message.mutable_go_away()->set_resume_after_ms(away.resume_after_ms);
  }
  void operator()(Waiting& waiting) const {
    message.mutable_waiting()->set_before(waiting.before);
    message.mutable_waiting()->set_expected_s(waiting.expected_s);
  }
  void operator()(PauseRequest& request) const {
    message.mutable_pause_request()->set_paused(request.paused);
  }
  void operator()(Chunk& chunk) const {
    v1::Chunk& out = *message.mutable_chunk();
    out.mutable_key()->set_submap(chunk.key.submap);
    out.mutable_key()->set_level(chunk.key.level);
    out.mutable_key()->set_x(chunk.key.x);
    out.mutable_key()->set_y(chunk.key.y);
    out.mutable_key()->set_z(chunk.key.z);
    out.set_version(chunk.version);
    out.set_point_count(chunk.point_count);
    out.set_draco(std::move(chunk.draco));
  }
  void operator()(MeshChunk& chunk) const {
    v1::MeshChunk& out = *message.mutable_mesh_chunk();
    out.mutable_cube()->set_part(chunk.cube.part);
    out.mutable_cube()->set_x(chunk.cube.x);
    out.mutable_cube()->set_y(chunk.cube.y);
    out.mutable_cube()->set_z(chunk.cube.z);
    out.set_version(chunk.version);
    out.set_submap(chunk.submap);
    out.set_triangle_count(chunk.triangle_count);
    out.set_draco(std::move(chunk.draco));
  }
  void operator()(SubmapPoses& poses) const {
    v1::SubmapPoses& out = *message.mutable_submap_poses();
    for (const SubmapPose& pose : poses.poses) {
      v1::SubmapPose& entry = *out.add_poses();
      entry.set_submap(pose.submap);
      write_rigid3(pose.world_from_submap, *entry.mutable_world_from_submap());
      entry.set_part(pose.part);
    }
  }
  void operator()(ScanState& state) const {
    v1::ScanState& out = *message.mutable_scan_state();
    out.set_phase(static_cast<v1::ScanPhase>(state.phase));
    out.set_words(without_paths(state.message));
    out.set_frames_received(state.frames_received);
    out.set_frames_processed(state.frames_processed);
    out.set_frames_dropped(state.frames_dropped);
    out.set_keyframes(state.keyframes);
    out.set_loops(state.loops);
    out.set_paused(state.paused);
    out.set_can_pause(state.can_pause);
    if (state.up) {
      write_vector3(state.up->in_world, *out.mutable_up()->mutable_in_world());
      out.mutable_up()->set_sigma_rad(state.up->sigma_rad);
    }
  }
  void operator()(Finished& finished) const {
    message.mutable_finished()->set_report_json(std::move(finished.report_json));
    message.mutable_finished()->set_trajectory_tum(std::move(finished.trajectory_tum));
  }
  void operator()(ErrorMessage& error) const {
    v1::Error& out = *message.mutable_error();
    out.set_code(std::move(error.code));
    out.set_message(without_paths(error.message));
    out.set_sequence(error.sequence);
    out.set_about_frame(error.about_frame);
  }
  void operator()(Pong& pong) const { message.mutable_pong()->set_id(pong.id); }
  void operator()(SnapshotEnd&) const { message.mutable_snapshot_end(); }
  void operator()(TrajectoryPart& part) const {
    v1::TrajectoryPart& out = *message.mutable_trajectory_part();
    out.mutable_positions()->Add(part.positions_m.begin(), part.positions_m.end());
    out.mutable_positions_in_submaps()->Add(part.positions_in_submaps_m.begin(),
                                            part.positions_in_submaps_m.end());
    out.mutable_submaps()->Add(part.submaps.begin(), part.submaps.end());
  }
};

}  // namespace

Result<ServerMessage> parse_server_message(std::string_view bytes, std::size_t max_bytes) {
  v1::ServerMessage message;
  if (Status status = parse_bytes(bytes, max_bytes, message); !status.ok()) return status.error();
  switch (message.body_case()) {
    case v1::ServerMessage::kWelcome: return welcome_from(message.welcome());
    case v1::ServerMessage::kFrameResult: return frame_result_from(*message.mutable_frame_result());
    case v1::ServerMessage::kCredit:
      return ServerMessage(
          Credit{message.credit().frames_granted(), message.credit().durable_frames()});
    case v1::ServerMessage::kChunk: return chunk_from(*message.mutable_chunk());
    case v1::ServerMessage::kSubmapPoses: return submap_poses_from(message.submap_poses());
    case v1::ServerMessage::kScanState: return scan_state_from(*message.mutable_scan_state());
    case v1::ServerMessage::kFinished:
      return ServerMessage(
          Finished{std::move(*message.mutable_finished()->mutable_report_json()),
                   std::move(*message.mutable_finished()->mutable_trajectory_tum())});
    case v1::ServerMessage::kError:
      return ServerMessage(ErrorMessage{message.error().code(), message.error().message(),
                                        message.error().about_frame(), message.error().sequence()});
    case v1::ServerMessage::kPong: return ServerMessage(Pong{message.pong().id()});
    case v1::ServerMessage::kSnapshotEnd: return ServerMessage(SnapshotEnd{});
    case v1::ServerMessage::kResumed:
      return ServerMessage(Resumed{message.resumed().next_sequence(),
                                   message.resumed().frames_granted(),
                                   message.resumed().durable_frames()});
    case v1::ServerMessage::kNotResumed:
      return ServerMessage(NotResumed{std::move(*message.mutable_not_resumed()->mutable_reason())});
    case v1::ServerMessage::kGoAway:
      return ServerMessage(GoAway{message.go_away().resume_after_ms()});
    case v1::ServerMessage::kWaiting:
      return ServerMessage(Waiting{message.waiting().before(), message.waiting().expected_s()});
    case v1::ServerMessage::kPauseRequest:
      return ServerMessage(PauseRequest{message.pause_request().paused()});
    case v1::ServerMessage::kMeshChunk: return mesh_chunk_from(*message.mutable_mesh_chunk());
    case v1::ServerMessage::kTrajectoryPart: return trajectory_from(message.trajectory_part());
    case v1::ServerMessage::BODY_NOT_SET: break;
  }
  return ServerMessage(Unknown{});
}

std::string format_server_message(ServerMessage message) {
  v1::ServerMessage out;
  std::visit(Writer{out}, message);
  return out.SerializeAsString();
}

}  // namespace hermite::wire
