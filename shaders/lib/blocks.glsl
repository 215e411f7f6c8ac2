// Blocks of 256 neighbouring slots, which the passes over the map skip where no view can show them. A block's bounds are the farthest that
// its surfels reach along eight directions: +x, +y, +z, -x, -y, -z in their submap's frame, +submap, -submap. They may be too wide, never
// too narrow, but for what a merge has just moved. Zero: the block is empty.
const uint kBlock = 256u;
const uint kOutOfView = 0x80000000u;  // of an entry in the list: only its turn has come

// Orders like the number, above zero for all that are finite.
uint ordered(float value) {
  uint bits = floatBitsToUint(value);
  return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}
float unordered(uint key) { return uintBitsToFloat((key & 0x80000000u) != 0u ? key & 0x7fffffffu : ~key); }

float reach(uint direction, vec4 position_submap) {
  float value = position_submap[direction < 6u ? direction % 3u : 3u];
  return (direction < 3u || direction == 6u) ? value : -value;
}
