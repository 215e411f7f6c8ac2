// Images of kernels: what an HRBF asks of a pixel in one texel. The margin around the image stays zero, which is no kernel, so that windows need no
// bounds. Invocations of four pixels reach three farther to the right.
const float kNoKernel = 1e6;  // an inverse radius that nothing is within
const int kKernelMargin = HERMITE_KERNEL_MARGIN;
int kernel_stride(Intrinsics camera) { return int(camera.width) + 2 * kKernelMargin + 3; }
int kernel_index(Intrinsics camera, ivec2 pixel) { return (pixel.y + kKernelMargin) * kernel_stride(camera) + pixel.x + kKernelMargin; }
float inverse_radius_of(uint word) { return word != 0u ? uintBitsToFloat(word) : kNoKernel; }
