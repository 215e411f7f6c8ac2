// LAS 1.4 (ASPRS, R15), point format 7: x y z in steps of 0.1 mm, z up (axes.h), metres; red, green
// and blue with 16 bits (8-bit values times 257). Each point has further columns, which an "Extra
// Bytes" record describes for PDAL, CloudCompare and LAStools: NormalX, NormalY, NormalZ,
// Confidence, CurvatureMax, CurvatureMin (1/m), Radius (m) as float, and Submap as unsigned long.
// The coordinate system is a local one in metres. The classification is 0 (never classified), each
// point is a single return, and time and date are absent, so the same cloud gives the same bytes.
// Pure.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/output/cloud.h"

namespace hermite::output {

// Returns kInvalidArgument as check_cloud_with_points, and kTooLarge for points more than 200 km
// apart, which exceed 32 bits in steps of 0.1 mm.
Result<std::string> format_las(const Cloud& cloud);

}  // namespace hermite::output
