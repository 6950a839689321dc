#include "rilievo/relief_impostor/impostor_warp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

#include "rilievo/render/shading/simd_test_helpers.h"

namespace rilievo {
namespace {

Camera warp_test_camera(int width, int height) {
  return look_at({0.3, 0.2, 3}, {0, 0, 0}, {0, 1, 0}, 0.5, width, height, 2.0, 4.0);
}

// Depths in steps and slopes, with holes; `thin`: and with texels that are not opaque.
ImpostorPicture random_impostor(std::mt19937& rng, int width, int height, bool thin = false) {
  Nailboard board;
  board.geometry = picture_geometry(warp_test_camera(width, height));
  board.geometry.delta_bits = kLevelBits;
  board.color = Rgba8Image(width, height);
  board.delta = Image<std::uint16_t>(width, height);
  std::uniform_int_distribution<int> byte(0, 255), level(0, int(delta_steps(kLevelBits)));
  int at = level(rng);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (byte(rng) < 40) at = level(rng);
      at = std::clamp(at + (byte(rng) - 128) / 16, 0, int(delta_steps(kLevelBits)));
      const bool hole = byte(rng) < 30;
      const int alpha = hole ? 0 : thin && byte(rng) < 30 ? 1 + byte(rng) % 255 : 255;
      const int red = byte(rng) * alpha / 255, green = byte(rng) * alpha / 255;
      board.color(x, y) = glm::u8vec4(red, green, byte(rng) * alpha / 255, alpha);
      board.delta(x, y) = std::uint16_t(hole ? kEmptyLevel : at);
    }
  return impostor_picture(board);
}

// Colours, premultiplied: `a` mixed with `b` by 256ths; `front` before `behind`.
std::uint32_t slow_mix(std::uint32_t a, std::uint32_t b, std::uint32_t weight) {
  std::uint32_t color = 0;
  for (int c = 0; c < 32; c += 8)
    color |= (((a >> c & 255) * (256 - weight) + (b >> c & 255) * weight + 128) >> 8) << c;
  return color;
}
std::uint32_t slow_over(std::uint32_t front, std::uint32_t behind) {
  std::uint32_t color = 0;
  for (int c = 0; c < 32; c += 8) {
    const double sum = double(front >> c & 255) +
                       std::floor(double(behind >> c & 255) * (255 - (front >> 24)) / 255 + 0.5);
    color |= std::uint32_t(std::min(255.0, sum)) << c;
  }
  return color;
}

// One row or column, one sample at a time; the same operations on floats in the same order. First
// what is opaque, then silhouettes.
std::vector<WarpTexel> slow_pass(const AxisWarp& k, const std::vector<WarpTexel>& in,
                                 int out_count) {
  const int count = int(in.size());
  std::vector<WarpTexel> out(std::size_t(out_count), WarpTexel{0, kEmptyWarped});
  const auto code = [&](int i) {
    return i < 0 || i >= count ? kEmptyWarped : in[std::size_t(i)].code & 0xffff;
  };
  const auto opaque = [&](int i) { return in[std::size_t(i)].color >> 24 == 255; };
  const auto position = [&](int i) {
    return (k.a0 + k.a1 * float(i)) + float(code(i)) * (k.b0 + k.b1 * float(i));
  };
  const auto cell = [&](float x) { return int(std::clamp(x + 0.5f, 0.0f, float(out_count))); };
  const auto put = [&](int x, const WarpTexel& front) {
    WarpTexel& texel = out[std::size_t(x)];
    if (front.color >> 24 < kFaintAlpha) return;
    if (texel.code == kEmptyWarped) {
      texel = front;
      return;
    }
    const WarpTexel was = texel;
    const bool nearer = (front.code & 0xffff) <= (was.code & 0xffff);
    const WarpTexel &first = nearer ? front : was, &second = nearer ? was : front;
    texel.color = slow_over(first.color, second.color);
    texel.code = first.color >> 24 >= 128 ? first.code : second.code;
  };
  const auto mixed = [&](int i, int x) {
    const float p = position(i), center = float(x) + 0.5f, next = position(i + 1);
    const float t = std::clamp((center - p) / (next - p), 0.0f, 1.0f);
    const WarpTexel &a = in[std::size_t(i)], &b = in[std::size_t(i + 1)];
    WarpTexel texel{slow_mix(a.color, b.color, std::uint32_t(t * 256.0f + 0.5f)), 0};
    const auto qa = float(code(i)), qb = float(code(i + 1));
    texel.code = std::uint32_t(qa + t * (qb - qa) + 0.5f);
    texel.code |= (t < 0.5f ? a : b).code & (kInterpolatedBit | kTornBit);
    if (std::abs(center - p) > k.reach && std::abs(next - center) > k.reach)
      texel.code |= kInterpolatedBit;
    if (next - p > kTear) texel.code |= kTornBit;
    return texel;
  };
  const auto piece = [&](int i, bool silhouettes) {
    if (code(i) == kEmptyWarped) return;
    const WarpTexel& a = in[std::size_t(i)];
    const float p = position(i), size = k.a1 + float(code(i)) * k.b1;
    const auto fade = [&](float from, float to) {
      for (int x = cell(from); x < cell(to); ++x) {
        const float t = std::min(std::abs(float(x) + 0.5f - p) / size, 1.0f);
        put(x, {slow_mix(a.color, 0, std::uint32_t(t * 256.0f + 0.5f)), a.code});
      }
    };
    const bool linked = code(i + 1) != kEmptyWarped;
    const bool solid = linked && opaque(i) && opaque(i + 1);
    if (silhouettes && code(i - 1) == kEmptyWarped && size > 0) fade(p - size, p);
    if (silhouettes && !linked && size > 0) fade(p, p + size);
    if (!linked || solid == silhouettes) return;
    for (int x = cell(p); x < cell(position(i + 1)); ++x) {
      if (silhouettes)
        put(x, mixed(i, x));
      else
        out[std::size_t(x)] = mixed(i, x);
    }
  };
  for (const bool silhouettes : {false, true})
    for (const AxisWarp::Range& range : k.ranges)
      for (int n = 0; n < range.to - range.from; ++n)
        piece(range.up ? range.from + n : range.to - 1 - n, silhouettes);
  return out;
}

AxisWarp random_axis(std::mt19937& rng, int count) {
  std::uniform_real_distribution<float> any(-1, 1);
  AxisWarp k;
  k.a0 = 20 * any(rng), k.a1 = 1.0f + 0.7f * any(rng);
  k.b0 = 4e-4f * any(rng), k.b1 = 1e-5f * any(rng);
  const int split = std::uniform_int_distribution<int>(0, count)(rng);
  k.ranges[0] = {0, split, any(rng) > 0};
  k.ranges[1] = {split, count, any(rng) > 0};
  return k;
}

void expect_passes_equal_the_slow_definition() {
  std::mt19937 rng(1);
  for (int round = 0; round < 60; ++round) {
    const int width = std::uniform_int_distribution<int>(1, 150)(rng);
    const int height = std::uniform_int_distribution<int>(1, 90)(rng);
    const int out_width = std::uniform_int_distribution<int>(1, 170)(rng);
    const int out_height = std::uniform_int_distribution<int>(1, 100)(rng);
    const ImpostorPicture picture = random_impostor(rng, width, height, round % 3 > 0);
    std::vector<std::uint32_t> table(kEmptyLevel + 1);
    const LevelCodes codes{1.4f, -1e-4f, 1.1f, 1e-5f, 90000, -64000};
    level_table(codes, table.data());
    for (std::uint32_t level = 0; level < kEmptyLevel; ++level) {
      const float nearness = (1.4f + -1e-4f * float(level)) / (1.1f + 1e-5f * float(level));
      ASSERT_EQ(table[level],
                std::uint32_t(std::clamp((90000 + -64000 * nearness) + 0.5f, 0.0f, 65534.0f)));
    }
    ASSERT_EQ(table[kEmptyLevel], kEmptyWarped);
    const AxisWarp across = random_axis(rng, width), down = random_axis(rng, height);

    const std::size_t block = warp_block(height);
    std::vector<std::uint32_t> between(block * ((std::size_t(out_width) + 15) / 16), kEmptyWarped);
    std::vector<std::byte> scratch(row_pass_scratch(width, out_width));
    std::vector<std::vector<WarpTexel>> expected;
    for (int y = 0; y < height; ++y) {
      row_pass(across, codes, table.data(), &picture.at(0, y), width, &between[std::size_t(y) * 32],
               block, out_width, scratch.data());
      std::vector<WarpTexel> row(&picture.at(0, y), &picture.at(0, y) + width);
      for (WarpTexel& texel : row) texel.code = table[texel.code];
      expected.push_back(slow_pass(across, row, out_width));
      for (int x = 0; x < out_width; ++x) {
        const WarpTexel& texel = expected.back()[std::size_t(x)];
        const std::uint32_t* found =
            &between[std::size_t(x / 16) * block + std::size_t(y * 32 + x % 16)];
        // A row that shows nothing has no colours.
        if (texel.code != kEmptyWarped) {
          ASSERT_EQ(found[0], texel.color) << x << ' ' << y;
        }
        ASSERT_EQ(found[16], texel.code) << x << ' ' << y;
      }
    }
    const std::size_t plane_pitch = std::size_t(out_width) + 3;
    std::vector<std::uint32_t> color(plane_pitch * std::size_t(out_height), 7);
    std::vector<std::uint16_t> delta(color.size(), 7), flags(color.size(), 7);
    const WarpPlanes planes{color.data(), delta.data(), flags.data(), plane_pitch};
    scratch.resize(column_pass_scratch(height, out_height));
    WarpedTexels counted, wanted;
    for (int x = 0; x < out_width; x += kWarpStrip) {
      const WarpedTexels part =
          column_pass(down, between.data(), block, height, x, std::min(kWarpStrip, out_width - x),
                      planes, out_height, scratch.data());
      counted.covered += part.covered, counted.interpolated += part.interpolated;
    }
    for (int x = 0; x < out_width; ++x) {
      std::vector<WarpTexel> column;
      for (const auto& row : expected) column.push_back(row[std::size_t(x)]);
      const std::vector<WarpTexel> drawn = slow_pass(down, column, out_height);
      for (int y = 0; y < out_height; ++y) {
        const std::size_t at = std::size_t(y) * plane_pitch + std::size_t(x);
        const WarpTexel& texel = drawn[std::size_t(y)];
        ASSERT_EQ(color[at], texel.color) << x << ' ' << y;
        ASSERT_EQ(delta[at], texel.code & 0xffff) << x << ' ' << y;
        ASSERT_EQ(flags[at], texel.code == kEmptyWarped ? 0 : texel.code >> 16) << x << ' ' << y;
        wanted.covered += texel.code != kEmptyWarped;
        wanted.interpolated += (texel.code & kInterpolatedBit) != 0;
      }
    }
    // Nothing beyond the columns is written.
    for (int y = 0; y < out_height; ++y)
      for (std::size_t x = std::size_t(out_width); x < plane_pitch; ++x)
        ASSERT_EQ(color[std::size_t(y) * plane_pitch + x], 7u);
    EXPECT_EQ(counted.covered, wanted.covered);
    EXPECT_EQ(counted.interpolated, wanted.interpolated);
  }
}

TEST(ImpostorWarp, passes_equal_the_slow_definition_to_the_byte_whatever_the_instruction_set) {
  for_each_instruction_set([](const char* name) {
    SCOPED_TRACE(name);
    expect_passes_equal_the_slow_definition();
  });
}

TEST(ImpostorWarp, its_formula_projects_points_of_the_picture_onto_the_plane) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int round = 0; round < 300; ++round) {
    const PictureGeometry picture = picture_geometry(warp_test_camera(200, 120));
    const glm::dvec3 eye =
        picture.capture.position() + glm::dvec3(any(rng), any(rng), 0.8 * any(rng));
    const auto warp = plane_warp(picture, eye);
    ASSERT_TRUE(warp);
    const glm::dvec2 raster(100 + 100 * any(rng), 60 + 60 * any(rng));
    const double depth = 3 + any(rng);
    const glm::dvec3 point = world_from_raster(picture.capture, raster, depth);
    const double nearness = warp->nearness(depth / picture.plane_z);
    if (!(nearness > 0)) continue;
    const glm::dvec2 moved(warp->x.moved(raster.x, nearness), warp->y.moved(raster.y, nearness));
    const glm::dvec3 shown = world_from_raster(picture.capture, moved, picture.plane_z);
    const glm::dvec3 off = glm::cross(glm::normalize(shown - eye), glm::normalize(point - eye));
    EXPECT_LT(glm::length(off), 1e-12);
    EXPECT_NEAR(warp->height / nearness, glm::dot(point - eye, picture.capture.forward()), 1e-12);
  }
}

