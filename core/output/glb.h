// Binary glTF 2.0, which everything opens: metres, y up (axes.h). Numbers of vertices are turned, no node is: programs that read nothing
// but the geometry see it upright too.
//
// The light of the room is in the colours already, so materials ask not to be lit (KHR_materials_unlit), and are as rough as can be and no
// metal where a program lights them anyway. They have one side. Without a texture, COLOR_0 is linear, as glTF has it. With one there is no
// COLOR_0, which would be multiplied with it; each page is a primitive with a material and a JPEG of its own.
// Triangles across filled holes are a primitive of their own, whose material is named kFilledMaterial: what reads the file again can tell
// them. Deterministic, pure.
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/output/cloud.h"
#include "core/output/triangle_mesh.h"

namespace hermite {

inline constexpr const char *kGlbGenerator = "Hermite", *kFilledMaterial = "filled";

enum class GlbCompression {
  kNone,
  kDraco,  // KHR_draco_mesh_compression, which the reader must know: positions are within 0.1 mm, other values see glb_draco.cpp
};

// kInvalidArgument: check_mesh_with_triangles. kTooLarge: more than 4 GiB. kUnsupported: Draco's words.
Result<std::string> format_mesh_glb(const TriangleMesh& mesh, GlbCompression compression);

// Points (mode 0) with normals and linear colours. kInvalidArgument: a position or normal that is not finite, no point. kTooLarge.
Result<std::string> format_cloud_glb(const Cloud& cloud);

}  // namespace hermite
