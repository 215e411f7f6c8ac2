#include "core/import/glb_model.h"

#include <fmt/core.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "core/image/image_codec.h"
#include "core/import/glb_primitive.h"
#include "core/import/glb_scene.h"
#include "core/import/model_frame.h"
#include "core/output/mean_normals.h"
#include "core/output/ply_reader.h"

namespace hermite::imports {
namespace {

using Json = nlohmann::json;

constexpr int kSwatch_px = 8;  // side length; a JPEG mixes colours within blocks of this size
constexpr std::size_t kMostSwatches = image::kMaxImageEdge_px / kSwatch_px;

// The sRGB transfer function (IEC 61966-2-1).
std::uint8_t srgb_of(float linear) {
  const double value =
      std::isfinite(linear) ? std::clamp(static_cast<double>(linear), 0.0, 1.0) : 0.0;
  return static_cast<std::uint8_t>(std::lround(
      255 * (value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1 / 2.4) - 0.055)));
}

Rgb8 srgb_of(const Eigen::Vector3f& linear) {
  return {srgb_of(linear.x()), srgb_of(linear.y()), srgb_of(linear.z())};
}

std::span<const std::uint8_t> as_span(std::string_view bytes) {
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

Result<std::string_view> image_bytes(const GlbDocument& document, std::uint64_t index) {
  const Result<const Json*> image = document.object("images", index);
  if (!image.ok()) return image.error();
  const std::string where = fmt::format("images[{}]", index);
  const auto view = glb_index(**image, "bufferView", where);
  if (!view.ok()) return view.error();
  if (!*view) return glb_error(where + ".bufferView is missing");
  return document.view(**view);
}

// A browser decodes all images of a file, whether they are used or not, so all of them count.
Status check_images(const GlbDocument& document) {
  std::int64_t pixels = 0;
  for (std::size_t i = 0; i < document.count("images"); ++i) {
    const Result<std::string_view> bytes = image_bytes(document, i);
    if (!bytes.ok()) return bytes.error();
    const Result<image::ImageSize> size = image::read_image_size(as_span(*bytes));
    if (!size.ok())
      return in_context(fmt::format("GLB: images[{}], which may be JPEG or PNG", i), size.error());
    pixels += std::int64_t{size->width} * size->height;
    if (pixels > kMaxModelPixels)
      return Error{ErrorCode::kTooLarge,
                   fmt::format("GLB: images up to images[{}] have {} pixels, the limit is {}", i,
                               pixels, kMaxModelPixels)};
  }
  return Done{};
}

Result<ColorImage> read_image(const GlbDocument& document, std::uint64_t index) {
  const Result<std::string_view> bytes = image_bytes(document, index);
  if (!bytes.ok()) return bytes.error();
  const Result<image::ImageSize> size = image::read_image_size(as_span(*bytes));
  if (!size.ok()) return size.error();
  Result<ColorImage> image = image::decode_color(as_span(*bytes), *size);
  return image.ok() ? std::move(image)
                    : in_context(fmt::format("GLB: images[{}]", index), image.error());
}

class SceneReader {
 public:
  SceneReader(const GlbDocument& document, const ImportOptions& options, ImportedModel& model)
      : document_(document), options_(options), model_(model) {}

  Status read() {
    const Result<std::vector<GlbPlacement>> placements = glb_placements(document_);
    if (!placements.ok()) return placements.error();
    for (const GlbPlacement& placement : *placements)
      if (const Status added = add(placement); !added.ok()) return added;
    return Done{};
  }
  std::vector<GlbPrimitive>& primitives() { return primitives_; }
  bool is_plain() const { return is_plain_; }

 private:
  Status add(const GlbPlacement& placement) {
    const Result<const Json*> mesh = document_.object("meshes", placement.mesh);
    if (!mesh.ok()) return mesh.error();
    const std::string where = fmt::format("meshes[{}].primitives", placement.mesh);
    const auto list = (*mesh)->find("primitives");
    if (list == (*mesh)->end() || !list->is_array() || list->empty())
      return glb_error(where + " is not an array with entries");
    for (std::size_t i = 0; i < list->size(); ++i) {
      // Every primitive that is read costs time, even one without a valid vertex.
      if (primitives_.size() >= kMaxGlbObjects)
        return Error{ErrorCode::kTooLarge,
                     fmt::format("GLB: more than {} primitives in the scene", kMaxGlbObjects)};
      const std::string name = fmt::format("{}[{}]", where, i);
      if (!(*list)[i].is_object()) return glb_error(name + " is not an object");
      Result<GlbPrimitive> primitive = read_glb_primitive(document_, (*list)[i], name, budget_);
      if (!primitive.ok()) return primitive.error();
      is_plain_ = is_plain_ && primitive->material.is_plain && !primitive->is_points;
      place(placement.world_from_mesh, *primitive);
      primitives_.push_back(*std::move(primitive));
    }
    return Done{};
  }

  void place(const Eigen::Matrix4d& world_from_mesh, GlbPrimitive& primitive) {
    const Eigen::Matrix3d linear = world_from_mesh.topLeftCorner<3, 3>();
    const Eigen::Vector3d shift = world_from_mesh.topRightCorner<3, 1>();
    for (Eigen::Vector3f& position : primitive.positions) {
      const Eigen::Vector3d in_file = linear * position.cast<double>() + shift;
      if (!origin_known_ && in_file.allFinite()) {
        model_.origin = output::origin_near(in_file);
        origin_known_ = true;
      }
      position = turned_from(model_.up, ((in_file - model_.origin) * options_.scale).cast<float>());
    }
    // Normals transform by the inverse transpose; a singular matrix has none, and the surface has
    // no thickness and no normal.
    const double volume = linear.determinant();
    const Eigen::Matrix3d turn = std::abs(volume) > 0
                                     ? Eigen::Matrix3d(linear.inverse().transpose())
                                     : Eigen::Matrix3d::Identity();
    for (Eigen::Vector3f& normal : primitive.normals)
      normal = unit_or_zero(
          turned_from(model_.up, (turn * normal.cast<double>()).normalized().cast<float>()));
    if (volume < 0)
      for (output::TriangleCorners& corners : primitive.triangles)
        std::swap(corners[1], corners[2]);
  }

  const GlbDocument& document_;
  const ImportOptions& options_;
  ImportedModel& model_;
  std::vector<GlbPrimitive> primitives_;
  GlbBudget budget_{kMaxModelVertices, kMaxModelTriangles};
  bool origin_known_ = false, is_plain_ = true;
};

Rgb8 vertex_color(const GlbPrimitive& primitive, std::size_t i) {
  const Eigen::Vector3f& factor = primitive.material.factor;
  return srgb_of(primitive.colors.empty()
                     ? factor
                     : Eigen::Vector3f(factor.cwiseProduct(primitive.colors[i])));
}

// Returns the texel at `uv` of an image that repeats in both directions.
Rgb8 texel(const ColorImage& image, const Eigen::Vector2f& uv) {
  const auto along = [](float coordinate, int edge) {
    const double share =
        std::isfinite(coordinate) ? coordinate - std::floor(static_cast<double>(coordinate)) : 0;
    return std::clamp(static_cast<int>(share * edge), 0, edge - 1);
  };
  const int x = along(uv.x(), image.width), y = along(uv.y(), image.height);
  return image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                      static_cast<std::size_t>(x)];
}

ColorImage swatches_of(const std::vector<Rgb8>& colors) {
  ColorImage image(static_cast<int>(colors.size()) * kSwatch_px, kSwatch_px);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] =
        colors[i % static_cast<std::size_t>(image.width) / static_cast<std::size_t>(kSwatch_px)];
  return image;
}

