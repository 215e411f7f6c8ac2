// How much of a cloud is there twice: surfaces that were mapped again a little in front of or behind themselves, because the camera came
// back with an error in its pose. Needs no true surface. Pure functions, metres.
//
// For a point p with normal n the points q around it count that are seen from the same side (normals within 45 degrees: the two sides of a
// panel are no double layer) and whose offset n.(q - p) is within +-30 mm while they lie beside the line along n by no more than q's
// radius, at most 10 mm, or 5 mm where no radius is known: q then covers the place of p. (10 mm: on one surface a normal that is wrong by
// 45 degrees gives offsets of no more than that, and a step such as that from book to book on a shelf counts along its edge only.) The q
// within +-10 mm are p's own layer, the q from 10 to 30 mm in front of it and those behind it are candidates for another; p is doubled when
// the mean offset of either differs from its own layer's by 10 to 30 mm. Means, because a single p may itself lie 10 mm off its layer by
// noise. Less than 10 mm is what noise and the size of surfels explain; more than 30 mm is as likely another thing.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace hermite {

struct LayerPoint {
  Eigen::Vector3f position_m = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // any length but 0
  float radius_m = 0;                                // 0: not known
};

struct DoubleLayers {
  std::int64_t point_count = 0;     // judged
  std::int64_t left_out_count = 0;  // not finite, without a normal, or more than 10 km from the origin
  std::int64_t doubled_count = 0;
  double share = 0;  // of the points judged; 0 without points
};

// Memory: about 60 bytes a point beside the cloud. 2 million points take a few seconds on one core. At most 2^32 - 1 points (a CHECK).
DoubleLayers double_layers(const std::vector<LayerPoint>& cloud);

// Keys: layer_points, layer_left_out, layer_doubled, layer_doubled_share.
std::string format_double_layers_json(const DoubleLayers& layers);

}  // namespace hermite
