// Measures how much of a cloud exists twice: surfaces that were mapped again slightly in front of
// or behind the first layer, because the camera returned with a pose error. Needs no true surface.
// Pure functions, metres.
//
// For a point p with normal n, the points q around it count that are seen from the same side
// (normals within 45 degrees, so that the two sides of a panel are no double layer), whose offset
// n.(q - p) is within +-30 mm and whose distance from the line along n is at most q's radius, at
// most 10 mm, or 5 mm if no radius is known; q then covers the position of p. (10 mm: on one
// surface a normal that is wrong by 45 degrees gives offsets of no more than that, and a step such
// as that from book to book on a shelf counts along its edge only.) The q within +-10 mm are p's
// own layer; those from 10 to 30 mm in front of it and those behind it are candidates for another
// layer. p is doubled if the mean offset of either differs from that of its own layer by 10 to 30
// mm and if it has at least a quarter as many points as that. Means are used because a single p may
// itself be 10 mm off its layer by noise. Less than 10 mm can be explained by noise and the size of
// surfels; more than 30 mm may as well be another object.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace hermite::evaluate {

struct LayerPoint {
  Eigen::Vector3f position_m = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // any length but 0
  float radius_m = 0;                                // 0: unknown
};

struct DoubleLayers {
  std::int64_t point_count = 0;  // points that were judged
  // Not finite, without a normal, or more than 10 km from the origin.
  std::int64_t left_out_count = 0;
  std::int64_t doubled_count = 0;
  double share = 0;  // of the judged points; 0 without points
};

// Memory: about 60 bytes per point in addition to the cloud. 2 million points take a few seconds on
// one core. CHECK: at most 2^32 - 1 points.
DoubleLayers double_layers(const std::vector<LayerPoint>& cloud);

// Returns an object with the keys layer_points, layer_left_out, layer_doubled, layer_doubled_share.
std::string format_double_layers_json(const DoubleLayers& layers);

}  // namespace hermite::evaluate
