#include <fmt/format.h>

#include <array>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "rilievo/measure/report_summary.h"
#include "rilievo/measure/svg_plot.h"

namespace rilievo {
namespace {

using Json = nlohmann::ordered_json;

std::string percent(double share) { return fmt::format("{:.3g} %", 100 * share); }
std::string ms(double v) {
  return v < 1000 ? fmt::format("{:.3g} ms", v) : fmt::format("{:.2f} s", v / 1000);
}
std::string decibel(double v) {
  return v >= kMaxPsnrDb ? std::string("identical") : fmt::format("{:.2f} dB", v);
}

// A row of the table of figures: its name, and how a method fills it.
struct Row {
  std::string name, meaning;
  std::string (*figure)(const MethodResult&, const MethodSummary&);
};

const std::array kReportRows = {
    Row{"Frame time, median", "Half of the frames take no longer.",
        [](const MethodResult&, const MethodSummary& s) { return ms(s.frame_ms.p50); }},
    Row{"Frame time, 99 %", "99 of 100 frames take no longer.",
        [](const MethodResult&, const MethodSummary& s) { return ms(s.frame_ms.p99); }},
    Row{"Frame time, longest", "",
        [](const MethodResult&, const MethodSummary& s) { return ms(s.frame_ms.max); }},
    Row{"PSNR, mean / least",
        "Against the true frames, 8-bit sRGB; higher is better. Of frames that show pictures.",
        [](const MethodResult&, const MethodSummary& s) {
          return decibel(s.psnr_db.mean) + " / " + decibel(s.psnr_db.min);
        }},
    Row{"SSIM, mean / least", "Structural similarity of luma; 1 is identical.",
        [](const MethodResult&, const MethodSummary& s) {
          return fmt::format("{:.4f} / {:.4f}", s.ssim.mean, s.ssim.min);
        }},
    Row{"FLIP, mean / most", "Perceived difference, 0 to 1; lower is better.",
        [](const MethodResult&, const MethodSummary& s) {
          return fmt::format("{:.4f} / {:.4f}", s.flip.mean, s.flip.max);
        }},
    Row{"FLIP of 99 %, mean / most", "99 of 100 pixels of a frame are no more different.",
        [](const MethodResult&, const MethodSummary& s) {
          return fmt::format("{:.4f} / {:.4f}", s.flip_p99.mean, s.flip_p99.max);
        }},
    Row{"Ghost edges, mean / most",
        "Share of pixels at an edge where the true frame has none within two pixels.",
        [](const MethodResult&, const MethodSummary& s) {
          return percent(s.ghost.mean) + " / " + percent(s.ghost.max);
        }},
    Row{"Speckle, mean / most",
        "Share of isolated pixels, off their neighbours as none of the true frame's near by is.",
        [](const MethodResult&, const MethodSummary& s) {
          return percent(s.speckle.mean) + " / " + percent(s.speckle.max);
        }},
    Row{"Flicker, mean / most",
        "How much more pixels change from frame to frame than the true frames' near by; of 1.",
        [](const MethodResult& m, const MethodSummary& s) {
          return m.flicker.empty() ? std::string()
                                   : fmt::format("{:.2g} / {:.2g}", s.flicker.mean, s.flicker.max);
        }},
    Row{"Wrong visibility, mean / most",
        "Share of pixels that show another object than the true frame; pixels within 1 pixel of an "
        "object boundary are not counted.",
        [](const MethodResult&, const MethodSummary& s) {
          return percent(s.wrong_visibility.mean) + " / " + percent(s.wrong_visibility.max);
        }},
    Row{"Counted pixels, mean / least", "The share that wrong visibility is taken of.",
        [](const MethodResult&, const MethodSummary& s) {
          return percent(s.counted.mean) + " / " + percent(s.counted.min);
        }},
    Row{"Uncovered, mean / most",
        "Share of the objects' pixels where nothing is drawn; boundaries are not counted.",
        [](const MethodResult&, const MethodSummary& s) {
          return percent(s.uncovered.mean) + " / " + percent(s.uncovered.max);
        }},
    Row{"Gap, most",
        "The widest strip that shows what lies behind a surface instead of the surface. Beside "
        "each edge, an error of position looks like a gap as wide.",
        [](const MethodResult&, const MethodSummary& s) {
          return fmt::format("{:.3g} px", s.gap_px.max);
        }},
    Row{"Depth error, median / 99 %", "Relative error of the distance where the object is right.",
        [](const MethodResult& m, const MethodSummary&) {
          return percent(m.depth_error_p50) + " / " + percent(m.depth_error_p99);
        }},
    Row{"Captures", "Pictures captured, and the time they took of all frames.",
        [](const MethodResult& m, const MethodSummary&) {
          return m.captures == 0 ? std::string("none")
                                 : fmt::format("{} ({})", m.captures, ms(m.capture_ms));
        }},
    Row{"Memory of pictures", "The most held at a time.",
        [](const MethodResult& m, const MethodSummary&) {
          return m.picture_bytes == 0 ? std::string("none")
                                      : fmt::format("{:.3g} MB", double(m.picture_bytes) / 1e6);
        }},
    Row{"Error bound, most", "What the method promises, in pixels of the frame.",
        [](const MethodResult& m, const MethodSummary&) {
          return m.bound_px_max ? fmt::format("{:.3g} px", *m.bound_px_max) : std::string();
        }},
    Row{"First frame", "It fills caches.",
        [](const MethodResult& m, const MethodSummary&) {
          return m.first_frame_ms ? ms(*m.first_frame_ms) : std::string();
        }},
    Row{"After a cut, most", "The first frame after a jump of the eye; it may be coarse.",
        [](const MethodResult& m, const MethodSummary&) {
          return m.cut_ms ? ms(*m.cut_ms) : std::string();
        }},
    Row{"Frames over the bound", "Frames that could not keep the error that was allowed.",
        [](const MethodResult& m, const MethodSummary&) {
          return m.over_bound_share ? fmt::format("{:.2f} %", 100 * *m.over_bound_share)
                                    : std::string();
        }},
    Row{"Gap bound, most",
        "The widest strip that may lack what was hidden when a picture was captured, in pixels.",
        [](const MethodResult& m, const MethodSummary&) {
          return m.gap_bound_px_max ? fmt::format("{:.3g} px", *m.gap_bound_px_max) : std::string();
        }},
    Row{"Error, median / 99 % / most",
        "How far from their true places surfaces are drawn, by the positions that pixels show.",
        [](const MethodResult& m, const MethodSummary&) {
          return m.error_px ? fmt::format("{:.3g} / {:.3g} / {:.3g} px, resolved to {:.2g}",
                                          m.error_px->p50, m.error_px->p99, m.error_px->max,
                                          m.error_px->resolution)
                            : std::string();
        }},
    Row{"Pixels measured for it",
        "Of those that show objects; not beside boundaries and steps, nor too near or far away.",
        [](const MethodResult& m, const MethodSummary&) {
          return m.error_px ? percent(m.error_px->measured) : std::string();
        }},
    Row{"Pop, most",
        "By how much a frame differs from the one before it (FLIP), above the true frames' change.",
        [](const MethodResult& m, const MethodSummary&) {
          return m.pop_max ? fmt::format("{:.4f}", *m.pop_max) : std::string();
        }},
    Row{"Drawn as", "How many objects, over all frames.",
        [](const MethodResult& m, const MethodSummary&) {
          std::string out;
          for (const auto& [way, count] : m.drawn_as)
            out += fmt::format("{}{} {}", out.empty() ? "" : ", ", count, way);
          return out;
        }},
    Row{"Frames by", "What drew them, where a method chooses between others.",
        [](const MethodResult& m, const MethodSummary&) {
          std::map<std::string, int> frames;
          for (const std::string& one : m.decisions) ++frames[one.substr(0, one.find(' '))];
          std::string out;
          for (const auto& [name, count] : frames)
            out += fmt::format("{}{} {}", out.empty() ? "" : ", ", count, name);
          return out;
        }},
};

// Methods are columns. Rows that no method fills are left out.
std::string figures_table(const Report& report) {
  std::vector<MethodSummary> summaries;
  // The fastest way to draw the scene without pictures.
  double direct_ms = 0;
  std::string direct_name;
  std::string head = "<tr><th></th>";
  for (const MethodResult& method : report.methods) {
    summaries.push_back(summarize(method));
    const double ms = summaries.back().frame_ms.p50;
    if (method.name.starts_with("direct") || method.name == "lod")
      if (direct_ms == 0 || ms < direct_ms) direct_ms = ms, direct_name = method.name;
    head += "<th>" + html_text(method.name) + "</th>";
  }
  std::string body;
  const auto add_row = [&](const Row& row, const std::vector<std::string>& cells) {
    body += "<tr><th title=\"" + html_text(row.meaning) + "\">" + html_text(row.name) + "</th>";
    for (const std::string& cell : cells) body += "<td>" + html_text(cell) + "</td>";
    body += "</tr>\n";
  };
  for (const Row& row : kReportRows) {
    std::vector<std::string> cells;
    bool filled = false;
    for (std::size_t i = 0; i < summaries.size(); ++i) {
      cells.push_back(row.figure(report.methods[i], summaries[i]));
      filled = filled || !cells.back().empty();
    }
    if (filled) add_row(row, cells);
    if (&row != &kReportRows[2] || direct_ms <= 0) continue;
    for (std::size_t i = 0; i < summaries.size(); ++i)
      cells[i] = fmt::format("{:.2f} x", direct_ms / summaries[i].frame_ms.p50);
    add_row(
        {"Speed-up of the median", "Over " + direct_name + ", the fastest baseline here.", nullptr},
        cells);
  }
  return "<table class=\"figures\"><thead>" + head + "</tr></thead><tbody>\n" + body +
         "</tbody></table>";
}

Plot path_plot(const Report& report, const char* title, const char* y_label,
               double FrameResult::*figure, double scale) {
  Plot plot{title, "frame", y_label, {}};
  for (const MethodResult& method : report.methods) {
    Curve curve{method.name, {}, series(method, figure)};
    for (std::size_t i = 0; i < curve.y.size(); ++i) {
      curve.x.push_back(double(i));
      curve.y[i] *= scale;
    }
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

std::string plots(const Report& report) {
  Plot time = path_plot(report, "Frame time", "ms", &FrameResult::frame_ms, 1);
  time.log_y = true;
  // Identical frames would press all others together.
  Plot psnr = path_plot(report, "PSNR (identical frames left out)", "dB", &FrameResult::psnr_db, 1);
  for (Curve& curve : psnr.curves)
    for (double& v : curve.y)
      if (v >= kMaxPsnrDb) v = std::numeric_limits<double>::quiet_NaN();
  return svg_plot(time) + svg_plot(psnr) +
         svg_plot(path_plot(report, "Wrong visibility", "% of pixels",
                            &FrameResult::wrong_visibility, 100)) +
         svg_plot(path_plot(report, "FLIP", "mean difference", &FrameResult::flip, 1));
}

std::string facts(const Report& report) {
  std::string out;
  const auto fact = [&](const char* name, const std::string& value) {
    if (!value.empty())
      out += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", name, html_text(value));
  };
  fact("Scene", fmt::format("{}: {} triangles, {} objects", report.scene_name, report.triangles,
                            report.objects));
  fact("Frames", fmt::format("{} of {} x {}", report.methods.front().frames.size(), report.width,
                             report.height));
  fact("Antialiasing", report.antialiasing);
  fact("Processor", fmt::format("{}, {} thread{}", report.machine.cpu, report.machine.threads,
                                report.machine.threads == 1 ? "" : "s"));
  fact("OpenGL", report.machine.gl_renderer);
  fact("Commit", report.commit);
  fact("Command", report.command);
  return out;
}

// What the page's script needs: the pictures, and the figures of the frames shown.
std::string frames_json(const Report& report) {
  const auto uris = [](const std::vector<EncodedPicture>& pictures) {
    Json out = Json::array();
    for (const EncodedPicture& picture : pictures) out.push_back(data_uri(picture));
    return out;
  };
  Json out;
  out["shown"] = report.shown;
  out["size"] = {report.width, report.height};
  out["truth"] = uris(report.true_pictures);
  out["methods"] = Json::array();
  for (const MethodResult& method : report.methods) {
    RILIEVO_EXPECTS_EQ(method.pictures.size(), report.shown.size());
    RILIEVO_EXPECTS_EQ(method.differences.size(), report.shown.size());
    Json captions = Json::array();
    for (int frame : report.shown) {
      const FrameResult& f = method.frames.at(std::size_t(frame));
      captions.push_back(fmt::format("{} · {} · SSIM {:.4f} · FLIP {:.4f} · wrong {}",
                                     ms(f.frame_ms), decibel(f.psnr_db), f.ssim, f.flip,
                                     percent(f.wrong_visibility)));
    }
    out["methods"].push_back({{"name", method.name},
                              {"pictures", uris(method.pictures)},
                              {"differences", uris(method.differences)},
                              {"captions", captions}});
  }
  return out.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string report_html(const Report& report) {
  RILIEVO_EXPECTS(!report.methods.empty());
  RILIEVO_EXPECTS_EQ(report.true_pictures.size(), report.shown.size());
  std::string notes;
  for (const std::string& note : report.notes) notes += "<p>" + html_text(note) + "</p>\n";
  const std::pair<std::string_view, std::string> texts[] = {
      {"TITLE", html_text(report.scene_name)},
      {"STYLE", std::string(page_style())},
      {"FACTS", facts(report)},
      {"NOTES", notes},
      {"TABLE", figures_table(report)},
      {"PLOTS", plots(report)},
      {"FRAMES", script_json(frames_json(report))},
      {"SCRIPT", std::string(report_script())},
  };
  return fill_page(report_page(), texts);
}

}  // namespace rilievo
