#include "core/source/open_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/dataset/camera_file.h"
#include "core/image/image_codec.h"
#include "tests/core/dataset/temp_folder.h"
#include "tests/support/data_folder.h"

namespace hermite::dataset {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 80, kHeight = 64;

const char* const kNumberedCameraJson =
    R"({"width": 80, "height": 64, "fx": 70, "fy": 71, "cx": 39.5, "cy": 31.5, )"
    R"("depth_units_per_metre": 5000, "frame_rate_hz": 10})";

// Every frame's depth carries its number, so that a test can tell which image it got.
DepthImage depth_of(int number, int width = kWidth, int height = kHeight) {
  DepthImage depth(width, height);
  for (std::size_t i = 0; i < depth.pixels.size(); ++i)
    depth.pixels[i] = static_cast<std::uint16_t>(1000 * (number + 1) + static_cast<int>(i % 50));
  return depth;
}

ColorImage color_of(int number, int width = kWidth, int height = kHeight) {
  ColorImage color(width, height);
  for (Rgb8& pixel : color.pixels) pixel = {static_cast<std::uint8_t>(40 * number), 100, 200};
  return color;
}

std::vector<std::uint8_t> depth_png(int number) {
  return *image::encode_depth_png(depth_of(number));
}
std::vector<std::uint8_t> color_png(int number) { return *image::encode_png(color_of(number)); }
std::vector<std::uint8_t> color_jpeg(int number) {
  return *image::encode_jpeg(color_of(number), 90);
}

std::string error_of(const std::string& source) {
  const auto sequence = source::open_sequence(source);
  return sequence.ok() ? "opened" : sequence.error().message;
}

// Three TUM frames; the colour clock is 5 ms early.
void write_tum(const TempFolder& folder) {
  folder.write("rgb.txt", "# color images\n0.995 rgb/0.png\n1.095 rgb/1.png\n1.195 rgb/2.png\n");
  folder.write("depth.txt", "# depth maps\n1.0 depth/0.png\n1.1 depth/1.png\n1.2 depth/2.png\n");
  for (int i = 0; i < 3; ++i) {
    folder.write("rgb/" + std::to_string(i) + ".png", color_png(i));
    folder.write("depth/" + std::to_string(i) + ".png", depth_png(i));
  }
}

TEST(TumSequence, ReadsFramesAtTheDepthsTimes) {
  const TempFolder folder;
  write_tum(folder);
  folder.write("camera.json", kNumberedCameraJson);
  folder.write("groundtruth.txt", "# x\n1.0 0 0 0 0 0 0 1\n1.1 1 2 3 0 0 0 1\n");
  const auto opened = source::open_sequence(folder.path() + "/");
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  const Sequence& sequence = **opened;
  EXPECT_EQ(sequence.format(), "tum");
  EXPECT_EQ(sequence.name(), std::filesystem::path(folder.path()).filename().string());
  EXPECT_EQ(sequence.frame_count(), 3);
  EXPECT_EQ(sequence.frame_rate_hz(), 10);
  EXPECT_EQ(sequence.camera(), (Camera{80, 64, 70, 71, 39.5, 31.5, 5000}));
  ASSERT_EQ(sequence.groundtruth().size(), 2u);
  EXPECT_EQ(sequence.groundtruth()[1].world_from_camera.translation, Eigen::Vector3d(1, 2, 3));
  for (int i = 0; i < 3; ++i) {
    const auto frame = sequence.read(i);
    ASSERT_TRUE(frame.ok()) << frame.error().message;
    EXPECT_EQ(frame->timestamp_s, 1.0 + 0.1 * i);
    EXPECT_EQ(sequence.timestamp_s(i), frame->timestamp_s);
    EXPECT_EQ(frame->depth, depth_of(i)) << "values as stored";
    EXPECT_EQ(frame->color_bytes, color_png(i)) << "the bytes of the file";
  }
}

TEST(TumSequence, FramesWithoutAPartnerAreLeftOut) {
  const TempFolder folder;
  write_tum(folder);
  folder.write("camera.json", kNumberedCameraJson);
  folder.write("depth.txt", "1.0 depth/0.png\n1.117 depth/1.png\n1.2 depth/2.png\n");
  const auto opened = source::open_sequence(folder.path());
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  EXPECT_EQ((*opened)->frame_count(), 2);
  EXPECT_EQ((*opened)->read(1)->depth, depth_of(2));
  folder.write("depth.txt", "5.0 depth/0.png\n");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("no depth image with a colour image"));
}

