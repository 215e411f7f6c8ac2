// The output of `hermite evaluate` about clouds and meshes: how far they are from the true surface,
// and what is wrong with them by themselves.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace hermite::commands {

struct ShapeJudging {
  // Where the cloud and the meshes lie: the trajectory that they were made with, TUM file, and the
  // true one (read_groundtruth); empty: in the world of the surface.
  std::string estimate, groundtruth;
  std::string cloud;                // PLY file
  std::string surface;              // the true one: PLY file, or a sequence
  std::string colored;              // PLY file for the cloud, coloured by its error; empty: none
  std::string surfels;              // PLY file with what the meshes were made of; empty: the cloud
  std::vector<std::string> meshes;  // PLY files
  double cell_m = 0.01;             // side of a cell of the meshes
};

// Returns the distances of the cloud from the true surface, and its completeness. Throws
// SetupError.
nlohmann::ordered_json evaluate_surface(const ShapeJudging& judging);

// Returns the defects of every mesh and, if there is ground truth, its distance from that; for the
// cloud the same errors. Throws SetupError.
nlohmann::ordered_json evaluate_meshes(const ShapeJudging& judging);

// Returns the share of points of the PLY file `cloud` that have another layer of the same surface
// near to them. Throws SetupError.
nlohmann::ordered_json evaluate_layers(const std::string& cloud);

}  // namespace hermite::commands
