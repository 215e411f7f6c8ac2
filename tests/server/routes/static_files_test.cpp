#include "server/routes/static_files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace hermite::server {
namespace {

void write(const std::string& path, const std::string& bytes) {
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(StaticFiles, AreReadByTheirUrlPath) {
  const test::TemporaryFolder folder;
  write(folder / "web/index.html", "<html>");
  write(folder / "web/assets/index-abc.js", "code");
  write(folder / "web/draco.wasm", std::string("\0asm", 4));
  const auto files = read_static_files(folder / "web");
  ASSERT_TRUE(files.ok()) << files.error().message;
  EXPECT_EQ(files->size(), 4u);
  EXPECT_EQ(files->at("/").bytes, "<html>");
  EXPECT_EQ(files->at("/").content_type, "text/html; charset=utf-8");
  EXPECT_FALSE(files->at("/").immutable);
  EXPECT_EQ(files->at("/assets/index-abc.js").content_type, "text/javascript; charset=utf-8");
  EXPECT_TRUE(files->at("/assets/index-abc.js").immutable);
  EXPECT_EQ(files->at("/draco.wasm").content_type, "application/wasm");
  EXPECT_EQ(files->at("/draco.wasm").bytes.size(), 4u);
}

TEST(StaticFiles, LinksAndOddNamesAreLeftOut) {
  const test::TemporaryFolder folder;
  write(folder / "secret", "s");
  write(folder / "web/index.html", "<html>");
  write(folder / "web/odd name", "x");
  std::filesystem::create_symlink(folder / "secret", folder / "web/link.txt");
  const auto files = read_static_files(folder / "web");
  ASSERT_TRUE(files.ok());
  EXPECT_EQ(files->size(), 2u);
}

TEST(StaticFiles, AFolderWithoutAnIndexIsAnError) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(read_static_files(folder / "none").error().code, ErrorCode::kNotFound);
  write(folder / "web/other.html", "x");
  EXPECT_EQ(read_static_files(folder / "web").error().code, ErrorCode::kNotFound);
}

TEST(StaticFiles, UnknownEndingsAreBytes) {
  EXPECT_EQ(content_type_of("file"), "application/octet-stream");
  EXPECT_EQ(content_type_of("js"), "application/octet-stream");
  EXPECT_EQ(content_type_of("a.html.exe"), "application/octet-stream");
}

}  // namespace
}  // namespace hermite::server
