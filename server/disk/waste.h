// Files that nobody wants any more. They are out of the way at once; a disk that takes its time to let go of gigabytes keeps nobody
// waiting. Belongs to the network thread.
#pragma once

#include <functional>
#include <string>

#include "core/base/result.h"
#include "server/store/data_directory.h"

namespace hermite {

class Waste {
 public:
  // Runs a function soon, on a thread that may wait for a disk. What was posted there ends before `data` does, or never begins: then the
  // next server has it to do.
  using Post = std::function<void(std::function<void()>)>;

  // Begins with what an earlier server has left. `data` outlives this.
  Waste(const DataDirectory& data, Post background);

  // Well, too, when there are none. kIo: they are where they were.
  Status remove_scan(const std::string& scan_id);
  Status remove_upload(const std::string& upload_id);

 private:
  Status remove(const Result<std::string>& name);

  const DataDirectory& data_;
  const Post background_;
};

}  // namespace hermite
