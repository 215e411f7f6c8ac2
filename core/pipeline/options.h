// Settings of the reconstruction. All sequences use the same defaults.
#pragma once

#include <string>
#include <vector>

#include "core/adjust/adjust_options.h"
#include "core/base/result.h"
#include "core/frame/frame_options.h"
#include "core/map/map_options.h"
#include "core/track/track_options.h"

namespace hermite::pipeline {

struct Options {
  frame::FrameOptions frame;
  track::TrackOptions track;
  map::MapOptions map;
  adjust::AdjustOptions adjust;
  bool output_unstable = false;  // also export surfels that are not stable
};

// Returns the least confidence of the surfels in cloud().
double least_output_confidence(const Options& options);

// One row of `--help`, of report.json's "settings" and of the protocol's settings map.
struct Setting {
  std::string key;          // "track.geometric_weight"
  std::string value;        // as text
  std::string description;  // one line, with unit and range
};
std::vector<Setting> list_settings(const Options& options);

// Returns kInvalidArgument or kNotFound, naming the key and the range.
Status apply_setting(Options& options, const std::string& key, const std::string& value);

}  // namespace hermite::pipeline
