#include "core/disturb/disturbance.h"
#include "core/source/open_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace hermite::disturb {
namespace {

using testing::HasSubstr;

const std::string kSource = "synthetic:frames=20,width=80,height=64,scene=bare";

std::unique_ptr<dataset::Sequence> open(const std::string& suffixes) {
  auto opened = source::open_sequence(kSource + suffixes);
  EXPECT_TRUE(opened.ok()) << (opened.ok() ? "" : opened.error().message);
  return opened.ok() ? std::move(*opened) : nullptr;
}

std::string error_of(const std::string& suffixes) {
  const auto opened = source::open_sequence(kSource + suffixes);
  return opened.ok() ? "opened" : opened.error().message;
}

TEST(Disturbance, CoveredFramesAreDarkAndWithoutDepth) {
  const auto clean = open(""), covered = open("+covered=5:3");
  EXPECT_EQ(covered->frame_count(), 20);
  EXPECT_EQ(covered->name(), clean->name());
  for (std::int64_t i = 0; i < 20; ++i) {
    auto frame = covered->read(i);
    ASSERT_TRUE(frame.ok());
    EXPECT_EQ(frame->timestamp_s, clean->timestamp_s(i));
    if (i < 5 || i >= 8) {
      EXPECT_EQ(frame->color_bytes, clean->read(i)->color_bytes) << i;
      EXPECT_EQ(frame->depth, clean->read(i)->depth) << i;
      continue;
    }
    EXPECT_EQ(frame->depth, DepthImage(80, 64));
    const auto decoded = dataset::decode_frame(std::move(*frame));
    ASSERT_TRUE(decoded.ok()) << decoded.error().message;
    for (const Rgb8& pixel : decoded->color.pixels)
      ASSERT_LT(std::max({pixel.r, pixel.g, pixel.b}), 60);
  }
}

TEST(Disturbance, MissingFramesLeaveAGapInTimeAndTheGroundTruthWhole) {
  const auto clean = open(""), gap = open("+missing=5:3");
  ASSERT_EQ(gap->frame_count(), 17);
  EXPECT_EQ(gap->timestamp_s(4), clean->timestamp_s(4));
  EXPECT_EQ(gap->timestamp_s(5), clean->timestamp_s(8));
  EXPECT_EQ(gap->read(5)->depth, clean->read(8)->depth);
  EXPECT_EQ(gap->read(5)->timestamp_s, gap->timestamp_s(5));
  EXPECT_EQ(gap->read(16)->color_bytes, clean->read(19)->color_bytes);
  EXPECT_EQ(gap->groundtruth().size(), 20u);
}

TEST(Disturbance, SuffixesApplyFromLeftToRight) {
  const auto both = open("+noise=kinect,seed=3+missing=0:4+covered=1:1");
  ASSERT_EQ(both->frame_count(), 16);
  EXPECT_EQ(both->timestamp_s(1), 5 / 30.0);
  EXPECT_EQ(both->read(1)->depth, DepthImage(80, 64)) << "frame 1 of what the gap left";
  EXPECT_EQ(both->read(2)->depth, open("+noise=kinect,seed=3")->read(6)->depth);
  EXPECT_NE(both->read(2)->depth, open("")->read(6)->depth);
}

TEST(Disturbance, WholeBeginningAndEndMayGo) {
  EXPECT_EQ(open("+missing=0:19")->timestamp_s(0), 19 / 30.0);
  EXPECT_EQ(open("+missing=1:19")->frame_count(), 1);
  EXPECT_EQ(open("+covered=0:20")->frame_count(), 20);
}

TEST(Disturbance, NonsenseIsAnErrorWithAMessage) {
  for (const char* text : {"", "5", "5:", ":3", "-1:3", "5:0", "5:-2", "a:b", "5:3:1", "5:3x",
                           " 5:3", "99999999999999999999:1"}) {
    EXPECT_THAT(error_of(std::string("+covered=") + text), HasSubstr("is no FROM:COUNT")) << text;
    EXPECT_THAT(error_of(std::string("+missing=") + text), HasSubstr("is no FROM:COUNT")) << text;
  }
  for (const char* text : {"20:1", "18:3", "0:21", "1:9223372036854775807",
                           "9223372036854775807:9223372036854775807"}) {
    EXPECT_THAT(error_of(std::string("+covered=") + text),
                HasSubstr("leave the sequence, which has 20"))
        << text;
    EXPECT_THAT(error_of(std::string("+missing=") + text),
                HasSubstr("leave the sequence, which has 20"))
        << text;
  }
  EXPECT_THAT(error_of("+missing=0:20"), HasSubstr("no frame would be left"));
  EXPECT_THAT(error_of("+missing=0:15+covered=6:1"), HasSubstr("which has 5"));
}

TEST(Disturbance, AsManySuffixesAsAnyoneNeeds) {
  std::string suffixes;
  for (int i = 0; i < 16; ++i) suffixes += "+covered=0:1";
  EXPECT_EQ(error_of(suffixes), "opened");
  EXPECT_THAT(error_of(suffixes + "+covered=0:1"), HasSubstr("more than 16"));
}

}  // namespace
}  // namespace hermite::disturb
