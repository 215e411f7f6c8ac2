// The messages of both directions, and the images of a frame message. Input: a byte for the
// direction, the bytes of a message.
#include <algorithm>

#include "proto/wire/client_message.h"
#include "proto/wire/frame_payload.h"
#include "proto/wire/server_message.h"

namespace {

using namespace hermite;

constexpr std::size_t kMaxMessage_bytes = 64 * 1024;

Camera small_camera() {
  Camera camera;
  camera.width = 16;
  camera.height = 12;
  camera.fx = camera.fy = 14;
  camera.cx = 7.5;
  camera.cy = 5.5;
  camera.depth_units_per_metre = 1000;
  return camera;
}

void decode_images(const wire::Frame& frame) {
  const Camera camera = small_camera();
  for (const wire::DepthCodec codec : wire::kDepthCodecs) {
    const Result<frame::RgbdFrame> images = wire::decode_frame_payload(frame, codec, camera);
    CHECK(images.ok() || !images.error().message.empty(), "an error without words");
  }
}

std::string sorted(std::string bytes) {
  std::sort(bytes.begin(), bytes.end());
  return bytes;
}

// What parses must be written and parsed again to the same bytes, but for the order of a map's
// entries, which protobuf leaves open: nothing that the rules let through is lost or refused on the
// way.
template <class Message, class Parse, class Format>
void check_fixed_point(const Message& message, const Parse& parse, const Format& format) {
  if (std::holds_alternative<wire::Unknown>(message)) return;
  const std::string once = format(message);
  const Result<Message> again = parse(once);
  CHECK(again.ok(), "a message that was parsed is refused once written: " + again.error().message);
  CHECK(sorted(format(*again)) == sorted(once),
        "a message changes when it is written and parsed again");
}

void client(std::string_view bytes) {
  const auto parse = [](std::string_view text) {
    return wire::parse_client_message(text, kMaxMessage_bytes);
  };
  const Result<wire::ClientMessage> message = parse(bytes);
  if (!message.ok()) {
    CHECK(!message.error().message.empty(), "an error without words");
    return;
  }
  if (const auto* frame = std::get_if<wire::Frame>(&*message)) decode_images(*frame);
  check_fixed_point(*message, parse, wire::format_client_message);
}

void server(std::string_view bytes) {
  const auto parse = [](std::string_view text) {
    return wire::parse_server_message(text, kMaxMessage_bytes);
  };
  const Result<wire::ServerMessage> message = parse(bytes);
  if (!message.ok()) {
    CHECK(!message.error().message.empty(), "an error without words");
    return;
  }
  check_fixed_point(*message, parse, wire::format_server_message);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  if (data[0] % 2 == 0) {
    client(bytes);
  } else {
    server(bytes);
  }
  return 0;
}
