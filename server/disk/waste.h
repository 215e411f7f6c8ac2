// Removes files in the background: they are moved out of the way immediately, and nothing waits for
// a disk that deletes gigabytes slowly. Belongs to the network thread.
#pragma once

#include <functional>
#include <string>

#include "core/base/result.h"
#include "server/store/set_aside_files.h"

namespace hermite::server {

class Waste {
 public:
  // Runs a function soon, on a thread that may wait for a disk. Posted functions end before `files`
  // are destroyed, or never begin; then the next server deletes the files.
  using Post = std::function<void(std::function<void()>)>;

  // Starts with the files that an earlier server has left. `files` outlive this.
  Waste(const SetAsideFiles& files, Post background);

  // Succeed if there are no files. kIo: the files are where they were.
  Status remove_scan(const std::string& scan_id);
  Status remove_upload(const std::string& upload_id);

 private:
  Status remove(const Result<std::string>& name);

  const SetAsideFiles& files_;
  const Post background_;
};

}  // namespace hermite::server
