// The walk keeps three things from texel to texel: is it in front of the surface, has it passed
// behind an edge, and behind an outline. Over a cell
//
//   front of all pieces    nothing is met, and it leaves in front, whatever it was before
//   behind all pieces      if it was behind, it stays so; with holes in the cell it comes out in
//                          front over each and passes behind an outline again. That is news only
//                          the first time: then the texels are walked. Later it may leave the cell
//                          as "behind" even if over a hole: holes have no links, by which alone the
//                          next texel would tell the difference
//
// and otherwise the next finer level is asked, and the texels at last.
//
// Drivers of OpenGL for processors, and SIMD, run both sides of a branch for some rays together;
// loops alone are left early. So each loop holds one thing, steps over cells or steps over texels.
#include "rilievo/layered_impostor/software/march_rays.h"

#include "rilievo/layered_impostor/picture_textures.h"

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/layered_impostor/software/march_rays.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

using F = hn::CappedTag<float, MarchRays::kCount>;
using I = hn::RebindToSigned<F>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;
using MF = hn::Mask<F>;

// The side of a cell of the finest level is 1 << kBlockBits texels.
constexpr int kBlockBits = 2, kFactorBits = 2, kLevels = SurfacePyramid::kLevels;
static_assert(1 << kBlockBits == SurfacePyramid::kBlock);
static_assert(1 << kFactorBits == SurfacePyramid::kFactor);
// Beyond the end of every segment.
constexpr float kNever = 1e30f;
// Every round leaves a texel, or the surface's front; rounding must not make it endless.
constexpr int kMaxRounds = 16384;

HWY_INLINE VF of(VI v) { return hn::ConvertTo(F(), v); }
HWY_INLINE VI select(MF mask, VI yes, VI no) {
  return hn::IfThenElse(hn::RebindMask(I(), mask), yes, no);
}
HWY_INLINE VF select(MF mask, VF yes, VF no) { return hn::IfThenElse(mask, yes, no); }

#include "rilievo/core/load_records.inl"

// A vector of rays on their way over a surface.
class March {
 public:
  March(const MarchSurface& surface, const MarchRays& rays, int first)
      : surface_(surface), columns_(hn::Set(i32, surface.cells.width())) {
    for (int a = 0; a < 3; ++a) {
      from_[a] = hn::Load(f, rays.from[a] + first);
      step_[a] = hn::Sub(hn::Load(f, rays.to[a] + first), from_[a]);
    }
    const VF zero = hn::Zero(f), one = hn::Set(f, 1.0f);
    const int size[] = {surface.width, surface.height};
    for (int a = 0; a < 2; ++a) {
      const MF moves = hn::Gt(hn::Abs(step_[a]), hn::Set(f, 1e-12f));
      per_step_[a] = hn::IfThenElseZero(moves, hn::Div(one, select(moves, step_[a], one)));
      never_[a] = hn::IfThenZeroElse(moves, hn::Set(f, kNever));
      const MF on = hn::Ge(step_[a], zero);
      ahead_[a] = select(on, hn::Set(i32, 1), hn::Zero(i32));
      forward_[a] = select(on, hn::Set(i32, 1), hn::Set(i32, -1));
      last_[a] = hn::Set(i32, size[a] - 1);
      texel_[a] =
          hn::Min(hn::Max(hn::ConvertTo(i32, hn::Floor(from_[a])), hn::Zero(i32)), last_[a]);
      moved_[a] = hn::Zero(i32);
    }
    t_ = hn::Zero(f), before_ = one, leave_ = zero, enters_ = zero;
    end_t_ = zero, end_[0] = end_[1] = hn::Zero(i32);
    behind_from_ = behind_to_ = zero;
    level_ = hn::Set(i32, kLevels - 1);
    // Lanes after the wanted ones.
    const std::uint8_t bits = std::uint8_t(rays.wanted >> first);
    HWY_ALIGN std::uint8_t bytes[8] = {bits};
    done_ = hn::Not(hn::LoadMaskBits(f, bytes));
    hit_ = behind_ = outline_ = hn::Lt(zero, zero);
  }

  void run(MarchRays& rays) {
    for (int round = 0; round < kMaxRounds; ++round) {
      over_cells(rays);
      if (hn::AllTrue(f, done_)) break;
      over_texels(rays);
      if (hn::AllTrue(f, done_)) break;
    }
    meet();
  }

