#include "server/scan/subscribers.h"

#include <gtest/gtest.h>

#include <variant>

#include "proto/wire/server_message.h"

namespace hermite::server {
namespace {

ChunkUpdate chunk(std::int16_t x, std::uint64_t version, std::size_t bytes = 100) {
  wire::Chunk message{{0, 0, x, 0, 0}, version, bytes == 0 ? 0u : 10u, std::string(bytes, 'd')};
  return {{0, 0, x, 0, 0},
          bytes == 0,
          std::make_shared<const std::string>(wire::format_server_message(std::move(message)))};
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
  update.pieces.push_back(
      {{0, x, 0, 0},
       bytes == 0,
       std::make_shared<const std::string>(wire::format_server_message(std::move(message)))});
  return update;
}

std::shared_ptr<Subscribers> empty_subscribers() {
  return std::make_shared<Subscribers>(SceneInfo{"id", "title", {}});
}

struct Joined {
  int woken = 0;
  std::unique_ptr<Viewer> viewer;
  explicit Joined(const std::shared_ptr<Subscribers>& subscribers, const wire::Watch& watch = {}) {
    auto result = Subscribers::join(subscribers, {"admin", true}, watch, [this] { ++woken; });
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

TEST(Subscribers, ALateViewerGetsEverythingAndThenTheEndOfTheSnapshot) {
  const auto subscribers = empty_subscribers();
  subscribers->show_state({});
  wire::FrameResult result;
  result.world_from_camera.translation = {1, 2, 3};
  subscribers->show_result(result);
  subscribers->show_result(result);
  subscribers->show_model(model({chunk(0, 1), chunk(1, 2), chunk(2, 3, 0)}));
  Joined joined(subscribers);
  const auto messages = take_all(*joined.viewer);
  EXPECT_EQ(only<wire::ScanState>(messages).size(), 1u);
  EXPECT_EQ(only<wire::SubmapPoses>(messages).size(), 1u);
  EXPECT_EQ(only<wire::FrameResult>(messages).size(), 1u) << "the latest only";
  ASSERT_EQ(only<wire::TrajectoryPart>(messages).size(), 1u);
  EXPECT_EQ(only<wire::TrajectoryPart>(messages)[0].positions_m,
            (std::vector<float>{1, 2, 3, 1, 2, 3}));
  EXPECT_EQ(only<wire::Chunk>(messages).size(), 2u) << "an empty chunk is nothing to a newcomer";
  EXPECT_TRUE(std::holds_alternative<wire::SnapshotEnd>(messages.back()));
}

TEST(Subscribers, ThePathMovesWithItsSubmapsForThoseWhoComeLater) {
  const auto subscribers = empty_subscribers();
  wire::FrameResult result;
  result.world_from_camera.translation = {1, 2, 3};
  result.in_submap = wire::PoseInSubmap{0, result.world_from_camera};
  subscribers->show_result(result);
  Rigid3 moved;
  moved.translation = {10, 0, 0};
  result.world_from_camera.translation = {11, 0, 0};
  result.in_submap = wire::PoseInSubmap{1, Rigid3{}};
  result.in_submap->submap_from_camera.translation = {1, 0, 0};
  subscribers->show_poses({{{0, Rigid3{}}, {1, moved}}});
  subscribers->show_result(result);
  moved.translation = {10, 0.5, 0};
  subscribers->show_poses({{{0, Rigid3{}}, {1, moved}}});
  Joined joined(subscribers);
  const auto messages = take_all(*joined.viewer);
  ASSERT_EQ(only<wire::TrajectoryPart>(messages).size(), 1u);
  const wire::TrajectoryPart part = only<wire::TrajectoryPart>(messages)[0];
  EXPECT_EQ(part.positions_m, (std::vector<float>{1, 2, 3, 11, 0.5, 0}))
      << "for viewers that know no submaps: as the map lies now";
  EXPECT_EQ(part.positions_in_submaps_m, (std::vector<float>{1, 2, 3, 1, 0, 0}));
  EXPECT_EQ(part.submaps, (std::vector<std::uint32_t>{0, 1}));
}

TEST(Subscribers, ThePathOfAMapThatIsMadeAnewIsAnotherOneForAll) {
  const auto subscribers = empty_subscribers();
  wire::FrameResult result;
  result.world_from_camera.translation = {1, 2, 3};
  subscribers->show_result(result);
  Joined before(subscribers);
  take_all(*before.viewer);
  wire::PoseInSubmap elsewhere;
  elsewhere.submap_from_camera.translation = {4, 5, 6};
  subscribers->show_other_past({elsewhere});
  result.world_from_camera.translation = {7, 8, 9};
  subscribers->show_result(result);
  const auto messages = take_all(*before.viewer);
  ASSERT_EQ(only<wire::TrajectoryPart>(messages).size(), 1u);
  EXPECT_EQ(only<wire::TrajectoryPart>(messages)[0].positions_m, (std::vector<float>{4, 5, 6}))
      << "in place of all before";
  EXPECT_TRUE(std::holds_alternative<wire::TrajectoryPart>(messages.front()))
      << "then the result that comes after it";
  Joined after(subscribers);
  EXPECT_EQ(only<wire::TrajectoryPart>(take_all(*after.viewer))[0].positions_m,
            (std::vector<float>{4, 5, 6, 7, 8, 9}));
}

TEST(Subscribers, ThePathOfAScanThatIsOverIsInTheWorld) {
  const auto subscribers = empty_subscribers();
  subscribers->set_positions({1, 2, 3});
  Joined joined(subscribers);
  const auto parts = only<wire::TrajectoryPart>(take_all(*joined.viewer));
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].positions_m, (std::vector<float>{1, 2, 3}));
  EXPECT_TRUE(parts[0].submaps.empty());
}

TEST(Subscribers, ASlowViewerHearsOfAnEventAfterwards) {
  const auto subscribers = empty_subscribers();
  Joined joined(subscribers);
  take_all(*joined.viewer);
  for (std::uint64_t i = 1; i <= 20; ++i) {
    wire::FrameResult result;
    result.sequence = i;
    if (i % 8 == 0) result.event = wire::MapEvent::kLoopClosed;
    subscribers->show_result(result);
  }
  const auto results = only<wire::FrameResult>(take_all(*joined.viewer));
  ASSERT_EQ(results.size(), 2u);
  EXPECT_EQ(results[0].sequence, 16u) << "the newest event";
  EXPECT_EQ(results[1].sequence, 20u);
  wire::FrameResult last;
  last.event = wire::MapEvent::kLost;
  subscribers->show_result({});
  subscribers->show_result(last);
  EXPECT_EQ(only<wire::FrameResult>(take_all(*joined.viewer)).size(), 1u)
      << "an older one would be old news";
}

TEST(Subscribers, PosesAreSentBeforeTheFrameThatIsInThem) {
  const auto subscribers = empty_subscribers();
  Joined joined(subscribers);
  take_all(*joined.viewer);
  subscribers->show_poses({{{0, Rigid3{}}, {1, Rigid3{}}}});
  subscribers->show_result({});
  const auto messages = take_all(*joined.viewer);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_TRUE(std::holds_alternative<wire::SubmapPoses>(messages[0]));
}

TEST(Subscribers, TheSnapshotOfAnEmptyScanEndsAtOnce) {
  const auto subscribers = empty_subscribers();
  Joined joined(subscribers);
  const auto messages = take_all(*joined.viewer);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<wire::SnapshotEnd>(messages[0]));
}

TEST(Subscribers, ASlowViewerGetsTheNewestOfEverythingOnce) {
  const auto subscribers = empty_subscribers();
  Joined joined(subscribers);
  take_all(*joined.viewer);
  for (std::uint64_t i = 1; i <= 100; ++i) {
    wire::FrameResult result;
    result.sequence = i;
    subscribers->show_result(result);
    subscribers->show_model(model({chunk(0, i)}));
  }
  const auto messages = take_all(*joined.viewer);
  ASSERT_EQ(only<wire::FrameResult>(messages).size(), 1u);
  EXPECT_EQ(only<wire::FrameResult>(messages)[0].sequence, 100u);
  ASSERT_EQ(only<wire::Chunk>(messages).size(), 1u);
  EXPECT_EQ(only<wire::Chunk>(messages)[0].version, 100u);
  EXPECT_GE(joined.woken, 200);
}

TEST(Subscribers, ARemovedChunkIsTold) {
  const auto subscribers = empty_subscribers();
  subscribers->show_model(model({chunk(0, 1)}));
  Joined joined(subscribers);
  take_all(*joined.viewer);
  subscribers->show_model(model({chunk(0, 2, 0)}));
  const auto chunks = only<wire::Chunk>(take_all(*joined.viewer));
  ASSERT_EQ(chunks.size(), 1u);
  EXPECT_EQ(chunks[0].point_count, 0u);
}

TEST(Subscribers, UnacknowledgedBytesAreBoundedForChunksAndNotForPoses) {
  const auto subscribers = empty_subscribers();
  std::vector<ChunkUpdate> chunks;
  for (std::int16_t x = 0; x < 100; ++x) chunks.push_back(chunk(x, 1, 100'000));
  subscribers->show_model(model(std::move(chunks)));
  Joined joined(subscribers);
  std::uint64_t sent_bytes = 0;
  while (const SharedBytes message = joined.viewer->next()) sent_bytes += message->size();
  EXPECT_LE(sent_bytes, kMaxUnackedBytes);
  EXPECT_GT(sent_bytes, kMaxUnackedBytes - 200'000);
  subscribers->show_result({});
  const SharedBytes pose = joined.viewer->next();
  ASSERT_TRUE(pose);
  EXPECT_TRUE(std::holds_alternative<wire::FrameResult>(parsed(pose)));
  EXPECT_FALSE(joined.viewer->next());
  ASSERT_TRUE(joined.viewer->acknowledge(sent_bytes).ok());
  EXPECT_TRUE(joined.viewer->next());
}

TEST(Subscribers, AnAcknowledgementOfMoreThanWasSentIsRefused) {
  const auto subscribers = empty_subscribers();
  Joined joined(subscribers);
  const std::uint64_t sent_bytes = joined.viewer->next()->size();
  EXPECT_TRUE(joined.viewer->acknowledge(sent_bytes).ok());
  EXPECT_TRUE(joined.viewer->acknowledge(0).ok()) << "an old one is no harm";
  const Status status = joined.viewer->acknowledge(sent_bytes + 1);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, ErrorCode::kInvalidArgument);
}

TEST(Subscribers, ChunksThatChangeAllTheTimeDoNotKeepOthersBack) {
  const auto subscribers = empty_subscribers();
  subscribers->show_model(model({chunk(0, 1), chunk(1, 1), chunk(2, 1)}));
  Joined joined(subscribers);
  bool snapshot_ended = false;
  std::uint64_t bytes = 0;
  for (std::uint64_t round = 2; round < 30 && !snapshot_ended; ++round) {
    subscribers->show_model(model({chunk(0, round)}));
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

TEST(Subscribers, WhoWantsASurfaceGetsItAndNoPointsWhileTheScanRuns) {
  const auto subscribers = empty_subscribers();
  subscribers->show_model(model({chunk(0, 1)}));
  subscribers->show_mesh(mesh(0, 1));
  subscribers->show_mesh(mesh(1, 2, 0));
  Joined before_minor_6(subscribers), joined(subscribers, {false, true}),
      both(subscribers, {true, true});
  EXPECT_TRUE(only<wire::MeshChunk>(take_all(*before_minor_6.viewer)).empty());
  const auto first = take_all(*joined.viewer);
  EXPECT_EQ(only<wire::MeshChunk>(first).size(), 1u) << "an empty piece is nothing to a newcomer";
  EXPECT_TRUE(only<wire::Chunk>(first).empty());
  EXPECT_TRUE(std::holds_alternative<wire::SnapshotEnd>(first.back()));
  const auto all = take_all(*both.viewer);
  EXPECT_EQ(only<wire::MeshChunk>(all).size() + only<wire::Chunk>(all).size(), 2u);

  for (std::uint64_t version = 3; version < 20; ++version) subscribers->show_mesh(mesh(0, version));
  subscribers->show_mesh(mesh(1, 20, 0));
  const auto changes = only<wire::MeshChunk>(take_all(*joined.viewer));
  ASSERT_EQ(changes.size(), 2u) << "the newest version of each, once";
  EXPECT_EQ(changes[0].version + changes[1].version, 39u);

  subscribers->show_model(model({chunk(1, 2)}));
  joined.viewer->watch({true, false});
  EXPECT_EQ(only<wire::Chunk>(take_all(*joined.viewer)).size(), 2u) << "all that it lacks";
  subscribers->show_mesh(mesh(2, 21));
  EXPECT_TRUE(take_all(*joined.viewer).empty());
  joined.viewer->watch({false, true});
  EXPECT_EQ(only<wire::MeshChunk>(take_all(*joined.viewer)).size(), 1u) << "nothing that it has";
}

TEST(Subscribers, PointsAreForAllWhenTheScanHasEndedOrThereIsNoSurfaceAnyMore) {
  const auto subscribers = empty_subscribers();
  subscribers->show_model(model({chunk(0, 1)}));
  Joined joined(subscribers, {false, true}), other(subscribers, {false, true});
  EXPECT_TRUE(only<wire::Chunk>(take_all(*joined.viewer)).empty());
  MeshUpdate last = mesh(0, 5, 0);
  last.ended = true;
  subscribers->show_mesh(std::move(last));
  EXPECT_EQ(only<wire::Chunk>(take_all(*joined.viewer)).size(), 1u);
  subscribers->close();
  EXPECT_FALSE(other.viewer->complete());
  EXPECT_EQ(only<wire::Chunk>(take_all(*other.viewer)).size(), 1u);
  EXPECT_TRUE(other.viewer->complete());
}

TEST(Subscribers, SaysWhetherAnybodyWantsASurface) {
  const auto subscribers = empty_subscribers();
  std::vector<bool> said;
  subscribers->tell_mesh_wanted([&said](bool wanted) { said.push_back(wanted); });
  {
    Joined points(subscribers), surface(subscribers, {false, true}),
        another(subscribers, {true, true});
    surface.viewer->watch({true, false});
    EXPECT_EQ(said, (std::vector<bool>{false, true})) << "another one still does";
  }
  EXPECT_EQ(said, (std::vector<bool>{false, true, false}));
  subscribers->tell_mesh_wanted(nullptr);
  Joined late(subscribers, {false, true});
  EXPECT_EQ(said.size(), 3u);
}

TEST(Subscribers, UnacknowledgedPiecesOfTheSurfaceAreBoundedToo) {
  const auto subscribers = empty_subscribers();
  for (std::int16_t x = 0; x < 100; ++x) subscribers->show_mesh(mesh(x, 1, 100'000));
  Joined joined(subscribers, {false, true});
  std::uint64_t sent_bytes = 0;
  while (const SharedBytes message = joined.viewer->next()) sent_bytes += message->size();
  EXPECT_LE(sent_bytes, kMaxUnackedBytes);
  EXPECT_GT(sent_bytes, kMaxUnackedBytes - 200'000);
}

TEST(Subscribers, HasAtMostItsViewersAndAPlaceIsFreeAfterOneLeaves) {
  const auto subscribers = empty_subscribers();
  std::vector<std::unique_ptr<Joined>> all;
  for (int i = 0; i < kViewerShare.in_all; ++i)
    all.push_back(std::make_unique<Joined>(subscribers));
  auto refused = Subscribers::join(subscribers, {"admin", true}, {}, [] {});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kBusy);
  all.pop_back();
  EXPECT_TRUE(Subscribers::join(subscribers, {"admin", true}, {}, [] {}).ok());
}

TEST(Subscribers, AViewerIsCompleteWhenTheScanHasEndedAndAllIsSent) {
  const auto subscribers = empty_subscribers();
  subscribers->show_model(model({chunk(0, 1)}));
  Joined joined(subscribers);
  take_all(*joined.viewer);
  EXPECT_FALSE(joined.viewer->complete());
  subscribers->show_state({wire::ScanPhase::kFinished, "", 1, 1, 0});
  subscribers->close();
  EXPECT_FALSE(joined.viewer->complete()) << "the last state is not sent yet";
  take_all(*joined.viewer);
  EXPECT_TRUE(joined.viewer->complete());
}

}  // namespace
}  // namespace hermite::server
