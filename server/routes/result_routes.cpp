#include "server/routes/result_routes.h"

#include <cstdint>

#include "core/thumbnail/thumbnail.h"
#include "server/exports/export_spec.h"
#include "server/routes/byte_range.h"

namespace hermite::server {

HttpAnswer send_file(const HttpWorld& world, const Call& call, const std::string& name,
                     const char* content_type) {
  const std::string& id = call.id;
  const Result<std::uint64_t> size_bytes = world.scans.ended_scans().size_of_result(id, name);
  if (!size_bytes.ok()) return refused(size_bytes.error());
  const Result<std::string> version = world.scans.blobs().version(id, name);
  if (!version.ok()) return refused(version.error());
  HttpAnswer answer;
  answer.content_type = content_type;
  answer.stored = StoredBody{*size_bytes, [&blobs = world.scans.blobs(), id, name](
                                              std::uint64_t offset, std::size_t max_bytes) {
                               return blobs.read(id, name, offset, max_bytes);
                             }};
  answer.download_name = id + "-" + name;
  return as_asked(std::move(answer), *version, call.request);
}

HttpAnswer send_cloud(const HttpWorld& world, const Call& call) {
  return send_file(world, call, "cloud.ply", "application/octet-stream");
}

HttpAnswer send_trajectory(const HttpWorld& world, const Call& call) {
  return send_file(world, call, "trajectory.txt", "text/plain; charset=utf-8");
}

// The thumbnail of the mesh comes first: the scan was edited. Lists ask for those of all scans:
// that one is still running, or older than these files, is no failure.
HttpAnswer send_thumbnail(const HttpWorld& world, const Call& call) {
  for (const char* name : {kMeshThumbnailFile, thumbnail::kThumbnailName}) {
    const Result<std::uint64_t> size_bytes =
        world.scans.ended_scans().size_of_result(call.id, name);
    if (size_bytes.ok() || size_bytes.error().code != ErrorCode::kNotFound ||
        !world.scans.rows().find(call.id).ok())
      return send_file(world, call, name, "image/jpeg");
  }
  HttpAnswer none;
  none.status = 204;
  return none;
}

HttpAnswer send_report(const HttpWorld& world, const Call& call) {
  return send_file(world, call, "report.json", "application/json");
}

}  // namespace hermite::server