  void store(MarchRays& rays, int first) const {
    hn::Store(end_t_, f, rays.t + first);
    hn::Store(behind_from_, f, rays.behind_from + first);
    const MF stays = hn::AndNot(hit_, hn::Le(before_, hn::Zero(f)));
    hn::Store(select(stays, hn::Set(f, 1.0f), behind_to_), f, rays.behind_to + first);
    hn::Store(end_[0], i32, rays.x + first);
    hn::Store(end_[1], i32, rays.y + first);
    const auto bits = [&](MF mask) {
      HWY_ALIGN std::uint8_t bytes[8] = {};
      hn::StoreMaskBits(f, mask, bytes);
      return std::uint32_t(bytes[0]) << first;
    };
    rays.hit |= bits(hit_);
    rays.passed_behind |= bits(behind_);
    rays.passed_outline |= bits(outline_);
  }

 private:
  HWY_INLINE VF at(int axis, VF t) const { return hn::Add(from_[axis], hn::Mul(step_[axis], t)); }
  // Of the border of [low, low + side) in front, on an axis.
  HWY_INLINE VF exit(int axis, VI low, VI side) const {
    const VI border = hn::Add(low, hn::And(side, hn::Neg(ahead_[axis])));
    return hn::Add(hn::Mul(hn::Sub(of(border), from_[axis]), per_step_[axis]), never_[axis]);
  }
  HWY_INLINE MF outside() const {
    const VI zero = hn::Zero(i32);
    const auto beyond = [&](int a) {
      return hn::Or(hn::Lt(texel_[a], zero), hn::Gt(texel_[a], last_[a]));
    };
    return hn::RebindMask(f, hn::Or(beyond(0), beyond(1)));
  }
  // Of numbers whose bits from `shift` on are not all alike.
  static HWY_INLINE MF differ(VI a, VI b, VI shift) {
    return hn::RebindMask(F(), hn::Ne(hn::Shr(a, shift), hn::Shr(b, shift)));
  }

  struct Patch {
    VF q, slope[4];
    VI links;
  };
  HWY_INLINE VI index_of(VI x, VI y) const {
    constexpr int kFields = sizeof(MarchSurface::Texel) / sizeof(float);
    const VI texel = hn::Add(hn::Mul(y, hn::Set(i32, surface_.width)), x);
    return hn::Mul(texel, hn::Set(i32, kFields));
  }
  HWY_INLINE Patch patch_at(VI index) const {
    const float* first = &surface_.texels[0].q;
    VF four[4], two[2];
    load_four(f, first, i32, index, four);
    load_two(f, first + 4, i32, index, two);
    Patch patch{four[0], {four[1], four[2], four[3], two[0]}, hn::BitCast(i32, two[1])};
    return patch;
  }
  // > 0 in front of the patch of surface over a texel.
  HWY_INLINE VF side_of(const Patch& patch, VI x, VI y, VF t) const {
    const VF half = hn::Set(f, 0.5f), zero = hn::Zero(f);
    const VF dx = hn::Sub(at(0, t), hn::Add(of(x), half)),
             dy = hn::Sub(at(1, t), hn::Add(of(y), half));
    const VF sx = select(hn::Ge(dx, zero), patch.slope[0], patch.slope[2]),
             sy = select(hn::Ge(dy, zero), patch.slope[1], patch.slope[3]);
    const VF surface =
        hn::Add(patch.q, hn::Add(hn::Mul(hn::Abs(dx), sx), hn::Mul(hn::Abs(dy), sy)));
    const VF side = hn::Mul(hn::Set(f, surface_.sigma), hn::Sub(at(2, t), surface));
    return select(hn::Eq(patch.q, zero), hn::Set(f, 1.0f), side);
  }

