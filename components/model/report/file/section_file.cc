#include "components/model/report/file/section_file.h"

#include <nlohmann/json.hpp>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"

namespace sinew::report {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "sinew-section/1";

Json ToJson(const Comparison& line) {
  Json out{{"name", line.name},     {"unit", line.unit},     {"published", line.published},
           {"source", line.source}, {"ours", line.ours},     {"interval", line.interval},
           {"truth", line.truth},   {"target", line.target}, {"met", nullptr},
           {"remark", line.remark}};
  if (line.met) out["met"] = *line.met;
  return out;
}

Comparison ComparisonOf(const Json& json) {
  Comparison line;
  line.name = json.at("name");
  line.unit = json.at("unit");
  line.published = json.at("published");
  line.source = json.at("source");
  line.ours = json.at("ours");
  line.interval = json.at("interval");
  line.truth = json.at("truth");
  line.target = json.at("target");
  if (!json.at("met").is_null()) line.met = json.at("met").get<bool>();
  line.remark = json.at("remark");
  return line;
}

}  // namespace

std::string DrawnHtml(Page page) {
  for (Section& section : page.sections) section.svgs = DrawPictures(section.pictures);
  return FormatHtml(page);
}

void WriteSection(const std::filesystem::path& folder, Section section) {
  CheckSection(section);
  section.svgs = DrawPictures(section.pictures);
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) {
    throw UsageError(folder.string() + ": " + failed.message() + ", expected a writable folder");
  }
  Json json{{"schema", kSchema},
            {"id", section.id},
            {"title", section.title},
            {"seconds", section.seconds},
            {"paragraphs", section.paragraphs},
            {"comparisons", Json::array()},
            {"tables", Json::array()},
            {"pictures", Json::array()}};
  for (const Comparison& line : section.comparisons) json["comparisons"].push_back(ToJson(line));
  for (const Table& table : section.tables) {
    json["tables"].push_back({{"title", table.title},
                              {"caption", table.caption},
                              {"header", table.header},
                              {"rows", table.rows}});
  }
  for (std::size_t i = 0; i < section.pictures.size(); ++i) {
    const std::string file = section.id + "-" + std::to_string(i + 1) + ".svg";
    config::WriteFileAtomically(folder / file, section.svgs[i]);
    json["pictures"].push_back({{"title", section.pictures[i].title},
                                {"caption", section.pictures[i].caption},
                                {"file", file},
                                {"svg", section.svgs[i]}});
  }
  config::WriteFileAtomically(folder / "section.json", types::JsonText(json, 1) + "\n");
}

Section ReadSection(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "section.json";
  const std::string text = config::ReadFile(path, config::kLargestData);
  Json json;
  try {
    json = types::ParseJson<Json>(text, path.string());
  } catch (const std::invalid_argument& problem) {
    throw UsageError(problem.what());
  }
  try {
    if (json.at("schema") != kSchema) {
      throw UsageError(path.string() + ": key 'schema': expected " + kSchema);
    }
    Section section;
    section.id = json.at("id");
    section.title = json.at("title");
    section.seconds = json.at("seconds");
    section.paragraphs = json.at("paragraphs").get<std::vector<std::string>>();
    for (const Json& line : json.at("comparisons")) {
      section.comparisons.push_back(ComparisonOf(line));
    }
    for (const Json& table : json.at("tables")) {
      section.tables.push_back({table.at("title"), table.at("caption"),
                                table.at("header").get<std::vector<std::string>>(),
                                table.at("rows").get<std::vector<std::vector<std::string>>>()});
    }
    for (const Json& picture : json.at("pictures")) {
      section.pictures.push_back({picture.at("title"), picture.at("caption"), ""});
      section.svgs.push_back(picture.at("svg"));
    }
    CheckSection(section);
    return section;
  } catch (const Json::exception& problem) {
    throw UsageError(path.string() + ": " + problem.what());
  } catch (const std::invalid_argument& problem) {
    throw UsageError(path.string() + ": " + problem.what());
  }
}

}  // namespace sinew::report
