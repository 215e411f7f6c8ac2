#include "server/scan/audience.h"

#include <gtest/gtest.h>

#include <variant>

#include "proto/wire/server_message.h"

namespace hermite {
namespace {

ChunkUpdate chunk(std::int16_t x, std::uint64_t version, std::size_t bytes = 100) {
  wire::Chunk message{{0, 0, x, 0, 0}, version, bytes == 0 ? 0u : 10u, std::string(bytes, 'd')};
  return {{0, 0, x, 0, 0}, bytes == 0, std::make_shared<const std::string>(wire::format_server_message(std::move(message)))};
}

ModelUpdate model(std::vector<ChunkUpdate> chunks) {
  ModelUpdate update;
  update.chunks = std::move(chunks);
  update.poses = {{{0, Rigid3{}}}};
  return update;
}

MeshUpdate mesh(std::int16_t x, std::uint64_t version, std::size_t bytes = 100) {
  wire::MeshChunk message{{0, x, 0, 0}, version, 0, bytes == 0 ? 0u : 10u, std::string(bytes, 'm')};
  MeshUpdate update;
  update.pieces.push_back({{0, x, 0, 0}, bytes == 0, std::make_shared<const std::string>(wire::format_server_message(std::move(message)))});
  return update;
}

std::shared_ptr<Audience> empty_audience() { return std::make_shared<Audience>(SceneInfo{"id", "title", {}}); }

struct Joined {
  int woken = 0;
  std::unique_ptr<Viewer> viewer;
  explicit Joined(const std::shared_ptr<Audience>& audience, const wire::Watch& watch = {}) {
    auto result = Audience::join(audience, {"admin", true}, watch, [this] { ++woken; });
    if (result.ok()) viewer = *std::move(result);
  }
};

wire::ServerMessage parsed(const SharedBytes& bytes) { return *wire::parse_server_message(*bytes); }

// Everything there is to send, with every byte acknowledged at once.
std::vector<wire::ServerMessage> take_all(Viewer& viewer) {
  std::vector<wire::ServerMessage> messages;
  std::uint64_t bytes = 0;
  while (const SharedBytes message = viewer.next()) {
    messages.push_back(parsed(message));
    bytes += message->size();
    viewer.acknowledge(bytes).ok();
  }
  return messages;
}

template <class Body>
std::vector<Body> only(const std::vector<wire::ServerMessage>& messages) {
  std::vector<Body> bodies;
  for (const wire::ServerMessage& message : messages)
    if (const Body* body = std::get_if<Body>(&message)) bodies.push_back(*body);
  return bodies;
}

TEST(Audience, ALateViewerGetsEverythingAndThenTheEndOfTheSnapshot) {
  const auto audience = empty_audience();
  audience->show_state({});
  wire::FrameResult result;
  result.world_from_camera.translation = {1, 2, 3};
  audience->show_result(result);
  audience->show_result(result);
  audience->show_model(model({chunk(0, 1), chunk(1, 2), chunk(2, 3, 0)}));
  Joined joined(audience);
  const auto messages = take_all(*joined.viewer);
  EXPECT_EQ(only<wire::ScanState>(messages).size(), 1u);
  EXPECT_EQ(only<wire::SubmapPoses>(messages).size(), 1u);
  EXPECT_EQ(only<wire::FrameResult>(messages).size(), 1u) << "the latest only";
  ASSERT_EQ(only<wire::TrajectoryPart>(messages).size(), 1u);
  EXPECT_EQ(only<wire::TrajectoryPart>(messages)[0].positions_m, (std::vector<float>{1, 2, 3, 1, 2, 3}));
  EXPECT_EQ(only<wire::Chunk>(messages).size(), 2u) << "an empty chunk is nothing to a newcomer";
  EXPECT_TRUE(std::holds_alternative<wire::SnapshotEnd>(messages.back()));
}

TEST(Audience, ThePathMovesWithItsSubmapsForThoseWhoComeLater) {
  const auto audience = empty_audience();
  wire::FrameResult result;
  result.world_from_camera.translation = {1, 2, 3};
  result.in_submap = wire::PoseInSubmap{0, result.world_from_camera};
  audience->show_result(result);
  Rigid3 moved;
  moved.translation = {10, 0, 0};
  result.world_from_camera.translation = {11, 0, 0};
  result.in_submap = wire::PoseInSubmap{1, Rigid3{}};
  result.in_submap->submap_from_camera.translation = {1, 0, 0};
  audience->show_poses({{{0, Rigid3{}}, {1, moved}}});
  audience->show_result(result);
  moved.translation = {10, 0.5, 0};
  audience->show_poses({{{0, Rigid3{}}, {1, moved}}});
  Joined joined(audience);
  const auto messages = take_all(*joined.viewer);
  ASSERT_EQ(only<wire::TrajectoryPart>(messages).size(), 1u);
  const wire::TrajectoryPart part = only<wire::TrajectoryPart>(messages)[0];
  EXPECT_EQ(part.positions_m, (std::vector<float>{1, 2, 3, 11, 0.5, 0})) << "for viewers that know no submaps: as the map lies now";
  EXPECT_EQ(part.positions_in_submaps_m, (std::vector<float>{1, 2, 3, 1, 0, 0}));
  EXPECT_EQ(part.submaps, (std::vector<std::uint32_t>{0, 1}));
}

TEST(Audience, ThePathOfAMapThatIsMadeAnewIsAnotherOneForAll) {
  const auto audience = empty_audience();
  wire::FrameResult result;
  result.world_from_camera.translation = {1, 2, 3};
  audience->show_result(result);
  Joined before(audience);
  take_all(*before.viewer);
  wire::PoseInSubmap elsewhere;
  elsewhere.submap_from_camera.translation = {4, 5, 6};
  audience->show_other_past({elsewhere});
  result.world_from_camera.translation = {7, 8, 9};
  audience->show_result(result);
  const auto messages = take_all(*before.viewer);
  ASSERT_EQ(only<wire::TrajectoryPart>(messages).size(), 1u);
  EXPECT_EQ(only<wire::TrajectoryPart>(messages)[0].positions_m, (std::vector<float>{4, 5, 6})) << "in place of all before";
  EXPECT_TRUE(std::holds_alternative<wire::TrajectoryPart>(messages.front())) << "then the result that comes after it";
  Joined after(audience);
  EXPECT_EQ(only<wire::TrajectoryPart>(take_all(*after.viewer))[0].positions_m, (std::vector<float>{4, 5, 6, 7, 8, 9}));
}

TEST(Audience, ThePathOfAScanThatIsOverIsInTheWorld) {
  const auto audience = empty_audience();
  audience->set_positions({1, 2, 3});
  Joined joined(audience);
  const auto parts = only<wire::TrajectoryPart>(take_all(*joined.viewer));
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].positions_m, (std::vector<float>{1, 2, 3}));
  EXPECT_TRUE(parts[0].submaps.empty());
}