  // Steps over cells, down to one of the finest level that cannot be stepped over.
  HWY_INLINE void over_cells(MarchRays& rays) {
    const VF zero = hn::Zero(f), one = hn::Set(f, 1.0f);
    const VI one_i = hn::Set(i32, 1);
    const float* cells = &surface_.cells.texels()[0].x;
    for (MF walks = hn::Not(done_); !hn::AllFalse(f, walks); ++rays.cell_steps) {
      const VI bits = hn::Add(hn::Set(i32, kBlockBits), hn::Mul(level_, hn::Set(i32, kFactorBits)));
      const VI side = hn::Shl(one_i, bits);
      VI cell[2], low[2];
      for (int a = 0; a < 2; ++a) {
        // Rays that are done may be beyond the picture.
        const VI inside = hn::Min(hn::Max(texel_[a], hn::Zero(i32)), last_[a]);
        cell[a] = hn::Shr(inside, bits), low[a] = hn::Shl(cell[a], bits);
      }
      VI column = cell[0];
      for (int level = 1; level < kLevels; ++level)
        column = hn::Add(column,
                         hn::IfThenElseZero(hn::Eq(level_, hn::Set(i32, level)),
                                            hn::Set(i32, surface_.level_at[std::size_t(level)])));
      const VI index = hn::Mul(hn::Add(hn::Mul(cell[1], columns_), column), hn::Set(i32, 2));
      VF range[2];
      load_two(f, cells, i32, index, range);
      const VF front = range[0], back = range[1];
      const VF exits[] = {exit(0, low[0], side), exit(1, low[1], side)};
      const VF end = hn::Min(hn::Min(exits[0], exits[1]), one);
      const VF sigma = hn::Set(f, surface_.sigma);
      const VF z0 = hn::Mul(sigma, at(2, t_)), z1 = hn::Mul(sigma, at(2, end));
      const MF in_front = hn::Gt(hn::Min(z0, z1), front);
      const MF passes = hn::Or(hn::Gt(back, zero), outline_);
      const MF behind = hn::And(hn::And(hn::Le(before_, zero), passes),
                                hn::Lt(hn::Max(z0, z1), hn::Mul(sigma, hn::Abs(back))));
      const MF skips = hn::And(walks, hn::Or(in_front, behind));
      if (!hn::AllFalse(f, skips)) {
        const MF across = hn::Le(exits[0], exits[1]);
        for (int a = 0; a < 2; ++a) {
          const MF leaves = a == 0 ? across : hn::Not(across);
          const VI most = hn::Min(hn::Add(low[a], hn::Sub(side, one_i)), last_[a]);
          const VI inside =
              hn::Min(hn::Max(hn::ConvertTo(i32, hn::Floor(at(a, end))), low[a]), most);
          const VI next =
              hn::Add(low[a], select(hn::RebindMask(f, hn::Gt(forward_[a], hn::Zero(i32))), side,
                                     hn::Set(i32, -1)));
          texel_[a] = select(skips, select(leaves, next, inside), texel_[a]);
          moved_[a] = select(skips, hn::IfThenElseZero(hn::RebindMask(i32, leaves), forward_[a]),
                             moved_[a]);
        }
        // In front at once where it was behind.
        const MF out = hn::And(hn::And(skips, in_front), hn::Le(before_, zero));
        behind_to_ = select(out, t_, behind_to_);
        t_ = select(skips, end, t_);
        before_ = select(skips, select(in_front, one, hn::Set(f, -1.0f)), before_);
        done_ = hn::Or(done_, hn::And(skips, hn::Or(hn::Ge(end, one), outside())));
        // Into another cell of the coarser level: that may be stepped over as a whole.
        const VI coarser = hn::Add(bits, hn::Set(i32, kFactorBits));
        const MF other =
            hn::Or(differ(texel_[0], low[0], coarser), differ(texel_[1], low[1], coarser));
        const MF rises = hn::And(hn::And(skips, other),
                                 hn::RebindMask(f, hn::Lt(level_, hn::Set(i32, kLevels - 1))));
        level_ = select(rises, hn::Add(level_, one_i), level_);
      }
      const MF sinks =
          hn::And(hn::AndNot(skips, walks), hn::RebindMask(f, hn::Gt(level_, hn::Zero(i32))));
      level_ = select(sinks, hn::Sub(level_, one_i), level_);
      walks = hn::And(walks, hn::AndNot(done_, hn::Or(skips, sinks)));
    }
  }

