#include "rilievo/render/raster/sample_raster.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <random>

#include "rilievo/core/sanitized_test_helpers.h"
#include "rilievo/render/shading/simd_test_helpers.h"

namespace rilievo {
namespace {

constexpr std::uint32_t kNothing = 0xFFFFFFFFu;

struct Soup {
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> indices;
  RasterInstance instance;
};

// A view of [-1, 1]^2 from a distance, slightly turned, that fills the picture.
void look(Soup& soup, int width, int height, float turn) {
  RasterInstance& r = soup.instance;
  r.positions = soup.positions.data();
  r.indices = soup.indices.data();
  r.triangles = std::uint32_t(soup.indices.size() / 3);
  const float w = float(width), h = float(height);
  r.row_w = {0.2f * turn, 0.1f, -0.3f, 2};
  r.row_x = 0.5f * w * (glm::vec4(2, turn, 0, 0) + r.row_w);
  r.row_y = 0.5f * h * (glm::vec4(-turn, 2, 0, 0) + r.row_w);
  r.row_z = {0, 0, 0.4f, 1};
}

// Triangles of all sizes, some of them far beyond the picture, that meet and cut each other.
Soup random_soup(std::mt19937& rng, int triangles) {
  std::uniform_real_distribution<float> u(-1, 1);
  Soup soup;
  for (int i = 0; i < triangles; ++i) {
    const float size = std::pow(10.0f, 1.2f * u(rng) - 0.8f);
    const glm::vec3 center(u(rng), u(rng), u(rng));
    for (int k = 0; k < 3; ++k) {
      soup.indices.push_back(std::uint32_t(soup.positions.size()));
      soup.positions.push_back(center + size * glm::vec3(u(rng), u(rng), u(rng)));
    }
    // Some are long and thin: most of their bounds is empty.
    if (i % 3 != 2) continue;
    const glm::vec3* corner = &soup.positions[soup.positions.size() - 3];
    soup.positions.back() = glm::mix(corner[0], corner[1], 0.5f + 0.5f * u(rng)) +
                            0.03f * size * glm::vec3(u(rng), u(rng), u(rng));
  }
  // What must not be seen at all: no area, no number.
  soup.indices.insert(soup.indices.end(), {0, 0, 1, 2, 2, 2});
  soup.indices.insert(soup.indices.end(), {0, 1, std::uint32_t(soup.positions.size())});
  soup.positions.push_back({NAN, 0, 0});
  return soup;
}

struct Nearest {
  double z = 1;
  std::uint32_t name = kNothing;
  bool doubtful = false;  // so near an edge, or two depths so alike, that rounding decides
};

// By definition: all triangles, in doubles.
Nearest slow_nearest(const std::vector<Soup>& soups, const glm::dvec2& at) {
  Nearest best;
  for (const Soup& soup : soups)
    for (std::uint32_t t = 0; t < soup.instance.triangles; ++t) {
      glm::dvec3 c[3];
      bool behind = false;
      for (int k = 0; k < 3; ++k) {
        const glm::dvec4 p(glm::dvec3(soup.positions[soup.indices[3 * t + std::uint32_t(k)]]), 1);
        const RasterInstance& r = soup.instance;
        const double w = glm::dot(glm::dvec4(r.row_w), p);
        behind |= !(w > 0);
        c[k] = glm::dvec3(glm::dot(glm::dvec4(r.row_x), p), glm::dot(glm::dvec4(r.row_y), p),
                          glm::dot(glm::dvec4(r.row_z), p)) /
               w;
      }
      if (behind) continue;
      const auto cross = [](const glm::dvec2& a, const glm::dvec2& b) {
        return a.x * b.y - a.y * b.x;
      };
      const double area = cross(glm::dvec2(c[1] - c[0]), glm::dvec2(c[2] - c[0]));
      if (!(area > 0 ? soup.instance.front : area < 0 && soup.instance.back)) continue;
      double share[3], nearest_edge = 1e300;
      for (int k = 0; k < 3; ++k) {
        const glm::dvec2 a(c[(k + 1) % 3]), b(c[(k + 2) % 3]);
        share[k] = cross(b - a, at - a) / area;
        nearest_edge = std::min(nearest_edge,
                                share[k] * std::abs(area) / std::max(glm::length(b - a), 1e-300));
      }
      // Floats: a few parts in 2^24 of coordinates up to some hundreds.
      constexpr double kEdge = 1e-3, kDepth = 1e-5;
      if (nearest_edge < -kEdge) continue;
      const double z = std::max(0.0, share[0] * c[0].z + share[1] * c[1].z + share[2] * c[2].z);
      const bool at_edge = nearest_edge < kEdge;
      if (z > best.z + kDepth) continue;
      best.doubtful =
          (best.doubtful && z > best.z - kDepth) || at_edge || std::abs(z - best.z) <= kDepth;
      if (nearest_edge >= 0 && z < best.z) {
        best.z = z;
        best.name = soup.instance.first_triangle + t;
      }
    }
  return best;
}

// One sample a texel, four, or a staggered one.
struct Sampling {
  int samples = 1;
  bool staggered = false;

