#include "core/track/judgement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <tuple>

namespace hermite::track::judgement_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

// An ordinary frame of a hand-held scan.
TrackingEvidence good() {
  TrackingEvidence e;
  e.content = {.in_range = 0.8,
               .too_near = 0,
               .too_far = 0.05,
               .median_m = 1.6,
               .mean_grey = 110,
               .texture = 3};
  e.agreement = {.surface = 0.75,
                 .overlap = 0.9,
                 .agreeing = 0.98,
                 .in_front = 0.01,
                 .correlation = 0.93,
                 .grey_deviation = 55,
                 .reference_grey_deviation = 52,
                 .sharpness = 1.1};
  e.inlier_share = 0.45;
  e.observability = 0.03;
  e.reference_from_camera.translation.x() = 0.01;
  e.turn_seen_rad = 0.01;
  return e;
}

Eigen::Quaterniond turned(double turn_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitY()));
}

struct Case {
  const char* reason;  // what the text begins with
  std::function<void(TrackingEvidence&)> change;
};

// Of an ordinary frame with that change: what must be said, beside what the caller checks.
Judgement judged(const Case& c, TrackingStatus expected) {
  TrackingEvidence evidence = good();
  c.change(evidence);
  Judgement judgement = judge(evidence, TrackOptions{});
  EXPECT_EQ(judgement.status, expected);
  return judgement;
}

TEST(Judgement, AnOrdinaryFrameIsTracked) {
  const Judgement judgement = judge(good(), TrackOptions{});
  EXPECT_EQ(judgement.status, TrackingStatus::kTracked);
  EXPECT_EQ(judgement.reason, "");
  EXPECT_TRUE(judgement.image_is_good);
}

TEST(Judgement, APlaceIsTheSameWhenMostOfTheViewFitsOrLessOfItFitsBetter) {
  const auto at = [](double overlap, double agreeing, double correlation) {
    Agreement agreement = good().agreement;
    agreement.overlap = overlap, agreement.agreeing = agreeing, agreement.correlation = correlation;
    return agreement;
  };
  constexpr double kSeen = 0.01;
  constexpr double kUsual = 0.3;  // a correlation of 0.67
  EXPECT_TRUE(is_same_place(at(0.9, 0.86, 0.61), kSeen, kUsual));
  EXPECT_FALSE(is_same_place(at(0.9, 0.84, 0.9), kSeen, kUsual));
  EXPECT_FALSE(is_same_place(at(0.9, 0.99, 0.55), kSeen, kUsual));
  EXPECT_TRUE(is_same_place(at(0.3, 0.97, 0.95), kSeen, kUsual));
  EXPECT_FALSE(is_same_place(at(0.3, 0.86, 0.95), kSeen, kUsual)) << "enough for a whole view only";
  EXPECT_FALSE(is_same_place(at(0.3, 0.97, 0.65), kSeen, kUsual));
  EXPECT_FALSE(is_same_place(at(0.2, 1, 1), kSeen, kUsual));
  EXPECT_FALSE(is_same_place(at(0.9, 0.99, 0.83), kSeen, 1.67))
      << "the images of this scan fit much better where they belong";
  EXPECT_FALSE(is_same_place(at(0.9, 0.99, 0.99), 1e-4, kUsual)) << "it may have slid along a wall";
  Agreement blank = at(0.3, 1, 0);
  blank.grey_deviation = blank.reference_grey_deviation = 1;
  EXPECT_FALSE(is_same_place(blank, kSeen, kUsual)) << "a piece of bare wall is like any other";
  blank.overlap = 0.9;
  EXPECT_TRUE(is_same_place(blank, kSeen, kUsual));
}

