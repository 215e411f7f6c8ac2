// The lock of a data folder, so that two servers never share one. Its file holds the address on
// which the server listens, for other programs on the same machine.
#pragma once

#include <string>

#include "core/base/result.h"
#include "server/store/owned_descriptor.h"

namespace hermite::server {

// Holds the lock while it exists. One owner; const functions are thread-safe.
class FolderLock {
 public:
  // Locks the file `lock` in the folder, which exists, and removes the address of an earlier
  // server. Also locks the folder itself, a lock that remains when somebody deletes the file.
  // Throws SetupError: kBusy, held by another server; kIo.
  explicit FolderLock(const std::string& folder);

  // Writes the address on which this server listens into the file. kIo.
  Status publish_address(const std::string& url) const;

 private:
  const std::string path_;
  const OwnedDescriptor file_, folder_;
};

// What a program on the same machine needs to connect to a server.
struct PublishedServer {
  std::string url;    // as published
  std::string token;  // the first token
};

// Returns address and token of the server that holds the lock of that data folder. kNotFound: no
// server has published its address there, or there is no token.
Result<PublishedServer> published_server(const std::string& folder);

}  // namespace hermite::server
