#include "tools/schema/command.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "tools/schema/print.h"
#include "tools/schema/schemas.h"

namespace sinew::schema {

namespace {

namespace fs = std::filesystem;

struct SchemaOptions {
  std::string name;
  bool table = false;
  std::string root;
};

std::string JsonText(const Schema& schema) {
  nlohmann::ordered_json json{{"$schema", "http://json-schema.org/draft-07/schema#"},
                              {"title", schema.name}};
  json.update(JsonSchema(schema.MakeShape()));
  return json.dump(1) + "\n";
}

// A document with the tables between its marks.
std::string WithTables(const std::string& text, const std::string& file) {
  static constexpr std::string_view kBegin = "<!-- keys of ", kClose = " -->\n",
                                    kEnd = "<!-- end -->";
  std::string out;
  std::size_t at = 0;
  while (true) {
    const std::size_t begin = text.find(kBegin, at), close = text.find(kClose, begin);
    if (begin == std::string::npos) return out + text.substr(at);
    const std::size_t end = text.find(kEnd, begin);
    if (close == std::string::npos || end == std::string::npos) {
      throw UsageError(file + ": '" + std::string(kBegin) + "' without '" + std::string(kEnd) +
                       "'");
    }
    const std::size_t name = begin + kBegin.size();
    out += text.substr(at, close + kClose.size() - at) +
           KeyTable(FindSchema(text.substr(name, close - name)).MakeShape());
    at = end;
  }
}

void Run(const SchemaOptions& options) {
  if (!options.root.empty()) {
    for (const auto& [path, text] : TreeFiles(options.root)) {
      config::WriteFileAtomically(options.root / path, text);
    }
  } else if (options.name.empty()) {
    for (const Schema& schema : AllSchemas()) std::cout << schema.name << '\n';
  } else {
    const Schema& schema = FindSchema(options.name);
    std::cout << (options.table ? KeyTable(schema.MakeShape()) : JsonText(schema));
  }
}

}  // namespace

std::map<fs::path, std::string> TreeFiles(const fs::path& root) {
  std::map<fs::path, std::string> files;
  for (const Schema& schema : AllSchemas()) {
    files[fs::path("schemas") / schema.FileName()] = JsonText(schema);
  }
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / "docs")) {
    if (entry.path().extension() != ".md") continue;
    const std::string text = config::ReadFile(entry.path());
    if (text.find("<!-- keys of ") == std::string::npos) continue;
    files[entry.path().lexically_relative(root)] = WithTables(text, entry.path().string());
  }
  return files;
}

void AddSchemaCommand(CLI::App& app) {
  auto options = std::make_shared<SchemaOptions>();
  CLI::App* command = app.add_subcommand(
      "schema", "Schemas of the configurations, for editors: their names, or one as JSON");
  command->add_option("name", options->name, "Such as sinew-control/1, or control");
  command->add_flag("--table", options->table, "Its keys as a table of Markdown");
  command->add_option("--write", options->root, "Write the schemas and tables of a source tree")
      ->type_name("ROOT");
  command->footer("Example:\n  sinew schema control > control.json");
  command->callback([options] { Run(*options); });
}

}  // namespace sinew::schema