TEST(Audience, ASlowViewerHearsOfAnEventAfterwards) {
  const auto audience = empty_audience();
  Joined joined(audience);
  take_all(*joined.viewer);
  for (std::uint64_t i = 1; i <= 20; ++i) {
    wire::FrameResult result;
    result.sequence = i;
    if (i % 8 == 0) result.event = wire::MapEvent::kLoopClosed;
    audience->show_result(result);
  }
  const auto results = only<wire::FrameResult>(take_all(*joined.viewer));
  ASSERT_EQ(results.size(), 2u);
  EXPECT_EQ(results[0].sequence, 16u) << "the newest event";
  EXPECT_EQ(results[1].sequence, 20u);
  wire::FrameResult last;
  last.event = wire::MapEvent::kLost;
  audience->show_result({});
  audience->show_result(last);
  EXPECT_EQ(only<wire::FrameResult>(take_all(*joined.viewer)).size(), 1u) << "an older one would be old news";
}

TEST(Audience, PosesAreSentBeforeTheFrameThatIsInThem) {
  const auto audience = empty_audience();
  Joined joined(audience);
  take_all(*joined.viewer);
  audience->show_poses({{{0, Rigid3{}}, {1, Rigid3{}}}});
  audience->show_result({});
  const auto messages = take_all(*joined.viewer);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_TRUE(std::holds_alternative<wire::SubmapPoses>(messages[0]));
}

TEST(Audience, TheSnapshotOfAnEmptyScanEndsAtOnce) {
  const auto audience = empty_audience();
  Joined joined(audience);
  const auto messages = take_all(*joined.viewer);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<wire::SnapshotEnd>(messages[0]));
}

