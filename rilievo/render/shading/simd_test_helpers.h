// The same test on every instruction set that this machine has and the library is built for.
#pragma once

#include <hwy/highway.h>

namespace rilievo {

// Calls test(name) with each of them in use, then goes back to the best.
template <class Test>
void for_each_instruction_set(Test&& test) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    test(hwy::TargetName(target));
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

}  // namespace rilievo
