// Images of kernels: what an HRBF needs of a pixel, in one texel. The margin around the image stays
// zero, which is no kernel, so that windows need no bounds checks.
// Inverse radius that marks a pixel without kernel: nothing is within its support.
const float kNoKernel = 1e6;
const int kKernelMargin = HERMITE_KERNEL_MARGIN;
int kernel_stride(Intrinsics camera) { return HERMITE_KERNEL_STRIDE(int(camera.width)); }
int kernel_index(Intrinsics camera, ivec2 pixel) {
  return (pixel.y + kKernelMargin) * kernel_stride(camera) + pixel.x + kKernelMargin;
}
float inverse_radius_of(uint word) { return word != 0u ? uintBitsToFloat(word) : kNoKernel; }
