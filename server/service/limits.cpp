#include "server/service/limits.h"

#include <fmt/core.h>

#include "core/archive/unpack.h"
#include "core/base/check.h"
#include "core/import/model.h"
#include "proto/wire/messages.h"
#include "server/access/places.h"
#include "server/access/rate_limit.h"
#include "server/connections/http_connection.h"
#include "server/disk/storage_quota.h"
#include "server/exports/build_comparison.h"
#include "server/exports/exports.h"
#include "server/exports/scan_edits_file.h"
#include "server/routes/frame_routes.h"
#include "server/routes/measure_routes.h"
#include "server/routes/measuring_cache.h"
#include "server/routes/note_routes.h"
#include "server/scan/received_frames.h"
#include "server/scan/shown_scans.h"
#include "server/scan/subscribers.h"
#include "server/service/service_setup.h"
#include "server/store/job_row.h"
#include "server/store/measurement_row.h"
#include "server/store/note_row.h"

namespace hermite::server {

namespace {

constexpr std::int64_t kGigabyte = 1'000'000'000;

SharedLimit shared_limit(Shared which, const ServiceOptions& options) {
  switch (which) {
    case Shared::kTokens:
      return {which, "tokens that have not ended; only administrators make them", kTokenShare, "",
              "HTTP 409"};
    case Shared::kShareLinks:
      return {which, "share links that have not ended, by the token that made them",
              kShareLinkShare, "", "HTTP 409"};
    case Shared::kUploads: return {which, "uploads", kUploadShare, "", "HTTP 503"};
    case Shared::kUploadBytes:
      return {which, "bytes of uploads", {0, options.uploads_per_token_gb, 0}, "GB", "HTTP 503"};
    case Shared::kJobs: return {which, "jobs that wait or run", kJobShare, "", "HTTP 409, 503"};
    case Shared::kRunningScans:
      return {which, "scans that run", running_share(scans_options(options).places), "",
              "`Waiting`, or close code 4013"};
    case Shared::kWaitingCameras:
      return {which, "cameras that wait for a place", kWaitingCameraShare, "", "close code 4013"};
    case Shared::kStorage: {
      const Share share = storage_share(static_cast<std::uint64_t>(options.storage_gb * kGigabyte));
      return {
          which,
          "storage for scans and uploads (`storage-gb`): one token has half, a twentieth is kept",
          {share.in_all / kGigabyte, share.per_token / kGigabyte, share.for_admins / kGigabyte},
          "GB",
          "close code 4013, HTTP 503"};
    }
    case Shared::kViewers:
      return {which, "viewers of one scan", kViewerShare, "", "close code 4013"};
    case Shared::kConnections:
      return {which, "WebSockets", connection_share(options), "", "close code 4013"};
    case Shared::kRequests:
      return {which,
              "HTTP requests a second; twice as many at once",
              {0, options.requests_per_second, 0},
              "",
              "HTTP 429"};
    case Shared::kExports:
      return {which, "exports that wait or are made, one at a time", kExportShare, "", "HTTP 503"};
  }
  CHECK(false, "every share has its row");
  return {};
}

std::string number(std::int64_t value, const std::string& unit) {
  return value == 0 ? "-" : std::to_string(value) + (unit.empty() ? "" : " " + unit);
}

std::string kib(std::size_t bytes) { return fmt::format("{} KiB", bytes / 1024); }

std::vector<Bound> bounds_of_connections(const ServiceOptions& options) {
  return {
      {"connections, in all and of one address",
       fmt::format("{}, {}", options.max_connections, options.connections_per_address), "HTTP 503"},
      {"HTTP requests and upgrades of one address",
       fmt::format("{} a second, {} at once", options.requests_per_second,
                   2 * options.requests_per_second),
       "HTTP 429"},
      {"wrong secrets of one address", fmt::format("{} a minute", options.failures_per_minute),
       "HTTP 429, close code 4013. A right one is still let in: many people may share an address"},
      {"addresses that are counted one by one", std::to_string(kMaxLimitedAddresses),
       "the others share one allowance"},
      {"header, body",
       fmt::format("{}, {}, {} to measure, {} for a note, {} for the edits of a scan; pieces of "
                   "uploads below",
                   kib(kMaxHeaderBytes), kib(kMaxBodyBytes), kib(kMaxMeasureBodyBytes),
                   kib(kMaxNoteBodyBytes), kib(kMaxEdits_bytes)),
       "HTTP 431, 413"},
      {"first message; frames; viewers' messages",
       fmt::format("{}; 64 KiB + 8 bytes a pixel; {}", kib(wire::kMaxBytesBeforeWelcome),
                   kib(wire::kMaxBytesBeforeWelcome)),
       "close code 1009"},
      {"header, first message", "10 s each", "closed"},
      {"a piece of 128 KiB of a long body", "60 s", "connection closed, what came is kept"},
  };
}

// Of scans while they run, of uploads and of their jobs.
std::vector<Bound> bounds_of_work(const ServiceOptions& options) {
  const archive::UnpackLimits unpack;
  return {
      {"a camera that could send a frame and sends none",
       fmt::format("{} s, less where it asks for less", options.frame_patience_s),
       "the scan ends as interrupted"},
      {"a pause", fmt::format("{} min", std::chrono::minutes(kMaxPause).count()),
       "the scan ends as interrupted"},
      {"frames of a scan", std::to_string(kMaxFramesPerScan), "close code 1009"},
      {"surfels of a map with a surface while it grows", std::to_string(mesh::kMostLiveSurfels),
       "its points are shown"},
      {"priority of a job without `admin`",
       fmt::format("{} to {}", kLowestPriority, kHighestPriorityForAll), "HTTP 403"},
      {"one upload", fmt::format("{} GB", options.max_upload_gb), "HTTP 413"},
      {"free disk that scans, uploads, unpacking and exports leave",
       fmt::format("{} MB, and an inode for each", options.min_free_disk_mb),
       "close code 4013, HTTP 503, 507; the job and the export wait"},
      {"an upload that nothing happens with", fmt::format("{} h", options.keep_upload_hours),
       "deleted"},
      {"unpacking",
       fmt::format("{} files, {} GiB, {} times the archive", unpack.entry_count,
                   unpack.output_bytes >> 30, unpack.ratio),
       "the job fails"},
      {"a cloud or mesh that is imported",
       fmt::format("{} MiB, {} vertices, {} triangles, {} pixels", imports::kMaxModel_bytes >> 20,
                   imports::kMaxModelVertices, imports::kMaxModelTriangles,
                   imports::kMaxModelPixels),
       "the job fails"},
  };
}

// Of what is asked about ended scans, and of the lists of what has ended.
std::vector<Bound> bounds_of_results() {
  return {
      {"frames that are looked at, at once; two are worked on",
       std::to_string(kMaxFramesAskedAtOnce), "HTTP 503"},
      {"the cloud of a scan that exports are made of",
       fmt::format("{} MiB", kMaxExportCloud_bytes >> 20), "the export fails"},
      {"the surfels of a scan that meshes are made of",
       fmt::format("{} MiB, and 4.4 times of them free in memory", kMaxMeshedCloud_bytes >> 20),
       "the export fails"},
      {"exports of a scan with options", std::to_string(kMaxShapedExports), "HTTP 503"},
      {"comparisons of a scan with others, as the first of both", std::to_string(kMaxComparisons),
       "HTTP 503"},
      {"the surfels of a scan that is compared",
       fmt::format("{} MiB, and what fits into the free memory", kMaxComparedCloud_bytes >> 20),
       "the comparison fails"},
      {"measurements that are made at once", std::to_string(kMaxMeasuringAtOnce), "HTTP 503"},
      {"scans whose surfels are kept in memory to be measured in",
       fmt::format("{}, {} MiB together", MeasuringCache::kMostScans,
                   MeasuringCache::kMost_bytes >> 20),
       "they are read again"},
      {"points of ended scans that are kept for viewers",
       fmt::format("{} MiB together, or one scan", kMaxShown_bytes >> 20), "close code 4013"},
      {"corners of an area that is measured", std::to_string(measure::kMostCorners), "HTTP 400"},
      {"measurements of a scan that are kept", std::to_string(kMaxMeasurementsPerScan), "HTTP 409"},
      {"edits of a scan", std::to_string(edit::kMostEdits), "HTTP 400"},
      {"notes in a scan; the text of one",
       fmt::format("{}; {} bytes", kMaxNotesPerScan, kMaxNoteTextBytes), "HTTP 409; 400"},
      {"ended tokens and links that a list keeps, of one maker",
       fmt::format("{}, for 90 days", kMaxEndedLinksPerToken), "the oldest are forgotten"},
      {"ended jobs that a list keeps, of one token",
       fmt::format("{}, for 90 days", kMaxEndedJobsPerToken), "the oldest are forgotten"},
  };
}

}  // namespace

Share connection_share(const ServiceOptions& options) {
  return {options.max_connections, options.connections_per_token, options.max_connections / 16};
}

std::vector<SharedLimit> shared_limits(const ServiceOptions& options) {
  std::vector<SharedLimit> limits;
  for (const Shared which : kAllShared) limits.push_back(shared_limit(which, options));
  return limits;
}

std::vector<Bound> bounds(const ServiceOptions& options) {
  std::vector<Bound> all = bounds_of_connections(options);
  for (Bound& bound : bounds_of_work(options)) all.push_back(std::move(bound));
  for (Bound& bound : bounds_of_results()) all.push_back(std::move(bound));
  return all;
}

std::string limits_text(const ServiceOptions& options) {
  std::string text =
      "| shared by all tokens | in all | of one token | of that for `admin` only | answer "
      "|\n|---|---|---|---|---|\n";
  for (const SharedLimit& limit : shared_limits(options))
    text += fmt::format("| {} | {} | {} | {} | {} |\n", limit.what,
                        number(limit.share.in_all, limit.unit),
                        number(limit.share.per_token, limit.unit),
                        number(limit.share.for_admins, limit.unit), limit.answer);
  text += "\n| bound | default | answer |\n|---|---|---|\n";
  for (const Bound& bound : bounds(options))
    text += fmt::format("| {} | {} | {} |\n", bound.what, bound.value, bound.answer);
  return text;
}

}  // namespace hermite::server
