// Any bytes as a picture, in colours and as depth: texels within the bound on memory, or a refusal
// with a reason. tools/fuzz runs it.
#include <cstdlib>

#include "rilievo/io/picture_decode.h"

namespace {

template <class Decode>
void decode(rilievo::Bytes bytes, Decode how) {
  rilievo::MemoryBudget budget(64u << 20);
  try {
    budget.earn(bytes.size());
    (void)how(bytes, budget);
  } catch (const rilievo::LoadError& fault) {
    if (fault.reason.empty() || fault.reason.ends_with(": ")) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  decode({data, size}, rilievo::decode_picture);
  decode({data, size}, rilievo::decode_grey16);
  return 0;
}
