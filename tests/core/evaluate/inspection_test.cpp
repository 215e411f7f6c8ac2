#include "core/evaluate/inspection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/disturb/disturbance.h"
#include "core/source/open_sequence.h"
#include "tests/support/data_folder.h"

namespace hermite::evaluate {
namespace {

using testing::HasSubstr;

dataset::Recording recording_of(const std::string& source,
                                const std::optional<Camera>& camera = std::nullopt) {
  return {*source::open_sequence(source, camera), "made", "given", {"a doubt of the reader"}};
}

std::string doubts_of(const Inspection& inspection) {
  std::string text;
  for (const std::string& doubt : inspection.doubts) text += doubt + "\n";
  return text;
}

TEST(Inspection, OfAGoodRecordingHasNoDoubts) {
  dataset::Recording recording = recording_of("synthetic:frames=40,width=160,height=120");
  recording.doubts.clear();
  const Inspection found = inspect(recording, "/nowhere", 8);
  EXPECT_EQ(doubts_of(found), "");
  EXPECT_EQ(found.frame_count, 40);
  EXPECT_NEAR(found.measured_rate_hz, 30, 1e-6);
  EXPECT_EQ(found.unit.units_per_metre, 5000);
  EXPECT_EQ(found.frames_looked_at, 8);
  EXPECT_EQ(found.truth.frames_with_pose, 40);
  EXPECT_GT(found.depth.valid_share, 0.9);
  EXPECT_THAT(inspection_text(found), HasSubstr("no doubts"));
}

TEST(Inspection, SaysGapsUnitsAndWhatTheReaderDoubted) {
  Camera wrong_unit{160, 120, 131.25, 131.25, 79.5, 59.5, 5000};
  auto gappy = disturb::with_missing(
      *source::open_sequence("synthetic:frames=40,width=160,height=120", wrong_unit), {10, 5});
  const Inspection found =
      inspect({*std::move(gappy), "made", "given", {"a doubt of the reader"}}, "/nowhere", 4);
  EXPECT_THAT(doubts_of(found), HasSubstr("a doubt of the reader"));
  EXPECT_THAT(doubts_of(found), HasSubstr("1 gaps in time, the longest of 0.2 s after frame 9"));
  EXPECT_EQ(found.gap_count, 1);
  EXPECT_THAT(inspection_json(found), HasSubstr("\"after_frame\": 9"));
}

TEST(DepthUnit, IsGuessedWhereTheStatedOneMakesNoRoom) {
  DepthValues values;
  DepthImage depth(100, 10);
  for (std::size_t i = 0; i < depth.pixels.size(); ++i)
    depth.pixels[i] = static_cast<std::uint16_t>(5 * (1500 + i));
  values.add(depth);
  const DepthSurvey survey = values.survey();
  EXPECT_EQ(survey.median, 5 * 2000);
  EXPECT_EQ(survey.common_divisor, 5);
  EXPECT_EQ(survey.distinct_values, 1000);
  EXPECT_FALSE(guess_depth_unit(survey, 5000).is_doubtful);
  const UnitGuess guess = guess_depth_unit(survey, 1000);
  EXPECT_TRUE(guess.is_doubtful);
  EXPECT_EQ(guess.units_per_metre, 5000);
  EXPECT_THAT(guess.reason, HasSubstr("multiple of 5"));
  EXPECT_TRUE(guess_depth_unit({}, 1000).is_doubtful) << "no depth at all";
}

// Of the recordings only redkitchen has raw images of two cameras.
TEST(Inspection, DoubtsTheRegistrationOfRedkitchenAlone) {
  for (const auto& [name, is_doubtful] :
       {std::pair{"redkitchen", true}, std::pair{"tum_fr1_rpy_part", false},
        std::pair{"living_room_part", false}}) {
    const auto folder = test::data_folder(name);
    if (!folder) GTEST_SKIP() << test::skip_message(name);
    Camera camera = (*source::open_sequence(folder->string()))->camera();
    camera.color.reset();
    const Inspection found =
        inspect(*dataset::open_recording(folder->string(), camera), folder->string());
    ASSERT_TRUE(found.registration.has_value());
    EXPECT_EQ(found.registration->is_doubtful(), is_doubtful)
        << name << " " << found.registration->gain;
    if (is_doubtful) {
      EXPECT_NEAR(found.registration->scale, 525.0 / 585, 0.021);
    }
  }
}

}  // namespace
}  // namespace hermite::evaluate
