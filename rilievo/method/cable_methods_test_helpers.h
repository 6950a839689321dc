// A cable of half a texel, as the methods draw it by a backend.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>

#include "rilievo/capture/cable_test_helpers.h"
#include "rilievo/frame/backend_target.h"
#include "rilievo/method/method.h"

namespace rilievo::test_cable {

// Nailboards are shown from so many degrees aside, seven times as far as usual. From 20 a cable is
// whole, too, but lies up to 4 pixels beside where it is looked for: its rectangle stands aslant.
inline constexpr double kMostAside = 5;

// With textures of 128 texels over the cable, and faces of 192 around an eye: a texel is 0.019 to
// 0.022 m wide where the cable is, and a pixel 0.013, as are texels that are captured for frames.
inline MethodOptions small_pictures(const std::string& method, const Box& eyes) {
  MethodOptions options;
  options.texel_px = 100;  // baked objects are drawn, however coarse
  options.angle_degrees = kMostAside;
  options.eyes = eyes;
  options.impostors.texels = 128;
  if (const Kind* kind = kind_method(method).kind)
    for (const auto& [option, value] :
         {std::pair{"views", "12"}, {"size", "128"}, {"textures", "6"}, {"face", "192"}})
      if (find_option(options_of(*kind, KindOptionsOf::bake), option))
        options.kinds.bake[option] = value;
  return options;
}

// Half a texel of the method's pictures, metres.
inline double half_texel(const std::string& method) {
  return method == "direct" || method == "nailboard" ? 0.0066 : 0.01;
}

inline constexpr double kMostGapPx = 1;

using MakeBackend = std::function<std::unique_ptr<Backend>(const Scene&)>;

// The widest gap along such a cable, over a few angles and eyes.
inline double widest_gap_px(const std::string& method, const MakeBackend& make) {
  Box eyes;
  eyes.add(glm::vec3(-0.4f, -0.2f, 2.9f)), eyes.add(glm::vec3(0.5f, 0.3f, 3.1f));
  double widest = 0;
  for (const double angle : {0.03, 0.3, 0.7, 1.2, 1.54}) {
    const Cable cable{.width = half_texel(method), .angle = angle};
    const Scene scene = scene_of(cable);
    const std::unique_ptr<Backend> backend = make(scene);
    Result<Method> made = make_method(method, small_pictures(method, eyes), *backend);
    EXPECT_TRUE(made.ok()) << made.error().message();
    if (!made) return 1e9;
    const auto target = backend->make_target(kWidth, kHeight);
    EXPECT_TRUE(target.ok());
    for (int i = 0; i < 6; ++i) {
      const Camera camera = camera_at({-0.4 + 0.16 * i, -0.2 + 0.1 * (i % 4), 2.9 + 0.04 * i});
      EXPECT_TRUE((*target)->draw(*made->frames, camera, 0).ok());
      // The wall is light.
      EXPECT_LE(made->frames->stats().polygons, method == "direct" ? 2 : 1);
      widest = std::max(widest, widest_gap_px((*target)->color(), camera, cable));
    }
  }
  return widest;
}

}  // namespace rilievo::test_cable
