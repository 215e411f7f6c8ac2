// A camera that gives what a test tells it, when asked. Header only.
#pragma once

#include <deque>
#include <thread>

#include "server/capture/camera.h"

namespace hermite::test {

class ScriptedCamera final : public client::CaptureCamera {
 public:
  explicit ScriptedCamera(const Camera& camera)
      : description_{"scripted", camera, "the test", 30} {}

  // Each entry is one answer: a frame, a silence or an error. After the last there are only
  // silences.
  std::deque<Result<std::optional<frame::RgbdFrame>>> script;

  // Frames of this camera, at 30 Hz from `first` on.
  void add_frames(int count, int first = 0) {
    for (int i = first; i < first + count; ++i) {
      frame::RgbdFrame frame{i / 30.0,
                             DepthImage(description_.camera.width, description_.camera.height),
                             ColorImage(description_.camera.width, description_.camera.height)};
      for (std::size_t k = 0; k < frame.depth.pixels.size(); ++k)
        frame.depth.pixels[k] =
            static_cast<std::uint16_t>(1500 + 10 * i + static_cast<int>(k % 64));
      for (std::size_t k = 0; k < frame.color.pixels.size(); ++k)
        frame.color.pixels[k].g = static_cast<std::uint8_t>(k * 5 + 64);
      script.emplace_back(std::optional<frame::RgbdFrame>(std::move(frame)));
    }
  }

  const client::CameraDescription& description() const override { return description_; }
  Result<std::optional<frame::RgbdFrame>> next(std::chrono::milliseconds patience) override {
    if (script.empty()) {
      std::this_thread::sleep_for(patience);
      return std::optional<frame::RgbdFrame>();
    }
    auto answer = std::move(script.front());
    script.pop_front();
    return answer;
  }

 private:
  const client::CameraDescription description_;
};

}  // namespace hermite::test
