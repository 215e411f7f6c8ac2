// Colour and depth images that go by numbers, as Redwood's and most people's own: in two folders ("color" or "rgb" or "image", and
// "depth", also behind a name: "livingroom1-depth"), or in one, told apart by these words in their names.
//
// The number is the first run of digits of a file's name. A second run is a time in microseconds (Redwood: 0000042-000001401401.png), where
// every depth image has one and they ascend.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/dataset/recorded_folder.h"

namespace hermite {

struct NumberedImages {
  std::string where;  // in words: "color/ and depth/"
  std::vector<FramePaths> frames;
  bool has_times = false;  // of the files' names; else numbers / frame_rate_hz
};

// Of the folder, else of the first of its folders that has any. Nothing when there is no pair. Depth must be .png, colour .png or .jpg.
// kTooLarge and what file_names returns.
Result<std::optional<NumberedImages>> find_numbered_images(const std::string& folder, double frame_rate_hz);

}  // namespace hermite
