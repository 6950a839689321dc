#include "rilievo/web_walk/page_files.h"

namespace rilievo {
namespace {

constexpr std::string_view kScript = "text/javascript; charset=utf-8";

constexpr PageFile kPageFiles[] = {
    {
        "index.html",
        "text/html; charset=utf-8",
#include "rilievo/web_walk/page/index.html.inc"
    },
    {
        "viewer.js",
        kScript,
#include "rilievo/web_walk/page/viewer.js.inc"
    },
    {
        "headset.js",
        kScript,
#include "rilievo/web_walk/page/headset.js.inc"
    },
    {
        "live.js",
        kScript,
#include "rilievo/web_walk/page/live.js.inc"
    },
    {
        "pictures.js",
        kScript,
#include "rilievo/web_walk/page/pictures.js.inc"
    },
    {
        "reliefs.js",
        kScript,
#include "rilievo/web_walk/page/reliefs.js.inc"
    },
};

}  // namespace

std::span<const PageFile> page_files() { return kPageFiles; }

}  // namespace rilievo
