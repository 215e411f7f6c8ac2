#include "core/disturb/held_disturbance.h"

#include <Eigen/Geometry>
#include <numbers>
#include <utility>

#include "core/dataset/changed_sequence.h"
#include "core/disturb/disturbed.h"
#include "core/disturb/key_values.h"
#include "core/disturb/redrawn_sequence.h"
#include "core/image/image_codec.h"
#include "core/math/counted_random.h"

namespace hermite::disturb {
namespace {

// A quarter of a turn: columns of the result are rows of the original.
template <class Pixel>
Image<Pixel> turned_once(const Image<Pixel>& image) {
  Image<Pixel> turned(image.height, image.width);
  for (int y = 0; y < turned.height; ++y)
    for (int x = 0; x < turned.width; ++x) turned.at(x, y) = image.at(image.width - 1 - y, x);
  return turned;
}

Camera turned_once(Camera camera) {
  std::swap(camera.width, camera.height);
  std::swap(camera.fx, camera.fy);
  camera.cx = std::exchange(camera.cy, camera.height - 1 - camera.cx);
  return camera;
}

class Turned : public dataset::ChangedSequence {
 public:
  Turned(std::unique_ptr<dataset::Sequence> original, int quarters)
      : ChangedSequence(std::move(original)),
        quarters_(quarters),
        camera_(original_->camera()),
        groundtruth_(original_->groundtruth()) {
    for (int i = 0; i < quarters_; ++i) camera_ = turned_once(camera_);
    const Eigen::AngleAxisd turn(quarters_ * std::numbers::pi / 2, Eigen::Vector3d::UnitZ());
    original_from_turned_.rotation = Eigen::Quaterniond(turn);
    for (dataset::TimedPose& pose : groundtruth_)
      pose.world_from_camera = pose.world_from_camera * original_from_turned_;
  }
  const Camera& camera() const override { return camera_; }
  const dataset::Trajectory& groundtruth() const override { return groundtruth_; }

  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    Result<dataset::RecordedFrame> frame = original_->read(index);
    if (!frame.ok()) return frame;
    auto color = image::decode_color(frame->color_bytes, {frame->depth.width, frame->depth.height});
    if (!color.ok()) return in_context("colour image", color.error());
    for (int i = 0; i < quarters_; ++i) {
      frame->depth = turned_once(frame->depth);
      *color = turned_once(*color);
    }
    auto encoded = image::encode_jpeg(*color, kDisturbedJpegQuality);
    if (!encoded.ok()) return encoded.error();
    frame->color_bytes = std::move(*encoded);
    if (frame->acceleration_m_s2)
      frame->acceleration_m_s2 =
          original_from_turned_.rotation.conjugate() * *frame->acceleration_m_s2;
    return frame;
  }

 private:
  const int quarters_;
  Rigid3 original_from_turned_;
  Camera camera_;
  dataset::Trajectory groundtruth_;
};

struct Sensor {
  double noise_m_s2 = 0.1, bias_m_s2 = 0.3;
  std::uint64_t seed = 1;
};

constexpr double kGravity_m_s2 = 9.80665;
// A pose of the ground truth belongs to a frame if it is this near.
constexpr double kMaxPoseGap_s = 0.02;

class Feeling : public dataset::ChangedSequence {
 public:
  Feeling(std::unique_ptr<dataset::Sequence> original, const Sensor& sensor)
      : ChangedSequence(std::move(original)),
        sensor_(sensor),
        bias_m_s2_(sensor.bias_m_s2 * random_vector(-1).normalized()) {}

  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    Result<dataset::RecordedFrame> frame = original_->read(index);
    if (frame.ok()) frame->acceleration_m_s2 = felt_m_s2(index);
    return frame;
  }

 private:
  Eigen::Vector3d random_vector(std::int64_t index) const {
    const std::uint64_t key = frame_key(sensor_.seed, index);
    const NormalPair first = normal_pair(key, 0), second = normal_pair(key, 1);
    return {first.a, first.b, second.a};
  }

  // The change of velocity from before this frame to after it. At both ends the camera rests.
  std::optional<Eigen::Vector3d> felt_m_s2(std::int64_t index) const {
    const auto pose = [this](std::int64_t at) {
      return dataset::pose_at(original_->groundtruth(), original_->timestamp_s(at), kMaxPoseGap_s);
    };
    const std::optional<Rigid3> here = pose(index);
    if (!here) return std::nullopt;
    Eigen::Vector3d felt_in_world_m_s2(0, 0, kGravity_m_s2);
    if (index > 0 && index + 1 < original_->frame_count()) {
      const std::optional<Rigid3> before = pose(index - 1), after = pose(index + 1);
      if (!before || !after) return std::nullopt;
      const double before_s = original_->timestamp_s(index) - original_->timestamp_s(index - 1),
                   after_s = original_->timestamp_s(index + 1) - original_->timestamp_s(index);
      felt_in_world_m_s2 += ((after->translation - here->translation) / after_s -
                             (here->translation - before->translation) / before_s) /
                            ((before_s + after_s) / 2);
    }
    return here->rotation.conjugate() * felt_in_world_m_s2 + bias_m_s2_ +
           sensor_.noise_m_s2 * random_vector(index);
  }

  const Sensor sensor_;
  const Eigen::Vector3d bias_m_s2_;
};

}  // namespace

Result<std::unique_ptr<dataset::Sequence>> with_turned(std::unique_ptr<dataset::Sequence> sequence,
                                                       const std::string& options) {
  int quarters = 1;
  const KeyValueRule deg{"deg", "90, 180 or 270", [&quarters](std::string_view value) {
                           quarters = value == "90" ? 1 : value == "180" ? 2 : 3;
                           return quarters < 3 || value == "270";
                         }};
  const Camera& camera = sequence->camera();
  if (camera.distortion != Distortion{} || camera.color || camera.timing != ImageTiming{})
    return Error{ErrorCode::kInvalidArgument,
                 "turned: the camera has a distortion, a colour camera of its own or a rolling "
                 "shutter"};
  return when_ok<Turned>(apply_key_values(options, {deg}), "turned", std::move(sequence), quarters);
}

Result<std::unique_ptr<dataset::Sequence>> with_accelerometer(
    std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  Sensor sensor;
  const Status status = apply_key_values(
      options, {number_rule("noise_m_s2", 0, 10, sensor.noise_m_s2),
                number_rule("bias_m_s2", 0, 5, sensor.bias_m_s2), seed_rule(sensor.seed)});
  if (sequence->groundtruth().empty())
    return Error{ErrorCode::kInvalidArgument,
                 "accelerometer: the source has no ground truth that tells how the camera moves"};
  return when_ok<Feeling>(status, "accelerometer", std::move(sequence), sensor);
}

}  // namespace hermite::disturb
