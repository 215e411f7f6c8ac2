#include "core/track/lens_shading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace hermite::track::lens_shading_test {
namespace {

constexpr shared::Intrinsics kCamera{65.6f, 65.6f, 39.5f, 29.5f, 80, 60};

// A wall 2 m away with an image of soft spots, as a lens shows it whose corners are as dark as
// `corner`.
frame::CoarseView wall(const Rigid3& world_from_camera, double corner, double exposure = 1) {
  frame::CoarseView view{kCamera, std::vector<float>(4800), std::vector<Eigen::Vector3f>(4800),
                         std::vector<float>(4800)};
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) {
      const Eigen::Vector3d ray((x - 39.5) / 65.6, (y - 29.5) / 65.6, 1);
      const Eigen::Vector3d direction = world_from_camera.rotation * ray;
      const double depth_m = (2 - world_from_camera.translation.z()) / direction.z();
      const Eigen::Vector3d point = world_from_camera * (depth_m * ray);
      const double squared =
          ((x - 39.5) * (x - 39.5) + (y - 29.5) * (y - 29.5)) / (39.5 * 39.5 + 29.5 * 29.5);
      const double grey = 120 + 30 * std::sin(2.1 * point.x()) * std::cos(1.7 * point.y());
      const std::size_t i = view.index(x, y);
      view.depth_m[i] = static_cast<float>(depth_m);
      view.normals[i] =
          (world_from_camera.rotation.conjugate() * Eigen::Vector3d::UnitZ()).cast<float>();
      view.grey[i] = static_cast<float>(exposure * grey * (1 - (1 - corner) * squared));
    }
  return view;
}

Rigid3 pose(int frame) {
  return exp_se3((Vector6d() << 0.01 * frame, 0.004 * frame, 0, 0, 0.01 * frame, 0).finished());
}

// As the pipeline does: the frame comes divided by what is known.
void learn(LensShading& shading, EarlierView& earlier, frame::CoarseView view,
           const Rigid3& world_from_camera) {
  const frame::CoarseMask nothing(view.size(), 0);
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x)
      view.grey[view.index(x, y)] /= shading.table()[shading_index(kCamera, x, y)];
  const frame::CoarseView measured = shading.as_measured(view);
  const auto comparison = earlier.compare(measured, world_from_camera, nothing);
  if (comparison) shading.learn(measured, *comparison);
  earlier.keep(measured, world_from_camera, nothing, comparison ? comparison->places.size() : 0);
}

LensShading learned(double corner, const std::function<double(int)>& exposure, int frames = 40) {
  LensShading shading;
  EarlierView earlier;
  for (int frame = 0; frame < frames; ++frame)
    learn(shading, earlier, wall(pose(frame), corner, exposure(frame)), pose(frame));
  return shading;
}

TEST(LensShading, OfDarkCornersIsFoundWhateverTheExposureDoes) {
  for (const double corner : {0.55, 0.8}) {
    const LensShading shading =
        learned(corner, [](int frame) { return 1 + 0.25 * std::sin(0.3 * frame); });
    EXPECT_NEAR(shading.table()[255], corner, 0.1 * (1 - corner));
    EXPECT_NEAR(shading.table()[127], 1 - (1 - corner) * 127 / 255, 0.1 * (1 - corner));
    EXPECT_EQ(shading.table()[0], 1);
  }
}

TEST(LensShading, OfAGoodLensStaysNone) {
  const LensShading shading = learned(1, [](int frame) { return frame % 2 == 0 ? 1.0 : 0.8; });
  for (const float darkening : shading.table()) EXPECT_EQ(darkening, 1);
}

TEST(LensShading, OfACameraThatStandsStillIsNotGuessed) {
  LensShading shading;
  EarlierView earlier;
  for (int frame = 0; frame < 40; ++frame) learn(shading, earlier, wall(Rigid3{}, 0.5), Rigid3{});
  EXPECT_EQ(shading.table()[255], 1);
}

TEST(LensShading, GoesOnFromWhatWasSaved) {
  const LensShading before = learned(
      0.6, [](int) { return 1.0; }, 30);
  ByteWriter bytes;
  before.save(bytes);
  const std::string saved = bytes.take();
  LensShading after;
  ByteReader reader(saved);
  after.restore(reader);
  ASSERT_TRUE(reader.status().ok());
  EXPECT_TRUE(reader.at_end());
  EXPECT_EQ(after.table(), before.table());
  ByteWriter again;
  after.save(again);
  EXPECT_EQ(again.take(), saved);
  ByteReader shorter(std::string_view(saved).substr(0, saved.size() - 5));
  after.restore(shorter);
  EXPECT_FALSE(shorter.status().ok());
}

}  // namespace
}  // namespace hermite::track::lens_shading_test
