#include "core/base/sync_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temporary_folder.h"

namespace hermite {
namespace {

// What it is worth is seen by tests/every_call/power_cut_test.cpp.
TEST(SyncPath, TakesFilesAndFoldersAndNamesWhatIsNotThere) {
  const test::TemporaryFolder folder;
  { std::ofstream(folder / "file") << "x"; }
  EXPECT_TRUE(sync_path(folder / "file").ok());
  EXPECT_TRUE(sync_path(folder.path()).ok());
  const Status missing = sync_path(folder / "none");
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, ErrorCode::kIo);
  EXPECT_THAT(missing.error().message, testing::HasSubstr(folder / "none: No such file"));
}

}  // namespace
}  // namespace hermite
