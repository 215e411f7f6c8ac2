#include "core/dataset/oni_file.h"

#include <fmt/core.h>

#include <array>
#include <cstring>
#include <tuple>

#include "core/dataset/frame_file.h"

namespace hermite::dataset {
namespace {

constexpr std::array<char, 4> kFileMagic{'N', 'I', '1', '0'};
constexpr std::uint32_t kRecordMagic = 0x0052494e;  // "NIR\0"
constexpr std::int64_t kMaxName_bytes = 256;        // OpenNI2's own limit
// The longest property is a table with a value for each depth, 20 kB.
constexpr std::int64_t kMaxFields_bytes = 1 << 20;
constexpr std::uint32_t kDepthKind = 2, kColorKind = 3;

enum RecordType : std::uint32_t {
  kNodeAddedBefore5 = 0x02,
  kIntegerProperty = 0x03,
  kGeneralProperty = 0x06,
  kImage = 0x0a,
  kEnd = 0x0b,
  kNodeAddedBefore6 = 0x0c,
  kNodeAdded = 0x0d,
};

struct Version {
  std::uint8_t major = 0, minor = 0;
  std::uint16_t maintenance = 0;
  std::uint32_t build = 0;
  auto order() const { return std::tuple(major, minor, maintenance, build); }
};
const Version kOldest{1, 0, 0, 4}, kFirstWithLongPositions{1, 0, 1, 0};

struct FileHeader {
  std::array<char, 4> magic;
  Version version;
  std::uint32_t greatest_stamp[2];  // 64 bits, but not aligned to them
  std::uint32_t greatest_node;
};
static_assert(sizeof(FileHeader) == 24, "as it lies in the file");

struct RecordHeader {
  std::uint32_t magic, type, node, fields_bytes, payload_bytes;
};

std::string text_of(const Version& version) {
  return fmt::format("{}.{}.{}.{}", version.major, version.minor, version.maintenance,
                     version.build);
}

class Walk {
 public:
  Walk(const ByteFile& file, OniFile& contents) : file_(file), fields_(file), contents_(contents) {}

  Status read_header() {
    const auto header = fields_.read<FileHeader>("file header");
    if (!header.ok()) return header.error();
    if (header->magic != kFileMagic)
      return fields_.error("file header", "does not begin with NI10");
    contents_.version = text_of(header->version);
    if (header->version.order() < kOldest.order() || header->version.major > 1)
      return Error{
          ErrorCode::kUnsupported,
          fmt::format("the file has version {}, 1.0.0.4 to 1.x are read", contents_.version)};
    undo_bytes_ = header->version.order() < kFirstWithLongPositions.order() ? 4 : 8;
    return Done{};
  }

  // Returns false at the end record.
  Result<bool> read_record() {
    const std::uint64_t start = fields_.offset();
    const auto header = fields_.read<RecordHeader>("record header");
    if (!header.ok()) return header.error();
    if (header->magic != kRecordMagic)
      return fields_.error("record header", "does not begin with NIR");
    const std::int64_t header_bytes = static_cast<std::int64_t>(sizeof(RecordHeader)) + undo_bytes_;
    if (header->fields_bytes < header_bytes || header->fields_bytes > kMaxFields_bytes)
      return fields_.error("bytes of fields",
                           fmt::format("are {}, allowed is {} to {}", header->fields_bytes,
                                       header_bytes, kMaxFields_bytes));
    const auto undo = fields_.skip("record header", undo_bytes_, undo_bytes_, undo_bytes_);
    if (!undo.ok()) return undo.error();
    const std::uint64_t fields_end = start + header->fields_bytes;
    if (Status status = read_fields(*header); !status.ok()) return status.error();
    if (fields_.offset() > fields_end)
      return fields_.error("bytes of fields",
                           fmt::format("are {}, too few for what they hold", header->fields_bytes));
    if (auto rest = skip("bytes of fields", fields_end - fields_.offset()); !rest.ok())
      return rest.error();
    const auto payload = skip("bytes of payload", header->payload_bytes);
    if (!payload.ok()) return payload.error();
    if (header->type == kImage)
      if (Status status = add_image(header->node, *payload); !status.ok()) return status.error();
    return header->type != kEnd;
  }

 private:
  Result<FilePart> skip(const char* length_field, std::uint64_t bytes) {
    return fields_.skip(length_field, static_cast<std::int64_t>(bytes), 0, INT64_MAX);
  }

  Status read_fields(const RecordHeader& header) {
    switch (header.type) {
      case kNodeAddedBefore5:
      case kNodeAddedBefore6:
      case kNodeAdded: return read_node(header.node);
      case kIntegerProperty:
      case kGeneralProperty: return read_property(header.node);
      case kImage: return read_stamp();
      default: return Done{};
    }
  }

