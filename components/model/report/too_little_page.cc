#include "components/model/report/gate_page.h"
#include "components/model/report/report.h"
#include "components/model/report/section.h"

namespace sinew::report {

std::string FormatTooLittleHtml(const Report& report) {
  const trace::TooLittle& too_little = report.trace.too_little.value();
  std::string out = HtmlHead("Closing the loop: " + report.robot);
  out += "<h1>Closing the loop: " + Escape(report.robot) + ", " +
         Escape(report.trace.nominal.name) + "</h1>\n<div class=\"meta\">Model " +
         Escape(report.model_file) + ".</div>\n<div class=\"verdict unexplained\">" +
         Escape(VerdictSentence(report)) + "</div>\n<h2>Next experiment</h2><p>" +
         Escape(NextExperiment(report)) + "</p>\n<h2>The recordings</h2>\n<table>" +
         HtmlRow({"recording", "used for", "rows", "duration, s"}, "th");
  const auto list = [&](const std::vector<Recording>& recordings, const char* use) {
    for (const Recording& recording : recordings) {
      out += HtmlRow({Escape(recording.name), use, std::to_string(recording.rows),
                      Short(recording.duration_s)});
    }
  };
  list(report.train, "training");
  list(report.held_out, "held out");
  out += "</table>\n<table>" + HtmlRow({"rule", "here", "limit"}, "th") +
         HtmlRow({"<code>" + Escape(too_little.rule) + "</code>", Short(too_little.statistic),
                  Short(too_little.limit)}) +
         "</table>\n" + FormatFaultTable(report.faults) + "<h2>The data</h2>\n<ul>";
  for (const identify::Finding& finding : report.findings) {
    out += "<li>" + Escape(finding.text) + "</li>\n";
  }
  return out + "</ul>\n</main></body></html>\n";
}

}  // namespace sinew::report
