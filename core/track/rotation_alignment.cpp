#include "core/track/rotation_alignment.h"

#include <Eigen/Cholesky>

#include "core/frame/shared_transform.h"
#include "core/gpu/buffer_bytes.h"
#include "core/math/rigid3.h"
#include "core/track/workgroup_sums.h"

namespace hermite::track {

namespace {

// Fine enough for a tenth of a degree, coarse enough for several degrees.
constexpr std::size_t kRotationLevel = 1;

}  // namespace

RotationAlignment::RotationAlignment(gpu::Device& device, const shared::Intrinsics& finest,
                                     gpu::Commands& commands, gpu::Buffer<float>& partial_sums)
    : rotation_(device, "track/rotation"),
      commands_(commands),
      partial_sums_(partial_sums),
      pixels_per_thread_(pixels_per_thread(device)),
      previous_intensity_(device,
                          static_cast<std::size_t>(finest.width >> kRotationLevel) *
                              (finest.height >> kRotationLevel),
                          "odometry") {}

Eigen::Quaterniond RotationAlignment::align(const frame::FrameMaps& frame) {
  Eigen::Quaterniond current_from_previous = Eigen::Quaterniond::Identity();
  if (!has_previous_) return current_from_previous;
  const frame::SurfaceLevel& image = frame.surface.levels[kRotationLevel];
  const std::uint32_t threads =
      odometry_threads(image.camera.width * image.camera.height, pixels_per_thread_);
  Eigen::Quaterniond best = current_from_previous;
  double best_error = 1e300;
  for (int i = 0; i < 10; ++i) {
    commands_.dispatch(
        rotation_, {threads},
        shared::RotationParams{frame::to_shared({current_from_previous, Eigen::Vector3d::Zero()}),
                               previous_camera_, image.camera},
        {{"previous", previous_intensity_},
         {"current", image.intensity},
         {"partial_sums", partial_sums_}});
    commands_.submit_and_wait();
    const auto sums = sum_of_groups<shared::kRotationSumCount>(partial_sums_.mapped(), threads);
    const double count = sums[shared::kRotationErrorSums + 1],
                 error = count > 0 ? sums[shared::kRotationErrorSums] / count : 1e300;
    if (error >= best_error) break;  // also if it stopped decreasing
    best_error = error;
    best = current_from_previous;
    // H | b.
    const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> system(
        sums.data() + shared::kRotationSystemSums);
    const Eigen::Vector3d step = system.leftCols<3>().eval().ldlt().solve(system.col(3));
    if (!step.allFinite() || step.norm() < 1e-5) break;
    Vector6d twist = Vector6d::Zero();
    twist.tail<3>() = step;
    current_from_previous = (exp_se3(twist).rotation * current_from_previous).normalized();
  }
  return best;
}

void RotationAlignment::remember(gpu::Commands& commands, const frame::FrameMaps& frame) {
  const frame::SurfaceLevel& image = frame.surface.levels[kRotationLevel];
  commands.copy(image.intensity, previous_intensity_, image.intensity.bytes());
  previous_camera_ = image.camera;
  has_previous_ = true;
}

void RotationAlignment::save(ByteWriter& bytes) const {
  bytes.flag(has_previous_);
  bytes.number(previous_camera_);
  gpu::save(bytes, previous_intensity_);
}

void RotationAlignment::restore(ByteReader& bytes) {
  bytes.flag(has_previous_);
  bytes.number(previous_camera_);
  const std::uint64_t pixels = std::uint64_t{previous_camera_.width} * previous_camera_.height;
  bytes.require(pixels == (has_previous_ ? previous_intensity_.count() : 0),
                "the camera of the last picture");
  gpu::restore(bytes, previous_intensity_);
}

}  // namespace hermite::track
