#include "core/synthetic/synthetic_room.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <thread>
#include <vector>

#include "core/synthetic/room_changes.h"
#include "core/synthetic/room_furniture.h"
#include "core/synthetic/room_light.h"

namespace hermite::synthetic {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kNearest_m = 0.05;
constexpr int kTile_px = 16;
// A 640x480 frame takes about 60 ms on one core, and a camera delivers one every 33 ms.
constexpr int kMaxThreads = 4;
constexpr int kNothing = -1;

// A shape as seen from one camera: all rays start at the same point, so everything but their
// direction is precomputed.
struct PlacedShape {
  const Shape* shape;
  Matrix3d shape_from_camera;  // rotation
  Vector3d origin_in_shape;    // of all rays
  Vector3d center_in_camera;
  Vector3d half_sides;
  double nearest_m;  // least depth of any part of it
};

// The first surface along a ray. Rays have z = 1 in the camera frame, so `depth_m` is both their
// parameter and the depth.
struct Hit {
  double depth_m = std::numeric_limits<double>::infinity();
  int shape = kNothing;
  int face = 0;
};

// Rows of tiles share nothing, so helper threads of this call can process them in any order;
// returns when all are done.
void for_each_row(int row_count, const std::function<void(int)>& work) {
  std::atomic<int> next{0};
  const auto take_rows = [&] {
    for (int row = next++; row < row_count; row = next++) work(row);
  };
  const int helper_count =
      std::min({static_cast<int>(std::thread::hardware_concurrency()), kMaxThreads, row_count}) - 1;
  std::vector<std::jthread> helpers;
  for (int i = 0; i < helper_count; ++i) helpers.emplace_back(take_rows);
  take_rows();
}

struct Ray {
  Vector3d direction_in_camera;
};

std::vector<Shape> turned(const Furniture& furniture, double angle_rad) {
  std::vector<Shape> shapes = furniture.shapes;
  const Matrix3d rotation = Eigen::AngleAxisd(angle_rad, Vector3d::UnitZ()).toRotationMatrix();
  for (std::size_t i = shapes.size() - furniture.turning_count; i < shapes.size(); ++i) {
    shapes[i].center = rotation * shapes[i].center;
    shapes[i].world_from_shape = rotation * shapes[i].world_from_shape;
  }
  return shapes;
}

// Turning objects are left out, so that their shading does not remain at their initial position.
RoomLight light_of_what_stands(Furniture furniture) {
  furniture.shapes.erase(
      furniture.shapes.end() - static_cast<std::ptrdiff_t>(furniture.turning_count),
      furniture.shapes.end());
  return RoomLight(furniture);
}

class Renderer {
 public:
  Renderer(const Furniture& furniture, const RoomLight& light, const Camera& camera,
           const Rigid3& world_from_camera, double turned_rad)
      : furniture_(furniture),
        shapes_(turned(furniture, turned_rad)),
        light_(light),
        camera_(camera),
        world_rotation_(world_from_camera.rotation.toRotationMatrix()),
        camera_in_world_(world_from_camera.translation) {
    const Matrix3d rotation = world_rotation_;
    for (const Shape& shape : shapes_) {
      const Matrix3d shape_from_world = shape.world_from_shape.transpose();
      const Matrix3d shape_from_camera = shape_from_world * rotation;
      const Vector3d center_in_camera =
          rotation.transpose() * (shape.center - world_from_camera.translation);
      const Vector3d half_sides = bounding_half_sides(shape);
      placed_.push_back(
          {&shape, shape_from_camera,
           shape_from_world * (world_from_camera.translation - shape.center), center_in_camera,
           half_sides, center_in_camera.z() - shape_from_camera.col(2).cwiseAbs().dot(half_sides)});
    }
    // From near to far, so that a ray can stop at the first body that begins behind the hit. The
    // room comes first: every ray meets it, and bodies extend into its walls.
    placed_.front().nearest_m = -std::numeric_limits<double>::infinity();
    std::stable_sort(
        placed_.begin(), placed_.end(),
        [](const PlacedShape& a, const PlacedShape& b) { return a.nearest_m < b.nearest_m; });
  }

