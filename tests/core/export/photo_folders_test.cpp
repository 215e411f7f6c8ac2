// The folders of colmap.h and nerfstudio.h, of a synthetic room whose poses are known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/dataset/changed_sequence.h"
#include "core/dataset/recording.h"
#include "core/dataset/text_file.h"
#include "core/export/colmap.h"
#include "core/export/nerfstudio.h"
#include "core/image/image_codec.h"
#include "core/output/ply_reader.h"
#include "core/source/open_sequence.h"
#include "tests/support/temporary_folder.h"

namespace hermite::exports {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

bool go_on(std::int64_t, std::int64_t) { return true; }

// Every fourth pixel of the first frame as a cloud in the world.
output::Cloud cloud_of_first_frame(const dataset::Sequence& sequence) {
  const frame::RgbdFrame frame = or_throw(dataset::decode_frame(or_throw(sequence.read(0))));
  const Rigid3 world_from_camera =
      *dataset::pose_at(sequence.groundtruth(), sequence.timestamp_s(0), 1e-3);
  output::Cloud cloud;
  for (int v = 0; v < frame.depth.height; v += 4)
    for (int u = 0; u < frame.depth.width; u += 4) {
      const double depth_m = frame.depth.at(u, v) / sequence.camera().depth_units_per_metre;
      if (depth_m <= 0) continue;
      output::CloudPoint point;
      const Eigen::Vector3d in_camera = sequence.camera().unproject(u, v, depth_m);
      point.position_m = (world_from_camera * in_camera).cast<float>();
      point.normal = (world_from_camera.rotation * -in_camera.normalized()).cast<float>();
      point.color = frame.color.at(u, v);
      cloud.push_back(point);
    }
  return cloud;
}

class PhotoFolders : public ::testing::Test {
 protected:
  PhotoFolders()
      : sequence_(or_throw(source::open_sequence("synthetic:frames=30,width=160,height=120"))),
        cloud_(cloud_of_first_frame(*sequence_)) {}
  PhotoSource source() const { return {*sequence_, sequence_->groundtruth(), cloud_}; }
  std::string text(const std::string& name) const {
    return or_throw(dataset::read_text_file(folder_ / name));
  }

