// Points of the true surface, and where a reconstruction has them: to judge what is measured between places of a scan. Pure function.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/dataset/sequence.h"

namespace hermite {

struct TruePoint {
  Eigen::Vector3d true_m = Eigen::Vector3d::Zero();       // in the true world
  Eigen::Vector3d estimated_m = Eigen::Vector3d::Zero();  // in the estimate's: the mean over frames that see it, each by its own two poses
};

// Of random pixels of random frames of `sequence`, whose depth is without noise, 0.4 to 4.5 m deep; what no frame looked at has an estimate
// of is left out, so that there may be fewer than `count`. Up to 120 frames are looked at, spread evenly. A frame sees a point where its
// depth is the point's, within 1 cm and 1 %. No alignment of the two worlds is needed, and none is made. The same seed gives the same
// points. kNotFound: no true poses, no pose of the estimate at the time of a frame.
Result<std::vector<TruePoint>> true_points(const Sequence& sequence, const Trajectory& estimate, std::size_t count, std::uint64_t seed);

}  // namespace hermite
