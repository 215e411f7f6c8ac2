// Archives made by hand, also such as no program makes. Header only.
#pragma once

#include <zlib.h>
#include <zstd.h>

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

namespace hermite::test {

struct ArchiveEntry {
  std::string name;
  std::string data{};
  // Type of an entry of a tar: 0 file, 1 hard link, 2 symbolic link, 3 and 4 devices, 5 folder, 6
  // FIFO.
  char type = '0';
  std::string link{};                         // of tar
  std::optional<std::uint64_t> says_bytes{};  // another size than there is
  std::uint32_t mode = 0100644;               // of zip
};

inline std::string tar_header(const ArchiveEntry& entry) {
  std::string header(512, '\0');
  const auto put = [&](std::size_t at, std::size_t size, const std::string& text) {
    std::memcpy(header.data() + at, text.data(), std::min(size, text.size()));
  };
  char size[16];
  std::snprintf(size, sizeof size, "%011llo",
                static_cast<unsigned long long>(entry.says_bytes.value_or(entry.data.size())));
  put(0, 100, entry.name);
  put(100, 8, "0000644");
  put(108, 8, "0000000");
  put(116, 8, "0000000");
  put(124, 12, size);
  put(136, 12, "00000000000");
  put(148, 8, "        ");
  put(156, 1, std::string(1, entry.type));
  put(157, 100, entry.link);
  put(257, 8, std::string("ustar\00000", 8));
  unsigned sum = 0;
  for (const char byte : header) sum += static_cast<unsigned char>(byte);
  char checksum[8];
  std::snprintf(checksum, sizeof checksum, "%06o", sum & 0777777u);
  put(148, 7, std::string(checksum, 7));
  return header;
}

inline std::string tar_bytes(const std::vector<ArchiveEntry>& entries) {
  std::string bytes;
  for (const ArchiveEntry& entry : entries) {
    bytes += tar_header(entry) + entry.data;
    bytes.resize((bytes.size() + 511) / 512 * 512, '\0');
  }
  return bytes + std::string(1024, '\0');
}

inline std::string zstd_bytes(const std::string& bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 1));
  return packed;
}

// A raw deflate stream, or gzip.
inline std::string deflate_bytes_of(const std::string& bytes, bool gzip) {
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, gzip ? 31 : -15, 8, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

inline std::string gzip_bytes(const std::string& bytes) { return deflate_bytes_of(bytes, true); }

inline std::string little(std::uint64_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i));
  return text;
}

// Deflated entries and the directory at the end.
inline std::string zip_bytes(const std::vector<ArchiveEntry>& entries) {
  std::string bytes, directory;
  for (const ArchiveEntry& entry : entries) {
    const std::string packed = deflate_bytes_of(entry.data, false);
    const auto crc = crc32(0, reinterpret_cast<const Bytef*>(entry.data.data()),
                           static_cast<uInt>(entry.data.size()));
    // Version, flags, method, time, date, checksum, sizes, lengths of name and extra field.
    const std::string common = little(20, 2) + little(0, 2) + little(8, 2) + little(0, 4) +
                               little(crc, 4) + little(packed.size(), 4) +
                               little(entry.says_bytes.value_or(entry.data.size()), 4) +
                               little(entry.name.size(), 2) + little(0, 2);
    directory += "PK\1\2" + little(0x0314, 2) + common + little(0, 2) + little(0, 4) +
                 little(std::uint64_t{entry.mode} << 16, 4) + little(bytes.size(), 4) + entry.name;
    bytes += "PK\3\4" + common + entry.name + packed;
  }
  const std::string counts = little(entries.size(), 2) + little(entries.size(), 2);
  return bytes + directory + "PK\5\6" + little(0, 4) + counts + little(directory.size(), 4) +
         little(bytes.size(), 4) + little(0, 2);
}

}  // namespace hermite::test
