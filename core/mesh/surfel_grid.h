// Slots of surfels by position, in the same bins as SurfelField. Not thread-safe; one owner.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace hermite::mesh {

class SurfelGrid {
 public:
  explicit SurfelGrid(double cell_m) : bin_m_(cell_m * kBinCells) {}

  static constexpr int kBinCells = 4;

  void insert(std::uint32_t slot, const Eigen::Vector3f& position_m);
  void remove(std::uint32_t slot, const Eigen::Vector3f& position_m);  // CHECK: it is there

  // Calls use(slot) for all slots in bins that the box touches, ordered by z, y and x of the bin,
  // then by slot.
  template <class Use>
  void for_each(const Eigen::Vector3f& low_m, const Eigen::Vector3f& high_m, const Use& use) const {
    const Eigen::Vector3i first = bin_of(low_m), last = bin_of(high_m);
    for (int z = first.z(); z <= last.z(); ++z)
      for (int y = first.y(); y <= last.y(); ++y)
        for (int x = first.x(); x <= last.x(); ++x) {
          const auto found = slots_by_bin_.find(key_of({x, y, z}));
          if (found == slots_by_bin_.end()) continue;
          for (const std::uint32_t slot : found->second) use(slot);
        }
  }

 private:
  static std::uint64_t key_of(const Eigen::Vector3i& bin);
  Eigen::Vector3i bin_of(const Eigen::Vector3f& position_m) const {
    return (position_m.cast<double>() / bin_m_).array().floor().cast<int>();
  }

  double bin_m_;
  // Sorted; no entry is empty.
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> slots_by_bin_;
};

}  // namespace hermite::mesh
