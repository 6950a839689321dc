// What did a benchmark find out?
//
// As "rilievo-bench-1" JSON for programs, as an aligned table for people at a terminal, and as one
// page that holds everything in itself.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "rilievo/measure/html.h"
#include "rilievo/measure/machine.h"
#include "rilievo/measure/svg_plot.h"

namespace rilievo {

// Cells are text; columns of numbers are aligned to the right.
struct Table {
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  // each as long as `columns`
};

struct BenchPicture {
  std::string caption;
  EncodedPicture picture;
};

struct BenchReport {
  std::string bench;  // the name under which `rilievo bench` knows it
  std::string commit = "unknown";
  Machine machine;
  std::vector<std::pair<std::string, double>> figures;  // by their fixed names
  std::vector<Table> tables;
  std::vector<Plot> plots;
  std::vector<std::string> notes;      // sentences
  std::vector<BenchPicture> pictures;  // for the page
};

// {"schema", "bench", "commit", "machine", "figures": {NAME: number}, "series": {"tables": [{title,
// columns, rows}], "plots": [{title, x_label, y_label, curves: [{name, x, y}]}]}, "notes"}. A
// figure that is not finite is null.
[[nodiscard]] std::string bench_json(const BenchReport& report);
// Tables, figures and notes, every line ended.
[[nodiscard]] std::string bench_text(const BenchReport& report);
[[nodiscard]] std::string bench_html(const BenchReport& report);

}  // namespace rilievo