  // Steps over the texels of a cell, up to an edge, or to where the surface is met.
  HWY_INLINE void over_texels(MarchRays& rays) {
    const VF zero = hn::Zero(f), one = hn::Set(f, 1.0f);
    const VI one_i = hn::Set(i32, 1), block_bits = hn::Set(i32, kBlockBits);
    const VI block[] = {texel_[0], texel_[1]};
    MF edge = hn::Lt(zero, zero);
    for (MF walks = hn::Not(done_); !hn::AllFalse(f, walks); ++rays.texel_steps) {
      VI inside[2];
      for (int a = 0; a < 2; ++a) inside[a] = hn::Min(hn::Max(texel_[a], hn::Zero(i32)), last_[a]);
      const Patch patch = patch_at(index_of(inside[0], inside[1]));
      const VF enters = side_of(patch, texel_[0], texel_[1], t_);
      const VF exits[] = {exit(0, texel_[0], one_i), exit(1, texel_[1], one_i)};
      const VF leave = hn::Min(hn::Min(exits[0], exits[1]), one);
      const VF leaves = side_of(patch, texel_[0], texel_[1], leave);
      enters_ = select(walks, enters, enters_), leave_ = select(walks, leave, leave_);
      const MF at_edge = hn::And(walks, hn::And(hn::Gt(before_, zero), hn::Le(enters, zero)));
      const MF meets = hn::And(walks, hn::And(hn::Gt(enters, zero), hn::Le(leaves, zero)));
      edge = hn::Or(edge, at_edge), hit_ = hn::Or(hit_, meets);
      const MF before_front = hn::Gt(enters, zero);
      const MF out = hn::And(hn::And(walks, hn::Le(before_, zero)),
                             hn::Or(before_front, hn::Gt(leaves, zero)));
      behind_to_ = select(out, select(before_front, t_, leave), behind_to_);
      const MF goes_on = hn::AndNot(hn::Or(at_edge, meets), walks);
      done_ = hn::Or(done_, hn::Or(meets, hn::And(goes_on, hn::Ge(leave, one))));
      const MF moves = hn::AndNot(done_, goes_on);
      const MF across = hn::Le(exits[0], exits[1]);
      for (int a = 0; a < 2; ++a) {
        const MF along = a == 0 ? across : hn::Not(across);
        const VI by = hn::IfThenElseZero(hn::RebindMask(i32, along), forward_[a]);
        moved_[a] = select(moves, by, moved_[a]);
        texel_[a] = select(moves, hn::Add(texel_[a], by), texel_[a]);
      }
      t_ = select(moves, leave, t_), before_ = select(moves, leaves, before_);
      done_ = hn::Or(done_, hn::And(moves, outside()));
      const MF other =
          hn::Or(differ(texel_[0], block[0], block_bits), differ(texel_[1], block[1], block_bits));
      walks = hn::AndNot(hn::Or(done_, other), moves);
    }
    if (!hn::AllFalse(f, edge)) pass_edge(edge);
    const VI coarser = hn::Set(i32, kBlockBits + kFactorBits);
    const MF rises =
        hn::Or(differ(texel_[0], block[0], coarser), differ(texel_[1], block[1], coarser));
    level_ = select(hn::AndNot(done_, rises), hn::Set(i32, kLevels > 1 ? 1 : 0), level_);
  }

  // Is it the surface's end, or only where two linked pieces do not quite meet?
  HWY_INLINE void pass_edge(MF edge) {
    const VF zero = hn::Zero(f);
    VI last[2], inside[2];
    for (int a = 0; a < 2; ++a) {
      last[a] = hn::Sub(texel_[a], moved_[a]);
      inside[a] = hn::Min(hn::Max(last[a], hn::Zero(i32)), last_[a]);
    }
    const VI index = index_of(inside[0], inside[1]);
    const Patch patch = patch_at(index);
    // Bits of kLinkSteps: right 0, down 2, left 4, up 6.
    const MF in_u = hn::RebindMask(f, hn::Ne(moved_[0], hn::Zero(i32)));
    const MF on = hn::RebindMask(f, hn::Gt(hn::Add(moved_[0], moved_[1]), hn::Zero(i32)));
    const VI bit = hn::Add(select(in_u, hn::Zero(i32), hn::Set(i32, 2)),
                           select(on, hn::Zero(i32), hn::Set(i32, 4)));
    const MF stands = hn::RebindMask(f, hn::Eq(hn::Or(moved_[0], moved_[1]), hn::Zero(i32)));
    const MF hole = hn::Or(stands, hn::Eq(patch.q, zero));
    const MF has_link = hn::RebindMask(
        f, hn::Ne(hn::And(hn::Shr(patch.links, bit), hn::Set(i32, 1)), hn::Zero(i32)));
    const VF ahead = side_of(patch, last[0], last[1], t_);
    const VF gap = hn::Mul(hn::Set(f, surface_.gap_per_q), patch.q);
    const MF meets = hn::And(hn::AndNot(hole, has_link), hn::Le(hn::Sub(ahead, enters_), gap));
    const MF joined = hn::And(edge, meets), ends = hn::AndNot(meets, edge);
    hit_ = hn::Or(hit_, joined), done_ = hn::Or(done_, joined);
    behind_from_ = select(hn::AndNot(behind_, ends), t_, behind_from_);
    behind_ = hn::Or(behind_, ends), outline_ = hn::Or(outline_, hn::And(edge, hole));
    end_t_ = select(edge, t_, end_t_);
    for (int a = 0; a < 2; ++a) end_[a] = select(joined, texel_[a], select(edge, last[a], end_[a]));
    leave_ = select(edge, t_, leave_);
    before_ = select(edge, hn::Set(f, -1.0f), before_);
  }

