// The exports of all scans: which are ready, queued, running or failed, and why. A finished export
// is a blob of its scan and survives restarts; queued and running ones (export_queue.h) are lost
// when the server ends and have to be requested again. Belongs to the network thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/edit/scan_edits.h"
#include "server/exports/export_offer.h"
#include "server/exports/export_queue.h"
#include "server/exports/export_spec.h"
#include "server/store/blobs.h"
#include "server/store/scan_row.h"
#include "server/store/shares.h"

namespace hermite::server {

// Limits of queued and running exports. A scan has about a dozen formats.
inline constexpr Share kExportShare{64, 16, 8};

struct ExportState {
  const ExportOffer* format = nullptr;
  MeshShape shape;            // how the mesh is processed first
  std::string other_scan_id;  // only of a comparison
  ExportPhase phase = ExportPhase::kMissing;
  std::uint64_t size_bytes = 0;  // when ready
  double done = 0;               // fraction, while running
  std::string message;           // why it failed, or still waits
};

struct ExportRequest {
  std::string scan_id;
  std::string format;  // ExportSpec::name, of a format
  std::string token_id;
  bool is_admin = false;  // only the limit for all tokens together applies
};

class Exports {
 public:
  using Clock = ExportQueue::Clock;
  using Hooks = ExportHooks;

  // `blobs` outlives this.
  Exports(Blobs& blobs, Hooks hooks);
  Exports(const Exports&) = delete;
  Exports& operator=(const Exports&) = delete;

  // Every format that the scan has or can be exported to, in the order of the table, followed by
  // its exports with options. kNotFound: no such scan. kBusy: it is running. kIo.
  Result<std::vector<ExportState>> list(const std::string& scan_id);

  // One export. Errors as above, and kNotFound: no such format; kInvalidArgument: its options.
  // `format` is never a comparison.
  Result<ExportState> state(const std::string& scan_id, const std::string& format);

  // The comparisons of the scan with others, as the first of both, by the id of the other scan.
  // Those whose other scan was deleted are removed and left out. Errors as of list().
  Result<std::vector<ExportState>> list_comparisons(const std::string& scan_id);

  // One comparison. Errors as of list(), for both scans; and kInvalidArgument: both are the same.
  Result<ExportState> comparison(const std::string& scan_id, const std::string& other_scan_id);

  // As request() and remove(), but `request.format` is not read. kBusy also: the scan already has
  // kMaxComparisons.
  Status request_comparison(const ExportRequest& request, const std::string& other_scan_id);
  Status remove_comparison(const std::string& scan_id, const std::string& other_scan_id);

  // Removes the comparisons that others have with a scan which is about to be deleted, since they
  // contain parts of it.
  void forget_comparisons_with(const std::string& scan_id);

  // Queues the export unless it is ready, queued or running; one that failed is tried again. Errors
  // as of state(), and kNotFound: the scan lacks the files that it is made from; kInvalidArgument:
  // its cloud has no points; kBusy: too many are queued, the server stops, or the scan already has
  // kMaxShapedExports exports with options.
  Status request(const ExportRequest& request);

  // What was taken out of the scan. kNotFound: no such scan; kCorruptData, kIo.
  Result<edit::ScanEdits> edits(const std::string& scan_id) const;

  // Replaces the edits of an ended scan, if their version is `changed.version`, and returns the new
  // ones with the next version; otherwise returns those that there are, which have another version.
  // The scan's meshes and clouds are removed, since they were made with other edits; the viewer's
  // mesh is queued. Errors as of edits(), and kBusy: the scan is running.
  Result<edit::ScanEdits> change_edits(const std::string& scan_id, edit::ScanEdits changed);

  // Queues the viewer's mesh of a scan that has just finished or been edited, if it has points and
  // the queue is not full.
  void make_mesh(const ScanRow& scan);

  // Removes the export from the queue, stops it, or deletes its file. Errors as of state(), and
  // kInvalidArgument: it is a result of the scan rather than an export; kNotFound: there is no such
  // export.
  Status remove(const std::string& scan_id, const std::string& format);

  void tick(Clock::time_point now) { queue_.tick(now); }
  void stop() { queue_.stop(); }
  std::size_t running_count() const { return queue_.running_count(); }
  std::size_t waiting_count() const { return queue_.waiting_count(); }

 private:
  Result<ScanRow> find_ended(const std::string& scan_id) const;
  Result<ScanRow> find_compared(const std::string& scan_id, const std::string& other_scan_id);
  Result<ExportState> stored_state(const std::string& scan_id, const ExportSpec& spec) const;
  ExportState state_of(const std::string& scan_id, const ExportSpec& spec,
                       std::optional<std::uint64_t> size_bytes) const;
  Status request_spec(const ScanRow& scan, const ExportSpec& spec, const ExportRequest& asker);
  Status remove_spec(const std::string& scan_id, const ExportState& now);
  std::vector<std::string> compared_scans(const std::string& scan_id,
                                          const std::vector<BlobInfo>& blobs) const;
  std::vector<ExportSpec> shaped_exports(const std::string& scan_id,
                                         const std::vector<BlobInfo>& blobs) const;
  Status check_comparisons(const std::string& scan_id, const ExportSpec& spec) const;
  Status check_shaped(const std::string& scan_id, const ExportSpec& spec) const;
  Status check_source(const std::string& scan_id, const ExportOffer& format) const;
  Status add(const ScanRow& scan, const ExportSpec& spec, const ExportRequest& asker,
             bool is_requested);

  Blobs& blobs_;
  const Hooks hooks_;
  ExportQueue queue_;
};

}  // namespace hermite::server
