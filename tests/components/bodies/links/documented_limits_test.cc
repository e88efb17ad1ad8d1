// docs/formats.md states the limits of files as the code has them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "components/base/config/config.h"
#include "components/base/config/yaml_text.h"
#include "components/base/types/json_text.h"
#include "components/base/types/seconds.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/bodies/links/file/xml_text.h"
#include "components/record/recording/compression.h"

namespace sinew {
namespace {

using ::testing::HasSubstr;

TEST(Formats, StateTheLimitsOfFiles) {
  const std::string document = config::ReadFile(std::string(SINEW_SOURCE_DIR) + "/docs/formats.md");
  const auto expect_row = [&document](const std::string& what, auto limit) {
    EXPECT_THAT(document, HasSubstr("| " + what + " | " + std::to_string(limit)));
  };
  expect_row("configuration, deployment, model, URDF, weights: bytes", config::kLargestText);
  expect_row("CSV tables, files of a bag, logs of a bus, meshes: bytes", config::kLargestData);
  expect_row("values of a YAML file, aliases replaced", config::kMostYamlNodes);
  expect_row("its levels, aliases replaced", config::kMostYamlLevels);
  expect_row("levels of a JSON file", types::kDeepestJson);
  expect_row("elements of a URDF inside each other", arm::kMostXmlLevels);
  expect_row("links of a URDF", arm::kMostLinks);
  expect_row("bytes of a chunk of n compressed bytes", recording::MostUncompressed(0));
  expect_row("seconds of a time, anywhere", static_cast<std::int64_t>(types::kLongest_s));
  EXPECT_THAT(
      document,
      HasSubstr("or " + std::to_string(recording::MostUncompressed(1u << 30) >> 30) + " n, "));
}

}  // namespace
}  // namespace sinew
