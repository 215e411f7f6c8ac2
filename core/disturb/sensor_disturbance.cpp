#include "core/disturb/sensor_disturbance.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/disturb/color_disturbance.h"
#include "core/disturb/depth_units.h"
#include "core/disturb/disturbed.h"
#include "core/disturb/key_values.h"
#include "core/disturb/redrawn_sequence.h"
#include "core/math/counted_random.h"

namespace hermite::disturb {
namespace {

using Opened = Result<std::unique_ptr<dataset::Sequence>>;

// Neighbours whose depths differ by at least this share are the two sides of an edge.
constexpr double kEdgeShare = 0.05;

// A pixel near an edge sees both sides, with more of the other one the nearer it is to the edge.
class Flying : public dataset::ChangedSequence {
 public:
  Flying(std::unique_ptr<dataset::Sequence> original, int width_px)
      : dataset::ChangedSequence(std::move(original)), width_px_(width_px) {}

  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    Result<dataset::RecordedFrame> frame = original_->read(index);
    if (!frame.ok()) return frame;
    const DepthImage sharp = frame->depth;
    for (int y = 0; y < sharp.height; ++y)
      for (int x = 0; x < sharp.width; ++x)
        if (sharp.at(x, y) > 0) frame->depth.at(x, y) = seen_by_pixel(sharp, x, y);
    return frame;
  }

 private:
  std::uint16_t seen_by_pixel(const DepthImage& sharp, int x, int y) const {
    const double own = sharp.at(x, y);
    for (int away = 1; away <= width_px_; ++away)
      for (const auto& [dx, dy] : {std::pair{away, 0}, {-away, 0}, {0, away}, {0, -away}}) {
        if (x + dx < 0 || y + dy < 0 || x + dx >= sharp.width || y + dy >= sharp.height) continue;
        const double other = sharp.at(x + dx, y + dy);
        if (other == 0 || std::abs(other - own) < kEdgeShare * std::min(own, other)) continue;
        const double of_other = 0.5 * (width_px_ + 1 - away) / width_px_;
        return to_depth_units(own + of_other * (other - own), 1);
      }
    return sharp.at(x, y);
  }

  const int width_px_;
};

class Interpolated : public dataset::ChangedSequence {
 public:
  Interpolated(std::unique_ptr<dataset::Sequence> original, int every)
      : dataset::ChangedSequence(std::move(original)), every_(every) {}

  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    Result<dataset::RecordedFrame> frame = original_->read(index);
    if (!frame.ok()) return frame;
    const DepthImage fine = frame->depth;
    for (int y = 0; y < fine.height; ++y)
      for (int x = 0; x < fine.width; ++x) frame->depth.at(x, y) = between(fine, x, y);
    return frame;
  }

 private:
  // Interpolates between those of the four measured pixels around that have a depth.
  std::uint16_t between(const DepthImage& fine, int x, int y) const {
    const int left = x / every_ * every_, top = y / every_ * every_;
    const double a = static_cast<double>(x - left) / every_,
                 b = static_cast<double>(y - top) / every_;
    double sum = 0, weights = 0;
    for (const int dy : {0, 1})
      for (const int dx : {0, 1}) {
        const int u = left + dx * every_, v = top + dy * every_;
        const double depth = u < fine.width && v < fine.height ? fine.at(u, v) : 0;
        const double weight = depth > 0 ? (dx != 0 ? a : 1 - a) * (dy != 0 ? b : 1 - b) : 0;
        sum += weight * depth;
        weights += weight;
      }
    return weights >= 0.5 ? to_depth_units(sum / weights, 1) : std::uint16_t{0};
  }

  const int every_;
};

struct SpeckleOptions {
  double holes = 0.2, wild = 0.01;
  std::uint64_t seed = 1;
};

class Speckled : public dataset::ChangedSequence {
 public:
  Speckled(std::unique_ptr<dataset::Sequence> original, const SpeckleOptions& options)
      : dataset::ChangedSequence(std::move(original)), options_(options) {}

  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    constexpr double kNearest_m = 0.5, kFarthest_m = 5;
    Result<dataset::RecordedFrame> frame = original_->read(index);
    if (!frame.ok()) return frame;
    const std::uint64_t key = frame_key(options_.seed, index);
    const double units_per_metre = camera().depth_units_per_metre;
    for (std::size_t i = 0; i < frame->depth.pixels.size(); ++i) {
      const double lot = unit_uniform(key, 2 * i);
      if (lot < options_.holes)
        frame->depth.pixels[i] = 0;
      else if (lot > 1 - options_.wild)
        frame->depth.pixels[i] =
            to_depth_units(kNearest_m + (kFarthest_m - kNearest_m) * unit_uniform(key, 2 * i + 1),
                           units_per_metre);
    }
    return frame;
  }

 private:
  const SpeckleOptions options_;
};

struct FrozenOptions {
  std::int64_t every = 15, count = 3;
};

class Frozen : public dataset::ChangedSequence {
 public:
  Frozen(std::unique_ptr<dataset::Sequence> original, const FrozenOptions& options)
      : dataset::ChangedSequence(std::move(original)), options_(options) {}

  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    const std::int64_t since = index % options_.every, last = options_.every - options_.count - 1;
    Result<dataset::RecordedFrame> frame =
        original_->read(index - std::max<std::int64_t>(since - last, 0));
    if (frame.ok()) frame->timestamp_s = timestamp_s(index);
    return frame;
  }

 private:
  const FrozenOptions options_;
};

