#include "core/gpu/embedded.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::gpu::embedded_test {
namespace {

using testing::ElementsAre;

// The interface, as it was read while Hermite was built.
ShaderInterface interface_of(std::string_view name) {
  for (const EmbeddedKernel& shader : embedded_kernels())
    if (shader.name == name) return shader.interface;
  ADD_FAILURE() << "there is no shader " << name;
  return {};
}

TEST(EmbeddedKernels, KnowTheirSpecialisedLocalSizeBuffersAndConstants) {
  const ShaderInterface shader = interface_of("test/affine");
  EXPECT_THAT(shader.bindings, ElementsAre(Binding::kStorage, Binding::kStorage));
  EXPECT_THAT(shader.binding_names, ElementsAre("source", "target"));
  EXPECT_EQ(shader.push_constant_bytes, 20u);
  EXPECT_THAT(shader.local_size, ElementsAre(8, 2, 1));
  EXPECT_THAT(shader.local_size_constant, ElementsAre(0u, std::nullopt, std::nullopt));
}

TEST(EmbeddedKernels, KnowTheSizesOfMatricesArraysAndStructs) {
  const ShaderInterface shader = interface_of("test/layouts");
  EXPECT_EQ(shader.push_constant_bytes, 112u);
  EXPECT_THAT(shader.binding_names, ElementsAre("floats", "target"))
      << "two views of binding 0 are one";
  EXPECT_THAT(shader.local_size, ElementsAre(4, 3, 2));
}

TEST(EmbeddedKernels, KnowTexelsFromStorage) {
  const ShaderInterface shader = interface_of("test/texels");
  EXPECT_THAT(shader.bindings, ElementsAre(Binding::kTexels, Binding::kTexels, Binding::kTexels,
                                           Binding::kTexels, Binding::kStorage));
  EXPECT_THAT(shader.binding_names,
              ElementsAre("halves", "words", "pairs", "transforms", "target"));
}

TEST(EmbeddedKernels, KnowWhatNeeds64BitAtomics) {
  EXPECT_TRUE(interface_of("map/index_nearest").needs_64_bit_atomics);
  EXPECT_FALSE(interface_of("map/index_depth").needs_64_bit_atomics);
}

TEST(EmbeddedKernels, MayHaveNoPushConstants) {
  EXPECT_EQ(interface_of("test/count").push_constant_bytes, 0u);
  EXPECT_THAT(interface_of("test/count").binding_names, ElementsAre("counts"));
}

TEST(EmbeddedKernels, BindNoTexelsWhereTheyAreInStorage) {
  ASSERT_EQ(embedded_kernels(ReadAs::kStorage).size(), embedded_kernels().size());
  for (std::size_t i = 0; i < embedded_kernels().size(); ++i) {
    const EmbeddedKernel& shader = embedded_kernels(ReadAs::kStorage)[i];
    const EmbeddedKernel& of_texels = embedded_kernels()[i];
    EXPECT_EQ(shader.name, of_texels.name);
    EXPECT_THAT(shader.interface.bindings, testing::Each(Binding::kStorage)) << shader.name;
    EXPECT_EQ(shader.interface.binding_names, of_texels.interface.binding_names) << shader.name;
    EXPECT_EQ(shader.interface.push_constant_bytes, of_texels.interface.push_constant_bytes)
        << shader.name;
  }
}

}  // namespace
}  // namespace hermite::gpu::embedded_test
