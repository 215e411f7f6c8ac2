// Writes a compute shader as C++: both versions of its SPIR-V (lib/texels.glsl says why there are
// two) with their interface (core/gpu/shader_interface.h), which SPIRV-Cross reads. Runs while
// Hermite is built:
//
//   hermite_embed_shader NAME IDENTIFIER TEXELS.spv STORAGE.spv OUTPUT.h
//
// Fails, with a reason, for anything but storage and texel buffers in set 0, numbered without gaps,
// and push constants.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <spirv_cross/spirv_cross.hpp>

#include "core/gpu/shader_interface.h"

namespace hermite::gpu {
namespace {

using spirv_cross::Compiler;
using spirv_cross::Resource;
using spirv_cross::ShaderResources;
using spirv_cross::SmallVector;

struct Bound {
  Binding kind = Binding::kStorage;
  std::string name;
};

[[noreturn]] void refuse(const std::string& reason) { throw std::runtime_error(reason); }

std::vector<std::uint32_t> read_words(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  if (!file || bytes.size() % 4 != 0) refuse("cannot read " + path);
  std::vector<std::uint32_t> words(bytes.size() / 4);
  std::memcpy(words.data(), bytes.data(), bytes.size());
  return words;
}

void refuse_other_resources(const ShaderResources& resources) {
  for (const auto* others :
       {&resources.uniform_buffers, &resources.stage_inputs, &resources.stage_outputs,
        &resources.subpass_inputs, &resources.storage_images, &resources.atomic_counters,
        &resources.acceleration_structures, &resources.separate_images,
        &resources.separate_samplers})
    if (!others->empty())
      refuse("'" + others->front().name + "' is neither a storage nor a texel buffer");
}

std::string name_of(const Compiler& shader, const Resource& buffer, Binding kind) {
  if (kind == Binding::kTexels) return buffer.name;
  const auto& block = shader.get_type(buffer.base_type_id);
  return shader.get_member_name(buffer.base_type_id,
                                static_cast<std::uint32_t>(block.member_types.size() - 1));
}

void add_buffers(const Compiler& shader, const SmallVector<Resource>& buffers, Binding kind,
                 std::map<std::uint32_t, Bound>& bound) {
  for (const Resource& buffer : buffers) {
    const auto& type = shader.get_type(buffer.type_id);
    if (!type.array.empty()) refuse("'" + buffer.name + "' is an array of buffers");
    if (kind == Binding::kTexels && type.image.dim != spv::DimBuffer)
      refuse("'" + buffer.name + "' is a texture");
    if (shader.get_decoration(buffer.id, spv::DecorationDescriptorSet) != 0)
      refuse("'" + buffer.name + "' is not in set 0");
    const std::uint32_t number = shader.get_decoration(buffer.id, spv::DecorationBinding);
    // Variables may share a binding if they are of the same kind.
    const auto [place, is_new] =
        bound.try_emplace(number, Bound{kind, name_of(shader, buffer, kind)});
    if (place->second.kind != kind)
      refuse("binding " + std::to_string(number) + " is a storage and a texel buffer");
  }
}

void read_buffers(const Compiler& shader, const ShaderResources& resources,
                  ShaderInterface& interface) {
  std::map<std::uint32_t, Bound> bound;
  add_buffers(shader, resources.storage_buffers, Binding::kStorage, bound);
  add_buffers(shader, resources.sampled_images, Binding::kTexels, bound);
  for (const auto& [number, buffer] : bound) {
    if (number != interface.bindings.size())
      refuse("binding " + std::to_string(interface.bindings.size()) + " is missing");
    interface.bindings.push_back(buffer.kind);
    interface.binding_names.push_back(buffer.name);
  }
}

void read_local_size(const Compiler& shader, ShaderInterface& interface) {
  std::array<spirv_cross::SpecializationConstant, 3> constants;
  shader.get_work_group_size_specialization_constants(constants[0], constants[1], constants[2]);
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    if (constants[axis].id == spirv_cross::ConstantID(0)) {
      interface.local_size[axis] =
          shader.get_execution_mode_argument(spv::ExecutionModeLocalSize, axis);
    } else {
      interface.local_size[axis] = shader.get_constant(constants[axis].id).scalar();
      interface.local_size_constant[axis] = constants[axis].constant_id;
    }
  }
}

ShaderInterface read_interface(const std::vector<std::uint32_t>& words) {
  const Compiler shader(words);
  if (shader.get_execution_model() != spv::ExecutionModelGLCompute) refuse("no compute shader");
  const ShaderResources resources = shader.get_shader_resources();
  refuse_other_resources(resources);
  ShaderInterface interface;
  read_buffers(shader, resources, interface);
  for (const Resource& block : resources.push_constant_buffers)
    interface.push_constant_bytes = static_cast<std::uint32_t>(
        shader.get_declared_struct_size(shader.get_type(block.base_type_id)));
  const auto& capabilities = shader.get_declared_capabilities();
  interface.needs_64_bit_atomics = std::find(capabilities.begin(), capabilities.end(),
                                             spv::CapabilityInt64Atomics) != capabilities.end();
  read_local_size(shader, interface);
  return interface;
}

// Returns an initialiser of the interface.
std::string as_code(const ShaderInterface& interface) {
  std::ostringstream code;
  code << "{{";
  for (const Binding kind : interface.bindings)
    code << (kind == Binding::kTexels ? "Binding::kTexels, " : "Binding::kStorage, ");
  code << "}, {";
  for (const std::string& name : interface.binding_names) code << '"' << name << "\", ";
  code << "}, " << std::boolalpha << interface.needs_64_bit_atomics << ", "
       << interface.push_constant_bytes << ", {";
  for (const std::uint32_t size : interface.local_size) code << size << ", ";
  code << "}, {";
  for (const std::optional<std::uint32_t>& constant : interface.local_size_constant)
    code << (constant ? std::to_string(*constant) : "std::nullopt") << ", ";
  code << "}}";
  return code.str();
}

std::string as_code(const std::vector<std::uint32_t>& words) {
  std::ostringstream code;
  for (std::size_t i = 0; i < words.size(); ++i)
    code << (i % 12 == 0 ? "\n" : "") << "0x" << std::hex << words[i] << ',';
  return code.str();
}

std::string embedded(const std::string& name, const std::string& identifier,
                     const std::vector<std::uint32_t>& texels,
                     const std::vector<std::uint32_t>& storage) {
  const ShaderInterface of_texels = read_interface(texels);
  ShaderInterface of_storage = read_interface(storage);
  if (of_storage.bindings.size() != of_texels.bindings.size())
    refuse("the versions have different bindings");
  // A buffer read as texels has four names where it is bound as storage.
  of_storage.binding_names = of_texels.binding_names;
  return "// Generated by shaders/embed_shader.cpp.\n"
         "constexpr std::uint32_t " +
         identifier + "_texels[] = {" + as_code(texels) +
         "};\n"
         "constexpr std::uint32_t " +
         identifier + "_storage[] = {" + as_code(storage) +
         "};\n"
         "EmbeddedKernel " +
         identifier +
         "(ReadAs read_as) {\n"
         "  if (read_as == ReadAs::kStorage)\n"
         "    return {\"" +
         name + "\", " + identifier + "_storage, " + as_code(of_storage) +
         "};\n"
         "  return {\"" +
         name + "\", " + identifier + "_texels, " + as_code(of_texels) +
         "};\n"
         "}\n";
}

}  // namespace
}  // namespace hermite::gpu

int main(int argument_count, char** arguments) {
  if (argument_count != 6) return 2;
  try {
    const std::string code =
        hermite::gpu::embedded(arguments[1], arguments[2], hermite::gpu::read_words(arguments[3]),
                               hermite::gpu::read_words(arguments[4]));
    if (!(std::ofstream(arguments[5]) << code << std::flush))
      hermite::gpu::refuse("cannot write " + std::string(arguments[5]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "shader %s: %s\n", arguments[1], error.what());
    return 1;
  }
}
