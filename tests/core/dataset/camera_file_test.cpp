#include "core/dataset/camera_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/dataset/sequence.h"
#include "tests/core/dataset/temp_folder.h"

namespace hermite::dataset {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const char* const kGood =
    R"({"width": 640, "height": 480, "fx": 525.5, "fy": 526, "cx": 319.5, "cy": 239.5,
        "depth_units_per_metre": 5000, "frame_rate_hz": 15,
        "color_distortion": {"k1": 0.02, "p2": -0.003}})";

TEST(CameraFile, ReadsAllKeys) {
  const auto file = parse_camera_json(kGood);
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_EQ(file->camera,
            (Camera{640, 480, 525.5, 526, 319.5, 239.5, 5000, {.k1 = 0.02, .p2 = -0.003}}));
  EXPECT_EQ(file->frame_rate_hz, 15);
}

TEST(CameraFile, WithoutARateItIsThirty) {
  const auto file =
      parse_camera_json(R"({"width": 64, "height": 64, "fx": 60, "fy": 60, "cx": 32, "cy": 32, )"
                        R"("depth_units_per_metre": 1000})");
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_EQ(file->frame_rate_hz, 30);
}

TEST(CameraFile, ErrorsNameTheKey) {
  const auto with = [](const std::string& old_text, const std::string& new_text) {
    std::string text = kGood;
    text.replace(text.find(old_text), old_text.size(), new_text);
    const auto file = parse_camera_json(text);
    return file.ok() ? std::string("accepted") : file.error().message;
  };
  EXPECT_THAT(with("\"fx\"", "\"gx\""), HasSubstr("\"fx\" is missing"));
  EXPECT_THAT(with("0.02", "\"0.02\""), HasSubstr("\"k1\" is not a number"));
  EXPECT_THAT(with("0.02", "20"), HasSubstr("camera.distortion moves a corner"));
  EXPECT_THAT(with("{\"k1\": 0.02, \"p2\": -0.003}", "[1]"), HasSubstr("color_distortion"));
  EXPECT_THAT(with("525.5", "\"525\""), HasSubstr("\"fx\" is not a number"));
  EXPECT_THAT(with("640", "640.5"),
              HasSubstr("\"width\" must be a whole number of pixels from 64 to 2048"));
  EXPECT_THAT(with("640", "1e12"), HasSubstr("\"width\""));
  EXPECT_THAT(with("525.5", "-525.5"), HasSubstr("fx"));
  EXPECT_THAT(with("319.5", "641"), HasSubstr("cx"));
  EXPECT_THAT(with("5000", "0"), HasSubstr("depth_units_per_metre"));
  EXPECT_THAT(with(": 15", ": 0"), HasSubstr("frame_rate_hz"));
  EXPECT_THAT(with("{\"width\"", "[\"width\""), HasSubstr("JSON"));
  EXPECT_THAT(parse_camera_json("").error().message, HasSubstr("JSON"));
  EXPECT_THAT(parse_camera_json("[1,2]").error().message, HasSubstr("JSON"));
}

const char* const kTwoLenses =
    R"({"width": 640, "height": 480, "fx": 585, "fy": 586, "cx": 320, "cy": 240,
        "depth_units_per_metre": 1000,
        "color_distortion": {"k1": 0.02}, "depth_distortion": {"k1": -0.1},
        "color_camera": {"fx": 525, "fy": 526, "cx": 321, "cy": 241,
                         "color_from_depth":
                             [[0, -1, 0, -0.025], [1, 0, 0, 0.001], [0, 0, 1, 0.002]]}})";

TEST(CameraFile, ReadsAColourCameraAndTheLensOfEach) {
  const auto file = parse_camera_json(kTwoLenses);
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_TRUE(file->says_color_camera);
  EXPECT_EQ(file->camera.fy, 586);
  EXPECT_EQ(file->camera.distortion, (Distortion{.k1 = -0.1}));
  ASSERT_TRUE(file->camera.color.has_value());
  const ColorCamera& color = *file->camera.color;
  EXPECT_EQ(Eigen::Vector4d(color.fx, color.fy, color.cx, color.cy),
            Eigen::Vector4d(525, 526, 321, 241));
  EXPECT_EQ(color.distortion, (Distortion{.k1 = 0.02}));
  EXPECT_LT(
      (color.color_from_depth * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(-0.025, 1.001, 0.002))
          .norm(),
      1e-12);
}

