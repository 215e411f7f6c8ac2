// What is known of the relative poses of submaps, and how far they may have drifted apart. Plain values.
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
  std::vector<std::uint32_t> component;  // by submap; links tie the submaps of a component together
  std::vector<std::uint32_t> parent;     // by submap: the one it was opened from, itself for the first of a component
  std::vector<SubmapLink> links;
};

// How far apart two cameras are: metres, where a turn counts as the way of a point half a metre off.
double length_of(const Rigid3& a_from_b);

bool is_within(const Rigid3& a_from_b, double distance_m, double turn_rad);

// Without a link.
std::uint32_t add_submap(SubmapGraph& graph, std::uint32_t component);

// Tracking has seen both at once. The first such link of two submaps stays.
void link_tracked(SubmapGraph& graph, std::uint32_t from, std::uint32_t to, const Rigid3& from_from_to);

// Along links from a submap to every other [m]; infinite where there is no way, as to other components. (Dijkstra)
std::vector<double> distances_m(const SubmapGraph& graph, std::uint32_t from);

// Inverse covariance of what the link may be off by, in the order of log_se3.
Matrix6d information_of(const SubmapLink& link);

// Could tracking over a path so long be off by this much?
bool is_possible_drift(const Rigid3& drift, double path_m);

}  // namespace hermite
