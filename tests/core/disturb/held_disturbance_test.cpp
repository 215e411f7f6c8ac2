#include "core/disturb/held_disturbance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/source/open_sequence.h"

namespace hermite::disturb::held_disturbance_test {
namespace {

using testing::HasSubstr;

const std::string kRoom = "synthetic:frames=20,rate=10,width=96,height=72";

std::unique_ptr<dataset::Sequence> room(const std::string& held) {
  return *source::open_sequence(kRoom + held);
}

std::string refusal(const std::string& held) {
  return source::open_sequence(kRoom + held).error().message;
}

// Where a pixel of a frame lies in the world.
Eigen::Vector3d in_world(const dataset::Sequence& sequence, std::int64_t index, int x, int y) {
  const Camera& camera = sequence.camera();
  const double depth_m = sequence.read(index)->depth.at(x, y) / camera.depth_units_per_metre;
  const Eigen::Vector3d ray((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1);
  return sequence.groundtruth()[static_cast<std::size_t>(index)].world_from_camera *
         Eigen::Vector3d(depth_m * ray);
}

TEST(HeldDisturbance, ATurnedCameraSeesTheSamePlaces) {
  const auto plain = room("");
  const frame::RgbdFrame own = *dataset::decode_frame(*plain->read(3));
  struct Turn {
    int deg, width, x, y;  // where pixel (20, 10) goes
  };
  for (const Turn& turn : {Turn{90, 72, 10, 75}, Turn{180, 96, 75, 61}, Turn{270, 72, 61, 20}}) {
    SCOPED_TRACE(turn.deg);
    const auto turned = room("+turned=deg=" + std::to_string(turn.deg));
    EXPECT_EQ(turned->camera().width, turn.width);
    const frame::RgbdFrame frame = *dataset::decode_frame(*turned->read(3));
    EXPECT_EQ(frame.depth.at(turn.x, turn.y), own.depth.at(20, 10));
    EXPECT_NEAR(frame.color.at(turn.x, turn.y).g, own.color.at(20, 10).g, 40);
    EXPECT_LT((in_world(*turned, 3, turn.x, turn.y) - in_world(*plain, 3, 20, 10)).norm(), 1e-9);
  }
}

TEST(HeldDisturbance, AnAccelerometerFeelsWhatHoldsIt) {
  const auto still = room("+accelerometer=noise_m_s2=0,bias_m_s2=0");
  Eigen::Vector3d mean_in_world = Eigen::Vector3d::Zero();
  for (std::int64_t i = 0; i < 20; ++i) {
    const auto& pose = still->groundtruth()[static_cast<std::size_t>(i)].world_from_camera;
    mean_in_world += pose.rotation * *still->read(i)->acceleration_m_s2 / 20;
  }
  EXPECT_LT((mean_in_world - Eigen::Vector3d(0, 0, 9.80665)).norm(), 0.5) << mean_in_world;
  // The same with a bias that the seed directs; a turned camera feels it about its own axes.
  const Eigen::Vector3d
      felt = *still->read(4)->acceleration_m_s2,
      biased = *room("+accelerometer=noise_m_s2=0,bias_m_s2=0.4")->read(4)->acceleration_m_s2,
      noisy = *room("+accelerometer=noise_m_s2=1,bias_m_s2=0")->read(4)->acceleration_m_s2,
      turned = *room("+turned+accelerometer=noise_m_s2=0,bias_m_s2=0")->read(4)->acceleration_m_s2;
  EXPECT_NEAR((biased - felt).norm(), 0.4, 1e-9);
  EXPECT_GT((noisy - felt).norm(), 0.1);
  EXPECT_LT((turned - Eigen::Vector3d(felt.y(), -felt.x(), felt.z())).norm(), 1e-9);
  const auto turned_afterwards = room("+accelerometer=noise_m_s2=0,bias_m_s2=0+turned");
  EXPECT_LT((turned - *turned_afterwards->read(4)->acceleration_m_s2).norm(), 1e-9);
}

TEST(HeldDisturbance, NonsenseIsAnErrorWithAMessage) {
  EXPECT_THAT(refusal("+turned=deg=45"), HasSubstr("turned: option deg is \"45\""));
  const Camera bent{96, 72, 80, 80, 47, 36, 5000, {.k1 = 0.1}};
  EXPECT_THAT(source::open_sequence(kRoom + "+turned", bent).error().message,
              HasSubstr("turned: the camera has a distortion"));
  EXPECT_THAT(refusal("+accelerometer=noise_m_s2=11"),
              HasSubstr("accelerometer: option noise_m_s2"));
  EXPECT_THAT(refusal("+accelerometer=bias_m_s2=nan"),
              HasSubstr("accelerometer: option bias_m_s2"));
}

}  // namespace
}  // namespace hermite::disturb::held_disturbance_test
