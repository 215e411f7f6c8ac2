// Relative poses of submaps, and how far they may have drifted apart. Plain values.
#pragma once

#include <cstdint>
#include <vector>

#include "core/math/rigid3.h"

namespace hermite::adjust {

struct SubmapLink {
  std::uint32_t from = 0, to = 0;
  Rigid3 from_from_to;
  double length_m = 0;   // path length, see length_of(); 0 for a loop
  bool is_loop = false;  // measured by a verified loop; otherwise by tracking
};

struct SubmapGraph {
  std::vector<std::uint32_t> component;  // by submap; links connect the submaps of a component
  // The submap that each one was opened from; itself for the first of a component.
  std::vector<std::uint32_t> parent;
  std::vector<SubmapLink> links;
};

// Returns the distance of two poses [m]; a rotation counts as the path of a point half a metre
// away.
double length_of(const Rigid3& a_from_b);

bool is_within(const Rigid3& a_from_b, double distance_m, double turn_rad);

// Adds a submap without links and returns its index.
std::uint32_t add_submap(SubmapGraph& graph, std::uint32_t component);

// Adds a link between two submaps that were tracked against at once. The first such link of a pair
// is kept.
void link_tracked(SubmapGraph& graph, std::uint32_t from, std::uint32_t to,
                  const Rigid3& from_from_to);

// Returns the shortest path length along links to every submap [m] (Dijkstra); infinite if there is
// none, as to other components.
std::vector<double> distances_m(const SubmapGraph& graph, std::uint32_t from);

// Returns the inverse covariance of the link's error, in the order of log_se3.
Matrix6d information_of(const SubmapLink& link);

// Returns whether tracking over a path of this length can have drifted by this much.
bool is_possible_drift(const Rigid3& drift, double path_m);

}  // namespace hermite::adjust
