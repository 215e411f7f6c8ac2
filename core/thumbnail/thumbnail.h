// A small image of a whole scan, for lists: seen from above and outside, without what would hide
// its inside, from the side that shows most of it. Pure functions.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/math/up_direction.h"
#include "core/output/cloud.h"

namespace hermite::thumbnail {

inline constexpr int kThumbnailWidth_px = 480, kThumbnailHeight_px = 360;
inline constexpr const char* kThumbnailName = "thumbnail.jpg";  // among the results of a scan

// How many points to draw of a mesh (points_on): on its two sides one for each pixel.
inline constexpr std::size_t kThumbnailPoints = 400'000;

// Draws the cloud; of an empty one there is only the background. Points without a radius take that
// of their neighbours' distance. The same cloud gives the same pixels.
// `up`: as measured, if it was.
ColorImage thumbnail_of(const output::Cloud& cloud, const std::optional<UpDirection>& up = {});

// Returns the same as JPEG, about 30 kB.
Result<std::string> thumbnail_jpeg(const output::Cloud& cloud,
                                   const std::optional<UpDirection>& up = {});

}  // namespace hermite::thumbnail
