#include "rilievo/serve/message.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

namespace rilievo {
namespace {

std::vector<std::byte> bytes_of_count(std::size_t count) {
  std::vector<std::byte> bytes(count);
  for (std::size_t i = 0; i < count; ++i) bytes[i] = std::byte(std::uint8_t(7 * i + 1));
  return bytes;
}

LivePose some_pose() {
  LivePose pose;
  pose.sequence = 4000000000u, pose.client_ms = 1.5e12;
  pose.eye = {1e7 + 0.125, -2, 3}, pose.orientation = glm::normalize(glm::dquat(1, 0.5, -2, 0.25));
  pose.vertical_fov = 0.75, pose.aspect = 1.75, pose.velocity = {1.25, 0, -0.5};
  pose.turn_rate = {0, 2, 0}, pose.latency_ms = 250, pose.cell = 0.5;
  return pose;
}

LivePictureHead some_head() {
  LivePictureHead head;
  head.fine = true, head.layer = 1, head.color = LiveColor::webp, head.surround_face = 5;
  head.keyframe = 77, head.id = 0x1122334455667788ull;
  head.content[15] = 9;
  head.eye = {1, 2, 3}, head.orientation = glm::normalize(glm::dquat(0.5, 0.5, 0.25, -1));
  head.window = {-0.5, 0.75, -0.25, 0.5}, head.width = 1536, head.height = 864;
  head.step = 0.001f, head.offset = -0.5f, head.cell = 0.25, head.error_px = 0.25;
  head.z_near = 0.125, head.server_ms = 12345.5, head.sequence = 6;
  return head;
}

TEST(Message, ClientMessagesComeBackAsTheyWere) {
  const LivePose pose = some_pose();
  const auto read = parse_client_message(encode_message(ClientMessage(pose)));
  ASSERT_TRUE(read.ok()) << read.error().message();
  const LivePose& back = std::get<LivePose>(*read);
  EXPECT_EQ(back.sequence, pose.sequence);
  EXPECT_EQ(back.client_ms, pose.client_ms);
  EXPECT_EQ(back.eye, pose.eye);
  // Quaternions travel in single precision: seven digits.
  for (int c = 0; c < 4; ++c) EXPECT_NEAR(back.orientation[c], pose.orientation[c], 1e-7);
  EXPECT_EQ(back.vertical_fov, pose.vertical_fov);
  EXPECT_EQ(back.aspect, pose.aspect);
  EXPECT_EQ(back.velocity, pose.velocity);
  EXPECT_EQ(back.turn_rate, pose.turn_rate);
  EXPECT_EQ(back.latency_ms, pose.latency_ms);
  EXPECT_EQ(back.cell, pose.cell);

  const auto hello = parse_client_message(
      encode_message(ClientMessage(LiveHello{1280, 720, 8192, std::uint64_t(1) << 40})));
  ASSERT_TRUE(hello.ok());
  EXPECT_EQ(std::get<LiveHello>(*hello).height, 720);
  EXPECT_EQ(std::get<LiveHello>(*hello).memory, std::uint64_t(1) << 40);

  const auto dropped =
      parse_client_message(encode_message(ClientMessage(LiveDropped{{3, ~0ull >> 1}})));
  ASSERT_TRUE(dropped.ok());
  EXPECT_EQ(std::get<LiveDropped>(*dropped).ids, (std::vector<std::uint64_t>{3, ~0ull >> 1}));
  const auto have = parse_client_message(encode_message(ClientMessage(LiveHave{})));
  ASSERT_TRUE(have.ok());
  EXPECT_TRUE(std::get<LiveHave>(*have).ids.empty());
}

TEST(Message, ServerMessagesComeBackAsTheyWere) {
  const LivePictureHead head = some_head();
  const std::vector<std::byte> depths = bytes_of_count(11), colors = bytes_of_count(5);
  const std::vector<std::byte> bytes =
      encode_message(ServerMessage(LivePicture{head, depths, colors}));
  const auto read = parse_server_message(bytes);
  ASSERT_TRUE(read.ok()) << read.error().message();
  const LivePicture& back = std::get<LivePicture>(*read);
  EXPECT_EQ(back.head.fine, head.fine);
  EXPECT_EQ(back.head.layer, head.layer);
  EXPECT_EQ(back.head.color, head.color);
  EXPECT_EQ(back.head.surround_face, head.surround_face);
  EXPECT_EQ(back.head.keyframe, head.keyframe);
  EXPECT_EQ(back.head.id, head.id);
  EXPECT_EQ(back.head.content, head.content);
  EXPECT_EQ(back.head.eye, head.eye);
  EXPECT_EQ(back.head.window, head.window);
  EXPECT_EQ(back.head.width, head.width);
  EXPECT_EQ(back.head.height, head.height);
  EXPECT_EQ(back.head.step, head.step);
  EXPECT_EQ(back.head.offset, head.offset);
  EXPECT_EQ(back.head.cell, head.cell);
  EXPECT_EQ(back.head.error_px, head.error_px);
  EXPECT_EQ(back.head.server_ms, head.server_ms);
  EXPECT_EQ(back.head.sequence, head.sequence);
  ASSERT_EQ(back.depths.size(), depths.size());
  EXPECT_EQ(std::memcmp(back.depths.data(), depths.data(), depths.size()), 0);
  ASSERT_EQ(back.colors.size(), colors.size());
  EXPECT_EQ(std::memcmp(back.colors.data(), colors.data(), colors.size()), 0);

  LiveWelcome welcome;
  welcome.name = "grove", welcome.bounds = {{-1, -2, -3}, {4, 5, 6}}, welcome.without_sky = true;
  welcome.unit = 0.25;
  const auto greeted = parse_server_message(encode_message(ServerMessage(welcome)));
  ASSERT_TRUE(greeted.ok());
  EXPECT_EQ(std::get<LiveWelcome>(*greeted).name, "grove");
  EXPECT_EQ(std::get<LiveWelcome>(*greeted).bounds.max, welcome.bounds.max);
  EXPECT_EQ(std::get<LiveWelcome>(*greeted).unit, 0.25);
  EXPECT_TRUE(std::get<LiveWelcome>(*greeted).without_sky);
  const auto bye = parse_server_message(encode_message(ServerMessage(LiveBye{LiveEnd::too_slow})));
  ASSERT_TRUE(bye.ok());
  EXPECT_EQ(std::get<LiveBye>(*bye).reason, LiveEnd::too_slow);
}

// docs/protocol.md and clients of others count bytes.
TEST(Message, FieldsLieWhereThePageSays) {
  const auto pose = encode_message(ClientMessage(some_pose()));
  EXPECT_EQ(pose.size(), 104u);
  EXPECT_EQ(pose[0], std::byte{2});
  EXPECT_EQ(pose[1], std::byte{1});
  EXPECT_EQ(pose[4], std::byte{0x00});  // 4000000000 = 0xEE6B2800
  EXPECT_EQ(pose[7], std::byte{0xEE});
  EXPECT_EQ(pose[91], std::byte{0x43});  // 250 = 0x437A0000
  const std::vector<std::byte> depths(3, std::byte{0xAB});
  const auto picture = encode_message(ServerMessage(LivePicture{some_head(), depths, {}}));
  EXPECT_EQ(picture.size(), 163u);
  EXPECT_EQ(picture[0], std::byte{66});
  EXPECT_EQ(picture[16], std::byte{0x88});
  EXPECT_EQ(picture[97], std::byte{6});  // 1536
  EXPECT_EQ(picture[132], std::byte{3});
  EXPECT_EQ(picture[140], std::byte{5});
  EXPECT_EQ(picture[160], std::byte{0xAB});
}

template <class T>
void set(std::vector<std::byte>& bytes, std::size_t at, T value) {
  std::memcpy(&bytes[at], &value, sizeof value);
}

TEST(Message, AnErrorNamesTheFieldThatIsWrong) {
  const auto reason = [](const std::vector<std::byte>& bytes) {
    const auto read = parse_client_message(bytes);
    return read ? std::string("none") : read.error().reason;
  };
  const auto good = encode_message(ClientMessage(some_pose()));
  auto bad = good;
  set(bad, 16, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(reason(bad), "eye is wrong");
  bad = good, set(bad, 40, 0.0f);
  set(bad, 44, 0.0f), set(bad, 48, 0.0f), set(bad, 52, 0.0f);
  EXPECT_EQ(reason(bad), "orientation is wrong");
  bad = good, set(bad, 56, 3.5f);
  EXPECT_EQ(reason(bad), "vertical field of view is wrong");
  bad = good, bad[1] = std::byte{2};
  EXPECT_EQ(reason(bad), "version is wrong");
  bad = good, bad[0] = std::byte{66};
  EXPECT_EQ(reason(bad), "kind is wrong");
  bad = good, bad.push_back(std::byte{});
  EXPECT_EQ(reason(bad), "size is wrong");
  EXPECT_EQ(reason({}), "size is wrong");
  EXPECT_EQ(reason(std::vector<std::byte>(5000)), "size is wrong");
  auto ids = encode_message(ClientMessage(LiveDropped{{1, 2}}));
  set(ids, 4, std::uint32_t(0x20000001));  // times 8 it is 8 again in 32 bits
  EXPECT_EQ(reason(ids), "count is wrong");
}

// What is read either is refused or keeps the limits; and written again it is the same message.
TEST(Message, DamagedMessagesAreRefusedOrWithinLimits) {
  std::mt19937 random(1);
  const std::vector<std::byte> seeds[] = {encode_message(ClientMessage(some_pose())),
                                          encode_message(ClientMessage(LiveHello{})),
                                          encode_message(ClientMessage(LiveHave{{1, 2, 3}})),
                                          encode_message(ClientMessage(LivePing{5}))};
  int kept = 0, refused = 0;
  for (int i = 0; i < 100000; ++i) {
    std::vector<std::byte> bytes = seeds[random() % 4];
    const int changes = 1 + int(random() % 4);
    for (int c = 0; c < changes; ++c) {
      const std::size_t at = random() % bytes.size();
      bytes[at] = std::byte(std::uint8_t(random()));
    }
    if (random() % 8 == 0) bytes.resize(random() % (bytes.size() + 8));
    const auto read = parse_client_message(bytes);
    if (!read) {
      ++refused;
      EXPECT_FALSE(read.error().reason.empty());
      continue;
    }
    ++kept;
    if (const auto* pose = std::get_if<LivePose>(&*read)) {
      EXPECT_TRUE(std::isfinite(pose->eye.x + pose->velocity.y + pose->turn_rate.z));
      EXPECT_NEAR(glm::length(pose->orientation), 1, 1e-12);
      EXPECT_GT(pose->vertical_fov, 0);
    }
    const auto again = parse_client_message(encode_message(*read));
    ASSERT_TRUE(again.ok());
    EXPECT_EQ(again->index(), read->index());
  }
  EXPECT_GT(kept, 1000);
  EXPECT_GT(refused, 1000);
}

TEST(Message, ACameraIsTheSameOnBothSides) {
  Camera camera = look_at({3, 4, 5}, {1, 2, -8}, {0, 1, 0}, 0.9, 1536, 864, 0.1, 500);
  LivePictureHead head;
  set_camera(camera, head);
  const auto bytes = encode_message(ServerMessage(LivePicture{head, {}, {}}));
  const auto first = parse_server_message(bytes);
  ASSERT_TRUE(first.ok());
  const LivePictureHead& sent = std::get<LivePicture>(*first).head;
  // What was rounded once stays as it is.
  LivePictureHead again;
  set_camera(camera_of(sent, 500), again);
  const auto second =
      parse_server_message(encode_message(ServerMessage(LivePicture{again, {}, {}})));
  ASSERT_TRUE(second.ok());
  const Camera a = camera_of(sent, 500), b = camera_of(std::get<LivePicture>(*second).head, 500);
  EXPECT_EQ(a.window, b.window);
  for (int c = 0; c < 3; ++c)
    // Quaternions of 24 bits: a turn of some 1e-7.
    EXPECT_LT(glm::length(a.world_from_eye[c] - camera.world_from_eye[c]), 5e-7);
}

}  // namespace
}  // namespace rilievo
