// Depth images of a recorded sequence of the 7-Scenes kind. Header only.
#pragma once

#include <cstdio>
#include <filesystem>
#include <vector>

#include "core/base/check.h"
#include "core/image/image_codec.h"
#include "tests/support/file_bytes.h"

namespace hermite::test {

// Every 50th of 1000 frames.
inline std::vector<DepthImage> recorded_depth(const std::filesystem::path& folder) {
  std::vector<DepthImage> images;
  for (int frame = 0; frame < 1000; frame += 50) {
    char name[32];
    std::snprintf(name, sizeof name, "frame-%06d.depth.png", frame);
    Result<DepthImage> depth = image::decode_depth_png(file_bytes(folder / name), {640, 480});
    CHECK(depth.ok(), std::string(name) + " cannot be read");
    images.push_back(*std::move(depth));
  }
  return images;
}

}  // namespace hermite::test
