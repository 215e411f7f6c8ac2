#include "core/output/mesh_check.h"

#include <fmt/core.h>

#include <string>

namespace hermite::output {
namespace {

Error wrong_mesh(const std::string& message) {
  return {ErrorCode::kInvalidArgument, "mesh: " + message};
}

Status check_lengths(const TriangleMesh& mesh) {
  const std::size_t count = mesh.positions_m.size();
  if (count > kMaxMeshVertices)
    return Error{ErrorCode::kTooLarge, fmt::format("mesh: {} vertices, at most {} can be written",
                                                   count, kMaxMeshVertices)};
  if (mesh.normals.size() != count || mesh.colors.size() != count)
    return wrong_mesh(
        fmt::format("{} positions, {} normals and {} colours: their numbers must be equal", count,
                    mesh.normals.size(), mesh.colors.size()));
  const bool is_textured = !mesh.pages.empty();
  if (mesh.texture_coordinates.size() != (is_textured ? count : 0))
    return wrong_mesh(fmt::format("{} texture coordinates for {} vertices and {} pages",
                                  mesh.texture_coordinates.size(), count, mesh.pages.size()));
  return Done{};
}

Status check_vertices(const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < mesh.positions_m.size(); ++i) {
    const char* what =
        !mesh.positions_m[i].allFinite() ? "position"
        : !mesh.normals[i].allFinite()   ? "normal"
        : !mesh.texture_coordinates.empty() && !mesh.texture_coordinates[i].allFinite()
            ? "texture coordinate"
            : nullptr;
    if (what) return wrong_mesh(fmt::format("the {} of vertex {} is not finite", what, i));
  }
  return Done{};
}

Status check_triangles(const TriangleMesh& mesh) {
  if (!mesh.is_filled.empty() && mesh.is_filled.size() != mesh.triangles.size())
    return wrong_mesh(fmt::format("{} filled marks for {} triangles", mesh.is_filled.size(),
                                  mesh.triangles.size()));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const std::uint32_t corner : mesh.triangles[i])
      if (corner >= mesh.positions_m.size())
        return wrong_mesh(fmt::format("triangle {} refers to vertex {} of {}", i, corner,
                                      mesh.positions_m.size()));
  return Done{};
}

Status check_pages(const TriangleMesh& mesh) {
  std::uint64_t covered = 0;
  for (std::size_t i = 0; i < mesh.pages.size(); ++i) {
    const TexturePage& page = mesh.pages[i];
    const std::string name = "page " + std::to_string(i);
    if (page.first_triangle != covered)
      return wrong_mesh(fmt::format("{} starts at triangle {} instead of {}", name,
                                    page.first_triangle, covered));
    covered += page.triangle_count;
    const ColorImage& image = page.image;
    if (image.width < 1 || image.height < 1 ||
        image.pixels.size() !=
            static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
      return wrong_mesh(fmt::format("{} has no image: {}x{} with {} pixels", name, image.width,
                                    image.height, image.pixels.size()));
  }
  if (!mesh.pages.empty() && covered != mesh.triangles.size())
    return wrong_mesh(fmt::format("pages have {} of {} triangles", covered, mesh.triangles.size()));
  return Done{};
}

}  // namespace

Status check_mesh(const TriangleMesh& mesh) {
  for (const auto check : {check_lengths, check_vertices, check_triangles, check_pages})
    if (const Status status = check(mesh); !status.ok()) return status;
  return Done{};
}

Status check_mesh_with_triangles(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return wrong_mesh("it has no triangles");
  return check_mesh(mesh);
}

}  // namespace hermite::output
