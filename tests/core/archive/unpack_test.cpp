#include "core/archive/unpack.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/archive/fresh_folder.h"
#include "core/archive/zip_directory.h"
#include "tests/core/dataset/temp_folder.h"
#include "tests/support/archive_bytes.h"
#include "tests/support/file_bytes.h"
#include "tests/support/memory_peak.h"

namespace hermite::archive {
namespace {

namespace fs = std::filesystem;
using test::ArchiveEntry;
using testing::HasSubstr;

const std::vector<ArchiveEntry> kTwoFiles{{"scan/rgb/1.png", "colour"},
                                          {"scan/depth.txt", std::string(100'000, 'd')}};

class Unpack : public testing::Test {
 protected:
  Result<UnpackSummary> unpack(const std::string& bytes, const UnpackLimits& limits = {}) {
    folder.write("archive", bytes);
    return unpack_archive(folder.path("archive"), folder.path("out"), limits);
  }
  // Of an archive that must be refused: with nothing left behind, in the folder or beside it.
  std::string refusal(const std::string& bytes, const UnpackLimits& limits = {}) {
    const auto summary = unpack(bytes, limits);
    if (summary.ok()) return "unpacked";
    EXPECT_TRUE(!fs::exists(folder.path("out")) || fs::is_empty(folder.path("out")))
        << summary.error().message;
    for (const auto& entry : fs::directory_iterator(folder.path()))
      EXPECT_TRUE(entry.path().filename() == "out" || entry.path().filename() == "archive")
          << entry.path();
    return summary.error().message;
  }

  const dataset::TempFolder folder;
};

TEST_F(Unpack, EveryKindGivesTheSameFiles) {
  const std::string tar = test::tar_bytes(kTwoFiles);
  const std::vector<std::pair<std::string, std::string>> archives{
      {"tar", tar},
      {"tar.gz", test::gzip_bytes(tar)},
      {"tar.zst", test::zstd_bytes(tar)},
      {"zip", test::zip_bytes(kTwoFiles)}};
  for (const auto& [kind, bytes] : archives) {
    folder.write("archive", bytes);
    EXPECT_TRUE(is_archive(folder.path("archive")));
    const auto summary = unpack_archive(folder.path("archive"), folder.path(kind));
    ASSERT_TRUE(summary.ok()) << kind << ": " << summary.error().message;
    EXPECT_EQ(summary->kind, kind);
    EXPECT_EQ(summary->file_count, 2);
    EXPECT_EQ(summary->output_bytes, 100'006u);
    EXPECT_EQ(test::file_bytes(folder.path(kind + "/scan/rgb/1.png")).size(), 6u);
    EXPECT_EQ(test::file_bytes(folder.path(kind + "/scan/depth.txt")).size(), 100'000u);
  }
}

TEST_F(Unpack, NamesThatLeadOutAreRefused) {
  for (const char* name : {"../evil", "/tmp/evil", "a/../../evil", "a\\evil"}) {
    EXPECT_THAT(refusal(test::tar_bytes({{"good", "x"}, {name, "y"}})), HasSubstr("the name \""))
        << name;
    // libarchive takes a backslash in a zip for a slash: inside the folder it does no harm.
    if (name != std::string("a\\evil")) {
      EXPECT_THAT(refusal(test::zip_bytes({{"good", "x"}, {name, "y"}})), HasSubstr("the name \""))
          << name;
    }
  }
}

TEST_F(Unpack, OnlyRegularFilesAreUnpacked) {
  const std::pair<char, const char*> types[] = {{'1', "hard link"},
                                                {'2', "symbolic link"},
                                                {'3', "character device"},
                                                {'4', "block device"},
                                                {'6', "FIFO"}};
  for (const auto& [type, reason] : types) {
    const std::string message =
        refusal(test::tar_bytes({{"good", "x"}, {"bad", "", type, "good"}}));
    EXPECT_THAT(message, HasSubstr(reason));
    EXPECT_THAT(message, HasSubstr("\"bad\""));
  }
  EXPECT_THAT(refusal(test::zip_bytes({{"bad", "/etc/passwd", '0', "", std::nullopt, 0120777}})),
              HasSubstr("symbolic link"));
  // A link first and a file through it behind: the link is where it ends.
  EXPECT_THAT(refusal(test::tar_bytes({{"d", "", '2', "/tmp"}, {"d/evil", "x"}})),
              HasSubstr("symbolic link"));
}

TEST_F(Unpack, TwoOfANameAreRefused) {
  EXPECT_THAT(refusal(test::tar_bytes({{"a", "x"}, {"./a", "y"}})), HasSubstr("two of this name"));
  EXPECT_THAT(refusal(test::tar_bytes({{"a", "x"}, {"a/b", "y"}})),
              HasSubstr("a file and a folder"));
}

TEST_F(Unpack, ArchivesInsideAreRefused) {
  const std::string inner = test::tar_bytes(kTwoFiles);
  for (const std::string& bytes : {inner, test::gzip_bytes(inner), test::zstd_bytes(inner),
                                   test::zip_bytes(kTwoFiles), std::string("BZh91AY")})
    EXPECT_THAT(refusal(test::tar_bytes({{"inner.bin", bytes}})), HasSubstr("inside the archive"));
  EXPECT_THAT(refusal(test::gzip_bytes(test::gzip_bytes(inner))),
              HasSubstr("compressed more than once"));
}

TEST_F(Unpack, BombsEndAtTheLimitWhateverHeadersSay) {
  const std::string zeros(20 << 20, '\0');
  UnpackLimits limits;
  limits.output_bytes = 1 << 20;
  for (const std::string& bytes :
       {test::zstd_bytes(test::tar_bytes({{"a", zeros}})), test::zip_bytes({{"a", zeros}}),
        test::zip_bytes({{"a", zeros, '0', "", 10}})})
    EXPECT_NE(refusal(bytes, limits), "unpacked");
  UnpackLimits by_ratio;
  by_ratio.ratio_free_bytes = 1 << 20;
  EXPECT_THAT(refusal(test::zstd_bytes(test::tar_bytes({{"a", zeros}})), by_ratio),
              HasSubstr("200 times"));
  // Many small files are as large as one.
  std::vector<ArchiveEntry> many;
  for (int i = 0; i < 200; ++i) many.push_back({std::to_string(i), std::string(10'000, '\0')});
  EXPECT_THAT(refusal(test::zstd_bytes(test::tar_bytes(many)), limits),
              HasSubstr("more than 1048576 bytes"));
}

TEST_F(Unpack, WhatHasNoRoomNowIsBusyAndWhatIsRefusedIsNot) {
  UnpackLimits limits;
  limits.room_bytes = 50'000;
  limits.capacity_bytes = 1'000'000;
  for (const std::string& bytes :
       {test::tar_bytes(kTwoFiles), test::zstd_bytes(test::tar_bytes(kTwoFiles)),
        test::zip_bytes(kTwoFiles)}) {
    EXPECT_EQ(unpack(bytes, limits).error().code, ErrorCode::kBusy);
    EXPECT_THAT(refusal(bytes, limits),
                HasSubstr("unpacked it has 0 MB, the disk has room for 0 MB now"));
  }
  std::vector<ArchiveEntry> bad = kTwoFiles;
  bad.push_back({"../out", "x"});
  EXPECT_EQ(unpack(test::tar_bytes(bad), limits).error().code, ErrorCode::kInvalidArgument)
      << "behind what there is no room for, too";
  const std::string large = test::zstd_bytes(test::tar_bytes({{"a", std::string(1'000'001, 'a')}}));
  EXPECT_EQ(unpack(large, limits).error().code, ErrorCode::kTooLarge);
  EXPECT_THAT(refusal(large, limits),
              HasSubstr("more than 1 MB, all that the disk could have room for"));
  limits.room_bytes = 100'006;
  EXPECT_TRUE(unpack(test::tar_bytes(kTwoFiles), limits).ok())
      << "exactly as much as there is room for";
}

TEST_F(Unpack, FilesAndFoldersThatTheDiskHasNoInodesForAreBusyOrTooMany) {
  const std::vector<ArchiveEntry> deep = {{"a/b/c", "x"}, {"d", "y"}};
  UnpackLimits limits;
  limits.room_inodes = 3;
  for (const std::string& bytes : {test::tar_bytes(deep), test::zip_bytes(deep)}) {
    EXPECT_EQ(unpack(bytes, limits).error().code, ErrorCode::kBusy);
    EXPECT_THAT(refusal(bytes, limits),
                HasSubstr("up to 4 files and folders, the disk has room for 3 (inodes) now"));
  }
  limits.capacity_inodes = 1;
  EXPECT_EQ(unpack(test::tar_bytes(deep), limits).error().code, ErrorCode::kTooLarge);
  limits.room_inodes = limits.capacity_inodes = 4;
  EXPECT_TRUE(unpack(test::tar_bytes(deep), limits).ok());
}

TEST_F(Unpack, RoomThatOthersTakeMeanwhileIsMissed) {
  std::vector<ArchiveEntry> many;
  for (int i = 0; i < 1000; ++i) many.push_back({std::to_string(i), "x"});
  for (const std::string& bytes :
       {test::tar_bytes(many), test::tar_bytes({{"a", std::string(20 << 20, 'a')}})}) {
    int asked = 0, room_for = 2;
    UnpackLimits limits;
    limits.has_room_left = [&] { return ++asked <= room_for; };
    const auto refused = unpack(bytes, limits);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, ErrorCode::kBusy);
    EXPECT_THAT(refused.error().message, HasSubstr("others have taken some"));
    EXPECT_EQ(asked, 3) << "once there is none, none is asked for";
    room_for = 1000;
    EXPECT_TRUE(unpack(bytes, limits).ok());
    EXPECT_LT(asked, 30);
    fs::remove_all(folder.path("out"));
  }
}

TEST_F(Unpack, SizesThatLieAreErrors) {
  EXPECT_NE(refusal(test::tar_bytes({{"a", "x", '0', "", std::uint64_t{1} << 32}})), "unpacked")
      << "says more than there is";
  EXPECT_NE(refusal(test::tar_bytes({{"a", std::string(3000, 'x'), '0', "", 10}})), "unpacked")
      << "says less";
  EXPECT_NE(refusal(test::zip_bytes({{"a", std::string(3000, 'x'), '0', "", 10}})), "unpacked");
}

TEST_F(Unpack, AMillionEntriesAreRefusedInBoundedMemory) {
  // The same folder again and again, which alone would be allowed.
  std::string thousand;
  for (int i = 0; i < 1000; ++i) thousand += test::tar_header({"d", "", '5'});
  std::string packed;
  ZSTD_CCtx* context = ZSTD_createCCtx();
  std::string block(ZSTD_compressBound(thousand.size()), '\0');
  for (int i = 0; i < 1000; ++i)  // frames one behind the other are one stream
    packed.append(block.data(), ZSTD_compressCCtx(context, block.data(), block.size(),
                                                  thousand.data(), thousand.size(), 1));
  ZSTD_freeCCtx(context);
  folder.write("archive", packed);
  std::string message;
  const std::size_t peak = test::peak_growth_bytes([&] {
    message = unpack_archive(folder.path("archive"), folder.path("out")).error().message;
  });
  EXPECT_THAT(message, HasSubstr("more than 200000 entries"));
  // The headers alone are 512 MB; sanitizers keep some of what was freed.
  EXPECT_LT(peak, std::size_t{128} << 20);

  std::string directory;
  const std::string entry =
      "PK\1\2" + std::string(24, '\0') + test::little(1, 2) + std::string(16, '\0') + "d";
  for (int i = 0; i < 1'000'000; ++i) directory += entry;
  const std::string end = "PK\5\6" + std::string(8, '\0') + test::little(directory.size(), 4) +
                          test::little(4, 4) + test::little(0, 2);
  folder.write("archive", "PK\3\4" + directory + end);
  EXPECT_THAT(unpack_archive(folder.path("archive"), folder.path("out")).error().message,
              HasSubstr("entries, allowed are 200000"));
}

TEST_F(Unpack, CutAndDamagedArchivesAreErrors) {
  const std::string tar = test::tar_bytes(kTwoFiles);
  for (const std::string& whole :
       {tar, test::gzip_bytes(tar), test::zstd_bytes(tar), test::zip_bytes(kTwoFiles)})
    for (std::size_t part = 1; part < 20; ++part) {
      const std::string cut = whole.substr(0, whole.size() * part / 20);
      // The last blocks of a tar are zeros.
      if (whole == tar && cut.size() >= tar.size() - 1024) continue;
      EXPECT_NE(refusal(cut), "unpacked") << part;
    }
}

TEST_F(Unpack, FoldersThatAreNotFreshAreLeftAlone) {
  folder.write("out/mine", "keep");
  EXPECT_THAT(unpack(test::tar_bytes(kTwoFiles)).error().message, HasSubstr("is not empty"));
  EXPECT_TRUE(fs::exists(folder.path("out/mine")));
  fs::create_directory_symlink(folder.path("out"), folder.path("link"));
  EXPECT_FALSE(FreshFolder::open(folder.path("link")).ok());
}

TEST_F(Unpack, WhatIsNoArchiveIsSaid) {
  EXPECT_EQ(unpack("no archive at all").error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(unpack_archive(folder.path("nowhere"), folder.path("out")).error().code,
            ErrorCode::kNotFound);
  EXPECT_FALSE(is_archive(folder.path()));
  EXPECT_FALSE(is_archive("/dev/null"));
  EXPECT_NE(
      refusal(test::gzip_bytes("a text, not a tar, but long enough for a header of 512 bytes" +
                               std::string(600, 'x'))),
      "unpacked");
}

}  // namespace
}  // namespace hermite::archive
