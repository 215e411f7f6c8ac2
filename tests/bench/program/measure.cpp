#include "tests/bench/program/measure.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace hermite::bench {

std::int64_t frame_to_play(std::int64_t step, std::int64_t file_frame_count) {
  if (file_frame_count == 1) return 0;
  const std::int64_t period = 2 * (file_frame_count - 1), phase = step % period;
  return phase < file_frame_count ? phase : period - phase;
}

std::int64_t measured_frame_count(const Arguments& arguments, std::int64_t file_frame_count) {
  if (arguments.frame_count > 0) return arguments.frame_count;
  return std::max(kFewestFrames, file_frame_count - arguments.warm_up_count);
}

output::Cloud elsewhere(std::int64_t count) {
  // A patch is 16 x 16 surfels a centimetre apart, as many as a block of the map has.
  constexpr int kSide = 16;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(-1, 1);
  output::Cloud cloud;
  while (cloud.size() < static_cast<std::size_t>(count)) {
    Eigen::Vector3f direction(unit(random), unit(random), unit(random));
    if (direction.norm() > 1 || direction.norm() < 0.1f) continue;
    direction.normalize();
    const Eigen::Vector3f corner = (40 + 15 * unit(random)) * direction,
                          right = direction.unitOrthogonal(), down = direction.cross(right);
    for (int i = 0; i < kSide * kSide && cloud.size() < static_cast<std::size_t>(count); ++i) {
      output::CloudPoint point;
      point.position_m = corner + 0.01f * (static_cast<float>(i % kSide) * right +
                                           static_cast<float>(i / kSide) * down);
      point.normal = -direction;
      point.confidence = 10;
      point.radius_m = 0.03f;
      cloud.push_back(point);
    }
  }
  return cloud;
}

Measurement measure(RawFrameReader& file, const Arguments& arguments) {
  Timeline timeline;
  pipeline::Pipeline pipeline(arguments.device, file.camera(), arguments.options, nullptr,
                              &timeline);
  if (arguments.elsewhere_count > 0)
    or_throw(pipeline.insert(elsewhere(arguments.elsewhere_count)));
  Measurement measurement;
  const std::int64_t steps =
      arguments.warm_up_count + measured_frame_count(arguments, file.frame_count());
  for (std::int64_t step = 0; step < steps; ++step) {
    MeasuredFrame measured;
    measured.index = frame_to_play(step, file.frame_count());
    // Programs do this on another thread.
    const frame::PreparedFrame frame =
        or_throw(pipeline.prepare(or_throw(file.read(measured.index))));
    timeline = {};
    measured.start = Timeline::Clock::now();
    const pipeline::FrameResult result = or_throw(pipeline.process(frame));
    measured.wall_ms =
        std::chrono::duration<double, std::milli>(Timeline::Clock::now() - measured.start).count();
    measured.tracked = result.status != track::TrackingStatus::kLost;
    measured.timeline = std::move(timeline);
    if (step >= arguments.warm_up_count) measurement.frames.push_back(std::move(measured));
  }
  measurement.statistics = pipeline.statistics();
  return measurement;
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(std::clamp(
                                        rank - 1, 0.0, static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

}  // namespace hermite::bench
