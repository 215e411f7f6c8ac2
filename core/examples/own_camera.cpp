// Frames of a camera of one's own become poses. Here a wall of coloured squares, 1.5 m away, past
// which the camera moves by 5 mm a frame.
#include <exception>
#include <iostream>

#include "core/run/back_end.h"

using namespace hermite;

namespace {

frame::RgbdFrame take_frame(const Camera& camera, int number) {
  frame::RgbdFrame frame{number / 30.0, DepthImage(camera.width, camera.height),
                         ColorImage(camera.width, camera.height)};
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const double distance_m = 1.5,
                   x_m = (u - camera.cx) / camera.fx * distance_m + 0.005 * number;
      const bool bright = (static_cast<int>(x_m / 0.1 + 1000) + v / 24) % 2 == 0;
      // No sensor measures the same twice.
      const int noise_mm = (7 * u + 13 * v + 5 * number) % 3 - 1;
      frame.depth.at(u, v) = static_cast<std::uint16_t>((distance_m + 0.001 * noise_mm) *
                                                        camera.depth_units_per_metre);
      frame.color.at(u, v) = bright ? Rgb8{200, 180, 90} : Rgb8{60, 80, 120};
    }
  return frame;
}

}  // namespace

int main() try {
  const Camera camera{.width = 320, .height = 240, .fx = 280, .fy = 280, .cx = 159.5, .cy = 119.5};
  const pipeline::Options options;
  pipeline::Pipeline pipeline("", camera, options,
                              run::make_back_end(options, adjust::CorrectionTime::kByFrames));
  for (int number = 0; number < 10; ++number) {
    const pipeline::FrameResult result = or_throw(pipeline.process(take_frame(camera, number)));
    std::cout << name_of(result.status) << ", camera at "
              << result.world_from_camera.translation.transpose() << " m\n";
  }
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
