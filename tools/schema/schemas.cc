#include "tools/schema/schemas.h"

#include "bridge/joints/file/bridge_config.h"
#include "bridge/joints/file/proof_file.h"
#include "bridge/virtual_axes/file/virtual_axes_config.h"
#include "components/learn/esn/dataset/file/training_file.h"
#include "components/learn/esn/file/esn_config.h"
#include "components/learn/rls/file/rls_config.h"
#include "components/model/actuator/file/model_file.h"
#include "components/model/identify/file/processing_file.h"
#include "components/record/recording/file/csv_map_file.h"
#include "components/robot/control/file/control_file.h"
#include "components/robot/estop/estop_config.h"
#include "components/robot/performance/file/performance_file.h"
#include "components/robot/pneumatics/file/pneumatics_file.h"
#include "components/robot/provider/participant/provider_options.h"
#include "components/robot/reference/file/reference_file.h"
#include "components/robot/regime/file/regime_file.h"
#include "components/robot/residual/file/residual_file.h"
#include "sim/body_disturbance/file/schedule_file.h"
#include "sim/stand_ins/recorded_reference/file/recorded_file.h"
#include "sim/surrogate/file/surrogate_file.h"
#include "sim/world/file/world_file.h"
#include "tools/launch/deployment.h"
#include "tools/security/folder.h"
#include "tools/tune_robot/tune_file.h"
#include "tools/view/view_config.h"

namespace sinew::schema {

namespace {

template <class Config>
void Of(config::Fields& fields) {
  Config config;
  Describe(fields, config);
}

// A state provider's, whose program reads the blocks `guard` and `estop` by itself.
template <class Config>
void Guarded(config::Fields& fields) {
  Of<Config>(fields);
  fields.Object("guard", "checks of commands (docs/safety.md)", Of<provider::GuardConfig>);
  if constexpr (std::is_same_v<Config, bridge::BridgeFile>) {
    fields.Object("estop", "without DDS (docs/participants/estop.md)", Of<estop::Block>);
  }
}

void Model(config::Fields& fields) {
  Of<actuator::RobotModel>(fields);
  fields.Object("processing", "of recordings; left out: the data decide",
                Of<identify::ProcessingOptions>);
  fields.If("as_published", "a publication's own processing", Of<identify::AsPublishedOptions>);
  config::Numbers gate;
  fields("data_gate", gate, "kept as it is");
}

}  // namespace

const std::vector<Schema>& AllSchemas() {
  static const std::vector<Schema> kSchemas = {
      {body_disturbance::kSchema, Of<body_disturbance::ScheduleParts>},
      {bridge::kSchema, Guarded<bridge::BridgeFile>},
      {control::kSchema, Of<control::ControlConfig>},
      {recording::kSchema, Of<recording::CsvMap>},
      {launch::kSchema, Of<launch::Deployment>},
      {esn::kEsnSchema, Of<esn::EsnConfig>},
      {esn::kTrainSchema, Of<esn::TrainingPlan>},
      {actuator::kSchema, Model},
      {performance::kSchema, Of<performance::PerformanceConfig>},
      {pneumatics::kSchema, Of<pneumatics::PneumaticsConfig>},
      {tune::kSweepSchema, Of<tune::PressureSweepConfig>},
      {stand_ins::kSchema, Of<stand_ins::RecordedReferenceFile>},
      {reference::kSchema, Of<reference::LoadedReference>},
      {regime::kSchema, Of<regime::RegimeConfig>},
      {residual::kSchema, Of<residual::ResidualConfig>},
      {rls::kSchema, Of<rls::RlsConfig>},
      {security::kMemberSchema, Of<security::MemberFile>},
      {security::kSettingsSchema, Of<security::Settings>},
      {surrogate::kSchema, Guarded<surrogate::RigParameters>},
      {tune::kTuneSchema, Of<tune::TuneFile>},
      {live::kSchema, Of<live::ViewFile>},
      {virtual_axes::kSchema, Of<virtual_axes::VirtualAxesFile>},
      {bridge::kProofSchema, Of<std::vector<bridge::WatchdogProof>>},
      {world::kSchema, Guarded<world::WorldFile>},
  };
  return kSchemas;
}

config::Shape Schema::MakeShape() const {
  auto shape = std::make_shared<config::Shape>();
  config::Fields fields(shape);
  fields.NeedWord("schema", {name}, "what the file is");
  describe(fields);
  return *shape;
}

std::string Schema::FileName() const {
  std::string file = name.substr(name.find('-') + 1) + ".json";
  file[file.find('/')] = '-';
  return file;
}

const Schema& FindSchema(const std::string& name) {
  std::string names;
  for (const Schema& schema : AllSchemas()) {
    const std::string plain = schema.name.substr(0, schema.name.find('/'));
    if (name == schema.name || name == plain || "sinew-" + name == plain) return schema;
    names += (names.empty() ? "" : ", ") + schema.name;
  }
  throw UsageError("'" + name + "' is no schema, expected one of " + names);
}

}  // namespace sinew::schema
