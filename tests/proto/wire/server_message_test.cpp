#include "proto/wire/server_message.h"

#include <cmath>
#include <limits>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::wire {
namespace {

using testing::HasSubstr;

template <class Body>
Body round_trip(Body body) {
  const Result<ServerMessage> message =
      parse_server_message(format_server_message(std::move(body)));
  if (!message.ok()) {
    ADD_FAILURE() << message.error().message;
    return {};
  }
  return std::get<Body>(*message);
}

Rigid3 some_pose() {
  Vector6d twist;
  twist << 0.1, -2, 3, 0.4, 0.5, -0.6;
  return exp_se3(twist);
}

TEST(ServerMessage, WelcomeComesBackAsItWas) {
  Welcome welcome;
  welcome.protocol_minor = 3;
  welcome.server = "hermite 0.1";
  welcome.scan_id = "abc";
  welcome.max_message_bytes = 1234567;
  welcome.frame_credit = 16;
  welcome.depth_codec = DepthCodec::kPng16;
  welcome.color_codecs = {ColorCodec::kPng, ColorCodec::kJpeg};
  welcome.camera = {640, 480, 525, 525, 319.5, 239.5, 5000};
  welcome.title = "a title";
  welcome.resume_token = "0123456789abcdef0123456789abcdef";
  welcome.resume_window_s = 120;
  const Welcome back = round_trip(welcome);
  EXPECT_EQ(back.protocol_minor, 3u);
  EXPECT_EQ(back.server, welcome.server);
  EXPECT_EQ(back.scan_id, welcome.scan_id);
  EXPECT_EQ(back.max_message_bytes, welcome.max_message_bytes);
  EXPECT_EQ(back.frame_credit, 16u);
  EXPECT_EQ(back.depth_codec, DepthCodec::kPng16);
  EXPECT_EQ(back.color_codecs, welcome.color_codecs);
  EXPECT_EQ(back.camera, welcome.camera);
  EXPECT_EQ(back.title, welcome.title);
  EXPECT_EQ(back.resume_token, welcome.resume_token);
  EXPECT_EQ(back.resume_window_s, 120u);
}

TEST(ServerMessage, WhatIsSaidAboutALostConnectionComesBackAsItWas) {
  const Credit credit = round_trip(Credit{20, 4});
  EXPECT_EQ(credit.frames_granted, 20u);
  EXPECT_EQ(credit.durable_frames, 4u);
  const Resumed resumed = round_trip(Resumed{7, 20, 4});
  EXPECT_EQ(resumed.next_sequence, 7u);
  EXPECT_EQ(resumed.frames_granted, 20u);
  EXPECT_EQ(resumed.durable_frames, 4u);
  EXPECT_EQ(round_trip(NotResumed{"why not"}).reason, "why not");
  EXPECT_EQ(round_trip(GoAway{1500}).resume_after_ms, 1500u);
  ScanState state;
  state.paused = true;
  EXPECT_TRUE(round_trip(state).paused);
  EXPECT_FALSE(round_trip(state).can_pause);
  state.can_pause = true;
  EXPECT_TRUE(round_trip(state).can_pause);
  EXPECT_TRUE(round_trip(PauseRequest{true}).paused);
  EXPECT_FALSE(round_trip(PauseRequest{false}).paused);
}

TEST(ServerMessage, HowLongACameraWaitsComesBackAsItWas) {
  const Waiting waiting = round_trip(Waiting{2, 40});
  EXPECT_EQ(waiting.before, 2u);
  EXPECT_EQ(waiting.expected_s, 40u);
}

TEST(ServerMessage, AWelcomeChoosesADepthCodecThatThisVersionKnows) {
  Welcome welcome;
  welcome.camera = {640, 480, 525, 525, 319.5, 239.5, 5000};
  for (const DepthCodec codec : kDepthCodecs) {
    welcome.depth_codec = codec;
    EXPECT_EQ(round_trip(welcome).depth_codec, codec);
  }
  welcome.depth_codec = static_cast<DepthCodec>(4);
  const auto message = parse_server_message(format_server_message(welcome));
  ASSERT_FALSE(message.ok());
  EXPECT_EQ(message.error().message, "welcome.depth_codec is 4, known are 1 to 3");
}

TEST(ServerMessage, AnUncertaintyIsADeviationOrRefused) {
  EXPECT_FALSE(round_trip(FrameResult{}).uncertainty);
  for (const double wrong :
       {-0.1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    FrameResult result;
    result.uncertainty = PoseUncertainty{wrong, 0.1};
    const auto position = parse_server_message(format_server_message(result));
    ASSERT_FALSE(position.ok());
    EXPECT_THAT(position.error().message,
                testing::StartsWith("frame_result.uncertainty.position_sigma_m is "));
    result.uncertainty = PoseUncertainty{0.1, wrong};
    const auto rotation = parse_server_message(format_server_message(result));
    ASSERT_FALSE(rotation.ok());
    EXPECT_THAT(rotation.error().message,
                testing::StartsWith("frame_result.uncertainty.rotation_sigma_rad is "));
  }
}

TEST(ServerMessage, AFrameResultKeepsItsPoseBitForBit) {
  FrameResult result;
  result.sequence = 41;
  result.timestamp_s = 1.25;
  result.world_from_camera = some_pose();
  result.status = TrackingStatus::kWeak;
  result.inlier_count = 12345;
  result.inlier_ratio = 0.75;
  result.residual_rms_m = 0.004;
  result.surfel_count = 99;
  result.frame_ms = 31.5;
  result.uncertainty = PoseUncertainty{0.0125, 0.003};
  const FrameResult back = round_trip(result);
  ASSERT_TRUE(back.uncertainty);
  EXPECT_EQ(back.uncertainty->position_sigma_m, 0.0125);
  EXPECT_EQ(back.uncertainty->rotation_sigma_rad, 0.003);
  EXPECT_EQ(back.sequence, 41u);
  EXPECT_EQ(back.timestamp_s, 1.25);
  EXPECT_EQ(back.world_from_camera.rotation.coeffs(), result.world_from_camera.rotation.coeffs());
  EXPECT_EQ(back.world_from_camera.translation, result.world_from_camera.translation);
  EXPECT_EQ(back.status, TrackingStatus::kWeak);
  EXPECT_EQ(back.inlier_count, 12345u);
  EXPECT_EQ(back.inlier_ratio, 0.75);
  EXPECT_EQ(back.residual_rms_m, 0.004);
  EXPECT_EQ(back.surfel_count, 99u);
  EXPECT_EQ(back.frame_ms, 31.5);
  for (const TrackingStatus status : {TrackingStatus::kTracked, TrackingStatus::kLost}) {
    result.status = status;
    EXPECT_EQ(round_trip(result).status, status);
  }
  result.reason = "too fast";
  EXPECT_EQ(round_trip(result).reason, "too fast");
}

TEST(ServerMessage, AFrameResultSaysWhereInTheMapAndWhatHappened) {
  FrameResult result;
  result.in_submap = PoseInSubmap{7, some_pose()};
  result.correction_m = 0.03;
  result.last_tracked = TrackedFrame{12, 0.5};
  const FrameResult back = round_trip(result);
  ASSERT_TRUE(back.in_submap);
  EXPECT_EQ(back.in_submap->submap, 7u);
  EXPECT_EQ(back.in_submap->submap_from_camera.translation, some_pose().translation);
  EXPECT_EQ(back.in_submap->submap_from_camera.rotation.coeffs(), some_pose().rotation.coeffs());
  EXPECT_EQ(back.correction_m, 0.03);
  ASSERT_TRUE(back.last_tracked);
  EXPECT_EQ(back.last_tracked->sequence, 12u);
  EXPECT_EQ(back.last_tracked->timestamp_s, 0.5);
  for (const MapEvent event :
       {MapEvent::kNone, MapEvent::kLost, MapEvent::kFoundAgain, MapEvent::kNewPart,
        MapEvent::kJoined, MapEvent::kLoopClosed, MapEvent::kRecalibrated}) {
    result.event = event;
    EXPECT_EQ(round_trip(result).event, event);
  }
}

// A frame result as a server of minor 0 writes it: sequence 3, the identity, tracked. And with an
// event that only a newer one knows.
TEST(ServerMessage, OlderAndNewerServersAreUnderstood) {
  const std::string pose("\x1a\x09\x39\0\0\0\0\0\0\xf0\x3f", 11);
  const std::string old_body = std::string("\x08\x03", 2) + pose + std::string("\x20\x01", 2);
  const auto message = [](const std::string& body) {
    return std::string("\x12", 1) + static_cast<char>(body.size()) + body;
  };
  const auto old = parse_server_message(message(old_body));
  ASSERT_TRUE(old.ok()) << old.error().message;
  const FrameResult& result = std::get<FrameResult>(*old);
  EXPECT_EQ(result.sequence, 3u);
  EXPECT_EQ(result.status, TrackingStatus::kTracked);
  EXPECT_FALSE(result.in_submap);
  EXPECT_FALSE(result.last_tracked);
  EXPECT_EQ(result.event, MapEvent::kNone);
  // Event 99.
  const auto newer = parse_server_message(message(old_body + std::string("\x68\x63", 2)));
  ASSERT_TRUE(newer.ok()) << newer.error().message;
  EXPECT_EQ(std::get<FrameResult>(*newer).event, MapEvent::kNone);
}

TEST(ServerMessage, TheOtherBodiesComeBackAsTheyWere) {
  EXPECT_EQ(round_trip(Credit{77}).frames_granted, 77u);
  const Chunk chunk = round_trip(Chunk{{1, 2, -3, 4, -32768}, 5, 6, std::string("\0draco", 6)});
  EXPECT_EQ(chunk.key, (ChunkKey{1, 2, -3, 4, -32768}));
  const MeshChunk piece = round_trip(MeshChunk{{1, 2, -3, 4}, 5, 6, 7, std::string("\0draco", 6)});
  EXPECT_EQ(piece.cube, (MeshCube{1, 2, -3, 4}));
  EXPECT_EQ(std::tuple(piece.version, piece.submap, piece.triangle_count), std::tuple(5u, 6u, 7u));
  EXPECT_EQ(piece.draco, std::string("\0draco", 6));
  EXPECT_EQ(chunk.version, 5u);
  EXPECT_EQ(chunk.point_count, 6u);
  EXPECT_EQ(chunk.draco, std::string("\0draco", 6));
  const SubmapPoses poses = round_trip(SubmapPoses{{{0, Rigid3{}, 0}, {1, some_pose(), 2}}});
  ASSERT_EQ(poses.poses.size(), 2u);
  EXPECT_EQ(poses.poses[1].submap, 1u);
  EXPECT_EQ(poses.poses[1].part, 2u);
  EXPECT_EQ(poses.poses[1].world_from_submap.translation, some_pose().translation);
  const ScanState state = round_trip(ScanState{ScanPhase::kInterrupted, "why", 3, 2, 1, 20, 4});
  EXPECT_EQ(state.phase, ScanPhase::kInterrupted);
  EXPECT_EQ(state.message, "why");
  EXPECT_EQ(state.frames_received, 3u);
  EXPECT_EQ(state.frames_processed, 2u);
  EXPECT_EQ(state.frames_dropped, 1u);
  EXPECT_EQ(state.keyframes, 20u);
  EXPECT_EQ(state.loops, 4u);
  const Finished finished = round_trip(Finished{"{}", "1 2 3\n"});
  EXPECT_EQ(finished.report_json, "{}");
  EXPECT_EQ(finished.trajectory_tum, "1 2 3\n");
  const ErrorMessage error = round_trip(ErrorMessage{"corrupt_data", "words", true, 12});
  EXPECT_EQ(error.code, "corrupt_data");
  EXPECT_EQ(error.message, "words");
  EXPECT_TRUE(error.about_frame);
  EXPECT_EQ(error.sequence, 12u);
  EXPECT_EQ(round_trip(Pong{5}).id, 5u);
  round_trip(SnapshotEnd{});
  const TrajectoryPart part =
      round_trip(TrajectoryPart{{1, 2, 3, 4, 5, 6}, {0, 2, 3, 3, 5, 6}, {0, 9}});
  EXPECT_EQ(part.positions_m, (std::vector<float>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(part.positions_in_submaps_m, (std::vector<float>{0, 2, 3, 3, 5, 6}));
  EXPECT_EQ(part.submaps, (std::vector<std::uint32_t>{0, 9}));
}

TEST(ServerMessage, UpComesBackOrIsNamed) {
  ScanState state;
  EXPECT_FALSE(round_trip(state).up.has_value());
  state.up = UpDirection{{0, -0.8, -0.6}, 0.02};
  EXPECT_EQ(round_trip(state).up->in_world, state.up->in_world);
  EXPECT_EQ(round_trip(state).up->sigma_rad, 0.02);
  for (const UpDirection& wrong :
       {UpDirection{{0, -0.8, -0.7}, 0.02}, UpDirection{{0, std::nan(""), 0}, 0.02},
        UpDirection{{0, -1, 0}, -1}, UpDirection{{0, -1, 0}, std::nan("")}}) {
    state.up = wrong;
    EXPECT_THAT(parse_server_message(format_server_message(state)).error().message,
                HasSubstr("scan_state.up"));
  }
}

TEST(ServerMessage, PosesThatAreNoneAreNamed) {
  FrameResult result;
  result.world_from_camera.translation.x() = std::nan("");
  EXPECT_THAT(parse_server_message(format_server_message(result)).error().message,
              HasSubstr("frame_result.world_from_camera"));
  result = {};
  result.in_submap = PoseInSubmap{};
  result.in_submap->submap_from_camera.translation.y() = std::nan("");
  EXPECT_THAT(parse_server_message(format_server_message(result)).error().message,
              HasSubstr("frame_result.submap_from_camera"));
  result = {};
  for (const double wrong_m : {std::nan(""), -1.0}) {
    result.correction_m = wrong_m;
    EXPECT_THAT(parse_server_message(format_server_message(result)).error().message,
                HasSubstr("frame_result.correction_m"));
  }
  SubmapPoses poses{{{0, Rigid3{}}}};
  poses.poses[0].world_from_submap.rotation.coeffs() *= 2;
  EXPECT_THAT(parse_server_message(format_server_message(poses)).error().message,
              HasSubstr("quaternion of length 2"));
}

TEST(ServerMessage, ATrajectoryOfHalfAPositionIsCorrupt) {
  for (const TrajectoryPart& part :
       {TrajectoryPart{{1, 2, 3, 4}, {}, {}}, TrajectoryPart{{1, 2, 3}, {1, 2, 3}, {0, 1}},
        TrajectoryPart{{1, 2, 3}, {1, 2}, {0}}, TrajectoryPart{{1, 2, 3}, {1, 2, 3}, {}}}) {
    const auto message = parse_server_message(format_server_message(part));
    ASSERT_FALSE(message.ok());
    EXPECT_EQ(message.error().code, ErrorCode::kCorruptData);
    EXPECT_THAT(message.error().message, HasSubstr("trajectory_part."));
  }
}

TEST(ServerMessage, GarbageOversizeAndTheFuture) {
  EXPECT_EQ(parse_server_message(std::string(50, '\xff')).error().code, ErrorCode::kCorruptData);
  EXPECT_EQ(parse_server_message(std::string(50, 'x'), 49).error().code, ErrorCode::kTooLarge);
  EXPECT_TRUE(
      std::holds_alternative<Unknown>(*parse_server_message(std::string("\xd2\x05\x01x", 4))));
}

}  // namespace
}  // namespace hermite::wire
