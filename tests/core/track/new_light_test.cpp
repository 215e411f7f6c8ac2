#include "core/track/new_light.h"

#include <gtest/gtest.h>

#include <string>

#include "core/base/byte_stream.h"

namespace hermite::track::new_light_test {
namespace {

constexpr int kFrames = 4;

Judgement judged(TrackingStatus status, bool image_is_good, bool light_has_changed = false) {
  Judgement judgement;
  judgement.status = status;
  judgement.image_is_good = image_is_good;
  judgement.light_has_changed = light_has_changed;
  return judgement;
}

TrackingEvidence described(const NewLight& light) {
  TrackingEvidence evidence;
  light.describe(evidence);
  return evidence;
}

TEST(NewLight, IsOnlyThoughtOfAfterAGoodImageAndUntilTheCameraIsLost) {
  NewLight light(kFrames);
  frame::Brightness brightness;
  EXPECT_FALSE(described(light).follows_good_image);
  light.follow(judged(TrackingStatus::kWeak, false), brightness);
  EXPECT_FALSE(described(light).follows_good_image) << "not one has been good yet";
  light.follow(judged(TrackingStatus::kTracked, true), brightness);
  light.follow(judged(TrackingStatus::kWeak, false), brightness);
  EXPECT_TRUE(described(light).follows_good_image);
  light.follow(judged(TrackingStatus::kLost, false), brightness);
  EXPECT_FALSE(described(light).follows_good_image);
}

TEST(NewLight, HoldsForAsManyFramesAsSampleAllPixelsAndKeepsTheExposure) {
  NewLight light(kFrames);
  frame::Brightness exposure{1.2, 3};
  EXPECT_FALSE(light.follow(judged(TrackingStatus::kTracked, true), exposure));
  EXPECT_EQ(exposure.gain, 1.2);
  for (int frame = 0; frame < kFrames; ++frame) {
    EXPECT_EQ(described(light).is_light_new, frame > 0) << frame;
    frame::Brightness found{0.4, 9};
    EXPECT_TRUE(light.follow(judged(TrackingStatus::kWeak, false, true), found));
    EXPECT_EQ(found.gain, 1.2);
    EXPECT_EQ(found.offset, 3);
  }
  EXPECT_FALSE(described(light).is_light_new);
}

TEST(NewLight, GoesOnFromWhatWasSaved) {
  NewLight light(kFrames);
  frame::Brightness exposure{1.2, 3};
  light.follow(judged(TrackingStatus::kTracked, true), exposure);
  light.follow(judged(TrackingStatus::kWeak, false, true), exposure);
  ByteWriter bytes;
  light.save(bytes);
  const std::string saved = bytes.take();
  ByteReader reader(saved);
  NewLight restored(kFrames);
  restored.restore(reader);
  ASSERT_TRUE(reader.ok());
  EXPECT_TRUE(described(restored).follows_good_image);
  EXPECT_TRUE(described(restored).is_light_new);
  ByteReader again(saved);
  NewLight shorter(1);
  shorter.restore(again);
  EXPECT_FALSE(again.ok()) << "more frames than there can be";
}

}  // namespace
}  // namespace hermite::track::new_light_test
