// Reads a point cloud or mesh of another program into the world frame of a scan: x right, y down, z
// forward, metres. All functions are pure except is_model_file.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/output/cloud.h"
#include "core/output/triangle_mesh.h"

namespace hermite::imports {

inline constexpr std::uint64_t kMaxModel_bytes = std::uint64_t{1} << 30;
inline constexpr std::uint64_t kMaxModelVertices = 20'000'000, kMaxModelTriangles = 30'000'000;
inline constexpr std::int64_t kMaxModelPixels =
    std::int64_t{1}  // Of all images of a file together: as many as in 16 images of 4096 x 4096.
    << 28;
inline constexpr double kMaxModelExtent_m = 20'000;

enum class UpAxis { kY, kZ, kMinusY };
const char* name_of(UpAxis axis);  // "y", "z", "-y"

struct ImportOptions {
  double scale = 1;  // metres per unit of the file
  // The up axis of the file; nullopt: the one of its format, otherwise z, and -y for files of this
  // program.
  std::optional<UpAxis> up;
  bool operator==(const ImportOptions&) const = default;
};

// Parses "scale" (above 0, at most 1e6) and "up" (y, z or -y). Returns kInvalidArgument for an
// invalid value or an unknown key.
Result<ImportOptions> parse_import_options(const std::map<std::string, std::string>& texts);
bool is_import_option(std::string_view key);

// A mesh or a cloud; the other one is empty. All numbers are finite, and every vertex has a colour
// and a normal, which is 0 if unknown.
struct ImportedModel {
  const char* format = "";  // "PLY", "GLB"
  output::TriangleMesh mesh;
  output::Cloud cloud;
  UpAxis up = UpAxis::kZ;
  // Subtracted from the positions of the file, in its axes and unit.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3f low_m = Eigen::Vector3f::Zero(), high_m = Eigen::Vector3f::Zero();
  // Dropped because of values that are not finite.
  std::uint64_t left_out_vertices = 0, left_out_triangles = 0;
  // The file is a GLB with the same content and can be used as it is.
  bool unchanged = false;

  bool is_mesh() const { return !mesh.triangles.empty(); }
  bool has_normals() const;
};

// Returns whether the file begins like a PLY or GLB.
bool is_model(std::string_view first_bytes);

// Returns kCorruptData, kUnsupported or kTooLarge, with messages that name the field and the limit.
// A file without points is kCorruptData.
Result<ImportedModel> read_model(std::string_view bytes, const ImportOptions& options);

// Returns kNotFound when the file cannot be opened.
Result<bool> is_model_file(const std::string& path);

// Returns sentences for the user: its size, what looks suspicious, and what was changed.
std::vector<std::string> remarks_about(const ImportedModel& model, const ImportOptions& options);

}  // namespace hermite::imports
