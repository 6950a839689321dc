// EXT_meshopt_compression, and KHR_meshopt_compression, which is the same with one more filter:
// what a buffer view holds after libmeshoptimizer has decoded it.
//
// The decoders are made for untrusted input as far as the stream goes, but assert what they expect
// of counts and strides: all of that is checked here, before they are called.
#include <meshoptimizer.h>

#include "rilievo/scene/gltf/document.h"

namespace rilievo::gltf {

std::string decode_meshopt(Document& document, const JsonValue& extension) {
  const Bytes packed = read_buffer(document, extension);
  const std::uint64_t stride = extension["byteStride"].whole();
  const std::uint64_t count = extension["count"].whole();
  const std::string mode = extension["mode"].text(), filter = extension["filter"].text("NONE");

  if (mode == "ATTRIBUTES") {
    if (stride == 0 || stride % 4 != 0 || stride > 256)
      extension["byteStride"].fail("is not a multiple of 4 up to 256");
  } else if (mode == "TRIANGLES" || mode == "INDICES") {
    if (stride != 2 && stride != 4) extension["byteStride"].fail("is neither 2 nor 4");
    if (mode == "TRIANGLES" && count % 3 != 0) extension["count"].fail("is not divisible by 3");
    if (filter != "NONE") extension["filter"].fail("applies to attributes only");
  } else {
    extension["mode"].fail("is '" + mode + "', which is unknown");
  }
  if (filter == "OCTAHEDRAL" && stride != 4 && stride != 8)
    extension["byteStride"].fail("of octahedral vectors is neither 4 nor 8");
  if (filter == "QUATERNION" && stride != 8)
    extension["byteStride"].fail("of quaternions is not 8");

  std::uint64_t bytes = 0;
  if (!__builtin_mul_overflow(count, stride, &bytes))
    document.context->budget.earn_decompressed(packed.size(), bytes);
  document.context->budget.take(count, stride);
  std::string out(count * stride, '\0');
  int failure = 0;
  if (mode == "ATTRIBUTES")
    failure = meshopt_decodeVertexBuffer(out.data(), count, stride, packed.data(), packed.size());
  else if (mode == "TRIANGLES")
    failure = meshopt_decodeIndexBuffer(out.data(), count, stride, packed.data(), packed.size());
  else
    failure = meshopt_decodeIndexSequence(out.data(), count, stride, packed.data(), packed.size());
  if (failure != 0) extension.fail("cannot be decompressed: the stream is damaged");

  if (filter == "OCTAHEDRAL")
    meshopt_decodeFilterOct(out.data(), count, stride);
  else if (filter == "QUATERNION")
    meshopt_decodeFilterQuat(out.data(), count, stride);
  else if (filter == "EXPONENTIAL")
    meshopt_decodeFilterExp(out.data(), count, stride);
  else if (filter != "NONE")
    extension["filter"].fail("is '" + filter + "', which is not supported");
  return out;
}

}  // namespace rilievo::gltf