TEST(Audience, ASlowViewerGetsTheNewestOfEverythingOnce) {
  const auto audience = empty_audience();
  Joined joined(audience);
  take_all(*joined.viewer);
  for (std::uint64_t i = 1; i <= 100; ++i) {
    wire::FrameResult result;
    result.sequence = i;
    audience->show_result(result);
    audience->show_model(model({chunk(0, i)}));
  }
  const auto messages = take_all(*joined.viewer);
  ASSERT_EQ(only<wire::FrameResult>(messages).size(), 1u);
  EXPECT_EQ(only<wire::FrameResult>(messages)[0].sequence, 100u);
  ASSERT_EQ(only<wire::Chunk>(messages).size(), 1u);
  EXPECT_EQ(only<wire::Chunk>(messages)[0].version, 100u);
  EXPECT_GE(joined.woken, 200);
}

TEST(Audience, ARemovedChunkIsTold) {
  const auto audience = empty_audience();
  audience->show_model(model({chunk(0, 1)}));
  Joined joined(audience);
  take_all(*joined.viewer);
  audience->show_model(model({chunk(0, 2, 0)}));
  const auto chunks = only<wire::Chunk>(take_all(*joined.viewer));
  ASSERT_EQ(chunks.size(), 1u);
  EXPECT_EQ(chunks[0].point_count, 0u);
}

