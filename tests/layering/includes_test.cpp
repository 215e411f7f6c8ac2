// Who may include whom (the layers of the project, bottom to top), and which folder is the door to
// which library. Reads the source tree.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "tests/source_root/source_root.h"

namespace hermite {
namespace {

namespace fs = std::filesystem;

// Besides itself and the standard library. An entry is a folder or a single header.
struct Layer {
  std::string folder;
  std::vector<std::string> may_include;
};

const std::vector<Layer> kLayers{
    {"core/base", {}},
    {"core/math", {"core/base"}},
    {"core/gpu", {"core/base", "shaders/shared"}},
    {"core/frame", {"core/gpu", "core/math", "core/base", "shaders/shared"}},
    {"core/map", {"core/frame", "core/gpu", "core/math", "core/base", "shaders/shared"}},
    {"core/track",
     {"core/map", "core/frame", "core/gpu", "core/math", "core/base", "shaders/shared"}},
    {"core/mesh", {"core/output", "core/math", "core/base"}},
    {"core/texture",
     {"core/output", "core/frame/rgbd_frame.h", "core/image", "core/math", "core/base"}},
    {"core/image", {"core/base"}},
    {"core/archive", {"core/base"}},
    {"core/log", {"core/base"}},
    {"core/raw", {"core/frame/rgbd_frame.h", "core/math", "core/base"}},
    {"core/adjust", {"core/frame/rgbd_frame.h", "core/image", "core/math", "core/base"}},
    // The messages as plain values: a frame log holds them as they came.
    {"core/dataset",
     {"core/archive", "core/log", "core/raw", "proto/wire", "core/frame/rgbd_frame.h", "core/image",
      "core/math", "core/base"}},
    {"core/disturb",
     {"core/dataset", "core/frame/rgbd_frame.h", "core/image", "core/math", "core/base"}},
    {"core/synthetic",
     {"core/disturb", "core/dataset", "core/frame/rgbd_frame.h", "core/image", "core/math",
      "core/base"}},
    {"core/source", {"core/synthetic", "core/disturb", "core/dataset", "core/math", "core/base"}},
    {"core/evaluate",
     {"core/source", "core/synthetic", "core/disturb", "core/dataset",
      "core/output/triangle_mesh.h", "core/frame/rgbd_frame.h", "core/image", "core/math",
      "core/base"}},
    {"core/calibrate",
     {"core/adjust", "core/dataset", "core/frame", "core/image", "core/math", "core/base"}},
    {"core/output", {"core/image", "core/math", "core/base"}},
    {"core/measure", {"core/output", "core/dataset/trajectory.h", "core/math", "core/base"}},
    {"core/compare",
     {"core/measure", "core/mesh/surfel_grid.h", "core/output", "core/dataset/trajectory.h",
      "core/math", "core/base"}},
    {"core/plan",
     {"core/measure", "core/output/cloud.h", "core/dataset/trajectory.h",
      "core/dataset/trajectory_formats.h", "core/math", "core/base"}},
    {"core/import", {"core/output", "core/image", "core/math", "core/base"}},
    {"core/export",
     {"core/output", "core/plan", "core/texture", "core/dataset", "core/archive",
      "core/frame/rectify.h", "core/frame/rgbd_frame.h", "core/image", "core/math", "core/base"}},
    {"core/edit", {"core/mesh/mesh_parts.h", "core/output", "core/base"}},
    {"core/thumbnail", {"core/output", "core/image", "core/math", "core/base"}},
    {"core/digest", {"core/base"}},
    // Only plain headers of what needs more than Vulkan, Eigen and fmt: hermite_bench links this
    // and nothing else.
    {"core/pipeline",
     {"core/adjust/mapping.h", "core/adjust/adjust_options.h", "core/calibrate/camera_watch.h",
      "core/calibrate/camera_numbers.h", "core/dataset/trajectory.h",
      "core/dataset/camera_velocity.h", "core/output/cloud.h", "core/track", "core/map",
      "core/frame", "core/gpu", "core/math", "core/base"}},
    {"core/report",
     {"core/pipeline", "core/dataset/camera_file.h", "core/evaluate", "core/digest", "core/math",
      "core/base"}},
    {"core/run",
     {"core/report", "core/pipeline", "core/calibrate/camera_watch.h", "core/dataset/trajectory.h",
      "core/output", "core/thumbnail", "core/base"}},
    {"tests/bench/program", {"core/pipeline", "core/raw", "core/gpu", "core/base"}},
    {"tests/bench/codecs",
     {"core/source", "core/dataset", "core/frame/rgbd_frame.h", "core/image", "core/math",
      "core/base"}},
    {"proto/wire", {"core/frame/rgbd_frame.h", "core/image", "core/math", "core/base"}},
    // Rooms of the service, from the ground up: each knows those above it here, as far as it says.
    {"server/net", {"core/base"}},
    {"server/database", {"core/digest", "core/base"}},
    {"server/store", {"core/output", "core/digest", "core/math", "core/base", "server/database"}},
    {"server/s3",
     {"core/output/ply.h", "core/digest", "core/base", "server/net/base64.h", "server/store"}},
    {"server/client",
     {"core/dataset", "core/archive", "core/digest", "core/frame/rgbd_frame.h", "core/image",
      "core/math", "core/base", "proto/wire", "server/net"}},
    {"server/capture",
     {"core/source", "core/dataset", "core/evaluate", "core/log", "core/frame/rgbd_frame.h",
      "core/frame/rectify.h", "core/output/ply.h", "core/image", "core/math", "core/base",
      "proto/wire", "server/client"}},
    {"server/exports",
     {"core/compare", "core/edit", "core/export", "core/import", "core/measure", "core/mesh",
      "core/texture", "core/thumbnail", "core/report/reported_up.h", "core/output",
      "core/dataset/sequence.h", "core/dataset/trajectory.h", "core/archive/zip.h", "core/math",
      "core/base", "server/store"}},
    {"server/operations", {"core/base", "server/store"}},
    {"server/disk", {"core/output", "core/log", "core/base", "server/operations", "server/store"}},
    {"server/access",
     {"core/digest", "core/base", "proto/wire", "server/operations", "server/store"}},
    {"server/scan",
     {"core/run", "core/report/reported_up.h", "core/report/tracking_file.h", "core/pipeline",
      "core/adjust/mapping.h", "core/adjust/mapping_counts.h", "core/dataset", "core/mesh",
      "core/output", "core/digest", "core/log", "core/image", "core/math", "core/base",
      "proto/wire", "server/access", "server/disk", "server/operations", "server/store"}},
    {"server/uploads", {"core/base", "server/access", "server/disk", "server/net", "server/store"}},
    {"server/jobs",
     {"core/import", "core/output", "core/thumbnail", "core/dataset", "core/archive", "core/log",
      "core/math", "core/base", "proto/wire", "server/client", "server/exports", "server/uploads",
      "server/scan", "server/disk", "server/operations", "server/store"}},
    {"server/slurm",
     {"core/log/frame_log_reader.h", "core/output/ply.h", "core/dataset", "core/base",
      "server/jobs", "server/scan", "server/disk", "server/store"}},
    {"server/routes",
     {"core/edit", "core/measure", "core/output/ply_points.h", "core/pipeline/options.h",
      "core/pipeline/doctor.h", "core/thumbnail/thumbnail.h", "core/base", "proto/wire",
      "server/jobs", "server/exports", "server/uploads", "server/scan", "server/access",
      "server/disk", "server/operations", "server/store"}},
    {"server/connections",
     {"core/base", "proto/wire", "server/routes", "server/scan", "server/access",
      "server/operations", "server/net", "server/store"}},
    {"server/service",
     {"core/import", "core/dataset", "core/archive", "core/base", "proto/wire",
      "server/connections", "server/routes", "server/slurm", "server/jobs", "server/uploads",
      "server/scan", "server/exports", "server/access", "server/disk", "server/operations",
      "server/net", "server/s3", "server/store", "server/database"}},
    {"core/examples",
     {"core/run", "core/mesh", "core/output", "core/source", "core/dataset", "core/base"}},
    {"server",
     {"core/pipeline",
      "core/report",
      "core/run",
      "core/adjust/mapping.h",
      "core/adjust/mapping_counts.h",
      "core/calibrate",
      "core/measure",
      "core/compare",
      "core/mesh",
      "core/edit",
      "core/texture",
      "core/thumbnail/up_direction.h",
      "core/export",
      "core/import",
      "core/output",
      "core/source",
      "core/disturb/depth_noise.h",
      "core/dataset",
      "core/archive",
      "core/digest",
      "core/evaluate",
      "core/frame/rgbd_frame.h",
      "core/frame/rectify.h",
      "core/log",
      "core/raw",
      "core/image",
      "core/math",
      "core/base",
      "proto/wire"}},
    {"shaders", {"core/gpu/shader_interface.h"}},
};

// What an include starts with, and the only folders or files that may have it.
struct Door {
  std::string include;
  std::vector<std::string> folders;
};

const std::vector<Door>& doors() {
  static const std::vector<Door> table{
      {"vulkan/", {"core/gpu"}},
      {"spirv_cross/", {"shaders"}},
      {"toml++/", {"server/service"}},
      {"ceres/", {"core/adjust"}},
      {"opencv2/", {"core/adjust"}},
      {"turbojpeg.h", {"core/image"}},
      {"jpeglib.h", {"core/image"}},
      {"spng.h", {"core/image"}},
      {"zstd.h", {"core/image"}},
      {"zlib.h", {"core/image"}},
      {"archive.h", {"core/archive"}},
      {"archive_entry.h", {"core/archive"}},
      {"draco/", {"core/output"}},
      {"nanoflann.hpp", {"core/output"}},
      {"meshoptimizer.h", {"core/mesh"}},
      {"SQLiteCpp/", {"server/database", "server/store/backup.cpp"}},
      {"libpq-fe.h", {"server/database/postgres_connection.cpp"}},
      {"sqlite3.h", {"server/database", "server/store/backup.cpp"}},
      {"curl/", {"server/s3"}},
      {"libfreenect", {"server/capture/kinect.cpp"}},
      {"OpenNI.h", {"server/capture/openni.cpp"}},
      {"librealsense2/", {"server/capture/realsense.cpp"}},
      {"boost/beast",
       {"server/net/transport.h", "server/connections/websocket.h",
        "server/connections/websocket.cpp", "server/connections/websocket_stream.h",
        "server/connections/websocket_stream.cpp", "server/connections/http_connection.cpp",
        "server/connections/answer_writer.cpp", "server/connections/body_reader.h",
        "server/connections/body_reader.cpp", "server/client/client_socket.h",
        "server/client/client_socket.cpp", "server/client/connection.cpp",
        "server/client/load_viewers.cpp"}},
      {"boost/graph", {"core/plan/minimum_cut.cpp"}},
      {"boost/", {"server", "core/plan/minimum_cut.cpp"}},
      {"prometheus/", {"server/operations/metrics.cpp"}},
      {"google/protobuf", {"proto/wire"}},
      {"scan.pb.h", {"proto/wire"}},
  };
  return table;
}

// Is `path` that file, or inside that folder?
bool lies_in(const std::string& path, const std::string& place) {
  return path == place || path.starts_with(place + "/");
}

bool lies_in_any(const std::string& path, const std::vector<std::string>& places) {
  for (const std::string& place : places)
    if (lies_in(path, place)) return true;
  return false;
}

// Of `path`: what stands between quotes or angle brackets, empty when the line is no include.
std::string included(const std::string& line, char& bracket) {
  const std::size_t word = line.find_first_not_of(" \t");
  if (word == std::string::npos || line.compare(word, 8, "#include") != 0) return {};
  const std::size_t open = line.find_first_of("\"<", word);
  if (open == std::string::npos) return {};
  bracket = line[open];
  const std::size_t close = line.find(bracket == '<' ? '>' : '"', open + 1);
  return close == std::string::npos ? std::string() : line.substr(open + 1, close - open - 1);
}

// A message about one include of a file, empty when it is allowed.
std::string objection(const std::string& path, const std::string& include, char bracket) {
  for (const Door& door : doors()) {
    if (!include.starts_with(door.include)) continue;
    return lies_in_any(path, door.folders) ? "" : "is not the door to " + door.include;
  }
  if (bracket == '<') return {};
  for (const Layer& layer : kLayers)
    if (lies_in(path, layer.folder))
      return lies_in(include, layer.folder) || lies_in_any(include, layer.may_include)
                 ? ""
                 : layer.folder + " may not include this";
  return "lies in no layer: add its folder to the table of this test";
}

// "path:line: #include ...: why" for each offence.
std::vector<std::string> offences(const std::string& path, std::istream& text) {
  std::vector<std::string> found;
  int number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    char bracket = 0;
    const std::string include = included(line, bracket);
    if (include.empty()) continue;
    const std::string why = objection(path, include, bracket);
    if (!why.empty())
      found.push_back(path + ":" + std::to_string(number) + ": " + line + ": " + why);
  }
  return found;
}

std::vector<std::string> offences(const std::string& path, const std::string& text) {
  std::istringstream stream(text);
  return offences(path, stream);
}

bool is_source(const fs::path& path) {
  const std::string extension = path.extension();
  return extension == ".h" || extension == ".cpp" || extension == ".comp" || extension == ".glsl";
}

TEST(Includes, KeepToTheLayers) {
  const fs::path root = hermite::test::source_root();
  int file_count = 0;
  for (const char* top : {"tests/bench/program", "core", "proto", "server", "shaders"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / top)) {
      if (!entry.is_regular_file() || !is_source(entry.path())) continue;
      ++file_count;
      std::ifstream text(entry.path());
      for (const std::string& offence :
           offences(fs::relative(entry.path(), root).generic_string(), text))
        ADD_FAILURE() << offence;
    }
  EXPECT_GT(file_count, 100) << "is this the source tree? " << root;
}

TEST(Includes, OffencesAreSeen) {
  const auto count = [](const std::string& path, const std::string& text) {
    return offences(path, text).size();
  };
  EXPECT_EQ(count("core/base/a.h", "#include \"core/math/camera.h\"\n"), 1u);
  EXPECT_EQ(count("core/math/a.cpp", "#include <vector>\n#include \"core/base/result.h\"\n"), 0u);
  EXPECT_EQ(count("core/dataset/a.cpp",
                  "#include \"core/frame/rgbd_frame.h\"\n#include \"core/frame/preprocess.h\"\n"),
            1u);
  EXPECT_EQ(count("core/map/a.cpp", "#include \"core/track/odometry.h\"\n"), 1u);
  EXPECT_EQ(count("server/scan/a.cpp", "  #include \"core/gpu/device.h\"\n"), 1u);
  EXPECT_EQ(count("server/service/a.cpp",
                  "#include <boost/beast/http.hpp>\n#include <boost/asio/post.hpp>\n"),
            1u);
  EXPECT_EQ(count("core/map/a.h", "#include <vulkan/vulkan.h>\n"), 1u);
  EXPECT_EQ(count("core/mapper/a.h", "#include \"core/base/check.h\"\n"), 1u)
      << "a folder that nobody has placed";
  EXPECT_EQ(count("core/frame/a.h", "#include \"preprocess.h\"\n"), 1u) << "not from the root";
  EXPECT_EQ(count("shaders/frame/a.comp",
                  "#include \"shaders/lib/geometry.glsl\"\n#include \"core/base/check.h\"\n"),
            1u);
  EXPECT_EQ(offences("core/base/a.h", "\n#include <zstd.h>\n").at(0),
            "core/base/a.h:2: #include <zstd.h>: is not the door to zstd.h");
}

}  // namespace
}  // namespace hermite
