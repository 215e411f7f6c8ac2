#include "tests/every_call/power_cut.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "core/digest/sha256.h"

namespace hermite::test {

namespace {

namespace fs = std::filesystem;

// Whatever it is called by now.
std::string path_of(int descriptor) { return "/proc/self/fd/" + std::to_string(descriptor); }

std::string bytes_of(int descriptor) {
  std::ifstream file(path_of(descriptor), std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::string digest_of(const DiskImage& image) {
  std::string text;
  for (const std::string& folder : image.folders) text += folder + '\n';
  for (const auto& [path, bytes] : image.files)
    text += path + ' ' + digest::sha256_hex(bytes) + '\n';
  for (const auto& [what, amount] : image.acknowledged)
    text += what + ' ' + std::to_string(amount) + '\n';
  return digest::sha256_hex(text);
}

}  // namespace

void DiskImage::restore_into(const std::string& folder) const {
  for (const std::string& name : folders) {
    fs::create_directory(folder + "/" + name);
    fs::permissions(folder + "/" + name, fs::perms::owner_all);
  }
  for (const auto& [name, bytes] : files) {
    std::ofstream(folder + "/" + name, std::ios::binary) << bytes;
    fs::permissions(folder + "/" + name, fs::perms::owner_read | fs::perms::owner_write);
  }
}

PowerCut::PowerCut(const std::string& folder) : folder_(folder) {
  root_ = meet(folder_);
  meet_all_in(folder_);
  for (auto& [inode, file] : files_) {
    if (file.is_folder)
      file.synced_entries = entries_of(path_of(file.descriptor));
    else
      file.synced = bytes_of(file.descriptor);
  }
  watch();
}

PowerCut::~PowerCut() {
  unwatch();
  for (const auto& [inode, file] : files_) close(file.descriptor);
}

void PowerCut::acknowledge(const std::string& what, std::int64_t amount) {
  const std::lock_guard lock(mutex_);
  acknowledged_[what] = amount;
}

int PowerCut::before(const DiskCall& call) {
  const std::lock_guard lock(mutex_);
  take_images("before " + std::string(call.name) + " " + std::to_string(call_count_++));
  return 0;
}

void PowerCut::synced(int descriptor) {
  const std::lock_guard lock(mutex_);
  meet_all_in(folder_);
  struct stat status {};
  if (fstat(descriptor, &status) != 0) throw std::runtime_error("what was synced is not there");
  const auto found = files_.find(status.st_ino);
  if (found == files_.end()) return;  // somewhere else
  if (found->second.is_folder)
    found->second.synced_entries = entries_of(path_of(descriptor));
  else
    found->second.synced = bytes_of(found->second.descriptor);
}

// Its inode; 0: it is gone.
ino_t PowerCut::meet(const std::string& path) {
  const int descriptor = open(path.c_str(), O_PATH | O_NOFOLLOW | O_CLOEXEC);
  struct stat status {};
  if (descriptor < 0 || fstat(descriptor, &status) != 0) return 0;
  const auto [file, is_new] = files_.try_emplace(status.st_ino);
  if (is_new) {
    file->second.descriptor = descriptor;
    file->second.is_folder = S_ISDIR(status.st_mode);
  } else {
    close(descriptor);
  }
  return status.st_ino;
}

void PowerCut::meet_all_in(const std::string& path) {
  for (const auto& [name, inode] : entries_of(path))
    if (files_[inode].is_folder) meet_all_in(path + "/" + name);
}

std::map<std::string, ino_t> PowerCut::entries_of(const std::string& path) {
  std::map<std::string, ino_t> entries;
  std::error_code error;
  for (fs::directory_iterator entry(path, error), end; !error && entry != end;
       entry.increment(error))
    if (const ino_t inode = meet(entry->path()); inode != 0)
      entries[entry->path().filename()] = inode;
  return entries;
}

std::string PowerCut::contents(const File& file, Loss loss) {
  if (loss == Loss::kSynced) return file.synced;
  std::string now = bytes_of(file.descriptor);
  if (loss == Loss::kAll) return now;
  const std::string& old = file.synced;
  // A cut is as a name: it is there, or it is not.
  if (now.size() < old.size()) return loss == Loss::kHalf ? now : old;
  const std::size_t same = static_cast<std::size_t>(
      std::mismatch(old.begin(), old.end(), now.begin()).first - old.begin());
  std::size_t end = now.size();  // of what has changed
  while (end > same && end <= old.size() && old[end - 1] == now[end - 1]) --end;
  const std::size_t kept = loss == Loss::kHalf ? same + (end - same) / 2 : same;
  for (std::size_t i = kept; i < now.size(); ++i) now[i] = i < old.size() ? old[i] : '\0';
  if (loss == Loss::kHalf) now.resize(std::max(kept, old.size()));
  return now;
}

void PowerCut::fill_image(DiskImage& into, Loss loss, ino_t folder, const std::string& relative) {
  const File& here = files_.at(folder);
  std::map<std::string, ino_t> entries = here.synced_entries;
  if (loss != Loss::kSynced) entries = entries_of(path_of(here.descriptor));
  for (const auto& [name, inode] : entries) {
    const File& file = files_.at(inode);
    const std::string path = relative.empty() ? name : relative + "/" + name;
    if (!file.is_folder) {
      into.files[path] = contents(file, loss);
    } else {
      into.folders.insert(path);
      fill_image(into, loss, inode, path);
    }
  }
}

void PowerCut::take_images(const std::string& when) {
  meet_all_in(folder_);
  for (const auto& [loss, loss_name] :
       {std::pair(Loss::kSynced, "synced"), std::pair(Loss::kNames, "names"),
        std::pair(Loss::kHalf, "half"), std::pair(Loss::kAll, "all")}) {
    DiskImage taken{when + ", " + loss_name, {}, {}, acknowledged_};
    fill_image(taken, loss, root_, "");
    if (seen_.insert(digest_of(taken)).second) images_.push_back(std::move(taken));
  }
}

std::vector<DiskImage> PowerCut::end() {
  unwatch();
  const std::lock_guard lock(mutex_);
  take_images("at the end");
  return std::move(images_);
}

}  // namespace hermite::test
