#include "core/import/model.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "core/import/glb_model.h"
#include "core/import/model_frame.h"
#include "core/output/mean_normals.h"
#include "core/output/ply_reader.h"

namespace hermite::imports {
namespace {

constexpr double kMostScale = 1e6;
// A room spans tens of metres, or thousands if its millimetres are taken for metres; a site or a
// village spans hundreds.
constexpr double kLarge_m = 1000, kSmall_m = 0.02;

bool is_ply(std::string_view bytes) {
  return bytes.starts_with("ply\n") || bytes.starts_with("ply\r");
}
bool is_glb(std::string_view bytes) { return bytes.starts_with("glTF"); }

std::string metres(double value) {
  char text[64];
  std::snprintf(text, sizeof text,
                value < 0.1    ? "%.4f m"
                : value < 10   ? "%.2f m"
                : value < 1000 ? "%.1f m"
                               : "%.0f m",
                value);
  return text;
}

std::string three(const Eigen::Vector3f& extent_m) {
  return fmt::format("{} x {} x {}", metres(static_cast<double>(extent_m.x())),
                     metres(static_cast<double>(extent_m.y())),
                     metres(static_cast<double>(extent_m.z())));
}

Result<ImportedModel> read_ply_model(std::string_view bytes, const ImportOptions& options) {
  Result<output::PlyShape> shape =
      output::parse_ply(bytes, {true, kMaxModelVertices, kMaxModelTriangles});
  if (!shape.ok()) return shape.error();
  ImportedModel model;
  model.format = "PLY";
  model.origin = shape->origin;
  const bool is_ours = std::any_of(
      shape->comments.begin(), shape->comments.end(),
      [](const std::string& comment) { return comment.starts_with("comment Hermite"); });
  model.up = options.up.value_or(is_ours ? UpAxis::kMinusY : UpAxis::kZ);
  const auto scale = static_cast<float>(options.scale);
  for (Eigen::Vector3f& position : shape->positions)
    position = turned_from(model.up, position) * scale;
  for (Eigen::Vector3f& normal : shape->normals)
    normal = unit_or_zero(turned_from(model.up, normal));
  for (float& radius : shape->radii) radius *= scale;
  for (Eigen::Vector2f& curvature : shape->curvatures) curvature /= scale;
  if (shape->triangles.empty()) {
    model.cloud = output::cloud_of(*shape);
    return model;
  }
  Result<output::TriangleMesh> mesh = output::mesh_of(*std::move(shape));
  if (!mesh.ok()) return mesh.error();
  model.mesh = *std::move(mesh);
  return model;
}

// Curvatures and confidences are only kept if they are finite.
void make_finite(output::CloudPoint& point) {
  point.normal = unit_or_zero(point.normal);
  for (float* number :
       {&point.confidence, &point.radius_m, &point.curvature_max_per_m, &point.curvature_min_per_m})
    if (!std::isfinite(*number)) *number = 0;
}

void leave_out_bad_points(ImportedModel& model) {
  model.left_out_vertices = std::erase_if(
      model.cloud, [](const output::CloudPoint& point) { return !point.position_m.allFinite(); });
  for (output::CloudPoint& point : model.cloud) {
    make_finite(point);
    point.submap = 0;
  }
}

// Vertices keep their indices. Invalid ones move to the position of a valid one, and triangles that
// use them are removed.
void leave_out_bad_triangles(ImportedModel& model) {
  output::TriangleMesh& mesh = model.mesh;
  std::vector<bool> is_bad(mesh.positions_m.size(), false);
  for (std::size_t i = 0; i < is_bad.size(); ++i) {
    is_bad[i] = !mesh.positions_m[i].allFinite();
    model.left_out_vertices += is_bad[i] ? 1 : 0;
    mesh.normals[i] = unit_or_zero(mesh.normals[i]);
    if (!mesh.texture_coordinates.empty() && !mesh.texture_coordinates[i].allFinite())
      mesh.texture_coordinates[i].setZero();
  }
  if (model.left_out_vertices == 0) return;
  const auto is_left_out = [&is_bad](const output::TriangleCorners& corners) {
    return std::any_of(corners.begin(), corners.end(),
                       [&is_bad](std::uint32_t corner) { return is_bad[corner]; });
  };
  std::vector<output::TriangleCorners> kept;
  std::vector<std::uint8_t> is_filled;
  std::vector<output::TexturePage> pages;
  std::size_t at = 0;
  const auto keep_until = [&](std::size_t end) {
    for (; at < end; ++at) {
      if (is_left_out(mesh.triangles[at])) continue;
      kept.push_back(mesh.triangles[at]);
      if (!mesh.is_filled.empty()) is_filled.push_back(mesh.is_filled[at]);
    }
  };
  for (output::TexturePage& page : mesh.pages) {
    const std::size_t first = kept.size();
    keep_until(page.first_triangle + page.triangle_count);
    pages.push_back({std::move(page.image), static_cast<std::uint32_t>(first),
                     static_cast<std::uint32_t>(kept.size() - first)});
  }
  keep_until(mesh.triangles.size());
  model.left_out_triangles = mesh.triangles.size() - kept.size();
  mesh.pages = std::move(pages);
  mesh.triangles = std::move(kept);
  mesh.is_filled = std::move(is_filled);
  model.unchanged = false;
  const auto good = std::find(is_bad.begin(), is_bad.end(), false);
  const Eigen::Vector3f somewhere =
      good == is_bad.end() ? Eigen::Vector3f::Zero()
                           : mesh.positions_m[static_cast<std::size_t>(good - is_bad.begin())];
  for (std::size_t i = 0; i < is_bad.size(); ++i)
    if (is_bad[i]) mesh.positions_m[i] = somewhere;
}

Status check_extent(ImportedModel& model) {
  const std::size_t count = model.is_mesh() ? model.mesh.positions_m.size() : model.cloud.size();
  const auto position = [&model](std::size_t i) -> const Eigen::Vector3f& {
    return model.is_mesh() ? model.mesh.positions_m[i] : model.cloud[i].position_m;
  };
  model.low_m = model.high_m = position(0);
  for (std::size_t i = 1; i < count; ++i) {
    model.low_m = model.low_m.cwiseMin(position(i));
    model.high_m = model.high_m.cwiseMax(position(i));
  }
  const Eigen::Vector3d extent_m = model.high_m.cast<double>() - model.low_m.cast<double>();
  const double farthest_m =
      std::max(model.high_m.cwiseAbs().maxCoeff(), model.low_m.cwiseAbs().maxCoeff());
  if (extent_m.maxCoeff() <= kMaxModelExtent_m && farthest_m <= 2 * kMaxModelExtent_m)
    return Done{};
  return Error{ErrorCode::kTooLarge,
               fmt::format("{}: it spans {}, the limit is {}; for a file in millimetres use the "
                           "scale 0.001 (--scale)",
                           model.format, three(extent_m.cast<float>()), metres(kMaxModelExtent_m))};
}

}  // namespace

const char* name_of(UpAxis axis) {
  switch (axis) {
    case UpAxis::kY: return "y";
    case UpAxis::kZ: return "z";
    case UpAxis::kMinusY: return "-y";
  }
  return "z";
}

bool is_import_option(std::string_view key) { return key == "scale" || key == "up"; }

Result<ImportOptions> parse_import_options(const std::map<std::string, std::string>& texts) {
  ImportOptions options;
  for (const auto& [key, value] : texts) {
    if (key == "scale") {
      const auto [end, error] =
          std::from_chars(value.data(), value.data() + value.size(), options.scale);
      if (error != std::errc() || end != value.data() + value.size() ||
          !(options.scale > 0 && options.scale <= kMostScale))
        return Error{ErrorCode::kInvalidArgument,
                     "scale must be a number above 0 and at most 1000000"};
    } else if (key == "up") {
      for (const UpAxis axis : {UpAxis::kY, UpAxis::kZ, UpAxis::kMinusY})
        if (value == name_of(axis)) options.up = axis;
      if (!options.up) return Error{ErrorCode::kInvalidArgument, "up must be y, z or -y"};
    } else {
      return Error{
          ErrorCode::kInvalidArgument,
          fmt::format("'{}' is not an import setting; known are scale and up", key.substr(0, 40))};
    }
  }
  return options;
}

bool ImportedModel::has_normals() const {
  const auto is_known = [](const Eigen::Vector3f& normal) { return normal.squaredNorm() > 0; };
  return std::any_of(mesh.normals.begin(), mesh.normals.end(), is_known) ||
         std::any_of(cloud.begin(), cloud.end(),
                     [&](const output::CloudPoint& point) { return is_known(point.normal); });
}

bool is_model(std::string_view first_bytes) { return is_ply(first_bytes) || is_glb(first_bytes); }

Result<ImportedModel> read_model(std::string_view bytes, const ImportOptions& options) {
  if (bytes.size() > kMaxModel_bytes)
    return Error{ErrorCode::kTooLarge, fmt::format("the file has {} bytes, the limit is {}",
                                                   bytes.size(), kMaxModel_bytes)};
  if (!is_model(bytes))
    return Error{ErrorCode::kCorruptData,
                 "the file is neither PLY nor GLB: it starts with neither 'ply' nor 'glTF'"};
  Result<ImportedModel> model =
      is_ply(bytes) ? read_ply_model(bytes, options) : read_glb_model(bytes, options);
  if (!model.ok()) return model;
  if (model->is_mesh())
    leave_out_bad_triangles(*model);
  else
    leave_out_bad_points(*model);
  if (!model->is_mesh() && model->cloud.empty())
    return Error{ErrorCode::kCorruptData,
                 fmt::format("{}: there is nothing in it{}", model->format,
                             model->left_out_vertices > 0
                                 ? fmt::format(": the positions of all {} vertices are not finite",
                                               model->left_out_vertices)
                                 : "")};
  if (const Status status = check_extent(*model); !status.ok()) return status.error();
  return model;
}

Result<bool> is_model_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{ErrorCode::kNotFound, "cannot open " + path};
  char first[4] = {};
  file.read(first, sizeof first);
  return is_model({first, static_cast<std::size_t>(file.gcount())});
}

