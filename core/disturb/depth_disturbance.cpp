#include "core/disturb/depth_disturbance.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "core/dataset/changed_sequence.h"
#include "core/disturb/color_disturbance.h"
#include "core/disturb/depth_units.h"
#include "core/disturb/disturbed.h"
#include "core/disturb/key_values.h"
#include "core/image/image_codec.h"

namespace hermite::disturb {
namespace {

using Opened = Result<std::unique_ptr<dataset::Sequence>>;

class Bent : public dataset::ChangedSequence {
 public:
  Bent(std::unique_ptr<dataset::Sequence> original, double percent)
      : dataset::ChangedSequence(std::move(original)), bend_(percent / 100) {}

  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    Result<dataset::RecordedFrame> frame = original_->read(index);
    if (!frame.ok()) return frame;
    DepthImage& depth = frame->depth;
    for (int y = 0; y < depth.height; ++y)
      for (int x = 0; x < depth.width; ++x)
        depth.at(x, y) = to_depth_units(
            depth.at(x, y) * (1 + bend_ * squared_radius(x, y, depth.width, depth.height)), 1);
    return frame;
  }

 private:
  const double bend_;
};

// Radius of the window that stereo matching compares: a fiftieth of the image width.
int window_radius(int width) { return std::max(1, width / 50); }

double grey(const Rgb8& color) { return 0.299 * color.r + 0.587 * color.g + 0.114 * color.b; }

// Returns, by pixel, how much the grey value changes in the window around it, from sums over
// columns and then over rows.
std::vector<double> texture_of(const ColorImage& color) {
  const int width = color.width, height = color.height, radius = window_radius(width);
  const auto at = [width](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  };
  std::vector<double> change(color.pixels.size(), 0), columns(change), windows(change);
  for (int y = 0; y + 1 < height; ++y)
    for (int x = 0; x + 1 < width; ++x)
      change[at(x, y)] = std::abs(grey(color.at(x + 1, y)) - grey(color.at(x, y))) +
                         std::abs(grey(color.at(x, y + 1)) - grey(color.at(x, y)));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int v = std::max(0, y - radius); v <= std::min(height - 1, y + radius); ++v)
        columns[at(x, y)] += change[at(x, v)];
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int u = std::max(0, x - radius); u <= std::min(width - 1, x + radius); ++u)
        windows[at(x, y)] += columns[at(u, y)];
  return windows;
}

class Sparse : public dataset::ChangedSequence {
 public:
  Sparse(std::unique_ptr<dataset::Sequence> original, double keep)
      : dataset::ChangedSequence(std::move(original)), keep_(keep) {}

  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    Result<dataset::RecordedFrame> frame = original_->read(index);
    if (!frame.ok()) return frame;
    const auto color =
        image::decode_color(frame->color_bytes, {frame->depth.width, frame->depth.height});
    if (!color.ok()) return in_context("colour image", color.error());
    const std::vector<double> texture = texture_of(*color);
    std::vector<double> measured;
    for (std::size_t i = 0; i < texture.size(); ++i)
      if (frame->depth.pixels[i] > 0) measured.push_back(texture[i]);
    if (measured.empty()) return frame;
    const auto kept = std::clamp<std::size_t>(
        static_cast<std::size_t>(keep_ * static_cast<double>(measured.size())), 1, measured.size());
    std::nth_element(measured.begin(), measured.begin() + static_cast<std::ptrdiff_t>(kept - 1),
                     measured.end(), std::greater<>());
    for (std::size_t i = 0; i < texture.size(); ++i)
      if (texture[i] < measured[kept - 1]) frame->depth.pixels[i] = 0;
    return frame;
  }

 private:
  const double keep_;
};

// Depth in metres that a camera can measure.
struct Reach {
  double min_m = 1.5, max_m = 10;
};

class Reaching : public dataset::ChangedSequence {
 public:
  Reaching(std::unique_ptr<dataset::Sequence> original, const Reach& reach)
      : dataset::ChangedSequence(std::move(original)), reach_(reach) {}

  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    Result<dataset::RecordedFrame> frame = original_->read(index);
    if (!frame.ok()) return frame;
    const double units_per_metre = original_->camera().depth_units_per_metre;
    for (std::uint16_t& depth : frame->depth.pixels)
      if (depth < reach_.min_m * units_per_metre || depth > reach_.max_m * units_per_metre)
        depth = 0;
    return frame;
  }

 private:
  const Reach reach_;
};

class Refocused : public dataset::ChangedSequence {
 public:
  Refocused(std::unique_ptr<dataset::Sequence> original, double percent)
      : dataset::ChangedSequence(std::move(original)), camera_(original_->camera()) {
    camera_.fx *= 1 + percent / 100;
    camera_.fy *= 1 + percent / 100;
  }
  const Camera& camera() const override { return camera_; }

 private:
  Camera camera_;
};

class Skipping : public dataset::ChangedSequence {
 public:
  Skipping(std::unique_ptr<dataset::Sequence> original, std::int64_t every)
      : dataset::ChangedSequence(std::move(original)), every_(every) {}
  double frame_rate_hz() const override {
    return original_->frame_rate_hz() / static_cast<double>(every_);
  }
  std::int64_t frame_count() const override {
    return (original_->frame_count() + every_ - 1) / every_;
  }
  double timestamp_s(std::int64_t index) const override {
    return original_->timestamp_s(index * every_);
  }
  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    return original_->read(index * every_);
  }

 private:
  const std::int64_t every_;
};

// The only option of a disturbance.
struct NumberOption {
  const char* key;
  double low, high, value;
};

template <class Disturbed>
Opened with_number(std::unique_ptr<dataset::Sequence> sequence, const char* name,
                   const std::string& options, NumberOption number) {
  const Status status =
      apply_key_values(options, {number_rule(number.key, number.low, number.high, number.value)});
  return when_ok<Disturbed>(status, name, std::move(sequence), number.value);
}

}  // namespace

Opened with_bend(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  return with_number<Bent>(std::move(sequence), "bend", options, {"percent", -10, 10, 1.5});
}

Opened with_sparse(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  return with_number<Sparse>(std::move(sequence), "sparse", options, {"keep", 0.01, 1, 0.1});
}

Opened with_reach(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  Reach reach;
  const Status status = apply_key_values(options, {number_rule("min_m", 0, 10, reach.min_m),
                                                   number_rule("max_m", 0.1, 100, reach.max_m)});
  return when_ok<Reaching>(status, "reach", std::move(sequence), reach);
}

Opened with_focal(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  return with_number<Refocused>(std::move(sequence), "focal", options, {"percent", -40, 40, 1});
}

Opened with_skip(std::unique_ptr<dataset::Sequence> sequence, const std::string& options) {
  std::int64_t every = 3;
  const Status status = apply_key_values(
      options, {whole_rule("every", 2, 1000, [&every](std::int64_t value) { every = value; })});
  return when_ok<Skipping>(status, "skip", std::move(sequence), every);
}

}  // namespace hermite::disturb
