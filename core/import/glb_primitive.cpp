#include "core/import/glb_primitive.h"

#include <fmt/core.h>

#include <cmath>

#include "core/import/glb_values.h"
#include "core/output/glb.h"
#include "core/output/glb_draco_decode.h"

namespace hermite::imports {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kPoints = 0, kTriangles = 4, kStrip = 5, kFan = 6;
constexpr const char* kDraco = "KHR_draco_mesh_compression";

// Reads the KHR_texture_transform extension.
Status read_transform(const Json& transform, const std::string& where, GlbMaterial& material) {
  const auto offset = glb_numbers(transform, "offset", 2, where),
             scale = glb_numbers(transform, "scale", 2, where);
  if (!offset.ok()) return offset.error();
  if (!scale.ok()) return scale.error();
  const auto coordinates = glb_index(transform, "texCoord", where, 7);
  if (!coordinates.ok()) return coordinates.error();
  const auto rotation = transform.find("rotation");
  const double turn_rad =
      rotation == transform.end() || !rotation->is_number() ? 0 : rotation->get<double>();
  if (!std::isfinite(turn_rad)) return glb_error(where + ".rotation is not finite");
  const Eigen::Vector2d by =
      *scale ? Eigen::Vector2d((**scale)[0], (**scale)[1]) : Eigen::Vector2d::Ones();
  const Eigen::Vector2d from =
      *offset ? Eigen::Vector2d((**offset)[0], (**offset)[1]) : Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 3> matrix;
  matrix << std::cos(turn_rad) * by.x(), std::sin(turn_rad) * by.y(), from.x(),
      -std::sin(turn_rad) * by.x(), std::cos(turn_rad) * by.y(), from.y();
  material.image_from_uv = matrix.cast<float>();
  material.coordinates = coordinates->value_or(material.coordinates);
  material.is_plain = false;
  return Done{};
}

Status read_texture(const GlbDocument& document, const Json& info, const std::string& where,
                    GlbMaterial& material) {
  const auto texture = glb_index(info, "index", where),
             coordinates = glb_index(info, "texCoord", where, 7);
  if (!texture.ok()) return texture.error();
  if (!coordinates.ok()) return coordinates.error();
  if (!*texture) return glb_error(where + ".index is missing");
  material.coordinates = coordinates->value_or(0);
  material.is_plain = material.coordinates == 0;
  const Json* extensions = glb_member(info, "extensions");
  if (const Json* transform =
          extensions ? glb_member(*extensions, "KHR_texture_transform") : nullptr)
    if (const Status read =
            read_transform(*transform, where + ".extensions.KHR_texture_transform", material);
        !read.ok())
      return read;
  const Result<const Json*> object = document.object("textures", **texture);
  if (!object.ok()) return object.error();
  const auto image = glb_index(**object, "source", fmt::format("textures[{}]", **texture));
  if (!image.ok()) return image.error();
  if (!*image)
    return Error{ErrorCode::kUnsupported,
                 fmt::format("GLB: textures[{}] has no source: its image has a format that needs "
                             "an unsupported extension",
                             **texture)};
  if (const Result<const Json*> there = document.object("images", **image); !there.ok())
    return there.error();
  material.image = **image;
  return Done{};
}

bool is_text(const Json& object, const char* key, const char* text) {
  const auto member = object.find(key);
  return member != object.end() && member->is_string() &&
         member->get_ref<const std::string&>() == text;
}

// Checks the generator too, since a material of another program may have the same name by chance.
bool is_filled_material(const GlbDocument& document, const Json& material) {
  const Json* asset = glb_member(document.json(), "asset");
  return asset && is_text(*asset, "generator", output::kGlbGenerator) &&
         is_text(material, "name", output::kFilledMaterial);
}

Result<GlbMaterial> read_material(const GlbDocument& document, const Json& primitive,
                                  const std::string& where) {
  GlbMaterial material;
  const auto index = glb_index(primitive, "material", where);
  if (!index.ok()) return index.error();
  if (!*index) return material;
  const Result<const Json*> object = document.object("materials", **index);
  if (!object.ok()) return object.error();
  material.is_filled = is_filled_material(document, **object);
  const std::string name = fmt::format("materials[{}].pbrMetallicRoughness", **index);
  const Json* metallic = glb_member(**object, "pbrMetallicRoughness");
  if (!metallic) return material;
  const auto factor = glb_numbers(*metallic, "baseColorFactor", 4, name);
  if (!factor.ok()) return factor.error();
  for (int k = 0; *factor && k < 3; ++k)
    material.factor[k] = static_cast<float>((**factor)[static_cast<std::size_t>(k)]);
  if (const Json* info = glb_member(*metallic, "baseColorTexture"))
    if (const Status read = read_texture(document, *info, name + ".baseColorTexture", material);
        !read.ok())
      return read.error();
  return material;
}

template <int kComponents>
std::vector<Eigen::Matrix<float, kComponents, 1>> rows_of(const GlbValues& values) {
  std::vector<Eigen::Matrix<float, kComponents, 1>> rows(values.count());
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (int k = 0; k < kComponents; ++k)
      rows[i][k] = values.numbers[i * static_cast<std::size_t>(values.components) +
                                  static_cast<std::size_t>(k)];
  return rows;
}

// Reads optional vertex attributes and checks that each has as many entries as there are positions.
class Attributes {
 public:
  Attributes(const GlbDocument& document, const Json& attributes, std::string where)
      : document_(document), attributes_(attributes), where_(std::move(where)) {}

