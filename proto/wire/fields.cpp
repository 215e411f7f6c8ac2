#include "proto/wire/fields.h"

#include <fmt/core.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/wire_format_lite.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hermite::wire {

namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::internal::WireFormatLite;
using google::protobuf::io::CodedInputStream;

// Whether every length stated in a message of `type` ends inside that message. Protobuf 3.21 finds
// out only after it has reserved up to 50 MB for a string that ends nowhere. Types of this protocol
// do not nest in themselves: the recursion is bounded by scan.proto.
bool lengths_fit(CodedInputStream& input, const Descriptor& type) {
  while (const std::uint32_t tag = input.ReadTag()) {
    std::uint64_t ignored = 0;
    std::uint32_t ignored_32 = 0, length = 0;
    bool fits = false;
    switch (WireFormatLite::GetTagWireType(tag)) {
      case WireFormatLite::WIRETYPE_VARINT: fits = input.ReadVarint64(&ignored); break;
      case WireFormatLite::WIRETYPE_FIXED64: fits = input.ReadLittleEndian64(&ignored); break;
      case WireFormatLite::WIRETYPE_FIXED32: fits = input.ReadLittleEndian32(&ignored_32); break;
      case WireFormatLite::WIRETYPE_LENGTH_DELIMITED: {
        if (!input.ReadVarint32(&length) ||
            length > static_cast<std::uint32_t>(input.BytesUntilLimit()))
          return false;
        const FieldDescriptor* field =
            type.FindFieldByNumber(WireFormatLite::GetTagFieldNumber(tag));
        const Descriptor* nested = field == nullptr ? nullptr : field->message_type();
        const CodedInputStream::Limit outer = input.PushLimit(static_cast<int>(length));
        fits =
            nested != nullptr ? lengths_fit(input, *nested) : input.Skip(static_cast<int>(length));
        input.PopLimit(outer);
        break;
      }
      default: break;  // groups: proto3 has none
    }
    if (!fits) return false;
  }
  return input.BytesUntilLimit() == 0;
}

bool parse(std::string_view bytes, google::protobuf::Message& message) {
  const int size = static_cast<int>(bytes.size());
  CodedInputStream input(reinterpret_cast<const std::uint8_t*>(bytes.data()), size);
  input.PushLimit(size);
  return lengths_fit(input, *message.GetDescriptor()) && message.ParseFromArray(bytes.data(), size);
}

template <class Message>
Distortion distortion_from(const Message& message) {
  return {message.k1(), message.k2(), message.p1(), message.p2(), message.k3()};
}

template <class Message>
void write_distortion(const Distortion& distortion, Message& message) {
  message.set_k1(distortion.k1);
  message.set_k2(distortion.k2);
  message.set_p1(distortion.p1);
  message.set_p2(distortion.p2);
  message.set_k3(distortion.k3);
}

Rigid3 unchecked(const v1::Rigid3& message) {
  return {Eigen::Quaterniond(message.qw(), message.qx(), message.qy(), message.qz()),
          {message.tx(), message.ty(), message.tz()}};
}

}  // namespace

Status parse_bytes(std::string_view bytes, std::size_t max_bytes,
                   google::protobuf::Message& message) {
  // Protobuf's own lengths are int: the cap keeps the cast below whole whatever the caller allows.
  const std::size_t limit = std::min<std::size_t>(max_bytes, std::numeric_limits<int>::max());
  if (bytes.size() > limit)
    return Error{ErrorCode::kTooLarge,
                 fmt::format("message of {} bytes, allowed are {}", bytes.size(), limit)};
  if (!parse(bytes, message))
    return Error{ErrorCode::kCorruptData,
                 fmt::format("these {} bytes are not a message of the protocol {} (cut, damaged, "
                             "or text that is not UTF-8)",
                             bytes.size(), kSubprotocol)};
  return Done{};
}

std::optional<DepthCodec> depth_codec_from(int number) {
  for (const DepthCodec codec : kDepthCodecs)
    if (number == static_cast<int>(codec)) return codec;
  return std::nullopt;
}

std::optional<ColorCodec> color_codec_from(int number) {
  for (const ColorCodec codec : {ColorCodec::kJpeg, ColorCodec::kPng})
    if (number == static_cast<int>(codec)) return codec;
  return std::nullopt;
}

