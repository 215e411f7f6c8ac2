// The messages of proto/scan.proto as plain values: what both ends work with, so that protobuf
// stays inside proto/wire.
//
// A value that came out of parse_client_message or parse_server_message keeps the limits below; a
// value that is to be sent should. The rules of order, credit and closing are in proto/README.md.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/base/result.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"
#include "core/math/up_direction.h"

namespace hermite::wire {

inline constexpr const char* kSubprotocol = "hermite.v1";
inline constexpr const char* kEndpoint = "/api/v1/ws";
inline constexpr std::uint32_t kProtocolMinor = 8;
// Both ends must have it for a scan to outlive its connection.
inline constexpr std::uint32_t kMinorWithResume = 2;
inline constexpr std::uint32_t kMinorWithWaiting = 3;       // a camera of it can wait for a place
inline constexpr std::uint32_t kMinorWithPauseRequest = 7;  // a camera of it can be asked to pause

// A Hello, and all that a viewer ever sends.
inline constexpr std::size_t kMaxBytesBeforeWelcome = 64 * 1024;
inline constexpr std::size_t kMaxServerMessageBytes = 64 * 1024 * 1024;
inline constexpr std::size_t kMaxTitleBytes = 200;
inline constexpr std::size_t kMaxClientNameBytes = 200;
inline constexpr std::size_t kMaxTokenBytes = 256;
inline constexpr std::size_t kMaxScanIdBytes = 64;
inline constexpr int kMaxSettings = 64;
inline constexpr std::size_t kMaxSettingBytes = 200;  // key, and value
inline constexpr int kMaxCodecs = 16;
inline constexpr std::uint32_t kMaxSubmaps = 65536;

enum class DepthCodec { kRvlZstd = 1, kPng16 = 2, kRanks = 3 };
// All there are.
inline constexpr std::array kDepthCodecs{DepthCodec::kRvlZstd, DepthCodec::kPng16,
                                         DepthCodec::kRanks};
enum class ColorCodec { kJpeg = 1, kPng = 2 };
enum class Mode { kBatch = 1, kLive = 2 };
enum class ScanPhase { kRunning = 1, kFinished = 2, kFailed = 3, kInterrupted = 4 };

// A body (or none) that this version does not know. To be ignored and counted.
struct Unknown {};

// ---- client to server

struct StartScan {
  std::string title;                     // UTF-8 without control characters
  Camera camera;                         // valid, see validate(Camera)
  std::vector<DepthCodec> depth_codecs;  // known ones only, best first, never empty
  std::vector<ColorCodec> color_codecs;  // known ones only, never empty
  Mode mode = Mode::kBatch;
  std::map<std::string, std::string> settings;
  std::uint64_t expected_frames = 0;   // 0: unknown
  std::uint32_t frame_patience_s = 0;  // 0: what the server grants
};
// What of the model a viewer wants to see while the scan runs.
struct Watch {
  bool points = true, mesh = false;
};
struct ViewScan {
  std::string scan_id;
  Watch watch = {};  // of a viewer before minor 6: points
};
struct ResumeScan {
  std::string scan_id;
  std::string resume_token;
  std::uint64_t next_sequence = 0;  // the first frame that the camera can still send
};
struct Hello {
  std::uint32_t protocol_minor = kProtocolMinor;
  std::string client;  // name and version, for the log
  std::string token;
  std::variant<StartScan, ViewScan, ResumeScan> role;
};
// `timestamp_s` is as sent, not finite maybe; the images are still encoded: decode_frame_payload.
struct Frame {
  std::uint64_t sequence = 0;
  double timestamp_s = 0;
  std::string depth;
  std::string color;
  std::optional<Eigen::Vector3d> acceleration_m_s2{};  // as in frame::RgbdFrame
};
struct Finish {};
struct Pause {};
struct Unpause {};
struct Discard {};
struct ViewerAck {
  std::uint64_t bytes = 0;
};
struct Ping {
  std::uint64_t id = 0;
};
using ClientMessage =
    std::variant<Unknown, Hello, Frame, Finish, ViewerAck, Ping, Pause, Unpause, Discard, Watch>;

// ---- server to client

struct Welcome {
  std::uint32_t protocol_minor = kProtocolMinor;
  std::string server;
  std::string scan_id;
  std::uint64_t max_message_bytes = 0;
  std::uint32_t frame_credit = 0;
  DepthCodec depth_codec = DepthCodec::kRvlZstd;
  std::vector<ColorCodec> color_codecs;
  Camera camera;
  std::string title;
  std::string resume_token;  // empty: the scan ends with the connection
  std::uint32_t resume_window_s = 0;
  std::uint32_t frame_patience_s = 0;
};
// Unknown ones of a newer server count as lost.
enum class TrackingStatus { kTracked, kWeak, kLost };
// Unknown ones count as none.
enum class MapEvent { kNone, kLost, kFoundAgain, kNewPart, kJoined, kLoopClosed, kRecalibrated };
struct TrackedFrame {
  std::uint64_t sequence = 0;
  double timestamp_s = 0;
};
struct PoseInSubmap {
  std::uint32_t submap = 0;
  Rigid3 submap_from_camera;
};
// Standard deviations along the axes of the greatest error, finite and not negative.
struct PoseUncertainty {
  double position_sigma_m = 0, rotation_sigma_rad = 0;
};
struct FrameResult {
  std::uint64_t sequence = 0;
  double timestamp_s = 0;
  Rigid3 world_from_camera;
  TrackingStatus status = TrackingStatus::kLost;
  std::string reason;  // for people, when not tracked or weakly
  std::uint64_t inlier_count = 0;
  double inlier_ratio = 0;
  double residual_rms_m = 0;
  std::uint64_t surfel_count = 0;
  double frame_ms = 0;
  // The same pose as it stays when submaps are corrected; a server of minor 0 does not say.
  std::optional<PoseInSubmap> in_submap;
  MapEvent event = MapEvent::kNone;
  // Finite; the farthest that a submap around the camera was moved in this frame.
  double correction_m = 0;
  // This frame, or while lost the one that the pose is of.
  std::optional<TrackedFrame> last_tracked;
  std::optional<PoseUncertainty> uncertainty;  // none while lost, and from a server before minor 4
};
struct Credit {
  std::uint64_t frames_granted = 0;  // in all, since the start
  std::uint64_t durable_frames = 0;  // the first so many survive the death of the server
};
struct Resumed {
  std::uint64_t next_sequence = 0;  // of the next frame that the server wants
  std::uint64_t frames_granted = 0;
  std::uint64_t durable_frames = 0;
};
struct NotResumed {
  std::string reason;
};
struct GoAway {
  std::uint32_t resume_after_ms = 0;
};
struct Waiting {
  std::uint32_t before = 0;      // cameras that come first
  std::uint32_t expected_s = 0;  // 0: nobody knows
};
struct PauseRequest {
  bool paused = false;
};
struct ChunkKey {
  std::uint32_t submap = 0;
  std::uint32_t level = 0;
  std::int32_t x = 0, y = 0, z = 0;
  bool operator==(const ChunkKey&) const = default;
};
struct Chunk {
  ChunkKey key;
  std::uint64_t version = 0;
  std::uint32_t point_count = 0;  // 0 removes the chunk
  std::string draco;
};
struct MeshCube {
  std::uint32_t part = 0;
  std::int32_t x = 0, y = 0, z = 0;
  bool operator==(const MeshCube&) const = default;
};
struct MeshChunk {
  MeshCube cube;
  std::uint64_t version = 0;
  std::uint32_t submap = 0;          // in whose frame it is
  std::uint32_t triangle_count = 0;  // 0 removes the piece
  std::string draco;
};
struct SubmapPose {
  std::uint32_t submap = 0;
  Rigid3 world_from_submap;
  std::uint32_t part = 0;  // submaps of different parts say nothing about each other's place
};
struct SubmapPoses {
  std::vector<SubmapPose> poses;
};
struct ScanState {
  ScanPhase phase = ScanPhase::kRunning;
  std::string message;
  std::uint64_t frames_received = 0;
  std::uint64_t frames_processed = 0;
  std::uint64_t frames_dropped = 0;
  std::uint64_t keyframes = 0;
  std::uint64_t loops = 0;
  bool paused = false;
  bool can_pause = false;
  std::optional<UpDirection> up{};
};
struct Finished {
  std::string report_json;
  std::string trajectory_tum;
};
struct ErrorMessage {
  std::string code;     // name_of(ErrorCode)
  std::string message;  // for people
  bool about_frame = false;
  std::uint64_t sequence = 0;  // when about_frame
};
struct Pong {
  std::uint64_t id = 0;
};
struct SnapshotEnd {};
struct TrajectoryPart {
  std::vector<float> positions_m;  // x y z, x y z, ... in the world as the map lies
  // Empty, or the same positions in the frames of their submaps, and the submap of each.
  std::vector<float> positions_in_submaps_m;
  std::vector<std::uint32_t> submaps;
};
using ServerMessage =
    std::variant<Unknown, Welcome, FrameResult, Credit, Chunk, SubmapPoses, ScanState, Finished,
                 ErrorMessage, Pong, SnapshotEnd, TrajectoryPart, Resumed, NotResumed, GoAway,
                 Waiting, MeshChunk, PauseRequest>;

}  // namespace hermite::wire
