#include "core/dataset/read_frame.h"
#include "core/source/open_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::dataset::read_frame_test {
namespace {

// Five frames of black; the third has no colour that can be decoded, the fourth is missing.
class Damaged final : public Sequence {
 public:
  Damaged() : good_(*source::open_sequence("synthetic:frames=5,width=64,height=64")) {}
  std::string format() const override { return "damaged"; }
  std::string name() const override { return "damaged"; }
  const Camera& camera() const override { return good_->camera(); }
  double frame_rate_hz() const override { return 30; }
  std::int64_t frame_count() const override { return 5; }
  double timestamp_s(std::int64_t index) const override { return good_->timestamp_s(index); }
  const Trajectory& groundtruth() const override { return good_->groundtruth(); }
  Result<RecordedFrame> read(std::int64_t index) const override {
    if (index == 3) return Error{ErrorCode::kIo, "the file is missing"};
    Result<RecordedFrame> frame = good_->read(index);
    if (index == 2 && frame.ok()) frame->color_bytes.resize(10);
    return frame;
  }

 private:
  std::unique_ptr<Sequence> good_;
};

TEST(ReadFrame, GivesAnEmptyFrameForOneThatCannotBeRead) {
  const Damaged sequence;
  for (std::int64_t index = 1; index < 5; ++index) {
    const ReadFrame read = read_frame(sequence, index);
    EXPECT_EQ(read.index, index);
    EXPECT_EQ(read.frame.timestamp_s, sequence.timestamp_s(index));
    EXPECT_EQ(read.frame.depth.width, 64);
    EXPECT_EQ(read.frame.color.height, 64);
    EXPECT_EQ(read.problem.empty(), index == 1 || index == 4);
    EXPECT_EQ(read.frame.depth == DepthImage(64, 64), index == 2 || index == 3)
        << "unreadable frames are empty ones";
  }
}

TEST(ReadFrame, SaysWhatWasWrong) {
  EXPECT_THAT(read_frame(Damaged(), 3).problem, testing::HasSubstr("missing"));
}

}  // namespace
}  // namespace hermite::dataset::read_frame_test
