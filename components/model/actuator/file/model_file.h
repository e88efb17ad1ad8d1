// Model files: YAML with `schema: sinew-model/1`, and a laboratory's rig.json read as the same
// model.
//
// A parameter's key is its name and unit suffix (effects::UnitSuffix). Every parameter of an effect
// must be there. Throws UsageError (one line: file, line, key, expected).
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "components/base/config/fields.h"
#include "components/model/actuator/model.h"

namespace sinew::actuator {

inline constexpr char kSchema[] = "sinew-model/1";

// Keys of a model file that belong to others.
inline constexpr std::string_view kForeignBlocks[] = {"processing", "as_published", "data_gate"};

struct ModelFile {
  RobotModel robot;
  // The whole file; ask it for Child("processing") and so on, and reject unknown keys there.
  config::Section root = config::Section::Empty("");
  // The foreign blocks as YAML text, by key, so that they survive saving.
  std::map<std::string, std::string> foreign_text;
};

// Every key but those of others.
void Describe(config::Fields& f, RobotModel& c);

// A .json path is read with LoadRigJson, everything else as YAML.
ModelFile LoadModelFile(const std::filesystem::path& path);
RobotModel LoadRobotModel(const std::filesystem::path& path);

// A laboratory's declaration (constants, nominal parameters, the balance of the SEA-PEA rig) as a
// model. Parameters whose trust is not "exact" ("about 5-15 % off") get a tolerance of 10 %.
RobotModel LoadRigJson(const std::filesystem::path& path);

// The text of a model file. `folder`: where it will be, for the relative path of the URDF.
std::string FormatModel(const RobotModel& robot,
                        const std::map<std::string, std::string>& foreign_text,
                        const std::filesystem::path& folder);
// Written as a whole or not at all.
void SaveModelFile(const std::filesystem::path& path, const ModelFile& file);
void SaveRobotModel(const std::filesystem::path& path, const RobotModel& robot);

}  // namespace sinew::actuator