TEST(TumSequence, AMissingOrBrokenImageIsAnErrorOfItsFrameAlone) {
  const TempFolder folder;
  write_tum(folder);
  folder.write("camera.json", kNumberedCameraJson);
  std::filesystem::remove(folder.path("depth/0.png"));
  folder.write("rgb/1.png", "this is no image");
  const auto opened = source::open_sequence(folder.path());
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  const auto missing = (*opened)->read(0), broken = (*opened)->read(1), good = (*opened)->read(2);
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(missing.error().message, HasSubstr("frame 0"));
  EXPECT_THAT(missing.error().message, HasSubstr("depth/0.png"));
  ASSERT_FALSE(broken.ok());
  EXPECT_THAT(broken.error().message, HasSubstr("rgb/1.png"));
  EXPECT_TRUE(good.ok());
}

TEST(TumSequence, AnotherSizeThanTheCamerasIsAnErrorWithBothSizes) {
  const TempFolder folder;
  write_tum(folder);
  folder.write("camera.json", kNumberedCameraJson);
  folder.write("rgb/1.png", *image::encode_png(color_of(1, 96, 64)));
  const auto opened = source::open_sequence(folder.path());
  ASSERT_TRUE(opened.ok());
  EXPECT_THAT((*opened)->read(1).error().message,
              HasSubstr("the image has 96x64 pixels, the camera 80x64"));
  EXPECT_TRUE((*opened)->read(0).ok());
  const auto wrong_camera = source::open_sequence(folder.path(), known_camera("fr1"));
  ASSERT_FALSE(wrong_camera.ok()) << "said once when opening, not for every frame";
  EXPECT_THAT(wrong_camera.error().message,
              HasSubstr("the image has 80x64 pixels, the camera 640x480"));
}

TEST(TumSequence, BadLinesAreNamed) {
  const TempFolder folder;
  write_tum(folder);
  folder.write("camera.json", kNumberedCameraJson);
  const std::pair<const char*, const char*> cases[] = {
      {"x depth/0.png", "the time is not a finite number"},
      {"nan depth/0.png", "the time is not a finite number"},
      {"1.0", "expected a time and a file name"},
      {"1.0 depth/0.png more", "expected a time and a file name"},
      {"1.0 ../depth/0.png", "the file name leaves the folder"},
      {"1.0 /etc/passwd", "the file name leaves the folder"},
  };
  for (const auto& [line, reason] : cases) {
    folder.write("depth.txt", std::string("# comment\n1.1 depth/1.png\n") + line + "\n");
    EXPECT_THAT(error_of(folder.path()), HasSubstr("depth.txt, line 3: ")) << line;
    EXPECT_THAT(error_of(folder.path()), HasSubstr(reason)) << line;
  }
}

TEST(TumSequence, ABrokenGroundTruthIsAnError) {
  const TempFolder folder;
  write_tum(folder);
  folder.write("camera.json", kNumberedCameraJson);
  folder.write("groundtruth.txt", "1 2 3\n");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("groundtruth.txt: trajectory, line 1"));
}

TEST(TumSequence, TheCameraIsGivenOrReadOrKnownOrAnError) {
  const TempFolder folder;
  write_tum(folder);
  EXPECT_THAT(error_of(folder.path()), HasSubstr("does not say which camera took it"));
  folder.write("groundtruth.txt", "# file: 'rgbd_dataset_freiburg2_xyz.bag'\n1 0 0 0 0 0 0 1\n");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("the camera 640x480"))
      << "the benchmark's name in a comment gives its camera";
  folder.write("camera.json", kNumberedCameraJson);
  EXPECT_EQ((*source::open_sequence(folder.path()))->camera().fx, 70)
      << "camera.json comes before the name";
  const Camera given{80, 64, 75, 75, 40, 32, 1000};
  EXPECT_EQ((*source::open_sequence(folder.path(), given))->camera(), given);
  EXPECT_FALSE(source::open_sequence(folder.path(), Camera{80, 64, -75, 75, 40, 32, 1000}).ok());
  folder.write("camera.json", "{}");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("camera.json: \"width\" is missing"));
}

void write_icl(const TempFolder& folder) {
  for (int i = 0; i < 3; ++i) {
    folder.write("rgb/" + std::to_string(i) + ".png", color_png(i));
    folder.write("depth/" + std::to_string(i) + ".png", depth_png(i));
  }
  folder.write("camera.json", kNumberedCameraJson);
}

