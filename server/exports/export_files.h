// The files of an export among the blobs of its scan, and those that it is made from. Blocking; any
// thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/output/named_file.h"
#include "server/exports/export_offer.h"
#include "server/exports/export_spec.h"
#include "server/store/blobs.h"

namespace hermite::server {

// Returns the blobs that a format can be made from; the first one that exists is used.
std::vector<std::string> sources_of(const ExportOffer& format);

// Returns the size of the blob that the format is made from. kNotFound: the scan has none of them;
// kIo.
Result<std::uint64_t> source_bytes(Blobs& blobs, const std::string& scan_id,
                                   const ExportOffer& format);

// Puts the files of an export. The mark that a comparison leaves with the second scan is put first,
// so that no comparison is without one. Errors as of Blobs::put().
Status put_export(Blobs& blobs, const std::string& scan_id, const ExportSpec& spec,
                  const output::NamedFiles& files);

// Removes the files of an export, and the mark of a comparison; the file that says that it is ready
// goes first. Errors as of Blobs::remove().
Status remove_export(Blobs& blobs, const std::string& scan_id, const ExportSpec& spec);

}  // namespace hermite::server