TEST(Audience, UnacknowledgedBytesAreBoundedForChunksAndNotForPoses) {
  const auto audience = empty_audience();
  std::vector<ChunkUpdate> chunks;
  for (std::int16_t x = 0; x < 100; ++x) chunks.push_back(chunk(x, 1, 100'000));
  audience->show_model(model(std::move(chunks)));
  Joined joined(audience);
  std::uint64_t sent_bytes = 0;
  while (const SharedBytes message = joined.viewer->next()) sent_bytes += message->size();
  EXPECT_LE(sent_bytes, kMaxUnackedBytes);
  EXPECT_GT(sent_bytes, kMaxUnackedBytes - 200'000);
  audience->show_result({});
  const SharedBytes pose = joined.viewer->next();
  ASSERT_TRUE(pose);
  EXPECT_TRUE(std::holds_alternative<wire::FrameResult>(parsed(pose)));
  EXPECT_FALSE(joined.viewer->next());
  ASSERT_TRUE(joined.viewer->acknowledge(sent_bytes).ok());
  EXPECT_TRUE(joined.viewer->next());
}

TEST(Audience, AnAcknowledgementOfMoreThanWasSentIsRefused) {
  const auto audience = empty_audience();
  Joined joined(audience);
  const std::uint64_t sent_bytes = joined.viewer->next()->size();
  EXPECT_TRUE(joined.viewer->acknowledge(sent_bytes).ok());
  EXPECT_TRUE(joined.viewer->acknowledge(0).ok()) << "an old one is no harm";
  const Status status = joined.viewer->acknowledge(sent_bytes + 1);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, ErrorCode::kInvalidArgument);
}

TEST(Audience, ChunksThatChangeAllTheTimeDoNotKeepOthersBack) {
  const auto audience = empty_audience();
  audience->show_model(model({chunk(0, 1), chunk(1, 1), chunk(2, 1)}));
  Joined joined(audience);
  bool snapshot_ended = false;
  std::uint64_t bytes = 0;
  for (std::uint64_t round = 2; round < 30 && !snapshot_ended; ++round) {
    audience->show_model(model({chunk(0, round)}));
    const SharedBytes message = joined.viewer->next();
    bytes += message->size();
    joined.viewer->acknowledge(bytes).ok();
    snapshot_ended = std::holds_alternative<wire::SnapshotEnd>(parsed(message));
    if (std::holds_alternative<wire::SubmapPoses>(parsed(message))) {
      const SharedBytes next = joined.viewer->next();
      bytes += next->size();
      snapshot_ended = std::holds_alternative<wire::SnapshotEnd>(parsed(next));
    }
  }
  EXPECT_TRUE(snapshot_ended);
}

TEST(Audience, WhoWantsASurfaceGetsItAndNoPointsWhileTheScanRuns) {
  const auto audience = empty_audience();
  audience->show_model(model({chunk(0, 1)}));
  audience->show_mesh(mesh(0, 1));
  audience->show_mesh(mesh(1, 2, 0));
  Joined before_minor_6(audience), joined(audience, {false, true}), both(audience, {true, true});
  EXPECT_TRUE(only<wire::MeshChunk>(take_all(*before_minor_6.viewer)).empty());
  const auto first = take_all(*joined.viewer);
  EXPECT_EQ(only<wire::MeshChunk>(first).size(), 1u) << "an empty piece is nothing to a newcomer";
  EXPECT_TRUE(only<wire::Chunk>(first).empty());
  EXPECT_TRUE(std::holds_alternative<wire::SnapshotEnd>(first.back()));
  const auto all = take_all(*both.viewer);
  EXPECT_EQ(only<wire::MeshChunk>(all).size() + only<wire::Chunk>(all).size(), 2u);

  for (std::uint64_t version = 3; version < 20; ++version) audience->show_mesh(mesh(0, version));
  audience->show_mesh(mesh(1, 20, 0));
  const auto changes = only<wire::MeshChunk>(take_all(*joined.viewer));
  ASSERT_EQ(changes.size(), 2u) << "the newest version of each, once";
  EXPECT_EQ(changes[0].version + changes[1].version, 39u);

  audience->show_model(model({chunk(1, 2)}));
  joined.viewer->watch({true, false});
  EXPECT_EQ(only<wire::Chunk>(take_all(*joined.viewer)).size(), 2u) << "all that it lacks";
  audience->show_mesh(mesh(2, 21));
  EXPECT_TRUE(take_all(*joined.viewer).empty());
  joined.viewer->watch({false, true});
  EXPECT_EQ(only<wire::MeshChunk>(take_all(*joined.viewer)).size(), 1u) << "nothing that it has";
}

TEST(Audience, PointsAreForAllWhenTheScanHasEndedOrThereIsNoSurfaceAnyMore) {
  const auto audience = empty_audience();
  audience->show_model(model({chunk(0, 1)}));
  Joined joined(audience, {false, true}), other(audience, {false, true});
  EXPECT_TRUE(only<wire::Chunk>(take_all(*joined.viewer)).empty());
  MeshUpdate last = mesh(0, 5, 0);
  last.ended = true;
  audience->show_mesh(std::move(last));
  EXPECT_EQ(only<wire::Chunk>(take_all(*joined.viewer)).size(), 1u);
  audience->close();
  EXPECT_FALSE(other.viewer->complete());
  EXPECT_EQ(only<wire::Chunk>(take_all(*other.viewer)).size(), 1u);
  EXPECT_TRUE(other.viewer->complete());
}

TEST(Audience, SaysWhetherAnybodyWantsASurface) {
  const auto audience = empty_audience();
  std::vector<bool> said;
  audience->tell_mesh_wanted([&said](bool wanted) { said.push_back(wanted); });
  {
    Joined points(audience), surface(audience, {false, true}), another(audience, {true, true});
    surface.viewer->watch({true, false});
    EXPECT_EQ(said, (std::vector<bool>{false, true})) << "another one still does";
  }
  EXPECT_EQ(said, (std::vector<bool>{false, true, false}));
  audience->tell_mesh_wanted(nullptr);
  Joined late(audience, {false, true});
  EXPECT_EQ(said.size(), 3u);
}

TEST(Audience, UnacknowledgedPiecesOfTheSurfaceAreBoundedToo) {
  const auto audience = empty_audience();
  for (std::int16_t x = 0; x < 100; ++x) audience->show_mesh(mesh(x, 1, 100'000));
  Joined joined(audience, {false, true});
  std::uint64_t sent_bytes = 0;
  while (const SharedBytes message = joined.viewer->next()) sent_bytes += message->size();
  EXPECT_LE(sent_bytes, kMaxUnackedBytes);
  EXPECT_GT(sent_bytes, kMaxUnackedBytes - 200'000);
}

TEST(Audience, HasAtMostItsViewersAndAPlaceIsFreeAfterOneLeaves) {
  const auto audience = empty_audience();
  std::vector<std::unique_ptr<Joined>> all;
  for (int i = 0; i < kViewerShare.in_all; ++i) all.push_back(std::make_unique<Joined>(audience));
  auto refused = Audience::join(audience, {"admin", true}, {}, [] {});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kBusy);
  all.pop_back();
  EXPECT_TRUE(Audience::join(audience, {"admin", true}, {}, [] {}).ok());
}

TEST(Audience, AViewerIsCompleteWhenTheScanHasEndedAndAllIsSent) {
  const auto audience = empty_audience();
  audience->show_model(model({chunk(0, 1)}));
  Joined joined(audience);
  take_all(*joined.viewer);
  EXPECT_FALSE(joined.viewer->complete());
  audience->show_state({wire::ScanPhase::kFinished, "", 1, 1, 0});
  audience->close();
  EXPECT_FALSE(joined.viewer->complete()) << "the last state is not sent yet";
  take_all(*joined.viewer);
  EXPECT_TRUE(joined.viewer->complete());
}

}  // namespace
}  // namespace hermite
