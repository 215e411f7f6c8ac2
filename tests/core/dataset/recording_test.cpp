#include "core/dataset/recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>

#include "core/dataset/write_frame_log.h"
#include "core/dataset/write_klg.h"
#include "core/dataset/write_raw.h"
#include "core/dataset/write_tum.h"
#include "core/source/open_sequence.h"
#include "tests/core/dataset/oni_bytes.h"
#include "tests/core/dataset/recording_bytes.h"
#include "tests/core/dataset/rendered_once.h"
#include "tests/core/dataset/temp_folder.h"
#include "tests/support/archive_bytes.h"
#include "tests/support/data_folder.h"
#include "tests/support/file_bytes.h"
#include "tests/support/joined.h"
#include "tests/support/memory_peak.h"

namespace hermite::dataset {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const char* const kSource = "synthetic:frames=4,width=96,height=72";
const WriteProgress kSilent = [](std::int64_t) {};

std::string number(std::int64_t value, int digits) {
  std::string text = std::to_string(value);
  return std::string(static_cast<std::size_t>(digits) - text.size(), '0') + text;
}

const char* const kCameraJson =
    R"({"width": 96, "height": 72, "fx": 80, "fy": 80, "cx": 48, "cy": 36, )"
    R"("depth_units_per_metre": 5000, "frame_rate_hz": 20})";

void write_redwood(const TempFolder& folder, const Sequence& source, bool with_times) {
  for (std::int64_t i = 0; i < source.frame_count(); ++i) {
    const auto frame = *source.read(i);
    const std::string name = number(i + 1, 7) + (with_times ? "-" + number(33'333 * i, 12) : "");
    folder.write("stone_png/depth/" + name + ".png", *image::encode_depth_png(frame.depth));
    folder.write("stone_png/color/" + name + ".png", frame.color_bytes);
  }
  folder.write("stone_trajectory.log", test::redwood_log(source.groundtruth()));
}

// "DEPTH/000000.png" and "COLOR/000000.png" and so on, between the names given.
struct ImageNames {
  std::string depth_prefix, depth_suffix, color_prefix, color_suffix;
};
void write_images(const TempFolder& folder, const Sequence& source, const ImageNames& names) {
  for (std::int64_t i = 0; i < source.frame_count(); ++i) {
    const auto frame = *source.read(i);
    folder.write("r/" + names.depth_prefix + number(i, 6) + names.depth_suffix,
                 *image::encode_depth_png(frame.depth));
    folder.write("r/" + names.color_prefix + number(i, 6) + names.color_suffix, frame.color_bytes);
  }
  folder.write("r/camera.json", kCameraJson);
}

// Every regular file below a folder, as entries of an archive.
std::vector<test::ArchiveEntry> entries_of(const std::string& folder, const std::string& prefix) {
  std::vector<test::ArchiveEntry> entries;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    const auto bytes = test::file_bytes(entry.path());
    entries.push_back({prefix + entry.path().lexically_relative(folder).string(),
                       std::string(bytes.begin(), bytes.end())});
  }
  std::sort(entries.begin(), entries.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  return entries;
}

void expect_equal(const Sequence& found, const Sequence& source, std::int64_t count) {
  ASSERT_EQ(found.frame_count(), count);
  for (std::int64_t i = 0; i < count; ++i) {
    const auto frame = found.read(i), expected = source.read(i);
    ASSERT_TRUE(frame.ok()) << frame.error().message;
    EXPECT_EQ(frame->timestamp_s, expected->timestamp_s) << "the same bits";
    EXPECT_EQ(frame->depth, expected->depth);
    EXPECT_EQ(frame->color_bytes, expected->color_bytes);
  }
}

TEST(Recording, RedwoodIsImagesWithALogOfPoses) {
  const test::RenderedOnce source("synthetic:frames=4,width=640,height=480");
  for (const bool with_times : {false, true}) {
    const TempFolder folder;
    write_redwood(folder, source, with_times);
    const auto recording = open_recording(folder.path());
    ASSERT_TRUE(recording.ok()) << recording.error().message;
    const Sequence& found = *recording->sequence;
    EXPECT_EQ(found.format(), "redwood");
    EXPECT_EQ(found.camera().fx, 525);
    EXPECT_THAT(recording->format_reason, HasSubstr("stone_trajectory.log"));
    EXPECT_THAT(test::joined(recording->doubts), HasSubstr("assumed to be Redwood's"));
    ASSERT_EQ(found.frame_count(), 4);
    EXPECT_EQ(found.read(2)->depth, source.read(2)->depth);
    EXPECT_NEAR(found.timestamp_s(3) - found.timestamp_s(0), 0.1, 1e-5);
    ASSERT_EQ(found.groundtruth().size(), 4u);
    EXPECT_EQ(found.groundtruth()[1].timestamp_s, found.timestamp_s(1));
    EXPECT_LT((found.groundtruth()[3].world_from_camera.translation -
               source.groundtruth()[3].world_from_camera.translation)
                  .norm(),
              1e-6);
  }
}

TEST(Recording, DamagedLogsNameTheLine) {
  const auto source = *source::open_sequence(kSource);
  const TempFolder folder;
  write_redwood(folder, *source, false);
  folder.write("camera.json", kCameraJson);
  const std::string log = test::redwood_log(source->groundtruth());
  const auto error_with = [&](const std::string& text) {
    folder.write("stone_trajectory.log", text);
    const auto recording = open_recording(folder.path());
    return recording.ok() ? "opened" : recording.error().message;
  };
  EXPECT_EQ(error_with(log), "opened");
  EXPECT_THAT(error_with(log + "4 4 5\n"), HasSubstr("not 5 for each pose"));
  EXPECT_THAT(error_with(log + log), HasSubstr("line 21: the frame is not after"));
  EXPECT_THAT(error_with(log + "4 4 5\n1 0 0 0\n0 1 0 0\n0 0 2 0\n0 0 0 1\n"),
              HasSubstr("not a rigid transform"));
  EXPECT_THAT(error_with(log + "4 4 5\n1 0 0 nan\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"),
              HasSubstr("not a finite number"));
  EXPECT_EQ(error_with(log + "9 9 10\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"), "opened");
  EXPECT_THAT(test::joined(open_recording(folder.path())->doubts),
              HasSubstr("poses of frames from 9 on"));
}

TEST(Recording, AnybodysImagesNeedACamera) {
  const auto source = *source::open_sequence(kSource);
  for (const bool one_folder : {false, true}) {
    const TempFolder folder;
    for (std::int64_t i = 0; i < 4; ++i) {
      const auto frame = *source->read(i);
      folder.write(one_folder ? "depth_" + number(10 + i, 4) + ".png"
                              : "my-depth/" + number(10 + i, 4) + ".png",
                   *image::encode_depth_png(frame.depth));
      folder.write(one_folder ? "image_" + number(10 + i, 4) + ".png"
                              : "my-rgb/" + number(10 + i, 4) + ".png",
                   frame.color_bytes);
    }
    EXPECT_FALSE(open_recording(folder.path()).ok());
    folder.write("camera.json", kCameraJson);
    const auto recording = open_recording(folder.path());
    ASSERT_TRUE(recording.ok()) << recording.error().message;
    EXPECT_EQ(recording->sequence->format(), "images");
    EXPECT_EQ(recording->sequence->timestamp_s(1), 11 / 20.0);
    EXPECT_EQ(recording->sequence->read(3)->depth, source->read(3)->depth);
    EXPECT_THAT(test::joined(recording->doubts), HasSubstr("say no times"));
  }
}

TEST(Recording, SeveralInAFolderAreNotGuessedAt) {
  const auto source = *source::open_sequence(kSource);
  const TempFolder folder;
  folder.write("one.sens", test::sens_bytes(*source));
  folder.write("notes.txt", "words");
  ASSERT_TRUE(open_recording(folder.path()).ok());
  folder.write("two.sens", test::sens_bytes(*source));
  EXPECT_THAT(open_recording(folder.path()).error().message, HasSubstr("holds 2 recordings"));
  EXPECT_EQ(open_recording(folder.path("notes.txt")).error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(open_recording(folder.path("nowhere")).error().code, ErrorCode::kNotFound);
}

TEST(Recording, NamesDoNotDecide) {
  const auto source = *source::open_sequence(kSource);
  const TempFolder folder;
  folder.write("really.klg", test::sens_bytes(*source));
  EXPECT_EQ((*source::open_sequence(folder.path("really.klg")))->format(), "sens");
  folder.write("a.tar", "no archive");
  EXPECT_EQ(open_recording(folder.path("a.tar")).error().code, ErrorCode::kUnsupported);
}

// A camera with everything that camera.json can say.
Camera full_camera() {
  return {96,
          72,
          80,
          81,
          47,
          36,
          5000,
          {0.01, -0.02, 0.001, 0.002, 0.003},
          ColorCamera{75,
                      76,
                      48,
                      35,
                      {0.02, 0, 0, 0, 0},
                      {Eigen::Quaterniond(Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY())),
                       {-0.025, 0, 0.001}}}};
}

TEST(WriteTum, ReadsBackBitForBit) {
  const auto source =
      *source::open_sequence("synthetic:frames=5,width=96,height=72,noise=kinect", full_camera());
  const TempFolder folder;
  const auto summary = write_tum(*source, {0, 5}, folder.path("out"), kSilent);
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_EQ(summary->frame_count, 5);
  const auto found = *source::open_sequence(folder.path("out"));
  EXPECT_EQ(found->format(), "tum");
  expect_equal(*found, *source, 5);
  EXPECT_EQ(found->camera().distortion, source->camera().distortion);
  EXPECT_EQ(found->camera().fy, 81);
  EXPECT_EQ(found->camera().color->distortion, source->camera().color->distortion);
  EXPECT_LT(angle_rad(found->camera().color->color_from_depth.rotation.conjugate() *
                      source->camera().color->color_from_depth.rotation),
            1e-9);
  EXPECT_EQ(found->groundtruth().size(), 5u);
  EXPECT_THAT(write_tum(*source, {0, 5}, folder.path("out"), kSilent).error().message,
              HasSubstr("is not empty"));
}

TEST(WriteRaw, ReadsBackBitForBit) {
  const auto source = *source::open_sequence(kSource);
  const TempFolder folder;
  ASSERT_TRUE(write_raw(*source, {1, 4}, folder.path("a.raw"), kSilent).ok());
  const auto found = *source::open_sequence(folder.path("a.raw"));
  ASSERT_EQ(found->frame_count(), 3);
  EXPECT_EQ(found->camera(), source->camera());
  for (std::int64_t i = 0; i < 3; ++i) {
    const frame::RgbdFrame frame = test::frame_of(*found, i),
                           expected = test::frame_of(*source, i + 1);
    EXPECT_EQ(frame.timestamp_s, expected.timestamp_s);
    EXPECT_EQ(frame.depth, expected.depth);
    EXPECT_EQ(frame.color, expected.color);
  }
  EXPECT_THAT(write_raw(*source, {0, 4}, folder.path("a.raw"), kSilent).error().message,
              HasSubstr("exists already"));
}

TEST(WriteKlg, MillimetresReadBackBitForBitOthersWithARemark) {
  Camera millimetres{96, 72, 80, 80, 47, 36, 1000};
  const auto source = *source::open_sequence(kSource, millimetres);
  const TempFolder folder;
  const auto summary = write_klg(*source, {0, 4}, folder.path("a.klg"), kSilent);
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_THAT(test::joined(summary->remarks), testing::Not(HasSubstr("millimetres")));
  const auto found = *source::open_sequence(folder.path("a.klg"));
  EXPECT_EQ(found->camera(), millimetres);
  EXPECT_EQ(found->groundtruth().size(), 4u);
  for (std::int64_t i = 0; i < 4; ++i) {
    EXPECT_EQ(found->read(i)->depth, source->read(i)->depth);
    EXPECT_EQ(test::frame_of(*found, i).color, test::frame_of(*source, i).color);
    EXPECT_NEAR(found->timestamp_s(i), source->timestamp_s(i), 1e-6);
  }
  const auto fifths =
      write_klg(**source::open_sequence(kSource), {0, 4}, folder.path("b.klg"), kSilent);
  EXPECT_THAT(test::joined(fifths->remarks), HasSubstr("rounded to millimetres"));
  EXPECT_NEAR((*source::open_sequence(folder.path("b.klg")))->read(1)->depth.at(40, 30),
              (*source::open_sequence(kSource))->read(1)->depth.at(40, 30) / 5.0, 0.51);
}

TEST(Recording, ArchivesGiveTheSameFramesAndLeaveNothing) {
  const auto source = *source::open_sequence(kSource);
  const TempFolder folder, temporary;
  ASSERT_TRUE(write_tum(*source, {0, 4}, folder.path("out"), kSilent).ok());
  const auto entries = entries_of(folder.path("out"), "kitchen/");
  const std::string tar = test::tar_bytes(entries);
  const char* before = std::getenv("TMPDIR");
  setenv("TMPDIR", temporary.path().c_str(), 1);
  for (const std::string& bytes :
       {tar, test::gzip_bytes(tar), test::zstd_bytes(tar), test::zip_bytes(entries)}) {
    folder.write("kitchen.tar.zst", bytes);
    {
      const auto recording = open_recording(folder.path("kitchen.tar.zst"));
      ASSERT_TRUE(recording.ok()) << recording.error().message;
      EXPECT_THAT(recording->format_reason, HasSubstr("in an archive ("));
      EXPECT_EQ(recording->sequence->name(), "kitchen");
      expect_equal(*recording->sequence, *source, 4);
    }
    EXPECT_TRUE(fs::is_empty(temporary.path())) << "the unpacked files go with the sequence";
  }
  folder.write("evil.tar", test::tar_bytes({{"../../evil", "x"}}));
  EXPECT_THAT(open_recording(folder.path("evil.tar")).error().message,
              HasSubstr("leads out of the folder"));
  EXPECT_TRUE(fs::is_empty(temporary.path()));
  before != nullptr ? setenv("TMPDIR", before, 1) : unsetenv("TMPDIR");
}

// Whatever is damaged: an error or a sequence all of whose frames give errors or images, and little
// memory.
class Damaged : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const auto source = *source::open_sequence("synthetic:frames=3,width=96,height=72");
    const std::string kind = GetParam();
    if (kind == "klg") {
      fs::create_directories(folder.path("r"));
      ASSERT_TRUE(write_klg(*source, {0, 3}, folder.path("r/a.klg"), kSilent).ok());
    } else if (kind == "sens") {
      folder.write("r/a.sens", test::sens_bytes(*source));
    } else if (kind == "oni") {
      folder.write("r/a.oni", test::oni_bytes(*source));
    } else if (kind == "raw") {
      fs::create_directories(folder.path("r"));
      ASSERT_TRUE(write_raw(*source, {0, 3}, folder.path("r/a.raw"), kSilent).ok());
    } else if (kind == "redwood") {
      const TempFolder made;
      write_redwood(made, *source, true);
      fs::copy(made.path(), folder.path("r"), fs::copy_options::recursive);
      folder.write("r/camera.json", kCameraJson);
    } else if (kind == "7scenes") {
      write_images(folder, *source, {"frame-", ".depth.png", "frame-", ".color.png"});
    } else if (kind == "icl") {
      write_images(folder, *source, {"depth/", ".png", "rgb/", ".png"});
    } else if (kind == "images") {
      write_images(folder, *source, {"depth_images/d", ".png", "color_images/c", ".png"});
    } else if (kind == "log") {
      ASSERT_TRUE(write_frame_log(*source, {0, 3}, folder.path("r"), kSilent).ok());
    } else {
      ASSERT_TRUE(write_tum(*source, {0, 3}, folder.path("t"), kSilent).ok());
      pack(kind);
    }
    for (const auto& entry : fs::recursive_directory_iterator(folder.path("r")))
      if (entry.is_regular_file()) files[entry.path().string()] = test::file_bytes(entry.path());
    for (const auto& [path, bytes] : files) all_bytes += bytes.size();
  }

  void pack(const std::string& kind) {
    const auto entries = entries_of(folder.path("t"), "");
    const std::string tar = test::tar_bytes(entries);
    if (kind == "tum") fs::rename(folder.path("t"), folder.path("r"));
    if (kind == "tar") folder.write("r/a", tar);
    if (kind == "tar.gz") folder.write("r/a", test::gzip_bytes(tar));
    if (kind == "tar.zst") folder.write("r/a", test::zstd_bytes(tar));
    if (kind == "zip") folder.write("r/a", test::zip_bytes(entries));
  }

  // The file that has byte `at` of all, damaged there; the others whole.
  void damage(std::size_t at, const std::function<void(test::Bytes&, std::size_t)>& change) {
    for (const auto& [path, whole] : files) {
      if (at < whole.size()) {
        test::Bytes bytes = whole;
        change(bytes, at);
        std::ofstream(path, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size()));
        look();
        std::ofstream(path, std::ios::binary)
            .write(reinterpret_cast<const char*>(whole.data()),
                   static_cast<std::streamsize>(whole.size()));
        return;
      }
      at -= whole.size();
    }
  }

