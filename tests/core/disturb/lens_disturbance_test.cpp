#include "core/disturb/lens_disturbance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "core/dataset/sequence.h"
#include "core/math/depth_between.h"
#include "core/source/open_sequence.h"

namespace hermite::disturb::lens_disturbance_test {
namespace {

using testing::HasSubstr;

const std::string kSource = "synthetic:scene=bare,frames=4,width=160,height=120";

frame::RgbdFrame frame_of(const std::string& suffix) {
  return *dataset::decode_frame(*(*source::open_sequence(kSource + suffix))->read(2));
}

TEST(LensDisturbance, IsUndoneByACameraThatStatesIt) {
  const frame::RgbdFrame straight = frame_of("");
  for (const double k1 : {-0.08, 0.08}) {
    const auto lens = *source::open_sequence(kSource + "+lens=k1=" + std::to_string(k1));
    EXPECT_EQ(lens->camera(), (*source::open_sequence(kSource))->camera()) << "it is not stated";
    Camera stated = lens->camera();
    stated.distortion.k1 = k1;
    const DepthImage distorted = dataset::decode_frame(*lens->read(2))->depth;
    int changed_count = 0, off_count = 0;
    for (int y = 0; y < distorted.height; ++y)
      for (int x = 0; x < distorted.width; ++x) {
        const int before = straight.depth.at(x, y);
        changed_count += std::abs(distorted.at(x, y) - before) > 10;
        const Eigen::Vector2d at_px = stated.distort(x, y);
        const int undone = depth_between(distorted, at_px.x(), at_px.y());
        off_count += undone > 0 && std::abs(undone - before) > 10;
      }
    // 2 mm; corners of the room are displaced by up to a pixel.
    EXPECT_GT(changed_count, 5000) << k1;
    EXPECT_LT(off_count, 800) << k1;
  }
}

TEST(LensDisturbance, LeavesTheMiddleWhereItIs) {
  const frame::RgbdFrame straight = frame_of(""), distorted = frame_of("+lens");
  EXPECT_NEAR(distorted.depth.at(80, 60), straight.depth.at(80, 60), 5);
  EXPECT_EQ(distorted.depth.at(0, 0), 0) << "a barrel shows more than there is";
  EXPECT_NE(distorted.color.at(0, 0), Rgb8{});
}

TEST(LensDisturbance, NonsenseIsAnErrorWithAMessage) {
  const auto error_of = [](const std::string& suffix) {
    const auto opened = source::open_sequence(kSource + suffix);
    return opened.ok() ? "opened" : opened.error().message;
  };
  EXPECT_THAT(error_of("+lens=k1=0.5"), HasSubstr("lens: option k1 is \"0.5\""));
  EXPECT_THAT(error_of("+lens=k3=0"), HasSubstr("lens: there is no option \"k3\""));
}

}  // namespace
}  // namespace hermite::disturb::lens_disturbance_test
