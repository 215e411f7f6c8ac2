#include "server/scan/live_mesher.h"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <variant>

#include "proto/wire/server_message.h"

namespace hermite::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// A square of 20 cm around (0.16, 0.16, 0.16), within one cube of cells of a centimetre.
LiveMesher::Model square(std::uint32_t first_slot = 0, float x_m = 0) {
  LiveMesher::Model model;
  for (int i = 0; i < 400; ++i) {
    output::CloudPoint point;
    point.position_m = {x_m + 0.06f + 0.01f * static_cast<float>(i % 20),
                        0.06f + 0.01f * static_cast<float>(i / 20), 0.16f};
    point.normal = -Eigen::Vector3f::UnitZ();
    point.confidence = 5;
    model.changes.push_back({first_slot + static_cast<std::uint32_t>(i), true, point});
  }
  model.submaps = {mesh::PlacedSubmap{}};
  model.since = LiveMesher::Clock::now();
  return model;
}

// What a mesher told, and when.
class Told {
 public:
  std::function<void(MeshUpdate)> tell() {
    return [this](MeshUpdate update) {
      const std::lock_guard lock(mutex_);
      updates_.push_back(std::move(update));
      changed_.notify_all();
    };
  }
  bool wait_for(std::size_t count, milliseconds patience = seconds(60)) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, patience, [&] { return updates_.size() >= count; });
  }
  std::vector<MeshUpdate> updates() {
    const std::lock_guard lock(mutex_);
    return updates_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<MeshUpdate> updates_;
};

wire::MeshChunk chunk_of(const MeshUpdate& update) {
  return std::get<wire::MeshChunk>(*wire::parse_server_message(*update.pieces.at(0).message));
}

TEST(LiveMesher, TellsEachPieceWithItsVersionAndDelay) {
  Told told;
  LiveMesher mesher(told.tell());
  mesher.add(square());
  ASSERT_TRUE(told.wait_for(1));
  mesher.add(square(1000, 0.96f));
  ASSERT_TRUE(told.wait_for(2));
  const std::vector<MeshUpdate> updates = told.updates();
  const wire::MeshChunk first = chunk_of(updates[0]), second = chunk_of(updates[1]);
  EXPECT_GT(first.triangle_count, 400u);
  EXPECT_FALSE(first.draco.empty());
  EXPECT_NE(first.cube, second.cube);
  EXPECT_LT(first.version, second.version);
  EXPECT_GT(updates[0].delay.count(), 0);
  EXPECT_FALSE(updates[0].ended);
}

TEST(LiveMesher, ContoursNothingWhileItIsPausedAndWhatHasChangedAfterwards) {
  Told told;
  LiveMesher mesher(told.tell());
  mesher.pause(true);
  mesher.add(square());
  EXPECT_FALSE(told.wait_for(1, milliseconds(300)));
  mesher.pause(false);
  EXPECT_TRUE(told.wait_for(1));
}

TEST(LiveMesher, WaitsForEnoughSurfelsToChooseItsCells) {
  Told told;
  LiveMesher mesher(told.tell());
  LiveMesher::Model first = square(), second = first;
  first.changes.resize(100);
  mesher.add(first);
  EXPECT_FALSE(told.wait_for(1, milliseconds(300)));
  second.changes.erase(second.changes.begin(), second.changes.begin() + 100);
  mesher.add(second);
  ASSERT_TRUE(told.wait_for(1));
  EXPECT_GT(chunk_of(told.updates()[0]).triangle_count, 400u) << "of both";
}

TEST(LiveMesher, OfAMapThatIsTooLargeAllPiecesGo) {
  Told told;
  LiveMesher mesher(told.tell(), 700);
  mesher.add(square());
  ASSERT_TRUE(told.wait_for(1));
  mesher.add(square(1000, 0.96f));
  ASSERT_TRUE(told.wait_for(2));
  const MeshUpdate last = told.updates()[1];
  EXPECT_TRUE(last.ended);
  ASSERT_EQ(last.pieces.size(), 1u);
  EXPECT_EQ(chunk_of(last).triangle_count, 0u);
  EXPECT_TRUE(last.pieces[0].empty);
  mesher.add(square(2000));
  EXPECT_FALSE(told.wait_for(3, milliseconds(300)));
}

}  // namespace
}  // namespace hermite::server
