// Lights and cameras of a glTF document. Internal; throws LoadError.
#pragma once

#include "rilievo/scene/gltf/nodes.h"

namespace rilievo::gltf {

// Those of the nodes that are drawn, where `posed` puts them.
void read_lights(Document& document, const Tree& tree, const PosedTree& posed, Scene& scene);
void read_cameras(Document& document, const Tree& tree, const PosedTree& posed, Scene& scene);

// Scales all lights by one factor so that together they light the centre of `bounds` as the default
// sun would. In the wild a "point light" is 5 candela or 50 000, by exporter, and nothing in the
// file says which; the proportions between lights are what can be trusted.
void balance_lights(const Box& bounds, std::vector<Light>& lights);

}  // namespace rilievo::gltf
