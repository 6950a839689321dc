#include "rilievo/keyframes/cheaper_way.h"

#include <gtest/gtest.h>

#include <functional>

namespace rilievo {
namespace {

// Frames of a walk: what each way takes at each of them, and how many were drawn by polygons.
struct WayWalk {
  CheaperWay way;
  double guess = 1.2;  // of what polygons take
  int polygons = 0, changes = 0, since_both = 0;

  // `slower`: how many times as long frame i takes, which is drawn by polygons or not.
  void go(
      int frames, double keyframes_ms, double polygons_ms,
      const std::function<double(int, bool)>& slower = [](int, bool) { return 1.0; }) {
    for (int i = 0; i < frames; ++i) {
      const CheaperWay::Way now = way.next();
      const bool by_polygons = now != CheaperWay::Way::keyframes;
      polygons += by_polygons;
      changes += by_polygons != last_;
      last_ = by_polygons;
      since_both = now == CheaperWay::Way::both ? since_both + 1 : 0;
      const double times = slower(i, by_polygons);
      way.add(times * (by_polygons ? polygons_ms : keyframes_ms), guess * polygons_ms,
              since_both > 20);
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

// A GPU draws polygons in a tenth of what the guess says, and Mesa on processors takes ten times as
// long.
TEST(CheaperWay, AnotherDrawersPolygonsAreTriedOnceAndKnownFromThenOn) {
  for (const double guess : {0.1, 0.5, 3.0, 10.0}) {
    WayWalk cheap, dear;
    cheap.way = dear.way = CheaperWay(false);
    cheap.guess = dear.guess = guess;
    cheap.go(600, 20, 10);
    // A guess that is four times as dear as keyframes says nothing yet.
    if (CheaperWay::kUnknownDrawer * guess * 10 < CheaperWay::kMayTry * 20) {
      EXPECT_GT(cheap.polygons, 480) << guess;
    }
    dear.go(600, 20, 200);
    EXPECT_LE(dear.polygons, 1) << guess;
  }
}

// Keyframes are looked at again after 120 frames and 240 more, for nine frames each.
TEST(CheaperWay, PolygonsAreDrawnWhereTheyCostHalf) {
  WayWalk walk;
  walk.go(600, 20, 10);
  EXPECT_GT(walk.polygons, 480);
  EXPECT_EQ(walk.changes, 5);
  WayWalk longer;
  longer.go(6000, 20, 10);
  EXPECT_GT(longer.polygons, 5800);
}

// Whatever is slowed down, and whenever: the cheaper way is gone in the end, and most of the time.
TEST(CheaperWay, WhatWasMeasuredBesideOtherWorkIsTriedAgain) {
  const int kFrames = 900;
  for (const int from : {0, 5, 25, 31, 61, 75, 80, 85, 89, 90, 91, 95, 115, 150, 200, 205})
    for (const int of : {0, 1, 2})  // polygons, keyframes, both
      for (const int lasts : {10, 40})
        for (const bool polygons_cheaper : {false, true}) {
          WayWalk walk;
          walk.go(kFrames, 20, polygons_cheaper ? 12 : 30, [&](int i, bool polygons) {
            const bool slow = i >= from && i < from + lasts && (of == 2 || polygons == (of == 0));
            return slow ? 5.0 : 1.0;
          });
          const auto cheaper = [&](int frames, int by_polygons) {
            return polygons_cheaper ? by_polygons : frames - by_polygons;
          };
          EXPECT_GT(cheaper(kFrames, walk.polygons), 600)
              << from << " " << of << " " << lasts << " " << polygons_cheaper;
          const int before = walk.polygons;
          walk.go(200, 20, polygons_cheaper ? 12 : 30);
          EXPECT_GT(cheaper(200, walk.polygons - before), 180)
              << from << " " << of << " " << lasts << " " << polygons_cheaper;
        }
}

// Until there are keyframes again, and only where polygons take about as long.
TEST(CheaperWay, PolygonsAreDrawnWhereKeyframesFail) {
  for (const bool tried : {false, true}) {
    WayWalk walk;
    walk.go(tried ? 200 : 44, 20, 24);
    const int before = walk.polygons;
    EXPECT_EQ(before > 0, tried);
    ASSERT_TRUE(walk.way.leave_keyframes(tried ? 1.2 * 24 : 24));
    EXPECT_EQ(walk.way.next(), CheaperWay::Way::both);
    walk.go(100, 20, 24);
    EXPECT_NEAR(walk.polygons - before, 22, 2);
  }
  WayWalk dearer;
  dearer.go(200, 20, 24);
  EXPECT_FALSE(dearer.way.leave_keyframes(3 * 24)) << "they were cheap elsewhere";
  WayWalk walk;
  EXPECT_FALSE(walk.way.leave_keyframes(1)) << "nothing is known of keyframes";
  walk.go(44, 20, 26);
  EXPECT_FALSE(walk.way.leave_keyframes(0)) << "nor of polygons";
  EXPECT_FALSE(walk.way.leave_keyframes(26));
  EXPECT_EQ(walk.way.next(), CheaperWay::Way::keyframes);
}

TEST(CheaperWay, KeyframesThatAreMadeAgainAndFailAreLeftAtOnce) {
  WayWalk walk;
  int i = 0;
  walk.go(100, 20, 10);
  while (walk.way.next() != CheaperWay::Way::both && i++ < 1000) walk.go(1, 20, 10);
  while (walk.way.next() == CheaperWay::Way::both && i++ < 1000) walk.go(1, 20, 10);
  ASSERT_EQ(walk.way.next(), CheaperWay::Way::keyframes);
  EXPECT_TRUE(walk.way.leave_keyframes(10));
  for (int k = 0; k < 2 * CheaperWay::kFramesToReturn - 1; ++k) {
    ASSERT_EQ(walk.way.next(), CheaperWay::Way::polygons) << k;
    walk.go(1, 20, 10);
  }
  // What they took is known still.
  walk.go(60, 20, 200);
  EXPECT_EQ(walk.way.next(), CheaperWay::Way::keyframes);
}

// Else a cut at that moment would bring seconds of dear frames.
TEST(CheaperWay, KeyframesThatFailWherePolygonsBecameDearAreNotLeft) {
  WayWalk walk;
  walk.go(100, 20, 10);
  ASSERT_EQ(walk.way.next(), CheaperWay::Way::polygons);
  for (int i = 0; i < 100 && walk.way.next() != CheaperWay::Way::keyframes; ++i)
    walk.go(1, 20, 200);
  ASSERT_EQ(walk.way.next(), CheaperWay::Way::keyframes);
  EXPECT_FALSE(walk.way.leave_keyframes(200));
}

TEST(CheaperWay, PolygonsThatCostSomewhatMoreAreTriedOnceASecond) {
  WayWalk walk;
  walk.go(630, 20, 22);
  EXPECT_LE(walk.polygons, 600 / CheaperWay::kFramesToTry + 1);
  EXPECT_GE(walk.polygons, 8);
}

// They are exact.
TEST(CheaperWay, WhereBothCostAlikePolygonsAreDrawn) {
  WayWalk walk;
  walk.go(630, 20, 20);
  EXPECT_GT(walk.polygons, 540);
  EXPECT_LE(walk.changes, 5);
}

TEST(CheaperWay, TheWayChangesWithWhatTheEyeSees) {
  WayWalk walk;
  walk.go(200, 20, 10);
  EXPECT_EQ(walk.way.next(), CheaperWay::Way::polygons);
  walk.go(200, 20, 60);
  EXPECT_EQ(walk.way.next(), CheaperWay::Way::keyframes);
  walk.go(200, 20, 10);
  EXPECT_EQ(walk.way.next(), CheaperWay::Way::polygons);
  // And two for each time that keyframes were looked at again.
  EXPECT_LE(walk.changes, 7);
}

}  // namespace
}  // namespace rilievo
