// Removes files in the background: they are moved out of the way immediately, and nothing waits for a disk that deletes
// gigabytes slowly. Belongs to the network thread.
#pragma once

#include <functional>
#include <string>

#include "core/base/result.h"
#include "server/store/data_directory.h"

namespace hermite {

class Waste {
 public:
  // Runs a function soon, on a thread that may wait for a disk. Posted functions end before `data` is destroyed, or
  // never begin; then the next server deletes the files.
  using Post = std::function<void(std::function<void()>)>;

  // Starts with the files that an earlier server has left. `data` outlives this.
  Waste(const DataDirectory& data, Post background);

  // Succeed if there are no files. kIo: the files are where they were.
  Status remove_scan(const std::string& scan_id);
  Status remove_upload(const std::string& upload_id);

 private:
  Status remove(const Result<std::string>& name);

  const DataDirectory& data_;
  const Post background_;
};

}  // namespace hermite
