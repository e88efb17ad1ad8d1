#include <boost/process.hpp>
#include <functional>
#include <stdexcept>

#include "components/model/report/file/section_file.h"

namespace sinew::report {

namespace {

namespace process = boost::process;

void ReplaceAll(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

// Several pictures in one page must not share names: theirs come from what they show.
std::string Inline(std::string svg, const std::string& script) {
  const std::size_t start = svg.find("<svg");
  if (start == std::string::npos) throw std::runtime_error("gnuplot wrote no SVG");
  svg.erase(0, start);
  const std::string prefix = "p" + std::to_string(std::hash<std::string>{}(script)) + "_";
  for (const char quote : {'\'', '"'}) {
    const std::string q(1, quote);
    ReplaceAll(svg, "id=" + q + "gp", "id=" + q + prefix + "gp");
    ReplaceAll(svg, "id=" + q + "gnuplot", "id=" + q + prefix + "gnuplot");
    ReplaceAll(svg, "href=" + q + "#gp", "href=" + q + "#" + prefix + "gp");
    ReplaceAll(svg, "url(#gp", "url(#" + prefix + "gp");
  }
  return svg;
}

}  // namespace

std::vector<std::string> DrawPictures(const std::vector<Picture>& pictures) {
  const auto program = process::search_path("gnuplot");
  if (program.empty()) {  // docs/decisions/0005: the report is worth more than its pictures
    return std::vector<std::string>(pictures.size(),
                                    "<p class=\"caption\">gnuplot was not found (apt-get install "
                                    "gnuplot-nox): no picture.</p>");
  }
  std::vector<std::string> out;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    boost::asio::io_context io;
    std::future<std::string> svg;
    std::future<std::string> words;
    process::child child(
        program, process::std_in<boost::asio::buffer(pictures[i].script), process::std_out> svg,
        process::std_err > words, io);
    io.run();
    child.wait();
    const std::string complaint = words.get();
    if (child.exit_code() != 0 || complaint.find("error") != std::string::npos) {
      throw std::runtime_error("gnuplot refused '" + pictures[i].title + "': " + complaint);
    }
    out.push_back(Inline(svg.get(), pictures[i].script));
  }
  return out;
}

}  // namespace sinew::report
