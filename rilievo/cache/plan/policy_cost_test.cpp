// What plans cost: budgets, prices, and the frames of long walks.
#include <gtest/gtest.h>

#include <algorithm>

#include "rilievo/cache/plan/forest_test_helpers.h"

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

TEST(PolicyCost, pictures_show_no_more_triangles_than_is_allowed) {
  const PlanObjects forest = plant(700);
  CacheOptions options;
  options.capture_triangles = 8000;
  options.picture_triangles = 8000;
  Loop run;
  for (int f = 0; f < 200; ++f) {
    ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, {}, walk(1, f), options));
    for (const Capture& capture : run.plan.captures) EXPECT_LE(capture.triangles, 8000u);
  }
  EXPECT_GT(run.plan.pictures.size(), 100u);
}

// What the last frame's captures cost more than to draw the same, but for the first of them.
double spent_beyond_drawing(const Loop& run) {
  double spent = 0;
  for (const Capture& capture : run.plan.captures)
    if (&capture != &run.plan.captures.front())
      spent += std::max(0.0, capture.cost - double(run.scratch.now_cost[capture.entity]));
  return spent;
}

// A budget of so many captured triangles is one of what their capture costs; captures are asked
// for, saved for and paid at the same price.
TEST(PolicyCost, captures_are_scheduled_at_the_price_of_their_estimates) {
  const PlanObjects forest = plant(700);
  for (const bool rasterized : {false, true}) {
    CacheOptions options = rasterized ? rasterized_cache_options() : CacheOptions{};
    options.capture_triangles = 20'000;
    options.capture_share = 0;
    const double budget = 20'000 * options.cost.capture_triangle;
    Loop run;
    int priced = 0;
    for (int f = 0; f < 100; ++f) {
      ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, {}, walk(1, f), options));
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
        ++priced;
      }
      EXPECT_LE(spent_beyond_drawing(run), budget * (1 + 1e-6));
    }
    EXPECT_GT(priced, 100);
  }
}

// ... or of what the frame costs anyway, where nobody minds that it takes twice as long.
TEST(PolicyCost, dear_frames_capture_for_as_much_as_they_cost_without) {
  const PlanObjects forest = plant(700);
  for (const double max_spike : {0.0, 2.0})
    for (const double share : {0.0, 0.1, 0.2}) {
      CacheOptions options = rasterized_cache_options();
      options.capture_triangles = 20'000;
      options.capture_share = share;
      options.spikes.max_spike = max_spike;
      const double budget = 20'000 * options.cost.capture_triangle;
      Loop run;
      int dear = 0;
      for (int f = 0; f < 60; ++f) {
        ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, {}, walk(1, f), options));
        // The root's cost is that of all objects.
        const double anyway = max_spike > 0 ? 0 : share * double(run.scratch.now_cost[0]);
        const double spent = spent_beyond_drawing(run);
        if (run.plan.limit > 0) continue;  // has a budget of its own
        EXPECT_LE(spent, std::max(budget, anyway) * (1 + 1e-6));
        dear += spent > budget * (1 + 1e-6);
      }
      EXPECT_EQ(dear > 0, max_spike == 0 && share > 0) << max_spike << ", " << share;
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

// One object 40 m ahead, which is worth a picture.
PlanObjects one_tree() {
  PlanObjects tree;
  Box box;
  box.add({-2, 0, -42}), box.add({2, 5, -38});
  tree.add(box, 20'000);
  tree.build();
  return tree;
}

TEST(PolicyCost, what_was_cheap_as_polygons_stays_so_and_what_was_dear_is_captured) {
  const PlanObjects tree = one_tree();
  for (const float share : {0.001f, 1.0f}) {
    Loop run;
    run.state.current.assign(1, 0), run.state.previous.assign(1, 0);
    const PolygonCost cost{0, 20'000, 20'000 * double(share)};
    learn_polygons({&cost, 1}, run.state);
    run.state.polygon_records[0].frame = 1;  // as if in the frame before
    run.state.frame = 1;
    int captures = 0, polygons = 0;
    for (int f = 0; f < 30; ++f) {
      ASSERT_NO_FATAL_FAILURE(run.frame(tree.tree, {}, walk(1, f), {}));
      captures += int(run.plan.captures.size()), polygons += int(run.plan.polygons.size());
      for (const DrawnObject& drawn : run.plan.polygons) {
        EXPECT_GT(drawn.expected_cost, 20'000);
        const PolygonCost took{0, double(drawn.expected_cost), double(drawn.expected_cost * share)};
        learn_polygons({&took, 1}, run.state);
      }
    }
    if (share < 1) {
      EXPECT_EQ(captures, 0);
      EXPECT_EQ(polygons, 30);
    } else {
      EXPECT_GT(captures, 0);
      EXPECT_LT(polygons, 5);
    }
  }
}

TEST(PolicyCost, records_are_the_mean_of_the_last_frames) {
  CacheState state;
  state.current.assign(2, 0);
  float mean = 0, usual = 1;
  const float shares[] = {0.25f, 1.0f, 0.5f, 3.0f};
  for (int f = 0; f < 4; ++f) {
    state.frame = std::uint32_t(f + 1);
    const PolygonCost costs[] = {{1, 200, 200 * double(shares[f])}};
    learn_polygons(costs, state);
    mean = f == 0 ? shares[f] : mean + 0.5f * (shares[f] - mean);
    usual += 0.1f * (shares[f] - usual);
    EXPECT_FLOAT_EQ(state.polygon_records[1].share, mean);
    EXPECT_FLOAT_EQ(state.usual_polygon_share, usual);
    EXPECT_EQ(state.polygon_records[0].frame, 0u);  // nothing is known of the other one
  }
  // Long after, the old mean says nothing.
  state.frame = 100;
  const PolygonCost later[] = {{1, 200, 50}};
  learn_polygons(later, state);
  EXPECT_FLOAT_EQ(state.polygon_records[1].share, 0.25f);
}

// Pictures end while the eye walks; those of what is hidden are not captured again.
TEST(PolicyCost, what_is_hidden_is_not_captured_again) {
  const PlanObjects forest = plant(300);
  const auto captures_with = [&](float seen) {
    Loop run;
    std::size_t captures = 0;
    for (int f = 0; f < 150; ++f) {
      run.frame(forest.tree, {}, walk(1, f), {});
      if (f >= 30) captures += run.plan.captures.size();
      const std::vector<float> shares(run.plan.pictures.size(), seen);
      learn_seen(run.plan, shares, run.state);
      // What it then costs as polygons is as little as was thought.
      std::vector<PolygonCost> costs;
      for (const DrawnObject& drawn : run.plan.polygons)
        for (Entity e = 0; e < forest.tree.nodes.size(); ++e)
          if (forest.tree.nodes[e].leaf() &&
              forest.tree.order[forest.tree.nodes[e].first] == drawn.object)
            costs.push_back({e, double(drawn.expected_cost), 0.02 * double(drawn.expected_cost)});
      if (seen < 1) learn_polygons(costs, run.state);
    }
    return captures;
  };
  const std::size_t all = captures_with(1), hidden = captures_with(0);
  EXPECT_GT(all, 50u);
  EXPECT_LT(hidden, all / 5);
}

}  // namespace
}  // namespace rilievo
