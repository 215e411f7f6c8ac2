#include "server/disk/waste.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <utility>
#include <vector>

#include "server/store/data_directory.h"
#include "server/store/scan_id.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

namespace fs = std::filesystem;

// The background is a queue that the test empties as it likes.
class WasteTest : public testing::Test {
 protected:
  Waste make() {
    return {data_.set_aside(),
            [this](std::function<void()> action) { background_.push_back(std::move(action)); }};
  }
  std::string scan() {
    const std::string id = new_scan_id();
    EXPECT_TRUE(data_.create_scan_folder(id).ok());
    fs::create_directory(data_.log_folder(id));
    std::ofstream(data_.log_folder(id) + "/segment-0000.rlog") << std::string(1000, 'x');
    return id;
  }
  void run_background() {
    for (const std::function<void()>& action : std::exchange(background_, {})) action();
  }

  const test::TemporaryFolder folder_;
  const DataDirectory data_{folder_ / "data"};
  std::vector<std::function<void()>> background_;
};

TEST_F(WasteTest, WhatIsRemovedIsOutOfTheWayBeforeTheDiskHasDoneAnything) {
  Waste waste = make();
  const std::string id = scan();
  std::ofstream(data_.upload_path(id)) << "bytes";
  ASSERT_TRUE(waste.remove_scan(id).ok());
  ASSERT_TRUE(waste.remove_upload(id).ok());
  EXPECT_FALSE(fs::exists(data_.scan_folder(id)));
  EXPECT_FALSE(fs::exists(data_.upload_path(id)));
  EXPECT_EQ(data_.set_aside().waste().size(), 2u) << "the slow part is still to come";
  EXPECT_TRUE(data_.create_scan_folder(id).ok()) << "a scan that is begun anew keeps its id";
  run_background();
  EXPECT_TRUE(data_.set_aside().waste().empty());
  EXPECT_TRUE(fs::exists(data_.scan_folder(id))) << "the new one is another";
}

TEST_F(WasteTest, WhatIsNotThereIsNoError) {
  Waste waste = make();
  EXPECT_TRUE(waste.remove_scan(new_scan_id()).ok());
  EXPECT_TRUE(waste.remove_upload(new_scan_id()).ok());
  EXPECT_TRUE(background_.empty());
}

TEST_F(WasteTest, AServerThatDiedInBetweenLeavesItToTheNext) {
  const std::string id = scan();
  {
    Waste waste = make();
    ASSERT_TRUE(waste.remove_scan(id).ok());
    background_.clear();
  }
  ASSERT_EQ(data_.set_aside().waste().size(), 1u);
  const Waste next = make();
  run_background();
  EXPECT_TRUE(data_.set_aside().waste().empty());
}

TEST_F(WasteTest, WhatCannotBeRemovedStaysWhereItIs) {
  Waste waste = make();
  const std::string id = scan();
  fs::remove(folder_ / "data/waste");
  std::ofstream(folder_ / "data/waste") << "in the way";
  const Status status = waste.remove_scan(id);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, ErrorCode::kIo);
  EXPECT_TRUE(fs::exists(data_.log_folder(id)));
}

}  // namespace
}  // namespace hermite::server