TEST(CameraFile, ARegisteredCameraMayBeSaidToBeSo) {
  EXPECT_FALSE(parse_camera_json(kGood)->says_color_camera);
  std::string text = kGood;
  text.insert(1, "\"color_camera\": null, ");
  const auto file = parse_camera_json(text);
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_TRUE(file->says_color_camera);
  EXPECT_EQ(file->camera, parse_camera_json(kGood)->camera);
}

TEST(CameraFile, ErrorsOfTheColourCameraNameTheKey) {
  const auto with = [](const std::string& old_text, const std::string& new_text) {
    std::string text = kTwoLenses;
    text.replace(text.find(old_text), old_text.size(), new_text);
    const auto file = parse_camera_json(text);
    return file.ok() ? std::string("accepted") : file.error().message;
  };
  EXPECT_EQ(with("525", "526"), "accepted");
  EXPECT_THAT(with("\"color_camera\": {", "\"color_camera\": 5, \"x\": {"),
              HasSubstr("\"color_camera\""));
  EXPECT_THAT(with("\"fx\": 525, ", ""), HasSubstr("\"color_camera\": \"fx\" is missing"));
  EXPECT_THAT(with("\"cx\": 321", "\"cx\": null"),
              HasSubstr("\"color_camera\": \"cx\" is not a number"));
  EXPECT_THAT(with("525", "5"), HasSubstr("camera.color.fx"));
  EXPECT_THAT(with("color_from_depth", "depth_from_color"),
              HasSubstr("\"color_from_depth\" must be three rows of four numbers"));
  EXPECT_THAT(with("[1, 0, 0, 0.001]", "[1, 0, 0]"), HasSubstr("three rows of four numbers"));
  EXPECT_THAT(with("[1, 0, 0, 0.001]", "[1, 0, 0, \"0\"]"),
              HasSubstr("three rows of four numbers"));
  EXPECT_THAT(with("[1, 0, 0, 0.001], ", ""), HasSubstr("three rows of four numbers"));
  EXPECT_THAT(with("[1, 0, 0, 0.001]", "[-1, 0, 0, 0.001]"), HasSubstr("is no rotation"));
  EXPECT_THAT(with("[1, 0, 0, 0.001]", "[1.01, 0, 0, 0.001]"), HasSubstr("is no rotation"));
  EXPECT_THAT(with("-0.025", "-25"), HasSubstr("camera.color.color_from_depth.translation"));
  EXPECT_THAT(with("\"k1\": 0.02", "\"k1\": 20"),
              HasSubstr("camera.color.distortion moves a corner"));
  EXPECT_THAT(with("\"k1\": -0.1", "\"k1\": \"a\""),
              HasSubstr("\"depth_distortion\": \"k1\" is not a number"));
  EXPECT_THAT(with("\"color_camera\"", "\"colour\""),
              HasSubstr("\"depth_distortion\" needs \"color_camera\""));
}

TEST(CameraFile, NamesEverybodyKnows) {
  EXPECT_EQ(known_camera("fr1")->fx, 517.3);
  EXPECT_EQ(known_camera("fr2")->fy, 521.0);
  EXPECT_EQ(known_camera("fr3")->cy, 247.6);
  EXPECT_EQ(known_camera("icl-nuim")->fy, 480.0)
      << "the published fy is negative; the reader turns the world instead";
  EXPECT_FALSE(known_camera("fr4"));
  EXPECT_FALSE(known_camera(""));
  EXPECT_EQ(camera_mentioned_in("/data/rgbd_dataset_freiburg2_desk")->fx, 520.9);
  EXPECT_FALSE(camera_mentioned_in("/data/desk"));
  for (const char* name : {"fr1", "fr2", "fr3", "icl-nuim"})
    EXPECT_TRUE(validate(*known_camera(name)).ok()) << name;
}

// A camera of which the file says this, too.
Result<CameraFile> with_key(const std::string& key, const std::string& value) {
  return parse_camera_json(
      R"({"width": 640, "height": 480, "fx": 525, "fy": 525, "cx": 320, "cy": 240,
          "depth_units_per_metre": 1000, ")" +
      key + "\": " + value + "}");
}

