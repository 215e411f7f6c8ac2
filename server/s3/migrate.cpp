#include "server/s3/migrate.h"

#include <fmt/core.h>

#include <utility>

#include "core/digest/sha256.h"
#include "core/output/ply.h"
#include "server/s3/remote_blobs.h"
#include "server/s3/remote_setup.h"

namespace hermite::server {

namespace {

// The blobs of a store with their sizes, by scan and name.
using Inventory = std::map<BlobKey, std::uint64_t>;

Result<Inventory> inventory_of_folder(const Migration& migration) {
  Inventory inventory;
  for (const std::string& scan_id : migration.scan_ids) {
    const Result<std::vector<BlobInfo>> blobs = migration.files.list(scan_id);
    if (!blobs.ok()) return blobs.error();
    for (const BlobInfo& blob : *blobs)
      if (!migration.local_names.contains(blob.name))
        inventory[{scan_id, blob.name}] = blob.size_bytes;
  }
  return inventory;
}

Result<Inventory> inventory_of_s3(S3Blobs& s3) {
  Inventory inventory;
  const Status listed = s3.list_all(
      [&inventory](const std::string& scan_id, const std::string& name, const StoredBlob& blob) {
        inventory[{scan_id, name}] = blob.size_bytes;
      });
  return listed.ok() ? Result<Inventory>(std::move(inventory)) : listed.error();
}

std::string blob_name(const BlobKey& key) {
  return fmt::format("{} of scan {}", key.second, key.first);
}

Result<std::string> hash_of(Blobs& blobs, const BlobKey& key) {
  const Result<std::string> bytes = read_blob(blobs, key.first, key.second, kMaxS3Put_bytes);
  return bytes.ok() ? Result<std::string>(digest::sha256(*bytes))
                    : in_context(blob_name(key), bytes.error());
}

struct Copying {
  Blobs& from;
  Blobs& to;
  Inventory there = {};  // at the destination
};

// Copies a blob unless it is there already. Returns whether it has copied it.
Result<bool> copy_blob(Copying& copying, const BlobKey& key, std::uint64_t size_bytes) {
  const Result<std::string> bytes = read_blob(copying.from, key.first, key.second, kMaxS3Put_bytes);
  if (!bytes.ok()) return in_context("reading " + blob_name(key), bytes.error());
  const std::string wanted = digest::sha256(*bytes);
  if (const auto there = copying.there.find(key);
      there != copying.there.end() && there->second == size_bytes)
    if (const Result<std::string> hash = hash_of(copying.to, key); hash.ok() && *hash == wanted)
      return false;
  if (Status status = copying.to.put(key.first, key.second, *bytes); !status.ok())
    return in_context("storing " + blob_name(key), status.error());
  const Result<std::string> hash = hash_of(copying.to, key);
  if (!hash.ok()) return hash.error();
  if (*hash != wanted)
    return Error{ErrorCode::kIo,
                 fmt::format("other bytes came back of {} than were copied; nothing is removed",
                             blob_name(key))};
  return true;
}

Result<MigrationCounts> copy_all(Copying copying, const Inventory& inventory,
                                 const Migration& migration) {
  MigrationCounts counts;
  for (const auto& [key, size_bytes] : inventory) {
    migration.says(
        fmt::format("{} of {}: {}", counts.blob_count + 1, inventory.size(), blob_name(key)));
    const Result<bool> copied = copy_blob(copying, key, size_bytes);
    if (!copied.ok()) return copied.error();
    ++counts.blob_count;
    counts.bytes += size_bytes;
    counts.copied_count += *copied ? 1 : 0;
  }
  return counts;
}

Status remove_all(Blobs& blobs, const Inventory& inventory) {
  for (const auto& [key, size_bytes] : inventory)
    if (Status status = blobs.remove(key.first, key.second); !status.ok()) return status;
  return Done{};
}

// What a server has removed and S3 has not been told yet must not come back.
Status make_removals(const Migration& migration) {
  const Result<std::set<BlobKey>> removals = read_removals(migration.removals_path);
  if (!removals.ok()) return removals.error();
  for (const auto& [scan_id, name] : *removals)
    if (Status status = migration.s3.remove(scan_id, name); !status.ok()) return status;
  return removals->empty() ? Status(Done{})
                           : output::write_file_atomically(migration.removals_path, "");
}

}  // namespace

Result<MigrationCounts> migrate_to_s3(const Migration& migration) {
  if (Status status = begin_move_to_s3(migration.data_folder, migration.s3); !status.ok())
    return status.error();
  if (Status status = make_removals(migration); !status.ok()) return status.error();
  const Result<Inventory> here = inventory_of_folder(migration);
  if (!here.ok()) return here.error();
  const Result<Inventory> there = inventory_of_s3(migration.s3);
  if (!there.ok()) return there.error();
  // With its note the folder has only what an interrupted migration, which had copied everything,
  // has left.
  Result<MigrationCounts> counts =
      copy_all({migration.files, migration.s3, *there}, *here, migration);
  if (!counts.ok()) return counts;
  if (Status status = end_move_to_s3(migration.data_folder); !status.ok()) return status.error();
  migration.says("all is in S3 and compared; it is removed from the folder");
  if (Status status = remove_all(migration.files, *here); !status.ok()) return status.error();
  return counts;
}

Result<MigrationCounts> migrate_from_s3(const Migration& migration) {
  const Result<bool> in_s3 = is_in_s3(migration.data_folder, migration.s3);
  if (!in_s3.ok()) return in_s3.error();
  if (Status status = make_removals(migration); !status.ok()) return status.error();
  const Result<Inventory> there = inventory_of_s3(migration.s3);
  if (!there.ok()) return there.error();
  Result<MigrationCounts> counts = MigrationCounts();
  if (*in_s3) {
    const Result<Inventory> here = inventory_of_folder(migration);
    if (!here.ok()) return here.error();
    counts = copy_all({migration.s3, migration.files, *here}, *there, migration);
    if (!counts.ok()) return counts;
    if (Status status = leave_s3(migration.data_folder); !status.ok()) return status.error();
  }
  migration.says("all is in the folder and compared; it is removed from S3");
  if (Status status = remove_all(migration.s3, *there); !status.ok()) return status.error();
  if (Status status = give_up_prefix(migration.data_folder, migration.s3); !status.ok())
    return status.error();
  return counts;
}

}  // namespace hermite::server
