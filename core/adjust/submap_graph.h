// Submaps, what is known of their relative poses, and how far they may have drifted apart. Plain values.
#pragma once

#include <cstdint>
#include <vector>

#include "core/math/rigid3.h"

namespace hermite {

struct SubmapLink {
  std::uint32_t from = 0, to = 0;
  Rigid3 from_from_to;
  double length_m = 0;   // see length_of(); 0 for a loop
  bool is_loop = false;  // seen by a camera that came back, otherwise tracked
};

struct SubmapGraph {
  std::vector<Rigid3> world_from_submap;
  std::vector<std::uint32_t> part;    // by submap
  std::vector<std::uint32_t> parent;  // by submap: the one it was opened from, itself for the first of a part
  std::vector<SubmapLink> links;
};

// How far apart two cameras are: metres, where a turn counts as the way of a point half a metre off.
double length_of(const Rigid3& a_from_b);

std::uint32_t add_submap(SubmapGraph& graph, const Rigid3& world_from_submap, std::uint32_t part);

// The present relative pose as a link, unless there is one.
void link_tracked(SubmapGraph& graph, std::uint32_t from, std::uint32_t to);

// Along links from a submap to every other [m]; infinite where there is no way, as to other parts. (Dijkstra)
std::vector<double> distances_m(const SubmapGraph& graph, std::uint32_t from);

// What one link may be off by: standard deviations.
struct LinkNoise {
  double translation_m = 0, rotation_rad = 0;
};
LinkNoise noise_of(const SubmapLink& link);
Matrix6d information_of(const SubmapLink& link);

// Could tracking over a path so long be off by this much?
bool is_possible_drift(const Rigid3& drift, double path_m);

// Moves every submap of the part of `moved` so that world_from_submap[moved] becomes what is given, and makes it part of `into`.
void join_parts(SubmapGraph& graph, std::uint32_t moved, const Rigid3& world_from_moved, std::uint32_t into);

}  // namespace hermite
