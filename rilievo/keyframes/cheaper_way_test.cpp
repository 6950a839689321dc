#include "rilievo/keyframes/cheaper_way.h"

#include <gtest/gtest.h>

namespace rilievo {
namespace {

// Frames of a walk: what each way takes at each of them, and how many were drawn by polygons.
struct WayWalk {
  CheaperWay way;
  int polygons = 0, changes = 0, since_both = 0;

  void go(int frames, double keyframes_ms, double polygons_ms) {
    for (int i = 0; i < frames; ++i) {
      const CheaperWay::Way now = way.next();
      const bool by_polygons = now != CheaperWay::Way::keyframes;
      polygons += by_polygons;
      changes += by_polygons != last_;
      last_ = by_polygons;
      since_both = now == CheaperWay::Way::both ? since_both + 1 : 0;
      way.add(by_polygons ? polygons_ms : keyframes_ms, 1.2 * polygons_ms, since_both > 20);
    }
  }

 private:
  bool last_ = false;
};

TEST(CheaperWay, KeyframesStayWherePolygonsCostTwice) {
  WayWalk walk;
  walk.go(600, 20, 40);
  EXPECT_EQ(walk.polygons, 0);
}

TEST(CheaperWay, PolygonsAreDrawnWhereTheyCostHalf) {
  WayWalk walk;
  walk.go(600, 20, 10);
  EXPECT_GT(walk.polygons, 500);
  EXPECT_EQ(walk.changes, 1);
}

TEST(CheaperWay, WhereBothCostAlikePolygonsAreTriedOnceASecond) {
  WayWalk walk;
  walk.go(630, 20, 20);
  EXPECT_LE(walk.polygons, 600 / CheaperWay::kFramesToTry);
  EXPECT_GE(walk.polygons, 8);
}

TEST(CheaperWay, TheWayChangesWithWhatTheEyeSees) {
  WayWalk walk;
  walk.go(200, 20, 10);
  EXPECT_EQ(walk.way.next(), CheaperWay::Way::polygons);
  walk.go(200, 20, 60);
  EXPECT_EQ(walk.way.next(), CheaperWay::Way::keyframes);
  walk.go(200, 20, 10);
  EXPECT_EQ(walk.way.next(), CheaperWay::Way::polygons);
  EXPECT_EQ(walk.changes, 3);
}

}  // namespace
}  // namespace rilievo
