// A cloud or a mesh of another program, from the bytes of its file into the world of a scan: x right, y down, z forward, metres.
// Pure but for is_model_file.
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

namespace hermite {

inline constexpr std::uint64_t kMaxModel_bytes = std::uint64_t{1} << 30;
inline constexpr std::uint64_t kMaxModelVertices = 20'000'000, kMaxModelTriangles = 30'000'000;
inline constexpr std::int64_t kMaxModelPixels = std::int64_t{1} << 28;  // of all images of a file together: 16 of 4096 x 4096
inline constexpr double kMaxModelExtent_m = 20'000;

enum class UpAxis { kY, kZ, kMinusY };
const char* name_of(UpAxis axis);  // "y", "z", "-y"

struct ImportOptions {
  double scale = 1;          // metres of a unit of the file
  std::optional<UpAxis> up;  // of the file; none: as its format says, else z, but -y of what this program has written
  bool operator==(const ImportOptions&) const = default;
};

// From texts: "scale" (above 0, at most 1e6) and "up" (y, z or -y). kInvalidArgument: what is wrong, or a key that is none of these.
Result<ImportOptions> parse_import_options(const std::map<std::string, std::string>& texts);
bool is_import_option(std::string_view key);

// A mesh or a cloud, the other one is empty. All numbers are finite, all colours and normals there; a point without a normal has 0.
struct ImportedModel {
  const char* format = "";  // "PLY", "GLB"
  TriangleMesh mesh;
  Cloud cloud;
  UpAxis up = UpAxis::kZ;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // what was subtracted from the file's positions, in its axes and unit
  Eigen::Vector3f low_m = Eigen::Vector3f::Zero(), high_m = Eigen::Vector3f::Zero();
  std::uint64_t left_out_vertices = 0, left_out_triangles = 0;  // with numbers that are none
  bool unchanged = false;                                       // a GLB that says the same as this: it can be shown as it is

  bool is_mesh() const { return !mesh.triangles.empty(); }
  bool has_normals() const;
};

// By the first bytes: PLY or GLB.
bool is_model(std::string_view first_bytes);

// kCorruptData, kUnsupported and kTooLarge, in words that name the field and the limit; kCorruptData also for no points at all.
Result<ImportedModel> read_model(std::string_view bytes, const ImportOptions& options);

// kNotFound.
Result<bool> is_model_file(const std::string& path);

// What a person should know of it: size, what is odd, what was changed. Whole sentences.
std::vector<std::string> words_about(const ImportedModel& model, const ImportOptions& options);

}  // namespace hermite
