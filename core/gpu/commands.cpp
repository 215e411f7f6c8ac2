#include "core/gpu/commands.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <string>

#include "core/base/check.h"

namespace hermite::gpu {

namespace {
constexpr std::uint32_t kQueriesPerPool = 256;
constexpr std::size_t kMaxPools = 64;  // commands of one submission beyond 16384 are not timed

std::uint32_t group_count(std::uint32_t threads, std::uint32_t local_size) {
  return static_cast<std::uint32_t>((std::uint64_t{threads} + local_size - 1) / local_size);
}

std::uint64_t bytes_of(std::initializer_list<NamedBuffer> buffers) {
  std::uint64_t bytes = 0;
  for (const auto& [name, buffer] : buffers) bytes += buffer.bytes;
  return bytes;
}
}  // namespace

Commands::Commands(Device& device)
    : device_(device),
      commands_(device),
      sets_(device),
      fill_slot_(device.pass_slot("(fill)")),
      copy_slot_(device.pass_slot("(copy)")) {}

Commands::~Commands() {
  if (!device_.may_release()) return;
  for (VkQueryPool pool : query_pools_) vkDestroyQueryPool(device_.vk(), pool, nullptr);
}

VkCommandBuffer Commands::next() {
  const bool first = !commands_.recording();
  commands_.barrier();  // begins the recording: nothing recorded before is still running
  if (first) sets_.take_back();
  if (first) write_timestamp(0);
  return commands_.vk();
}

void Commands::bind(const Kernel& kernel, Constants constants,
                    std::initializer_list<NamedBuffer> buffers) {
  CHECK(buffers.size() == kernel.bindings().size(),
        fmt::format("{} binds {} buffers, not {}", kernel.name(), kernel.bindings().size(),
                    buffers.size()));
  CHECK(constants.size == (kernel.push_constant_bytes() + std::size_t{3}) / 4 * 4,
        fmt::format("{} takes {} bytes of parameters, not {}", kernel.name(),
                    kernel.push_constant_bytes(), constants.size));
  VkCommandBuffer commands = next();
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.pipeline());
  bind_buffers(kernel, buffers);
  if (constants.size > 0)
    vkCmdPushConstants(commands, kernel.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                       static_cast<std::uint32_t>(constants.size), constants.bytes);
}

void Commands::record(const Kernel& kernel, Threads threads, Constants constants,
                      std::initializer_list<NamedBuffer> buffers) {
  const std::array<std::uint32_t, 3> groups = {group_count(threads.x, kernel.local_size()[0]),
                                               group_count(threads.y, kernel.local_size()[1]),
                                               group_count(threads.z, kernel.local_size()[2])};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (groups[axis] == 0) return;
    const std::uint32_t limit = device_.limits().maxComputeWorkGroupCount[axis];
    if (groups[axis] > limit)
      throw DeviceError(fmt::format("{}: {} work groups along axis {}, the device has at most {}",
                                    kernel.name(), groups[axis], axis, limit));
  }
  bind(kernel, constants, buffers);
  vkCmdDispatch(commands_.vk(), groups[0], groups[1], groups[2]);
  stamp({kernel.pass_slot(), std::uint64_t{threads.x} * threads.y * threads.z, bytes_of(buffers)});
}

void Commands::record_indirect(const Kernel& kernel, GroupCounts groups, Constants constants,
                               std::initializer_list<NamedBuffer> buffers) {
  const VkDeviceSize offset = VkDeviceSize{4} * groups.first_word;
  CHECK(groups.buffer.bytes >= offset + sizeof(VkDispatchIndirectCommand),
        kernel.name() + ": no room for the number of work groups");
  bind(kernel, constants, buffers);
  vkCmdDispatchIndirect(commands_.vk(), groups.buffer.buffer, offset);
  stamp({kernel.pass_slot(), 0, bytes_of(buffers)});
}

void Commands::bind_buffers(const Kernel& kernel, std::initializer_list<NamedBuffer> buffers) {
  if (buffers.size() == 0) return;
  CHECK(buffers.size() <= kMaxBindings, kernel.name() + " binds more than 32 buffers");
  std::array<VkDescriptorBufferInfo, kMaxBindings> infos;
  std::array<VkWriteDescriptorSet, kMaxBindings> writes;
  const bool push = device_.info().has_push_descriptors;
  const VkDescriptorSet set = push ? VK_NULL_HANDLE : sets_.next(kernel.set_layout());
  std::uint32_t count = 0;
  for (const auto& [name, buffer] : buffers) {
    const std::string& expected = kernel.binding_names()[count];
    CHECK(name == expected,
          fmt::format("{}: buffer {} is '{}', not '{}'", kernel.name(), count, expected, name));
    CHECK(buffer.buffer != VK_NULL_HANDLE, fmt::format("{}: {} is empty", kernel.name(), expected));
    const Binding kind = kernel.bindings()[count];
    if (kind == Binding::kTexels && buffer.texels == VK_NULL_HANDLE)
      throw DeviceError(fmt::format(
          "{}: {} of {} bytes cannot be read as texels: none is whole, or they are more than the "
          "device's {}",
          kernel.name(), expected, buffer.bytes, device_.limits().maxTexelBufferElements));
    infos[count] = {buffer.buffer, 0, buffer.bytes};
    VkWriteDescriptorSet& write = writes[count];
    write = {};
    write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    write.dstSet = set;
    write.dstBinding = count;
    write.descriptorCount = 1;
    write.descriptorType = descriptor_type(kind);
    write.pBufferInfo = &infos[count];
    write.pTexelBufferView = &buffer.texels;
    ++count;
  }
  if (push) {
    device_.push_descriptors()(commands_.vk(), VK_PIPELINE_BIND_POINT_COMPUTE, kernel.layout(), 0,
                               count, writes.data());
  } else {
    vkUpdateDescriptorSets(device_.vk(), count, writes.data(), 0, nullptr);
    vkCmdBindDescriptorSets(commands_.vk(), VK_PIPELINE_BIND_POINT_COMPUTE, kernel.layout(), 0, 1,
                            &set, 0, nullptr);
  }
}