TEST(Judgement, SaysWhyACameraIsLost) {
  const Case cases[] = {
      {"too few points", [](TrackingEvidence& e) { e.agreement = {}, e.content.in_range = 0; }},
      {"too near",
       [](TrackingEvidence& e) {
         e.agreement = {}, e.content.in_range = 0.01, e.content.median_m = 0.5;
       }},
      {"too near",
       [](TrackingEvidence& e) {
         e.agreement = {}, e.content.in_range = 0, e.content.too_near = 0.7;
       }},
      {"occluded",
       [](TrackingEvidence& e) {
         e.agreement.agreeing = 0.3, e.unmoved = {.overlap = 0.8, .in_front = 0.7};
       }},
      {"dark or blurred",
       [](TrackingEvidence& e) { e.agreement.agreeing = 0.3, e.content.mean_grey = 4; }},
      {"dark or blurred",
       [](TrackingEvidence& e) { e.agreement.agreeing = 0.3, e.content.texture = 0.1; }},
      {"too fast", [](TrackingEvidence& e) { e.agreement.overlap = 0.1, e.turn_seen_rad = 0.4; }},
      {"too fast: the camera would have jumped 45 cm",
       [](TrackingEvidence& e) { e.reference_from_camera.translation.x() = 0.45; }},
      {"blank surface",
       [](TrackingEvidence& e) { e.agreement.agreeing = 0.3, e.observability = 0; }},
      {"too little in common", [](TrackingEvidence& e) { e.agreement.agreeing = 0.3; }},
      {"too little in common", [](TrackingEvidence& e) { e.agreement.overlap = 0.1; }},
      {"too little in common", [](TrackingEvidence& e) { e.agreement.correlation = 0.1; }},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.reason);
    const Judgement judgement = judged(c, TrackingStatus::kLost);
    EXPECT_THAT(judgement.reason, StartsWith(c.reason));
  }
}

TEST(Judgement, WarnsWithAReasonBeforeTheCameraIsLost) {
  const Case cases[] = {
      {"too few points", [](TrackingEvidence& e) { e.inlier_share = 0.07; }},
      {"too little in common: only 30 %", [](TrackingEvidence& e) { e.agreement.overlap = 0.3; }},
      {"occluded",
       [](TrackingEvidence& e) { e.agreement.agreeing = 0.7, e.agreement.in_front = 0.28; }},
      {"too little in common: 30 %", [](TrackingEvidence& e) { e.agreement.agreeing = 0.7; }},
      {"too fast: 20 cm",
       [](TrackingEvidence& e) { e.reference_from_camera.translation.x() = 0.2; }},
      {"too fast: the camera turned by 15 degrees",
       [](TrackingEvidence& e) { e.reference_from_camera.rotation = turned(0.262); }},
      {"blank surface", [](TrackingEvidence& e) { e.observability = 0; }},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.reason);
    const Judgement judgement = judged(c, TrackingStatus::kWeak);
    EXPECT_THAT(judgement.reason, StartsWith(c.reason));
    EXPECT_TRUE(judgement.image_is_good);
  }
}

TEST(Judgement, AnImageWorseThanTheMapsIsAWarningAndItsColoursAreNotBelieved) {
  const Case cases[] = {
      {"white",
       [](TrackingEvidence& e) {
         e.agreement.grey_deviation = 0, e.agreement.correlation = 0, e.agreement.sharpness = 0;
       }},
      {"blurred", [](TrackingEvidence& e) { e.agreement.sharpness = 0.4; }},
      {"changed", [](TrackingEvidence& e) { e.agreement.correlation = 0.5; }},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.reason);
    const Judgement judgement = judged(c, TrackingStatus::kWeak);
    EXPECT_THAT(judgement.reason, StartsWith("dark or blurred"));
    EXPECT_FALSE(judgement.image_is_good);
  }
}

// A lamp went out: sharp, of the same shape, and corners go on as the camera does.
TrackingEvidence in_new_light() {
  TrackingEvidence evidence = good();
  evidence.agreement.correlation = 0.5;
  evidence.agreement.sharpness = 0.9;
  evidence.corners = {42, 0.9};
  evidence.follows_good_image = true;
  return evidence;
}

