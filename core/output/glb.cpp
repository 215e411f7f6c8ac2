#include "core/output/glb.h"

#include <algorithm>

#include "core/output/axes.h"
#include "core/output/cloud_check.h"
#include "core/output/glb_container.h"
#include "core/output/glb_draco.h"
#include "core/output/glb_parts.h"
#include "core/output/mesh_check.h"
#include "core/output/texture_jpeg.h"

namespace hermite::output {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kPointsMode = 0, kTrianglesMode = 4;
// Interpolates between the page's pixels without mipmaps, which would mix charts that are only
// neighbours in the page.
constexpr int kLinearFilter = 9729, kClampToEdge = 33071, kRepeat = 10497;

void begin_glb(GlbContainer& container, const char* name) {
  container.json["asset"] = {{"version", "2.0"}, {"generator", kGlbGenerator}};
  container.json["scene"] = 0;
  container.json["scenes"] = Json::array({Json{{"nodes", {0}}}});
  container.json["nodes"] = Json::array({Json{{"mesh", 0}, {"name", name}}});
  container.json["extensionsUsed"] = {"KHR_materials_unlit"};
}

Json glb_material(const char* name) {
  return {{"name", name},
          {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}},
          {"extensions", {{"KHR_materials_unlit", Json::object()}}},
          {"doubleSided", false}};
}

GltfAccessor position_accessor(const std::vector<Eigen::Vector3f>& positions) {
  Eigen::Vector3f low = positions.front(), high = low;
  for (const Eigen::Vector3f& position : positions) {
    low = low.cwiseMin(position);
    high = high.cwiseMax(position);
  }
  return {
      GltfComponent::kFloat,         "VEC3", positions.size(), false, {low.x(), low.y(), low.z()},
      {high.x(), high.y(), high.z()}};
}

GltfAccessor float_accessor(const char* type, std::size_t count) {
  return {GltfComponent::kFloat, type, count};
}
GltfAccessor color_accessor(const char* type, std::size_t count) {
  return {GltfComponent::kUint16, type, count, true};
}
GltfAccessor index_accessor(std::size_t count) { return {GltfComponent::kUint32, "SCALAR", count}; }

Json plain_primitive(const GlbPart& part, GlbContainer& container) {
  constexpr GltfTarget kVertices = GltfTarget::kVertices;
  const std::size_t count = part.positions.size();
  Json attributes;
  attributes["POSITION"] = container.add_accessor(position_accessor(part.positions),
                                                  as_bytes(part.positions), kVertices);
  attributes["NORMAL"] =
      container.add_accessor(float_accessor("VEC3", count), as_bytes(part.normals), kVertices);
  if (!part.colors.empty())
    attributes["COLOR_0"] =
        container.add_accessor(color_accessor("VEC4", count), as_bytes(part.colors), kVertices);
  if (!part.texture_coordinates.empty())
    attributes["TEXCOORD_0"] = container.add_accessor(
        float_accessor("VEC2", count), as_bytes(part.texture_coordinates), kVertices);
  const std::size_t indices = container.add_accessor(
      index_accessor(3 * part.triangles.size()), as_bytes(part.triangles), GltfTarget::kIndices);
  return {{"attributes", attributes}, {"indices", indices}, {"mode", kTrianglesMode}};
}

Result<Json> draco_primitive(const GlbPart& part, const DracoGrid& grid, int texture_edge_px,
                             GlbContainer& container) {
  const Result<DracoPart> encoded = encode_draco_part(part, grid, texture_edge_px);
  if (!encoded.ok()) return encoded.error();
  const std::size_t count = encoded->vertex_count;
  GltfAccessor position = position_accessor(part.positions);
  position.count = count;
  Json attributes, ids;
  attributes["POSITION"] = container.add_accessor_without_bytes(position);
  attributes["NORMAL"] = container.add_accessor_without_bytes(float_accessor("VEC3", count));
  ids = {{"POSITION", encoded->position}, {"NORMAL", encoded->normal}};
  if (!part.colors.empty()) {
    attributes["COLOR_0"] = container.add_accessor_without_bytes(color_accessor("VEC3", count));
    ids["COLOR_0"] = encoded->color;
  }
  if (!part.texture_coordinates.empty()) {
    attributes["TEXCOORD_0"] = container.add_accessor_without_bytes(float_accessor("VEC2", count));
    ids["TEXCOORD_0"] = encoded->texture_coordinate;
  }
  const std::size_t indices =
      container.add_accessor_without_bytes(index_accessor(3 * encoded->triangle_count));
  const Json extension{{"bufferView", container.add_view(encoded->bytes)}, {"attributes", ids}};
  return Json{{"attributes", attributes},
              {"indices", indices},
              {"mode", kTrianglesMode},
              {"extensions", {{"KHR_draco_mesh_compression", extension}}}};
}

