#include "server/service/results_place.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "server/scan/checkpoint_file.h"

namespace hermite::server {

namespace {

bool is_result(const BlobInfo& blob) { return blob.name != kCheckpointName; }

bool has_results(const DataDirectory& data, FileBlobs& files) {
  for (const std::string& id : or_throw(data.scan_ids())) {
    const std::vector<BlobInfo> blobs = or_throw(files.list(id));
    if (std::any_of(blobs.begin(), blobs.end(), is_result)) return true;
  }
  return false;
}

void or_setup_error(const Status& status) {
  if (!status.ok()) throw SetupError(status.error());
}

}  // namespace

S3Settings s3_settings(const ServiceOptions& options) {
  return {options.blobs, options.s3_endpoint,    options.s3_region,      options.s3_addressing,
          options.s3_ca, options.s3_credentials, options.insecure_listen};
}

ResultsPlace::ResultsPlace(const ServiceOptions& options, const DataDirectory& data)
    : data_(data), files_(data.scans_folder()) {
  if (options.blobs.empty()) {
    or_setup_error(check_place(options.data_folder, "", true));
    return;
  }
  S3Options s3 = or_throw(s3_options(s3_settings(options)));
  or_setup_error(check_place(options.data_folder, text_of(S3Location{s3.bucket, s3.prefix}),
                             has_results(data, files_)));
  remote_ = std::make_unique<RemoteBlobs>(
      std::move(s3), LocalBlobs{files_, {kCheckpointName}, options.data_folder + "/blob-removals"});
  or_setup_error(remote_->s3().check_access());
  or_setup_error(join_to_s3(options.data_folder, remote_->s3()));
  or_setup_error(remote_->load());
  std::map<std::string, std::uint64_t> sizes;
  remote_->add_sizes(sizes);
  spdlog::info("results are in {}, of {} scans now", remote_->s3().address(), sizes.size());
}

Result<std::map<std::string, std::uint64_t>> ResultsPlace::scan_sizes() const {
  Result<std::map<std::string, std::uint64_t>> sizes = data_.scan_sizes();
  if (sizes.ok() && remote_) remote_->add_sizes(*sizes);
  return sizes;
}

}  // namespace hermite::server