TEST(Judgement, NewLightIsAWarningAndItsColoursReplaceTheOldOnes) {
  const Judgement judgement = judge(in_new_light(), TrackOptions{});
  EXPECT_EQ(judgement.status, TrackingStatus::kWeak);
  EXPECT_THAT(judgement.reason, StartsWith("light: it has changed"));
  EXPECT_TRUE(judgement.light_has_changed);
}

// Until all colours are replaced, the map's image is a mixture, sharper than any frame.
TEST(Judgement, NewLightGoesOnUntilAllColoursAreReplaced) {
  TrackingEvidence evidence = in_new_light();
  evidence.agreement.correlation = 0.9;
  evidence.agreement.sharpness = 0.4;
  EXPECT_FALSE(judge(evidence, TrackOptions{}).light_has_changed) << "it is blurred";
  evidence.is_light_new = true;
  EXPECT_TRUE(judge(evidence, TrackOptions{}).light_has_changed);
}

TEST(Judgement, WhatMayBeAnotherPlaceOrABadImageIsNotNewLight) {
  const Case cases[] = {
      {"found again", [](TrackingEvidence& e) { e.follows_good_image = false; }},
      {"another shape", [](TrackingEvidence& e) { e.agreement.agreeing = 0.8; }},
      {"few corners", [](TrackingEvidence& e) { e.corners.count = 12; }},
      {"corners go another way", [](TrackingEvidence& e) { e.corners.share = 0.5; }},
      {"blurred", [](TrackingEvidence& e) { e.agreement.sharpness = 0.5; }},
      {"no image", [](TrackingEvidence& e) { e.agreement.grey_deviation = 3; }},
      {"as before", [](TrackingEvidence& e) { e.agreement.correlation = 0.9; }},
  };
  for (const Case& c : cases) {
    TrackingEvidence evidence = in_new_light();
    c.change(evidence);
    EXPECT_FALSE(judge(evidence, TrackOptions{}).light_has_changed) << c.reason;
  }
}

TEST(Judgement, AScanInTheDarkHasNoImageToBeWorseThan) {
  TrackingEvidence evidence = good();
  evidence.content.mean_grey = evidence.content.texture = 0;
  evidence.agreement.grey_deviation = evidence.agreement.reference_grey_deviation = 0;
  evidence.agreement.correlation = evidence.agreement.sharpness = 0;
  EXPECT_EQ(judge(evidence, TrackOptions{}).status, TrackingStatus::kTracked);
  EXPECT_FALSE(judge(evidence, TrackOptions{}).image_is_good)
      << "colours that the map got while there was light are kept";
}

// Half of the view may have changed, if the other half looks exactly as it did.
TEST(Judgement, TheLessAgreesTheMoreItMustLookTheSame) {
  for (const auto& [agreeing, correlation, believed] : {std::tuple{0.65, 0.9, true},
                                                        {0.65, 0.6, false},
                                                        {0.9, 0.4, true},
                                                        {0.9, 0.1, false},
                                                        {0.5, 1.0, false},
                                                        {0.8, 0.65, true},
                                                        {0.77, 0.73, false},
                                                        {0.68, 0.84, false}}) {
    Agreement agreement = good().agreement;
    agreement.agreeing = agreeing;
    agreement.correlation = correlation;
    EXPECT_EQ(is_believable(agreement, Rigid3{}, TrackOptions{}), believed)
        << agreeing << " " << correlation;
  }
}

