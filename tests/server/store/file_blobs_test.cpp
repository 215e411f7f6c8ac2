#include "server/store/file_blobs.h"

#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <memory>

#include "tests/server/store/blobs_contract.h"
#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

namespace fs = std::filesystem;

class FileWorld {
 public:
  static constexpr bool kHidesWhatIsReplaced = false;
  Blobs& blobs() { return *blobs_; }
  void die() { blobs_ = std::make_unique<FileBlobs>(folder_.path()); }

 private:
  const test::TemporaryFolder folder_;
  std::unique_ptr<Blobs> blobs_ = std::make_unique<FileBlobs>(folder_.path());
};

class FileBlobsTest : public testing::Test {
 protected:
  const test::TemporaryFolder folder_;
  const std::string scan_ = new_scan_id();
  FileBlobs blobs_{folder_.path()};
};

TEST_F(FileBlobsTest, LeavesTheFrameLogAndWhatIsHalfWrittenAlone) {
  ASSERT_TRUE(blobs_.put(scan_, "cloud.ply", "x").ok());
  const fs::path folder = fs::path(folder_.path()) / scan_;
  fs::create_directory(folder / "log");
  std::ofstream(folder / "log/segment-0000.rlog") << "frames";
  std::ofstream(folder / "cloud.ply.7-1.tmp") << "half of a cl";  // of a process that died
  EXPECT_EQ(blobs_.list(scan_)->size(), 1u);
  ASSERT_TRUE(blobs_.remove(scan_).ok());
  EXPECT_FALSE(fs::exists(folder / "cloud.ply"));
  EXPECT_TRUE(fs::exists(folder / "log/segment-0000.rlog"));
}

TEST_F(FileBlobsTest, FollowsNoLinkAndWaitsForNoPipe) {
  ASSERT_TRUE(blobs_.put(scan_, "cloud.ply", "x").ok());
  const fs::path folder = fs::path(folder_.path()) / scan_;
  fs::create_symlink("/etc/passwd", folder / "link");
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  for (const char* name : {"link", "pipe"}) {
    EXPECT_EQ(blobs_.read(scan_, name, 0, 100).error().code, ErrorCode::kNotFound) << name;
    EXPECT_EQ(blobs_.size_bytes(scan_, name).error().code, ErrorCode::kNotFound) << name;
  }
  EXPECT_EQ(blobs_.list(scan_)->size(), 1u);
}

TEST_F(FileBlobsTest, SaysWhyItCannotBePut) {
  FileBlobs nowhere(folder_ / "gone");
  const Status status = nowhere.put(scan_, "a", "x");
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, ErrorCode::kIo);
  EXPECT_THAT(status.error().message, testing::HasSubstr("gone"));
}

TEST(BlobName, HasNoWayOutOfItsFolder) {
  for (const char* name : {"cloud.ply", "a", "chunks.bin", "mesh-2_lod.glb"})
    EXPECT_TRUE(is_blob_name(name)) << name;
  for (const char* name :
       {"", ".", "..", "../a", "a/b", ".hidden", "A", "a b", "-rf", "0", "a.tmp", "a\n"})
    EXPECT_FALSE(is_blob_name(name)) << name;
  EXPECT_TRUE(is_blob_name(std::string(64, 'a')));
  EXPECT_FALSE(is_blob_name(std::string(65, 'a')));
  EXPECT_FALSE(is_blob_name(std::string("a\0b", 3)));
}

TEST(FileBlobsDeathTest, AnIdOrNameThatIsNoneIsAMistake) {
  const test::TemporaryFolder folder;
  FileBlobs blobs(folder.path());
  EXPECT_DEATH(static_cast<void>(blobs.size_bytes("../../etc", "passwd")), "no scan id");
  EXPECT_DEATH(static_cast<void>(blobs.size_bytes(new_scan_id(), "../x")), "no name of a blob");
}

}  // namespace

}  // namespace hermite::server

namespace hermite::test {
INSTANTIATE_TYPED_TEST_SUITE_P(Files, BlobsContract, server::FileWorld);
}  // namespace hermite::test
