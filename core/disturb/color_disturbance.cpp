#include "core/disturb/color_disturbance.h"

#include <algorithm>
#include <cmath>

#include "core/disturb/disturbed.h"
#include "core/disturb/key_values.h"
#include "core/disturb/redrawn_sequence.h"
#include "core/math/counted_random.h"

namespace hermite::disturb {
namespace {

using Opened = Result<std::unique_ptr<dataset::Sequence>>;

constexpr double kMaxAmplitude = 0.9;

// A sequence whose colour is multiplied by a gain per pixel.
class Gained : public RedrawnSequence {
 public:
  using RedrawnSequence::RedrawnSequence;

 protected:
  static void multiply_all(ColorImage& color, double gain) {
    for (Rgb8& pixel : color.pixels) pixel = multiplied(pixel, gain);
  }

 private:
  Status redraw(DepthImage& /*depth*/, ColorImage& color, std::int64_t index) const override {
    multiply(color, index);
    return Done{};
  }
  virtual void multiply(ColorImage& color, std::int64_t index) const = 0;
};

struct ExposureOptions {
  double amplitude = 0.25, period_s = 2;
};

class Exposed : public Gained {
 public:
  Exposed(std::unique_ptr<dataset::Sequence> original, const ExposureOptions& options)
      : Gained(std::move(original)), options_(options) {}

 private:
  void multiply(ColorImage& color, std::int64_t index) const override {
    const double time_s = timestamp_s(index) - timestamp_s(0);
    multiply_all(color, 1 + options_.amplitude * std::sin(2 * M_PI * time_s / options_.period_s));
  }

  const ExposureOptions options_;
};

struct FlickerOptions {
  double amplitude = 0.1;
  std::uint64_t seed = 1;
};

class Flickering : public Gained {
 public:
  Flickering(std::unique_ptr<dataset::Sequence> original, const FlickerOptions& options)
      : Gained(std::move(original)), options_(options) {}

 private:
  void multiply(ColorImage& color, std::int64_t index) const override {
    multiply_all(
        color, 1 + options_.amplitude * (2 * unit_uniform(frame_key(options_.seed, index), 0) - 1));
  }

  const FlickerOptions options_;
};

class Vignetted : public Gained {
 public:
  Vignetted(std::unique_ptr<dataset::Sequence> original, double corner)
      : Gained(std::move(original)), corner_(corner) {}

 private:
  void multiply(ColorImage& color, std::int64_t /*index*/) const override {
    for (int y = 0; y < color.height; ++y)
      for (int x = 0; x < color.width; ++x) {
        const double gain = 1 - (1 - corner_) * squared_radius(x, y, color.width, color.height);
        color.at(x, y) = multiplied(color.at(x, y), gain);
      }
  }

  const double corner_;
};

}  // namespace

Rgb8 multiplied(const Rgb8& pixel, double red, double green, double blue) {
  const auto byte = [](std::uint8_t value, double gain) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(value * gain, 0.0, 255.0)));
  };
  return {byte(pixel.r, red), byte(pixel.g, green), byte(pixel.b, blue)};
}

double squared_radius(int x, int y, int width, int height) {
  const double middle_x = 0.5 * (width - 1), middle_y = 0.5 * (height - 1);
  const double dx = x - middle_x, dy = y - middle_y;
  return (dx * dx + dy * dy) / (middle_x * middle_x + middle_y * middle_y);
}

Opened with_exposure(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  ExposureOptions exposure;
  const Status status =
      apply_key_values(options, {number_rule("amplitude", 0, kMaxAmplitude, exposure.amplitude),
                                 number_rule("period_s", 0.01, 3600, exposure.period_s)});
  return when_ok<Exposed>(status, "exposure", std::move(sequence), exposure);
}

Opened with_flicker(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  FlickerOptions flicker;
  const Status status = apply_key_values(
      options,
      {number_rule("amplitude", 0, kMaxAmplitude, flicker.amplitude), seed_rule(flicker.seed)});
  return when_ok<Flickering>(status, "flicker", std::move(sequence), flicker);
}

Opened with_vignetting(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  double corner = 0.55;
  const Status status = apply_key_values(options, {number_rule("corner", 0, 1, corner)});
  return when_ok<Vignetted>(status, "vignetting", std::move(sequence), corner);
}

}  // namespace hermite::disturb
