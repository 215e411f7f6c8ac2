// What `hermite-client upload` tells the server of a recording, which it looks at before it is
// sent.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/client/upload.h"

namespace hermite::commands {

// What is asked for with each recording of a command line.
struct UploadRequest {
  std::string title;                  // empty: the recording's name
  std::string camera;                 // a file or a name (dataset::read_camera); empty: it says so
  std::vector<std::string> settings;  // key=value
  int priority = 0;
  bool no_check = false;  // do not open the recording
  bool import = false;    // only clouds and meshes
};

// Returns the metadata of the upload of `path`, after checking, unless no_check, that the server
// will be able to read it; adds its camera, so that the server need not guess from names. `tell` is
// given one line after another about what is in it. The errors of whoever reads it; kCorruptData
// also where no frame can be read.
Result<client::UploadMetadata> upload_metadata(const std::string& path,
                                               const UploadRequest& request,
                                               const std::function<void(const std::string&)>& tell);

}  // namespace hermite::commands
