// Which folder of data belongs to which prefix of S3. Both know of each other, so that neither two
// servers use one prefix, nor a server starts without the results of its folder:
//   DATA/blobs-at   the address, and the id of the folder, which is made with it; in backups
//   PREFIX/owner    that id
#pragma once

#include <optional>
#include <string>

#include "core/base/result.h"
#include "server/s3/s3_blobs.h"

namespace hermite::server {

// What `hermite serve` and `hermite migrate` are told of S3.
struct S3Settings {
  std::string blobs;     // "s3://BUCKET/PREFIX"
  std::string endpoint;  // empty: Amazon's
  std::string region;
  std::string addressing;  // "path" or "virtual-host"
  std::string ca_file;
  std::string credentials_file;  // empty: the environment
  bool allow_plain = false;      // see checked_s3_endpoint
};

// Returns the options; kInvalidArgument, kNotFound, kIo, with a message that names the setting.
Result<S3Options> s3_options(const S3Settings& settings);

// Returns where the results of a folder of data are, as it notes; std::nullopt: in the folder
// itself. kCorruptData, kIo.
Result<std::optional<std::string>> blobs_at(const std::string& data_folder);

// Notes, in the folder and below the prefix, that they belong together. Succeeds if it is noted
// already. kBusy: the prefix belongs to another folder. kInvalidArgument: the folder's results are
// elsewhere. kIo.
Status join_to_s3(const std::string& data_folder, S3Blobs& s3);

// While results move, the note is in DATA/blobs-moving whenever the folder itself has all of them:
// on the way to S3 until the end, on the way back once all have arrived. A server then looks for
// them in the folder. Beginning claims the prefix for this folder, whose results are in it or in S3
// below this prefix. kBusy, kInvalidArgument, kIo as above.
Status begin_move_to_s3(const std::string& data_folder, S3Blobs& s3);
Status end_move_to_s3(const std::string& data_folder);  // all results are in S3

// Returns whether the results are still in S3: true; false: all are in the folder, and were not
// removed from S3 yet. kInvalidArgument: nothing of this folder is there.
Result<bool> is_in_s3(const std::string& data_folder, const S3Blobs& s3);
// All results are in the folder.
Status leave_s3(const std::string& data_folder);
Status give_up_prefix(const std::string& data_folder, S3Blobs& s3);  // no result is left in S3

// Checks that a server may start with these settings on this folder: `address` is that of S3, or
// empty. kInvalidArgument, with a message: the results are somewhere else. `has_results`: there are
// results in the folder itself.
Status check_place(const std::string& data_folder, const std::string& address, bool has_results);

}  // namespace hermite::server
