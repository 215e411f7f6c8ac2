// Reads the values of a glTF accessor. Pure.
#pragma once

#include <cstdint>
#include <vector>

#include "core/import/glb_document.h"

namespace hermite {

struct GlbValues {
  int components = 0;          // of each element: 1 to 4
  std::vector<float> numbers;  // one element after the other; normalised integers are 0 to 1 or -1 to 1
  std::size_t count() const { return numbers.size() / static_cast<std::size_t>(components); }
};

// Handles strides, all component types and normalisation. kCorruptData, naming the field: the accessor exceeds its bufferView, or has
// another number of components; kTooLarge: more than `most` elements; kUnsupported: sparse accessors, matrices.
Result<GlbValues> read_glb_values(const GlbDocument& document, std::uint64_t accessor, int least_components, int most_components,
                                  std::uint64_t most);

// Indices below `end`. Errors as above.
Result<std::vector<std::uint32_t>> read_glb_indices(const GlbDocument& document, std::uint64_t accessor, std::uint64_t end,
                                                    std::uint64_t most);

// The element count of an accessor without data of its own (Draco). Errors as above.
Result<std::uint64_t> glb_element_count(const GlbDocument& document, std::uint64_t accessor, std::uint64_t most);

}  // namespace hermite
