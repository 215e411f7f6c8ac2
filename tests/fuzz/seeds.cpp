// Writes the first inputs of every fuzz target, so that a short run starts behind the headers:
// fuzz_seeds FOLDER.
#include <zstd.h>

#include <cstdio>
#include <filesystem>
#include <string>

#include "core/image/depth_codec.h"
#include "core/image/depth_ranks.h"
#include "core/image/image_codec.h"
#include "core/log/frame_log_format.h"
#include "core/output/glb.h"
#include "core/output/mesh_ply.h"
#include "core/output/ply.h"
#include "core/source/open_sequence.h"
#include "proto/wire/client_message.h"
#include "proto/wire/server_message.h"
#include "tests/core/dataset/oni_bytes.h"
#include "tests/core/dataset/recording_bytes.h"
#include "tests/fuzz/seed_folder.h"
#include "tests/support/analytic_mesh.h"
#include "tests/support/archive_bytes.h"
#include "tests/support/glb_bytes.h"

namespace {

using namespace hermite;
using fuzz::SeedFolder;
namespace fs = std::filesystem;

constexpr image::ImageSize kSize{16, 12};

std::string text(std::span<const std::uint8_t> bytes) { return {bytes.begin(), bytes.end()}; }

DepthImage depth_image(unsigned kind) {
  DepthImage depth(kSize.width, kSize.height);
  for (std::size_t i = 0; i < depth.pixels.size(); ++i) {
    depth.pixels[i] = static_cast<std::uint16_t>(kind == 0    ? 0
                                                 : kind == 1  ? i * 331
                                                 : i % 5 == 0 ? 0
                                                              : 1000 + i * i % 17);
  }
  return depth;
}

ColorImage color_image() {
  ColorImage color(kSize.width, kSize.height);
  for (std::size_t i = 0; i < color.pixels.size(); ++i) {
    color.pixels[i] = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(255 - i),
                       static_cast<std::uint8_t>(i * 7)};
  }
  return color;
}

void add_depth_seeds(SeedFolder seeds) {
  const std::string size(1, static_cast<char>((kSize.height - 1) * 16 + kSize.width - 1));
  for (unsigned kind = 0; kind < 3; ++kind) {
    const DepthImage depth = depth_image(kind);
    seeds.add(std::string(1, 0) + size + text(image::encode_depth_rvl_zstd(depth)));
    seeds.add(
        std::string(1, 2) + size +
        std::string(reinterpret_cast<const char*>(depth.pixels.data()), depth.pixels.size() * 2));
  }
  // 40 MB of zeros in 1.3 kB, where RVL of less than 1 kB belongs.
  const std::string zeros(40'000'000, 0);
  std::string bomb(ZSTD_compressBound(zeros.size()), 0);
  bomb.resize(ZSTD_compress(bomb.data(), bomb.size(), zeros.data(), zeros.size(), 1));
  seeds.add(std::string(1, 0) + size + bomb);
  // RVL of {0, 0, 5, 7}, see tests/core/image/depth_codec_test.cpp, for the path that packs it.
  seeds.add(std::string("\x01\x03\x00\x40\xa1\x22", 6));
}

void add_ranks_seeds(SeedFolder seeds) {
  const std::string size(1, static_cast<char>((kSize.height - 1) * 16 + kSize.width - 1));
  for (unsigned kind = 0; kind < 3; ++kind) {
    const DepthImage depth = depth_image(kind);
    seeds.add(std::string(1, 0) + size + text(image::encode_depth_ranks(depth)));
    seeds.add(
        std::string(1, 1) + size +
        std::string(reinterpret_cast<const char*>(depth.pixels.data()), depth.pixels.size() * 2));
  }
  seeds.add(std::string(1, 0) + size + text(image::encode_depth_ranks(DepthImage(4096, 4096))));
}

void add_image_seeds(SeedFolder seeds) {
  for (const int quality : {30, 95}) seeds.add(text(*image::encode_jpeg(color_image(), quality)));
  seeds.add(text(*image::encode_png(color_image())));
  seeds.add(text(*image::encode_depth_png(depth_image(1))));
}

Camera camera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 585;
  camera.cx = 320;
  camera.cy = 240;
  return camera;
}

