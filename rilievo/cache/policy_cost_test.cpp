// What plans cost: budgets, prices, and the frames of long walks.
#include <gtest/gtest.h>

#include <algorithm>

#include "rilievo/cache/forest_test_helpers.h"

namespace rilievo {
namespace {

using namespace test_forest;

TEST(PolicyCost, who_stands_still_captures_nothing_more) {
  const PlanObjects forest = plant(700);
  Loop run;
  const FrameView view = looking({0, 10, 0}, {0, -0.1, -1}, {0, 0, 0});
  for (int f = 0; f < 100; ++f) {
    ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, {}, view, {}));
    if (f == 0) {
      EXPECT_GT(run.plan.captures.size(), 0u);
    }
  }
  for (int f = 0; f < 20; ++f) {
    ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, {}, view, {}));
    EXPECT_EQ(run.plan.captures.size(), 0u);
    EXPECT_EQ(run.plan.evictions.size(), 0u);
  }
  EXPECT_LT(run.plan.bound_px, 1e-6);  // pictures from this very eye, texel for pixel
}

TEST(PolicyCost, captures_hold_their_budget) {
  const PlanObjects forest = plant(700);
  CacheOptions options;
  options.capture_triangles = 8000;
  options.picture_triangles = 8000;
  options.captures = 3;
  Loop run;
  for (int f = 0; f < 200; ++f) {
    ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, {}, walk(1, f), options));
    EXPECT_LE(run.plan.captures.size(), 3u);
    for (const Capture& capture : run.plan.captures) EXPECT_LE(capture.triangles, 8000u);
  }
  EXPECT_GT(run.plan.pictures.size(), 100u);
}

// A budget of so many captured triangles is one of what their capture costs; captures are asked
// for, saved for and paid at the same price.
TEST(PolicyCost, captures_are_scheduled_at_the_price_of_their_estimates) {
  const PlanObjects forest = plant(700);
  for (const bool rasterized : {false, true}) {
    CacheOptions options = rasterized ? rasterized_cache_options() : CacheOptions{};
    options.capture_triangles = 20'000;
    const double budget = 20'000 * options.cost.capture_triangle;
    Loop run;
    int priced = 0;
    for (int f = 0; f < 100; ++f) {
      ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, {}, walk(1, f), options));
      double spent = 0;
      for (const Capture& capture : run.plan.captures) {
        const auto request =
            std::find_if(run.scratch.requests.begin(), run.scratch.requests.end(),
                         [&](const auto& r) { return r.entity == capture.entity; });
        ASSERT_NE(request, run.scratch.requests.end());
        EXPECT_EQ(capture.cost, double(request->cost));
        const Camera& camera = capture.geometry.capture;
        const double without_texels =
            options.cost.capture + options.cost.capture_triangle * double(capture.triangles);
        const double texels = options.cost.capture_texel * camera.width * camera.height;
        EXPECT_GE(request->cost, without_texels * (1 - 1e-6));
        // The picture is as large as was foreseen, or nearly so: its eye may be another one.
        EXPECT_LE(request->cost, without_texels + 2 * texels + 1);
        if (&capture != &run.plan.captures.front())
          spent +=
              std::max(0.0, double(request->cost) - double(run.scratch.now_cost[capture.entity]));
        ++priced;
      }
      EXPECT_LE(spent, budget * (1 + 1e-6));
    }
    EXPECT_GT(priced, 100);
  }
}

// By definition: the lowest rate at which what is saved up pays for each request by its deadline.
double lowest_rate(std::vector<PlanScratch::Request> requests) {
  std::sort(requests.begin(), requests.end(),
            [](const auto& a, const auto& b) { return a.deadline < b.deadline; });
  const auto suffices = [&](double rate) {
    double paid = 0;
    for (const auto& request : requests) {
      paid += double(request.cost);
      if (paid > rate * std::max(1.0, double(request.deadline))) return false;
    }
    return true;
  };
  double low = 0, high = 1;
  while (!suffices(high)) high *= 2;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (suffices(middle) ? high : low) = middle;
  }
  return high;
}

TEST(PolicyCost, what_is_saved_up_grows_at_the_lowest_rate_that_meets_all_deadlines) {
  const PlanObjects forest = plant(700);
  const CacheOptions options;
  const double budget = double(options.capture_triangles) * options.cost.capture_triangle;
  Loop run;
  int saving = 0;
  for (int f = 0; f < 200; ++f) {
    const double before = run.state.credit;
    ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, {}, walk(1, f), options));
    const auto& requests = run.scratch.requests;
    double credit = requests.empty() ? 0 : before + lowest_rate(requests);
    for (const Capture& capture : run.plan.captures) credit = std::max(0.0, credit - capture.cost);
    EXPECT_NEAR(run.plan.credit, std::min(credit, budget), 1e-6 * budget) << f;
    saving += !requests.empty() && requests.front().deadline > 1;
  }
  EXPECT_GT(saving, 20);
}

struct Cost {
  double median, largest_after_start;  // triangles of polygons and captures in a frame
  double price;  // of them, texels and all, as the schedule keeps it even: mean after 20 frames
  std::size_t pictures;
  double bound_px;
};

Cost cost_of_walk(int trees, int kind) {
  const PlanObjects forest = plant(trees);
  Loop run;
  std::vector<double> costs;
  double bound = 0, largest = 0, price = 0;
  for (int f = 0; f < 120; ++f) {
    run.frame(forest.tree, {}, walk(kind, f), {});
    if (f >= 20) price += double(run.plan.polygon_triangles) / 100;
    for (const Capture& capture : run.plan.captures)
      if (f >= 20) price += capture.cost / 100;
    costs.push_back(double(run.plan.polygon_triangles + run.plan.captured_triangles));
    if (f > 0) largest = std::max(largest, costs.back());
    bound = std::max(bound, run.plan.bound_px);
  }
  std::sort(costs.begin(), costs.end());
  return {costs[60], largest, price, run.plan.pictures.size(), bound};
}

TEST(PolicyCost, a_walk_through_ten_million_triangles_draws_a_hundredth_of_them) {
  for (const int kind : {0, 1}) {
    const Cost cost = cost_of_walk(5000, kind);
    EXPECT_LT(cost.median, 100'000);
    EXPECT_LT(cost.largest_after_start, 500'000);
    EXPECT_LT(cost.pictures, 500u);
    EXPECT_LE(cost.bound_px, 1);
    EXPECT_LT(cost.price, 100'000);
    // And five times the trees cost hardly more.
    EXPECT_LE(cost_of_walk(25000, kind).price, 1.3 * cost.price);
  }
}

}  // namespace
}  // namespace rilievo