  RoomView render() {
    const int columns = (camera_.width + kTile_px - 1) / kTile_px,
              rows = (camera_.height + kTile_px - 1) / kTile_px;
    hits_ = Image<Hit>(camera_.width, camera_.height);
    candidates_.resize(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    RoomView view{DepthImage(camera_.width, camera_.height),
                  ColorImage(camera_.width, camera_.height)};
    for_each_row(rows, [&](int row) { trace_row(row, columns); });
    // Uses the neighbours' hits.
    for_each_row(rows, [&](int row) { shade_row(row, columns, view); });
    return view;
  }

 private:
  struct PixelRange {
    int left, top, right, bottom;  // half open
  };

  std::vector<int> all_shapes() const {
    std::vector<int> indices(placed_.size());
    for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<int>(i);
    return indices;
  }

  Ray ray(double u, double v) const {
    return {{(u - camera_.cx) / camera_.fx, (v - camera_.cy) / camera_.fy, 1.0}};
  }

  // Returns the shapes whose bounding box is not entirely outside one side of the pyramid through
  // the range, widened by half a pixel for supersampling.
  std::vector<int> shapes_in(const PixelRange& range, const std::vector<int>& among) const {
    const Vector3d low = ray(range.left - 1.0, range.top - 1.0).direction_in_camera,
                   high = ray(range.right, range.bottom).direction_in_camera;
    const Vector3d inwards[] = {
        {1, 0, -low.x()}, {-1, 0, high.x()}, {0, 1, -low.y()}, {0, -1, high.y()}, {0, 0, 1}};
    std::vector<int> inside;
    for (const int index : among) {
      const PlacedShape& placed = placed_[static_cast<std::size_t>(index)];
      const bool seen =
          std::all_of(std::begin(inwards), std::end(inwards), [&](const Vector3d& normal) {
            const double reach =
                (placed.shape_from_camera * normal).cwiseAbs().dot(placed.half_sides);
            return normal.dot(placed.center_in_camera) + reach >= 0;
          });
      if (seen) inside.push_back(index);
    }
    return inside;
  }

  Hit trace(const Ray& ray, const std::vector<int>& among) const {
    Hit hit;
    for (const int index : among) {
      const PlacedShape& placed = placed_[static_cast<std::size_t>(index)];
      if (placed.nearest_m > hit.depth_m) break;
      const Vector3d direction = placed.shape_from_camera * ray.direction_in_camera;
      const double depth_m =
          intersect(*placed.shape, placed.origin_in_shape, direction, kNearest_m);
      if (depth_m < hit.depth_m) hit = {depth_m, index, 0};
    }
    if (hit.shape != kNothing) {
      const PlacedShape& placed = placed_[static_cast<std::size_t>(hit.shape)];
      const Vector3d point = placed.origin_in_shape +
                             hit.depth_m * (placed.shape_from_camera * ray.direction_in_camera);
      hit.face = face_of(*placed.shape, point);
    }
    return hit;
  }

  void trace_row(int row, int columns) {
    const int top = row * kTile_px, bottom = std::min(top + kTile_px, camera_.height);
    const std::vector<int> in_row = shapes_in({0, top, camera_.width, bottom}, all_shapes());
    for (int column = 0; column < columns; ++column) {
      const int left = column * kTile_px, right = std::min(left + kTile_px, camera_.width);
      auto& in_tile = candidates_[static_cast<std::size_t>(row * columns + column)];
      in_tile = shapes_in({left, top, right, bottom}, in_row);
      for (int y = top; y < bottom; ++y)
        for (int x = left; x < right; ++x) hits_.at(x, y) = trace(ray(x, y), in_tile);
    }
  }

  void shade_row(int row, int columns, RoomView& view) const {
    const int top = row * kTile_px, bottom = std::min(top + kTile_px, camera_.height);
    for (int y = top; y < bottom; ++y)
      for (int x = 0; x < camera_.width; ++x) {
        view.depth.at(x, y) = depth_units(hits_.at(x, y).depth_m);
        const auto& in_tile = candidates_[static_cast<std::size_t>(row * columns + x / kTile_px)];
        view.color.at(x, y) = srgb_from_linear(is_edge(x, y) ? supersample(x, y, in_tile)
                                                             : shade(ray(x, y), hits_.at(x, y)));
      }
  }

  std::uint16_t depth_units(double depth_m) const {
    const double units = std::round(depth_m * camera_.depth_units_per_metre);
    return units >= 1 && units <= 65535 ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
  }

  // Returns whether a pixel is beside another body or face, so that its colour is a mixture.
  bool is_edge(int x, int y) const {
    const Hit& here = hits_.at(x, y);
    const auto differs = [&](int other_x, int other_y) {
      if (other_x < 0 || other_y < 0 || other_x >= camera_.width || other_y >= camera_.height)
        return false;
      const Hit& other = hits_.at(other_x, other_y);
      return other.shape != here.shape || other.face != here.face;
    };
    return differs(x - 1, y) || differs(x + 1, y) || differs(x, y - 1) || differs(x, y + 1);
  }

  Vector3f supersample(int x, int y, const std::vector<int>& among) const {
    Vector3f sum = Vector3f::Zero();
    for (const double dy : {-0.25, 0.25})
      for (const double dx : {-0.25, 0.25}) {
        const Ray sample = ray(x + dx, y + dy);
        sum += shade(sample, trace(sample, among));
      }
    return 0.25f * sum;
  }

  Vector3f shade(const Ray& ray, const Hit& hit) const {
    if (hit.shape == kNothing) return Vector3f::Zero();
    const PlacedShape& placed = placed_[static_cast<std::size_t>(hit.shape)];
    const Shape& shape = *placed.shape;
    const Vector3d direction = placed.shape_from_camera * ray.direction_in_camera;
    const SurfacePoint surface = describe(shape, placed.origin_in_shape + hit.depth_m * direction);
    const bool is_wall = shape.kind == ShapeKind::kRoom;
    const auto material_index =
        static_cast<std::size_t>(is_wall ? room_material_of_face(surface.face) : shape.material);
    const Material& material = furniture_.materials[material_index];

    // A pixel covers a square seen at an angle; its side is taken between the short and the long
    // one.
    const double cosine = std::max(0.05, -surface.normal.dot(direction) / direction.norm());
    const double footprint_m = hit.depth_m / camera_.fx / std::sqrt(cosine);
    const auto as_float = [](double value) { return static_cast<float>(value); };
    const Vector3f albedo = texture_color(
        material, {as_float(surface.position_m.x()), as_float(surface.position_m.y()),
                   as_float(surface.half_size_m.x()), as_float(surface.half_size_m.y()),
                   as_float(footprint_m), surface.face});
    const Vector3d point_in_world =
        camera_in_world_ + hit.depth_m * (world_rotation_ * ray.direction_in_camera);
    const Vector3f lit = light_.at(point_in_world, shape.world_from_shape * surface.normal);
    return albedo.cwiseProduct(material.glow * Vector3f::Ones() + (1.0f - material.glow) * lit);
  }

  const Furniture& furniture_;
  const std::vector<Shape> shapes_;  // in their present position
  const RoomLight& light_;
  const Camera camera_;
  const Matrix3d world_rotation_;  // world_from_camera
  const Vector3d camera_in_world_;
  std::vector<PlacedShape> placed_;
  Image<Hit> hits_;
  std::vector<std::vector<int>> candidates_;  // per tile
};

}  // namespace

struct SyntheticRoom::Contents {
  Furniture furniture;
  RoomLight light;
};

SyntheticRoom::SyntheticRoom(std::unique_ptr<const Contents> contents)
    : contents_(std::move(contents)) {}

Result<SyntheticRoom> SyntheticRoom::create(RoomScene scene,
                                            const std::vector<RoomChange>& changes) {
  Furniture furniture = furnish(scene);
  if (const Status status = apply_changes(changes, furniture); !status.ok()) return status.error();
  RoomLight light = light_of_what_stands(furniture);
  return SyntheticRoom(
      std::make_unique<const Contents>(Contents{std::move(furniture), std::move(light)}));
}

SyntheticRoom::SyntheticRoom(RoomScene scene) : SyntheticRoom(or_throw(create(scene, {}))) {}
SyntheticRoom::~SyntheticRoom() = default;
SyntheticRoom::SyntheticRoom(SyntheticRoom&&) noexcept = default;

RoomView SyntheticRoom::render(const Camera& camera, const Rigid3& world_from_camera,
                               double turned_rad) const {
  return Renderer(contents_->furniture, contents_->light, camera, world_from_camera, turned_rad)
      .render();
}

double SyntheticRoom::surface_distance(const Eigen::Vector3d& point_in_world) const {
  return std::abs(signed_distance(contents_->furniture, point_in_world));
}

}  // namespace hermite::synthetic
