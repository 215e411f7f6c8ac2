#include "server/disk/waste.h"

#include <spdlog/spdlog.h>

#include <utility>

namespace hermite::server {

Waste::Waste(const SetAsideFiles& files, Post background)
    : files_(files), background_(std::move(background)) {
  for (const std::string& name : files_.waste()) (void)remove(name);
}

Status Waste::remove(const Result<std::string>& name) {
  if (!name.ok()) return name.error();
  if (name->empty()) return Done{};
  background_([&files = files_, name = *name] {
    if (const Status status = files.remove_waste(name); !status.ok())
      spdlog::warn("{}; it is tried again at the next start", status.error().message);
  });
  return Done{};
}

Status Waste::remove_scan(const std::string& scan_id) {
  return remove(files_.discard_scan(scan_id));
}

Status Waste::remove_upload(const std::string& upload_id) {
  return remove(files_.discard_upload(upload_id));
}

}  // namespace hermite::server
