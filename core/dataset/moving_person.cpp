#include "core/dataset/moving_person.h"

#include <cmath>
#include <limits>
#include <optional>

#include "core/dataset/changed_sequence.h"
#include "core/dataset/color_disturbance.h"
#include "core/dataset/depth_units.h"
#include "core/dataset/key_values.h"
#include "core/image/image_codec.h"

namespace hermite {
namespace {

using Eigen::Vector3d;

constexpr double kRadius_m = 0.25, kHeight_m = 1.75, kHeadAboveCamera_m = 0.15;
constexpr double kSpeed_m_s = 0.8;
constexpr double kAheadDistance_m = 1.7;
constexpr double kMaxPoseGap_s = 0.1;
constexpr double kMinDepth_m = 0.3;
constexpr double kCheckAngle_rad = 0.4, kCheckHeight_m = 0.1;
constexpr Rgb8 kLightCheck{180, 190, 200}, kDarkCheck{60, 45, 40}, kPlainCloth{120, 110, 90};
// Below it a view is taken to go straight up or down.
constexpr double kLeastHorizontal = 0.05;
constexpr int kUndistortSteps = 20;

// What the way of the person hangs on.
struct Stage {
  Vector3d up, forward, side;  // of the middle frame, in the world
  Vector3d camera_m;           // of the middle frame
  double middle_s = 0;
};

Vector3d upright(const Vector3d& mean_up) {
  Eigen::Index axis = 0;
  mean_up.cwiseAbs().maxCoeff(&axis);
  Vector3d up = Vector3d::Zero();
  up[axis] = mean_up[axis] < 0 ? -1 : 1;
  return up;
}

// Where the camera looks, brought to the horizontal. One that looks straight down has its upper edge in front.
Vector3d forward_of(const Rigid3& world_from_camera, const Vector3d& up) {
  const auto horizontal = [&](const Vector3d& direction) -> Vector3d { return direction - direction.dot(up) * up; };
  const Vector3d view = horizontal(world_from_camera.rotation * Vector3d::UnitZ());
  if (view.norm() > kLeastHorizontal) return view.normalized();
  return horizontal(world_from_camera.rotation * -Vector3d::UnitY()).normalized();
}

Result<Stage> stage_of(const Sequence& sequence) {
  const Trajectory& truth = sequence.groundtruth();
  if (truth.empty() || sequence.frame_count() == 0)
    return Error{ErrorCode::kInvalidArgument, "person: the sequence has no ground truth, which says where the camera sees the person"};
  Vector3d mean_up = Vector3d::Zero();
  for (const TimedPose& pose : truth) mean_up -= pose.world_from_camera.rotation * Vector3d::UnitY();
  Stage stage;
  stage.up = upright(mean_up);
  stage.middle_s = sequence.timestamp_s(sequence.frame_count() / 2);
  const Rigid3 middle = *pose_at(truth, stage.middle_s, std::numeric_limits<double>::infinity());
  stage.forward = forward_of(middle, stage.up);
  stage.side = stage.up.cross(stage.forward);
  stage.camera_m = middle.translation;
  return stage;
}

Result<Rigid3> pose_of(const Sequence& sequence, std::int64_t index) {
  const auto pose = pose_at(sequence.groundtruth(), sequence.timestamp_s(index), kMaxPoseGap_s);
  if (!pose) return Error{ErrorCode::kNotFound, "person: the ground truth has no pose at the time of frame " + std::to_string(index)};
  return *pose;
}

Person placed(const Stage& stage, const PersonOptions& options, const Rigid3& world_from_camera, double time_s) {
  Person person{Vector3d::Zero(), kRadius_m, kHeight_m, stage.up};
  if (options.path == PersonPath::kCross)
    person.head_world = stage.camera_m + options.distance_m * stage.forward + kSpeed_m_s * (time_s - stage.middle_s) * stage.side;
  else
    person.head_world = world_from_camera.translation + options.distance_m * forward_of(world_from_camera, stage.up);
  person.head_world += kHeadAboveCamera_m * stage.up;
  return person;
}

// Multiple of `direction` at which a ray from outside enters the person.
std::optional<double> enters(const Person& person, const Vector3d& origin, const Vector3d& direction) {
  const Vector3d from_head = origin - person.head_world;
  const double rise = direction.dot(person.up_world), height_m = from_head.dot(person.up_world);
  const Vector3d across = direction - rise * person.up_world, away_m = from_head - height_m * person.up_world;
  const double a = across.squaredNorm(), b = across.dot(away_m), c = away_m.squaredNorm() - person.radius_m * person.radius_m;
  const double discriminant = b * b - a * c;
  if (discriminant > 0) {
    const double s = (-b - std::sqrt(discriminant)) / a, above_m = height_m + s * rise;
    if (s > 0 && above_m <= 0 && above_m >= -person.height_m) return s;
  }
  if (height_m <= 0 || rise >= 0) return std::nullopt;
  const double s = -height_m / rise;
  if ((away_m + s * across).norm() <= person.radius_m) return s;
  return std::nullopt;
}

Rgb8 cloth_at(const Vector3d& from_head, const Stage& stage, PersonClothes clothes) {
  if (clothes == PersonClothes::kPlain) return kPlainCloth;
  const double angle = std::atan2(from_head.dot(stage.side), from_head.dot(stage.forward));
  const auto check = std::lround(std::floor(angle / kCheckAngle_rad) + std::floor(from_head.dot(stage.up) / kCheckHeight_m));
  return check % 2 == 0 ? kLightCheck : kDarkCheck;
}

// What an image has at pixel (x, y) comes from there, at a depth of 1.
Vector3d ray_of(const Camera& camera, int x, int y) {
  const Eigen::Vector2d seen((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy);
  Eigen::Vector2d straight = seen;
  if (camera.distortion != Distortion{})
    for (int step = 0; step < kUndistortSteps; ++step) straight += seen - camera.distortion.apply(straight.x(), straight.y());
  return {straight.x(), straight.y(), 1};
}

class Crowded : public ChangedSequence {
 public:
  Crowded(std::unique_ptr<Sequence> original, const PersonOptions& options, const Stage& stage)
      : ChangedSequence(std::move(original)), options_(options), stage_(stage) {}

  Result<RecordedFrame> read(std::int64_t index) const override {
    Result<RecordedFrame> frame = original_->read(index);
    if (!frame.ok()) return frame;
    const Result<Rigid3> pose = pose_of(*original_, index);
    if (!pose.ok()) return pose.error();
    auto color = decode_color(frame->color_bytes, {frame->depth.width, frame->depth.height});
    if (!color.ok()) return in_context("colour image", color.error());
    if (!render(placed(stage_, options_, *pose, timestamp_s(index)), *pose, frame->depth, *color)) return frame;
    auto encoded = encode_jpeg(*color, kDisturbedJpegQuality);
    if (!encoded.ok()) return encoded.error();
    frame->color_bytes = std::move(*encoded);
    return frame;
  }

 private:
  // False: nothing of the person is in view.
  bool render(const Person& person, const Rigid3& world_from_camera, DepthImage& depth, ColorImage& color) const {
    const Eigen::Matrix3d rotation = world_from_camera.rotation.toRotationMatrix();
    const double scale = camera().depth_units_per_metre;
    bool is_seen = false;
    for (int y = 0; y < depth.height; ++y)
      for (int x = 0; x < depth.width; ++x) {
        const Vector3d direction = rotation * ray_of(camera(), x, y);
        const std::optional<double> depth_m = enters(person, world_from_camera.translation, direction);
        std::uint16_t& seen = depth.at(x, y);
        if (!depth_m || *depth_m < kMinDepth_m || (seen > 0 && *depth_m * scale >= seen)) continue;
        seen = to_depth_units(*depth_m, scale);
        color.at(x, y) = cloth_at(world_from_camera.translation + *depth_m * direction - person.head_world, stage_, options_.clothes);
        is_seen = true;
      }
    return is_seen;
  }

  const PersonOptions options_;
  const Stage stage_;
};

}  // namespace

Result<PersonOptions> parse_person(const std::string& text) {
  PersonOptions options;
  double distance_m = 0;
  const auto take_path = [&](std::string_view value) {
    options.path = value == "ahead" ? PersonPath::kAhead : PersonPath::kCross;
    return value == "ahead" || value == "cross";
  };
  const auto take_clothes = [&](std::string_view value) {
    options.clothes = value == "plain" ? PersonClothes::kPlain : PersonClothes::kChecked;
    return value == "plain" || value == "checked";
  };
  const Status status = apply_key_values(text, {{"path", "cross or ahead", take_path},
                                                {"clothes", "checked or plain", take_clothes},
                                                number_rule("distance_m", 0.6, 10, distance_m)});
  if (!status.ok()) return in_context("person", status.error());
  if (distance_m > 0)
    options.distance_m = distance_m;
  else if (options.path == PersonPath::kAhead)
    options.distance_m = kAheadDistance_m;
  return options;
}

Result<Person> person_at(const Sequence& sequence, const PersonOptions& options, std::int64_t frame_index) {
  const Result<Stage> stage = stage_of(sequence);
  if (!stage.ok()) return stage.error();
  const Result<Rigid3> pose = pose_of(sequence, frame_index);
  if (!pose.ok()) return pose.error();
  return placed(*stage, options, *pose, sequence.timestamp_s(frame_index));
}

Result<std::unique_ptr<Sequence>> with_person(std::unique_ptr<Sequence> sequence, const std::string& options) {
  const Result<PersonOptions> person = parse_person(options);
  if (!person.ok()) return person.error();
  if (sequence->camera().color)
    return Error{ErrorCode::kUnsupported, "person: depth must be registered to colour, but a camera of its own takes the colour"};
  const Result<Stage> stage = stage_of(*sequence);
  if (!stage.ok()) return stage.error();
  return std::unique_ptr<Sequence>(std::make_unique<Crowded>(std::move(sequence), *person, *stage));
}

}  // namespace hermite
