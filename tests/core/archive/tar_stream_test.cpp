#include "core/archive/tar_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/archive/unpack.h"
#include "tests/support/temporary_folder.h"

namespace hermite::archive {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class TarStreamTest : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) {
    const fs::path path = folder_ / ("room/" + name);
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << text;
  }
  std::string all(const TarStream& tar) { return *tar.read(0, tar.size_bytes()); }
  const test::TemporaryFolder folder_;
};

TEST_F(TarStreamTest, UnpacksToTheSameFiles) {
  write("rgb/2.png", std::string(1000, 'b'));
  write("rgb/1.png", std::string(512, 'a'));
  write("empty", "");
  fs::create_symlink("/etc/passwd", folder_ / "room/link");
  const Result<TarStream> tar = TarStream::open(folder_ / "room/");
  ASSERT_TRUE(tar.ok()) << tar.error().message;
  EXPECT_EQ(tar->file_count(), 3);
  const std::string bytes = all(*tar);
  EXPECT_EQ(bytes.size(), static_cast<std::size_t>(tar->size_bytes()));
  std::ofstream(folder_ / "packed", std::ios::binary) << bytes;
  const Result<UnpackSummary> unpacked = unpack_archive(folder_ / "packed", folder_ / "out");
  ASSERT_TRUE(unpacked.ok()) << unpacked.error().message;
  EXPECT_EQ(unpacked->file_count, 3);
  EXPECT_EQ(fs::file_size(folder_ / "out/room/rgb/2.png"), 1000u);
  EXPECT_EQ(fs::file_size(folder_ / "out/room/empty"), 0u);
  EXPECT_FALSE(fs::exists(folder_ / "out/room/link"));
}

TEST_F(TarStreamTest, AnyPartIsThatPartOfTheWhole) {
  write("a", std::string(700, 'a'));
  write("b", std::string(1, 'b'));
  write("c/d", std::string(3000, 'd'));
  const TarStream tar = *TarStream::open(folder_ / "room");
  const std::string whole = all(tar);
  for (const std::int64_t step : {1, 511, 512, 513, 4096})
    for (std::int64_t offset = 0; offset < tar.size_bytes(); offset += step)
      ASSERT_EQ(*tar.read(offset, step),
                whole.substr(static_cast<std::size_t>(offset), static_cast<std::size_t>(step)))
          << offset;
  EXPECT_EQ(tar.read(tar.size_bytes(), 10)->size(), 0u);
}

TEST_F(TarStreamTest, TimesMakeNoDifferenceToTheBytesButToTheFingerprint) {
  write("a", "a");
  const TarStream before = *TarStream::open(folder_ / "room");
  fs::last_write_time(folder_ / "room/a",
                      fs::last_write_time(folder_ / "room/a") + std::chrono::hours(1));
  const TarStream after = *TarStream::open(folder_ / "room");
  EXPECT_EQ(all(before), all(after));
  EXPECT_NE(before.fingerprint(), after.fingerprint());
}

TEST_F(TarStreamTest, AFileThatChangesMeanwhileIsAnError) {
  write("a", "a");
  const TarStream tar = *TarStream::open(folder_ / "room");
  write("a", "longer");
  const Result<std::string> bytes = tar.read(0, tar.size_bytes());
  ASSERT_FALSE(bytes.ok());
  EXPECT_THAT(bytes.error().message, HasSubstr("has changed"));
}

TEST_F(TarStreamTest, LongNamesAreSplitOrRefused) {
  const std::string part(90, 'x');
  write(part + "/" + part, "a");
  ASSERT_TRUE(TarStream::open(folder_ / "room").ok());
  write(std::string(150, 'y'), "a");
  const Result<TarStream> tar = TarStream::open(folder_ / "room");
  ASSERT_FALSE(tar.ok());
  EXPECT_THAT(tar.error().message, HasSubstr("too long for a tar"));
}

TEST_F(TarStreamTest, WhatIsNoFolderIsNotFound) {
  EXPECT_EQ(TarStream::open(folder_ / "none").error().code, ErrorCode::kNotFound);
  write("a", "a");
  EXPECT_EQ(TarStream::open(folder_ / "room/a").error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace hermite::archive
