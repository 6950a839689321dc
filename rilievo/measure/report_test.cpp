#include "rilievo/measure/report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "rilievo/measure/bench_report.h"

namespace rilievo {
namespace {

using Json = nlohmann::ordered_json;

Report small_report() {
  Report r;
  r.commit = "abc1234";
  r.machine = {"A CPU", 2, "llvmpipe"};
  r.scene_name = "bridge";
  r.triangles = 2000000;
  r.objects = 321;
  r.width = 64, r.height = 48;
  r.antialiasing = "4 samples a pixel";
  r.shown = {0, 2};
  r.true_pictures.assign(2, {"image/png", {1, 2, 3}});
  for (const char* name : {"direct", "nailboard"}) {
    MethodResult m;
    m.name = name;
    for (int i = 0; i < 3; ++i)
      m.frames.push_back(
          {10.0 + i, 30.0 + i, 0.9, 0.1, 0.001 * i, 0.002 * i, 0.75 + 0.1 * i, 2.0 * i});
    for (FrameResult& f : m.frames) f.flip_p99 = 0.5, f.ghost = 0.01, f.speckle = 0.02;
    m.flicker = {0.25, 0.75};
    m.depth_error_p50 = 0.25;
    m.captures = 7;
    m.capture_ms = 70;
    m.picture_bytes = 1 << 20;
    m.pictures = m.differences = r.true_pictures;
    r.methods.push_back(m);
  }
  for (FrameResult& f : r.methods[0].frames) f.psnr_db = std::numeric_limits<double>::infinity();
  return r;
}

TEST(Report, json_has_the_keys_of_its_schema_and_their_figures) {
  const Json j = Json::parse(report_json(small_report()));
  EXPECT_EQ(j["schema"], "rilievo-report-1");
  EXPECT_EQ(j["commit"], "abc1234");
  EXPECT_EQ(j["machine"], Json({{"cpu", "A CPU"}, {"threads", 2}, {"gl_renderer", "llvmpipe"}}));
  EXPECT_EQ(j["scene"], Json({{"name", "bridge"}, {"triangles", 2000000}, {"objects", 321}}));
  EXPECT_EQ(j["size"], Json({64, 48}));
  EXPECT_EQ(j["frames"], 3);
  const Json& m = j["methods"]["nailboard"];
  EXPECT_EQ(m["frame_ms"]["p50"], 11);
  EXPECT_DOUBLE_EQ(m["frame_ms"]["p99"], 11.98);
  EXPECT_EQ(m["frame_ms"]["max"], 12);
  EXPECT_EQ(m["psnr_db"], Json({{"mean", 31.0}, {"min", 30.0}}));
  EXPECT_EQ(m["ssim"]["min"], 0.9);
  EXPECT_EQ(m["flip"]["max"], 0.1);
  EXPECT_DOUBLE_EQ(m["wrong_visibility"]["mean"], 0.001);
  EXPECT_EQ(m["wrong_visibility"]["max"], 0.002);
  EXPECT_EQ(m["uncovered"]["max"], 0.004);
  EXPECT_EQ(m["counted"]["min"], 0.75);
  EXPECT_EQ(m["gap_px"]["max"], 4);
  EXPECT_EQ(m["flip_p99"]["max"], 0.5);
  EXPECT_EQ(m["ghost"]["max"], 0.01);
  EXPECT_EQ(m["speckle"]["max"], 0.02);
  EXPECT_EQ(m["flicker"], Json({{"mean", 0.5}, {"max", 0.75}}));
  EXPECT_EQ(m["picture_frames"], 3);
  EXPECT_EQ(m["depth_error"], Json({{"p50", 0.25}, {"p99", 0.0}}));
  EXPECT_EQ(m["captures"], 7);
  EXPECT_EQ(m["capture_ms"], 70);
  EXPECT_EQ(m["picture_bytes"], 1 << 20);
  EXPECT_EQ(m["series"]["frame_ms"], Json({10.0, 11.0, 12.0}));
  // Identical frames are no null.
  EXPECT_EQ(j["methods"]["direct"]["psnr_db"]["mean"], kMaxPsnrDb);
}

TEST(Report, frames_of_polygons_alone_do_not_make_pictures_look_better) {
  Report r = small_report();
  MethodResult& cache = r.methods[1];
  cache.frames[0].pictures = false;
  cache.frames[0].psnr_db = std::numeric_limits<double>::infinity();
  Json m = Json::parse(report_json(r))["methods"]["nailboard"];
  EXPECT_EQ(m["psnr_db"], Json({{"mean", 31.5}, {"min", 31.0}}));
  EXPECT_EQ(m["picture_frames"], 2);
  EXPECT_EQ(m["series"]["psnr_db"][0], kMaxPsnrDb);
  // Where there are no others they are what there is to say.
  for (FrameResult& f : cache.frames) f.pictures = false, f.psnr_db = 60;
  m = Json::parse(report_json(r))["methods"]["nailboard"];
  EXPECT_EQ(m["psnr_db"]["mean"], 60);
}

TEST(Report, keys_of_later_methods_are_there_only_where_they_are_known) {
  Report r = small_report();
  for (const char* key : {"bound_px", "gap_bound_px", "error_px", "drawn_as", "decisions"})
    EXPECT_FALSE(Json::parse(report_json(r))["methods"]["nailboard"].contains(key));
  r.methods[1].bound_px_max = 0.75;
  r.methods[1].gap_bound_px_max = 1.5;
  r.methods[1].error_px = ErrorPx{0.1, 0.2, 0.3, 0.4, 0.5, 0.06, 0.07, 0.08, 0.09, 10, 11};
  r.methods[1].drawn_as = {{"polygons", 4}, {"nailboard", 5}, {"hierarchy", 6}};
  r.methods[1].decisions = {"cache (the cheapest)", "direct (a trial)"};
  const Json m = Json::parse(report_json(r))["methods"]["nailboard"];
  EXPECT_EQ(m["decisions"], Json({"cache (the cheapest)", "direct (a trial)"}));
  EXPECT_EQ(m["bound_px"]["max"], 0.75);
  EXPECT_EQ(m["gap_bound_px"]["max"], 1.5);
  EXPECT_EQ(m["error_px"], Json({{"p50", 0.1},
                                 {"p99", 0.2},
                                 {"max", 0.3},
                                 {"resolution", 0.4},
                                 {"measured_share", 0.5},
                                 {"boundary_share", 0.06},
                                 {"mixed_share", 0.07},
                                 {"unresolved_share", 0.08},
                                 {"over_bound_share", 0.09},
                                 {"violations", 10},
                                 {"in_gaps", 11}}));
  EXPECT_EQ(m["drawn_as"], Json({{"polygons", 4}, {"nailboard", 5}, {"hierarchy", 6}}));
}

std::string between(const std::string& text, const std::string& open, const std::string& close) {
  const std::size_t begin = text.find(open) + open.size();
  return text.substr(begin, text.find(close, begin) - begin);
}

TEST(Report, page_holds_everything_and_cannot_be_broken_out_of) {
  Report r = small_report();
  r.scene_name = "</script><b>\"&{{TABLE}}";
  r.methods[1].name = "</script><!--";
  const std::string page = report_html(r);
  // One script of data, one of code; nothing is loaded from elsewhere.
  std::size_t scripts = 0;
  for (std::size_t at = 0; (at = page.find("</script>", at)) != std::string::npos; ++at) ++scripts;
  EXPECT_EQ(scripts, 2u);
  for (const char* outside : {"src=\"http", "href=", "url(", "@import", "<b>"})
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
  EXPECT_NE(page.find("&lt;/script&gt;&lt;b&gt;&quot;&amp;{{TABLE}}"), std::string::npos);
  const Json data =
      Json::parse(between(page, "<script type=\"application/json\" id=\"data\">", "</script>"));
  EXPECT_EQ(data["shown"], Json({0, 2}));
  EXPECT_EQ(data["truth"][1], "data:image/png;base64,AQID");
  EXPECT_EQ(data["methods"][1]["name"], "</script><!--");
  EXPECT_EQ(data["methods"][1]["captions"].size(), 2u);
  // Four plots, with a curve for each of the methods.
  std::size_t plots = 0;
  for (std::size_t at = 0; (at = page.find("<svg", at)) != std::string::npos; ++at) ++plots;
  EXPECT_EQ(plots, 4u);
}

TEST(Report, broken_utf8_in_a_name_is_replaced) {
  Report r = small_report();
  r.scene_name = "caf\xe9";
  EXPECT_EQ(Json::parse(report_json(r))["scene"]["name"], "caf\xef\xbf\xbd");
}

TEST(Report, frames_to_show_are_spread_evenly_with_both_ends) {
  EXPECT_EQ(frames_to_show(120, 4), (std::vector<int>{0, 40, 79, 119}));
  EXPECT_EQ(frames_to_show(3, 10), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(frames_to_show(1, 10), (std::vector<int>{0}));
  EXPECT_TRUE(frames_to_show(0, 10).empty());
}

TEST(Html, base64_is_that_of_rfc_4648) {
  const auto encoded = [](std::string_view text) {
    return data_uri({"t", {text.begin(), text.end()}});
  };
  const char* expected[] = {"", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"};
  for (std::size_t n = 0; n <= 6; ++n)
    EXPECT_EQ(encoded(std::string_view("foobar").substr(0, n)),
              std::string("data:t;base64,") + expected[n]);
  EXPECT_EQ(encoded("\xff\xfe\xfd"), "data:t;base64,//79");
}

TEST(DifferencePicture, is_black_where_equal_and_grows_lighter) {
  Rgba8Image a(3, 1, glm::u8vec4(100, 100, 100, 255)), b = a;
  b(1, 0).g = 110;
  b(2, 0).r = 0;
  const Rgba8Image d = difference_picture(a, b, 64);
  EXPECT_EQ(d(0, 0), glm::u8vec4(0, 0, 0, 255));
  EXPECT_EQ(d(2, 0), glm::u8vec4(255, 255, 240, 255));
  const auto light = [](const glm::u8vec4& c) { return int(c.r) + c.g + c.b; };
  EXPECT_GT(light(d(1, 0)), 0);
  EXPECT_LT(light(d(1, 0)), light(d(2, 0)));
}

BenchReport small_bench() {
  BenchReport b;
  b.bench = "nailboard-bits";
  b.machine = {"A CPU", 2, ""};
  b.figures = {{"wrong_visibility_2bit", 0.125}, {"broken", std::nan("")}};
  b.tables = {{"Bits", {"method", "bits", "share"}, {{"exact", "2", "12.5 %"}, {"é", "16", ""}}}};
  b.plots = {{"Share", "bits", "%", {{"exact", {2, 16}, {12.5, 0.1}}}}};
  b.notes = {"A sentence."};
  return b;
}

TEST(BenchReport, json_has_its_figures_by_name_and_its_series) {
  const Json j = Json::parse(bench_json(small_bench()));
  EXPECT_EQ(j["schema"], "rilievo-bench-1");
  EXPECT_EQ(j["bench"], "nailboard-bits");
  EXPECT_EQ(j["commit"], "unknown");
  EXPECT_EQ(j["machine"]["threads"], 2);
  EXPECT_EQ(j["figures"]["wrong_visibility_2bit"], 0.125);
  EXPECT_TRUE(j["figures"]["broken"].is_null());
  EXPECT_EQ(j["series"]["plots"][0]["curves"][0]["y"], Json({12.5, 0.1}));
  EXPECT_EQ(j["series"]["tables"][0]["rows"][1][1], "16");
}

TEST(BenchReport, text_is_aligned_numbers_to_the_right) {
  const std::string text = bench_text(small_bench());
  EXPECT_TRUE(
      text.starts_with("Bits\n"
                       "method  bits   share\n"
                       "--------------------\n"
                       "exact      2  12.5 %\n"
                       "é         16\n"))
      << text;
  EXPECT_NE(text.find("wrong_visibility_2bit  0.125\n"), std::string::npos) << text;
}

TEST(BenchReport, page_is_filled) {
  const std::string page = bench_html(small_bench());
  EXPECT_EQ(page.find("{{"), std::string::npos);
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_NE(page.find("12.5 %"), std::string::npos);
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++n;
  return n;
}

TEST(SvgPlot, what_cannot_be_shown_interrupts_its_curve) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  Plot plot{"t", "x", "y", {{"c", {0, 1, 2, 3, 4, 5}, {1, 2, nan, 3, inf, 4}}}};
  std::string svg = svg_plot(plot);
  const std::string path = between(svg, "<path d=\"", "\"");
  EXPECT_EQ(count(path, "M"), 3u);  // 0-1, 3, 5
  EXPECT_EQ(count(path, "L"), 1u);
  EXPECT_EQ(count(svg, "<circle"), 2u);  // samples alone are marked
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  plot.log_y = true;
  plot.curves[0].y = {1, 0, -1, 10, 100, 1000};
  svg = svg_plot(plot);
  EXPECT_EQ(count(between(svg, "<path d=\"", "\""), "M"), 2u);
}

TEST(SvgPlot, equal_steps_on_a_logarithmic_axis_are_equal_ratios) {
  Plot plot{"t", "x", "y", {{"c", {1, 2, 3}, {1, 10, 100}}}};
  plot.log_y = true;
  const std::string path = between(svg_plot(plot), "<path d=\"", "\"");
  double x[3], y[3];
  ASSERT_EQ(std::sscanf(path.c_str(), "M%lf %lfL%lf %lfL%lf %lf", x, y, x + 1, y + 1, x + 2, y + 2),
            6);
  // Coordinates are written with one digit.
  EXPECT_NEAR(y[0] - y[1], y[1] - y[2], 0.2);
  EXPECT_NEAR(x[1] - x[0], x[2] - x[1], 0.2);
  EXPECT_GT(y[0], y[2]);  // down is y
}

TEST(SvgPlot, empty_and_constant_plots_are_drawn) {
  for (const bool log : {false, true}) {
    Plot plot{"t", "x", "y", {}};
    plot.log_x = plot.log_y = log;
    EXPECT_TRUE(svg_plot(plot).ends_with("</svg>\n"));
    plot.curves = {{"zero", {1, 2}, {0, 0}}};
    EXPECT_TRUE(svg_plot(plot).ends_with("</svg>\n"));
    // Values that differ by rounding alone.
    plot.curves = {{"nearly", {0.3, 0.1 + 0.2}, {0.1 + 0.2, 0.3}}};
    EXPECT_EQ(svg_plot(plot).find("nan"), std::string::npos);
    plot.curves = {{"seven", {5}, {7}}};
    const std::string svg = svg_plot(plot);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(count(svg, "<circle"), 1u);
  }
}

TEST(SvgPlot, many_curves_are_named_in_as_many_rows_as_they_need) {
  Plot plot{"many", "x", "y", {}};
  const auto height = [&] {
    const std::string box = between(svg_plot(plot), "viewBox=\"0 0 640 ", "\"");
    return std::stod(box);
  };
  plot.curves.push_back({"one", {0, 1}, {0, 1}});
  const double one_row = height();
  for (int i = 0; i < 11; ++i) plot.curves.push_back({"a curve of a long name", {0, 1}, {0, 1}});
  // Three such names fit into a row: four rows.
  EXPECT_EQ(height(), one_row + 3 * 18);
  // The colours of the first eight come again, told apart by their dashes: in the legend and in
  // the plot; the cursor is dashed too.
  EXPECT_EQ(count(svg_plot(plot), "stroke-dasharray"), 4u * 2 + 1);
}

}  // namespace
}  // namespace rilievo