// A tilted plane whose colour tells the position.
TEST(ImpostorWarp, what_it_shows_of_a_plane_lies_on_the_plane_in_the_right_colour) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int round = 0; round < 12; ++round) {
    const Camera camera = warp_test_camera(160, 120);
    const glm::dvec3 normal = glm::normalize(glm::dvec3(0.5 * any(rng), 0.5 * any(rng), 1));
    DepthImage picture;
    picture.camera = camera;
    picture.depth_kind = DepthKind::eye_z;
    picture.color = ColorImage(camera.width, camera.height);
    picture.depth = Image<float>(camera.width, camera.height);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const glm::dvec3 far = world_from_raster(camera, {x + 0.5, y + 0.5}, 1);
        const glm::dvec3 ray = far - camera.position();
        const double z = -glm::dot(normal, camera.position()) / glm::dot(normal, ray);
        picture.depth(x, y) = z > 2.1 && z < 3.9 ? float(z) : kNoDepth;
        picture.color(x, y) = z > 2.1 && z < 3.9 ? glm::vec4(0.5, 0.5, 0.5, 1) : glm::vec4(0);
      }
    const ImpostorPicture impostor = impostor_picture(picture);
    const glm::dvec3 eye = camera.position() + 0.6 * glm::dvec3(any(rng), any(rng), any(rng));
    ImpostorWarpScratch scratch;
    Prewarped result;
    const auto counted = warp_impostor(impostor, eye, {}, scratch, result);
    ASSERT_TRUE(counted);
    std::size_t shown = 0;
    for (int y = 0; y < result.height(); ++y)
      for (int x = 0; x < result.width(); ++x) {
        const std::uint16_t code = result.delta[std::size_t(y * result.width() + x)];
        if (code == kEmptyWarped) continue;
        ++shown;
        const glm::dvec2 raster(x + 0.5, y + 0.5);
        const double z = eye_z_from(DepthKind::window_z, double(decode_delta(code, 16)),
                                    result.geometry.capture, raster);
        const glm::dvec3 point = world_from_raster(result.geometry.capture, raster, z);
        // A level of the source is 0.5 mm of depth. At the ends, a texel that fades has its end's
        // depth: at most 16 mm along each axis, on a slope of at most 0.6.
        EXPECT_NEAR(glm::dot(normal, point), 0, 0.02);
      }
    EXPECT_EQ(shown, counted->covered);
    EXPECT_GT(shown, 5000u);
  }
}