TEST(IclNuimSequence, NumbersAreFramesAtThirtyHertz) {
  const TempFolder folder;
  write_icl(folder);
  for (const char* associations :
       {"0 depth/0.png 0 rgb/0.png\n1 depth/1.png 1 rgb/1.png\n2 depth/2.png 2 rgb/2.png\n",
        "0 rgb/0.png 0 depth/0.png\n1 rgb/1.png 1 depth/1.png\n2 rgb/2.png 2 depth/2.png\n"}) {
    folder.write("associations.txt", associations);
    const auto opened = source::open_sequence(folder.path());
    ASSERT_TRUE(opened.ok()) << opened.error().message;
    EXPECT_EQ((*opened)->format(), "icl-nuim");
    ASSERT_EQ((*opened)->frame_count(), 3);
    EXPECT_DOUBLE_EQ((*opened)->timestamp_s(2), 2 / 30.0);
    EXPECT_EQ((*opened)->read(2)->depth, depth_of(2));
    EXPECT_EQ((*opened)->read(2)->color_bytes, color_png(2));
  }
}

TEST(IclNuimSequence, WithoutAssociationsNumbersPair) {
  const TempFolder folder;
  write_icl(folder);
  folder.write("rgb/10.png", color_png(3));
  const auto opened = source::open_sequence(folder.path());
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  EXPECT_EQ((*opened)->format(), "icl-nuim");
  EXPECT_EQ((*opened)->frame_count(), 3);
}

TEST(IclNuimSequence, ItsCameraIsKnown) {
  const TempFolder folder;
  write_icl(folder);
  std::filesystem::remove(folder.path("camera.json"));
  folder.write("depth/0.png", *image::encode_depth_png(depth_of(0, 640, 480)));
  const auto opened = source::open_sequence(folder.path());
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  EXPECT_EQ((*opened)->camera(), (Camera{640, 480, 481.2, 480, 319.5, 239.5, 5000}));
}

// A point seen at image row v under ICL-NUIM's camera (fy = -480) must be the same world point, up
// to the reflection of that world, as under ours (fy = +480).
TEST(IclNuimSequence, PosesAreReflectedIntoARigidWorld) {
  const TempFolder folder;
  write_icl(folder);
  folder.write("living.gt.freiburg", "1 0.5 -1.5 2 0.1825742 0.3651484 0.5477226 0.7302967\n");
  const auto opened = source::open_sequence(folder.path());
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  ASSERT_EQ((*opened)->groundtruth().size(), 1u);
  const TimedPose& pose = (*opened)->groundtruth()[0];
  EXPECT_DOUBLE_EQ(pose.timestamp_s, 1 / 30.0);

  const Rigid3 published{
      Eigen::Quaterniond(0.7302967, 0.1825742, 0.3651484, 0.5477226).normalized(), {0.5, -1.5, 2}};
  const Eigen::DiagonalMatrix<double, 3> reflection(1, -1, 1);
  const double u = 100, v = 400, depth_m = 1.7;
  const Eigen::Vector3d in_their_camera((u - 319.5) / 481.2 * depth_m, (v - 239.5) / -480 * depth_m,
                                        depth_m);
  const Eigen::Vector3d in_our_camera = known_camera("icl-nuim")->unproject(u, v, depth_m);
  const Eigen::Vector3d in_their_world = published * in_their_camera;
  const Eigen::Vector3d in_our_world = pose.world_from_camera * in_our_camera;
  EXPECT_LT((in_our_world - reflection * in_their_world).norm(), 1e-12);
}

TEST(IclNuimSequence, BadLinesAreNamed) {
  const TempFolder folder;
  write_icl(folder);
  for (const char* line : {"0 depth/0.png 0", "0 depth/0.png x rgb/0.png", "0 ../0.png 0 rgb/0.png",
                           "0 rgb/0.png 0 rgb/1.png", "0 depth/0.png 0 depth/1.png"}) {
    folder.write("associations.txt", std::string("0 depth/0.png 0 rgb/0.png\n") + line + "\n");
    EXPECT_THAT(error_of(folder.path()), HasSubstr("associations.txt, line 2")) << line;
  }
  std::filesystem::remove(folder.path("associations.txt"));
  folder.write("x.gt.freiburg", "0.5 0 0 0 0 0 0 1\n");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("is not whole"));
}

std::string frame_file(int number, const std::string& kind) {
  return "frame-00000" + std::to_string(number) + "." + kind;
}

