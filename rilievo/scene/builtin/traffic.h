// Vehicles that drive along a road, for the scene `bridge`.
#pragma once

#include <functional>
#include <string>

#include "rilievo/scene/scene.h"

namespace rilievo {

// A road along x from -half_length to half_length, driven from end to end in `seconds`.
struct Road {
  float half_length = 100;
  float seconds = 20;
  std::function<float(float x)> height;
};

struct Vehicle {
  std::string name;
  int model = 0;          // forward is +x
  float half_length = 2;  // from the middle to the axles, for the slope of the road
  float lane = 0;         // z of its middle; drives towards +x where positive, else towards -x
  float sway = 0;         // metres that it leaves its lane to either side
  float phase = 0;        // share of the road driven at time 0
};

// Adds the object, its node, and channels that repeat after road.seconds. At the end of the road
// the vehicle jumps back to the beginning, within a tenth of a millisecond.
void add_vehicle(Scene& scene, const Road& road, const Vehicle& vehicle);

}  // namespace rilievo
