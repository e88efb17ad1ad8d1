// Sections on disk, and their pictures through gnuplot.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "components/model/report/section.h"

namespace sinew::report {

// SVG text of each picture. Without gnuplot each is a paragraph that says so. Throws
// std::runtime_error with gnuplot's words when it refuses a script.
std::vector<std::string> DrawPictures(const std::vector<Picture>& pictures);

// The page with its pictures drawn.
std::string DrawnHtml(Page page);

// Draws the pictures and writes folder/section.json and folder/<id>-<n>.svg; section.json comes
// last and as a whole. Makes the folder. Throws std::invalid_argument (CheckSection),
// std::runtime_error (gnuplot), UsageError (folder).
void WriteSection(const std::filesystem::path& folder, Section section);

// Reads folder/section.json. Throws UsageError naming file and key.
Section ReadSection(const std::filesystem::path& folder);

}  // namespace sinew::report