TEST(Judgement, AJumpIsBelievedWhereNearlyAllFits) {
  const auto status = [](double step_m, double turn_rad, double agreeing, double correlation) {
    TrackingEvidence evidence = good();
    evidence.reference_from_camera = {turned(turn_rad), {step_m, 0, 0}};
    evidence.agreement.agreeing = agreeing, evidence.agreement.correlation = correlation;
    return judge(evidence, TrackOptions{}).status;
  };
  for (const auto& [step_m, turn_rad] : {std::pair(0.25, 0.01), std::pair(0.01, 0.3)}) {
    EXPECT_EQ(status(step_m, turn_rad, 0.91, 0.82), TrackingStatus::kWeak);
    EXPECT_EQ(status(step_m, turn_rad, 0.76, 0.84), TrackingStatus::kLost);
    EXPECT_EQ(status(step_m, turn_rad, 0.76, 0.93), TrackingStatus::kLost);
    EXPECT_EQ(status(step_m, turn_rad, 0.98, 0.55), TrackingStatus::kLost);
  }
  EXPECT_EQ(status(0.01, 0.01, 0.76, 0.84), TrackingStatus::kWeak) << "a step is no jump";
}

TEST(Judgement, TheLongerACameraWasLostTheFartherItMayHaveGone) {
  TrackingEvidence evidence = good();
  evidence.reference_from_camera.translation.x() = 0.5;
  EXPECT_EQ(judge(evidence, TrackOptions{}).status, TrackingStatus::kLost);
  evidence.lost_count = 1;
  EXPECT_EQ(judge(evidence, TrackOptions{}).status, TrackingStatus::kWeak);
}

TEST(Judgement, ALostCameraIsFoundFarAwayOnlyWhereItsImageTellsEnough) {
  TrackingEvidence evidence = good();
  evidence.lost_count = 20;
  evidence.reference_from_camera.translation.x() = 0.4;
  evidence.agreement.agreeing = 1;
  evidence.agreement.correlation = 0.84;
  evidence.usual_information = 1.6;  // a correlation of 0.98
  EXPECT_THAT(judge(evidence, TrackOptions{}).reason, HasSubstr("too little in common"));
  evidence.agreement.correlation = 0.98;
  EXPECT_EQ(judge(evidence, TrackOptions{}).status, TrackingStatus::kWeak);
  evidence.agreement.correlation = 0.84;
  evidence.reference_from_camera.translation.x() = 0.05;
  EXPECT_NE(judge(evidence, TrackOptions{}).status, TrackingStatus::kLost)
      << "where it was lost there is little else to be";
}

TEST(Judgement, WithoutAnImageALostCameraIsFoundFarAwayOnlyWhereDepthHoldsIt) {
  TrackingEvidence evidence = good();
  evidence.lost_count = 20;
  evidence.reference_from_camera.translation.x() = 0.4;
  evidence.agreement.agreeing = 1;
  evidence.agreement.grey_deviation = evidence.agreement.reference_grey_deviation = 1;
  EXPECT_NE(judge(evidence, TrackOptions{}).status, TrackingStatus::kLost);
  evidence.observability = 1e-5;
  EXPECT_THAT(judge(evidence, TrackOptions{}).reason, HasSubstr("blank surface"));
}

TEST(Judgement, AFrameThatFitsTwoPlacesIsLost) {
  TrackingEvidence evidence = good();
  evidence.is_ambiguous = true;
  const Judgement judgement = judge(evidence, TrackOptions{});
  EXPECT_EQ(judgement.status, TrackingStatus::kLost);
  EXPECT_THAT(judgement.reason, HasSubstr("more than one place"));
}

TEST(Judgement, AnImageTellsTheMoreTheBetterItCorrelates) {
  Agreement agreement = good().agreement;
  const auto information = [&agreement](double correlation) {
    agreement.correlation = correlation;
    return image_information(agreement);
  };
  EXPECT_EQ(information(-0.5), 0);
  EXPECT_EQ(information(0), 0);
  EXPECT_NEAR(information(0.6), -0.5 * std::log(0.64), 1e-12);
  EXPECT_GT(information(0.98), 2.5 * information(0.84));
  EXPECT_TRUE(std::isfinite(information(1)));
  agreement.grey_deviation = 0;
  EXPECT_EQ(information(1), 0) << "there is no image";
}

