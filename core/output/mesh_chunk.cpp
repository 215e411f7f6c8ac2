#include "core/output/mesh_chunk.h"

#include <draco/compression/encode.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <exception>
#include <utility>

#include "core/output/draco_mesh.h"

namespace hermite::output {
namespace {

constexpr int kChunkNormal_bits = 8;
constexpr int kMostChunk_bits = 20;
constexpr int kMeshChunkSpeed = 7;

Error mesh_chunk_refused(const std::string& message) {
  return {ErrorCode::kUnsupported, "Draco failed to encode a piece of the mesh: " + message};
}

// The grid corner next below all positions, and the edge length that covers them.
struct StepGrid {
  std::array<float, 3> corner_m{};
  float edge_m = 0;
  int bits = 1;

  StepGrid(const TriangleMesh& mesh, double step_m) {
    Eigen::Vector3f low = mesh.positions_m.front(), high = low;
    for (const Eigen::Vector3f& position_m : mesh.positions_m) {
      low = low.cwiseMin(position_m);
      high = high.cwiseMax(position_m);
    }
    const Eigen::Vector3d first = (low.cast<double>() / step_m).array().floor(),
                          last = (high.cast<double>() / step_m).array().ceil();
    for (std::size_t axis = 0; axis < 3; ++axis)
      corner_m[axis] = static_cast<float>(first[static_cast<Eigen::Index>(axis)] * step_m);
    const double steps = std::min((last - first).maxCoeff(), std::ldexp(1.0, kMostChunk_bits));
    bits = std::max(1, static_cast<int>(std::bit_width(static_cast<std::uint32_t>(steps))));
    edge_m = static_cast<float>((std::ldexp(1.0, bits) - 1) * step_m);
  }
};

Result<EncodedMesh> encode(const TriangleMesh& mesh, const StepGrid& grid) {
  using Attribute = draco::GeometryAttribute;
  draco::Mesh draco_mesh;
  set_triangles(draco_mesh, mesh.positions_m.size(), mesh.triangles);
  add_vertex_attribute(draco_mesh, {Attribute::POSITION, draco::DT_FLOAT32, 3, false},
                       mesh.positions_m);
  add_vertex_attribute(draco_mesh, {Attribute::NORMAL, draco::DT_FLOAT32, 3, false}, mesh.normals);
  add_vertex_attribute(draco_mesh, {Attribute::COLOR, draco::DT_UINT8, 3, true}, mesh.colors);
  if (!mesh.confidence_eighths.empty())
    add_vertex_attribute(draco_mesh, {Attribute::GENERIC, draco::DT_UINT8, 1, false},
                         mesh.confidence_eighths);
  draco::Encoder encoder;
  encoder.SetSpeedOptions(kMeshChunkSpeed, kMeshChunkSpeed);
  encoder.SetTrackEncodedProperties(true);
  encoder.SetAttributeExplicitQuantization(Attribute::POSITION, grid.bits, 3, grid.corner_m.data(),
                                           grid.edge_m);
  encoder.SetAttributeQuantization(Attribute::NORMAL, kChunkNormal_bits);
  draco::EncoderBuffer buffer;
  if (const draco::Status status = encoder.EncodeMeshToBuffer(draco_mesh, &buffer); !status.ok())
    return mesh_chunk_refused(status.error_msg_string());
  return EncodedMesh{static_cast<std::uint32_t>(encoder.num_encoded_faces()),
                     std::string(buffer.data(), buffer.size())};
}

}  // namespace

Result<EncodedMesh> encode_mesh_chunk(const TriangleMesh& mesh, double cell_m) {
  if (mesh.triangles.empty()) return EncodedMesh{};
  if (mesh.triangles.size() > kMaxTrianglesPerChunk)
    return Error{ErrorCode::kTooLarge,
                 fmt::format("a piece of the mesh has {} triangles, the limit is {}",
                             mesh.triangles.size(), kMaxTrianglesPerChunk)};
  const StepGrid grid(mesh, kMeshChunkStep_cells * cell_m);
  if (grid.bits > kMostChunk_bits)
    return Error{ErrorCode::kTooLarge, "a piece of the mesh is larger than its grid"};
  try {  // Draco allocates by sizes in the data and may throw
    return encode(mesh, grid);
  } catch (const std::exception& exception) {
    return mesh_chunk_refused(exception.what());
  }
}

}  // namespace hermite::output