void add_client_seeds(SeedFolder& seeds) {
  const auto add = [&](const wire::ClientMessage& message) {
    seeds.add(std::string(1, 0) + wire::format_client_message(message));
  };
  wire::StartScan start;
  start.title = "kitchen";
  start.camera = camera();
  start.depth_codecs = {wire::DepthCodec::kRvlZstd, wire::DepthCodec::kPng16};
  start.color_codecs = {wire::ColorCodec::kJpeg};
  start.settings = {{"voxel", "5"}};
  start.expected_frames = 100;
  add(wire::Hello{0, "client 1", "secret", start});
  add(wire::Hello{0, "viewer 1", "secret", wire::ViewScan{"01arz3ndektsv4rrffq69g5fav"}});
  add(wire::Frame{1, 0.033, text(image::encode_depth_rvl_zstd(depth_image(2))),
                  text(*image::encode_jpeg(color_image(), 80))});
  add(wire::Frame{1, 0.033, text(image::encode_depth_ranks(depth_image(2))),
                  text(*image::encode_jpeg(color_image(), 80))});
  add(wire::Frame{2, 0.066, text(*image::encode_depth_png(depth_image(2))),
                  text(*image::encode_png(color_image())), Eigen::Vector3d(0.1, -9.7, 1.5)});
  add(wire::Finish{});
  add(wire::ViewerAck{100000});
  add(wire::Ping{7});
  add(wire::Hello{
      2, "client 1", "secret",
      wire::ResumeScan{"01arz3ndektsv4rrffq69g5fav", "0123456789abcdef0123456789abcdef", 12}});
  add(wire::Pause{});
  add(wire::Unpause{});
  add(wire::Discard{});
}

void add_server_seeds(SeedFolder& seeds) {
  const auto add = [&](const wire::ServerMessage& message) {
    seeds.add(std::string(1, 1) + wire::format_server_message(message));
  };
  wire::Welcome welcome;
  welcome.server = "hermite 0.1";
  welcome.scan_id = "01arz3ndektsv4rrffq69g5fav";
  welcome.max_message_bytes = 1 << 20;
  welcome.frame_credit = 4;
  welcome.color_codecs = {wire::ColorCodec::kJpeg, wire::ColorCodec::kPng};
  welcome.camera = camera();
  welcome.title = "kitchen";
  add(welcome);
  add(wire::FrameResult{});
  add(wire::Credit{12});
  add(wire::Chunk{{1, 0, -1, 2, -3}, 9, 3, "draco bytes"});
  add(wire::SubmapPoses{{{0, {}}, {1, {}}}});
  add(wire::ScanState{wire::ScanPhase::kRunning, "words", 3, 2, 1});
  add(wire::Finished{"{}", "0 0 0 0 0 0 0 1\n"});
  add(wire::ErrorMessage{"corrupt_data", "frame.depth: cut", true, 5});
  add(wire::Pong{7});
  add(wire::SnapshotEnd{});
  add(wire::Resumed{7, 20, 4});
  add(wire::NotResumed{"the scan has ended"});
  add(wire::GoAway{1000});
  add(wire::PauseRequest{true});
  add(wire::TrajectoryPart{{1, 2, 3, 4, 5, 6}, {1, 2, 3, 3, 2, 1}, {0, 1}});
}

void add_message_seeds(SeedFolder seeds) {
  add_client_seeds(seeds);
  add_server_seeds(seeds);
}

void add_recording_seeds(SeedFolder klg, SeedFolder sens) {
  const auto sequence = *source::open_sequence("synthetic:frames=2,width=64,height=64");
  for (const test::FileOptions options :
       {test::FileOptions{}, test::FileOptions{true, true}, test::FileOptions{false, true}}) {
    klg.add(text(test::klg_bytes(*sequence, options)));
    sens.add(text(test::sens_bytes(*sequence, options)));
  }
  sens.add(text(test::sens_bytes(*sequence, {.color_factor = 2})));
}

void add_oni_seeds(SeedFolder seeds) {
  const auto sequence = *source::open_sequence("synthetic:frames=2,width=64,height=64",
                                               Camera{64, 64, 60, 60, 31.5, 31.5, 1000});
  for (const char* const depth_codec : {"NONE", "16zP", "16zT"})
    for (const char* const color_codec : {"NONE", "JPEG"})
      seeds.add(text(
          test::oni_bytes(*sequence, {.depth_codec = depth_codec, .color_codec = color_codec})));
  seeds.add(text(test::oni_bytes(*sequence, {.mirrored = true, .old_positions = true})));
  seeds.add(text(test::oni_bytes(*sequence, {.has_color = false, .has_end = false})));
}

// Whole, in two segments, and records of no use in a row.
void add_log_seeds(SeedFolder seeds) {
  const auto sequence = *source::open_sequence("synthetic:frames=2,width=64,height=64");
  wire::StartScan start;
  start.title = "kitchen";
  start.camera = sequence->camera();
  start.depth_codecs = {wire::DepthCodec::kRvlZstd};
  start.color_codecs = {wire::ColorCodec::kPng};
  std::vector<std::pair<frame_log::RecordType, std::string>> records{
      {frame_log::RecordType::kTerms, "{}"},
      {frame_log::RecordType::kStart,
       wire::format_client_message(wire::Hello{0, "client 1", "", start})}};
  for (std::int64_t i = 0; i < sequence->frame_count(); ++i) {
    const dataset::RecordedFrame frame = *sequence->read(i);
    const wire::Frame message{static_cast<std::uint64_t>(i), frame.timestamp_s,
                              text(image::encode_depth_rvl_zstd(frame.depth)),
                              text(frame.color_bytes)};
    records.emplace_back(frame_log::RecordType::kFrame, wire::format_client_message(message));
  }
  records.emplace_back(frame_log::RecordType::kRefusedFrame, "");
  records.emplace_back(frame_log::RecordType::kFinish, "");
  const auto log_of = [](const auto& all, std::size_t first_in_second) {
    std::string bytes = frame_log::format_segment_header(0);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i == first_in_second)
        bytes += std::string("\xff\x00\xff\x00", 4) + frame_log::format_segment_header(1);
      bytes += frame_log::format_record_header(all[i].first, i, all[i].second) + all[i].second;
    }
    return bytes;
  };
  seeds.add(log_of(records, records.size()));
  seeds.add(log_of(records, 3));
  records.erase(records.begin() + 1);
  seeds.add(log_of(records, 1));
}

