// The schemas and tables that the tree holds are those of the descriptions, and a description reads
// what is shipped.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

#include "tools/schema/command.h"
#include "tools/schema/print.h"
#include "tools/schema/schemas.h"

namespace sinew::schema {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const fs::path kRoot = SINEW_SOURCE_DIR;

// "sinew-view/1" of "schema: sinew-view/1"; empty: the file has none.
std::string SchemaOf(const std::string& text) {
  const std::size_t at = text.find("schema: sinew-");
  return at == std::string::npos ? "" : text.substr(at + 8, text.find('\n', at) - at - 8);
}

void ReadAs(const Schema& schema, const fs::path& file) {
  const config::Section section = config::Section::Load(file, schema.name);
  config::Fields fields(section);
  schema.describe(fields);
  section.RejectUnknownKeys();
}

TEST(Schema, TheTreeHoldsTheSchemasAndTablesOfTheDescriptions) {
  for (const auto& [path, text] : TreeFiles(kRoot)) {
    ASSERT_TRUE(fs::exists(kRoot / path)) << path << ": run 'sinew schema --write .'";
    EXPECT_EQ(config::ReadFile(kRoot / path), text) << path << ": run 'sinew schema --write .'";
  }
}

TEST(Schema, TheDescriptionReadsEveryShippedFile) {
  std::set<std::string> seen;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kRoot / "robots")) {
    if (entry.path().extension() != ".yaml") continue;
    const std::string name = SchemaOf(config::ReadFile(entry.path()));
    for (const Schema& schema : AllSchemas()) {
      // A deployment looks for programs and interfaces.
      if (schema.name != name || name == "sinew-deployment/1") continue;
      EXPECT_NO_THROW(ReadAs(schema, entry.path())) << entry.path();
      seen.insert(name);
    }
  }
  EXPECT_GE(seen.size(), 15u);
}

// check_schemas.py has the JSON schemas refuse the same files.
TEST(Schema, TheDescriptionRefusesABrokenFileOfEachInOneLine) {
  std::set<std::string> seen;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(kRoot / "tests/tools/schema/broken")) {
    const std::string name = SchemaOf(config::ReadFile(entry.path()));
    seen.insert(name);
    try {
      ReadAs(FindSchema(name), entry.path());
      ADD_FAILURE() << entry.path() << " is accepted";
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), HasSubstr(entry.path().filename().string() + ":"));
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(seen.size(), AllSchemas().size());
}

TEST(Schema, NamesAreSortedAndFoundWithoutVersion) {
  for (std::size_t i = 1; i < AllSchemas().size(); ++i) {
    EXPECT_LT(AllSchemas()[i - 1].name, AllSchemas()[i].name);
  }
  EXPECT_EQ(FindSchema("control").name, "sinew-control/1");
  EXPECT_EQ(FindSchema("sinew-control").FileName(), "control-1.json");
  EXPECT_THROW(static_cast<void>(FindSchema("contral")), UsageError);
}

TEST(Schema, EveryKeyHasALineOfHelp) {
  const std::function<void(const config::Shape&, const std::string&)> check =
      [&](const config::Shape& shape, const std::string& where) {
        for (const config::FieldInfo& field : shape.fields) {
          EXPECT_FALSE(field.help.empty()) << where << field.keys[0];
          EXPECT_EQ(field.help.find_first_of("\n|"), std::string::npos) << where << field.keys[0];
          if (field.entries != nullptr) check(*field.entries, where + field.keys[0] + ".");
        }
      };
  for (const Schema& schema : AllSchemas()) check(schema.MakeShape(), schema.name + ": ");
}

}  // namespace
}  // namespace sinew::schema
