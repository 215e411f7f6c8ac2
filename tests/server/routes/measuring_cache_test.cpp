#include "server/routes/measuring_cache.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/output/ply.h"
#include "server/store/file_blobs.h"
#include "server/store/scan_id.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/two_walls.h"

namespace hermite::server {
namespace measuring_cache_test {

class MeasuringCacheTest : public testing::Test {
 protected:
  MeasuringCacheTest() {
    for (const std::string& id : ids_) put(id, test::two_walls());
  }
  void put(const std::string& id, const output::Cloud& cloud) {
    EXPECT_TRUE(blobs_.put(id, "surfels.ply", output::format_ply(cloud)).ok());
    EXPECT_TRUE(blobs_.put(id, "trajectory.txt", "0.0 0 0 0 0 0 0 1\n").ok());
    EXPECT_TRUE(blobs_.put(id, "report.json", "{}").ok());
  }
  std::shared_ptr<const measure::MeasuredResult> of(const std::string& id) {
    return or_throw(cache_.of(blobs_, id, "surfels.ply"));
  }
  static std::size_t count_of(const measure::MeasuredResult& result) {
    std::size_t count = 0;
    EXPECT_TRUE(result.each_point([&](const output::CloudPoint&) { ++count; }).ok());
    return count;
  }

  const test::TemporaryFolder folder_;
  FileBlobs blobs_{folder_.path()};
  MeasuringCache cache_;
  const std::vector<std::string> ids_ = {new_scan_id(), new_scan_id(), new_scan_id(), new_scan_id(),
                                         new_scan_id()};
};

TEST_F(MeasuringCacheTest, AScanIsReadOnceUntilItsFilesArePutAgain) {
  const auto first = of(ids_[0]);
  EXPECT_EQ(count_of(*first), test::two_walls().size());
  EXPECT_EQ(of(ids_[0]), first);
  EXPECT_EQ(cache_.kept_bytes(), test::two_walls().size() * sizeof(output::CloudPoint));
  output::Cloud half = test::two_walls();
  half.resize(half.size() / 2);
  put(ids_[0], half);
  const auto second = of(ids_[0]);
  EXPECT_NE(second, first);
  EXPECT_EQ(count_of(*second), half.size());
  EXPECT_EQ(count_of(*first), test::two_walls().size()) << "who still has it goes on";
  EXPECT_EQ(cache_.kept_bytes(), half.size() * sizeof(output::CloudPoint))
      << "of a scan there is one";
}

TEST_F(MeasuringCacheTest, OnlyTheLastUsedScansAreKept) {
  const std::uint64_t one_bytes = test::two_walls().size() * sizeof(output::CloudPoint);
  const auto first = of(ids_[0]), second = of(ids_[1]);
  EXPECT_EQ(of(ids_[0]), first);
  for (std::size_t i = 2; i < ids_.size(); ++i) of(ids_[i]);
  EXPECT_EQ(cache_.kept_bytes(), MeasuringCache::kMostScans * one_bytes);
  EXPECT_EQ(of(ids_[0]), first) << "it was used after the second";
  EXPECT_NE(of(ids_[1]), second);
}

TEST_F(MeasuringCacheTest, WhatIsGoneIsNotAnswered) {
  of(ids_[0]);
  cache_.forget(ids_[0]);
  EXPECT_EQ(cache_.kept_bytes(), 0u);
  of(ids_[0]);
  ASSERT_TRUE(blobs_.remove(ids_[0]).ok());
  EXPECT_EQ(cache_.of(blobs_, ids_[0], "surfels.ply").error().code, ErrorCode::kNotFound);
}

TEST_F(MeasuringCacheTest, OfATooLargeScanNothingIsKeptAndItIsReadEachTime) {
  MeasuringCache small(test::two_walls().size() * sizeof(output::CloudPoint) - 1);
  const auto result = or_throw(small.of(blobs_, ids_[0], "surfels.ply"));
  EXPECT_EQ(count_of(*result), test::two_walls().size());
  EXPECT_EQ(small.kept_bytes(), 0u);
}

}  // namespace measuring_cache_test
}  // namespace hermite::server