// Joins primitives into one mesh, grouped by their image. In a model with images, primitives
// without one get a swatch of their material's colour.
class MeshAssembly {
 public:
  MeshAssembly(const GlbDocument& document, std::vector<GlbPrimitive>& primitives,
               output::TriangleMesh& mesh)
      : document_(document), primitives_(primitives), mesh_(mesh) {}

  Status assemble() {
    std::map<std::uint64_t, std::vector<std::size_t>> of_image;
    std::vector<std::size_t> plain;
    for (std::size_t i = 0; i < primitives_.size(); ++i) {
      if (primitives_[i].triangles.empty()) continue;
      if (has_image(primitives_[i]))
        of_image[*primitives_[i].material.image].push_back(i);
      else
        plain.push_back(i);
    }
    for (const auto& [image, which] : of_image) {
      Result<ColorImage> pixels = read_image(document_, image);
      if (!pixels.ok()) return pixels.error();
      begin_page();
      for (const std::size_t i : which)
        add(primitives_[i],
            [&](std::size_t k) { return texel(*pixels, primitives_[i].texture_coordinates[k]); });
      end_page(*std::move(pixels));
    }
    return of_image.empty() || plain.empty() ? add_plain(plain) : add_swatches(plain);
  }

 private:
  static bool has_image(const GlbPrimitive& primitive) {
    return primitive.material.image && !primitive.texture_coordinates.empty();
  }

  Status add_plain(const std::vector<std::size_t>& which) {
    for (const std::size_t i : which) {
      primitives_[i].texture_coordinates.clear();
      add(primitives_[i], [&](std::size_t k) { return vertex_color(primitives_[i], k); });
    }
    return Done{};
  }

