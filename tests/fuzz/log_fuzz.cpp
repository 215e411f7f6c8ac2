// Frame logs. Input: the bytes of a first segment, and behind every 0xff 0x00 0xff 0x00 those of
// the next.
//
// A record with a wrong checksum ends a log, so the mutator corrects the checksums of what it
// changed.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <vector>

#include "core/archive/fresh_folder.h"
#include "core/log/frame_log.h"
#include "tests/fuzz/recording_file.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

using namespace hermite;
namespace fs = std::filesystem;

constexpr std::uint8_t kNextSegment[] = {0xff, 0x00, 0xff, 0x00};

std::vector<std::span<std::uint8_t>> segments_of(std::span<std::uint8_t> bytes) {
  std::vector<std::span<std::uint8_t>> segments;
  for (;;) {
    const auto end =
        std::search(bytes.begin(), bytes.end(), std::begin(kNextSegment), std::end(kNextSegment));
    segments.push_back(bytes.first(static_cast<std::size_t>(end - bytes.begin())));
    if (end == bytes.end()) return segments;
    bytes = bytes.subspan(segments.back().size() + sizeof kNextSegment);
  }
}

// Corrects the checksum of each record as far as one follows another: it takes 4 bytes behind 4 of
// magic, then comes what it is of, the length first.
void correct_checksums(std::span<std::uint8_t> segment) {
  std::size_t at = frame_log::kSegmentHeaderBytes;
  while (at + frame_log::kRecordHeaderBytes <= segment.size()) {
    std::uint32_t length = 0;
    std::memcpy(&length, &segment[at + 8], sizeof length);
    const std::size_t record_bytes = frame_log::kRecordHeaderBytes + length;
    if (length > frame_log::kMaxRecordBytes || record_bytes > segment.size() - at) return;
    const std::uint32_t crc =
        frame_log::crc32c({reinterpret_cast<const char*>(&segment[at + 8]), record_bytes - 8});
    std::memcpy(&segment[at + 4], &crc, sizeof crc);
    at += record_bytes;
  }
}

struct Record {
  frame_log::RecordType type;
  std::string payload;
  bool operator==(const Record&) const = default;
};

// All that can be read, and that the reader keeps its promises on the way.
std::vector<Record> read_all(const std::string& folder) {
  frame_log::FrameLogReader reader(folder);
  std::vector<Record> records;
  for (;;) {
    const auto record = reader.next();
    CHECK(record.ok(), "a folder with a segment cannot be read");
    if (!*record) break;
    CHECK((*record)->number == records.size(), "a record is missing");
    records.push_back({(*record)->type, (*record)->payload});
  }
  CHECK(reader.end().record_count == records.size(), "the end is elsewhere");
  const std::string last = folder + "/" + frame_log::segment_name(reader.end().segment);
  CHECK(reader.end().offset <= fs::file_size(last), "the end is outside the file");
  return records;
}

void write_segments(const std::string& folder, std::span<std::uint8_t> bytes) {
  fs::remove_all(folder);
  fs::create_directory(folder);
  std::uint32_t number = 0;
  for (const std::span<std::uint8_t> segment : segments_of(bytes)) {
    std::ofstream file(folder + "/" + frame_log::segment_name(number++), std::ios::binary);
    file.write(reinterpret_cast<const char*>(segment.data()),
               static_cast<std::streamsize>(segment.size()));
  }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  const std::size_t new_size = LLVMFuzzerMutate(data, size, max_size);
  if (seed % 8 != 0)
    for (const std::span<std::uint8_t> segment : segments_of({data, new_size}))
      correct_checksums(segment);
  return new_size;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const archive::TemporaryFolder folder = [] {
    Result<archive::TemporaryFolder> made = archive::TemporaryFolder::make();
    CHECK(made.ok(), "no temporary folder");
    return *std::move(made);
  }();
  const std::string log = folder.path() + "/log";
  std::vector<std::uint8_t> bytes(data, data + size);
  write_segments(log, bytes);
  const std::vector<Record> records = read_all(log);
  fuzz::check_recording(dataset::open_frame_log(log, std::nullopt));

  // Opening for writing cuts what cannot be read, and nothing else.
  frame_log::FrameLogOptions options;
  options.sync = [](int) { return 0; };  // the disk is not what is looked at
  const auto opened =
      frame_log::FrameLog::open(log, {[](std::uint64_t) {}, [](const Error&) {}}, options);
  CHECK(opened.ok() || !opened.error().message.empty(), "an error without words");
  if (opened.ok())
    CHECK(opened->contents.record_count == records.size() && read_all(log) == records,
          "the cut took good records");
  return 0;
}