void write_seven_scenes(const TempFolder& folder) {
  for (int i = 0; i < 3; ++i) {
    folder.write(frame_file(i, "color.jpg"), color_jpeg(i));
    folder.write(frame_file(i, "depth.png"), depth_png(i));
    folder.write(frame_file(i, "pose.txt"),
                 "1 0 0 " + std::to_string(i) + "\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  }
  folder.write("camera-intrinsics.txt", "7.0e+01 0 40\n0 70.0 32\n0 0 1\n");
}

TEST(SevenScenesSequence, ReadsFramesPosesAndIntrinsics) {
  const TempFolder folder;
  write_seven_scenes(folder);
  DepthImage with_holes = depth_of(2);
  with_holes.at(5, 6) = 65535;
  with_holes.at(6, 6) = 0;
  folder.write(frame_file(2, "depth.png"), *image::encode_depth_png(with_holes));
  const auto opened = source::open_sequence(folder.path());
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  const Sequence& sequence = **opened;
  EXPECT_EQ(sequence.format(), "7-scenes");
  EXPECT_EQ(sequence.frame_count(), 3);
  EXPECT_EQ(sequence.camera(), (Camera{80, 64, 70, 70, 40, 32, 1000}));
  EXPECT_DOUBLE_EQ(sequence.timestamp_s(2), 2 / 30.0);
  ASSERT_EQ(sequence.groundtruth().size(), 3u);
  EXPECT_EQ(sequence.groundtruth()[2].world_from_camera.translation, Eigen::Vector3d(2, 0, 0));
  const auto frame = sequence.read(2);
  ASSERT_TRUE(frame.ok()) << frame.error().message;
  EXPECT_EQ(frame->depth.at(5, 6), 0) << "65535 is no measurement";
  EXPECT_EQ(frame->depth.at(6, 6), 0);
  EXPECT_EQ(frame->depth.at(7, 6), with_holes.at(7, 6));
}

TEST(SevenScenesSequence, FrameNumbersGiveTimesAcrossGaps) {
  const TempFolder folder;
  write_seven_scenes(folder);
  for (const char* kind : {"color.jpg", "depth.png", "pose.txt"})
    std::filesystem::remove(folder.path(frame_file(1, kind)));
  const auto opened = source::open_sequence(folder.path());
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  EXPECT_EQ((*opened)->frame_count(), 2);
  EXPECT_DOUBLE_EQ((*opened)->timestamp_s(1), 2 / 30.0);
}

TEST(SevenScenesSequence, AMissingHalfIsAnErrorOfThatFrameAlone) {
  const TempFolder folder;
  write_seven_scenes(folder);
  std::filesystem::remove(folder.path(frame_file(1, "color.jpg")));
  std::filesystem::remove(folder.path(frame_file(2, "depth.png")));
  const auto opened = source::open_sequence(folder.path());
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  EXPECT_EQ((*opened)->frame_count(), 3);
  EXPECT_TRUE((*opened)->read(0).ok());
  EXPECT_EQ((*opened)->read(1).error().code, ErrorCode::kNotFound);
  EXPECT_EQ((*opened)->read(2).error().code, ErrorCode::kNotFound);
}

TEST(SevenScenesSequence, LostPosesAreLeftOutAndWrongOnesAreErrors) {
  const TempFolder folder;
  write_seven_scenes(folder);
  folder.write(frame_file(1, "pose.txt"),
               "nan nan nan nan\nnan nan nan nan\nnan nan nan nan\n0 0 0 1\n");
  const auto opened = source::open_sequence(folder.path());
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  EXPECT_EQ((*opened)->groundtruth().size(), 2u);
  EXPECT_EQ((*opened)->frame_count(), 3);
  for (const char* pose :
       {"1 0 0\n0 1 0\n0 0 1\n0 0 0\n", "1 0 0 0\n0 1 0 0\n0 0 1 0\n",
        "2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "-1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n",
        "1 0 0 x\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"}) {
    folder.write(frame_file(1, "pose.txt"), pose);
    EXPECT_THAT(error_of(folder.path()), HasSubstr("frame-000001.pose.txt")) << pose;
  }
}

// 7-Scenes' own camera, and what its folders may say of colour.
TEST(SevenScenesSequence, TheBenchmarksKinectHasAColourCameraUnlessTheFolderSaysOtherwise) {
  const TempFolder folder;
  write_seven_scenes(folder);
  EXPECT_FALSE((*source::open_sequence(folder.path()))->camera().color.has_value())
      << "another camera";
  folder.write(frame_file(0, "depth.png"), *image::encode_depth_png(depth_of(0, 640, 480)));
  folder.write("camera-intrinsics.txt", "585 0 320\n0 585 240\n0 0 1\n");
  const Camera by_intrinsics = (*source::open_sequence(folder.path()))->camera();
  ASSERT_TRUE(by_intrinsics.color.has_value());
  EXPECT_TRUE(validate(by_intrinsics).ok());
  EXPECT_EQ(by_intrinsics.color->fx, 525);
  EXPECT_NEAR(by_intrinsics.color->color_from_depth.translation.x(), -0.0256, 1e-4)
      << "the colour lens is to the right of the depth lens";

  const auto with_json = [&](const std::string& more) {
    folder.write("camera.json",
                 R"({"width": 640, "height": 480, "fx": 585, "fy": 585, "cx": 320, "cy": 240, )"
                 R"("depth_units_per_metre": 1000)" +
                     more + "}");
    return (*source::open_sequence(folder.path()))->camera();
  };
  EXPECT_EQ(with_json(""), by_intrinsics);
  EXPECT_FALSE(with_json(R"(, "color_camera": null)").color.has_value());
  const Camera told =
      with_json(R"(, "color_camera": {"fx": 500, "fy": 500, "cx": 320, "cy": 240, )"
                R"("color_from_depth": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]})");
  EXPECT_EQ(told.color->fx, 500);
  const Camera given{640, 480, 585, 585, 320, 240, 1000};
  EXPECT_EQ((*source::open_sequence(folder.path(), given))->camera(), given)
      << "a given camera is taken at its word";
}

TEST(SevenScenesSequence, WithoutIntrinsicsTheErrorSaysWhatToGive) {
  const TempFolder folder;
  write_seven_scenes(folder);
  std::filesystem::remove(folder.path("camera-intrinsics.txt"));
  EXPECT_THAT(error_of(folder.path()), HasSubstr("does not say which camera took it"));
  folder.write("camera-intrinsics.txt", "70 0 40\n0 70 32\n");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("camera-intrinsics.txt has 2 lines, expected 3"));
}

TEST(Sequence, DecodingAFrameGivesItsColour) {
  RecordedFrame recorded{1.5, depth_of(1), color_png(2)};
  const auto frame = decode_frame(recorded);
  ASSERT_TRUE(frame.ok()) << frame.error().message;
  EXPECT_EQ(frame->timestamp_s, 1.5);
  EXPECT_EQ(frame->depth, depth_of(1));
  EXPECT_EQ(frame->color, color_of(2));
  recorded.color_bytes.resize(recorded.color_bytes.size() / 2);
  EXPECT_THAT(decode_frame(recorded).error().message, HasSubstr("colour image"));
  EXPECT_FALSE(decode_frame({1.5, depth_of(1), *image::encode_png(color_of(1, 96, 64))}).ok());
}

struct RealData {
  const char* folder;
  const char* format;
  std::int64_t frame_count;
  double fx;
};

class RealSequence : public testing::TestWithParam<RealData> {};

TEST_P(RealSequence, OpensWithItsFramesAndGroundTruth) {
  const auto folder = test::data_folder(GetParam().folder);
  if (!folder) GTEST_SKIP() << test::skip_message(GetParam().folder);
  const auto opened = source::open_sequence(folder->string());
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  const Sequence& sequence = **opened;
  EXPECT_EQ(sequence.format(), GetParam().format);
  EXPECT_EQ(sequence.frame_count(), GetParam().frame_count);
  EXPECT_EQ(sequence.camera().fx, GetParam().fx);
  EXPECT_EQ(sequence.frame_rate_hz(), 30);
  EXPECT_GE(sequence.groundtruth().size(), static_cast<std::size_t>(sequence.frame_count()));
  for (std::int64_t i = 1; i < sequence.frame_count(); ++i)
    ASSERT_GT(sequence.timestamp_s(i), sequence.timestamp_s(i - 1));
  for (const std::int64_t i :
       {std::int64_t{0}, sequence.frame_count() / 2, sequence.frame_count() - 1}) {
    auto frame = sequence.read(i);
    ASSERT_TRUE(frame.ok()) << frame.error().message;
    const auto decoded = decode_frame(std::move(*frame));
    ASSERT_TRUE(decoded.ok()) << decoded.error().message;
    EXPECT_GT(std::count_if(decoded->depth.pixels.begin(), decoded->depth.pixels.end(),
                            [](std::uint16_t value) { return value > 0; }),
              640 * 480 / 4);
  }
}

INSTANTIATE_TEST_SUITE_P(All, RealSequence,
                         testing::Values(RealData{"redkitchen", "7-scenes", 1000, 585},
                                         RealData{"tum_fr1_rpy_part", "tum", 140, 517.3},
                                         RealData{"living_room_part", "tum", 225, 525}),
                         [](const auto& info) { return std::string(info.param.folder); });

}  // namespace
}  // namespace hermite::dataset