  template <int kComponents>
  Status read(const std::string& name, int most_components, std::uint64_t most,
              std::vector<Eigen::Matrix<float, kComponents, 1>>& rows) const {
    const auto accessor = glb_index(attributes_, name.c_str(), where_);
    if (!accessor.ok()) return accessor.error();
    if (!*accessor) return Done{};
    const Result<GlbValues> values =
        read_glb_values(document_, **accessor, kComponents, most_components, most);
    if (!values.ok()) return values.error();
    rows = rows_of<kComponents>(*values);
    return Done{};
  }

 private:
  const GlbDocument& document_;
  const Json& attributes_;
  const std::string where_;
};

std::string coordinates_name(const GlbMaterial& material) {
  return "TEXCOORD_" + std::to_string(material.coordinates);
}

Status check_same_length(const GlbPrimitive& read, const std::string& where) {
  const std::size_t count = read.positions.size();
  const auto fits = [count](std::size_t size) { return size == 0 || size == count; };
  if (!fits(read.normals.size()) || !fits(read.colors.size()) ||
      !fits(read.texture_coordinates.size()))
    return glb_error(fmt::format(
        "{} has {} positions, {} normals, {} colours and {} texture coordinates", where, count,
        read.normals.size(), read.colors.size(), read.texture_coordinates.size()));
  return Done{};
}

Status read_vertices(const GlbDocument& document, const Json& attributes, const std::string& where,
                     const GlbBudget& budget, GlbPrimitive& read) {
  const Attributes all(document, attributes, where + ".attributes");
  if (const Status status = all.read<3>("POSITION", 3, budget.vertices, read.positions);
      !status.ok())
    return status;
  const std::uint64_t most = read.positions.size();
  if (const Status status = all.read<3>("NORMAL", 3, most, read.normals); !status.ok())
    return status;
  if (const Status status = all.read<3>("COLOR_0", 4, most, read.colors); !status.ok())
    return status;
  if (!read.material.image) return Done{};
  return all.read<2>(coordinates_name(read.material), 2, most, read.texture_coordinates);
}

// Appends triangles from a list of corners, as the primitive's mode groups them.
void append_triangles(const std::vector<std::uint32_t>& corners, std::uint64_t mode,
                      std::vector<output::TriangleCorners>& triangles) {
  const std::size_t step = mode == kTriangles ? 3 : 1;
  for (std::size_t i = 0; i + 2 < corners.size(); i += step) {
    const bool turned = mode == kStrip && i % 2 == 1;
    triangles.push_back({corners[mode == kFan ? 0
                                 : turned     ? i + 1
                                              : i],
                         corners[turned ? i : i + 1], corners[i + 2]});
  }
}

// Returns the vertex of each corner, of `vertex_count` vertices.
Result<std::vector<std::uint32_t>> read_corners(const GlbDocument& document, const Json& primitive,
                                                const std::string& where, std::size_t vertex_count,
                                                const GlbBudget& budget) {
  const auto accessor = glb_index(primitive, "indices", where);
  if (!accessor.ok()) return accessor.error();
  if (*accessor) return read_glb_indices(document, **accessor, vertex_count, 3 * budget.triangles);
  std::vector<std::uint32_t> corners(vertex_count);
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<std::uint32_t>(i);
  return corners;
}

Status read_draco(const GlbDocument& document, const Json& primitive, const std::string& where,
                  const GlbBudget& budget, GlbPrimitive& read) {
  const Json& extension = primitive.at("extensions").at(kDraco);
  const auto view = glb_index(extension, "bufferView", where);
  if (!view.ok()) return view.error();
  const Json* ids = glb_member(extension, "attributes");
  const Json* attributes = glb_member(primitive, "attributes");
  if (!*view || !ids || !attributes)
    return glb_error(fmt::format("{}.{} has no bufferView or no attributes", where, kDraco));
  const auto position = glb_index(*attributes, "POSITION", where),
             corners = glb_index(primitive, "indices", where);
  if (!position.ok()) return position.error();
  if (!corners.ok()) return corners.error();
  if (!*position || !*corners) return glb_error(where + " has no POSITION or no indices");
  const Result<std::uint64_t> vertex_count =
                                  glb_element_count(document, **position, budget.vertices),
                              corner_count =
                                  glb_element_count(document, **corners, 3 * budget.triangles);
  if (!vertex_count.ok()) return vertex_count.error();
  if (!corner_count.ok()) return corner_count.error();
  output::DracoIds wanted;
  const std::string coordinates = coordinates_name(read.material);
  for (const auto& [name, id] :
       {std::pair<const char*, std::int64_t*>{"POSITION", &wanted.position},
        {"NORMAL", &wanted.normal},
        {"COLOR_0", &wanted.color},
        {coordinates.c_str(), &wanted.texture_coordinate}}) {
    const auto unique_id = glb_index(*ids, name, fmt::format("{}.{}.attributes", where, kDraco));
    if (!unique_id.ok()) return unique_id.error();
    if (*unique_id) *id = static_cast<std::int64_t>(**unique_id);
  }
  if (!read.material.image) wanted.texture_coordinate = -1;
  const Result<std::string_view> bytes = document.view(**view);
  if (!bytes.ok()) return bytes.error();
  Result<output::DracoMesh> mesh =
      output::decode_draco_mesh(*bytes, wanted, *vertex_count, *corner_count / 3);
  if (!mesh.ok()) return in_context("GLB: " + where, mesh.error());
  read.positions = std::move(mesh->positions);
  read.normals = std::move(mesh->normals);
  read.colors = std::move(mesh->colors);
  read.texture_coordinates = std::move(mesh->texture_coordinates);
  read.triangles = std::move(mesh->triangles);
  return Done{};
}

}  // namespace

