#include "rilievo/measure/bench_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

using Json = nlohmann::ordered_json;

// Does a cell begin with a number ("12", "-3.5 px", "1e-5")? Empty cells fit any column.
bool is_number(const std::string& cell) {
  if (cell.empty()) return true;
  char* end = nullptr;
  std::strtod(cell.c_str(), &end);
  return end != cell.c_str();
}

bool is_numeric(const Table& table, std::size_t column) {
  return std::all_of(table.rows.begin(), table.rows.end(),
                     [&](const auto& row) { return is_number(row[column]); });
}

// Characters, not bytes: UTF-8's continuation bytes do not count.
std::size_t length(const std::string& text) {
  return std::size_t(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string table_text(const Table& table) {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    widths.push_back(length(table.columns[c]));
    for (const auto& row : table.rows) widths[c] = std::max(widths[c], length(row[c]));
  }
  std::string out;
  const auto line = [&](const std::vector<std::string>& cells) {
    std::string text;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const std::string pad(widths[c] - length(cells[c]), ' ');
      text += c ? "  " : "";
      text += is_numeric(table, c) ? pad + cells[c] : cells[c] + pad;
    }
    text.erase(text.find_last_not_of(' ') + 1);
    out += text + "\n";
  };
  if (!table.title.empty()) out += table.title + "\n";
  line(table.columns);
  std::size_t total = 2 * (widths.empty() ? 0 : widths.size() - 1);
  for (std::size_t w : widths) total += w;
  out += std::string(total, '-') + "\n";
  for (const auto& row : table.rows) line(row);
  return out;
}

std::string table_html(const Table& table) {
  std::string out =
      "<h2>" + html_text(table.title) + "</h2>\n<div class=\"scroll\"><table><thead><tr>";
  for (const std::string& column : table.columns) out += "<th>" + html_text(column) + "</th>";
  out += "</tr></thead><tbody>\n";
  for (const auto& row : table.rows) {
    out += "<tr>";
    for (const std::string& cell : row) out += "<td>" + html_text(cell) + "</td>";
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

Table figures_table(const BenchReport& report) {
  Table table{"Figures", {"figure", "value"}, {}};
  for (const auto& [name, value] : report.figures)
    table.rows.push_back({name, fmt::format("{:.5g}", value)});
  return table;
}

void check([[maybe_unused]] const BenchReport& report) {
  for ([[maybe_unused]] const Table& table : report.tables)
    for ([[maybe_unused]] const auto& row : table.rows)
      RILIEVO_EXPECTS_EQ(row.size(), table.columns.size());
}

}  // namespace

std::string bench_json(const BenchReport& report) {
  check(report);
  Json out;
  out["schema"] = "rilievo-bench-1";
  out["bench"] = report.bench;
  out["commit"] = report.commit;
  out["machine"] = {{"cpu", report.machine.cpu},
                    {"threads", report.machine.threads},
                    {"gl_renderer", report.machine.gl_renderer}};
  Json& figures = out["figures"] = Json::object();
  for (const auto& [name, value] : report.figures) figures[name] = value;
  Json& tables = out["series"]["tables"] = Json::array();
  for (const Table& table : report.tables)
    tables.push_back({{"title", table.title}, {"columns", table.columns}, {"rows", table.rows}});
  Json& plots = out["series"]["plots"] = Json::array();
  for (const Plot& plot : report.plots) {
    Json curves = Json::array();
    for (const Curve& curve : plot.curves)
      curves.push_back({{"name", curve.name}, {"x", curve.x}, {"y", curve.y}});
    plots.push_back({{"title", plot.title},
                     {"x_label", plot.x_label},
                     {"y_label", plot.y_label},
                     {"curves", curves}});
  }
  out["notes"] = report.notes;
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string bench_text(const BenchReport& report) {
  check(report);
  std::string out;
  for (const Table& table : report.tables) out += table_text(table) + "\n";
  if (!report.figures.empty()) out += table_text(figures_table(report));
  for (const std::string& note : report.notes) out += "\n" + note + "\n";
  return out;
}

std::string bench_html(const BenchReport& report) {
  check(report);
  std::string facts, notes, body;
  const auto fact = [&](const char* name, const std::string& value) {
    if (!value.empty())
      facts += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", name, html_text(value));
  };
  fact("Processor", fmt::format("{}, {} thread{}", report.machine.cpu, report.machine.threads,
                                report.machine.threads == 1 ? "" : "s"));
  fact("OpenGL", report.machine.gl_renderer);
  fact("Commit", report.commit);
  for (const std::string& note : report.notes) notes += "<p>" + html_text(note) + "</p>\n";
  if (!report.figures.empty()) body += table_html(figures_table(report));
  if (!report.plots.empty()) {
    body += "<h2>Plots</h2>\n<div class=\"plots\">\n";
    for (const Plot& plot : report.plots) body += svg_plot(plot);
    body += "</div>\n";
  }
  for (const Table& table : report.tables) body += table_html(table);
  if (!report.pictures.empty()) {
    body += "<h2>Pictures</h2>\n<div class=\"frames\">\n";
    for (const BenchPicture& p : report.pictures)
      body +=
          fmt::format("<figure><img src=\"{}\" alt=\"{}\"><figcaption>{}</figcaption></figure>\n",
                      data_uri(p.picture), html_text(p.caption), html_text(p.caption));
    body += "</div>\n";
  }
  const std::pair<std::string_view, std::string> texts[] = {
      {"TITLE", html_text("bench " + report.bench)},
      {"STYLE", std::string(page_style())},
      {"FACTS", facts},
      {"NOTES", notes},
      {"BODY", body},
  };
  return fill_page(bench_page(), texts);
}

}  // namespace rilievo
