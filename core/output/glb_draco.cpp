#include "core/output/glb_draco.h"

#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <exception>
#include <memory>

#include "core/output/draco_mesh.h"

namespace hermite::output {
namespace {

constexpr int kGlbNormal_bits = 10;
// The scale is 0 to 10. A room of 317,000 triangles takes 0.53 s and 0.96 MB at 0, 0.48 s and 1.09
// MB at 3, and 0.24 s and 1.09 MB at 7.
constexpr int kGlbDracoSpeed = 0;
constexpr int kMaxPosition_bits = 24, kMinPosition_bits = 8;

int unique_id(const draco::Mesh& mesh, int id) {
  return id < 0 ? 0 : static_cast<int>(mesh.attribute(id)->unique_id());
}

Error draco_refused(const std::string& message) {
  return {ErrorCode::kUnsupported, "Draco failed to encode the mesh: " + message};
}

Result<DracoPart> encode_part(const GlbPart& part, const DracoGrid& grid, int texture_edge_px) {
  using Attribute = draco::GeometryAttribute;
  draco::Mesh mesh;
  set_triangles(mesh, part.positions.size(), part.triangles);
  const int position = add_vertex_attribute(
      mesh, {Attribute::POSITION, draco::DT_FLOAT32, 3, false}, part.positions);
  const int normal =
      add_vertex_attribute(mesh, {Attribute::NORMAL, draco::DT_FLOAT32, 3, false}, part.normals);
  int color = -1, texture = -1;
  if (!part.colors.empty())
    color = add_vertex_attribute(mesh, {Attribute::COLOR, draco::DT_UINT16, 3, true}, part.colors);
  if (!part.texture_coordinates.empty())
    texture = add_vertex_attribute(mesh, {Attribute::TEX_COORD, draco::DT_FLOAT32, 2, false},
                                   part.texture_coordinates);
  // Merges equal points, so that for Draco the surface is only cut at borders of texture charts.
  mesh.DeduplicateAttributeValues();
  mesh.DeduplicatePointIds();

  draco::Encoder encoder;
  encoder.SetSpeedOptions(kGlbDracoSpeed, kGlbDracoSpeed);
  encoder.SetTrackEncodedProperties(true);
  encoder.SetAttributeExplicitQuantization(Attribute::POSITION, grid.bits, 3, grid.corner.data(),
                                           grid.edge);
  encoder.SetAttributeQuantization(Attribute::NORMAL, kGlbNormal_bits);
  const int texture_bits = std::clamp(
      2 + static_cast<int>(std::bit_width(static_cast<unsigned>(texture_edge_px))), 8, 18);
  encoder.SetAttributeQuantization(Attribute::TEX_COORD, texture_bits);
  draco::EncoderBuffer buffer;
  if (const draco::Status status = encoder.EncodeMeshToBuffer(mesh, &buffer); !status.ok())
    return draco_refused(status.error_msg_string());
  return DracoPart{std::string(buffer.data(), buffer.size()),
                   encoder.num_encoded_points(),
                   encoder.num_encoded_faces(),
                   unique_id(mesh, position),
                   unique_id(mesh, normal),
                   unique_id(mesh, color),
                   unique_id(mesh, texture)};
}

}  // namespace

DracoGrid draco_grid_of(const std::vector<GlbPart>& parts) {
  Eigen::Vector3f low = parts.front().positions.front(), high = low;
  for (const GlbPart& part : parts)
    for (const Eigen::Vector3f& position : part.positions) {
      low = low.cwiseMin(position);
      high = high.cwiseMax(position);
    }
  DracoGrid grid{{low.x(), low.y(), low.z()}, std::max((high - low).maxCoeff(), kDracoStep_m), 0};
  const double steps =
      std::ceil(static_cast<double>(grid.edge) / static_cast<double>(kDracoStep_m));
  grid.bits = std::clamp(static_cast<int>(std::ceil(std::log2(steps + 1))), kMinPosition_bits,
                         kMaxPosition_bits);
  return grid;
}

Result<DracoPart> encode_draco_part(const GlbPart& part, const DracoGrid& grid,
                                    int texture_edge_px) {
  try {  // Draco allocates by sizes in the data and may throw
    return encode_part(part, grid, texture_edge_px);
  } catch (const std::exception& exception) {
    return draco_refused(exception.what());
  }
}

}  // namespace hermite::output
