// The pixel a surfel falls into and the bits of its depth (positive floats order like their bits). Shared by both halves of the index
// map, which must agree to the last bit: hence `precise`. Needs the bindings of index_depth.comp.
uint listed_slot() { return block_of(listed_block(visible_blocks, gl_WorkGroupID.x)) * kBlock + gl_LocalInvocationID.x; }

bool index_cell(uint slot, out uint cell, out uint bits) {
  cell = 0u;
  bits = 0u;
  // Slots in the list beyond those in use are free.
  vec4 surfel = vec4_at(position_confidence, slot);
  if (surfel.w <= 0.0 || surfel.w < p.min_confidence) return false;
  Transform t = transform_at(camera_from_submap, surfel_submap(attributes_at(attributes, slot)));
  precise vec3 point = transform_point(t, surfel.xyz);
  if (point.z <= 0.05 || point.z > p.depth_max_m) return false;
  precise vec2 uv = project(p.camera, point);
  ivec2 pixel = ivec2(floor(uv + 0.5));
  if (!inside(p.camera, pixel)) return false;
  cell = uint(pixel.y) * p.camera.width + uint(pixel.x);
  bits = floatBitsToUint(point.z);
  return true;
}