void add_archive_seeds(SeedFolder seeds) {
  const std::vector<test::ArchiveEntry> plain{
      {"a/rgb/1.png", "colour"}, {"a/", "", '5'}, {"a/depth.txt", std::string(700, 'd')}};
  const std::vector<test::ArchiveEntry> odd{
      {"l", "", '2', "/etc"}, {"../x", "x"}, {"f", "", '6'}, {"big", "x", '0', "", 1 << 30}};
  for (const auto& entries : {plain, odd}) {
    const std::string tar = test::tar_bytes(entries);
    for (const std::string& bytes :
         {tar, test::gzip_bytes(tar), test::zstd_bytes(tar), test::zip_bytes(entries)})
      seeds.add(bytes);
  }
}

void add_tus_seeds(SeedFolder seeds) {
  const std::string version = "Tus-Resumable: 1.0.0\n";
  seeds.add(version +
            "Upload-Length: 100\nUpload-Metadata: filename cm9vbS50YXI=,title,camera ZnIx,priority "
            "LTc=\n");
  seeds.add(version +
            "Upload-Defer-Length: 1\nUpload-Metadata: settings "
            "eyJtYXAuc3RhYmxlX2NvbmZpZGVuY2UiOiAiMSJ9\n");
  seeds.add(version +
            "Upload-Offset: 70\nContent-Type: application/offset+octet-stream\nUpload-Checksum: "
            "sha1 2jmj7l5rSw0yVb/vlWAYkK/YBwk=\n");
  seeds.add(version +
            "Upload-Checksum: sha256 47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU=\nUpload-Offset: "
            "9007199254740992\n");
}

// Without images: a few bytes of a JPEG may ask for more memory than a fuzzer may take. They have a
// target of their own.
void add_model_seeds(SeedFolder seeds) {
  const output::TriangleMesh sphere = test::sphere_mesh(2, 3);
  seeds.add(*output::format_mesh_glb(sphere, output::GlbCompression::kNone));
  seeds.add(output::format_mesh_ply(sphere));
  seeds.add(output::format_ply(output::Cloud(3)));
  nlohmann::json turned = test::triangle_json();
  turned["nodes"] = nlohmann::json::parse(
      R"([{"children": [1]}, {"mesh": 0, "translation": [5e5, 1, 0], "rotation": [0, 0, 0, 1], )"
      R"("scale": [-1, 1, 1]}])");
  seeds.add(test::glb_of(turned.dump(), test::triangle_binary()));
  const std::string header =
      "element vertex 3\nproperty double x\nproperty short y\nproperty float z\nelement face "
      "1\nproperty list uchar int vertex_index\n";
  seeds.add("ply\nformat ascii 1.0\n" + header + "end_header\n1 2 3\n1e9 nan 0\n0 0 1\n3 0 1 2\n");
  seeds.add("ply\nformat binary_big_endian 1.0\n" + header + "end_header\n" +
            std::string(42, '\0') + std::string("\3\0\0\0\0\0\0\0\1\0\0\0\2", 13));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: fuzz_seeds FOLDER\n");
    return 2;
  }
  add_depth_seeds(SeedFolder(fs::path(argv[1]) / "depth"));
  add_ranks_seeds(SeedFolder(fs::path(argv[1]) / "ranks"));
  add_image_seeds(SeedFolder(fs::path(argv[1]) / "image"));
  add_message_seeds(SeedFolder(fs::path(argv[1]) / "message"));
  add_recording_seeds(SeedFolder(fs::path(argv[1]) / "klg"),
                      SeedFolder(fs::path(argv[1]) / "sens"));
  add_oni_seeds(SeedFolder(fs::path(argv[1]) / "oni"));
  add_log_seeds(SeedFolder(fs::path(argv[1]) / "log"));
  add_archive_seeds(SeedFolder(fs::path(argv[1]) / "archive"));
  add_tus_seeds(SeedFolder(fs::path(argv[1]) / "tus"));
  add_model_seeds(SeedFolder(fs::path(argv[1]) / "model"));
  fuzz::add_checkpoint_seeds(SeedFolder(fs::path(argv[1]) / "checkpoint"));
  fuzz::add_mapping_seeds(SeedFolder(fs::path(argv[1]) / "mapping"));
  return 0;
}