TEST(CameraFile, KeepsTheCorrectionOfDepth) {
  const auto with = [](const std::string& correction) {
    return with_key("depth_correction", correction);
  };
  const Result<CameraFile> file = with(R"({"bend": -0.015, "inverse_offset_per_m": 0.02})");
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_EQ(file->camera.depth_correction, (DepthCorrection{-0.015, 0.02}));
  const Result<CameraFile> again = parse_camera_json(format_camera_json(*file));
  ASSERT_TRUE(again.ok()) << again.error().message;
  EXPECT_EQ(again->camera, file->camera);
  EXPECT_EQ(with(R"({"bend": 0.01})")->camera.depth_correction, (DepthCorrection{0.01, 0}));
  const auto message_of = [&with](const char* correction) {
    return with(correction).error().message;
  };
  EXPECT_THAT(message_of("5"), HasSubstr("depth_correction"));
  EXPECT_THAT(message_of(R"({"bend": "much"})"),
              AllOf(HasSubstr("depth_correction"), HasSubstr("bend")));
  EXPECT_THAT(message_of(R"({"bend": 0.2})"),
              AllOf(HasSubstr("depth_correction.bend"), HasSubstr("allowed is")));
  EXPECT_THAT(message_of(R"({"inverse_offset_per_m": -1})"),
              AllOf(HasSubstr("depth_correction.inverse_offset_per_m"), HasSubstr("allowed is")));
}

TEST(CameraFile, KeepsWhatIsKnownOfTheCamera) {
  const auto with = [](const std::string& deviations) {
    return with_key("standard_deviations", deviations);
  };
  const Result<CameraFile> file = with(R"({"bend": 0.001, "focal": 0.0015})");
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_EQ(file->camera.deviations, (CameraDeviations{0.001, 0.0015, 0}));
  EXPECT_EQ(parse_camera_json(format_camera_json(*file))->camera, file->camera);
  EXPECT_THAT(with("[]").error().message, HasSubstr("standard_deviations"));
  EXPECT_THAT(with(R"({"focal": -1})").error().message,
              AllOf(HasSubstr("standard_deviations.focal"), HasSubstr("allowed is")));
}

TEST(CameraFile, KeepsTheTimingOfRows) {
  const auto with = [](const std::string& timing) { return with_key("timing", timing); };
  const Result<CameraFile> file =
      with(R"({"depth_readout_s": 0.033, "color_readout_s": 0.03, "color_delay_s": -0.01})");
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_EQ(file->camera.timing, (ImageTiming{0.033, 0.03, -0.01}));
  const Result<CameraFile> again = parse_camera_json(format_camera_json(*file));
  ASSERT_TRUE(again.ok()) << again.error().message;
  EXPECT_EQ(again->camera, file->camera);
  EXPECT_EQ(with(R"({"color_delay_s": 0.01})")->camera.timing, (ImageTiming{0, 0, 0.01}));
  const auto message_of = [&with](const char* timing) { return with(timing).error().message; };
  EXPECT_THAT(message_of("5"), AllOf(HasSubstr("timing"),
                                     HasSubstr("depth_readout_s, color_readout_s, color_delay_s")));
  EXPECT_THAT(message_of(R"({"color_delay_s": "late"})"),
              AllOf(HasSubstr("timing"), HasSubstr("color_delay_s")));
  EXPECT_THAT(message_of(R"({"depth_readout_s": 0.2})"),
              AllOf(HasSubstr("timing.depth_readout_s"), HasSubstr("allowed is")));
}

TEST(CameraFile, BesideAFileItsOwnComesBeforeThatOfTheFolder) {
  const TempFolder folder;
  EXPECT_FALSE(*camera_beside(folder.path("a.klg")));
  folder.write("camera.json", kGood);
  auto found = camera_beside(folder.path("a.klg"));
  ASSERT_TRUE(found.ok() && *found);
  EXPECT_EQ((*found)->name, "camera.json");
  EXPECT_EQ((*found)->file.camera.fx, 525.5);
  folder.write("a.klg.camera.json", "{");
  EXPECT_THAT(camera_beside(folder.path("a.klg")).error().message, HasSubstr("a.klg.camera.json"));
  EXPECT_EQ((*camera_beside(folder.path("b.klg")))->name, "camera.json");
}

TEST(CameraFile, ReadCameraTakesAPathOrAName) {
  const TempFolder folder;
  folder.write("camera.json", kGood);
  EXPECT_EQ(read_camera("fr3")->fx, 535.4);
  EXPECT_EQ(read_camera(folder.path("camera.json"))->fx, 525.5);
  EXPECT_THAT(read_camera("fr9").error().message,
              HasSubstr("\"fr9\" is neither a file nor one of fr1"));
  folder.write("broken.json", "{");
  EXPECT_THAT(read_camera(folder.path("broken.json")).error().message, HasSubstr("broken.json"));
}

}  // namespace
}  // namespace hermite::dataset