  explicit Sampling(int round) : samples(round % 3 == 1 ? 4 : 1), staggered(round % 3 == 2) {}
  void begin(SampleRaster& raster, int width, int height) const {
    raster.begin(width, height, samples, staggered);
  }
  [[nodiscard]] glm::dvec2 at(int x, int y, int s) const {
    return glm::dvec2(x, y) +
           glm::dvec2(staggered ? staggered_position(x, y) : sample_position(s, samples));
  }
};

// As the four samples of a texel of twice the size do, but for the last digit of their places.
TEST(SampleRaster, staggered_samples_are_in_columns_and_rows_of_their_own) {
  std::vector<float> columns, rows;
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 2; ++x) {
      const glm::vec2 at = glm::vec2(x, y) + staggered_position(x, y);
      columns.push_back(at.x), rows.push_back(at.y);
    }
  for (std::vector<float>* places : {&columns, &rows}) {
    std::ranges::sort(*places);
    // A quarter of two texels apart would be even.
    for (std::size_t i = 1; i < 4; ++i)
      EXPECT_NEAR((*places)[i] - (*places)[i - 1], 0.5f, 2 * (0.25f - kStagger)) << i;
  }
}

TEST(SampleRaster, finds_the_triangle_that_is_nearest_among_all) {
  for_each_instruction_set([](const char* name) {
    std::mt19937 rng(5);
    int compared = 0, covered = 0;
    for (int round = 0; round < sanitized_cases(24); ++round) {
      const Sampling sampling(round);
      const int samples = sampling.samples;
      const int width = 1 + int(rng() % 90), height = 1 + int(rng() % 60);
      std::vector<Soup> soups;
      std::vector<RasterInstance> instances;
      std::uint32_t first_triangle = 0;
      for (int i = 0; i < 3; ++i) {
        soups.push_back(random_soup(rng, 5 << (round % 5)));
        look(soups.back(), width, height, 0.3f * float(i));
        RasterInstance& r = soups.back().instance;
        r.front = i != 1, r.back = i != 0;
        r.first_triangle = first_triangle;
        first_triangle += r.triangles;
      }
      for (const Soup& soup : soups) instances.push_back(soup.instance);
      SampleRaster raster;
      sampling.begin(raster, width, height);
      raster.draw(instances);
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
          for (int s = 0; s < samples; ++s) {
            const Nearest expected = slow_nearest(soups, sampling.at(x, y, s));
            if (expected.doubtful) continue;
            ++compared;
            const float z = raster.seen().depths(y)[x * samples + s];
            // Floats again; z is at most 1, its slopes are steep.
            ASSERT_NEAR(z, expected.z, 2e-5)
                << name << ", round " << round << ": " << x << " " << y;
            if (expected.z >= 1) continue;
            ++covered;
            ASSERT_EQ(raster.seen().triangles(y)[x * samples + s], expected.name);
          }
    }
    EXPECT_GT(compared, sanitized_cases(50'000));
    EXPECT_GT(covered, compared / 3);
  });
}

// How many of its triangles cover each sample of a square picture, each drawn alone.
std::vector<int> times_covered(const RasterInstance& instance, int size, const Sampling& sampling) {
  const int samples = sampling.samples;
  std::vector<int> times(std::size_t(size * size * samples));
  SampleRaster raster;
  for (std::uint32_t t = 0; t < instance.triangles; ++t) {
    RasterInstance one = instance;
    one.indices += 3 * t;
    one.triangles = 1;
    sampling.begin(raster, size, size);
    raster.draw({&one, 1});
    for (int y = 0; y < size; ++y)
      for (int i = 0; i < size * samples; ++i)
        times[std::size_t(y * size * samples + i)] += raster.seen().depths(y)[i] < 1;
  }
  return times;
}

// A crumpled sheet, not folded over, that reaches beyond the picture.
TEST(SampleRaster, leaves_no_gap_between_neighbours_and_takes_no_sample_twice) {
  std::mt19937 rng(6);
  std::uniform_real_distribution<float> u(-1, 1);
  for (int round = 0; round < 12; ++round) {
    const int n = 2 + 3 * round, size = 80;
    Soup soup;
    const Sampling sampling(round);
    // In texels. Every other sheet has corners that lie on samples.
    for (int y = 0; y <= n; ++y)
      for (int x = 0; x <= n; ++x) {
        glm::vec2 p(1.5f * (2.0f * float(x) / float(n) - 1),
                    1.5f * (2.0f * float(y) / float(n) - 1));
        p += 0.8f / float(n) * glm::vec2(u(rng), u(rng));
        p = 0.5f * float(size) * (p + 1.0f);
        if (round % 2 == 0)
          p = sampling.staggered ? (2.0f * glm::floor(p * 8.0f) + 1.0f) / 16.0f
                                 : glm::round(p * 8.0f) / 8.0f;
        soup.positions.emplace_back(p, 0.2f * u(rng));
      }
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const auto a = std::uint32_t(y * (n + 1) + x), b = a + 1, c = a + std::uint32_t(n) + 1,
                   d = c + 1;
        if (rng() % 2)
          soup.indices.insert(soup.indices.end(), {a, b, d, a, d, c});
        else
          soup.indices.insert(soup.indices.end(), {a, b, c, b, d, c});
      }
    look(soup, size, size, 0.0f);
    soup.instance.row_x = {1, 0, 0, 0}, soup.instance.row_y = {0, 1, 0, 0};
    soup.instance.row_w = {0, 0, 0, 1}, soup.instance.row_z = {0, 0, 0.25f, 0.5f};
    soup.instance.front = soup.instance.back = true;
    for (const int t : times_covered(soup.instance, size, sampling))
      ASSERT_EQ(t, 1) << "sheet " << round;
  }
}

// An edge of two triangles that reaches up to 10^7 texels beyond the picture: single precision has
// no more.
TEST(SampleRaster, leaves_no_gap_along_an_edge_however_far_it_reaches) {
  std::mt19937 rng(9);
  std::uniform_real_distribution<float> u(-1, 1);
  constexpr int kSize = 80;
  for (int round = 0; round < sanitized_cases(400); ++round) {
    const float angle = 4 * u(rng), far = std::pow(10.0f, 5 + 2 * u(rng));
    const glm::vec2 along(std::cos(angle), std::sin(angle)), across(-along.y, along.x);
    const glm::vec2 middle = 0.5f * float(kSize) + 35.0f * glm::vec2(u(rng), u(rng));
    const glm::vec2 places[] = {middle - 400.0f * along, middle + far * along,
                                middle + 1000 * far * across, middle - 1000 * far * across};
    Soup soup;
    for (const glm::vec2& p : places) soup.positions.emplace_back(p, 0);
    soup.indices = round % 2 ? std::vector<std::uint32_t>{0, 1, 2, 1, 0, 3}
                             : std::vector<std::uint32_t>{1, 2, 0, 0, 3, 1};
    look(soup, kSize, kSize, 0);
    soup.instance.row_x = {1, 0, 0, 0}, soup.instance.row_y = {0, 1, 0, 0};
    soup.instance.row_w = {0, 0, 0, 1}, soup.instance.row_z = {0, 0, 0, 0.5f};
    soup.instance.front = soup.instance.back = true;
    for (const int t : times_covered(soup.instance, kSize, Sampling(1 + round / 2 % 2)))
      ASSERT_EQ(t, 1) << "round " << round << ", " << far << " texels";
  }
}

// The depth and the triangle of each sample; the triangle of one that shows none is kNothing.
std::vector<std::uint32_t> bytes_of(const SampleBuffer& seen) {
  std::vector<std::uint32_t> bytes;
  for (int y = 0; y < seen.height; ++y)
    for (int i = 0; i < seen.width * seen.samples; ++i) {
      const float z = seen.depths(y)[i];
      bytes.push_back(z < 1 ? seen.triangles(y)[i] : kNothing);
      bytes.push_back(0);
      std::memcpy(&bytes.back(), &z, sizeof z);
    }
  return bytes;
}

// Small triangles, neighbours near each other in their order, between z = -1 and 1.
Soup crowd(std::mt19937& rng, int triangles) {
  std::uniform_real_distribution<float> u(-1, 1);
  Soup soup;
  glm::vec3 center(0);
  for (int i = 0; i < triangles; ++i) {
    if (i % int(SampleRaster::kPiece) == 0) center = glm::vec3(2 * u(rng), 2 * u(rng), u(rng));
    const glm::vec3 at = center + 0.2f * glm::vec3(u(rng), u(rng), 0.2f * u(rng));
    float size = 0.08f * std::pow(10.0f, 0.7f * u(rng) - 0.7f);  // 0.1 to 2.5 texels
    if (i % 40 == 0) size *= 12;
    for (int k = 0; k < 3; ++k) {
      soup.indices.push_back(std::uint32_t(soup.positions.size()));
      soup.positions.push_back(at + size * glm::vec3(u(rng), u(rng), 0.3f * u(rng)));
    }
  }
  return soup;
}

// By definition: runs drawn each into a picture of its own, where nothing is known of the others,
// and of each sample the first that is nearest.
TEST(SampleRaster, leaves_out_what_is_hidden_and_shows_the_same) {
  for_each_instruction_set([](const char* name) {
    std::mt19937 rng(8);
    for (int round = 0; round < sanitized_cases(12); ++round) {
      const Sampling sampling(round);
      const int width = 64 + int(rng() % 60), height = 64 + int(rng() % 60);
      std::vector<Soup> soups;
      for (int i = 0; i < 3; ++i) soups.push_back(crowd(rng, 40'000));
      std::vector<std::vector<Box>> boxes(soups.size());
      std::vector<RasterInstance> instances;
      std::uint32_t triangles = 0;
      for (std::size_t i = 0; i < soups.size(); ++i) {
        Soup& soup = soups[i];
        look(soup, width, height, 0.1f * float(round));
        RasterInstance& r = soup.instance;
        r.back = true;
        if (round % 2 == 1) r.row_z = r.row_w - r.row_z;  // the farthest are kept
        r.first_triangle = triangles;
        triangles += r.triangles;
        for (std::uint32_t t = 0; t < r.triangles; ++t) {
          if (t % SampleRaster::kPiece == 0) boxes[i].emplace_back();
          for (int k = 0; k < 3; ++k)
            boxes[i].back().add(soup.positions[soup.indices[3 * t + std::uint32_t(k)]]);
        }
        r.boxes = boxes[i];
        instances.push_back(r);
      }
      SampleRaster raster, alone;
      sampling.begin(raster, width, height);
      raster.draw(instances);
      const auto found = bytes_of(raster.seen());
      std::vector<std::uint32_t> expected;
      for (const RasterInstance& instance : instances)
        for (std::uint32_t first = 0; first < instance.triangles; first += SampleRaster::kPiece) {
          RasterInstance run = instance;
          run.indices += 3 * first;
          run.first_triangle += first;
          run.triangles = std::min(SampleRaster::kPiece, instance.triangles - first);
          run.boxes = {};
          sampling.begin(alone, width, height);
          alone.draw({&run, 1});
          const auto seen = bytes_of(alone.seen());
          if (expected.empty()) expected = seen;
          for (std::size_t i = 0; i < seen.size(); i += 2)
            if (std::bit_cast<float>(seen[i + 1]) < std::bit_cast<float>(expected[i + 1]))
              expected[i] = seen[i], expected[i + 1] = seen[i + 1];
        }
      ASSERT_EQ(found, expected) << name << ", round " << round;
      // Most lie behind others, and many runs beside the picture.
      MeshWork all;
      for (const MeshWork& work : raster.work())
        all.projected += work.projected, all.filled += work.filled;
      EXPECT_LT(double(all.projected), triangles * 0.9) << round;
      EXPECT_LT(double(all.filled), double(all.projected) * 0.6) << round;
    }
  });
}

TEST(SampleRaster, gives_the_same_bytes_for_any_number_of_threads_and_instruction_set) {
  std::mt19937 rng(7);
  Soup soup = random_soup(rng, 20'000);  // more than a round
  look(soup, 120, 90, 0.2f);
  soup.instance.back = true;
  for (int i = 1; i < 3; ++i) {
    const auto draw = [&] {
      SampleRaster raster;
      Sampling(i).begin(raster, 120, 90);
      raster.draw({&soup.instance, 1});
      return bytes_of(raster.seen());
    };
    const auto expected = draw();
    {
      const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
      EXPECT_EQ(draw(), expected);
    }
    for_each_instruction_set([&](const char* name) { EXPECT_EQ(draw(), expected) << name; });
  }
}

}  // namespace
}  // namespace rilievo
