// Blobs as files: FOLDER/SCAN/NAME. Other contents of a scan's folder (its frame log) are neither
// listed nor removed here.
#pragma once

#include <string>
#include <vector>

#include "server/store/blobs.h"

namespace hermite::server {

class FileBlobs : public Blobs {
 public:
  // `folder` must exist.
  explicit FileBlobs(std::string folder) : folder_(std::move(folder)) {}

  Status put(const std::string& scan_id, const std::string& name,
             const std::string& bytes) override;
  Result<std::string> read(const std::string& scan_id, const std::string& name,
                           std::uint64_t offset, std::size_t max_bytes) override;
  Result<std::uint64_t> size_bytes(const std::string& scan_id, const std::string& name) override;
  Result<std::string> version(const std::string& scan_id, const std::string& name) override;
  Result<std::vector<BlobInfo>> list(const std::string& scan_id) override;
  Status remove(const std::string& scan_id) override;
  Status remove(const std::string& scan_id, const std::string& name) override;

 private:
  std::string folder_of(const std::string& scan_id) const;
  std::string path_of(const std::string& scan_id, const std::string& name) const;

  const std::string folder_;
};

}  // namespace hermite::server
