// Pictures of a mesh as a viewer would draw it, and how near they come to frames that the texture was not made from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/output/triangle_mesh.h"
#include "core/texture/texture.h"
#include "core/texture/texture_options.h"

namespace hermite {

struct MeshPicture {
  ColorImage color;                // black where there is no mesh
  Image<std::uint8_t> is_covered;  // by pixel
};

enum class MeshColor { kTexture, kVertices };

// The texture between its texels, or the colours of the vertices between them; not lit.
MeshPicture drawn(const TriangleMesh& mesh, const Camera& camera, const Rigid3& world_from_camera, MeshColor color);

// Peak signal-to-noise ratio [dB] over the pixels that the picture covers, of all channels, 99 for no difference.
double psnr_db(const MeshPicture& picture, const ColorImage& image);

struct HeldOutFrame {
  std::size_t frame = 0;
  double covered_share = 0;  // of the pixels
  double texture_db = 0, vertices_db = 0;
  double texture_gain_db = 0, vertices_gain_db = 0;  // the picture brightened by the factor for each channel that fits the frame best
  double texture_aligned_db = 0;  // that, drawn from the pose that the frame's colours fit the other views' best (view_alignment.h)
  Rigid3 aligned_world_from_camera;
  double texture_warped_db = 0;  // from there, the frame bent as the texture's views were (view_warp.h)
};

struct HeldOutQuality {
  std::vector<HeldOutFrame> frames;
  double texture_db = 0, vertices_db = 0, texture_gain_db = 0, vertices_gain_db = 0, texture_aligned_db = 0,
         texture_warped_db = 0;  // means over the frames
};

// Leaves out every eighth of the views that textured() would use, makes the texture from the rest, and draws the mesh at the poses that the
// frames left out have in `frames`. Errors as of textured(); kNotFound too when fewer than eight views are there. `result` and
// `statistics`, where given, are of the mesh with that texture.
inline constexpr std::size_t kHeldOutOf = 8;
Result<HeldOutQuality> held_out_quality(const TriangleMesh& mesh, const TextureFrames& frames, const TextureOptions& options,
                                        TriangleMesh* result = nullptr, TextureStatistics* statistics = nullptr);

}  // namespace hermite
