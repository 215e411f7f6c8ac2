// Renders a mesh as a viewer would, and compares the result with frames from which the texture was
// not made.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/output/triangle_mesh.h"
#include "core/texture/texture.h"
#include "core/texture/texture_options.h"

namespace hermite::texture {

struct MeshRendering {
  ColorImage color;                // black where there is no mesh
  Image<std::uint8_t> is_covered;  // by pixel
};

enum class MeshColor { kTexture, kVertices };

// Renders unlit: with the texture sampled bilinearly, or with interpolated vertex colours.
MeshRendering drawn(const output::TriangleMesh& mesh, const Camera& camera,
                    const Rigid3& world_from_camera, MeshColor color);

// Returns the peak signal-to-noise ratio [dB] over all channels of the pixels that the mesh covers;
// 99 if there is no difference.
double psnr_db(const MeshRendering& rendering, const ColorImage& image);

struct HeldOutFrame {
  std::size_t frame = 0;
  double covered_share = 0;  // of the pixels
  double texture_db = 0, vertices_db = 0;
  // After scaling each channel of the rendered image to fit the frame best.
  double texture_gain_db = 0, vertices_gain_db = 0;
  // The same, from the pose at which the frame agrees best with the views (view_alignment.h).
  double texture_aligned_db = 0;
  Rigid3 aligned_world_from_camera;
  double texture_warped_db = 0;  // the same, with the frame warped as the views were (view_warp.h)
};

struct HeldOutQuality {
  std::vector<HeldOutFrame> frames;
  double texture_db = 0, vertices_db = 0, texture_gain_db = 0, vertices_gain_db = 0,
         texture_aligned_db = 0,
         texture_warped_db = 0;  // means over the frames
};

// One of this many views is held out.
inline constexpr std::size_t kHeldOutOf = 8;

// Holds out every eighth view that textured() would use, makes the texture from the others, and
// renders the mesh at the poses of the held-out frames. Errors as for textured(), and kNotFound for
// fewer than eight views. `result` and `statistics`, if given, receive the mesh with that texture
// and its statistics.
Result<HeldOutQuality> held_out_quality(const output::TriangleMesh& mesh,
                                        const TextureFrames& frames, const TextureOptions& options,
                                        output::TriangleMesh* result = nullptr,
                                        TextureStatistics* statistics = nullptr);

}  // namespace hermite::texture
