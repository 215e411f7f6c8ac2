// Ended scans and the memory that is taken to show them.
#include "server/scan/shown_scans.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>

#include "server/store/chunk_file.h"
#include "server/store/file_blobs.h"
#include "server/store/scan_id.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server::shown_scans_test {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kMost_bytes = 10'000;

class ShownScansTest : public testing::Test {
 protected:
  // Returns the id of an ended scan with about so many bytes of points.
  std::string add_scan(std::size_t bytes) {
    ScanRow row;
    row.id = new_scan_id();
    row.phase = ScanPhase::kFinished;
    rows_[row.id] = row;
    StoredChunks stored;
    stored.submaps.push_back({0, Rigid3{}});
    stored.chunks.emplace_back();
    stored.chunks.back().point_count = 1;
    stored.chunks.back().draco.assign(bytes, 'x');
    EXPECT_TRUE(blobs_.put(row.id, kChunksName, format_chunk_file(stored)).ok());
    return row.id;
  }
  Result<ScanRow> find(const std::string& id) const {
    const auto found = rows_.find(id);
    if (found == rows_.end()) return Error{ErrorCode::kNotFound, "there is no scan " + id};
    return found->second;
  }
  void run_posted() {
    while (!posted_.empty()) {
      const auto next = std::move(posted_.front());
      posted_.pop_front();
      next();
    }
  }
  // Watches as a viewer does, which waits until the files are read.
  Result<std::shared_ptr<Subscribers>> watched(const std::string& id) {
    Result<std::shared_ptr<Subscribers>> result = shown_.watch(id);
    if (!result.ok() || *result) return result;
    shown_.when_shown(id, [&] { result = shown_.watch(id); });
    run_posted();
    return result;
  }

  const test::TemporaryFolder folder_;
  FileBlobs blobs_{folder_.path()};
  std::map<std::string, ScanRow> rows_;
  std::deque<std::function<void()>> posted_;
  const LogReaders::Post post_ = [this](std::function<void()> work) {
    posted_.push_back(std::move(work));
  };
  ShownScans shown_{
      blobs_, {post_, post_}, [this](const std::string& id) { return find(id); }, kMost_bytes};
};

TEST_F(ShownScansTest, IsReadOnceForAllWhoLook) {
  const std::string id = add_scan(100);
  std::vector<std::shared_ptr<Subscribers>> seen;
  for (int viewer = 0; viewer < 3; ++viewer) {
    ASSERT_EQ(*shown_.watch(id), nullptr);
    shown_.when_shown(id, [&] { seen.push_back(*shown_.watch(id)); });
  }
  const ShownScans::Ticket gone =
      shown_.when_shown(id, [] { ADD_FAILURE() << "it has been cancelled"; });
  shown_.cancel(gone);
  EXPECT_EQ(posted_.size(), 1u);
  run_posted();
  ASSERT_EQ(seen.size(), 3u);
  EXPECT_TRUE(seen[0] && seen[0] == seen[1] && seen[1] == seen[2]);
  EXPECT_EQ(seen[0]->info().scan_id, id);
}

TEST_F(ShownScansTest, WhatDoesNotFitBesideOthersWaitsUntilTheyAreLookedAtNoMore) {
  const std::string first = add_scan(6000), second = add_scan(6000), small = add_scan(1000);
  auto looking = watched(first);
  ASSERT_TRUE(looking.ok() && *looking);
  const auto refused = watched(second);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kBusy);
  EXPECT_THAT(refused.error().message, HasSubstr("do not fit into memory"));
  EXPECT_TRUE(watched(small).ok());
  EXPECT_TRUE(watched(first).ok()) << "it is there already";
  *looking = nullptr;
  EXPECT_TRUE(watched(second).ok());
}

TEST_F(ShownScansTest, AScanThatIsLargerThanTheLimitIsShownAlone) {
  const std::string large = add_scan(3 * kMost_bytes), small = add_scan(100);
  {
    const auto looking = watched(large);
    ASSERT_TRUE(looking.ok() && *looking);
    EXPECT_FALSE(watched(small).ok());
  }
  EXPECT_TRUE(watched(small).ok());
}

TEST_F(ShownScansTest, OneThatIsRemovedWhileItIsReadTakesNothing) {
  const std::string gone = add_scan(9000), other = add_scan(9000);
  ASSERT_EQ(*shown_.watch(gone), nullptr);
  bool is_told = false;
  shown_.when_shown(gone, [&] {
    is_told = true;
    EXPECT_EQ(shown_.watch(gone).error().code, ErrorCode::kNotFound);
  });
  rows_.erase(gone);
  run_posted();
  EXPECT_TRUE(is_told);
  EXPECT_TRUE(watched(other).ok());
}

TEST_F(ShownScansTest, AScanWithoutFilesHasOnlyItsState) {
  ScanRow row;
  row.id = new_scan_id();
  row.phase = ScanPhase::kFailed;
  rows_[row.id] = row;
  const auto shown = watched(row.id);
  ASSERT_TRUE(shown.ok() && *shown);
  rows_[row.id].phase = ScanPhase::kRunning;
  shown_.forget(row.id);
  EXPECT_EQ(shown_.watch(row.id).error().code, ErrorCode::kBusy) << "it is not resumed yet";
}

TEST_F(ShownScansTest, WhoeverShowsAScanMayGoFirst) {
  const std::string id = add_scan(100);
  std::shared_ptr<Subscribers> kept;
  {
    ShownScans brief(
        blobs_, {post_, post_}, [this](const std::string& wanted) { return find(wanted); },
        kMost_bytes);
    ASSERT_EQ(*brief.watch(id), nullptr);
    brief.when_shown(id, [&] { kept = *brief.watch(id); });
    run_posted();
  }
  ASSERT_TRUE(kept);
  kept = nullptr;
}

}  // namespace
}  // namespace hermite::server::shown_scans_test
