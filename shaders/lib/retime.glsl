// Frames whose rows were taken at different times (core/frame/retime.h): depth in sensor units, two
// pixels per word, and the camera's motion to the time of each row.

uint units_at(uint index) { return (uint_at(units, index >> 1) >> (16u * (index & 1u))) & 0xffffu; }

// Returns the direction in which the camera sees a pixel's point when it takes the row around
// `row_px`; with depth, the point itself. A pixel without depth is infinitely far.
vec3 seen_in_row(Transform row_from_stamp, vec3 ray, float depth_m) {
  return depth_m > 0.0 ? transform_point(row_from_stamp, depth_m * ray)
                       : rotate(row_from_stamp, ray);
}

// The transform of the row that is nearest to a position in the image.
uint row_at(float y_px) { return uint(y_px + 0.5); }
