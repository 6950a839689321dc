// A frame of an explicit list of objects and pictures, without a sky: what is measured.
#pragma once

#include <numeric>
#include <utility>

#include "rilievo/cache/measure_costs.h"
#include "rilievo/frame/frame_content.h"

namespace rilievo {

// `Frames`: the frame source of a backend, made of what follows the pictures. `Pictures`: a
// drawable `set` and its `instances`.
template <typename Frames, typename Pictures>
class ExplicitFrames final : public Frames {
 public:
  template <typename Of, typename... Rest>
  ExplicitFrames(Pictures pictures, Of& of, Rest... rest)
      : Frames(of, rest...), pictures_(std::move(pictures)) {
    this->sky_ = false;
    this->content().sets.push_back({pictures_.set.get(), {}});
  }
  void show(const MeasuredRun& objects, const MeasuredRun& pictures) {
    objects_ = objects, shown_ = pictures;
  }

 private:
  Result<> choose(const Camera&, FrameContent& content, FrameStats&) override {
    content.polygons.resize(objects_.count);
    std::iota(content.polygons.begin(), content.polygons.end(), objects_.first);
    const auto first = pictures_.instances.begin() + shown_.first;
    content.sets[0].instances.assign(first, first + shown_.count);
    return Done{};
  }

  Pictures pictures_;
  MeasuredRun objects_, shown_;
};

}  // namespace rilievo
