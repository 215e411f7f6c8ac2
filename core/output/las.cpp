#include "core/output/las.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>

#include "core/base/byte_stream.h"
#include "core/output/axes.h"
#include "core/output/cloud_check.h"

namespace hermite::output {
namespace {

constexpr double kLasStep_m = 0.0001, kLasReach_m = 200'000;
constexpr std::uint16_t kLasHeader_bytes = 375;
constexpr std::uint8_t kLasPointFormat = 7;
constexpr std::uint16_t kLasPoint_bytes = 36,
                        kLasExtra_bytes = 7 * sizeof(float) + sizeof(std::uint32_t);
// Bit of the global encoding, required by formats 6 to 10.
constexpr std::uint16_t kCoordinatesAreWkt = 1 << 4;
constexpr std::uint8_t kLasFloat = 9, kLasUnsignedLong = 5;
constexpr const char* kLasWkt =
    "LOCAL_CS[\"Hermite scan\",LOCAL_DATUM[\"first "
    "camera\",0],UNIT[\"metre\",1],AXIS[\"right\",EAST],AXIS[\"forward\",NORTH],AXIS[\"up\","
    "UP]]";

struct LasColumn {
  const char* name;
  const char* description;  // at most 31 characters
  std::uint8_t type;
};
constexpr std::array<LasColumn, 8> kLasColumns{
    {{"NormalX", "unit, towards the camera", kLasFloat},
     {"NormalY", "unit, towards the camera", kLasFloat},
     {"NormalZ", "unit, towards the camera", kLasFloat},
     {"Confidence", "weight of what was measured", kLasFloat},
     {"CurvatureMax", "1/m", kLasFloat},
     {"CurvatureMin", "1/m", kLasFloat},
     {"Radius", "m, reach of the surfel", kLasFloat},
     {"Submap", "part that moves as one", kLasUnsignedLong}}};

// Appends `text` as a field of this size, padded with zeros.
void append_field(ByteWriter& bytes, std::string_view text, std::size_t size) {
  std::string field(text.substr(0, size));
  field.resize(size, '\0');
  bytes.numbers(field.data(), size);
}

void append_record(ByteWriter& bytes, const char* user, std::uint16_t id, const char* description,
                   const std::string& content) {
  bytes.number(std::uint16_t{0});
  append_field(bytes, user, 16);
  bytes.number(id);
  bytes.number(static_cast<std::uint16_t>(content.size()));
  append_field(bytes, description, 32);
  bytes.numbers(content.data(), content.size());
}

std::string extra_bytes_descriptors() {
  ByteWriter bytes;
  for (const LasColumn& column : kLasColumns) {
    bytes.number(std::uint16_t{0});
    bytes.number(column.type);
    bytes.number(std::uint8_t{0});  // no extremes, scale or offset
    append_field(bytes, column.name, 32);
    append_field(bytes, "", 4 + 5 * 3 * 8);  // unused; no data, min, max, scale, offset
    append_field(bytes, column.description, 32);
  }
  return bytes.take();
}

std::string variable_length_records() {
  ByteWriter bytes;
  append_record(bytes, "LASF_Projection", 2112, "local, metres, z up", std::string(kLasWkt) + '\0');
  append_record(bytes, "LASF_Spec", 4, "columns behind each point", extra_bytes_descriptors());
  return bytes.take();
}

// Conversion of coordinates to integer steps, relative to the lowest corner of the box.
struct LasGrid {
  Eigen::Vector3d offset_m, low_m, high_m;  // low and high as decoded

  explicit LasGrid(const Cloud& cloud) {
    Eigen::AlignedBox3d box;
    for (const CloudPoint& point : cloud) box.extend(z_up(point.position_m).cast<double>());
    offset_m = box.min().array().floor();
    low_m = value_of(steps_of(box.min()));
    high_m = value_of(steps_of(box.max()));
    is_within_reach = (box.max() - offset_m).maxCoeff() < kLasReach_m;
  }
  Eigen::Vector3d steps_of(const Eigen::Vector3d& position_m) const {
    return ((position_m - offset_m) / kLasStep_m).array().round();
  }
  Eigen::Vector3d value_of(const Eigen::Vector3d& steps) const {
    return steps * kLasStep_m + offset_m;
  }
  bool is_within_reach = false;
};

void append_header(ByteWriter& bytes, const LasGrid& grid, std::uint64_t count,
                   std::size_t records_bytes) {
  append_field(bytes, "LASF", 4);
  bytes.number(std::uint16_t{0});  // source
  bytes.number(kCoordinatesAreWkt);
  append_field(bytes, "", 16);  // GUID
  bytes.number(std::uint8_t{1});
  bytes.number(std::uint8_t{4});
  append_field(bytes, "Hermite", 32);
  append_field(bytes, "Hermite", 32);
  bytes.number(std::uint32_t{0});  // day and year of creation
  bytes.number(kLasHeader_bytes);
  bytes.number(static_cast<std::uint32_t>(kLasHeader_bytes + records_bytes));
  bytes.number(std::uint32_t{2});  // number of records
  bytes.number(kLasPointFormat);
  bytes.number(static_cast<std::uint16_t>(kLasPoint_bytes + kLasExtra_bytes));
  append_field(bytes, "", 6 * 4);  // legacy counts, zero for this format
  for (int axis = 0; axis < 3; ++axis) bytes.number(kLasStep_m);
  for (int axis = 0; axis < 3; ++axis) bytes.number(grid.offset_m[axis]);
  for (int axis = 0; axis < 3; ++axis) {
    bytes.number(grid.high_m[axis]);
    bytes.number(grid.low_m[axis]);
  }
  append_field(bytes, "", 8 + 8 + 4);  // no waveforms, no records after the points
  bytes.number(count);
  bytes.number(count);  // first returns
  append_field(bytes, "", 14 * 8);
}

void append_point(ByteWriter& bytes, const LasGrid& grid, const CloudPoint& point) {
  const Eigen::Vector3d steps = grid.steps_of(z_up(point.position_m).cast<double>());
  for (int axis = 0; axis < 3; ++axis) bytes.number(static_cast<std::int32_t>(steps[axis]));
  bytes.number(std::uint16_t{0});                  // intensity
  bytes.number(std::uint8_t{0x11});                // return 1 of 1
  append_field(bytes, "", 1 + 1 + 1 + 2 + 2 + 8);  // flags, class, user data, angle, source, time
  for (const std::uint8_t channel : {point.color.r, point.color.g, point.color.b})
    bytes.number(static_cast<std::uint16_t>(257 * channel));
  const Eigen::Vector3f normal = z_up(point.normal);
  for (const float value : {normal.x(), normal.y(), normal.z(), point.confidence,
                            point.curvature_max_per_m, point.curvature_min_per_m, point.radius_m})
    bytes.number(value);
  bytes.number(point.submap);
}

}  // namespace

Result<std::string> format_las(const Cloud& cloud) {
  if (const Status status = check_cloud_with_points(cloud); !status.ok()) return status.error();
  const LasGrid grid(cloud);
  if (!grid.is_within_reach)
    return Error{ErrorCode::kTooLarge,
                 "LAS: points are more than 200 km apart, which its numbers do not reach in steps "
                 "of 0.1 mm"};
  const std::string records = variable_length_records();
  ByteWriter bytes;
  append_header(bytes, grid, cloud.size(), records.size());
  bytes.numbers(records.data(), records.size());
  for (const CloudPoint& point : cloud) append_point(bytes, grid, point);
  return bytes.take();
}

}  // namespace hermite::output
