#include "rilievo/layered_impostor/eye_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "rilievo/core/sanitized_test_helpers.h"
#include "rilievo/layered_impostor/jug_test_helpers.h"
#include "rilievo/layered_impostor/slice_quads.h"

namespace rilievo {
namespace {

using test_shapes::random_direction;

TEST(EyeCells, each_direction_is_a_combination_of_its_cells_corners) {
  std::mt19937 rng(1);
  std::vector<int> met(kEyeCells);
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 direction = random_direction(rng);
    const int index = eye_cell_of(2.5 * direction);
    ++met[std::size_t(index)];
    const EyeCell cell = eye_cell(index);
    // Two triangles make the cell.
    double inside = -1;
    for (const auto& [a, b, c] : {std::array{0, 1, 3}, std::array{0, 3, 2}}) {
      const glm::dvec3 w =
          glm::inverse(glm::dmat3(cell.corners[std::size_t(a)], cell.corners[std::size_t(b)],
                                  cell.corners[std::size_t(c)])) *
          direction;
      inside = std::max(inside, std::min({w.x, w.y, w.z}));
    }
    EXPECT_GE(inside, -1e-12);
    EXPECT_LE(1 / glm::dot(direction, cell.middle), cell.farthest * (1 + 1e-12));
  }
  // Cells are of about one size.
  for (const int directions : met) EXPECT_GT(directions, 20000 / kEyeCells / 2);
}

TEST(EyeCells, no_view_is_drawn_that_the_cell_lacks) {
  std::mt19937 rng(2);
  for (const ViewSetOptions& of :
       {ViewSetOptions{.spread = ViewSpread::faces_12},
        ViewSetOptions{.spread = ViewSpread::vertices_20},
        ViewSetOptions{.spread = ViewSpread::both_32}, ViewSetOptions{.hemisphere = true},
        ViewSetOptions{.spread = ViewSpread::ring, .ring = 7}}) {
    const Result<LayeredImpostor> impostor = make_layered_impostor(
        test_shapes::cast_views(test_shapes::jug(), make_view_set(of), {.size = 8}), {});
    ASSERT_TRUE(impostor.ok()) << impostor.error().message();
    for (const LayeredMethod method : {LayeredMethod::surfaces, LayeredMethod::slices})
      for (const int max_views : {1, 3, 6}) {
        const LayeredOptions options{.method = method, .max_views = max_views};
        std::vector<std::vector<bool>> drawn;
        int most = 0;
        for (int cell = 0; cell < kEyeCells; ++cell) {
          drawn.push_back(views_drawn_from(*impostor, options, cell));
          most = std::max(most, int(std::count(drawn.back().begin(), drawn.back().end(), true)));
        }
        for (int i = 0; i < sanitized_cases(1000); ++i) {
          const glm::dvec3 direction = random_direction(rng);
          const std::vector<bool>& of_cell = drawn[std::size_t(eye_cell_of(direction))];
          const glm::dvec3 eye = glm::dvec3(impostor->bounds.center()) + 5.0 * direction;
          const ServingViews serving = views_for_eye(*impostor, eye, options);
          const bool sliced = method == LayeredMethod::slices;
          for (int k = 0; k < (sliced ? serving.weighted : serving.count); ++k) {
            EXPECT_TRUE(of_cell[std::size_t(serving.views[k])]);
            if (!sliced || max_views == 1) continue;
            for (const int view :
                 pick_views_around(impostor->views, serving.views[k], direction).views)
              EXPECT_TRUE(view < 0 || of_cell[std::size_t(view)]);
          }
        }
        // Nor is the set a mere list of all.
        EXPECT_LT(most, impostor->pictures.size() == 32 ? (max_views == 1 ? 8 : 17) : 21);
      }
  }
}

}  // namespace
}  // namespace rilievo
