#include "core/texture/texture_detail.h"

#include <algorithm>

#include "core/base/parallel.h"

namespace hermite::texture {

namespace {

constexpr std::size_t kVerticesAtOnce = 4096;
constexpr float kDetailEdge_px = 1;

}  // namespace

std::vector<float> finest_pixels_m(const output::TriangleMesh& mesh, const Camera& camera,
                                   const std::vector<TextureView>& views,
                                   const TextureOptions& options) {
  std::vector<float> finest(mesh.positions_m.size(), kNeverSeen_m);
  in_parallel((finest.size() + kVerticesAtOnce - 1) / kVerticesAtOnce, options.thread_count,
              [&](std::size_t block) {
                if (is_stopped(options)) return;
                const std::size_t end = std::min(finest.size(), (block + 1) * kVerticesAtOnce);
                for (std::size_t i = block * kVerticesAtOnce; i < end; ++i)
                  for (const TextureView& view : views)
                    if (const std::optional<Seen> seen = seen_at(view, camera, mesh.positions_m[i],
                                                                 mesh.normals[i], kDetailEdge_px))
                      finest[i] =
                          std::min(finest[i],
                                   seen->depth_m / (static_cast<float>(camera.fx) * seen->cosine));
              });
  return finest;
}

}  // namespace hermite::texture
