// thesis.html: one file, no scripts, nothing loaded from elsewhere.
#include <fmt/format.h>

#include <cmath>

#include "ajar/core/markup.hpp"
#include "ajar/thesis/reproduction.hpp"

namespace ajar {
namespace {

constexpr const char* kStyle = R"css(
body{font:15px/1.5 system-ui,'Helvetica Neue',Arial,sans-serif;color:#222;background:#fff;max-width:1180px;margin:0 auto;padding:24px}
h1{font-size:26px;margin:0 0 4px}h2{font-size:19px;margin:36px 0 8px}p{max-width:75ch}
table{border-collapse:collapse;width:100%;font-size:13.5px}th,td{text-align:left;vertical-align:top;padding:6px 8px;border-bottom:1px solid #ddd}
th{position:sticky;top:0;background:#f6f6f6}td.n{text-align:right;white-space:nowrap;font-variant-numeric:tabular-nums}
.yes{color:#00694b;font-weight:600}.no{color:#a63d00;font-weight:600}
figure{margin:28px 0;border:1px solid #e2e2e2;border-radius:6px;padding:12px;overflow-x:auto}figcaption{color:#555;margin-top:6px;max-width:90ch}
figure svg{max-width:100%;height:auto}a{color:#0063a5}
@media print{figure,tr{break-inside:avoid}th{position:static}}
)css";

std::string number(const std::optional<double>& value) {
  if (!value || !std::isfinite(*value)) return "–";
  const double size = std::abs(*value);
  if (size < 5e-5) return "0";
  return size >= 100.0 ? fmt::format("{:.0f}", *value)
         : size >= 1.0 ? fmt::format("{:.3g}", *value)
                       : fmt::format("{:.2g}", *value);
}

std::string table(const std::vector<ThesisStatement>& statements) {
  std::string out =
      "<table>\n<thead><tr><th>Figure</th><th>The thesis says</th><th>stated</th><th>its law</th><th>ours</th><th>unit</th>"
      "<th>holds</th><th>why, and what else was measured</th></tr></thead>\n<tbody>\n";
  for (const ThesisStatement& s : statements) {
    out += fmt::format(
        "<tr><td>{}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td>"
        "<td class=\"{}\">{}</td><td>{}</td></tr>\n",
        escape_markup(s.figure), escape_markup(s.statement), number(s.thesis), number(s.corrected), number(s.ours),
        escape_markup(s.unit), s.holds ? "yes" : "no", s.holds ? "yes" : "no", escape_markup(s.reason));
  }
  return out + "</tbody>\n</table>\n";
}

}  // namespace

std::string to_html(const Reproduction& reproduction) {
  std::string out = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\">"
      "<title>The thesis's experiments</title><style>{}</style></head><body>\n<h1>The thesis's experiments</h1>\n",
      kStyle);
  out +=
      "<p><em>Mobile Robot Manipulator Control for Interacting with 1-DoF Mechanisms</em>, every experiment run again. "
      "<b>Its law</b> is what the thesis prints with the misprints mended and with its own settings: the hand's twist is "
      "constant in "
      "the hand's axes, nothing leads it back to the path, joint rates are clipped one by one. <b>Ours</b> is the default "
      "controller on the same task with the same limits. Numbers come from the runs in <code>runs/</code>; the same rows "
      "stand in "
      "<a href=\"thesis.json\">thesis.json</a>, the drawings in <code>figures/</code>.</p>\n<h2>What the thesis says, and "
      "what the runs "
      "say</h2>\n";
  out += table(reproduction.statements);
  out += "<h2>Figures</h2>\n";
  for (const Figure& figure : reproduction.figures) {
    out += fmt::format("<figure id=\"{}\">\n{}<figcaption>{}</figcaption></figure>\n", figure.name, to_svg(figure),
                       escape_markup(figure.caption));
  }
  return out + "</body></html>\n";
}

}  // namespace ajar
