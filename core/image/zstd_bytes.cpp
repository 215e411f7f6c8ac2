#include "core/image/zstd_bytes.h"

#include <fmt/core.h>
#include <zstd.h>

#include <memory>

namespace hermite::image {

std::string compress_bytes(std::string_view bytes) {
  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(),
                                                                     ZSTD_freeCCtx);
  CHECK(context != nullptr, "zstd has no memory");
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, 1);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  std::string frame(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress2(context.get(), frame.data(), frame.size(), bytes.data(), bytes.size());
  CHECK(!ZSTD_isError(size), std::string("zstd refused to compress: ") + ZSTD_getErrorName(size));
  frame.resize(size);
  return frame;
}

Result<std::string> decompress_bytes(std::string_view frame, std::size_t max_bytes) {
  const auto corrupt = [](const std::string& message) {
    return Error{ErrorCode::kCorruptData, "zstd: " + message};
  };
  const unsigned long long content_bytes = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (content_bytes == ZSTD_CONTENTSIZE_ERROR || content_bytes == ZSTD_CONTENTSIZE_UNKNOWN)
    return corrupt("no frame that states its size");
  if (content_bytes > max_bytes)
    return Error{
        ErrorCode::kTooLarge,
        fmt::format("zstd: the frame states {} bytes, allowed are {}", content_bytes, max_bytes)};
  if (ZSTD_findFrameCompressedSize(frame.data(), frame.size()) != frame.size())
    return corrupt("not exactly one whole frame");
  std::string bytes(static_cast<std::size_t>(content_bytes), '\0');
  const std::size_t size = ZSTD_decompress(bytes.data(), bytes.size(), frame.data(), frame.size());
  if (ZSTD_isError(size)) return corrupt(ZSTD_getErrorName(size));
  if (size != bytes.size()) return corrupt("less than the frame states");
  return bytes;
}

}  // namespace hermite::image
