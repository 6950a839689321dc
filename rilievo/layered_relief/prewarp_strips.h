// Into which strips is the result of a pre-warp divided?
//
// Internal to the folder. Strips are as wide as the result: the rows of a relief's tile that cannot
// reach a strip are left out, its columns are not, so that fewer samples are warped twice than with
// squares. Each is warped by one thread, and all take about equally long, however the samples are
// distributed over the result. Pure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "rilievo/layered_relief/layered_relief.h"
#include "rilievo/layered_relief/prewarp_grid.h"

namespace rilievo {

// How many, for a result of this size: of at most most * most texels in the mean. At least one for
// each thread, but no more than kStrips for that, unless they would be low: with four strips a
// sample is warped 1.4 times in the mean (a helmet). If more, a multiple of the threads, so that
// none waits for the last.
inline constexpr int kStrips = 4, kStripRows = 64;
[[nodiscard]] int strip_count(const glm::ivec2& extent, int most, int threads);

// No strip is higher than this: twice the mean. One that has all rows but few, as the samples of a
// grazing eye lie in these few, takes long for its texels alone.
[[nodiscard]] int most_strip_rows(int height, int count);
// So many texels no strip exceeds, with `padding` beside each row, in results of at most max_size
// texels a side: what a thread needs, so that it need not ask for more when the eye has moved.
[[nodiscard]] std::size_t most_strip_texels(int max_size, int most, int padding);

// Where the work is, for an eye: an estimate of it above each of the borders of `shown`, from its
// upper to its lower, both included, at equal distances; so many samples. Requires two borders or
// more; codes below `least_code` are not drawn.
void estimate_work(const LayeredRelief& relief, const ReliefWarp& warp, double resolution,
                   std::uint32_t least_code, const Texels& shown, std::vector<double>& above);

// Appends `count` strips of `shown` with equally much work each, but for most_strip_rows(), from
// the top; none is empty. Work as estimate_work() gives it. Requires as many rows as strips.
void divide_work(const Texels& shown, const std::vector<double>& above, int count,
                 std::vector<Texels>& strips);

}  // namespace rilievo