  // Between t (in front) and leave (not) a patch is met: a line meets a plane in each of the
  // stretches between the texel's middle lines.
  HWY_INLINE void meet() {
    const MF inside = hn::And(hit_, hn::Gt(leave_, t_));
    if (hn::AllFalse(f, inside)) return;
    const VF zero = hn::Zero(f), one = hn::Set(f, 1.0f), half = hn::Set(f, 0.5f);
    VI texel[2];
    VF middle[2];
    for (int a = 0; a < 2; ++a) {
      texel[a] = hn::Min(hn::Max(texel_[a], hn::Zero(i32)), last_[a]);
      const VF center = hn::Add(of(texel[a]), half);
      const VF crossed = hn::Add(hn::Mul(hn::Sub(center, from_[a]), per_step_[a]), never_[a]);
      middle[a] = hn::Min(hn::Max(crossed, t_), leave_);
    }
    const Patch patch = patch_at(index_of(texel[0], texel[1]));
    const auto side = [&](VF t) { return side_of(patch, texel[0], texel[1], t); };
    const VF t1 = hn::Min(middle[0], middle[1]), t2 = hn::Max(middle[0], middle[1]);
    const VF s1 = side(t1), s2 = side(t2), s3 = side(leave_);
    const MF first = hn::Le(s1, zero), second = hn::AndNot(first, hn::Le(s2, zero));
    const VF from = select(first, t_, select(second, t1, t2)),
             to = select(first, t1, select(second, t2, leave_)),
             s_from = select(first, enters_, select(second, s1, s2)),
             s_to = select(first, s1, select(second, s2, s3));
    VF share = hn::Div(s_from, hn::Max(hn::Sub(s_from, s_to), hn::Set(f, 1e-30f)));
    share = hn::Min(hn::Max(share, zero), one);
    end_t_ = select(inside, hn::Add(from, hn::Mul(hn::Sub(to, from), share)), end_t_);
    for (int a = 0; a < 2; ++a) end_[a] = select(inside, texel[a], end_[a]);
  }

  F f;
  I i32;
  const MarchSurface& surface_;
  VI columns_, last_[2];
  VF from_[3], step_[3];
  VF per_step_[2], never_[2];       // never: of an axis along which the segment does not move
  VI ahead_[2], forward_[2];        // 0 or 1; -1 or 1
  VI texel_[2], moved_[2], level_;  // moved: the step that led to the texel
  VF t_, before_;                   // the side that the last texel was left on
  VF enters_, leave_;               // of the last texel
  VF end_t_;
  VI end_[2];
  VF behind_from_, behind_to_;
  MF done_, hit_, behind_, outline_;
};

void march(const MarchSurface& surface, MarchRays& rays) {
  rays.hit = rays.passed_behind = rays.passed_outline = 0;
  rays.cell_steps = rays.texel_steps = 0;
  const int lanes = int(hn::Lanes(F()));
  for (int first = 0; first < MarchRays::kCount; first += lanes) {
    if (!(rays.wanted >> first & ((1u << lanes) - 1))) continue;
    March march(surface, rays, first);
    march.run(rays);
    march.store(rays, first);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(march);

MarchSurface make_march_surface(const TexelSurface& surface) {
  MarchSurface out;
  out.width = surface.texels.width(), out.height = surface.texels.height();
  out.sigma = surface.camera.keeps_farthest() ? -1.0f : 1.0f;
  out.gap_per_q = float(patch_gap_per_q(surface.camera));
  out.texels.reserve(surface.texels.texels().size());
  for (const SurfaceTexel& texel : surface.texels.texels()) {
    const auto& [right, down, left, up] = texel.slope;
    out.texels.push_back({texel.q, {right, down, left, up}, texel.links});
  }
  const CellTexture layout = cell_texture(out.width, out.height);
  out.level_at = layout.level_at;
  out.cells = pyramid_cells(surface, layout);
  return out;
}

void march_rays(const MarchSurface& surface, MarchRays& rays) {
  HWY_DYNAMIC_DISPATCH(march)(surface, rays);
}

}  // namespace rilievo
#endif
