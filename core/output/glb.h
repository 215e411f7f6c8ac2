// Binary glTF 2.0 in metres with y up (axes.h). The coordinates themselves are converted, without a
// node transform, so programs that read only the geometry also show it upright.
//
// Colours already contain the light of the room, so materials are unlit (KHR_materials_unlit), and
// fully rough and non-metallic for programs that light them anyway. They are single-sided. Without
// a texture, COLOR_0 is linear, as glTF requires. With a texture there is no COLOR_0, which would
// be multiplied with it; each page is a primitive with its own material and JPEG. Triangles across
// filled holes are a separate primitive, whose material is named kFilledMaterial, so that a reader
// can recognise them. Deterministic, pure.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/output/cloud.h"
#include "core/output/triangle_mesh.h"

namespace hermite::output {

inline constexpr const char *kGlbGenerator = "Hermite", *kFilledMaterial = "filled";

enum class GlbCompression {
  kNone,
  // KHR_draco_mesh_compression, which the reader must support; positions are within 0.1 mm, see
  // glb_draco.cpp for other values.
  kDraco,
};

// Returns kInvalidArgument as check_mesh_with_triangles, kTooLarge above 4 GiB, and kUnsupported
// with Draco's message when Draco fails.
Result<std::string> format_mesh_glb(const TriangleMesh& mesh, GlbCompression compression);

// Writes points (mode 0) with normals and linear colours. Returns kInvalidArgument for a position
// or normal that is not finite or an empty cloud, and kTooLarge above 4 GiB.
Result<std::string> format_cloud_glb(const Cloud& cloud);

}  // namespace hermite::output
