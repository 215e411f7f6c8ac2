// A folder that is there as a whole or not at all: it grows under another name beside its place and
// moves there when it is complete.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/archive/fresh_folder.h"

namespace hermite::archive {

// One thread. Movable. What was not finished goes with its owner.
class WholeFolder {
 public:
  // kInvalidArgument: there is something at `path` already, but for an empty folder; kNotFound:
  // what is to hold it is not there; kIo.
  static Result<WholeFolder> make(const std::string& path);
  ~WholeFolder();
  WholeFolder(WholeFolder&& other) noexcept;
  WholeFolder& operator=(WholeFolder&&) = delete;

  // A new file. The parts are names of ours, at least one (CHECK): folders, then the file. kIo,
  // naming the file.
  Status write(const std::vector<std::string>& parts, std::span<const std::uint8_t> bytes) const;
  Status write(const std::vector<std::string>& parts, const std::string& bytes) const;

  // Brings the folder to the disk, and then to its place. Afterwards nothing can be written. kIo;
  // kInvalidArgument: something came there in the meantime.
  Status finish();

 private:
  WholeFolder(std::string path, std::string growing, FreshFolder folder);

  std::string path_, growing_;  // growing_ is empty once it is finished
  FreshFolder folder_;
};

}  // namespace hermite::archive
