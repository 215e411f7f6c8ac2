// LAS 1.4 (ASPRS, R15), point format 7: x y z in steps of 0.1 mm, z up (axes.h), metres; red, green and blue of 16 bits (ours times 257).
// Behind each point what else a surfel has, described in the file by an "Extra Bytes" record, by which PDAL, CloudCompare and LAStools
// show it: NormalX, NormalY, NormalZ, Confidence, CurvatureMax, CurvatureMin (1/m), Radius (m) as float, Submap as unsigned long. The
// coordinate system is a local one in metres. Classification 0 (never classified), one return each, no time, no date: the same cloud gives
// the same bytes. Pure.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/output/cloud.h"

namespace hermite {

// kInvalidArgument: check_cloud_with_points. kTooLarge: points more than 200 km apart, which 32 bits of 0.1 mm do not reach.
Result<std::string> format_las(const Cloud& cloud);

}  // namespace hermite
