#include "core/pipeline/checkpoint.h"

#include <elf.h>
#include <fmt/core.h>
#include <link.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <initializer_list>

namespace hermite::pipeline {

namespace {

constexpr std::array<char, 8> kMagic{'H', 'R', 'M', 'C', 'K', 'P', 'T', '1'};

// Writes numbers as the shortest texts that read back as the same numbers.
std::string condition_text(std::initializer_list<double> values) {
  std::string joined;
  for (const double value : values) {
    std::array<char, 32> text{};
    char* const end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    joined += (joined.empty() ? "" : " ") + std::string(text.data(), end);
  }
  return joined;
}

std::string condition_text(const Distortion& lens) {
  return condition_text({lens.k1, lens.k2, lens.p1, lens.p2, lens.k3});
}

std::string condition_text(const ColorCamera& color) {
  const Eigen::Quaterniond& q = color.color_from_depth.rotation;
  const Eigen::Vector3d& t = color.color_from_depth.translation;
  return fmt::format("{} {} {}", condition_text({color.fx, color.fy, color.cx, color.cy}),
                     condition_text(color.distortion),
                     condition_text({q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z()}));
}

std::string condition_text(const Camera& camera) {
  std::string text = fmt::format(
      "{}x{} {} {}", camera.width, camera.height,
      condition_text({camera.fx, camera.fy, camera.cx, camera.cy, camera.depth_units_per_metre}),
      condition_text(camera.distortion));
  if (camera.color) text += " " + condition_text(*camera.color);
  if (const DepthCorrection& depth = camera.depth_correction; depth != DepthCorrection{})
    text += " depth " + condition_text({depth.bend, depth.inverse_offset_per_m});
  if (const ImageTiming& timing = camera.timing; timing != ImageTiming{})
    text += " timing " +
            condition_text({timing.depth_readout_s, timing.color_readout_s, timing.color_delay_s});
  if (const CameraDeviations& known = camera.deviations; known != CameraDeviations{})
    text += " deviations " + condition_text({known.bend, known.focal, known.k1});
  return text;
}

// Returns the content of the note NT_GNU_BUILD_ID of one segment, or an empty string.
std::string build_id_among(const char* notes, std::size_t size) {
  const auto padded = [](std::size_t bytes) { return (bytes + 3) / 4 * 4; };
  for (std::size_t at = 0; at + sizeof(ElfW(Nhdr)) <= size;) {
    ElfW(Nhdr) note;
    std::memcpy(&note, notes + at, sizeof note);
    const std::size_t name = at + sizeof note, content = name + padded(note.n_namesz);
    if (note.n_type == NT_GNU_BUILD_ID && std::strcmp(notes + name, "GNU") == 0) {
      std::string id;
      for (std::size_t i = 0; i < note.n_descsz; ++i)
        for (const int shift : {4, 0}) id += "0123456789abcdef"[notes[content + i] >> shift & 15];
      return id;
    }
    at = content + padded(note.n_descsz);
  }
  return {};
}

// Takes the build id of the first object listed, which is the program itself.
int take_build_id(dl_phdr_info* object, std::size_t, void* id) {
  for (std::size_t i = 0; i < object->dlpi_phnum; ++i) {
    const ElfW(Phdr)& segment = object->dlpi_phdr[i];
    if (segment.p_type != PT_NOTE) continue;
    const std::string found = build_id_among(
        reinterpret_cast<const char*>(object->dlpi_addr + segment.p_vaddr), segment.p_memsz);
    if (!found.empty()) *static_cast<std::string*>(id) = found;
  }
  return 1;
}

}  // namespace

std::string program_identity() {
  std::string id;
  dl_iterate_phdr(take_build_id, &id);
  return id;
}

Conditions conditions_of(const gpu::DeviceInfo& device, const Camera& camera,
                         const Options& options, bool with_mapping) {
  Conditions conditions{{"device", device.name},
                        {"driver", device.driver},
                        {"program", program_identity()},
                        {"camera", condition_text(camera)},
                        {"mapping", with_mapping ? "yes" : "no"}};
  for (const Setting& setting : list_settings(options))
    conditions.emplace_back(setting.key, setting.value);
  return conditions;
}

void write_head(ByteWriter& bytes, const Conditions& conditions) {
  bytes.number(kMagic);
  bytes.list(conditions, [](ByteWriter& to, const auto& condition) {
    to.text(condition.first);
    to.text(condition.second);
  });
}

Status read_head(ByteReader& bytes, const Conditions& conditions) {
  std::array<char, 8> magic{};
  bytes.number(magic);
  if (bytes.ok() && magic != kMagic)
    return Error{ErrorCode::kUnsupported, "the checkpoint has another format"};
  Conditions found;
  bytes.list(found, [](ByteReader& from, auto& condition) {
    from.text(condition.first);
    from.text(condition.second);
  });
  if (!bytes.ok()) return bytes.status();
  for (std::size_t i = 0; i < std::min(found.size(), conditions.size()); ++i) {
    const auto& [name, value] = conditions[i];
    if (found[i].first != name)
      return Error{ErrorCode::kUnsupported, "the checkpoint lacks " + name};
    if (found[i].second != value)
      return Error{ErrorCode::kUnsupported,
                   fmt::format("the checkpoint was made where {} is '{}', but here it is '{}'",
                               name, found[i].second, value)};
  }
  if (found.size() != conditions.size())
    return Error{ErrorCode::kUnsupported, "the checkpoint was made with other settings"};
  return Done{};
}

}  // namespace hermite::pipeline
