// Settings of the reconstruction. One set of defaults for every sequence; each constant has its reason beside it in options.cpp's table.
#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"

namespace hermite {

struct Options {
  // frame
  double depth_min_m = 0.3;
  double depth_max_m = 4.0;
  // track
  double icp_weight = 10.0;
  // map
  double stable_confidence = 3.0;
  bool output_unstable = false;
};

// One row of `--help`, of report.json's "settings" and of the protocol's settings map.
struct Setting {
  std::string key;          // "track.icp_weight"
  std::string value;        // as text
  std::string description;  // one line, with unit and range
};
std::vector<Setting> list_settings(const Options& options);

// kInvalidArgument, naming key and range.
Status apply_setting(Options& options, const std::string& key, const std::string& value);

}  // namespace hermite
