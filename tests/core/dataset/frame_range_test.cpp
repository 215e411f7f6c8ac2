#include "core/dataset/frame_range.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::dataset {
namespace {

TEST(FrameRange, IsHalfOpenAndEitherEndMayBeMissing) {
  EXPECT_EQ(*parse_frame_range("2:5", 10), (FrameRange{2, 5}));
  EXPECT_EQ(parse_frame_range("2:5", 10)->count(), 3);
  EXPECT_EQ(*parse_frame_range("7:", 10), (FrameRange{7, 10}));
  EXPECT_EQ(*parse_frame_range(":4", 10), (FrameRange{0, 4}));
  EXPECT_EQ(*parse_frame_range(":", 10), (FrameRange{0, 10}));
  EXPECT_EQ(*parse_frame_range("", 10), (FrameRange{0, 10}));
}

TEST(FrameRange, AnEndBeyondTheSequenceIsTheSequencesEnd) {
  EXPECT_EQ(*parse_frame_range("8:100", 10), (FrameRange{8, 10}));
}

TEST(FrameRange, NonsenseIsRefusedNamingTheTextAndTheCount) {
  for (const char* text :
       {"5", "a:b", "1:2:3", "-1:4", "1:-1", " 1:2", "1.5:3", "99999999999999999999:", "0x1:3"}) {
    const auto range = parse_frame_range(text, 10);
    ASSERT_FALSE(range.ok()) << text;
    EXPECT_EQ(range.error().code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(range.error().message, testing::HasSubstr(text));
    EXPECT_THAT(range.error().message, testing::HasSubstr("10 frames"));
  }
}

TEST(FrameRange, ARangeWithoutAFrameIsRefused) {
  for (const char* text : {"5:5", "6:5", "10:", "20:30", ":0"})
    EXPECT_FALSE(parse_frame_range(text, 10).ok()) << text;
  EXPECT_FALSE(parse_frame_range("", 0).ok());
  EXPECT_FALSE(parse_frame_range(":", 0).ok());
}

}  // namespace
}  // namespace hermite::dataset
