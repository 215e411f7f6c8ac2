// Reads the values of a glTF accessor. Pure.
#pragma once

#include <cstdint>
#include <vector>

#include "core/import/glb_document.h"

namespace hermite::imports {

struct GlbValues {
  int components = 0;  // of each element: 1 to 4
  // The elements one after another; normalised integers become 0 to 1 or -1 to 1.
  std::vector<float> numbers;
  std::size_t count() const { return numbers.size() / static_cast<std::size_t>(components); }
};

// Reads an accessor as floats, with strides, all component types and normalisation. Returns
// kCorruptData naming the field when it exceeds its bufferView or has another number of components;
// kTooLarge for more than `most` elements; kUnsupported for sparse accessors and matrices.
Result<GlbValues> read_glb_values(const GlbDocument& document, std::uint64_t accessor,
                                  int least_components, int most_components, std::uint64_t most);

// Reads indices, all of which must be below `end`. Errors as above.
Result<std::vector<std::uint32_t>> read_glb_indices(const GlbDocument& document,
                                                    std::uint64_t accessor, std::uint64_t end,
                                                    std::uint64_t most);

// Returns the element count of an accessor without data of its own, as Draco has them. Errors as
// above.
Result<std::uint64_t> glb_element_count(const GlbDocument& document, std::uint64_t accessor,
                                        std::uint64_t most);

}  // namespace hermite::imports
