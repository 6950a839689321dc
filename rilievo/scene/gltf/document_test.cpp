#include "rilievo/scene/gltf/document.h"

#include <gtest/gtest.h>

namespace rilievo::gltf {
namespace {

// The warnings about a document with these members, or why it is refused.
std::vector<std::string> answers(const std::string& members) {
  const std::string text = R"({"asset": {"version": "2.0"}, )" + members + "}";
  LoadContext context{"", {}, 0.0, MemoryBudget(1 << 24)};
  try {
    (void)open_document(bytes_of(text), context);
    return context.warnings.lines();
  } catch (const LoadError& fault) {
    return {fault.reason};
  }
}

using Answers = std::vector<std::string>;

TEST(GltfDocument, an_extension_that_is_required_says_what_to_do) {
  EXPECT_EQ(answers(R"("extensionsRequired": ["EXT_odd"])"),
            Answers{"requires the extension EXT_odd, which is not supported"});
  EXPECT_EQ(answers(R"("extensionsRequired": ["KHR_texture_basisu"])"),
            Answers{"requires the extension KHR_texture_basisu, which is not supported: "
                    "'gltf-transform ktxdecompress IN.glb OUT.glb' (npm: @gltf-transform/cli) "
                    "makes PNG of its textures"});
  EXPECT_EQ(answers(R"("extensionsRequired": ["KHR_meshopt_compression", "CESIUM_RTC"])"),
            Answers{});
}

TEST(GltfDocument, the_centre_of_cesium_rtc_is_named) {
  EXPECT_EQ(answers(R"("extensionsUsed": ["CESIUM_RTC"],
                       "extensions": {"CESIUM_RTC": {"center": [6378137.25, 0, -12]}})"),
            Answers{"coordinates count from the centre that CESIUM_RTC gives: 6378137.250000 "
                    "0.000000 -12.000000"});
  EXPECT_EQ(answers(R"("extensions": {"CESIUM_RTC": {}})"), Answers{});
}

}  // namespace
}  // namespace rilievo::gltf
