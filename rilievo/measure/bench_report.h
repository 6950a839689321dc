// What did a benchmark find out?
//
// A report is written as "rilievo-bench-1" JSON for programs, as an aligned table for terminals,
// and as one HTML page without external files.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "rilievo/measure/html.h"
#include "rilievo/measure/machine.h"
#include "rilievo/measure/svg_plot.h"

namespace rilievo {

// A table of text cells; columns of numbers are aligned to the right.
struct Table {
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  // each as long as `columns`
};

// A captioned picture on the page.
struct BenchPicture {
  std::string caption;
  EncodedPicture picture;
};

// The results of one benchmark.
struct BenchReport {
  std::string bench;  // the name under which `rilievo bench` knows it
  std::string commit = "unknown";
  Machine machine;
  std::vector<std::pair<std::string, double>> figures;  // name and value; names do not change
  std::vector<Table> tables;
  std::vector<Plot> plots;
  std::vector<std::string> notes;      // sentences
  std::vector<BenchPicture> pictures;  // on the page only
};

// The report as JSON. A figure that is not finite is null.
//   {"schema", "bench", "commit", "machine", "figures": {NAME: number},
//    "series": {"tables": [{title, columns, rows}],
//               "plots": [{title, x_label, y_label, curves: [{name, x, y}]}]}, "notes"}
[[nodiscard]] std::string bench_json(const BenchReport& report);
// Tables, figures and notes as text; each line ends with a newline.
[[nodiscard]] std::string bench_text(const BenchReport& report);
// The page.
[[nodiscard]] std::string bench_html(const BenchReport& report);

}  // namespace rilievo
