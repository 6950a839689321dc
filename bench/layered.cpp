// Layered impostors seen from new eyes: all parts of it (S2.3 to S2.6).
#include "bench/layered.h"

#include "bench/benches.h"

namespace rilievo::bench {

Result<BenchReport> layered(const BenchOptions& options) {
  BenchReport report;
  for (const auto add : {add_quality, add_tears, add_jumps})
    if (Result<> added = add(options, report); !added) return added.error();
  return report;
}

}  // namespace rilievo::bench
