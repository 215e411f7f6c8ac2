// Colour and depth images with numbers in their names, as in Redwood's and most other data: in two
// folders ("color" or "rgb" or "image", and "depth", also with a prefix as in "livingroom1-depth"),
// or in one, distinguished by these words in their names.
//
// The number is the first run of digits of a file's name. A second run is a time in microseconds
// (Redwood: 0000042-000001401401.png), if every depth image has one and they ascend.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/dataset/recorded_folder.h"

namespace hermite::dataset {

struct NumberedImages {
  std::string where;  // as text: "color/ and depth/"
  std::vector<FramePaths> frames;
  bool has_times = false;  // from the file names; otherwise times are numbers / frame_rate_hz
};

// Returns the images of the folder, or else of the first of its subfolders that has any;
// std::nullopt if there is no pair. Depth must be .png, colour .png or .jpg. kTooLarge, and errors
// of file_names.
Result<std::optional<NumberedImages>> find_numbered_images(const std::string& folder,
                                                           double frame_rate_hz);

}  // namespace hermite::dataset
