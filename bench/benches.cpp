#include <array>

#include "bench/automatic.h"
#include "bench/bench.h"
#include "bench/bound.h"
#include "bench/capture.h"
#include "bench/compose.h"
#include "bench/coverage.h"
#include "bench/decoupling.h"
#include "bench/deep_objects.h"
#include "bench/draw.h"
#include "bench/keyframes.h"
#include "bench/kinds.h"
#include "bench/layered.h"
#include "bench/layered_cost.h"
#include "bench/nailboard_bits.h"
#include "bench/nailboard_error.h"
#include "bench/nodes.h"
#include "bench/pop.h"
#include "bench/prewarp.h"
#include "bench/program_walk.h"
#include "bench/real.h"
#include "bench/relief.h"
#include "bench/relief_run.h"
#include "bench/rgbd.h"
#include "bench/serve.h"
#include "bench/spinning.h"
#include "bench/splats.h"
#include "bench/tradeoff.h"
#include "bench/triangulate.h"

namespace rilievo::bench {

std::span<const Bench> benches() {
  static constexpr std::array list{
      Bench{"nailboard-error", "What does the linear depth of eq. (4) cost? (figure 8)",
            Needs::nothing, nailboard_error},
      Bench{"nailboard-bits", "How many bits of Delta does a nailboard need? (figure 5)",
            Needs::as_it_draws, nailboard_bits},
      Bench{"bound", "Does the error bound hold, and how tight is it?", Needs::opengl, bound},
      Bench{"draw", "How many nailboards in a millisecond, and against a textured quad?",
            Needs::opengl, draw},
      Bench{"compose", "How fast are nailboards drawn without OpenGL?", Needs::nothing, compose},
      Bench{"kinds", "How fast is each baked kind drawn without OpenGL, and against polygons?",
            Needs::nothing, kinds_without_opengl},
      Bench{"capture", "What does capturing a picture cost, by OpenGL, by our rasteriser, by rays?",
            Needs::opengl, capture},
      Bench{"tradeoff", "What does an allowed error buy, and what does it cost?", Needs::opengl,
            tradeoff},
      Bench{"real", "How fast is the cache in scenes such as users have, in real time?",
            Needs::as_it_draws, real},
      Bench{"keyframes",
            "What do whole frames from keyframes cost and look like, beside direct drawing?",
            Needs::nothing, keyframes},
      Bench{"serve", "What does a client of a live walk see, over networks of all kinds?",
            Needs::nothing, serve},
      Bench{"auto", "Does the method auto take as little time as the best of all methods?",
            Needs::nothing, automatic},
      Bench{"scaling", "What does a cached frame cost as the scene grows?", Needs::nothing,
            scaling},
      Bench{"pop", "Does a picture that replaces another one pop, and does fading help?",
            Needs::as_it_draws, pop},
      Bench{"spinning", "What does a cache gain from impostors baked before, of what spins?",
            Needs::opengl, spinning},
      Bench{"coverage", "How much of an object do its pictures hold? (S2, figures 2 and 5)",
            Needs::nothing, coverage},
      Bench{"layered",
            "What do layered impostors look like from new eyes? A fortieth of them, or --full: "
            "all, in a quarter of an hour (S2.3 to S2.6)",
            Needs::opengl, layered},
      Bench{"layered-cost", "What do layered impostors cost? (S2.8: tables 2 and 3, figure 8)",
            Needs::opengl, layered_cost},
      Bench{"prewarp", "What does the pre-warp of layered reliefs cost? (S4.6 to S4.8)",
            Needs::nothing, prewarp},
      Bench{"splats", "Which splats show a layered picture best, and fastest? (S4.9: figure 6)",
            Needs::nothing, splats},
      Bench{"relief", "What do relief impostors cost, and how many does a walk take? (S5.2, S5.9)",
            Needs::nothing, relief},
      Bench{"decoupling",
            "Do frames stay fast and right while their pictures take long? (S5.1, S5.7)",
            Needs::as_it_draws, decoupling},
      Bench{"program-walk", "Does a walk go on while another program renders? (S5.8)",
            Needs::as_it_draws, program_walk},
      Bench{"relief-run", "What do layered reliefs cost over 300 turns? (S4.4, S4.7)",
            Needs::nothing, relief_run},
      Bench{"deep-objects", "What do layered reliefs gain for deep objects near the eye?",
            Needs::opengl, deep_objects},
      Bench{"rgbd", "What do impostors of photographs with depth look like? (S2.7)", Needs::nothing,
            rgbd},
      Bench{"triangulate", "How well do few triangles stand for a node's depths? (S3.2)",
            Needs::nothing, triangulate_nodes},
      Bench{"nodes", "What do environment nodes look like, alone and merged? (S3)", Needs::opengl,
            nodes},
      Bench{"node-bound", "Does a node's bound hold for what is drawn? (S3)", Needs::opengl,
            node_bound},
      Bench{"node-places", "How many nodes hold all that is seen? (S3)", Needs::nothing,
            node_places},
  };
  return list;
}

}  // namespace rilievo::bench
