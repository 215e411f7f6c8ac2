#include "core/output/glb_draco_decode.h"

#include <draco/compression/decode.h>
#include <draco/mesh/mesh.h>
#include <fmt/core.h>

#include <exception>
#include <memory>
#include <string>

namespace hermite::output {
namespace {

Error damaged_draco(const std::string& message) {
  return {ErrorCode::kCorruptData, "Draco: " + message};
}

// Reads an attribute of every vertex; succeeds without rows if the attribute is absent.
template <int kComponents>
Status read_attribute(const draco::Mesh& mesh, std::int64_t id,
                      std::vector<Eigen::Matrix<float, kComponents, 1>>& rows) {
  if (id < 0) return Done{};
  const draco::PointAttribute* attribute =
      mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
  if (!attribute) return damaged_draco("there is no attribute " + std::to_string(id));
  if (attribute->num_components() < kComponents || attribute->num_components() > 4)
    return damaged_draco(
        fmt::format("attribute {} has {} components", id, attribute->num_components()));
  rows.reserve(mesh.num_points());
  for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
    const draco::AttributeValueIndex value = attribute->mapped_index(draco::PointIndex(i));
    Eigen::Matrix<float, kComponents, 1> row;
    if (value.value() >= attribute->size() ||
        !attribute->ConvertValue<float>(value, static_cast<std::int8_t>(kComponents), row.data()))
      return damaged_draco(fmt::format("attribute {} lacks a value", id));
    rows.push_back(row);
  }
  return Done{};
}

Result<DracoMesh> decode(std::string_view bytes, const DracoIds& ids, std::uint64_t vertex_count,
                         std::uint64_t triangle_count) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  const auto type = draco::Decoder::GetEncodedGeometryType(&buffer);
  if (!type.ok() || type.value() != draco::TRIANGULAR_MESH)
    return damaged_draco("the bytes are not a mesh");
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) return damaged_draco(decoded.status().error_msg_string());
  const draco::Mesh& source = *decoded.value();
  if (source.num_points() != vertex_count || source.num_faces() != triangle_count)
    return damaged_draco(fmt::format("{} vertices and {} triangles where the glTF says {} and {}",
                                     source.num_points(), source.num_faces(), vertex_count,
                                     triangle_count));
  DracoMesh mesh;
  for (const Status& read :
       {read_attribute<3>(source, ids.position, mesh.positions),
        read_attribute<3>(source, ids.normal, mesh.normals),
        read_attribute<3>(source, ids.color, mesh.colors),
        read_attribute<2>(source, ids.texture_coordinate, mesh.texture_coordinates)})
    if (!read.ok()) return read.error();
  mesh.triangles.reserve(source.num_faces());
  for (std::uint32_t i = 0; i < source.num_faces(); ++i) {
    const draco::Mesh::Face& face = source.face(draco::FaceIndex(i));
    for (std::size_t k = 0; k < 3; ++k)
      if (face[k].value() >= source.num_points())
        return damaged_draco(fmt::format("triangle {} names a vertex that is not there", i));
    mesh.triangles.push_back({face[0].value(), face[1].value(), face[2].value()});
  }
  return mesh;
}

}  // namespace

Result<DracoMesh> decode_draco_mesh(std::string_view bytes, const DracoIds& ids,
                                    std::uint64_t vertex_count, std::uint64_t triangle_count) {
  try {  // Draco allocates by sizes in the data and may throw
    return decode(bytes, ids, vertex_count, triangle_count);
  } catch (const std::exception& exception) {
    return damaged_draco(exception.what());
  }
}

}  // namespace hermite::output