// Pages of an atlas are clamped at their border; an image that repeats, such as a pattern of
// bricks, is wrapped.
int wrap_of(const TriangleMesh& mesh) {
  const auto is_inside = [](const Eigen::Vector2f& uv) {
    return uv.minCoeff() >= -1e-3f && uv.maxCoeff() <= 1.001f;
  };
  return std::all_of(mesh.texture_coordinates.begin(), mesh.texture_coordinates.end(), is_inside)
             ? kClampToEdge
             : kRepeat;
}

// Adds a material per part, and an image and a texture per page that has a part.
Status add_materials(const TriangleMesh& mesh, const std::vector<GlbPart>& parts,
                     GlbContainer& container) {
  Json& json = container.json;
  std::size_t textures = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Json material = glb_material(parts[i].is_filled   ? kFilledMaterial
                                 : mesh.pages.empty() ? "vertex colours"
                                                      : "texture");
    if (!mesh.pages.empty()) {
      if (i == 0 || parts[i].page != parts[i - 1].page) {
        const Result<std::string> jpeg = texture_jpeg(mesh.pages[parts[i].page].image);
        if (!jpeg.ok())
          return in_context("texture page " + std::to_string(parts[i].page), jpeg.error());
        json["images"].push_back(
            {{"mimeType", "image/jpeg"}, {"bufferView", container.add_view(*jpeg)}});
        json["textures"].push_back({{"sampler", 0}, {"source", textures++}});
      }
      material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", textures - 1}};
    }
    json["materials"].push_back(material);
  }
  if (mesh.pages.empty()) return Done{};
  const int wrap = wrap_of(mesh);
  json["samplers"] = Json::array({Json{{"magFilter", kLinearFilter},
                                       {"minFilter", kLinearFilter},
                                       {"wrapS", wrap},
                                       {"wrapT", wrap}}});
  return Done{};
}

int longer_edge_px(const TriangleMesh& mesh, const GlbPart& part) {
  return mesh.pages.empty()
             ? 0
             : std::max(mesh.pages[part.page].image.width, mesh.pages[part.page].image.height);
}

}  // namespace

Result<std::string> format_mesh_glb(const TriangleMesh& mesh, GlbCompression compression) {
  if (const Status status = check_mesh_with_triangles(mesh); !status.ok()) return status.error();
  const std::vector<GlbPart> parts = glb_parts(mesh);
  const DracoGrid grid = draco_grid_of(parts);
  GlbContainer container;
  begin_glb(container, "scan");
  if (compression == GlbCompression::kDraco) {
    container.json["extensionsUsed"].push_back("KHR_draco_mesh_compression");
    container.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  }
  Json primitives = Json::array();
  for (const GlbPart& part : parts) {
    Result<Json> primitive =
        compression == GlbCompression::kDraco
            ? draco_primitive(part, grid, longer_edge_px(mesh, part), container)
            : Result<Json>(plain_primitive(part, container));
    if (!primitive.ok()) return primitive.error();
    (*primitive)["material"] = primitives.size();
    primitives.push_back(*std::move(primitive));
  }
  container.json["meshes"] = Json::array({Json{{"primitives", primitives}}});
  if (const Status status = add_materials(mesh, parts, container); !status.ok())
    return status.error();
  return container.finish();
}

Result<std::string> format_cloud_glb(const Cloud& cloud) {
  if (const Status status = check_cloud_with_points(cloud); !status.ok()) return status.error();
  std::vector<Eigen::Vector3f> positions, normals;
  std::vector<LinearRgba16> colors;
  for (const CloudPoint& point : cloud) {
    positions.push_back(y_up(point.position_m));
    normals.push_back(unit_normal_y_up(point.normal));
    colors.push_back(linear_color(point.color));
  }
  GlbContainer container;
  begin_glb(container, "cloud");
  Json attributes;
  attributes["POSITION"] = container.add_accessor(position_accessor(positions), as_bytes(positions),
                                                  GltfTarget::kVertices);
  attributes["NORMAL"] = container.add_accessor(float_accessor("VEC3", cloud.size()),
                                                as_bytes(normals), GltfTarget::kVertices);
  attributes["COLOR_0"] = container.add_accessor(color_accessor("VEC4", cloud.size()),
                                                 as_bytes(colors), GltfTarget::kVertices);
  const Json primitive{{"attributes", attributes}, {"material", 0}, {"mode", kPointsMode}};
  container.json["meshes"] = Json::array({Json{{"primitives", Json::array({primitive})}}});
  container.json["materials"] = Json::array({glb_material("vertex colours")});
  return container.finish();
}

}  // namespace hermite::output
