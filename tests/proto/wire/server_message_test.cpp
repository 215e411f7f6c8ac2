#include "proto/wire/server_message.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::wire {
namespace {

using testing::HasSubstr;

template <class Body>
Body round_trip(Body body) {
  const Result<ServerMessage> message = parse_server_message(format_server_message(std::move(body)));
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
  const FrameResult back = round_trip(result);
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

TEST(ServerMessage, TheOtherBodiesComeBackAsTheyWere) {
  EXPECT_EQ(round_trip(Credit{77}).frames_granted, 77u);
  const Chunk chunk = round_trip(Chunk{{1, 2, -3, 4, -32768}, 5, 6, std::string("\0draco", 6)});
  EXPECT_EQ(chunk.key, (ChunkKey{1, 2, -3, 4, -32768}));
  EXPECT_EQ(chunk.version, 5u);
  EXPECT_EQ(chunk.point_count, 6u);
  EXPECT_EQ(chunk.draco, std::string("\0draco", 6));
  const SubmapPoses poses = round_trip(SubmapPoses{{{0, Rigid3{}}, {1, some_pose()}}});
  ASSERT_EQ(poses.poses.size(), 2u);
  EXPECT_EQ(poses.poses[1].submap, 1u);
  EXPECT_EQ(poses.poses[1].world_from_submap.translation, some_pose().translation);
  const ScanState state = round_trip(ScanState{ScanPhase::kInterrupted, "why", 3, 2, 1});
  EXPECT_EQ(state.phase, ScanPhase::kInterrupted);
  EXPECT_EQ(state.words, "why");
  EXPECT_EQ(state.frames_received, 3u);
  EXPECT_EQ(state.frames_processed, 2u);
  EXPECT_EQ(state.frames_dropped, 1u);
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
  EXPECT_EQ(round_trip(TrajectoryPart{{1, 2, 3, 4, 5, 6}}).positions_m, (std::vector<float>{1, 2, 3, 4, 5, 6}));
}

TEST(ServerMessage, PosesThatAreNoneAreNamed) {
  FrameResult result;
  result.world_from_camera.translation.x() = std::nan("");
  EXPECT_THAT(parse_server_message(format_server_message(result)).error().message, HasSubstr("frame_result.world_from_camera"));
  SubmapPoses poses{{{0, Rigid3{}}}};
  poses.poses[0].world_from_submap.rotation.coeffs() *= 2;
  EXPECT_THAT(parse_server_message(format_server_message(poses)).error().message, HasSubstr("quaternion of length 2"));
}

TEST(ServerMessage, ATrajectoryOfHalfAPositionIsCorrupt) {
  const auto message = parse_server_message(format_server_message(TrajectoryPart{{1, 2, 3, 4}}));
  ASSERT_FALSE(message.ok());
  EXPECT_EQ(message.error().code, ErrorCode::kCorruptData);
}

TEST(ServerMessage, GarbageOversizeAndTheFuture) {
  EXPECT_EQ(parse_server_message(std::string(50, '\xff')).error().code, ErrorCode::kCorruptData);
  EXPECT_EQ(parse_server_message(std::string(50, 'x'), 49).error().code, ErrorCode::kTooLarge);
  EXPECT_TRUE(std::holds_alternative<Unknown>(*parse_server_message(std::string("\xd2\x05\x01x", 4))));
}

}  // namespace
}  // namespace hermite::wire
