#include "core/disturb/rig_disturbance.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/disturb/depth_units.h"
#include "core/disturb/disturbed.h"
#include "core/disturb/key_values.h"
#include "core/disturb/redrawn_sequence.h"
#include "core/image/image_codec.h"
#include "core/math/counted_random.h"

namespace hermite::disturb {
namespace {

using Opened = Result<std::unique_ptr<dataset::Sequence>>;

struct AttachedOptions {
  double share = 0.15, distance_m = 0.5;
};

// A wedge with a pattern, whose surface is inclined by one part in five.
class Attached : public RedrawnSequence {
 public:
  Attached(std::unique_ptr<dataset::Sequence> original, const AttachedOptions& options)
      : RedrawnSequence(std::move(original)), options_(options) {}

 private:
  Status redraw(DepthImage& depth, ColorImage& color, std::int64_t /*index*/) const override {
    constexpr Rgb8 kLight{170, 160, 140}, kDark{50, 60, 70};
    constexpr int kChecksAcross = 40;
    // Side of a triangle, in image widths and heights.
    const double side = std::sqrt(2 * options_.share);
    const int check_px = std::max(2, color.width / kChecksAcross);
    for (int y = 0; y < color.height; ++y)
      for (int x = 0; x < color.width; ++x) {
        const double right = static_cast<double>(x) / color.width,
                     down = static_cast<double>(y) / color.height;
        if (right + down < 2 - side) continue;
        color.at(x, y) = (x / check_px + y / check_px) % 2 == 0 ? kLight : kDark;
        depth.at(x, y) = to_depth_units(options_.distance_m * (1.2 - 0.2 * down),
                                        camera().depth_units_per_metre);
      }
    return Done{};
  }

  const AttachedOptions options_;
};

struct TornOptions {
  std::int64_t every = 5;
  std::uint64_t seed = 1;
};

class Torn : public RedrawnSequence {
 public:
  Torn(std::unique_ptr<dataset::Sequence> original, const TornOptions& options)
      : RedrawnSequence(std::move(original)), options_(options) {}

 private:
  Status redraw(DepthImage& depth, ColorImage& color, std::int64_t index) const override {
    if (index == 0 || index % options_.every != 0) return Done{};
    const Result<dataset::RecordedFrame> before = original_->read(index - 1);
    if (!before.ok()) return before.error();
    const auto earlier = image::decode_color(before->color_bytes, {depth.width, depth.height});
    if (!earlier.ok()) return in_context("colour image", earlier.error());
    const int first =
        static_cast<int>(unit_uniform(frame_key(options_.seed, index), 0) * depth.height);
    const auto from = static_cast<std::ptrdiff_t>(first) * depth.width;
    std::copy(before->depth.pixels.begin() + from, before->depth.pixels.end(),
              depth.pixels.begin() + from);
    std::copy(earlier->pixels.begin() + from, earlier->pixels.end(), color.pixels.begin() + from);
    return Done{};
  }

  const TornOptions options_;
};

struct StainedOptions {
  std::uint64_t spots = 6;
  double width_px = 30;
  std::uint64_t seed = 1;
};

class Stained : public RedrawnSequence {
 public:
  Stained(std::unique_ptr<dataset::Sequence> original, const StainedOptions& options)
      : RedrawnSequence(std::move(original)), options_(options) {}

 private:
  Status redraw(DepthImage& depth, ColorImage& color, std::int64_t /*index*/) const override {
    constexpr double kDirt = 60;  // its own grey value
    const std::uint64_t key = mix_bits(options_.seed);
    for (std::uint64_t i = 0; i < options_.spots; ++i) {
      const double middle_x = unit_uniform(key, 2 * i) * color.width,
                   middle_y = unit_uniform(key, 2 * i + 1) * color.height;
      for (int y = 0; y < color.height; ++y)
        for (int x = 0; x < color.width; ++x) {
          const double away = std::hypot(x - middle_x, y - middle_y) / (options_.width_px / 2);
          if (away >= 1) continue;
          const double dirt = 1 - away * away;
          Rgb8& pixel = color.at(x, y);
          const auto behind = [dirt](std::uint8_t byte) {
            return static_cast<std::uint8_t>(std::lround(byte + dirt * (kDirt - byte)));
          };
          pixel = {behind(pixel.r), behind(pixel.g), behind(pixel.b)};
          depth.at(x, y) = 0;
        }
    }
    return Done{};
  }