TEST(ImpostorWarp, its_own_eye_sees_the_picture_unchanged) {
  std::mt19937 rng(4);
  const ImpostorPicture picture = random_impostor(rng, 90, 70);
  ImpostorWarpScratch scratch;
  Prewarped result;
  const auto counted =
      warp_impostor(picture, picture.geometry.capture.position(), {}, scratch, result);
  ASSERT_TRUE(counted);
  EXPECT_EQ(counted->interpolated, 0u);
  // A texel of room for silhouettes on each side.
  const glm::ivec2 size = picture.max - picture.min;
  ASSERT_EQ(result.width(), size.x + 2);
  ASSERT_EQ(result.height(), size.y + 2);
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      const WarpTexel& from = picture.at(picture.min.x + x, picture.min.y + y);
      const auto to = std::bit_cast<glm::u8vec4>(from.color);
      const glm::u8vec4 found = result.color[std::size_t((y + 1) * result.width() + x + 1)];
      // Positions are rounded to floats: up to one 256th of a neighbour, in each pass.
      for (int c = 0; c < 4; ++c) EXPECT_NEAR(int(found[c]), int(to[c]), 2) << x << ' ' << y;
    }
}

TEST(ImpostorWarp, threads_change_nothing_and_a_second_warp_allocates_nothing) {
  std::mt19937 rng(5);
  const ImpostorPicture picture = random_impostor(rng, 200, 170);
  const glm::dvec3 eye = picture.geometry.capture.position() + glm::dvec3(0.2, -0.1, 0.1);
  ImpostorWarpScratch alone, together;
  Prewarped a, b;
  const auto first = warp_impostor(picture, eye, {.parallel = false}, alone, a);
  const auto second = warp_impostor(picture, eye, {.parallel = true}, together, b);
  ASSERT_TRUE(first && second);
  EXPECT_TRUE(a.color == b.color && a.delta == b.delta);
  EXPECT_EQ(first->interpolated, second->interpolated);
  EXPECT_GT(first->share(), 0.05);
  const void* before[] = {alone.between.data(), alone.bytes.data(), alone.table.data(),
                          a.color.data(),       a.delta.data(),     alone.flags.data()};
  ASSERT_TRUE(warp_impostor(picture, eye, {.parallel = false}, alone, a));
  const void* after[] = {alone.between.data(), alone.bytes.data(), alone.table.data(),
                         a.color.data(),       a.delta.data(),     alone.flags.data()};
  EXPECT_TRUE(std::equal(before, before + 6, after));
}

