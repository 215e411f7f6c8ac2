#include "core/archive/zip.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/archive/unpack.h"
#include "tests/support/temporary_folder.h"

namespace hermite::archive {
namespace {

TEST(Zip, ComesApartIntoWhatWentIn) {
  const ZipEntries entries{
      {"mesh.obj", "v 0 0 0\n"}, {"empty", ""}, {"images/0.jpg", std::string(300'000, '\0')}};
  const Result<std::string> zip = format_zip(entries);
  ASSERT_TRUE(zip.ok()) << zip.error().message;
  const test::TemporaryFolder folder;
  std::ofstream(folder / "a.zip", std::ios::binary) << *zip;
  const Result<UnpackSummary> unpacked = unpack_archive(folder / "a.zip", folder / "out");
  ASSERT_TRUE(unpacked.ok()) << unpacked.error().message;
  EXPECT_EQ(unpacked->kind, "zip");
  EXPECT_EQ(unpacked->file_count, 3);
  for (const auto& [name, bytes] : entries) {
    std::ifstream file(folder / ("out/" + name), std::ios::binary);
    EXPECT_EQ((std::string{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()}),
              bytes)
        << name;
  }
}

TEST(Zip, TheSameFilesGiveTheSameBytes) {
  const ZipEntries entries{{"a", "1"}, {"b", "2"}};
  EXPECT_EQ(*format_zip(entries), *format_zip(entries));
  EXPECT_NE(*format_zip(entries), *format_zip({{"a", "1"}, {"b", "3"}}));
}

}  // namespace
}  // namespace hermite::archive