  void look() {
    const bool is_file = files.size() == 1 && std::string(GetParam()) != "log";
    const std::string path = is_file ? files.begin()->first : folder.path("r");
    const auto recording = open_recording(path);
    if (!recording.ok()) {
      ++refused;
      EXPECT_GT(recording.error().message.size(), 20u);
      return;
    }
    // A frame log is read up to where it was cut, and says so.
    if (test::joined(recording->doubts).find("cut") != std::string::npos) ++cut;
    for (std::int64_t i = 0; i < recording->sequence->frame_count(); ++i) {
      const auto frame = recording->sequence->read(i);
      const auto decoded =
          frame.ok() ? decode_frame(*frame) : Result<frame::RgbdFrame>(frame.error());
      if (decoded.ok()) continue;
      ++bad_frames;
      EXPECT_GT(decoded.error().message.size(), 10u);
    }
  }

  const TempFolder folder;
  std::map<std::string, test::Bytes> files;
  std::size_t all_bytes = 0;
  int refused = 0, bad_frames = 0, cut = 0;
};

TEST_P(Damaged, GivesAMessageInBoundedMemory) {
  look();
  ASSERT_EQ(refused + bad_frames + cut, 0) << "whole to begin with";
  const std::size_t peak = test::peak_growth_bytes([&] {
    for (std::size_t i = 0; i < 20; ++i)
      damage(all_bytes * i / 20, [](test::Bytes& bytes, std::size_t at) { bytes.resize(at); });
    EXPECT_GT(refused + bad_frames + cut, 10);
    std::uint64_t state = 7;  // a fixed sequence of places
    for (int i = 0; i < 200; ++i) {
      state = state * 6364136223846793005u + 1442695040888963407u;
      const int bit = static_cast<int>(state >> 61);
      damage((state >> 16) % all_bytes, [bit](test::Bytes& bytes, std::size_t at) {
        bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ 1 << bit);
      });
    }
  });
  // Of it the unpacked archives and images are little; zstd may take its window, sanitizers keep
  // what was freed.
  EXPECT_LT(peak, std::size_t{400} << 20);
}

