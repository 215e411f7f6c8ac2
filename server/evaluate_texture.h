// What `hermite evaluate --texture` prints.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace hermite {

struct TextureJudging {
  std::string recording, mesh, trajectory;
  std::string pictures;  // folder for the pages, and for each frame left out beside the mesh's pictures of it; empty: none
  double texel_mm = 2;
  int max_views = 200, blended_views = 4;
  bool keeps_exposure = false, keeps_poses = false;
};

// Makes the texture of the mesh without every eighth view, and says how near its pictures come to those. SetupError.
nlohmann::ordered_json evaluate_texture(const TextureJudging& judging);

}  // namespace hermite