TEST(Judgement, OfTheFirstFrameAsksForSurfaceOnly) {
  TrackingEvidence evidence = good();
  evidence.agreement = {.surface = 0.02};
  EXPECT_EQ(judge_start(evidence, TrackOptions{}).status, TrackingStatus::kTracked);
  evidence.agreement.surface = 0.005;
  EXPECT_THAT(judge_start(evidence, TrackOptions{}).reason, HasSubstr("almost nothing"));
}

TEST(Judgement, WeighsWhatIsKnownOfThePose) {
  const Judgement tracked{TrackingStatus::kTracked, "", true};
  const auto with_sigma = [](double sigma_m) {
    return Doubts{PoseUncertainty{sigma_m * sigma_m * Matrix6d::Identity(), 0, 0, {}}, {}, {}};
  };
  EXPECT_EQ(weighed(tracked, with_sigma(0.01)).status, TrackingStatus::kTracked);
  const Judgement uncertain = weighed(tracked, with_sigma(0.08));
  EXPECT_EQ(uncertain.status, TrackingStatus::kWeak);
  EXPECT_EQ(uncertain.reason, "uncertain: the camera may be 16 cm from where it seems to be");
  Doubts far = with_sigma(0.08);
  far.uncertainty.way_m = 6;
  EXPECT_EQ(weighed(tracked, far).status, TrackingStatus::kTracked) << "after a walk of 6 m";
  Doubts beginning = with_sigma(0.038);
  beginning.uncertainty.way_m = 0.2;
  EXPECT_EQ(weighed(tracked, beginning).status, TrackingStatus::kWeak)
      << "nothing is known of the camera yet";
  beginning.uncertainty.way_m = 1;
  EXPECT_EQ(weighed(tracked, beginning).status, TrackingStatus::kTracked);

  Doubts bent = with_sigma(0.01);
  bent.calibration = {0.015, 0.001};
  EXPECT_EQ(weighed(tracked, bent).reason,
            "the camera's calibration does not fit: depth in the corners of the image is too great "
            "by about 1.5 %");
  bent.calibration.deviation = 0.004;
  EXPECT_EQ(weighed(tracked, bent).status, TrackingStatus::kTracked) << "not significant";

  Doubts coarse = with_sigma(0.01);
  coarse.uncertainty.steps = {3, 0.06, 0.02};
  EXPECT_EQ(weighed(tracked, coarse).reason,
            "depth is measured in steps of 6 cm, which its noise does not average out: the camera "
            "may follow the steps");
  coarse.uncertainty.steps.terrace_m = 0.001;
  EXPECT_EQ(weighed(tracked, coarse).status, TrackingStatus::kTracked) << "noise averages them out";

  Doubts apart = with_sigma(0.01);
  apart.contradiction = {9, 0.04, 0.01, "depth", "picture"};
  EXPECT_EQ(weighed(tracked, apart).reason, "depth and picture disagree: by 4 cm and 1 degrees");
  apart.contradiction.sigmas = 3;
  EXPECT_EQ(weighed(tracked, apart).status, TrackingStatus::kTracked) << "noise";
  EXPECT_EQ(weighed({TrackingStatus::kWeak, "too fast", true}, apart).reason, "too fast");

  Doubts elsewhere = with_sigma(0.01);
  elsewhere.uncertainty.elsewhere_m = 2;
  EXPECT_EQ(weighed(tracked, elsewhere).status, TrackingStatus::kWeak);
  EXPECT_THAT(weighed(tracked, elsewhere).reason, testing::StartsWith("unconfirmed: "));
}

TEST(Judgement, StatusesHaveNames) {
  EXPECT_STREQ(name_of(TrackingStatus::kTracked), "tracked");
  EXPECT_STREQ(name_of(TrackingStatus::kWeak), "weak");
  EXPECT_STREQ(name_of(TrackingStatus::kLost), "lost");
}

}  // namespace
}  // namespace hermite::track::judgement_test