INSTANTIATE_TEST_SUITE_P(Every, Damaged,
                         testing::Values("klg", "sens", "oni", "raw", "redwood", "7scenes", "icl",
                                         "images", "log", "tum", "tar", "tar.gz", "tar.zst", "zip"),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

class RealRoundTrip : public testing::TestWithParam<const char*> {};

TEST_P(RealRoundTrip, TumAndArchiveKeepEveryBit) {
  const auto data = test::data_folder(GetParam());
  if (!data) GTEST_SKIP() << test::skip_message(GetParam());
  const auto source = *source::open_sequence(data->string());
  const TempFolder folder;
  ASSERT_TRUE(write_tum(*source, {0, 6}, folder.path("out"), kSilent).ok());
  expect_equal(**source::open_sequence(folder.path("out")), *source, 6);
  folder.write("a.tar.zst",
               test::zstd_bytes(test::tar_bytes(entries_of(folder.path("out"), "x/"))));
  expect_equal(**source::open_sequence(folder.path("a.tar.zst")), *source, 6);
  if (source->camera().depth_units_per_metre != 1000) return;
  ASSERT_TRUE(write_klg(*source, {0, 6}, folder.path("a.klg"), kSilent).ok());
  const auto klg = *source::open_sequence(folder.path("a.klg"));
  for (std::int64_t i = 0; i < 6; ++i) {
    EXPECT_EQ(klg->read(i)->depth, source->read(i)->depth);
    EXPECT_EQ(klg->read(i)->color_bytes, source->read(i)->color_bytes);
  }
  for (const char* const codec : {"16zP", "16zT"}) {
    folder.write("a.oni",
                 test::oni_bytes(*source, {.depth_codec = codec, .color_codec = "NONE"}, 6));
    const auto oni = *source::open_sequence(folder.path("a.oni"));
    ASSERT_EQ(oni->frame_count(), 6);
    for (std::int64_t i = 0; i < 6; ++i) {
      EXPECT_EQ(oni->read(i)->depth, source->read(i)->depth);
      EXPECT_EQ(decode_frame(*oni->read(i))->color, decode_frame(*source->read(i))->color);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, RealRoundTrip,
                         testing::Values("redkitchen", "tum_fr1_rpy_part", "living_room_part"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace hermite::dataset
