#include "apps/rilievo/impostors.h"

#include "apps/rilievo/checks.h"
#include "rilievo/capture/shaders/software_shader.h"

namespace rilievo::app {

void add_impostor_options(CLI::App& command, ReliefImpostorOptions& options) {
  command
      .add_option("--shader", options.shader,
                  "relief-impostor: who shades the pictures: raytrace, sdf:torus, sdf:gyroid, "
                  "sdf:menger, or exec:PROGRAM, which is started (default raytrace)")
      ->check(CLI::Validator(
          [](std::string& text) {
            const Result<> known = check_shader(text);
            return known ? std::string() : known.error().message();
          },
          ""))
      ->type_name("SHADER");
  command
      .add_option("--objects", options.objects,
                  "relief-impostor: the objects that are impostors, by name, or #0, #1, ... "
                  "(default all)")
      ->delimiter(',')
      ->type_name("NAME,...");
  command
      .add_option("--workers", options.workers,
                  "relief-impostor: threads that render pictures (default 1)")
      ->check(in_range(1, 64))
      ->type_name("N");
  command
      .add_option("--store", options.store,
                  "relief-impostor: a file that keeps finished pictures, searched before anything "
                  "is rendered; made if it is not there")
      ->type_name("FILE");
  command
      .add_option("--store-mb", options.store_mb,
                  "relief-impostor: the size of the store; the pictures used least recently go "
                  "first (default 4096)")
      ->check(in_range(1, 1 << 20))
      ->type_name("MB");
  command
      .add_option(
          "--impostor-texels", options.texels,
          "relief-impostor: the most texels a side of a picture, which otherwise has one for "
          "each pixel (default 1024)")
      ->check(in_range(16, 1024))
      ->type_name("N");
  command
      .add_option("--impostor-samples", options.samples,
                  "relief-impostor: samples a texel (default 4)")
      ->check(in_range(1, 4096))
      ->type_name("N");
}

}  // namespace rilievo::app
