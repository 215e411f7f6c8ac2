#include "server/client/depth_codec_choice.h"

#include <gtest/gtest.h>

#include <random>

namespace hermite::client {
namespace {

using wire::DepthCodec;
using Codecs = std::vector<DepthCodec>;

TEST(BestFirst, IsTheSmallestWithinTheBudgetThenTheFastest) {
  const std::vector<DepthCodecTrial> trials{
      {DepthCodec::kRvlZstd, 900, 2}, {DepthCodec::kPng16, 700, 25}, {DepthCodec::kRanks, 400, 4}};
  EXPECT_EQ(best_first(trials, 10),
            (Codecs{DepthCodec::kRanks, DepthCodec::kRvlZstd, DepthCodec::kPng16}));
  EXPECT_EQ(best_first(trials, 30),
            (Codecs{DepthCodec::kRanks, DepthCodec::kPng16, DepthCodec::kRvlZstd}));
  EXPECT_EQ(best_first(trials, 3),
            (Codecs{DepthCodec::kRvlZstd, DepthCodec::kRanks, DepthCodec::kPng16}));
  EXPECT_EQ(best_first(trials, 1),
            (Codecs{DepthCodec::kRvlZstd, DepthCodec::kRanks, DepthCodec::kPng16}));
}

TEST(BestFirst, WithoutMeasurementsKeepsTheirOrder) {
  EXPECT_EQ(best_first(try_depth_codecs({}), 10),
            Codecs(wire::kDepthCodecs.begin(), wire::kDepthCodecs.end()));
}

// Walls whose depths are `step_mm` apart, with noise of a step; frame 5 of 9 cannot be read.
class Walls final : public dataset::Sequence {
 public:
  explicit Walls(int step_mm) : step_mm_(step_mm) {}
  std::string format() const override { return "test"; }
  std::string name() const override { return "walls"; }
  const Camera& camera() const override { return camera_; }
  double frame_rate_hz() const override { return rate_hz; }
  std::int64_t frame_count() const override { return 9; }
  double timestamp_s(std::int64_t index) const override { return static_cast<double>(index); }
  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    if (index == 4) return Error{ErrorCode::kIo, "no such file"};
    dataset::RecordedFrame frame{timestamp_s(index), DepthImage(camera_.width, camera_.height), {}};
    std::mt19937 random(static_cast<unsigned>(index));
    for (std::size_t i = 0; i < frame.depth.pixels.size(); ++i)
      frame.depth.pixels[i] = static_cast<std::uint16_t>((100 + i % 160 / 40 * 30 + random() % 2) *
                                                         static_cast<unsigned>(step_mm_));
    return frame;
  }
  const dataset::Trajectory& groundtruth() const override { return groundtruth_; }

  double rate_hz = 1;  // a budget of 333 ms, which every codec keeps on any machine

 private:
  Camera camera_{160, 120, 150, 150, 79.5, 59.5, 1000};
  dataset::Trajectory groundtruth_;
  int step_mm_;
};

TEST(DepthCodecsFor, TakesRanksForASensorOfFewDepths) {
  const auto codecs = depth_codecs_for(Walls(20), {0, 9});
  EXPECT_EQ(codecs.size(), wire::kDepthCodecs.size());
  EXPECT_EQ(codecs.front(), DepthCodec::kRanks);
}

TEST(DepthCodecsFor, FramesThatCannotBeReadSayNothing) {
  EXPECT_EQ(depth_codecs_for(Walls(20), {4, 5}),
            Codecs(wire::kDepthCodecs.begin(), wire::kDepthCodecs.end()));
  EXPECT_EQ(depth_codecs_for(Walls(20), {4, 4}),
            Codecs(wire::kDepthCodecs.begin(), wire::kDepthCodecs.end()));
}

}  // namespace
}  // namespace hermite::client
