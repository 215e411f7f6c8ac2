// Which export is meant: a format of the table and, of a mesh, what is done to it before. Has one name, in requests and as a file. Plain
// value.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "server/exports/export_offer.h"

namespace hermite {

inline constexpr std::int64_t kLeastSimplify_um = 10, kMostSimplify_um = 100'000, kMostMeshTriangles = 100'000'000, kMostFill_mm = 10'000;
// Of one scan, of exports with options.
inline constexpr std::size_t kMaxShapedExports = 16;

// How a mesh is finished. Whole numbers, so that what is the same has the same name.
struct MeshShape {
  std::int64_t simplify_um = 0;  // how far the surface may move for fewer triangles; 0: not at all
  std::int64_t triangles = 0;    // with that: not fewer than these
  std::int64_t fill_mm = 0;      // holes up to that width are filled; 0: none
  bool closes = false;           // all that is open

  bool operator==(const MeshShape&) const = default;
  bool is_plain() const { return *this == MeshShape(); }
};

struct ExportSpec {
  const ExportOffer* offer = nullptr;  // of the table
  MeshShape shape;                     // of formats of a mesh alone

  std::string name() const;  // "glb", "glb_s1000_t50000_f100_c"
  std::string file() const;  // "mesh.glb", "mesh_s1000_t50000_f100_c.glb"
};

// kInvalidArgument, naming the field as requests have it and its limits; or that the format is none that a mesh is made as.
Status check_shape(const ExportOffer& offer, const MeshShape& shape);

// Of a name as name() makes it. kNotFound: there is no such format, in words that say which there are; kInvalidArgument as check_shape.
Result<ExportSpec> export_spec_named(std::string_view name);

// Of a file as file() names it, of an export with options. offer is null: it is none.
ExportSpec shaped_export_of_file(std::string_view file);

}  // namespace hermite
