#include "core/calibrate/retimed_sequence.h"

#include <utility>

#include "core/dataset/depth_units.h"
#include "core/dataset/moved_view.h"
#include "core/dataset/true_view.h"
#include "core/image/image_codec.h"

namespace hermite {
namespace {

// The row in which a point is seen depends on the time at which that row is taken. Each round divides the error by
// about the readout over the time in which the image moves by its own height, 30 for a fast hand.
constexpr int kRounds = 2;

}  // namespace

RetimedSequence::RetimedSequence(std::unique_ptr<Sequence> original, const ImageTiming& timing, Trajectory trajectory)
    : ChangedSequence(std::move(original)),
      rectifier_(rectifier_of(original_->camera())),
      camera_(rectified(original_->camera())),
      rays_(rays_of(camera_)),
      timing_(timing),
      trajectory_(std::move(trajectory)) {}

Result<RecordedFrame> RetimedSequence::read(std::int64_t index) const {
  Result<RecordedFrame> recorded = original_->read(index);
  if (!recorded.ok()) return recorded;
  Result<RgbdFrame> frame = decode_frame(*std::move(recorded));
  if (!frame.ok()) return frame.error();
  if (frame->depth.width != camera_.width || frame->depth.height != camera_.height || frame->color.width != camera_.width ||
      frame->color.height != camera_.height)
    return Error{ErrorCode::kCorruptData, "the images of a frame do not have the camera's size"};
  if (rectifier_) *frame = rectifier_->apply(*frame);
  if (const std::optional<Vector6d> twist_per_s = twist_per_s_at(trajectory_, timestamp_s(index))) *frame = retimed(*frame, *twist_per_s);
  Result<std::vector<std::uint8_t>> color = encode_jpeg(frame->color, kRetimedJpegQuality);
  if (!color.ok()) return color.error();
  return RecordedFrame{frame->timestamp_s, std::move(frame->depth), *std::move(color)};
}

DepthImage RetimedSequence::retimed_depth(const DepthImage& depth, const Vector6d& twist_per_s) const {
  std::vector<Rigid3> row_from_stamp;
  for (int row = 0; row < depth.height; ++row)
    row_from_stamp.push_back(exp_se3(-timing_.depth_readout_s * share_of_row(row, depth.height) * twist_per_s));
  const MovedView view(camera_, rays_, depth);
  DepthImage result(depth.width, depth.height);
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      SeenPlace seen{Eigen::Vector2d(x, y), 0};
      for (int round = 0; round < kRounds; ++round) seen = view.find(x, y, row_from_stamp[static_cast<std::size_t>(seen.at_px.y() + 0.5)]);
      result.at(x, y) = to_depth_units(seen.depth_m, camera_.depth_units_per_metre);
    }
  return result;
}

RgbdFrame RetimedSequence::retimed(const RgbdFrame& frame, const Vector6d& twist_per_s) const {
  RgbdFrame result = frame;
  if (timing_.depth_readout_s != 0) result.depth = retimed_depth(frame.depth, twist_per_s);
  if (timing_.color_readout_s == 0 && timing_.color_delay_s == 0) return result;
  std::vector<Rigid3> row_from_stamp;
  for (int row = 0; row < frame.color.height; ++row) {
    const double later_s = timing_.color_delay_s + timing_.color_readout_s * share_of_row(row, frame.color.height);
    row_from_stamp.push_back(exp_se3(-later_s * twist_per_s));
  }
  const Eigen::Vector2d last_px(frame.color.width - 1, frame.color.height - 1);
  for (int y = 0; y < frame.color.height; ++y)
    for (int x = 0; x < frame.color.width; ++x) {
      const double depth_m = result.depth.at(x, y) / camera_.depth_units_per_metre;
      Eigen::Vector2d at_px(x, y);
      for (int round = 0; round < kRounds; ++round) {
        const Rigid3& moved = row_from_stamp[static_cast<std::size_t>(at_px.y() + 0.5)];
        // Without depth, a pixel is taken to be infinitely far.
        const Eigen::Vector3d point = depth_m > 0 ? Eigen::Vector3d(moved * Eigen::Vector3d(depth_m * rays_.at(x, y)))
                                                  : Eigen::Vector3d(moved.rotation * rays_.at(x, y));
        if (point.z() > 0) at_px = pixel_of(camera_, point).cwiseMax(0).cwiseMin(last_px);
      }
      result.color.at(x, y) = rounded(color_at(frame.color, at_px));
    }
  return result;
}

}  // namespace hermite
