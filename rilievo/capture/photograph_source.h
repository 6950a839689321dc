// Posed photographs with depth as a source of pictures.
//
// A capture reprojects all photographs, or their parts within a box, into the camera
// (warp/reproject.h). Objects are not distinguished. Needs no OpenGL.
#pragma once

#include <string>
#include <vector>

#include "rilievo/capture/capture_source.h"

namespace rilievo {

// Photographs as a capture source.
class PhotographSource final : public CaptureSource {
 public:
  // `box` is the region of interest (world space); empty: everything that was measured.
  // `world` is where the photographs' space lies.
  PhotographSource(std::string name, std::vector<DepthImage> photographs, const Box& box = {},
                   const WorldSpace& world = {});

  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t> objects) const override;
  // Holes have no depth, but colour 0 0 0 1. Fails if `farthest` is requested, because photographs
  // do not know hidden surfaces.
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override;
  [[nodiscard]] std::span<const DepthImage> photographs() const override { return photographs_; }
  [[nodiscard]] WorldSpace world() const override { return world_; }

 private:
  std::string name_;
  std::vector<DepthImage> photographs_;
  Box box_;
  WorldSpace world_;
};

}  // namespace rilievo
