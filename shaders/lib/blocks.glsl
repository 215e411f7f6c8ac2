// Blocks of 256 neighbouring slots, which the passes over the map skip if no view can show them. A
// block's bounds are the farthest extents of its surfels along eight directions: +x, +y, +z, -x,
// -y, -z in their submap's coordinate frame, +submap, -submap. They may be too wide but never too
// narrow, except for what a merge has just moved. Zero: the block is empty. All surfels of a block
// belong to one submap.
//
// To keep blocks small, new surfels get slots in blocks at about the same position: the view is
// divided into 4 x 4 zones, and each has its own free slots.
const uint kBlock = 256u;
const uint kNewWords = kBlock / 32u;  // of bits, one per pixel of a tile
// A tile has as many pixels as a block has slots.
const uint kTileSide = uint(HERMITE_TILE_SIDE);

// Flag in the list of blocks, whose entries are block | zone << 16: the block is not in view and is
// listed only because it is its turn.
const uint kOutOfView = 0x80000000u;
#define listed_block(visible_blocks, i) \
  uint_at(visible_blocks, uint(HERMITE_VISIBLE_HEAD_WORDS) + (i))
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
uint tile_of_pixel(Intrinsics camera, uvec2 pixel) {
  return pixel.y / kTileSide * tiles_across(camera) + pixel.x / kTileSide;
}
uvec2 pixel_in_tile(Intrinsics camera, uint tile, uint lane) {
  uint across = tiles_across(camera);
  return kTileSide * uvec2(tile % across, tile / across) +
         uvec2(lane % kTileSide, lane / kTileSide);
}

// Returns a number whose order is that of `value`; it is above zero for all finite values.
uint ordered(float value) {
  uint bits = floatBitsToUint(value);
  return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}
float unordered(uint key) {
  return uintBitsToFloat((key & 0x80000000u) != 0u ? key & 0x7fffffffu : ~key);
}

uint coordinate_of(uint direction) { return direction < 6u ? direction % 3u : 3u; }
float sign_of(uint direction) { return direction < 3u || direction == 6u ? 1.0 : -1.0; }
float reach(uint direction, vec4 position_submap) {
  return sign_of(direction) * position_submap[coordinate_of(direction)];
}

// Returns the submap of the block's surfels; HERMITE_NONE if there is none, or if the bounds
// contain several, as they may until they are updated.
uint submap_of(BlockBounds block) {
  if (block.reach[6] == 0u) return HERMITE_NONE;
  float submap = unordered(block.reach[6]);
  return submap == -unordered(block.reach[7]) ? uint(submap) : HERMITE_NONE;
}

// Returns whether new surfels of `submap` may take free slots of the block. A block out of view has
// to wait until the camera returns, so that its surfels remain neighbours.
bool has_room(uint entry, BlockBounds block, uint submap) {
  return (entry & kOutOfView) == 0u && submap_of(block) == submap;
}
