// Field by field between scan.proto and messages.h: what both directions share. Only for the
// sources of proto/wire.
#pragma once

#include <google/protobuf/message.h>

#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"
#include "proto/wire/messages.h"
#include "scan.pb.h"

namespace hermite::wire {

// kTooLarge over `max_bytes`, kCorruptData when protobuf refuses.
Status parse_bytes(std::string_view bytes, std::size_t max_bytes,
                   google::protobuf::Message& message);

// None: one that this version does not know.
std::optional<DepthCodec> depth_codec_from(int number);
std::optional<ColorCodec> color_codec_from(int number);

// kTooLarge naming the field; kInvalidArgument for control characters. UTF-8 was checked by
// protobuf.
Status check_text(const std::string& field, const std::string& text, std::size_t max_bytes);

// As it is: validate(Camera) judges.
Camera camera_from(const v1::Camera& message);
void write_camera(const Camera& camera, v1::Camera& message);

// kInvalidArgument naming the field: not finite, or a quaternion that is not of unit length within
// 1e-3.
Result<Rigid3> rigid3_from(const std::string& field, const v1::Rigid3& message);
Eigen::Vector3d vector3_from(const v1::Vector3& message);  // as it is
void write_vector3(const Eigen::Vector3d& vector, v1::Vector3& message);
void write_rigid3(const Rigid3& transform, v1::Rigid3& message);

}  // namespace hermite::wire
