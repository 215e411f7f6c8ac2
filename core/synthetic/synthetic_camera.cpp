#include "core/synthetic/synthetic_camera.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/disturb/key_values.h"
#include "core/image/image_codec.h"
#include "core/synthetic/world_paths.h"
#include "core/synthetic/world_plans.h"

namespace hermite::synthetic {
namespace {

using Eigen::Vector3d;

constexpr double kLap_s = 10.0;
constexpr double kTurn_s = 20.0;  // of a turn of the turntable
constexpr double kSway_s = 10.0;  // in front of the poster
constexpr double kReading_m = 1.0;
constexpr std::int64_t kMaxFrameCount = 1'000'000;
constexpr double kFocalOverWidth = 525.0 / 640.0;
constexpr int kJpegQuality = 90;
constexpr double kDegree = M_PI / 180;

struct NamedScene {
  const char* name;
  RoomScene scene;
};
constexpr NamedScene kScenes[] = {
    {"room", RoomScene::kRoom},           {"bare", RoomScene::kBare},
    {"loop", RoomScene::kLoop},           {"twins", RoomScene::kTwins},
    {"office", RoomScene::kOffice},       {"blank", RoomScene::kBlank},
    {"turntable", RoomScene::kTurntable}, {"poster", RoomScene::kPoster}};

bool is_furnished_room(RoomScene scene) {
  return scene == RoomScene::kRoom || scene == RoomScene::kBare;
}

double turned_rad(double time_s, double speed, RoomScene scene) {
  return scene == RoomScene::kTurntable ? 2 * M_PI * speed * time_s / kTurn_s : 0;
}

// Moves to and fro in front of the poster, whose text stays in the middle; the first frame looks
// straight at it.
Rigid3 before_poster(double phase_rad) {
  const double aside = std::sin(phase_rad), up = std::sin(2 * phase_rad),
               off = std::sin(3 * phase_rad);
  return camera_at(
      {0.25 * aside, kPosterWall_m - kReading_m + 0.03 * off, kPosterHeight_m + 0.08 * up},
      kDegree * (90 + 9 * aside), kDegree * -3 * up, kDegree * 2 * off);
}

Rigid3 about_z(double angle_rad) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Vector3d::UnitZ())), Vector3d::Zero()};
}

Result<std::vector<RoomChange>> changes_of(RoomScene scene, const std::string& moved,
                                           const std::string& removed) {
  std::vector<RoomChange> changes;
  if (!moved.empty()) {
    Result<std::vector<RoomChange>> parsed = parse_moved_objects(moved);
    if (!parsed.ok()) return in_context("option moved", parsed.error());
    changes = *std::move(parsed);
  }
  if (!removed.empty())
    for (RoomChange& change : parse_removed_objects(removed)) changes.push_back(std::move(change));
  Furniture furniture = furnish(scene);
  if (const Status status = apply_changes(changes, furniture); !status.ok())
    return in_context("option moved or removed", status.error());
  return changes;
}

class SyntheticSequence : public dataset::Sequence {
 public:
  explicit SyntheticSequence(const SyntheticOptions& options)
      : options_(options), room_(or_throw(SyntheticRoom::create(options.scene, options.changes))) {
    groundtruth_.reserve(static_cast<std::size_t>(options.frame_count));
    for (std::int64_t i = 0; i < options.frame_count; ++i)
      groundtruth_.push_back(
          {timestamp_s(i), synthetic_pose(on_path_s(i), options.speed, options.scene)});
  }

  std::string format() const override { return "synthetic"; }
  std::string name() const override {
    return std::string("synthetic ") +
           (is_furnished_room(options_.scene) ? "room" : name_of(options_.scene));
  }
  const Camera& camera() const override { return options_.camera; }
  double frame_rate_hz() const override { return options_.frame_rate_hz; }
  std::int64_t frame_count() const override { return options_.frame_count; }
  double timestamp_s(std::int64_t index) const override {
    return static_cast<double>(index) / options_.frame_rate_hz;
  }
  const dataset::Trajectory& groundtruth() const override { return groundtruth_; }

  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    CHECK(index >= 0 && index < frame_count(), "frame index outside the sequence");
    const Rigid3& world_from_camera =
        groundtruth_[static_cast<std::size_t>(index)].world_from_camera;
    const double turned = turned_rad(on_path_s(index), options_.speed, options_.scene);
    // Without a turntable the room is the world, and the pose must not be changed by rounding.
    RoomView view =
        room_.render(options_.camera,
                     turned == 0 ? world_from_camera : about_z(turned) * world_from_camera, turned);
    auto color = image::encode_jpeg(view.color, kJpegQuality);
    if (!color.ok()) return color.error();
    return dataset::RecordedFrame{timestamp_s(index), std::move(view.depth), std::move(*color)};
  }

 private:
  double on_path_s(std::int64_t index) const { return options_.start_s + timestamp_s(index); }

  const SyntheticOptions options_;
  const SyntheticRoom room_;
  dataset::Trajectory groundtruth_;
};

}  // namespace

