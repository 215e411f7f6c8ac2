#include "server/disk/waste.h"

#include <spdlog/spdlog.h>

#include <utility>

namespace hermite {

Waste::Waste(const DataDirectory& data, Post background) : data_(data), background_(std::move(background)) {
  for (const std::string& name : data_.waste()) (void)remove(name);
}

Status Waste::remove(const Result<std::string>& name) {
  if (!name.ok()) return name.error();
  if (name->empty()) return Done{};
  background_([&data = data_, name = *name] {
    if (const Status status = data.remove_waste(name); !status.ok())
      spdlog::warn("{}; it is tried again at the next start", status.error().message);
  });
  return Done{};
}

Status Waste::remove_scan(const std::string& scan_id) { return remove(data_.discard_scan(scan_id)); }

Status Waste::remove_upload(const std::string& upload_id) { return remove(data_.discard_upload(upload_id)); }

}  // namespace hermite
