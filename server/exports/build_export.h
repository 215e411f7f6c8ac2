// Makes the bytes of an export out of the results of a scan: the work of a thread that nobody waits for.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "server/exports/export_format.h"
#include "server/store/blobs.h"

namespace hermite {

// A cloud of twenty million points; contouring takes several times its size of memory.
inline constexpr std::uint64_t kMaxExportCloud_bytes = std::uint64_t{1} << 30;

// Called from time to time with the share that is done; false: stop.
using ExportProgress = std::function<bool(double done)>;

// Keeps the mesh that it has made last: who wants one format of a scan often wants another. One thread at a time.
class ExportBuilder {
 public:
  explicit ExportBuilder(Blobs& blobs) : blobs_(blobs) {}

  // kNotFound: the scan has no cloud, or no trajectory; kInvalidArgument: its cloud has no points, or no surface; kTooLarge: more than
  // kMaxExportCloud_bytes; kBusy: stopped; kCorruptData, kIo.
  Result<std::string> build(const ExportFormat& format, const std::string& scan_id, const ExportProgress& progress);

  void forget() { mesh_.reset(); }  // gives the memory back

 private:
  struct KnownMesh {
    std::string scan_id, cloud_version;
    TriangleMesh mesh;
  };
  Result<Cloud> read_cloud(const std::string& scan_id);
  Result<Trajectory> read_path(const std::string& scan_id);
  Status make_mesh(const std::string& scan_id, const ExportProgress& progress);

  Blobs& blobs_;
  std::optional<KnownMesh> mesh_;
};

}  // namespace hermite