  const StainedOptions options_;
};

// Changes every measured depth.
class Remeasured : public dataset::ChangedSequence {
 public:
  using dataset::ChangedSequence::ChangedSequence;

  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    Result<dataset::RecordedFrame> frame = original_->read(index);
    if (!frame.ok()) return frame;
    const double units_per_metre = camera().depth_units_per_metre;
    for (std::uint16_t& pixel : frame->depth.pixels)
      if (pixel > 0)
        pixel =
            to_depth_units(measured_m(pixel / units_per_metre, timestamp_s(index) - timestamp_s(0)),
                           units_per_metre);
    return frame;
  }

 private:
  virtual double measured_m(double depth_m, double time_s) const = 0;
};

struct WarmingOptions {
  double percent = 1, over_s = 5;
};

class Warming : public Remeasured {
 public:
  Warming(std::unique_ptr<dataset::Sequence> original, const WarmingOptions& options)
      : Remeasured(std::move(original)), options_(options) {}

 private:
  double measured_m(double depth_m, double time_s) const override {
    return depth_m * (1 + options_.percent / 100 * std::min(time_s / options_.over_s, 1.0));
  }

  const WarmingOptions options_;
};

struct JitterOptions {
  double ms = 12;
  std::uint64_t seed = 1;
};

class Jittered : public dataset::ChangedSequence {
 public:
  Jittered(std::unique_ptr<dataset::Sequence> original, const JitterOptions& options)
      : dataset::ChangedSequence(std::move(original)) {
    constexpr double kLeast_s = 0.001;  // between two stamps
    for (std::int64_t i = 0; i < original_->frame_count(); ++i) {
      const double late_s = options.ms / 1000 * unit_uniform(frame_key(options.seed, i), 0);
      const double stamp_s = original_->timestamp_s(i) + late_s;
      timestamps_s_.push_back(
          timestamps_s_.empty() ? stamp_s : std::max(stamp_s, timestamps_s_.back() + kLeast_s));
    }
    constexpr double kMaxGap_s = 0.1;
    for (std::int64_t i = 0; i < original_->frame_count(); ++i)
      if (const auto pose =
              dataset::pose_at(original_->groundtruth(), original_->timestamp_s(i), kMaxGap_s))
        truth_.push_back({timestamp_s(i), *pose});
  }

  double timestamp_s(std::int64_t index) const override {
    return timestamps_s_[static_cast<std::size_t>(index)];
  }
  const dataset::Trajectory& groundtruth() const override { return truth_; }
  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    Result<dataset::RecordedFrame> frame = original_->read(index);
    if (frame.ok()) frame->timestamp_s = timestamp_s(index);
    return frame;
  }

 private:
  std::vector<double> timestamps_s_;
  // Where the camera was at the exposures, with the stamps of the frames.
  dataset::Trajectory truth_;
};

}  // namespace

Opened with_attached(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  AttachedOptions attached;
  const Status status =
      apply_key_values(options, {number_rule("share", 0.01, 0.5, attached.share),
                                 number_rule("distance_m", 0.2, 5, attached.distance_m)});
  return when_ok<Attached>(status, "attached", std::move(sequence), attached);
}

Opened with_torn(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  TornOptions torn;
  const Status status = apply_key_values(
      options, {whole_rule("every", 1, 1000, [&](std::int64_t v) { torn.every = v; }),
                seed_rule(torn.seed)});
  return when_ok<Torn>(status, "torn", std::move(sequence), torn);
}

Opened with_stained(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  StainedOptions stained;
  const Status status = apply_key_values(
      options, {whole_rule("spots", 1, 100,
                           [&](std::int64_t v) { stained.spots = static_cast<std::uint64_t>(v); }),
                number_rule("width_px", 2, 200, stained.width_px), seed_rule(stained.seed)});
  return when_ok<Stained>(status, "stained", std::move(sequence), stained);
}

Opened with_warming(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  WarmingOptions warming;
  const Status status =
      apply_key_values(options, {number_rule("percent", -10, 10, warming.percent),
                                 number_rule("over_s", 0.1, 3600, warming.over_s)});
  return when_ok<Warming>(status, "warming", std::move(sequence), warming);
}

Opened with_jitter(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  JitterOptions jitter;
  const Status status =
      apply_key_values(options, {number_rule("ms", 0, 1000, jitter.ms), seed_rule(jitter.seed)});
  return when_ok<Jittered>(status, "jitter", std::move(sequence), jitter);
}

}  // namespace hermite::disturb