class Misregistered : public RedrawnSequence {
 public:
  Misregistered(std::unique_ptr<dataset::Sequence> original, int right_px, int down_px)
      : RedrawnSequence(std::move(original)), right_px_(right_px), down_px_(down_px) {}

 private:
  // Pixels beyond the border repeat the border.
  Status redraw(DepthImage& /*depth*/, ColorImage& color, std::int64_t /*index*/) const override {
    const ColorImage right = color;
    for (int y = 0; y < color.height; ++y)
      for (int x = 0; x < color.width; ++x)
        color.at(x, y) = right.at(std::clamp(x - right_px_, 0, color.width - 1),
                                  std::clamp(y - down_px_, 0, color.height - 1));
    return Done{};
  }

  const int right_px_, down_px_;
};

struct BandingOptions {
  double amplitude = 0.15, bands = 2;
};

class Banded : public RedrawnSequence {
 public:
  Banded(std::unique_ptr<dataset::Sequence> original, const BandingOptions& options)
      : RedrawnSequence(std::move(original)), options_(options) {}

 private:
  Status redraw(DepthImage& /*depth*/, ColorImage& color, std::int64_t index) const override {
    constexpr double kWanders = 0.37;  // of a band per frame: mains and camera are not synchronised
    for (int y = 0; y < color.height; ++y) {
      const double phase =
          options_.bands * y / color.height + kWanders * static_cast<double>(index);
      const double gain = 1 + options_.amplitude * std::sin(2 * M_PI * phase);
      for (int x = 0; x < color.width; ++x) color.at(x, y) = multiplied(color.at(x, y), gain);
    }
    return Done{};
  }

  const BandingOptions options_;
};

template <class Change>
Rgb8 changed(const Rgb8& pixel, const Change& change) {
  const auto byte = [&change](std::uint8_t value) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(change(value), 0.0, 255.0)));
  };
  return {byte(pixel.r), byte(pixel.g), byte(pixel.b)};
}

struct DarkOptions {
  double gain = 0.1, sigma = 4;
  std::uint64_t seed = 1;
};

class Dark : public RedrawnSequence {
 public:
  Dark(std::unique_ptr<dataset::Sequence> original, const DarkOptions& options)
      : RedrawnSequence(std::move(original)), options_(options) {}

 private:
  Status redraw(DepthImage& /*depth*/, ColorImage& color, std::int64_t index) const override {
    const std::uint64_t key = frame_key(options_.seed, index);
    for (std::size_t i = 0; i < color.pixels.size(); ++i) {
      const double noise = options_.sigma * normal_pair(key, i).a;
      color.pixels[i] =
          changed(color.pixels[i], [&](double value) { return options_.gain * value + noise; });
    }
    return Done{};
  }

  const DarkOptions options_;
};

}  // namespace

Opened with_flying(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  int width_px = 2;
  const Status status = apply_key_values(
      options,
      {whole_rule("width_px", 1, 8, [&](std::int64_t v) { width_px = static_cast<int>(v); })});
  return when_ok<Flying>(status, "flying", std::move(sequence), width_px);
}

Opened with_lowres(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  int every = 4;
  const Status status = apply_key_values(
      options, {whole_rule("every", 2, 16, [&](std::int64_t v) { every = static_cast<int>(v); })});
  return when_ok<Interpolated>(status, "lowres", std::move(sequence), every);
}

Opened with_speckle(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  SpeckleOptions speckle;
  const Status status = apply_key_values(
      options, {number_rule("holes", 0, 0.9, speckle.holes),
                number_rule("wild", 0, 0.5, speckle.wild), seed_rule(speckle.seed)});
  return when_ok<Speckled>(status, "speckle", std::move(sequence), speckle);
}

Opened with_frozen(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  FrozenOptions frozen;
  const Status status = apply_key_values(
      options, {whole_rule("every", 2, 1000, [&](std::int64_t v) { frozen.every = v; }),
                whole_rule("count", 1, 999, [&](std::int64_t v) { frozen.count = v; })});
  if (status.ok() && frozen.count >= frozen.every)
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("frozen: count is {}, expected less than every, {}", frozen.count,
                             frozen.every)};
  return when_ok<Frozen>(status, "frozen", std::move(sequence), frozen);
}

Opened with_misregistered(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  double right_px = 4, down_px = 0;
  const Status status = apply_key_values(options, {number_rule("right_px", -40, 40, right_px),
                                                   number_rule("down_px", -40, 40, down_px)});
  return when_ok<Misregistered>(status, "misregistered", std::move(sequence),
                                static_cast<int>(std::lround(right_px)),
                                static_cast<int>(std::lround(down_px)));
}

Opened with_banding(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  BandingOptions banding;
  const Status status =
      apply_key_values(options, {number_rule("amplitude", 0, 0.9, banding.amplitude),
                                 number_rule("bands", 0.5, 20, banding.bands)});
  return when_ok<Banded>(status, "banding", std::move(sequence), banding);
}

Opened with_dark(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  DarkOptions dark;
  const Status status =
      apply_key_values(options, {number_rule("gain", 0.01, 1, dark.gain),
                                 number_rule("sigma", 0, 50, dark.sigma), seed_rule(dark.seed)});
  return when_ok<Dark>(status, "dark", std::move(sequence), dark);
}

}  // namespace hermite::disturb