Result<SyntheticOptions> parse_synthetic_options(const std::string& text) {
  SyntheticOptions options;
  std::string noise = "none", noise_options;
  const auto keep_for_noise = [&noise_options](const std::string& key) {
    return [key, &noise_options](std::string_view value) {
      noise_options += "," + key + "=" + std::string(value);
      return true;
    };
  };
  const auto keep_text = [](std::string& kept) {
    return [&kept](std::string_view value) {
      kept = value;
      return !value.empty();
    };
  };
  const auto take_scene = [&options](std::string_view value) {
    const auto* const named = std::find_if(std::begin(kScenes), std::end(kScenes),
                                           [&](const NamedScene& s) { return value == s.name; });
    if (named == std::end(kScenes)) return false;
    options.scene = named->scene;
    return true;
  };
  const auto take_noise = [&noise](std::string_view value) {
    noise = value;
    return value == "none" || value == "gaussian" || value == "kinect" || value == "kinect-white";
  };
  std::string moved, removed;
  Camera& camera = options.camera;
  const Status status = disturb::apply_key_values(
      text,
      {disturb::whole_rule("frames", 1, kMaxFrameCount,
                           [&](std::int64_t value) { options.frame_count = value; }),
       disturb::whole_rule("width", kMinImageSide_px, kMaxImageSide_px,
                           [&](std::int64_t value) { camera.width = static_cast<int>(value); }),
       disturb::whole_rule("height", kMinImageSide_px, kMaxImageSide_px,
                           [&](std::int64_t value) { camera.height = static_cast<int>(value); }),
       disturb::number_rule("rate", 1, 240, options.frame_rate_hz),
       disturb::number_rule("start", 0, 10000, options.start_s),
       disturb::number_rule("speed", 0.05, 5, options.speed),
       {"scene", "room, bare, loop, twins, office, blank, turntable or poster", take_scene},
       {"moved", "OBJECT:DX:DY:DZ/...", keep_text(moved)},
       {"removed", "OBJECT/...", keep_text(removed)},
       {"noise", "none, gaussian, kinect or kinect-white", take_noise},
       {"sigma_mm", "a number", keep_for_noise("sigma_mm")},
       {"seed", "a whole number", keep_for_noise("seed")}});
  if (!status.ok()) return status.error();
  Result<std::vector<RoomChange>> changes = changes_of(options.scene, moved, removed);
  if (!changes.ok()) return changes.error();
  options.changes = *std::move(changes);
  camera.fx = camera.fy = kFocalOverWidth * camera.width;
  camera.cx = 0.5 * (camera.width - 1);
  camera.cy = 0.5 * (camera.height - 1);
  const Result<disturb::NoiseOptions> parsed = disturb::parse_noise(noise + noise_options);
  if (!parsed.ok()) return parsed.error();
  options.noise = *parsed;
  return options;
}

const char* name_of(RoomScene scene) {
  const auto* const named = std::find_if(std::begin(kScenes), std::end(kScenes),
                                         [&](const NamedScene& s) { return s.scene == scene; });
  CHECK(named != std::end(kScenes), "a scene without a name");
  return named->name;
}

double synthetic_lap_s(RoomScene scene) {
  if (scene == RoomScene::kTurntable) return kTurn_s;
  if (scene == RoomScene::kPoster) return kSway_s;
  return is_furnished_room(scene) ? kLap_s : world_lap_s(scene);
}

Rigid3 synthetic_pose(double time_s, double speed, RoomScene scene) {
  if (scene == RoomScene::kTurntable)
    return about_z(-turned_rad(time_s, speed, scene)) *
           camera_at({0.03, -0.85, 1.30}, kDegree * 92, kDegree * -27, 0);
  if (scene == RoomScene::kPoster) return before_poster(2 * M_PI * speed * time_s / kSway_s);
  if (!is_furnished_room(scene)) return world_pose(scene, speed * time_s / world_lap_s(scene));
  // Terms with whole multiples of the lap's phase repeat after one lap. Half of the phase changes
  // sign between laps: the first looks from higher up and down at the furniture, the second from
  // lower and up.
  const double lap = 2 * M_PI * speed * time_s / kLap_s;
  const double alternating = std::sin(0.5 * lap);
  const Vector3d position(0.74 * std::cos(lap) + 0.025 * std::sin(3 * lap + 1.0),
                          0.64 * std::sin(lap) + 0.020 * std::sin(4 * lap + 2.0),
                          1.36 + 0.05 * std::sin(2 * lap + 0.7) + 0.15 * alternating);
  // Looks across the middle of the room at the opposite side.
  const double heading = lap + M_PI + 0.03 * std::sin(2 * lap + 0.4);
  const double pitch = kDegree * (-13 + 4 * std::sin(2 * lap + 2.0) - 7 * alternating);
  const double roll = kDegree * 2 * std::sin(3 * lap + 0.3);
  return camera_at(position, heading, pitch, roll);
}

Result<std::unique_ptr<dataset::Sequence>> make_synthetic_sequence(
    const SyntheticOptions& options) {
  if (const Status status = validate(options.camera); !status.ok())
    return in_context("synthetic camera", status.error());
  return disturb::with_noise(std::make_unique<SyntheticSequence>(options), options.noise);
}

}  // namespace hermite::synthetic
