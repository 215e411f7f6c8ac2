// Where a server keeps the results of its scans: in its folder of data, or in S3.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "core/base/result.h"
#include "server/s3/remote_blobs.h"
#include "server/s3/remote_setup.h"
#include "server/service/service.h"
#include "server/store/data_directory.h"
#include "server/store/file_blobs.h"

namespace hermite::server {

S3Settings s3_settings(const ServiceOptions& options);

class ResultsPlace {
 public:
  // `data` outlives this. In S3 it checks that objects can be stored, read, listed and removed, and
  // reads which there are. Throws SetupError, with a message: it is not allowed, S3 does not
  // answer, or the results of this folder are elsewhere.
  ResultsPlace(const ServiceOptions& options, const DataDirectory& data);

  Blobs& blobs() { return remote_ ? static_cast<Blobs&>(*remote_) : files_; }
  bool is_remote() const { return remote_ != nullptr; }

  // Returns the size of all files and objects of each scan, as DataDirectory::scan_sizes.
  Result<std::map<std::string, std::uint64_t>> scan_sizes() const;

 private:
  const DataDirectory& data_;
  FileBlobs files_;
  std::unique_ptr<RemoteBlobs> remote_;
};

}  // namespace hermite::server
