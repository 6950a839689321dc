#include "bench/layered.h"

namespace rilievo::bench {

Result<BenchReport> layered(const BenchOptions& options) {
  BenchReport report;
  for (const auto add : {add_quality, add_tears, add_jumps})
    if (Result<> added = add(options, report); !added) return added.error();
  return report;
}

}  // namespace rilievo::bench
