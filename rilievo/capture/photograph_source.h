// Posed photographs with depth as a source of pictures.
//
// A capture is a reprojection of all photographs into the camera (warp/reproject.h), or of those
// that lie in the box. Objects are not told apart. Needs no OpenGL.
#pragma once

#include <string>
#include <vector>

#include "rilievo/capture/capture_source.h"

namespace rilievo {

class PhotographSource final : public CaptureSource {
 public:
  // `box` is the region of interest; empty: all that was measured.
  PhotographSource(std::string name, std::vector<DepthImage> photographs, const Box& box = {});

  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t> objects) const override;
  // Holes have no depth, but colour 0 0 0 1. Photographs know nothing of hidden surfaces:
  // `farthest` is an error.
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override;
  [[nodiscard]] std::span<const DepthImage> photographs() const override { return photographs_; }

 private:
  std::string name_;
  std::vector<DepthImage> photographs_;
  Box box_;
};

}  // namespace rilievo
