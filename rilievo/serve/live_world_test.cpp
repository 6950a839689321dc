#include "rilievo/serve/live_world.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rilievo/capture/raster_ray_source.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/serve/live_picture.h"
#include "rilievo/serve/live_simulation_test_helpers.h"
#include "rilievo/serve/view_need.h"

namespace rilievo {
namespace {

constexpr int kWidth = 320, kHeight = 180;

// A small scene and its sources.
struct Walkable {
  BuiltinScene built = *make_builtin("builtin:stonehenge?triangles=20000");
  PlacedScene placed{built.scene};
  RayScene rays = *RayScene::create(built.scene);
  RasterRaySource source{placed, rays};

  [[nodiscard]] Camera camera(double seconds) const {
    return camera_at(built.path, seconds, kWidth, kHeight);
  }
  [[nodiscard]] LiveScene scene() {
    LiveScene shown;
    shown.name = "stonehenge";
    shown.bounds = source.bounds({});
    shown.start = camera(0);
    return shown;
  }
  [[nodiscard]] Rgba8Image truth(const Camera& camera) {
    CaptureRequest request;
    request.camera = camera;
    request.with_sky = true;
    return srgb8_from_linear(source.capture(request)->picture.color);
  }
};

// Fine pictures hold what direct drawing shows, but for JPEG and a texel's shift at edges.
TEST(LiveWorld, AWalkIsCompleteAndLooksLikeDirectDrawing) {
  Walkable walkable;
  LiveWorld world(walkable.source, walkable.source, walkable.scene(), {.work_s = 0.02});
  const SimulatedClient client{[&](double s) { return walkable.camera(s); },
                               {.latency_ms = 20, .jitter_ms = 10}};
  int frames = 0, compared = 0;
  double sum_db = 0, holes = 0;
  const auto traffic = simulate_walk(
      world, std::span(&client, 1), {.seconds = 4}, [&](int, double now, const LiveClient& seen) {
        if (now < 1 || ++frames % 30 != 0) return;
        LiveFrame frame;
        seen.draw(walkable.camera(now), frame);
        sum_db += psnr_db(walkable.truth(walkable.camera(now)), frame.color);
        holes += double(frame.holes) / (kWidth * kHeight);
        ++compared;
        // Depths are as exact as was asked for.
        EXPECT_LE(frame.error_px, 0.25);
      });
  ASSERT_TRUE(traffic.ok()) << traffic.error().message();
  ASSERT_GE(compared, 5);
  // JPEG of quality 85 alone is some 34 dB here, and edges lie up to half a texel off.
  EXPECT_GT(sum_db / compared, 27);
  // Strips that both views hide, until the next one.
  EXPECT_LT(holes / compared, 0.005);
  EXPECT_GE((*traffic)[0].first_view, 0.04);  // there and back
  EXPECT_LT((*traffic)[0].first_view, 1);
  EXPECT_EQ(world.stats().failed, 0u);
}

// A head that swings by 50 degrees every 0.8 s is seen almost as well half a second later: its
// pictures are made around the middle of its swings, and as wide as these are.
TEST(LiveWorld, LatePicturesShowAHeadThatSwings) {
  Walkable walkable;
  const auto camera = [&](double s) {
    Camera turned = walkable.camera(s);
    const glm::dmat4 turn =
        glm::mat4_cast(glm::angleAxis(0.45 * std::sin(4 * s), glm::dvec3(0, 1, 0)));
    for (int c = 0; c < 3; ++c) turned.world_from_eye[c] = turn * turned.world_from_eye[c];
    return turned;
  };
  double db[2] = {}, holes[2] = {};
  for (const bool late : {false, true}) {
    LiveWorld world(walkable.source, walkable.source, walkable.scene(), {.work_s = 0.02});
    const SimulatedClient client{camera, {.latency_ms = late ? 250.0 : 0.0}};
    int compared = 0;
    SimulatedWalk walk;
    walk.seconds = 7, walk.frames_a_second = 4;
    const auto traffic = simulate_walk(
        world, std::span(&client, 1), walk, [&](int, double now, const LiveClient& seen) {
          if (now < 3) return;
          LiveFrame frame;
          seen.draw(camera(now), frame);
          db[late] += psnr_db(walkable.truth(camera(now)), frame.color);
          holes[late] += double(frame.holes) / (kWidth * kHeight);
          ++compared;
        });
    ASSERT_TRUE(traffic.ok());
    ASSERT_GT(compared, 10);
    db[late] /= compared, holes[late] /= compared;
  }
  // Without the forecast: 2.6 dB in a town, and three times the pixels that nothing shows.
  EXPECT_GT(db[1], db[0] - 2);
  EXPECT_LT(holes[1], 0.005);
}

// Coarse pictures, whose texels reach over borders, change no pixel that a fine one shows.
TEST(LiveClient, CoarsePicturesFillHolesAlone) {
  Walkable walkable;
  const Camera before = walkable.camera(1), frame = walkable.camera(1.8);
  LiveClient fine, both;
  LiveWelcome welcome;
  welcome.z_near = frame.z_near, welcome.z_far = frame.z_far;
  welcome.bounds = walkable.scene().bounds;
  for (LiveClient* one : {&fine, &both})
    ASSERT_TRUE(one->receive(encode_message(ServerMessage(welcome))).ok());
  const auto send = [&](const Camera& camera, bool is_fine, int face, LiveClient& client) {
    LivePictureOrder order;
    order.camera = camera, order.frame = frame_scale(frame), order.fine = is_fine;
    order.surround_face = face;
    const Result<MadePicture> made = make_live_picture(walkable.source, order);
    ASSERT_TRUE(made.ok());
    LivePictureHead head = made->head;
    head.id = head.keyframe = std::uint64_t(face + 2);
    ASSERT_TRUE(client.receive(encode_picture(*made, head)).ok());
  };
  for (LiveClient* one : {&fine, &both}) send(before, true, -1, *one);
  for (int face = 0; face < 6; ++face)
    send(surround_camera(frame.position(), face, 64, frame.z_near, frame.z_far), false, face, both);
  LiveFrame alone, filled;
  fine.draw(frame, alone);
  both.draw(frame, filled);
  ASSERT_GT(alone.holes, 300u);
  EXPECT_LT(filled.holes, alone.holes / 10);
  std::size_t changed = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) changed += alone.color(x, y) != filled.color(x, y);
  // Where nothing was shown, colours came from beside.
  EXPECT_LE(changed, alone.holes);
  EXPECT_GT(psnr_db(walkable.truth(frame), filled.color),
            psnr_db(walkable.truth(frame), alone.color));
}

// Servers keep pictures by their bytes: there is no room besides.
TEST(LivePicture, TakesTheMemoryOfItsBytes) {
  Walkable walkable;
  LivePictureOrder order;
  order.camera = walkable.camera(1), order.frame = frame_scale(order.camera), order.fine = true;
  const Result<MadePicture> made = make_live_picture(walkable.source, order);
  ASSERT_TRUE(made.ok());
  EXPECT_EQ(made->depths.capacity(), made->depths.size());
  EXPECT_LE(made->colors.capacity(), made->colors.size() + 1024);
}

// An eye that stands gets one picture of its own place and direction, then the surround, and then
// nothing more.
TEST(LiveWorld, WhoStandsGetsItsOwnViewAndThenNothing) {
  Walkable walkable;
  LiveWorld world(walkable.source, walkable.source, walkable.scene(), {.work_s = 0.02});
  const Camera stands = walkable.camera(1);
  const SimulatedClient client{[&](double) { return stands; }, {}};
  double db = 0;
  const auto traffic = simulate_walk(world, std::span(&client, 1), {.seconds = 3},
                                     [&](int, double, const LiveClient& seen) {
                                       if (db == 0 && seen.newest()->surround_face < 0) return;
                                       LiveFrame frame;
                                       if (db != 0) return;
                                       seen.draw(stands, frame);
                                       db = psnr_db(walkable.truth(stands), frame.color);
                                     });
  ASSERT_TRUE(traffic.ok());
  // Its texels are the frame's pixels: only JPEG differs, of quality 92.
  EXPECT_GT(db, 30);
  const LiveWorldStats stats = world.stats();
  EXPECT_EQ(stats.surround, 6u);
  EXPECT_LE(stats.made, 10u);
  EXPECT_EQ(world.work(3.1), 0);
}

// A turn at once shows what the surround has, and a cut what is made for it.
TEST(LiveWorld, ASuddenTurnAndACutAreNeverEmpty) {
  Walkable walkable;
  LiveWorld world(walkable.source, walkable.source, walkable.scene(), {.work_s = 0.02});
  const Camera before = walkable.camera(1);
  Camera behind = before;
  behind.world_from_eye[0] = -before.world_from_eye[0];
  behind.world_from_eye[2] = -before.world_from_eye[2];
  const Camera elsewhere = walkable.camera(12);
  const auto camera = [&](double s) { return s < 2 ? before : s < 3 ? behind : elsewhere; };
  const SimulatedClient client{camera, {.latency_ms = 50}};
  double shown_at_once = -1, shown_later = -1;
  const auto traffic = simulate_walk(
      world, std::span(&client, 1), {.seconds = 4}, [&](int, double now, const LiveClient& seen) {
        LiveFrame frame;
        const bool first = shown_at_once < 0 && now >= 2;
        if (!first && !(now > 3.6 && shown_later < 0)) return;
        seen.draw(camera(now), frame);
        (first ? shown_at_once : shown_later) = 1 - double(frame.holes) / (kWidth * kHeight);
      });
  ASSERT_TRUE(traffic.ok());
  EXPECT_GT(shown_at_once, 0.99);
  EXPECT_GT(shown_later, 0.99);
}

TEST(LiveWorld, ClientsThatWalkTogetherSharePictures) {
  Walkable walkable;
  LiveWorld world(walkable.source, walkable.source, walkable.scene(), {.work_s = 0.02});
  std::vector<SimulatedClient> clients;
  for (int i = 0; i < 4; ++i)
    clients.push_back({[&](double s) { return walkable.camera(s); }, {}, 0, 0.1 * i});
  const auto traffic =
      simulate_walk(world, clients, {.seconds = 2}, [](int, double, const LiveClient&) {});
  ASSERT_TRUE(traffic.ok());
  // Four clients see what one does: a few more pictures are made, as they joined one by one.
  EXPECT_GT(world.stats().shared, world.stats().made / 2);
  EXPECT_LT(world.stats().shared, 200u);
  for (const SimulatedTraffic& one : *traffic) EXPECT_GE(one.first_fine, 0);
}

// Work is so slow that one round of all clients takes a second: each still gets a fine view.
TEST(LiveWorld, ManyClientsAtDifferentPlacesAllGetSharp) {
  for (const double apart_s : {0.05, 2.0}) {
    Walkable walkable;
    LiveWorld world(walkable.source, walkable.source, walkable.scene(),
                    {.work_s = 0.08, .coarse_work_s = 0.04});
    std::vector<SimulatedClient> clients;
    for (int i = 0; i < 8; ++i)
      clients.push_back({[&, i](double s) { return walkable.camera(s + apart_s * i); },
                         {.latency_ms = 20, .mbit_s = 100},
                         0,
                         0.05 * i});
    const auto traffic =
        simulate_walk(world, clients, {.seconds = 3}, [](int, double, const LiveClient&) {});
    ASSERT_TRUE(traffic.ok());
    for (const SimulatedTraffic& one : *traffic) {
      EXPECT_GE(one.first_fine, 0) << apart_s;
      // All coarse ones, all fine ones, and one more round for who is served again before.
      EXPECT_LT(one.first_fine, 2 * 8 * (0.08 + 0.04)) << apart_s;
    }
    // Who walks behind another one sees what that one saw.
    if (apart_s < 1) {
      EXPECT_GT(world.stats().shared, world.stats().made / 4);
    }
  }
}

TEST(LiveWorld, WhatAClientSaysWrongIsRefused) {
  Walkable walkable;
  LiveWorld world(walkable.source, walkable.source, walkable.scene(), {.work_s = 0.02});
  const auto session = world.connect();
  EXPECT_FALSE(session->receive(encode_message(ClientMessage(LivePose{})), 0).ok());
  EXPECT_FALSE(session->receive({}, 0).ok());
  EXPECT_TRUE(session->receive(encode_message(ClientMessage(LiveHello{})), 0).ok());
  // Identifiers that nobody gave.
  EXPECT_TRUE(session->receive(encode_message(ClientMessage(LiveHave{{1, 2, 99}})), 0).ok());
  ASSERT_TRUE(session->next(0));  // the welcome
  EXPECT_FALSE(session->next(0));
}

// With one fine view of its place, a walking eye needs the surround next if pictures come late, and
// another view if they come soon.
TEST(ViewNeed, LatePicturesAskForTheSurroundFirst) {
  const Camera frame = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.9, 320, 180, 0.1, 100);
  HeldPicture held;
  held.id = 1, held.fine = true, held.typical_inverse_z = 0.1;
  held.camera = look_at({0, 0, 0.5}, {0, 0, -1}, {0, 1, 0}, 1.1, 400, 225, 0.1, 100);
  LivePose walks;
  walks.velocity = {0, 0, -1.4};
  const auto wanted = [&](double lead) {
    return view_need(std::span(&held, 1), walks, frame, 0, false, lead).wanted;
  };
  EXPECT_EQ(wanted(0.05), Wanted::fine_view);
  EXPECT_EQ(wanted(0.5), Wanted::surround);
}

TEST(ViewNeed, AFrameIsCoveredByAWiderViewAndNotByOneElsewhere) {
  const Camera frame = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.9, 320, 180, 0.1, 100);
  Camera wide = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1.1, 320, 180, 0.1, 100);
  const Camera* views[] = {&wide};
  EXPECT_EQ(covered_share(frame, views), 1);
  wide = look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 1.1, 320, 180, 0.1, 100);
  EXPECT_EQ(covered_share(frame, views), 0);
  // The six faces of a cube show everything.
  std::vector<Camera> cube;
  for (int face = 0; face < 6; ++face)
    cube.push_back(surround_camera({0, 0, 0}, face, 8, 0.1, 100));
  std::vector<const Camera*> faces;
  for (const Camera& face : cube) faces.push_back(&face);
  const Camera oblique = look_at({0, 0, 0}, {1, 2, 3}, {0, 1, 0}, 1.5, 320, 180, 0.1, 100);
  EXPECT_EQ(covered_share(oblique, faces), 1);
}

}  // namespace
}  // namespace rilievo
