#include "server/scan/scan_end.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/store/file_blobs.h"
#include "server/store/scan_id.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

using testing::HasSubstr;

TEST(ScanEnd, WithoutItsResultsAScanIsInterruptedAndNothingOfThemIsLeft) {
  const test::TemporaryFolder folder;
  FileBlobs blobs(folder.path());
  const std::string id = new_scan_id();
  ASSERT_TRUE(blobs.put(id, "report.json", "half of them").ok());
  const ScanEnd end = not_stored(blobs, id, Error{ErrorCode::kIo, "the disk is full"},
                                 {ErrorCode::kIo, "No space left on device"});
  EXPECT_EQ(end.phase, wire::ScanPhase::kInterrupted);
  EXPECT_TRUE(end.results_missing);
  EXPECT_THAT(end.message,
              HasSubstr("the disk is full; its results cannot be stored: No space left on device"));
  EXPECT_TRUE(blobs.list(id)->empty());
  EXPECT_EQ(not_stored(blobs, id, std::nullopt, {ErrorCode::kIo, "x"}).error.message,
            "its results cannot be stored: x");
}

}  // namespace
}  // namespace hermite::server
