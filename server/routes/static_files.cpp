#include "server/routes/static_files.h"

#include <fmt/core.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

namespace hermite::server {

namespace {

namespace fs = std::filesystem;

bool plain_name(const std::string& path) {
  return path.find_first_not_of(
             "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-/") ==
             std::string::npos &&
         path.find("..") == std::string::npos;
}

bool readable(const fs::directory_entry& entry) {
  std::error_code error;
  return fs::is_regular_file(entry.symlink_status(error)) && !error;
}

}  // namespace

std::string content_type_of(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 15> kTypes = {{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".mjs", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".wasm", "application/wasm"},
      {".json", "application/json"},
      {".map", "application/json"},
      {".webmanifest", "application/manifest+json"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".jpg", "image/jpeg"},
      {".ico", "image/x-icon"},
      {".woff2", "font/woff2"},
      {".txt", "text/plain; charset=utf-8"},
      {".ply", "application/octet-stream"},
  }};
  for (const auto& [ending, type] : kTypes)
    if (name.size() > ending.size() && name.substr(name.size() - ending.size()) == ending)
      return std::string(type);
  return "application/octet-stream";
}

Result<StaticFiles> read_static_files(const std::string& folder) {
  std::error_code error;
  StaticFiles files;
  std::size_t total_bytes = 0;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().lexically_relative(folder).generic_string();
    if (!readable(*entry) || !plain_name(name)) continue;
    std::ifstream stream(entry->path(), std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    if (!stream) return Error{ErrorCode::kIo, "reading " + entry->path().string()};
    total_bytes += bytes.size();
    if (files.size() >= kMaxStaticFiles || total_bytes > kMaxStaticBytes)
      return Error{ErrorCode::kTooLarge, fmt::format("{} holds more than {} files or {} bytes",
                                                     folder, kMaxStaticFiles, kMaxStaticBytes)};
    files["/" + name] = {content_type_of(name), name.rfind("assets/", 0) == 0, std::move(bytes)};
  }
  if (error)
    return Error{ErrorCode::kNotFound,
                 fmt::format("reading the folder {}: {}", folder, error.message())};
  const auto index = files.find("/index.html");
  if (index == files.end())
    return Error{ErrorCode::kNotFound, "there is no index.html in " + folder};
  files["/"] = index->second;
  return files;
}

}  // namespace hermite::server