  Result<std::string> read_string(const char* length_field) {
    const auto length = fields_.read<std::uint32_t>(length_field);
    if (!length.ok()) return length.error();
    const auto part = fields_.skip(length_field, *length, 0, kMaxName_bytes);
    if (!part.ok()) return part.error();
    const auto bytes = file_.read(*part);
    if (!bytes.ok()) return bytes.error();
    std::string text(bytes->begin(), bytes->end());
    return text.substr(0, text.find('\0'));
  }

  Status read_node(std::uint32_t node) {
    const auto name = read_string("bytes of a node's name");
    if (!name.ok()) return name.error();
    const auto kind = fields_.read<std::uint32_t>("kind of node");
    if (!kind.ok()) return kind.error();
    const auto codec = fields_.read<std::array<char, 4>>("codec");
    if (!codec.ok()) return codec.error();
    if (*kind != kDepthKind && *kind != kColorKind) return Done{};
    std::optional<OniStream>& stream = *kind == kDepthKind ? contents_.depth : contents_.color;
    if (stream) return Done{};
    stream.emplace();
    stream->node = node;
    stream->codec.assign(codec->begin(), codec->end());
    return Done{};
  }

  OniStream* find(std::uint32_t node) {
    for (std::optional<OniStream>* stream : {&contents_.depth, &contents_.color})
      if (*stream && (*stream)->node == node) return &**stream;
    return nullptr;
  }

  // Properties that are not used here, or have an unexpected length, are skipped.
  Status read_property(std::uint32_t node) {
    const auto name = read_string("bytes of a property's name");
    if (!name.ok()) return name.error();
    const auto length = fields_.read<std::uint32_t>("bytes of a property");
    if (!length.ok()) return length.error();
    const auto part = fields_.skip("bytes of a property", *length, 0, kMaxFields_bytes);
    if (!part.ok()) return part.error();
    OniStream* const stream = find(node);
    if (!stream) return Done{};
    const auto bytes = file_.read(*part);
    if (!bytes.ok()) return bytes.error();
    const auto take = [&bytes](auto& value) {
      if (bytes->size() != sizeof value) return false;
      std::memcpy(&value, bytes->data(), sizeof value);
      return true;
    };
    std::int64_t number = 0;
    std::array<std::int32_t, 3> mode{};  // width, height, frames per second
    if (*name == "xnMapOutputMode" && take(mode)) {
      stream->size = {mode[0], mode[1]};
      stream->frame_rate_hz = mode[2];
    }
    if (*name == "xnFOV") take(stream->view_rad);
    if (*name == "oniPixelFormat" && take(number)) stream->oni_pixel_format = number;
    if (*name == "xnPixelFormat" && take(number)) stream->pixel_format = number;
    if (*name == "xnMirror" && take(number)) stream->is_mirrored = number != 0;
    // The first element says whether it is on, as one byte or as four.
    if (*name == "xnCropping" && !bytes->empty()) stream->is_cropped = bytes->front() != 0;
    return Done{};
  }

  Status read_stamp() {
    const auto stamp = fields_.read<std::uint64_t>("time stamp");
    if (!stamp.ok()) return stamp.error();
    stamp_us_ = *stamp;
    return Done{};
  }

  Status add_image(std::uint32_t node, const FilePart& payload) {
    OniStream* const stream = find(node);
    if (!stream) return Done{};
    if (static_cast<std::int64_t>(stream->images.size()) >= kMaxFileFrames)
      return Error{ErrorCode::kTooLarge,
                   fmt::format("more than {} images of one stream", kMaxFileFrames)};
    const bool is_depth = contents_.depth && stream == &*contents_.depth;
    const std::int64_t limit_bytes = is_depth ? kMaxDepthPart_bytes : kMaxColorPart_bytes;
    if (payload.bytes > static_cast<std::uint64_t>(limit_bytes))
      return fields_.error("bytes of payload",
                           fmt::format("are {}, an image may have {}", payload.bytes, limit_bytes));
    const std::optional<OniStream>& other = is_depth ? contents_.color : contents_.depth;
    stream->images.push_back(
        {stamp_us_, other ? static_cast<std::int64_t>(other->images.size()) : 0, payload});
    return Done{};
  }

  const ByteFile& file_;
  FieldReader fields_;
  OniFile& contents_;
  std::int64_t undo_bytes_ = 8;
  std::uint64_t stamp_us_ = 0;
};

}  // namespace

bool looks_like_oni(const ByteFile& file) {
  std::array<char, 4> start{};
  return file.read_into(0, start.data(), start.size()).ok() && start == kFileMagic;
}

Result<OniFile> read_oni_file(const ByteFile& file) {
  OniFile contents;
  Walk walk(file, contents);
  if (Status status = walk.read_header(); !status.ok()) return status.error();
  for (;;) {
    const Result<bool> more = walk.read_record();
    if (more.ok() && *more) continue;
    if (more.ok()) return contents;
    const bool can_be_used = more.error().code == ErrorCode::kCorruptData && contents.depth &&
                             !contents.depth->images.empty();
    if (!can_be_used) return more.error();
    contents.cut = more.error().message;
    return contents;
  }
}

}  // namespace hermite::dataset
