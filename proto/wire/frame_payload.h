// The images of a Frame message: encoded by the client, decoded by the server with the decoders
// that also read files. Pure and thread-safe.
#pragma once

#include <vector>

#include "core/base/result.h"
#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"
#include "proto/wire/messages.h"

namespace hermite::wire {

// Enough for any frame a camera can give: depth of noise (RVL: 3 bytes a pixel, ranks: less than 4)
// and colour as a PNG of noise (3 bytes a pixel), and some room.
std::size_t max_frame_message_bytes(const Camera& camera);

// Both images must have the camera's size; nothing larger is ever allocated. Takes the frame's time
// as it is. Errors name the image ("frame.depth: ..."): kCorruptData, kTooLarge, kUnsupported.
Result<frame::RgbdFrame> decode_frame_payload(const Frame& frame, DepthCodec depth_codec,
                                              const Camera& camera);

// The depth alone, of the camera's size. kCorruptData, kTooLarge, kUnsupported.
Result<DepthImage> decode_depth_payload(const std::string& payload, DepthCodec depth_codec,
                                        const Camera& camera);

// `depth` in sensor units, encoded losslessly.
Result<std::string> encode_depth_payload(const DepthImage& depth, DepthCodec depth_codec);

// What the pipeline gets for a frame whose images cannot be used: no depth and black, so that every
// frame has its line in the trajectory.
frame::RgbdFrame empty_frame(double timestamp_s, const Camera& camera);

}  // namespace hermite::wire