Status check_text(const std::string& field, const std::string& text, std::size_t max_bytes) {
  if (text.size() > max_bytes)
    return Error{ErrorCode::kTooLarge,
                 fmt::format("{} has {} bytes, allowed are {}", field, text.size(), max_bytes)};
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (std::any_of(text.begin(), text.end(), is_control))
    return Error{ErrorCode::kInvalidArgument,
                 field + " holds a control character; allowed is printable UTF-8"};
  return Done{};
}

Camera camera_from(const v1::Camera& message) {
  // A size beyond int is clamped and then refused by validate() as any other size that is too
  // large.
  const auto side = [](std::uint32_t px) {
    return static_cast<int>(std::min<std::uint32_t>(px, std::numeric_limits<int>::max()));
  };
  Camera camera;
  camera.width = side(message.width());
  camera.height = side(message.height());
  camera.fx = message.fx();
  camera.fy = message.fy();
  camera.cx = message.cx();
  camera.cy = message.cy();
  camera.depth_units_per_metre = message.depth_units_per_metre();
  camera.distortion = distortion_from(message);
  camera.depth_correction = {message.depth_bend(), message.depth_inverse_offset_per_m()};
  camera.timing = {message.depth_readout_s(), message.color_readout_s(), message.color_delay_s()};
  camera.deviations = {message.bend_deviation(), message.focal_deviation(), message.k1_deviation()};
  if (!message.has_color()) return camera;
  const v1::ColorCamera& color = message.color();
  camera.color = ColorCamera{color.fx(),
                             color.fy(),
                             color.cx(),
                             color.cy(),
                             distortion_from(color),
                             unchecked(color.color_from_depth())};
  return camera;
}

void write_camera(const Camera& camera, v1::Camera& message) {
  message.set_width(static_cast<std::uint32_t>(camera.width));
  message.set_height(static_cast<std::uint32_t>(camera.height));
  message.set_fx(camera.fx);
  message.set_fy(camera.fy);
  message.set_cx(camera.cx);
  message.set_cy(camera.cy);
  message.set_depth_units_per_metre(camera.depth_units_per_metre);
  write_distortion(camera.distortion, message);
  message.set_depth_bend(camera.depth_correction.bend);
  message.set_depth_inverse_offset_per_m(camera.depth_correction.inverse_offset_per_m);
  message.set_depth_readout_s(camera.timing.depth_readout_s);
  message.set_color_readout_s(camera.timing.color_readout_s);
  message.set_color_delay_s(camera.timing.color_delay_s);
  message.set_bend_deviation(camera.deviations.bend);
  message.set_focal_deviation(camera.deviations.focal);
  message.set_k1_deviation(camera.deviations.k1);
  if (!camera.color) return;
  v1::ColorCamera& color = *message.mutable_color();
  color.set_fx(camera.color->fx);
  color.set_fy(camera.color->fy);
  color.set_cx(camera.color->cx);
  color.set_cy(camera.color->cy);
  write_distortion(camera.color->distortion, color);
  write_rigid3(camera.color->color_from_depth, *color.mutable_color_from_depth());
}

Result<Rigid3> rigid3_from(const std::string& field, const v1::Rigid3& message) {
  const Rigid3 transform = unchecked(message);
  const double norm = transform.rotation.norm();
  if (!transform.translation.allFinite() || !std::isfinite(norm))
    return Error{ErrorCode::kInvalidArgument, field + " is not finite"};
  if (std::abs(norm - 1) > 1e-3)
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{} has a quaternion of length {:f}, it must be 1", field, norm)};
  return transform;
}

Eigen::Vector3d vector3_from(const v1::Vector3& message) {
  return {message.x(), message.y(), message.z()};
}

void write_vector3(const Eigen::Vector3d& vector, v1::Vector3& message) {
  message.set_x(vector.x());
  message.set_y(vector.y());
  message.set_z(vector.z());
}

void write_rigid3(const Rigid3& transform, v1::Rigid3& message) {
  message.set_tx(transform.translation.x());
  message.set_ty(transform.translation.y());
  message.set_tz(transform.translation.z());
  message.set_qx(transform.rotation.x());
  message.set_qy(transform.rotation.y());
  message.set_qz(transform.rotation.z());
  message.set_qw(transform.rotation.w());
}

}  // namespace hermite::wire
