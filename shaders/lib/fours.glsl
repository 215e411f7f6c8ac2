// Four neighbouring pixels of a row at once, one in each component of a vec4: shared data, such as
// the kernels of overlapping windows, is loaded and unpacked once for all of them, and the vector
// units of a CPU that substitutes for a GPU are fully used.
struct Vectors4 {
  vec4 x, y, z;
};

// Rays (x, y, 1) of the four pixels.
struct Rays4 {
  vec4 x;
  float y;
};

// `ray` belongs to the first pixel.
Rays4 rays_from(Intrinsics camera, vec3 ray) {
  return Rays4(ray.x + vec4(0.0, 1.0, 2.0, 3.0) / camera.fx, ray.y);
}
vec3 first_ray(Rays4 rays) { return vec3(rays.x.x, rays.y, 1.0); }
Vectors4 points_at(Rays4 rays, vec4 depth_m) {
  return Vectors4(depth_m * rays.x, depth_m * rays.y, depth_m);
}

Vectors4 minus(Vectors4 a, vec3 b) { return Vectors4(a.x - b.x, a.y - b.y, a.z - b.z); }
vec4 dot4(Vectors4 a, vec3 b) { return b.x * a.x + b.y * a.y + b.z * a.z; }
vec4 dot4(Vectors4 a, Rays4 rays) { return a.x * rays.x + a.y * rays.y + a.z; }
vec4 dot4(vec3 a, Rays4 rays) { return a.x * rays.x + (a.y * rays.y + a.z); }
vec4 square4(Vectors4 a) { return a.x * a.x + a.y * a.y + a.z * a.z; }
Vectors4 unit4(Vectors4 a) {
  vec4 scale = inversesqrt(max(square4(a), 1e-30));
  return Vectors4(a.x * scale, a.y * scale, a.z * scale);
}
vec3 component(Vectors4 a, int i) { return vec3(a.x[i], a.y[i], a.z[i]); }

// Returns 1 where a column, counted from the first pixel's window, lies in the window of each
// pixel, which has 2 `radius` + 1 columns; else 0.
vec4 in_windows(int column, int radius) {
  vec4 of_each = float(column) - vec4(0.0, 1.0, 2.0, 3.0);
  return step(0.0, of_each) * step(of_each, vec4(2.0 * radius));
}
