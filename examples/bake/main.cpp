// Bakes a model into a file, which then draws without it:   rilievo_bake MODEL.glb OUT.exr
#include <rilievo/frame/software/software_backend.h>
#include <rilievo/representation/kinds.h>
#include <rilievo/scene/files/load_scene.h>

#include <cstdio>

using namespace rilievo;

Result<> bake(const char* model, const char* file) {
  const auto loaded = load_scene(model);
  if (!loaded) return loaded.error();
  const auto backend = SoftwareBackend::create(loaded->scene, 4);  // captures without OpenGL
  if (!backend) return backend.error();
  const auto source = (*backend)->make_capture_source();
  if (!source) return source.error();
  const Kind& kind = *find_kind(kinds(), "layered-impostor");  // or any of `rilievo info --kinds`
  OptionValues options(kind.bake_options);
  if (auto set = options.set("views", "12"); !set) return set;
  if (auto set = options.set("size", "128"); !set) return set;
  const auto baked = kind.bake({**source, {}}, options, {});
  if (!baked) return baked.error();
  return kind.save(*baked->representation, file);
}

int main(int argc, char** argv) {
  if (argc < 3) return std::fprintf(stderr, "usage: %s MODEL OUT.exr\n", argv[0]), 2;
  const auto done = bake(argv[1], argv[2]);
  if (!done) std::fprintf(stderr, "%s\n", done.error().message().c_str());
  return done ? 0 : 1;
}
