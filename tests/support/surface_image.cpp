#include "tests/support/surface_image.h"

#include <algorithm>

#include "tests/support/packing.h"

namespace hermite::test {

SurfaceImage::SurfaceImage(const shared::Intrinsics& intrinsics)
    : camera(intrinsics),
      depth_m(static_cast<std::size_t>(camera.width) * camera.height),
      normals(depth_m.size(), Eigen::Vector3d::Zero()),
      curvatures(depth_m.size(), Eigen::Vector2d::Zero()),
      weight(depth_m.size()),
      intensity(depth_m.size(), -1.0f) {}

Eigen::Vector3d SurfaceImage::ray(int x, int y) const {
  return {(x - static_cast<double>(camera.cx)) / static_cast<double>(camera.fx),
          (y - static_cast<double>(camera.cy)) / static_cast<double>(camera.fy), 1};
}

std::vector<Eigen::Vector3d> unpack_normals(const std::vector<shared::uint>& packed) {
  std::vector<Eigen::Vector3d> normals(packed.size());
  std::transform(packed.begin(), packed.end(), normals.begin(), unpack_normal);
  return normals;
}

SurfaceImage download(const frame::SurfaceLevel& level) {
  SurfaceImage image(level.camera);
  const std::vector<shared::SurfacePoint> points = level.points.download();
  for (std::size_t i = 0; i < points.size(); ++i) {
    image.depth_m[i] = points[i].depth_m;
    image.normals[i] = unpack_normal(points[i].normal);
    image.curvatures[i] = unpack_halves(points[i].curvatures);
    image.weight[i] = points[i].weight;
  }
  image.intensity = level.intensity.download();
  return image;
}

void upload(const SurfaceImage& image, frame::SurfaceLevel& level) {
  std::vector<shared::SurfacePoint> points(image.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d& kappa = image.curvatures[i];
    points[i] = {image.depth_m[i], pack_normal(image.normals[i]), pack_halves(kappa.x(), kappa.y()),
                 image.weight[i]};
  }
  level.points.upload(points);
  level.intensity.upload(image.intensity);
}

shared::Intrinsics intrinsics_of_level(const Camera& camera, int level) {
  shared::Intrinsics intrinsics = frame::intrinsics_of(camera);
  for (int i = 0; i < level; ++i) intrinsics = frame::coarser(intrinsics);
  return intrinsics;
}

frame::FrameMaps make_frame_maps(gpu::Device& device, const Camera& camera) {
  const std::size_t pixels =
      static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  frame::FrameMaps maps{
      .raw_depth_m = {device, pixels, "test"},
      .filtered_depth_m = {device, pixels, "test"},
      .kernels = {device, frame::kernel_image_size(frame::intrinsics_of(camera)), "test"},
      .color = {device, pixels, "test"},
      .surface = frame::make_surface_pyramid(device, frame::intrinsics_of(camera), "test"),
      .images = {}};
  for (std::size_t level = 0; level < maps.images.size(); ++level)
    maps.images[level] = {device, maps.surface.levels[level].intensity.count(), "test"};
  return maps;
}

void upload(const std::vector<map::Surfel>& surfels, map::SurfelStore& store) {
  store.reserve(static_cast<std::uint32_t>(surfels.size()));
  std::vector<shared::vec4> positions;
  std::vector<shared::SurfelAttributes> attributes;
  std::vector<shared::uvec2> times;
  std::vector<shared::uint> free;
  for (const map::Surfel& s : surfels) {
    if (s.confidence <= 0) free.push_back(static_cast<shared::uint>(positions.size()));
    positions.push_back({s.position_in_submap_m.x(), s.position_in_submap_m.y(),
                         s.position_in_submap_m.z(), s.confidence});
    attributes.push_back({pack_unit(s.normal_in_submap.cast<double>()),
                          float_to_half(static_cast<double>(s.radius_m)) | (s.submap << 16),
                          map::pack_attributes(s).color,
                          pack_halves(static_cast<double>(s.curvature_max_per_m),
                                      static_cast<double>(s.curvature_min_per_m))});
    times.push_back({s.created_frame, s.observed_frame});
  }
  positions.resize(store.capacity());  // nothing of what was there before
  store.positions.upload(positions);
  store.attributes.upload(attributes);
  store.times.upload(times);
  store.free_slots.upload(free);
  std::vector<shared::BlockBounds> bounds = map::bounds_of(surfels);
  bounds.resize(store.bounds.count());
  store.bounds.upload(bounds);
  const auto slot_count = static_cast<shared::uint>(surfels.size()),
             free_count = static_cast<shared::uint>(free.size());
  shared::MapState state{slot_count, free_count, 0, 0, slot_count - free_count, 0, {}, {}};
  state.zones[0].free_count = free_count;
  store.state.upload(std::vector<shared::MapState>{state});
}

std::vector<std::vector<std::uint32_t>> free_slots_by_zone(const map::SurfelStore& store) {
  std::vector<std::vector<std::uint32_t>> zones;
  for (const shared::ZoneSlots& zone : store.state.mapped()[0].zones)
    zones.push_back(store.free_slots.download(zone.free_count, zone.free_begin));
  return zones;
}

std::vector<std::uint32_t> free_slots(const map::SurfelStore& store) {
  return store.free_slots.download(store.state.mapped()[0].free_count);
}

}  // namespace hermite::test