  const test::TemporaryFolder folder_;
  const std::unique_ptr<dataset::Sequence> sequence_;
  const output::Cloud cloud_;
};

struct ReadPoint {
  Eigen::Vector3d position_m;
  std::vector<std::pair<int, int>> track;  // image id, place in it
};
std::map<int, ReadPoint> read_points(const std::string& text) {
  std::map<int, ReadPoint> points;
  for (const dataset::TextLine& line : dataset::data_lines(text)) {
    std::istringstream words{std::string(line.text)};
    int id = 0, r = 0, g = 0, b = 0, image = 0, place = 0;
    double error = 0;
    ReadPoint point;
    words >> id >> point.position_m.x() >> point.position_m.y() >> point.position_m.z() >> r >> g >>
        b >> error;
    while (words >> image >> place) point.track.emplace_back(image, place);
    points[id] = point;
  }
  return points;
}

TEST_F(PhotoFolders, ColmapsPointsProjectWhereItsImagesSay) {
  const auto summary = write_colmap(source(), {.most_points = 300}, folder_ / "a model", go_on);
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_GE(summary->image_count, 3u);
  EXPECT_LE(summary->point_count, 300u);
  std::istringstream camera(
      std::string(dataset::data_lines(text("a model/sparse/0/cameras.txt"))[0].text));
  std::string id, model;
  double width = 0, height = 0, fx = 0, fy = 0, cx = 0, cy = 0;
  camera >> id >> model >> width >> height >> fx >> fy >> cx >> cy;
  EXPECT_EQ(model, "PINHOLE");
  EXPECT_EQ(cx, sequence_->camera().cx + 0.5);
  const std::map<int, ReadPoint> points = read_points(text("a model/sparse/0/points3D.txt"));
  EXPECT_EQ(points.size(), summary->point_count);
  std::istringstream images(text("a model/sparse/0/images.txt"));
  std::size_t count = 0, sightings = 0;
  for (std::string line, seen; std::getline(images, line);) {
    if (line[0] == '#') continue;
    ASSERT_TRUE(std::getline(images, seen));
    std::istringstream words(line), places(seen);
    int image = 0, camera_id = 0, point = 0;
    std::string name;
    Rigid3 pose;
    words >> image >> pose.rotation.w() >> pose.rotation.x() >> pose.rotation.y() >>
        pose.rotation.z() >> pose.translation.x() >> pose.translation.y() >> pose.translation.z() >>
        camera_id >> name;
    EXPECT_TRUE(fs::exists(folder_ / ("a model/images/" + name)));
    EXPECT_EQ(static_cast<std::size_t>(image), ++count);
    double u = 0, v = 0;
    for (int place = 0; places >> u >> v >> point; ++place, ++sightings) {
      const Eigen::Vector3d at = pose * points.at(point).position_m;
      EXPECT_NEAR(fx * at.x() / at.z() + cx, u, 0.01);
      EXPECT_NEAR(fy * at.y() / at.z() + cy, v, 0.01);
      EXPECT_THAT(points.at(point).track, ::testing::Contains(std::pair(image, place)));
    }
  }
  EXPECT_EQ(count, summary->image_count);
  EXPECT_GT(sightings, 300u);
}

TEST_F(PhotoFolders, NerfstudiosCamerasLookAlongMinusZ) {
  const auto summary = write_nerfstudio(source(), {.most_points = 300}, folder_ / "nerf", go_on);
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  const nlohmann::json json = nlohmann::json::parse(text("nerf/transforms.json"));
  ASSERT_EQ(json["frames"].size(), summary->image_count);
  const auto points = output::parse_ply(text("nerf/" + json["ply_file_path"].get<std::string>()));
  ASSERT_TRUE(points.ok()) << points.error().message;
  EXPECT_EQ(points->normals.size(), summary->point_count);
  // What the first image has in its middle lies before its camera.
  const nlohmann::json& frame = json["frames"][0];
  Eigen::Matrix4d world_from_gl;
  for (unsigned row = 0; row < 4; ++row)
    for (unsigned column = 0; column < 4; ++column)
      world_from_gl(row, column) = frame["transform_matrix"][row][column];
  const auto depth_png = or_throw(
      dataset::read_binary_file(folder_ / ("nerf/" + frame["depth_file_path"].get<std::string>()),
                                dataset::kMaxImageFile_bytes));
  const DepthImage depth_mm = or_throw(image::decode_depth_png(depth_png, {160, 120}));
  const double fx = json["fl_x"], fy = json["fl_y"], cx = json["cx"], cy = json["cy"];
  int near_count = 0;
  for (const Eigen::Vector3f& position : points->positions) {
    const Eigen::Vector4d at = world_from_gl.inverse() * position.cast<double>().homogeneous();
    if (at.z() >= 0) continue;
    const double u = fx * at.x() / -at.z() + cx - 0.5, v = -fy * at.y() / -at.z() + cy - 0.5;
    if (u < 0 || v < 0 || u > 159 || v > 119) continue;
    const double mm = depth_mm.at(static_cast<int>(u + 0.5), static_cast<int>(v + 0.5));
    near_count += std::abs(mm + 1000 * at.z()) < 20;
  }
  EXPECT_GT(near_count, static_cast<int>(points->positions.size()) / 2);
}

TEST_F(PhotoFolders, ABentLensIsStraightened) {
  Camera bent = sequence_->camera();
  bent.distortion.k1 = 0.05;
  const dataset::RecalibratedSequence sequence(
      or_throw(source::open_sequence("synthetic:frames=2,width=160,height=120")), bent);
  const PhotoReader reader(sequence), straight(*sequence_);
  const Photo photo = or_throw(reader.read(1)), as_it_came = or_throw(straight.read(1));
  EXPECT_EQ(photo.name, "frame_000001.png");
  EXPECT_EQ(or_throw(image::decode_color(photo.color_bytes, {160, 120})), photo.frame.color);
  EXPECT_NE(photo.frame.color, as_it_came.frame.color);
  EXPECT_EQ(as_it_came.color_bytes, or_throw(sequence_->read(1)).color_bytes)
      << "coded once more for nothing";
}

TEST_F(PhotoFolders, NothingIsLeftOfWhatFails) {
  const auto stop = [](std::int64_t done, std::int64_t) { return done < 3; };
  EXPECT_EQ(write_colmap(source(), {}, folder_ / "ended", stop).error().code, ErrorCode::kBusy);
  output::Cloud broken = cloud_;
  broken[3].position_m.x() = std::nanf("");
  EXPECT_THAT(
      write_colmap({*sequence_, sequence_->groundtruth(), broken}, {}, folder_ / "nan", go_on)
          .error()
          .message,
      HasSubstr("point 3"));
  EXPECT_THAT(
      write_nerfstudio({*sequence_, {}, cloud_}, {}, folder_ / "lost", go_on).error().message,
      HasSubstr("none of the 30 frames"));
  EXPECT_TRUE(fs::is_empty(folder_.path()));
  std::ofstream(folder_ / "taken") << "mine";
  EXPECT_EQ(write_colmap(source(), {}, folder_ / "taken", go_on).error().code,
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(text("taken"), "mine");
}

}  // namespace
}  // namespace hermite::exports