std::vector<std::string> remarks_about(const ImportedModel& model, const ImportOptions& options) {
  const Eigen::Vector3f extent_m = model.high_m - model.low_m;
  std::vector<std::string> remarks;
  remarks.push_back(fmt::format(
      "{}: {}; {} (right, down, forward); {} is up.", model.format,
      model.is_mesh() ? fmt::format("{} triangles, {} vertices{}", model.mesh.triangles.size(),
                                    model.mesh.positions_m.size(),
                                    model.mesh.pages.empty()
                                        ? ""
                                        : fmt::format(", {} image(s)", model.mesh.pages.size()))
                      : fmt::format("{} points{}", model.cloud.size(),
                                    model.has_normals() ? "" : ", without normals"),
      three(extent_m), name_of(model.up)));
  const double longest_m = static_cast<double>(extent_m.maxCoeff());
  if (longest_m > kLarge_m && options.scale == 1)
    remarks.push_back(
        fmt::format("It spans {}, taken as metres: if the file is in millimetres, import it with "
                    "the scale 0.001 (--scale 0.001).",
                    metres(longest_m)));
  if (longest_m < kSmall_m && options.scale == 1)
    remarks.push_back(
        fmt::format("It spans {}, taken as metres: if the file is in another unit, import it with "
                    "a scale (--scale 1000 for kilometres).",
                    metres(longest_m)));
  if (!model.origin.isZero()) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "It lies far off: %.0f, %.0f, %.0f was subtracted from its coordinates, so that "
                  "none loses its last digits.",
                  model.origin.x(), model.origin.y(), model.origin.z());
    remarks.emplace_back(text);
  }
  if (model.left_out_vertices > 0)
    remarks.push_back(fmt::format(
        "{} vertices are not finite and left out{}", model.left_out_vertices,
        model.left_out_triangles > 0 ? fmt::format(", with {} triangles.", model.left_out_triangles)
                                     : "."));
  return remarks;
}

}  // namespace hermite::imports
