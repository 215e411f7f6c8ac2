#include "server/connections/sessions.h"

namespace hermite::server {

CloseCode close_code_of(const Error& error) {
  switch (error.code) {
    case ErrorCode::kCorruptData: return CloseCode::kCorrupt;
    case ErrorCode::kTooLarge: return CloseCode::kTooBig;
    case ErrorCode::kUnauthorized: return CloseCode::kUnauthorized;
    case ErrorCode::kNotFound: return CloseCode::kNoSuchScan;
    case ErrorCode::kBusy: return CloseCode::kBusy;
    case ErrorCode::kInvalidArgument:
    case ErrorCode::kUnsupported: return CloseCode::kProtocolError;
    case ErrorCode::kIo:
    case ErrorCode::kUnavailable:
    case ErrorCode::kDevice: return CloseCode::kInternal;
  }
  return CloseCode::kInternal;
}

}  // namespace hermite::server
