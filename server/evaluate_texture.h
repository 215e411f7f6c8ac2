// The output of `hermite evaluate --texture`.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace hermite::commands {

struct TextureJudging {
  std::string recording, mesh, trajectory;
  // Folder for the atlas pages, and for each held-out frame next to renderings of the mesh; empty:
  // none.
  std::string images;
  double texel_mm = 2;
  int max_views = 200, blended_views = 4;
  bool keeps_exposure = false, keeps_poses = false;
};

// Makes the texture of the mesh without every eighth view, and compares renderings of it with those
// views. Throws SetupError.
nlohmann::ordered_json evaluate_texture(const TextureJudging& judging);

}  // namespace hermite::commands
