// Blocks of 256 neighbouring slots, which the passes over the map skip where no view can show them. A block's bounds are the farthest that
// its surfels reach along eight directions: +x, +y, +z, -x, -y, -z in their submap's frame, +submap, -submap. They may be too wide, never
// too narrow, but for what a merge has just moved. Zero: the block is empty. All surfels of a block are of one submap.
//
// So that blocks stay small, new surfels get slots of blocks that lie where they do: the view is divided into 4 x 4 zones, and each has its
// own free slots.
const uint kBlock = 256u;
const uint kTileSide = 16u;  // fusion goes through the image in tiles of as many pixels as a block has slots

// Of the list of blocks: block | zone << 16, and
const uint kOutOfView = 0x80000000u;  // it is not in view, only its turn has come
#define listed_block(visible_blocks, i) uint_at(visible_blocks, uint(HERMITE_VISIBLE_HEAD_WORDS) + (i))
uint block_of(uint entry) { return entry & 0xffffu; }
uint zone_of_block(uint entry) { return (entry >> 16) & 15u; }

uint zone_of_pixel(Intrinsics camera, vec2 pixel) {
  uvec2 zone = uvec2(clamp(4.0 * pixel / vec2(camera.width, camera.height), 0.0, 3.0));
  return 4u * zone.y + zone.x;
}

uint tiles_across(Intrinsics camera) { return (camera.width + kTileSide - 1u) / kTileSide; }
uint zone_of_tile(Intrinsics camera, uint tile) {
  uint across = tiles_across(camera);
  return zone_of_pixel(camera, float(kTileSide) * (vec2(tile % across, tile / across) + 0.5));
}
uvec2 pixel_in_tile(Intrinsics camera, uint tile, uint lane) {
  uint across = tiles_across(camera);
  return kTileSide * uvec2(tile % across, tile / across) + uvec2(lane % kTileSide, lane / kTileSide);
}

// Orders like the number, above zero for all that are finite.
uint ordered(float value) {
  uint bits = floatBitsToUint(value);
  return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}
float unordered(uint key) { return uintBitsToFloat((key & 0x80000000u) != 0u ? key & 0x7fffffffu : ~key); }

uint coordinate_of(uint direction) { return direction < 6u ? direction % 3u : 3u; }
float sign_of(uint direction) { return direction < 3u || direction == 6u ? 1.0 : -1.0; }
float reach(uint direction, vec4 position_submap) { return sign_of(direction) * position_submap[coordinate_of(direction)]; }

// Whose surfels does the block hold? Of several submaps or none, as its bounds may say until they are brought up to date: HERMITE_NONE.
uint submap_of(BlockBounds block) {
  if (block.reach[6] == 0u) return HERMITE_NONE;
  float submap = unordered(block.reach[6]);
  return submap == -unordered(block.reach[7]) ? uint(submap) : HERMITE_NONE;
}

// May new surfels of `submap` take free slots beside those that are there? A block elsewhere waits until the camera is there again: its
// surfels shall stay neighbours.
bool has_room(uint entry, BlockBounds block, uint submap) { return (entry & kOutOfView) == 0u && submap_of(block) == submap; }
