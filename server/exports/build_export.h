// Makes the bytes of an export from the results of a scan, on a background thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "core/base/result.h"
#include "core/dataset/sequence.h"
#include "core/edit/scan_edits.h"
#include "core/export/formats.h"
#include "core/output/cloud.h"
#include "core/output/named_file.h"
#include "core/output/triangle_mesh.h"
#include "server/exports/export_spec.h"
#include "server/exports/result_sources.h"
#include "server/store/blobs.h"

namespace hermite::server {

// The largest cloud that is meshed: about ten million surfels, which takes less than 2 GiB
// (tests/bench/README.md).
inline constexpr std::uint64_t kMaxMeshedCloud_bytes = std::uint64_t{480} << 20;
// The memory that meshing takes, as a multiple of the size of the surfels' file. With less free
// memory no mesh is made.
inline constexpr double kMeshMemory = 4.4;

// Called from time to time with the fraction that is done, by any thread. Returns false to stop.
using BuildProgress = std::function<bool(double done)>;

// The recorded frames of a scan that has ended. kNotFound: they were removed. Callable from any
// thread.
using OpenFrames =
    std::function<Result<std::unique_ptr<dataset::Sequence>>(const std::string& scan_id)>;

// Keeps the last mesh, since several formats of one scan are often requested together. One thread
// at a time.
class ExportBuilder {
 public:
  ExportBuilder(Blobs& blobs, OpenFrames open_frames, FreeMemory free_memory = free_memory_bytes)
      : blobs_(blobs), open_frames_(std::move(open_frames)), free_memory_(std::move(free_memory)) {}

  // All but comparisons are made of what the edits of the scan leave (scan_edits_file.h). Meshes
  // have a texture if the format supports one and the scan still has its frames, otherwise the
  // colours of the surfels. kNotFound: the scan has no cloud or no trajectory; kInvalidArgument:
  // its cloud has no points or makes no surface, or its edits leave nothing; kTooLarge: more than
  // kMaxExportCloud_bytes, or for meshes more than kMaxMeshedCloud_bytes or the free memory; kBusy:
  // stopped; kCorruptData, kIo. For a comparison as build_comparison.h. Returns the files of the
  // export, the last of which is spec.file().
  Result<output::NamedFiles> build(const ExportSpec& spec, const std::string& scan_id,
                                   const BuildProgress& progress);

  void forget() { mesh_.reset(); }  // frees the memory of the mesh

 private:
  struct KnownMesh {
    std::string scan_id, source_version;
    output::TriangleMesh mesh;
    MeshShape shape;
    std::vector<edit::ScanEdit> edits;
    // The mesh with `edits`, then with `shape`; none if there is neither.
    std::optional<output::TriangleMesh> shaped;
    // The same, once a format has needed it and there were frames.
    std::optional<output::TriangleMesh> textured;
    const output::TriangleMesh& finished() const { return shaped ? *shaped : mesh; }
    const output::TriangleMesh& with_texture() const { return textured ? *textured : finished(); }
  };
  Result<output::Cloud> read_points(const std::string& scan_id, const std::string& name);
  Result<output::NamedFiles> files_of(const exports::ExportFormat& format, const ExportSpec& spec,
                                      const std::string& scan_id, const BuildProgress& progress);
  Result<plan::FloorPlan> make_plan(const std::string& scan_id);
  Status read_imported(const std::string& scan_id);
  Status check_memory(const std::string& scan_id, const std::string& source) const;
  Status make_mesh(const std::string& scan_id, double share, const BuildProgress& progress);
  Status make_shape(const std::string& scan_id, const MeshShape& shape, double from, double to,
                    const BuildProgress& progress);
  Result<output::TriangleMesh> texture(const std::string& scan_id, const BuildProgress& progress);
  Status make_texture(const std::string& scan_id, const BuildProgress& progress);
  Result<output::NamedFiles> with_thumbnail(const std::string& scan_id,
                                            output::NamedFile mesh) const;

  Blobs& blobs_;
  const OpenFrames open_frames_;
  const FreeMemory free_memory_;
  std::optional<KnownMesh> mesh_;
};

}  // namespace hermite::server
