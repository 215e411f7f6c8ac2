#include "core/frame/sampling.h"

#include <array>

namespace hermite::frame {

namespace {

// Diagonal neighbours come first, so that two frames already cover a checkerboard.
constexpr std::array<std::array<shared::uint, 2>, 4> kQuarters{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}};

constexpr int kEnoughPixels = 320 * 240;

}  // namespace

int sampling_step(const Camera& camera, int wished_step) {
  return camera.width * camera.height > kEnoughPixels ? wished_step : 1;
}

shared::Sampling sampling_of_frame(int step, std::int64_t frame_index) {
  if (step == 1) return {1, 0, 0};
  const auto& quarter = kQuarters[static_cast<std::size_t>(frame_index) % kQuarters.size()];
  return {2, quarter[0], quarter[1]};
}

shared::Intrinsics intrinsics_of(const Camera& camera) {
  return {static_cast<float>(camera.fx),           static_cast<float>(camera.fy),
          static_cast<float>(camera.cx),           static_cast<float>(camera.cy),
          static_cast<shared::uint>(camera.width), static_cast<shared::uint>(camera.height)};
}

shared::Intrinsics sampled(const shared::Intrinsics& camera, const shared::Sampling& sampling) {
  const auto step = static_cast<float>(sampling.step);
  return {camera.fx / step,
          camera.fy / step,
          (camera.cx - static_cast<float>(sampling.x)) / step,
          (camera.cy - static_cast<float>(sampling.y)) / step,
          camera.width / sampling.step,
          camera.height / sampling.step};
}

shared::Intrinsics coarser(const shared::Intrinsics& camera) {
  return {0.5f * camera.fx,          0.5f * camera.fy, 0.5f * (camera.cx - 0.5f),
          0.5f * (camera.cy - 0.5f), camera.width / 2, camera.height / 2};
}

std::size_t kernel_image_size(const shared::Intrinsics& camera) {
  return HERMITE_KERNEL_STRIDE(std::size_t{camera.width}) *
         (std::size_t{camera.height} + 2 * HERMITE_KERNEL_MARGIN);
}

}  // namespace hermite::frame