Result<GlbPrimitive> read_glb_primitive(const GlbDocument& document, const Json& primitive,
                                        const std::string& where, GlbBudget& budget) {
  GlbPrimitive read;
  const auto mode = glb_index(primitive, "mode", where);
  if (!mode.ok()) return mode.error();
  const std::uint64_t kind = mode->value_or(kTriangles);
  if (kind != kPoints && kind != kTriangles && kind != kStrip && kind != kFan)
    return Error{ErrorCode::kUnsupported,
                 fmt::format("GLB: {}.mode is {}; known are points (0) and triangles (4, 5, 6)",
                             where, kind)};
  read.is_points = kind == kPoints;
  Result<GlbMaterial> material = read_material(document, primitive, where);
  if (!material.ok()) return material.error();
  read.material = *material;
  const Json* attributes = glb_member(primitive, "attributes");
  if (!attributes) return glb_error(where + ".attributes is missing");
  const Json* extensions = glb_member(primitive, "extensions");
  Status status = Done{};
  if (extensions && glb_member(*extensions, kDraco)) {
    status = read_draco(document, primitive, where, budget, read);
  } else {
    status = read_vertices(document, *attributes, where, budget, read);
    if (status.ok() && !read.is_points && !read.positions.empty()) {
      const auto corners = read_corners(document, primitive, where, read.positions.size(), budget);
      if (!corners.ok()) return corners.error();
      append_triangles(*corners, kind, read.triangles);
    }
  }
  if (!status.ok()) return status.error();
  if (read.positions.empty()) return glb_error(where + " has no POSITION");
  if (read.triangles.size() > budget.triangles)
    return Error{ErrorCode::kTooLarge,
                 fmt::format("GLB: {} has {} triangles, {} are left of the limit", where,
                             read.triangles.size(), budget.triangles)};
  if (status = check_same_length(read, where); !status.ok()) return status.error();
  for (Eigen::Vector2f& uv : read.texture_coordinates)
    uv = read.material.image_from_uv * Eigen::Vector3f(uv.x(), uv.y(), 1);
  budget.vertices -= read.positions.size();
  budget.triangles -= read.triangles.size();
  return read;
}

}  // namespace hermite::imports