  Status add_swatches(const std::vector<std::size_t>& which) {
    std::vector<Rgb8> colors;
    begin_page();
    std::vector<std::size_t> swatch;
    for (const std::size_t i : which) {
      const Rgb8 color = srgb_of(primitives_[i].material.factor);
      const auto found = std::find(colors.begin(), colors.end(), color);
      swatch.push_back(static_cast<std::size_t>(found - colors.begin()));
      if (found == colors.end()) colors.push_back(color);
      if (colors.size() > kMostSwatches)
        return Error{ErrorCode::kTooLarge,
                     fmt::format("GLB: more than {} material colours in a model with images",
                                 kMostSwatches)};
    }
    for (std::size_t k = 0; k < which.size(); ++k) {
      GlbPrimitive& primitive = primitives_[which[k]];
      const float middle =
          (static_cast<float>(swatch[k]) + 0.5f) / static_cast<float>(colors.size());
      primitive.texture_coordinates.assign(primitive.positions.size(),
                                           Eigen::Vector2f(middle, 0.5f));
      add(primitive, [&](std::size_t i) { return vertex_color(primitive, i); });
    }
    end_page(swatches_of(colors));
    return Done{};
  }

  void begin_page() { page_begin_ = mesh_.triangles.size(); }
  void end_page(ColorImage image) {
    mesh_.pages.push_back({std::move(image), static_cast<std::uint32_t>(page_begin_),
                           static_cast<std::uint32_t>(mesh_.triangles.size() - page_begin_)});
  }

  template <class ColorOf>
  void add(GlbPrimitive& primitive, ColorOf color_of) {
    const auto first = static_cast<std::uint32_t>(mesh_.positions_m.size());
    if (primitive.normals.empty())
      primitive.normals = output::mean_normals(primitive.positions, primitive.triangles);
    for (std::size_t i = 0; i < primitive.positions.size(); ++i)
      mesh_.colors.push_back(color_of(i));
    const auto append = [](auto& to, const auto& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    append(mesh_.positions_m, primitive.positions);
    append(mesh_.normals, primitive.normals);
    append(mesh_.texture_coordinates, primitive.texture_coordinates);
    for (const auto& [a, b, c] : primitive.triangles)
      mesh_.triangles.push_back({first + a, first + b, first + c});
    // Filled marks are kept from the first filled primitive on; a mesh without any has an empty
    // list.
    if (primitive.material.is_filled || !mesh_.is_filled.empty()) {
      mesh_.is_filled.resize(mesh_.triangles.size() - primitive.triangles.size(), 0);
      mesh_.is_filled.resize(mesh_.triangles.size(), primitive.material.is_filled ? 1 : 0);
    }
    primitive = {};  // frees its memory early
  }

  const GlbDocument& document_;
  std::vector<GlbPrimitive>& primitives_;
  output::TriangleMesh& mesh_;
  std::size_t page_begin_ = 0;
};

output::Cloud points_of(const std::vector<GlbPrimitive>& primitives) {
  output::Cloud cloud;
  for (const GlbPrimitive& primitive : primitives)
    for (std::size_t i = 0; i < primitive.positions.size(); ++i) {
      output::CloudPoint point;
      point.position_m = primitive.positions[i];
      if (!primitive.normals.empty()) point.normal = primitive.normals[i];
      point.color = vertex_color(primitive, i);
      cloud.push_back(point);
    }
  return cloud;
}

}  // namespace

Result<ImportedModel> read_glb_model(std::string_view bytes, const ImportOptions& options) {
  const Result<GlbDocument> document = GlbDocument::parse(bytes);
  if (!document.ok()) return document.error();
  if (const Status images = check_images(*document); !images.ok()) return images.error();
  ImportedModel model;
  model.format = "GLB";
  model.up = options.up.value_or(UpAxis::kY);
  SceneReader scene(*document, options, model);
  if (const Status read = scene.read(); !read.ok()) return read.error();
  std::vector<GlbPrimitive>& primitives = scene.primitives();
  const bool has_triangles =
      std::any_of(primitives.begin(), primitives.end(),
                  [](const GlbPrimitive& one) { return !one.triangles.empty(); });
  if (!has_triangles) {
    model.cloud = points_of(primitives);
    return model;
  }
  if (const Status assembled = MeshAssembly(*document, primitives, model.mesh).assemble();
      !assembled.ok())
    return assembled.error();
  model.unchanged =
      scene.is_plain() && options.scale == 1 && model.up == UpAxis::kY && model.origin.isZero();
  return model;
}

}  // namespace hermite::imports