// Rows alone: the surface that is drawn last is the nearest of those that cover a texel.
TEST(ImpostorWarp, nearer_surfaces_hide_farther_ones_wherever_the_eye_goes) {
  std::mt19937 rng(6);
  std::uniform_real_distribution<double> any(-1, 1);
  std::size_t compared = 0, several = 0;
  for (int round = 0; round < 900; ++round) {
    const ImpostorPicture picture = random_impostor(rng, 120, 1);
    const PictureGeometry& geometry = picture.geometry;
    // Eyes in the row's own plane, before and behind the captured eye.
    const glm::dmat4& axes = geometry.capture.world_from_eye;
    const glm::dvec3 eye = geometry.capture.position() + glm::dvec3(axes[0]) * any(rng) +
                           glm::dvec3(axes[2]) * (round % 5 ? 0.7 * any(rng) : 0.0);
    ImpostorWarpScratch scratch;
    Prewarped result;
    if (!warp_impostor(picture, eye, {}, scratch, result)) continue;
    const auto warp = plane_warp(geometry, eye);
    // Samples in the result's texels, and their nearness.
    std::vector<glm::dvec2> at(120, glm::dvec2(0));
    int row = 0;
    for (int x = 0; x < 120; ++x) {
      const WarpTexel& from = picture.at(x, 0);
      if (from.code == kEmptyLevel) continue;
      const double z = eye_z_from(DepthKind::window_z, double(decode_delta(from.code, kLevelBits)),
                                  geometry.capture, {});
      const glm::dvec3 world = world_from_raster(geometry.capture, {x + 0.5, 0.5}, z);
      const glm::dvec3 raster = raster_from_world(result.geometry.capture, world);
      at[std::size_t(x)] = {raster.x, warp->height / raster.z};
      row = int(std::floor(raster.y));  // the middle of the picture's: the same for all
    }
    for (int x = 0; x < result.width(); ++x) {
      double nearest = 0;
      int covering = 0;
      bool near_an_end = false;
      for (const glm::dvec2& end : {at.front(), at.back()})
        near_an_end |= end.y > 0 && std::abs(end.x - (x + 0.5)) < kMaxImpostorMagnification / 2;
      for (int i = 0; i + 1 < 120; ++i) {
        const glm::dvec2 &a = at[std::size_t(i)], &b = at[std::size_t(i + 1)];
        const double center = x + 0.5;
        if ((a.y > 0) != (b.y > 0))
          near_an_end |= std::abs((a.y > 0 ? a.x : b.x) - center) < kMaxImpostorMagnification / 2;
        if (!(a.y > 0 && b.y > 0 && a.x < center && center < b.x)) continue;
        ++covering;
        nearest = std::max(nearest, a.y + (b.y - a.y) * (center - a.x) / (b.x - a.x));
      }
      // Beside an end, half a sample may hide or be hidden.
      if (covering == 0 || near_an_end) continue;
      const std::uint16_t code = result.delta[std::size_t(row * result.width() + x)];
      ASSERT_NE(code, kEmptyWarped);
      const double shown =
          warp->height / eye_z_from(DepthKind::window_z, double(decode_delta(code, 16)),
                                    result.geometry.capture, {});
      // Rounding of two codes, on a piece that is never steeper than the whole slab a texel.
      EXPECT_NEAR(shown, nearest, 0.01) << round << ' ' << x;
      ++compared;
      several += covering > 1;
    }
  }
  EXPECT_GT(compared, 2000u);
  EXPECT_GT(several, 300u);
}

}  // namespace
}  // namespace rilievo
