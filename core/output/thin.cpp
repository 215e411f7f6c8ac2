#include "core/output/thin.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/base/check.h"

namespace hermite::output {
namespace {

constexpr double kFinestCube_m = 0.002, kCubeGrowth = 1.25;

struct Cube {
  std::int64_t x = 0, y = 0, z = 0;
  bool operator==(const Cube&) const = default;
};
struct CubeHash {
  std::size_t operator()(const Cube& cube) const {
    std::uint64_t mixed = 0;
    for (const std::int64_t value : {cube.x, cube.y, cube.z})
      mixed = (mixed ^ static_cast<std::uint64_t>(value)) * 0x9e3779b97f4a7c15ull;
    return static_cast<std::size_t>(mixed ^ (mixed >> 29));
  }
};

Cube cube_of(const Eigen::Vector3f& position_m, double edge_m) {
  const Eigen::Vector3d cell = (position_m.cast<double>() / edge_m).array().floor();
  return {static_cast<std::int64_t>(cell.x()), static_cast<std::int64_t>(cell.y()),
          static_cast<std::int64_t>(cell.z())};
}

// Returns the index of the most confident point of each cube, the first if several are equal; empty
// when there are more than `most`.
std::vector<std::size_t> best_of_cubes(const Cloud& cloud, double edge_m, std::size_t most) {
  std::unordered_map<Cube, std::size_t, CubeHash> best;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto [found, is_new] = best.try_emplace(cube_of(cloud[i].position_m, edge_m), i);
    if (best.size() > most) return {};
    if (!is_new && cloud[i].confidence > cloud[found->second].confidence) found->second = i;
  }
  std::vector<std::size_t> places;
  for (const auto& [cube, place] : best) places.push_back(place);
  std::sort(places.begin(), places.end());
  return places;
}

}  // namespace

Cloud thinned(const Cloud& cloud, std::size_t most) {
  CHECK(most >= 1, "thinned() cannot return zero points");
  if (cloud.size() <= most) return cloud;
  double farthest_m = 0;
  for (const CloudPoint& point : cloud) {
    CHECK(point.position_m.allFinite(), "a position is not finite");
    farthest_m = std::max(farthest_m, static_cast<double>(point.position_m.cwiseAbs().maxCoeff()));
  }
  // Keeps cube indices within 64 bits.
  double edge_m = std::max(kFinestCube_m, farthest_m * 1e-15);
  std::vector<std::size_t> places;
  for (; places.empty() && edge_m <= 4 * farthest_m; edge_m *= kCubeGrowth)
    places = best_of_cubes(cloud, edge_m, most);
  if (places.empty()) places = {0};  // the cubes around the origin are at least eight
  Cloud thin;
  for (const std::size_t place : places) thin.push_back(cloud[place]);
  return thin;
}

}  // namespace hermite::output
