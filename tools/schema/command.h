// `sinew schema`: what a configuration may hold, for editors and documents.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace CLI {
class App;
}

namespace sinew::schema {

void AddSchemaCommand(CLI::App& app);

// Path from the root of the tree -> what belongs there: the schemas, and the documents with their
// tables of keys. Throws UsageError: a document names no schema.
std::map<std::filesystem::path, std::string> TreeFiles(const std::filesystem::path& root);

}  // namespace sinew::schema