void Commands::fill(BufferRef buffer, std::uint32_t value) {
  CHECK(buffer.buffer != VK_NULL_HANDLE, "fill of an empty buffer");
  vkCmdFillBuffer(next(), buffer.buffer, 0, buffer.bytes, value);
  stamp({fill_slot_, 0, buffer.bytes});
}

void Commands::copy(BufferRef from, BufferRef to, VkDeviceSize bytes) {
  CHECK(bytes <= from.bytes && bytes <= to.bytes, "copy outside a buffer");
  CHECK(bytes % 4 == 0, "copy of a part of a word");
  if (bytes == 0) return;
  const VkBufferCopy region{0, 0, bytes};
  vkCmdCopyBuffer(next(), from.buffer, to.buffer, 1, &region);
  stamp({copy_slot_, 0, 2 * bytes});
}

void Commands::stamp(const Stamped& command) {
  stamped_.push_back(command);
  write_timestamp(static_cast<std::uint32_t>(stamped_.size()));
}

// Stamp i is written when command i is done, and the barriers between commands prevent any overlap,
// so the time of a command is the difference from the stamp before.
void Commands::write_timestamp(std::uint32_t index) {
  if (device_.timestamp_period_ns() <= 0) return;
  const std::size_t pool = index / kQueriesPerPool;
  if (pool >= kMaxPools) return;
  if (pool >= query_pools_.size()) {
    VkQueryPoolCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
    create.queryType = VK_QUERY_TYPE_TIMESTAMP;
    create.queryCount = kQueriesPerPool;
    VkQueryPool made = VK_NULL_HANDLE;
    throw_if_failed(vkCreateQueryPool(device_.vk(), &create, nullptr, &made), "make a query pool");
    query_pools_.push_back(made);
  }
  if (index % kQueriesPerPool == 0)
    vkCmdResetQueryPool(commands_.vk(), query_pools_[pool], 0, kQueriesPerPool);
  vkCmdWriteTimestamp(commands_.vk(), VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, query_pools_[pool],
                      index % kQueriesPerPool);
}

void Commands::submit_and_wait_beside(const std::function<void()>& meanwhile,
                                      std::chrono::milliseconds limit) {
  if (!commands_.recording()) {
    if (meanwhile) meanwhile();
    return;
  }
  try {
    const Timeline::Clock::time_point submitted = Timeline::Clock::now();
    commands_.run(limit, meanwhile);
    collect_times(submitted);
  } catch (...) {
    stamped_.clear();
    throw;
  }
  stamped_.clear();
}

void Commands::read_ticks() {
  ticks_.clear();
  const std::size_t stamp_count =
      std::min(stamped_.size() + 1, query_pools_.size() * kQueriesPerPool);
  ticks_.resize(stamp_count);
  for (std::size_t first = 0; first < stamp_count; first += kQueriesPerPool) {
    const std::size_t count = std::min<std::size_t>(kQueriesPerPool, stamp_count - first);
    const VkResult result =
        vkGetQueryPoolResults(device_.vk(), query_pools_[first / kQueriesPerPool], 0,
                              static_cast<std::uint32_t>(count), count * sizeof(std::uint64_t),
                              &ticks_[first], sizeof(std::uint64_t), VK_QUERY_RESULT_64_BIT);
    throw_if_failed(result, "read time stamps");
    if (result == VK_NOT_READY) ticks_.resize(first);
    if (result == VK_NOT_READY) break;
  }
}

void Commands::collect_times(Timeline::Clock::time_point submitted) {
  read_ticks();
  double since_first_ms = 0;
  for (std::size_t i = 0; i < stamped_.size(); ++i) {
    const Stamped& command = stamped_[i];
    const bool timed = i + 1 < ticks_.size();
    const std::uint64_t ticks = timed ? (ticks_[i + 1] - ticks_[i]) & device_.timestamp_mask() : 0;
    const double ms = static_cast<double>(ticks) * device_.timestamp_period_ns() * 1e-6;
    device_.add_pass_time(command.pass_slot, ms);
    if (Timeline* timeline = device_.timeline()) {
      const auto start = submitted + std::chrono::duration_cast<Timeline::Clock::duration>(
                                         std::chrono::duration<double, std::milli>(since_first_ms));
      timeline->passes.push_back({device_.pass_name(command.pass_slot), start, ms,
                                  command.invocations, command.bytes_within_reach});
    }
    since_first_ms += ms;
  }
}

}  // namespace hermite::gpu
