// A measurement of two frames with round numbers, for the tests of what is made of measurements.
// Header only.
#pragma once

#include "tests/bench/program/measure.h"

namespace hermite::bench {

inline Measurement made_up_measurement() {
  using std::chrono::microseconds;
  const Timeline::Clock::time_point zero = Timeline::Clock::time_point{} + std::chrono::hours(5);
  Measurement measurement;
  MeasuredFrame tracked{7, true, zero, 10, {}};
  tracked.timeline.stages = {{"track", zero + microseconds(500), 6},
                             {"fuse", zero + microseconds(7000), 2.5}};
  tracked.timeline.passes = {{"track/odometry", zero + microseconds(600), 1.25, 8192, 1000},
                             {"track/odometry", zero + microseconds(2000), 0.75, 8192, 1000},
                             {"map/merge", zero + microseconds(7500), 3, 100, 5000}};
  MeasuredFrame lost{8, false, zero + microseconds(20000), 4, {}};
  lost.timeline.stages = {{"track", zero + microseconds(20500), 3}};
  lost.timeline.passes = {{"track/odometry", zero + microseconds(21000), 0.5, 8192, 1000}};
  measurement.frames = {tracked, lost};
  measurement.statistics.device = "a \"device\"\n";
  measurement.statistics.surfel_count = 1000;
  measurement.statistics.surfel_slot_count = 2000;
  measurement.statistics.surfel_capacity = 4000;
  measurement.statistics.gpu_memory_bytes = {{"map", 80'000}, {"frame", 1'500'000}};
  return measurement;
}

}  // namespace hermite::bench
