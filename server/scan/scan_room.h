// Room for scans on the disk and in the storage of their owners. Room for the results of running
// scans is kept back. Belongs to the network thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "server/access/places.h"
#include "server/disk/storage.h"
#include "server/scan/scan_rows.h"

namespace hermite::server {

class ScanRoom {
 public:
  // What is referred to outlives this. Scans leave `min_free_disk_bytes`, besides room for their
  // results.
  ScanRoom(std::uint64_t min_free_disk_bytes, const Storage& storage, const Places& places,
           ScanRows& rows, const RunningScans& running);

  // kBusy: the disk has no room for another scan besides the results of the running ones. kIo: its
  // free space is unknown.
  Status check_disk() const;
  Status check_disk_for(std::uint64_t bytes) const;  // the same for this many bytes of an export

  // kBusy: the storage of the owner is used up. kIo. That upload is not counted.
  Status check_storage(const ScanOwner& owner, const std::string& except_upload_id = "") const;
  Status check_storage_of(const std::string& scan_id);  // of the scan's owner; also kNotFound

  // Both, for a model that replaces its upload.
  Status check_import(const std::string& upload_id, const ScanOwner& owner,
                      std::uint64_t bytes) const;

  // To be called regularly: every second warns the cameras of running scans when little room is
  // left, and ends scans while the results of all of them still fit. On a full disk no results
  // could be stored.
  void tick(std::chrono::steady_clock::time_point now);

 private:
  struct Room {
    std::optional<Error> gone;  // no room except for results
    std::string warning;        // little room is left
  };
  // Room is needed for this many bytes of the owner, besides reserved bytes of others.
  struct ToCome {
    std::uint64_t bytes = 1, bytes_of_others = 0;
  };
  std::uint64_t kept_back_bytes() const;
  Room room_on_disk() const;
  Room room_in_storage(const std::string& scan_id) const;
  Status check_storage_for(const ScanOwner& owner, const std::string& except_upload_id,
                           const ToCome& to_come) const;

  const std::uint64_t min_free_disk_bytes_;
  const Storage storage_;
  const Places& places_;
  ScanRows& rows_;
  const RunningScans& running_;
  std::chrono::steady_clock::time_point watched_at_;
};

}  // namespace hermite::server
