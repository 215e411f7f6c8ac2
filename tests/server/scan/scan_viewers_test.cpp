// What viewers see of scans on a real server with a real pipeline, while they run and afterwards.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <tuple>
#include <vector>

#include "core/image/image_codec.h"
#include "proto/wire/frame_payload.h"
#include "tests/support/scans_fixture.h"

namespace hermite::server {
namespace scan_viewers_test {

using Json = nlohmann::json;
using test::kFrameCount;
using test::RawClient;
using test::room;
using test::room_frame;
using testing::HasSubstr;

class ScanViewersTest : public test::ScansFixture {};

// What a viewer gets until the connection ends, acknowledging all of it.
struct Watched {
  std::optional<wire::Welcome> welcome;
  std::map<std::tuple<std::uint32_t, std::uint32_t, int, int, int>, wire::Chunk> chunks;
  wire::TrajectoryPart past;
  std::optional<wire::FrameResult> last_result;
  std::optional<wire::SubmapPoses> poses;
  std::optional<wire::ScanState> last_state;
  std::vector<wire::ScanPhase> phases;
  bool snapshot_ended = false;
  int close_code = 0;
};

Watched watch(RawClient& client) {
  Watched watched;
  while (const auto message = client.read_message()) {
    if (const auto* welcome = std::get_if<wire::Welcome>(&*message)) watched.welcome = *welcome;
    if (const auto* chunk = std::get_if<wire::Chunk>(&*message)) {
      const wire::ChunkKey& key = chunk->key;
      wire::Chunk& known = watched.chunks[{key.submap, key.level, key.x, key.y, key.z}];
      EXPECT_GT(chunk->version, known.version);
      known = *chunk;
    }
    if (const auto* part = std::get_if<wire::TrajectoryPart>(&*message)) watched.past = *part;
    if (const auto* result = std::get_if<wire::FrameResult>(&*message))
      watched.last_result = *result;
    if (const auto* poses = std::get_if<wire::SubmapPoses>(&*message)) watched.poses = *poses;
    if (const auto* state = std::get_if<wire::ScanState>(&*message)) {
      watched.phases.push_back(state->phase);
      watched.last_state = *state;
    }
    if (std::holds_alternative<wire::SnapshotEnd>(*message)) watched.snapshot_ended = true;
    client.send_message(wire::ViewerAck{client.received_bytes()});
  }
  watched.close_code = client.close_code();
  return watched;
}

TEST_F(ScanViewersTest, AViewerOfARunningScanAndOneAfterARestartSeeTheSame) {
  Camera camera = start();
  RawClient viewer(server_->port());
  ASSERT_TRUE(viewer.upgrade());
  viewer.send_message(
      wire::Hello{0, "test", server_->token(), wire::ViewScan{camera.welcome.scan_id}});
  ASSERT_TRUE(viewer.read<wire::SnapshotEnd>()) << "of a scan without points yet";
  std::thread streaming([&] { EXPECT_TRUE(stream(camera)); });
  const Watched live = watch(viewer);
  streaming.join();
  EXPECT_EQ(live.close_code, 1000);
  ASSERT_FALSE(live.phases.empty());
  EXPECT_EQ(live.phases.back(), wire::ScanPhase::kFinished);
  EXPECT_GT(live.chunks.size(), 3u);
  ASSERT_TRUE(live.last_result);
  ASSERT_TRUE(live.last_result->in_submap);
  ASSERT_TRUE(live.last_result->last_tracked);
  EXPECT_EQ(live.last_result->last_tracked->sequence, static_cast<std::uint64_t>(kFrameCount - 1));
  ASSERT_TRUE(live.poses);
  EXPECT_GT(live.poses->poses.size(), live.last_result->in_submap->submap)
      << "the pose of every submap that a frame is in";
  EXPECT_GT(live.last_state->keyframes, 0u);

  RawClient after(server_->port());
  ASSERT_TRUE(after.upgrade());
  after.send_message(
      wire::Hello{0, "test", server_->token(), wire::ViewScan{camera.welcome.scan_id}});
  const Watched kept = watch(after);
  EXPECT_EQ(kept.past.submaps.size(), static_cast<std::size_t>(kFrameCount));

  serve([](ServiceOptions&) {});
  RawClient late(server_->port());
  ASSERT_TRUE(late.upgrade());
  late.send_message(
      wire::Hello{0, "test", server_->token(), wire::ViewScan{camera.welcome.scan_id}});
  const Watched stored = watch(late);
  ASSERT_TRUE(stored.welcome);
  EXPECT_EQ(stored.welcome->title, "a test");
  EXPECT_EQ(stored.welcome->camera, room().camera());
  EXPECT_TRUE(stored.snapshot_ended);
  EXPECT_EQ(stored.close_code, 1000);
  EXPECT_EQ(stored.phases, std::vector<wire::ScanPhase>{wire::ScanPhase::kFinished});
  ASSERT_EQ(stored.past.positions_m.size(), static_cast<std::size_t>(3 * kFrameCount));
  for (std::size_t i = 0; i < stored.past.positions_m.size(); ++i)
    EXPECT_NEAR(stored.past.positions_m[i], kept.past.positions_m[i], 1e-5)
        << "the corrected path, from memory and from the files";
  EXPECT_EQ(stored.last_state->keyframes, live.last_state->keyframes);
  std::size_t filled_count = 0;
  for (const auto& [key, chunk] : live.chunks) {
    if (chunk.point_count == 0) continue;
    ++filled_count;
    ASSERT_TRUE(stored.chunks.contains(key));
    EXPECT_EQ(stored.chunks.at(key).draco, chunk.draco);
  }
  EXPECT_EQ(stored.chunks.size(), filled_count);
}

// Its results are read beside the network thread, once; who leaves before they are there harms
// nobody.
TEST_F(ScanViewersTest, ViewersThatComeTogetherWaitForTheSameResults) {
  Camera camera = start();
  ASSERT_TRUE(stream(camera));
  serve([](ServiceOptions&) {});
  constexpr int kViewers = 6;
  std::vector<std::unique_ptr<RawClient>> viewers;
  for (int i = 0; i < kViewers; ++i) {
    viewers.push_back(std::make_unique<RawClient>(server_->port()));
    ASSERT_TRUE(viewers.back()->upgrade());
  }
  for (const auto& viewer : viewers)
    viewer->send_message(
        wire::Hello{0, "test", server_->token(), wire::ViewScan{camera.welcome.scan_id}});
  viewers.erase(viewers.begin() + 1);  // with its connection
  std::optional<std::size_t> chunk_count;
  for (const auto& viewer : viewers) {
    const Watched watched = watch(*viewer);
    EXPECT_TRUE(watched.welcome);
    EXPECT_TRUE(watched.snapshot_ended);
    EXPECT_EQ(watched.close_code, 1000);
    EXPECT_EQ(watched.chunks.size(), chunk_count.value_or(watched.chunks.size()));
    chunk_count = watched.chunks.size();
  }
  EXPECT_GT(chunk_count.value_or(0), 3u);
}

// From the fourth frame on the camera hangs head down: nothing fits, and a new part begins.
TEST_F(ScanViewersTest, AScanInTwoPartsSaysSoAndShowsBoth) {
  Camera camera = start(wire::Mode::kBatch,
                        {{"output.unstable", "true"}, {"adjust.new_part_after_frames", "2"}});
  RawClient viewer(server_->port());
  ASSERT_TRUE(viewer.upgrade());
  viewer.send_message(
      wire::Hello{0, "test", server_->token(), wire::ViewScan{camera.welcome.scan_id}});
  ASSERT_TRUE(viewer.read<wire::SnapshotEnd>());
  Watched watched;
  std::thread watching([&] { watched = watch(viewer); });
  for (int i = 0; i < kFrameCount; ++i) {
    wire::Frame frame = room_frame(i);
    frame::RgbdFrame images =
        *wire::decode_frame_payload(frame, wire::DepthCodec::kRvlZstd, room().camera());
    if (i >= 3) std::reverse(images.depth.pixels.begin(), images.depth.pixels.end());
    if (i >= 3) std::reverse(images.color.pixels.begin(), images.color.pixels.end());
    frame.depth = *wire::encode_depth_payload(images.depth, wire::DepthCodec::kRvlZstd);
    const std::vector<std::uint8_t> png = *image::encode_png(images.color);
    frame.color = {png.begin(), png.end()};
    camera.client->send_message(std::move(frame));
  }
  camera.client->send_message(wire::Finish{});
  const auto finished = camera.client->read<wire::Finished>();
  watching.join();
  ASSERT_TRUE(finished);
  EXPECT_EQ(Json::parse(finished->report_json)["mapping"]["parts"], 2);
  EXPECT_THAT(watched.last_state->message, HasSubstr("2 parts"));
  EXPECT_THAT(std::string(row(camera.welcome.scan_id)["words"]), HasSubstr("2 parts"));
  ASSERT_TRUE(watched.poses);
  ASSERT_EQ(watched.poses->poses.size(), 2u);
  EXPECT_NE(watched.poses->poses[0].part, watched.poses->poses[1].part);
}

TEST_F(ScanViewersTest, AViewerThatBreaksARuleIsEndedAndTheScanIsNot) {
  Camera camera = start();
  for (wire::ClientMessage message :
       {wire::ClientMessage(wire::Frame{}), wire::ClientMessage(wire::Finish{}),
        wire::ClientMessage(wire::ViewerAck{1ull << 40})}) {
    RawClient viewer(server_->port());
    ASSERT_TRUE(viewer.upgrade());
    viewer.send_message(
        wire::Hello{0, "test", server_->token(), wire::ViewScan{camera.welcome.scan_id}});
    ASSERT_TRUE(viewer.read<wire::Welcome>());
    viewer.send_message(std::move(message));
    EXPECT_TRUE(viewer.read<wire::ErrorMessage>());
    EXPECT_EQ(viewer.close_code(), 1002);
  }
  EXPECT_TRUE(stream(camera));
}

TEST_F(ScanViewersTest, AScanThatADeadServerLeftRunningIsInterruptedAndCanBeLookedAt) {
  const ScanRow left = leave_running(true);
  // Its log is looked for in the background.
  for (int i = 0; i < 1000 && row(left.id)["state"] == "running"; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(row(left.id)["state"], "interrupted");
  RawClient viewer(server_->port());
  ASSERT_TRUE(viewer.upgrade());
  viewer.send_message(wire::Hello{0, "test", server_->token(), wire::ViewScan{left.id}});
  const Watched watched = watch(viewer);
  EXPECT_TRUE(watched.snapshot_ended);
  EXPECT_EQ(watched.phases, std::vector<wire::ScanPhase>{wire::ScanPhase::kInterrupted});
}

TEST_F(ScanViewersTest, ADamagedChunkFileHarmsNobody) {
  Camera camera = start();
  ASSERT_TRUE(stream(camera));
  server_->stop();
  std::ofstream(scan_file(camera.welcome.scan_id, "chunks.bin"), std::ios::trunc)
      << "HRMCHNK1\xff\xff\xff\xff";
  std::ofstream(scan_file(camera.welcome.scan_id, "trajectory.txt"), std::ios::trunc)
      << "no trajectory";
  serve([](ServiceOptions&) {});
  RawClient viewer(server_->port());
  ASSERT_TRUE(viewer.upgrade());
  viewer.send_message(
      wire::Hello{0, "test", server_->token(), wire::ViewScan{camera.welcome.scan_id}});
  const Watched watched = watch(viewer);
  EXPECT_TRUE(watched.snapshot_ended);
  EXPECT_TRUE(watched.chunks.empty());
}

}  // namespace scan_viewers_test
}  // namespace hermite::server
