#include "server/disk/storage.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "server/store/file_blobs.h"
#include "server/store/scan_id.h"
#include "server/store/store.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

TEST(Storage, AScansFilesGoWithAllThatCounted) {
  const test::TemporaryFolder folder;
  const DataDirectory data(folder / "data");
  Store store(data.database_path());
  FileBlobs blobs(data.scans_folder());
  const std::string id = new_scan_id(), other = new_scan_id();
  for (const std::string& scan : {id, other})
    ASSERT_TRUE(blobs.put(scan, "cloud.ply", std::string(60, 'x')).ok());
  const auto later = [](const std::function<void()>&) {};
  Waste waste(data.set_aside(), later);
  StorageQuota quota(120, [&data] { return data.scan_sizes(); }, {later, later});
  const Storage storage{data, store, blobs, waste, quota};
  EXPECT_FALSE(quota.check(0, 60).ok());
  ASSERT_TRUE(remove_files_of_scan(storage, id).ok());
  EXPECT_TRUE(quota.check(0, 60).ok());
  EXPECT_TRUE(blobs.list(id)->empty());
  EXPECT_EQ(blobs.list(other)->size(), 1u);
  EXPECT_TRUE(remove_files_of_scan(storage, id).ok()) << "there are none";
}

}  // namespace
}  // namespace hermite::server
