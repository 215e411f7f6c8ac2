#include "core/output/mesh_check.h"

#include <string>

namespace hermite::output {
namespace {

Error wrong_mesh(const std::string& message) {
  return {ErrorCode::kInvalidArgument, "mesh: " + message};
}

Status check_lengths(const TriangleMesh& mesh) {
  const std::size_t count = mesh.positions_m.size();
  if (count > kMaxMeshVertices)
    return Error{ErrorCode::kTooLarge, "mesh: " + std::to_string(count) + " vertices, at most " +
                                           std::to_string(kMaxMeshVertices) + " can be written"};
  if (mesh.normals.size() != count || mesh.colors.size() != count)
    return wrong_mesh(std::to_string(count) + " positions, " + std::to_string(mesh.normals.size()) +
                      " normals and " + std::to_string(mesh.colors.size()) +
                      " colours: their numbers must be equal");
  const bool is_textured = !mesh.pages.empty();
  if (mesh.texture_coordinates.size() != (is_textured ? count : 0))
    return wrong_mesh(std::to_string(mesh.texture_coordinates.size()) +
                      " texture coordinates for " + std::to_string(count) + " vertices and " +
                      std::to_string(mesh.pages.size()) + " pages");
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
    if (what)
      return wrong_mesh("the " + std::string(what) + " of vertex " + std::to_string(i) +
                        " is not finite");
  }
  return Done{};
}

Status check_triangles(const TriangleMesh& mesh) {
  if (!mesh.is_filled.empty() && mesh.is_filled.size() != mesh.triangles.size())
    return wrong_mesh(std::to_string(mesh.is_filled.size()) + " filled marks for " +
                      std::to_string(mesh.triangles.size()) + " triangles");
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const std::uint32_t corner : mesh.triangles[i])
      if (corner >= mesh.positions_m.size())
        return wrong_mesh("triangle " + std::to_string(i) + " refers to vertex " +
                          std::to_string(corner) + " of " +
                          std::to_string(mesh.positions_m.size()));
  return Done{};
}

Status check_pages(const TriangleMesh& mesh) {
  std::uint64_t covered = 0;
  for (std::size_t i = 0; i < mesh.pages.size(); ++i) {
    const TexturePage& page = mesh.pages[i];
    const std::string name = "page " + std::to_string(i);
    if (page.first_triangle != covered)
      return wrong_mesh(name + " starts at triangle " + std::to_string(page.first_triangle) +
                        " instead of " + std::to_string(covered));
    covered += page.triangle_count;
    const ColorImage& image = page.image;
    if (image.width < 1 || image.height < 1 ||
        image.pixels.size() !=
            static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
      return wrong_mesh(name + " has no image: " + std::to_string(image.width) + "x" +
                        std::to_string(image.height) + " with " +
                        std::to_string(image.pixels.size()) + " pixels");
  }
  if (!mesh.pages.empty() && covered != mesh.triangles.size())
    return wrong_mesh("pages have " + std::to_string(covered) + " of " +
                      std::to_string(mesh.triangles.size()) + " triangles");
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
