// Conversion of plain arrays to a Draco mesh, for the sources of core/output.
#pragma once

#include <draco/mesh/mesh.h>

#include <vector>

#include "core/output/triangle_mesh.h"

namespace hermite::output {

// Sets the faces of a mesh that has no attributes yet.
void set_triangles(draco::Mesh& mesh, std::size_t vertex_count,
                   const std::vector<TriangleCorners>& triangles);

struct VertexAttribute {
  draco::GeometryAttribute::Type type;
  draco::DataType data_type;
  int components;
  bool normalized;  // integers stand for 0 to 1
};

// Adds a per-vertex attribute and returns its id in the mesh. A row may be longer than its
// components.
template <class Row>
int add_vertex_attribute(draco::Mesh& mesh, const VertexAttribute& kind,
                         const std::vector<Row>& rows) {
  draco::GeometryAttribute attribute;
  attribute.Init(kind.type, nullptr, static_cast<std::uint8_t>(kind.components), kind.data_type,
                 kind.normalized, kind.components * draco::DataTypeLength(kind.data_type), 0);
  const int id = mesh.AddAttribute(attribute, true,
                                   static_cast<draco::AttributeValueIndex::ValueType>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
    mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(static_cast<std::uint32_t>(i)),
                                          &rows[i]);
  return id;
}

}  // namespace hermite::output
