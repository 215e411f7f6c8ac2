#include "core/dataset/recorded_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/dataset/temp_folder.h"

namespace hermite::dataset {
namespace {

using testing::ElementsAre;

TEST(RecordedFolder, NamesThatLeaveTheFolderAreRecognised) {
  for (const char* name : {"rgb/1.png", "1.png", "./rgb/1.png", "rgb/..png", "a..b/c"})
    EXPECT_TRUE(stays_inside(name)) << name;
  for (const char* name :
       {"", "/etc/passwd", "../1.png", "rgb/../../1.png", "rgb/..", "..", "rgb\\..\\1.png"})
    EXPECT_FALSE(stays_inside(name)) << name;
  EXPECT_FALSE(stays_inside(std::string_view("rgb/1.png\0x", 11)));
}

TEST(RecordedFolder, ListsFilesNotFoldersInOrder) {
  const TempFolder folder;
  folder.write("b.txt", "");
  folder.write("a.txt", "");
  folder.write("c/d.txt", "");
  EXPECT_THAT(*file_names(folder.path()), ElementsAre("a.txt", "b.txt"));
  EXPECT_EQ(file_names(folder.path("nowhere")).error().code, ErrorCode::kNotFound);
}

TEST(RecordedFolder, PairsHaveTheDepthsTimeAndAscend) {
  const auto frames = pair_by_time({{0.07, "c2"}, {0.00, "c0"}, {0.04, "c1"}},
                                   {{0.035, "d1"}, {0.001, "d0"}, {0.5, "d9"}});
  ASSERT_TRUE(frames.ok());
  ASSERT_EQ(frames->size(), 2u);
  EXPECT_EQ((*frames)[0].timestamp_s, 0.001);
  EXPECT_EQ((*frames)[0].color, "c0");
  EXPECT_EQ((*frames)[1].timestamp_s, 0.035);
  EXPECT_EQ((*frames)[1].color, "c1");
  EXPECT_EQ((*frames)[1].depth, "d1");
}

TEST(RecordedFolder, OfTwoImagesWithOneTimeTheLaterLineCounts) {
  const auto frames = pair_by_time({{0.0, "old"}, {0.0, "new"}}, {{0.0, "d_old"}, {0.0, "d_new"}});
  ASSERT_TRUE(frames.ok());
  ASSERT_EQ(frames->size(), 1u);
  EXPECT_EQ((*frames)[0].color, "new");
  EXPECT_EQ((*frames)[0].depth, "d_new");
}

}  // namespace
}  // namespace hermite::dataset
