// `sinew export-model`: a model file in the formats of other simulators.
#pragma once

namespace CLI {
class App;
}

namespace sinew::export_model {

void AddExportModelCommand(CLI::App& app);

}  // namespace sinew::export_model
