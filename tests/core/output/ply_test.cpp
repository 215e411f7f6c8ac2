#include "core/output/ply.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>
#include <vector>

namespace hermite::output {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
namespace fs = std::filesystem;

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

template <class T>
T take(const std::string& bytes, std::size_t& at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  at += sizeof(T);
  return value;
}

CloudPoint some_point() {
  CloudPoint point;
  point.position_m = {1.5f, -2.25f, 3.125f};
  point.normal = {0, 0.6f, -0.8f};
  point.color = {10, 20, 255};
  point.confidence = 12.5f;
  point.curvature_max_per_m = 40;
  point.curvature_min_per_m = -3;
  point.radius_m = 0.004f;
  point.submap = 70000;
  return point;
}

// A folder of its own that goes away with the test.
class Ply : public ::testing::Test {
 protected:
  Ply() : folder_(fs::temp_directory_path() / ("hermite-ply-" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~Ply() override { fs::remove_all(folder_); }
  std::vector<std::string> names() const {
    std::vector<std::string> result;
    for (const auto& entry : fs::directory_iterator(folder_))
      result.push_back(entry.path().filename());
    return result;
  }
  const fs::path folder_;
};

TEST_F(Ply, HeaderNamesThePropertiesInOrder) {
  const std::string bytes = format_ply({some_point()});
  EXPECT_THAT(bytes, StartsWith("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_THAT(bytes, HasSubstr("element vertex 1\n"
                               "property float x\nproperty float y\nproperty float z\n"
                               "property float nx\nproperty float ny\nproperty float nz\n"
                               "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                               "property float confidence\nproperty float curvature_max\nproperty "
                               "float curvature_min\nproperty float radius\n"
                               "property uint submap\nend_header\n"));
}

TEST_F(Ply, VerticesHoldTheValues) {
  const CloudPoint point = some_point();
  const std::string bytes = format_ply({CloudPoint(), point});
  const std::size_t begin = bytes.find("end_header\n") + 11;
  ASSERT_EQ(bytes.size(), begin + 2 * 47);
  std::size_t at = begin + 47;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(take<float>(bytes, at), point.position_m[i]);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(take<float>(bytes, at), point.normal[i]);
  EXPECT_EQ(take<std::uint8_t>(bytes, at), 10);
  EXPECT_EQ(take<std::uint8_t>(bytes, at), 20);
  EXPECT_EQ(take<std::uint8_t>(bytes, at), 255);
  EXPECT_EQ(take<float>(bytes, at), 12.5f);
  EXPECT_EQ(take<float>(bytes, at), 40.0f);
  EXPECT_EQ(take<float>(bytes, at), -3.0f);
  EXPECT_EQ(take<float>(bytes, at), 0.004f);
  EXPECT_EQ(take<std::uint32_t>(bytes, at), 70000u);
}

TEST_F(Ply, AnEmptyCloudIsAFileToo) {
  EXPECT_THAT(format_ply({}), HasSubstr("element vertex 0\n"));
  EXPECT_TRUE(format_ply({}).ends_with("end_header\n"));
}

TEST_F(Ply, WritesAndReplacesLeavingNothingElse) {
  const std::string path = folder_ / "cloud.ply";
  ASSERT_TRUE(write_file_atomically(path, std::string("one\0two", 7)).ok());
  EXPECT_EQ(read_file(path), std::string("one\0two", 7));
  const std::string large(5'000'000, 'x');
  ASSERT_TRUE(write_file_atomically(path, large).ok());
  EXPECT_EQ(read_file(path), large);
  EXPECT_THAT(names(), ::testing::ElementsAre("cloud.ply"));
}

TEST_F(Ply, ObeysTheUmask) {
  const std::string path = folder_ / "cloud.ply";
  const mode_t before = ::umask(027);
  EXPECT_TRUE(write_file_atomically(path, "x").ok());
  ::umask(before);
  struct stat status {};
  ASSERT_EQ(::stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0640u);
}

TEST_F(Ply, SaysWhyItCannotWrite) {
  const Status missing = write_file_atomically(folder_ / "no" / "such" / "cloud.ply", "x");
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, ErrorCode::kIo);
  EXPECT_THAT(missing.error().message, HasSubstr("No such file or directory"));
  EXPECT_THAT(missing.error().message, HasSubstr("no/such/cloud.ply"));

  fs::create_directory(folder_ / "taken");
  const Status taken = write_file_atomically(folder_ / "taken", "x");
  ASSERT_FALSE(taken.ok());
  EXPECT_EQ(taken.error().code, ErrorCode::kIo);
  EXPECT_THAT(taken.error().message, HasSubstr("Is a directory"));
  EXPECT_THAT(names(), ::testing::ElementsAre("taken"));
}

TEST_F(Ply, AWriteThatFailsHalfwayLeavesTheOldFile) {
  const std::string path = folder_ / "cloud.ply";
  ASSERT_TRUE(write_file_atomically(path, "old").ok());
  struct rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const struct rlimit small { 4096, before.rlim_max };
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const Status halfway = write_file_atomically(path, std::string(100'000, 'x'));
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, old_handler);
  ASSERT_FALSE(halfway.ok());
  EXPECT_EQ(halfway.error().code, ErrorCode::kIo);
  EXPECT_THAT(halfway.error().message, HasSubstr("File too large"));
  EXPECT_EQ(read_file(path), "old");
  EXPECT_THAT(names(), ::testing::ElementsAre("cloud.ply"));
}

TEST_F(Ply, ManyWritersOfOneFileLeaveOneWholeFile) {
  const std::string path = folder_ / "cloud.ply";
  std::vector<std::thread> writers;
  for (int writer = 0; writer < 4; ++writer) {
    writers.emplace_back([&path, writer] {
      for (int round = 0; round < 20; ++round) {
        EXPECT_TRUE(
            write_file_atomically(path, std::string(20'000, static_cast<char>('a' + writer))).ok());
      }
    });
  }
  for (std::thread& writer : writers) writer.join();
  const std::string last = read_file(path);
  ASSERT_EQ(last.size(), 20'000u);
  EXPECT_EQ(last, std::string(20'000, last[0]));
  EXPECT_THAT(names(), ::testing::ElementsAre("cloud.ply"));
}

}  // namespace
}  // namespace hermite::output
