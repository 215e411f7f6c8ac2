#include "server/store/set_aside_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "server/store/scan_id.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server::set_aside_files_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

class SetAsideFilesTest : public testing::Test {
 protected:
  SetAsideFilesTest() {
    for (const char* name : {"scans", "uploads", "waste", "lost/scans", "lost/uploads"})
      fs::create_directories(folder_ / name);
    fs::create_directory(folder_ / "scans/" + id_);
    std::ofstream(folder_ / "scans/" + id_ + "/cloud.ply") << "points";
    std::ofstream(folder_ / "uploads/" + id_) << "half of it";
  }

  const test::TemporaryFolder folder_;
  const std::string id_ = new_scan_id();
  const SetAsideFiles files_{folder_.path()};
};

TEST_F(SetAsideFilesTest, WhatIsDiscardedFreesItsIdAndIsDeletedLater) {
  const Result<std::string> name = files_.discard_scan(id_);
  ASSERT_TRUE(name.ok());
  EXPECT_FALSE(fs::exists(folder_ / "scans/" + id_));
  EXPECT_THAT(files_.waste(), ElementsAre(*name));
  EXPECT_TRUE(files_.remove_waste(*name).ok());
  EXPECT_THAT(files_.waste(), IsEmpty());
  EXPECT_EQ(*files_.discard_scan(id_), "") << "there is nothing any more";
  EXPECT_NE(*files_.discard_upload(id_), "");
  EXPECT_EQ(*files_.discard_jobs(), "");
}

TEST_F(SetAsideFilesTest, WhatIsLostStaysForItsTime) {
  ASSERT_TRUE(files_.lose_scan(id_, 1'000'000).ok());
  ASSERT_TRUE(files_.lose_upload(id_, 2'000'000).ok());
  EXPECT_TRUE(fs::exists(folder_ / "lost/scans/" + id_ + "/cloud.ply"));
  EXPECT_THAT(files_.discard_lost(1'000'000), IsEmpty());
  EXPECT_THAT(files_.discard_lost(1'500'000), ElementsAre("lost/scans/" + id_));
  EXPECT_TRUE(fs::exists(folder_ / "lost/uploads/" + id_));
  EXPECT_EQ(files_.waste().size(), 1u);
}

TEST_F(SetAsideFilesTest, NothingIsLostOverWhatWasLostBefore) {
  ASSERT_TRUE(files_.lose_upload(id_, 1'000'000).ok());
  std::ofstream(folder_ / "uploads/" + id_) << "another one";
  const Status again = files_.lose_upload(id_, 1'000'000);
  ASSERT_FALSE(again.ok());
  EXPECT_EQ(again.error().code, ErrorCode::kIo);
  EXPECT_TRUE(fs::exists(folder_ / "uploads/" + id_));
}

using SetAsideFilesDeathTest = SetAsideFilesTest;
TEST_F(SetAsideFilesDeathTest, NoPathIsMadeFromAnythingButAnId) {
  EXPECT_DEATH((void)files_.discard_scan("../../etc"), "no scan id");
  EXPECT_DEATH((void)files_.remove_waste(".."), "no name of waste");
}

}  // namespace
}  // namespace hermite::server::set_aside_files_test
