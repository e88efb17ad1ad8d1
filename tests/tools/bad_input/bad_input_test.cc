// Everything a user can get wrong, as a table: one line that names file, line or key and what was
// expected; exit code 2; nothing half-written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;
using sinew::testing::Finished;
using sinew::testing::Program;
using sinew::testing::TemporaryFolder;
using ::testing::HasSubstr;

constexpr auto kLimit = std::chrono::seconds(30);
const fs::path kRig = fs::path(SINEW_SOURCE_DIR) / "robots/rig";

struct File {
  std::string name, content;
};

struct Row {
  std::string name;                    // of the test
  std::vector<std::string> arguments;  // program first, from the build's bin folder
  std::vector<File> files;             // written into the working folder
  std::vector<std::string> words;      // of the error line
};

void PrintTo(const Row& row, std::ostream* out) { *out << row.name; }

// Lines that are not from the log: those begin with the time.
std::vector<std::string> ErrorLines(const std::string& text) {
  static const std::regex kLog(R"(^\d\d:\d\d:\d\d\.\d{3} )");
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (!std::regex_search(line, kLog)) lines.push_back(line);
  }
  return lines;
}

std::set<std::string> FilesIn(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    names.insert(fs::relative(entry.path(), folder).string());
  }
  return names;
}

// Runs a program in a folder; it must refuse.
void ExpectRefused(std::vector<std::string> arguments, const fs::path& folder,
                   const std::vector<std::string>& words) {
  const std::set<std::string> before = FilesIn(folder);
  arguments[0] = std::string(SINEW_BIN_DIR) + "/" + arguments[0];
  Program program(arguments, folder);
  const int exit_code = program.Wait(kLimit);
  EXPECT_EQ(exit_code, 2) << program.output() << program.error();
  const std::vector<std::string> lines = ErrorLines(program.error());
  ASSERT_EQ(lines.size(), 1u) << program.error();
  for (const std::string& word : words) EXPECT_THAT(lines[0], HasSubstr(word));
  EXPECT_EQ(program.error().find('\x1b'), std::string::npos) << "the log controls the terminal";
  EXPECT_EQ(program.output(), "");
  EXPECT_EQ(FilesIn(folder), before) << "something was written";
}

class BadInput : public ::testing::TestWithParam<Row> {};

TEST_P(BadInput, IsRefusedInOneLineAndNothingIsWritten) {
  const TemporaryFolder folder;
  for (const File& file : GetParam().files) folder.Write(file.name, file.content);
  ExpectRefused(GetParam().arguments, folder.path(), GetParam().words);
}

std::string NameOf(const ::testing::TestParamInfo<Row>& info) { return info.param.name; }

// ---- the sinew command

constexpr char kModel[] =
    "schema: sinew-model/1\n"
    "name: axis\n"
    "joints:\n"
    "  - name: joint\n"
    "    kind: linear\n"
    "    constants: {force_constant_N_V: 35.15}\n"
    "    terms:\n"
    "      - effect: drive_voltage\n"
    "        gain_N_V: {value: 35.15, fixed: true}\n"
    "      - effect: inertia\n"
    "        inertia_kg: {value: 100, tolerance: 0.2}\n"
    "      - effect: viscous\n"
    "        viscous_N_s_m: {value: 200, tolerance: 0.2}\n";

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  return at == std::string::npos ? "the test replaces what is not there"
                                 : text.replace(at, from.size(), to);
}

constexpr char kMap[] =
    "schema: sinew-csv-map/1\n"
    "kind: linear\n"
    "time: {column: t_s, unit: s}\n"
    "signals:\n"
    "  position: {column: x_m, unit: m}\n"
    "  reference_position: {column: r_m, unit: m}\n";
constexpr char kCsv[] = "t_s,x_m,r_m\n0,0,0\n0.1,0.01,0.01\n0.2,0.02,0.02\n";

// Five seconds of a steady motion.
std::string LongCsv(double speed_m_s) {
  std::ostringstream csv("t_s,x_m,r_m\n", std::ios::ate);
  for (int i = 0; i < 500; ++i) {
    csv << 0.01 * i << ',' << 0.01 * i * speed_m_s << ',' << 0.01 * i * speed_m_s << '\n';
  }
  return csv.str();
}

// Twelve lines, in each of which ten aliases of the line before stand.
std::string AliasBomb() {
  std::string text = "x0: &x0 [1]\n";
  for (int i = 1; i <= 12; ++i) {
    const std::string name = "x" + std::to_string(i), before = "*x" + std::to_string(i - 1);
    text += name + ": &" + name + " [" + before;
    for (int k = 1; k < 10; ++k) text += ", " + before;
    text += "]\n";
  }
  return text;
}

// A recording of one chunk: 32 kB of zstd, whose blocks repeat a byte (RFC 8878), for 1 GiB.
std::string DenseRecording() {
  constexpr std::uint64_t kBlocks = 8192, kBlock_bytes = 1u << 17;
  const auto number = [](std::uint64_t value, std::size_t bytes) {
    std::string text;
    for (std::size_t i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i));
    return text;
  };
  const auto record = [&number](int opcode, const std::string& content) {
    return static_cast<char>(opcode) + number(content.size(), 8) + content;
  };
  std::string zstd = number(0xFD2FB528u, 4) + std::string("\0\x38", 2);  // a window of 128 KiB
  for (std::uint64_t i = 1; i <= kBlocks; ++i) {
    zstd += number((kBlock_bytes << 3) | 2u | (i == kBlocks ? 1u : 0u), 3) + '\0';
  }
  const std::string magic = "\x89MCAP0\r\n";
  const std::string chunk = number(0, 8) + number(1, 8) + number(kBlocks * kBlock_bytes, 8) +
                            number(0, 4) + number(4, 4) + "zstd" + number(zstd.size(), 8) + zstd;
  return magic + record(1, number(0, 4) + number(1, 4) + "t") + record(6, chunk) +
         record(15, number(0, 4)) + record(2, number(0, 20)) + magic;
}

std::vector<Row> CommandRows() {
  std::vector<Row> rows = {
      {"LaunchMissingFile", {"sinew", "launch", "no.yaml"}, {}, {"no.yaml", "No such file"}},
      {"LaunchFolder", {"sinew", "launch", "."}, {}, {"folder", "expected a file"}},
      {"LaunchNoYaml",
       {"sinew", "launch", "d.yaml"},
       {{"d.yaml", "a: [1\nb: 2\n"}},
       {"d.yaml:", "no valid YAML"}},
      {"LaunchYamlInItself",
       {"sinew", "launch", "d.yaml"},
       {{"d.yaml", "schema: sinew-deployment/1\nprocesses: &a [*a]\n"}},
       {"d.yaml:2: a value contains itself by an alias"}},
      {"LaunchAliasBomb",
       {"sinew", "launch", "d.yaml"},
       {{"d.yaml", AliasBomb()}},
       {"d.yaml:7: more than 1048576 values with those of aliases, expected fewer"}},
      {"LaunchDevice", {"sinew", "launch", "/dev/zero"}, {}, {"/dev/zero: is a device"}},
      {"LaunchControlCharacters",
       {"sinew", "launch", "d.yaml"},
       {{"d.yaml", "schema: \"\\e[2J\"\n"}},
       {"d.yaml:1: key 'schema': '\\u001b[2J', expected"}},
      {"LogOfControlCharacters",
       {"sinew-surrogate", "--config", "a\x1b[2J.yaml"},
       {},
       {"a\\u001b[2J.yaml: cannot be read"}},
      {"LaunchUnknownKey",
       {"sinew", "launch", "d.yaml"},
       {{"d.yaml",
         "schema: sinew-deployment/1\nprocesses:\n  - name: a\n    program: sh\n    retart: "
         "never\n"}},
       {"d.yaml:5", "processes[0].retart", "unknown"}},
      {"LaunchWrongDomain",
       {"sinew", "launch", "d.yaml", "--domain", "233"},
       {{"d.yaml", "schema: sinew-deployment/1\nprocesses:\n  - {name: a, program: sh}\n"}},
       {"233", "232"}},
      {"ModelMissingFile", {"sinew", "model", "show", "no.yaml"}, {}, {"no.yaml"}},
      {"ModelUnknownKey",
       {"sinew", "model", "show", "m.yaml"},
       {{"m.yaml", Replaced(kModel, "kind: linear", "kind: linear\n    colour: red")}},
       {"m.yaml:6", "colour"}},
      {"ModelWrongUnit",
       {"sinew", "model", "show", "m.yaml"},
       {{"m.yaml", Replaced(kModel, "viscous_N_s_m", "viscous_Nm_s_rad")}},
       {"m.yaml:13", "viscous_Nm_s_rad", "viscous_N_s_m"}},
      {"ModelNotANumber",
       {"sinew", "model", "show", "m.yaml"},
       {{"m.yaml", Replaced(kModel, "value: 100", "value: .nan")}},
       {"m.yaml:11", "expected a"}},
      {"ModelUnknownEffect",
       {"sinew", "model", "show", "m.yaml"},
       {{"m.yaml", Replaced(kModel, "effect: viscous", "effect: viscus")}},
       {"m.yaml:12", "viscus"}},
      {"ModelMissingParameter",
       {"sinew", "model", "show", "m.yaml"},
       {{"m.yaml", Replaced(kModel, "        viscous_N_s_m: {value: 200, tolerance: 0.2}\n", "")}},
       {"m.yaml:12", "viscous_N_s_m", "missing"}},
      {"RigBadJson",
       {"sinew", "model", "from-rig", "r.json", "--out", "m.yaml"},
       {{"r.json", "{\n\"constants\": {\n"}},
       {"r.json", "JSON"}},
      {"RigMissingKey",
       {"sinew", "model", "from-rig", "r.json", "--out", "m.yaml"},
       {{"r.json", "{}"}},
       {"r.json", "constants.gear_ratio"}},
      {"EffectUnknown", {"sinew", "effects", "viscus"}, {}, {"viscus", "expected"}},
      {"ScoreMissingFile", {"sinew", "score", "no.mcap"}, {}, {"no.mcap"}},
      {"ScoreBrokenMcap",
       {"sinew", "score", "b.mcap"},
       {{"b.mcap", "this is no recording at all, but it has some length to it"}},
       {"b.mcap"}},
      {"ScoreEmptyMcap", {"sinew", "score", "b.mcap"}, {{"b.mcap", ""}}, {"b.mcap"}},
      {"ScoreCsvWithoutMapping", {"sinew", "score", "d.csv"}, {{"d.csv", kCsv}}, {"d.csv"}},
      {"ScoreMissingColumn",
       {"sinew", "score", "--map", "m.yaml", "d.csv"},
       {{"m.yaml", Replaced(kMap, "x_m", "y_m")}, {"d.csv", kCsv}},
       {"d.csv", "y_m"}},
      {"ScoreWrongUnit",
       {"sinew", "score", "--map", "m.yaml", "d.csv"},
       {{"m.yaml", Replaced(kMap, "x_m, unit: m", "x_m, unit: kg")}, {"d.csv", kCsv}},
       {"m.yaml:5", "kg"}},
      {"ScoreNotANumber",
       {"sinew", "score", "--map", "m.yaml", "d.csv"},
       {{"m.yaml", kMap}, {"d.csv", Replaced(kCsv, "0.01,0.01", "nan,0.01")}},
       {"d.csv:3", "x_m"}},
      {"ScoreTimeRunsBack",
       {"sinew", "score", "--map", "m.yaml", "d.csv"},
       {{"m.yaml", kMap}, {"d.csv", Replaced(kCsv, "0.2,", "0.1,")}},
       {"d.csv:4", "t_s"}},
      {"ScoreNoReference",
       {"sinew", "score", "--map", "m.yaml", "d.csv"},
       {{"m.yaml", Replaced(kMap, "  reference_position: {column: r_m, unit: m}\n", "")},
        {"d.csv", kCsv}},
       {"reference_position"}},
      {"ImportMissingColumn",
       {"sinew", "import", "d.csv", "--map", "m.yaml", "--out", "o.mcap"},
       {{"m.yaml", Replaced(kMap, "x_m", "y_m")}, {"d.csv", kCsv}},
       {"d.csv", "y_m"}},
      {"ImportNotANumber",
       {"sinew", "import", "d.csv", "--map", "m.yaml", "--out", "o.mcap"},
       {{"m.yaml", kMap}, {"d.csv", Replaced(kCsv, "0.02,0.02", "inf,0.02")}},
       {"d.csv:4", "x_m"}},
      {"ImportUnknownKey",
       {"sinew", "import", "d.csv", "--map", "m.yaml", "--out", "o.mcap"},
       {{"m.yaml", Replaced(kMap, "kind: linear", "kind: linear\nkinds: 2")}, {"d.csv", kCsv}},
       {"m.yaml:3", "kinds"}},
      {"ImportTimeBeyondACentury",
       {"sinew", "import", "d.csv", "--map", "m.yaml", "--out", "o.mcap"},
       {{"m.yaml", kMap}, {"d.csv", Replaced(kCsv, "0.2,", "1e300,")}},
       {"d.csv:4", "t_s", "century"}},
      {"ImportIntoAFolder",
       {"sinew", "import", "d.csv", "--map", "m.yaml", "--out", ".", "--overwrite"},
       {{"m.yaml", kMap}, {"d.csv", kCsv}},
       {".: is a folder, expected the name of a file"}},
      {"ImportIntoAMissingFolder",
       {"sinew", "import", "d.csv", "--map", "m.yaml", "--out", "no/o.mcap"},
       {{"m.yaml", kMap}, {"d.csv", kCsv}},
       {"no/o.mcap"}},
      {"ImportShortRow",
       {"sinew", "import", "d.csv", "--map", "m.yaml", "--out", "o.mcap"},
       {{"m.yaml", kMap}, {"d.csv", Replaced(kCsv, "0.02,0.02", "0.02")}},
       {"d.csv:4"}},
      {"ReplayBrokenMcap",
       {"sinew", "replay", "b.mcap"},
       {{"b.mcap", "this is no recording at all, but it has some length to it"}},
       {"b.mcap", "byte 0"}},
      {"ReplayMissingFile", {"sinew", "replay", "no.mcap"}, {}, {"no.mcap"}},
      {"ReplayWrongDomain",
       {"sinew", "replay", "b.mcap", "--domain", "-1"},
       {{"b.mcap", ""}},
       {"--domain", "232"}},
      {"ListDenseMcap",
       {"sinew", "list", "b.mcap"},
       {{"b.mcap", DenseRecording()}},
       {"b.mcap: byte 26: chunk: 32774 compressed bytes are said to hold 1073741824, expected at "
        "most 67108864"}},
      {"ListBrokenMcap", {"sinew", "list", "b.mcap"}, {{"b.mcap", "nothing"}}, {"b.mcap"}},
      {"EchoUnknownTopic", {"sinew", "echo", "joint_stat"}, {}, {"joint_stat"}},
      {"EchoUnknownField",
       {"sinew", "echo", "joint_state", "--field", "position_deg[0]"},
       {},
       {"position_deg"}},
      {"PlotBrokenMcap",
       {"sinew", "plot", "b.mcap", "joint_state.position_rad[0]"},
       {{"b.mcap", "nothing"}},
       {"b.mcap"}},
      {"PlotTooNarrow",
       {"sinew", "plot", "b.mcap", "joint_state.position_rad[0]", "--width", "3"},
       {},
       {"--width", "40"}},
      {"RecordUnknownTopic",
       {"sinew", "record", "--out", "o.mcap", "--topics", "joint_stat"},
       {},
       {"joint_stat"}},
      {"RecordForAges",
       {"sinew", "record", "--out", "o.mcap", "--duration", "1e300"},
       {},
       {"--duration", "'1e300' s, expected from 0 to 3155760000 (a century)"}},
      {"RecordForNoNumber",
       {"sinew", "record", "--out", "o.mcap", "--duration", "nan"},
       {},
       {"--duration", "expected from 0 to"}},
      {"RecordIntoAMissingFolder",
       {"sinew", "record", "--out", "no/o.mcap", "--domain", "40"},
       {},
       {"no/o.mcap"}},
      {"ExportOfNoRecording",
       {"sinew", "export", "d.csv", "--format", "npz", "--out", "o.npz"},
       {{"d.csv", kCsv}},
       {"d.csv"}},
      {"ExportIntoWhatIsThere",
       {"sinew", "export", "d.csv", "--format", "csv", "--out", "o.csv"},
       {{"d.csv", kCsv}, {"o.csv", kCsv}},
       {"o.csv", "is there already"}},
      {"ExportModelWithoutAUrdf",
       {"sinew", "export-model", "m.yaml", "--format", "mjcf", "--out", "o.xml"},
       {{"m.yaml", kModel}},
       {"m.yaml", "--urdf"}},
      {"CloseLoopMissingColumn",
       {"sinew", "close-loop", "--model", "m.yaml", "--map", "c.yaml", "--train", "d.csv",
        "--held-out", "d.csv", "--out", "found"},
       {{"m.yaml", kModel}, {"c.yaml", Replaced(kMap, "x_m", "y_m")}, {"d.csv", kCsv}},
       {"d.csv", "y_m"}},
      {"CloseLoopNotANumber",
       {"sinew", "close-loop", "--model", "m.yaml", "--map", "c.yaml", "--train", "d.csv",
        "--held-out", "d.csv", "--out", "found"},
       {{"m.yaml", kModel}, {"c.yaml", kMap}, {"d.csv", Replaced(kCsv, "0.01,0.01", "nan,0.01")}},
       {"d.csv:3", "x_m"}},
      {"CloseLoopBadModel",
       {"sinew", "close-loop", "--model", "m.yaml", "--map", "c.yaml", "--train", "d.csv",
        "--held-out", "d.csv", "--out", "found"},
       {{"m.yaml", Replaced(kModel, "viscous_N_s_m", "viscous_Nm_s_rad")},
        {"c.yaml", kMap},
        {"d.csv", kCsv}},
       {"m.yaml:13", "viscous_N_s_m"}},
      {"CloseLoopBrokenMcap",
       {"sinew", "close-loop", "--model", "m.yaml", "--train", "b.mcap", "--held-out", "b.mcap",
        "--out", "found"},
       {{"m.yaml", kModel}, {"b.mcap", "this is no recording at all, but it has some length"}},
       {"b.mcap", "byte 0"}},
      {"CloseLoopMissingRecording",
       {"sinew", "close-loop", "--model", "m.yaml", "--map", "c.yaml", "--train", "no.csv",
        "--held-out", "no.csv", "--out", "found"},
       {{"m.yaml", kModel}, {"c.yaml", kMap}},
       {"no.csv"}},
      {"CloseLoopHeldOutIsTraining",
       {"sinew", "close-loop", "--model", "m.yaml", "--map", "c.yaml", "--train", "d.csv",
        "--held-out", "d.csv", "--out", "found"},
       {{"m.yaml", kModel}, {"c.yaml", kMap}, {"d.csv", kCsv}},
       {"d.csv", "same samples"}},
      {"CloseLoopSignalThatTheModelNeedsIsNotThere",
       {"sinew", "close-loop", "--model", "m.yaml", "--map", "c.yaml", "--train", "d.csv",
        "--held-out", "e.csv", "--out", "found"},
       {{"m.yaml", kModel}, {"c.yaml", kMap}, {"d.csv", LongCsv(0.1)}, {"e.csv", LongCsv(0.2)}},
       {"drive_voltage"}},
      {"TrainMissingModel",
       {"sinew", "train", "--model", "no.yaml", "--recording", "d.csv", "--network", "sea",
        "--config", "c.yaml", "--out", "w.json"},
       {{"d.csv", kCsv}, {"c.yaml", "schema: sinew-esn-train/1\n"}},
       {"yaml"}},
  };
  return rows;
}

INSTANTIATE_TEST_SUITE_P(Command, BadInput, ::testing::ValuesIn(CommandRows()), NameOf);

// ---- participants: their common options, and the configuration that the rig ships for them

struct Participant {
  std::string program;
  std::string config;                  // in robots/rig
  std::vector<std::string> arguments;  // it cannot do without
};

void PrintTo(const Participant& participant, std::ostream* out) { *out << participant.program; }

class BadParticipantInput : public ::testing::TestWithParam<Participant> {
 protected:
  // The rig's folder with one file changed; the configurations name their neighbours.
  void SetUp() override {
    fs::copy(kRig, folder_.path(), fs::copy_options::recursive);
    config_ = (folder_.path() / GetParam().config).string();
  }
  std::string Config() const {
    std::ifstream in(config_);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
  void Refused(const std::vector<std::string>& more, const std::vector<std::string>& words) {
    std::vector<std::string> arguments = {GetParam().program};
    arguments.insert(arguments.end(), GetParam().arguments.begin(), GetParam().arguments.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    ExpectRefused(arguments, folder_.path(), words);
  }

  TemporaryFolder folder_;
  std::string config_;
};

TEST_P(BadParticipantInput, AWrongDomainIsRefused) {
  Refused({"--config", config_, "--domain", "233"}, {"--domain", "232"});
}

TEST_P(BadParticipantInput, AnUnknownOptionIsRefused) {
  Refused({"--config", config_, "--no-such-option"}, {"--no-such-option"});
}

TEST_P(BadParticipantInput, AMissingConfigurationIsNamed) {
  Refused({"--config", "no.yaml"}, {"no.yaml"});
}

TEST_P(BadParticipantInput, AnotherSchemaIsRefused) {
  folder_.Write(GetParam().config, "schema: sinew-other/1\n");
  Refused({"--config", config_}, {":1:", "'sinew-other/1', expected 'sinew-"});
}

TEST_P(BadParticipantInput, AnUnknownKeyIsNamedWithItsLine) {
  const std::string text = Config();
  const auto lines = std::count(text.begin(), text.end(), '\n');
  folder_.Write(GetParam().config, text + "unknown_1: 1\n");
  Refused({"--config", config_}, {":" + std::to_string(lines + 1) + ":", "'unknown_1'"});
}

TEST_P(BadParticipantInput, ANumberThatIsNoneIsNamedWithItsLine) {
  // The first plain number of the file.
  static const std::regex kNumber(
      R"(([\n {][a-z]\w*_(?:Nm|rad|s|ms|Hz|bar|kg|m)\w*: )(-?[0-9][0-9.e+-]*)(?=[\s,}]))");
  std::smatch match;
  const std::string text = Config();
  ASSERT_TRUE(std::regex_search(text, match, kNumber)) << "no number with a unit in it";
  folder_.Write(GetParam().config,
                match.prefix().str() + match[1].str() + ".nan" + match.suffix().str());
  const std::string before = match.prefix().str() + match[1].str();
  const auto line = std::count(before.begin(), before.end(), '\n') + 1;
  Refused({"--config", config_}, {":" + std::to_string(line) + ":", ".nan", "expected"});
}

std::string ProgramOf(const ::testing::TestParamInfo<Participant>& row) {
  std::string name = row.param.program;
  name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
  return name;
}

INSTANTIATE_TEST_SUITE_P(
    Programs, BadParticipantInput,
    ::testing::Values(Participant{"sinew-surrogate", "surrogate.yaml", {}},
                      Participant{"sinew-world", "world.yaml", {}},
                      Participant{"sinew-can-bridge", "can_bridge.yaml", {}},
                      Participant{"sinew-virtual-axes", "virtual_axes.yaml", {}},
                      Participant{"sinew-pneumatics", "pneumatics.yaml", {}},
                      Participant{"sinew-regime", "regime.yaml", {}},
                      Participant{"sinew-esn", "esn_model.yaml", {}},
                      Participant{"sinew-rls", "rls.yaml", {}},
                      Participant{"sinew-control", "control_pid_model.yaml", {}},
                      Participant{"sinew-reference", "reference_benchmark.yaml", {}}),
    ProgramOf);

// ---- robot descriptions

TEST(BadUrdf, IsRefusedWithFileAndWhatWasExpected) {
  const struct {
    std::string from, to;
    std::vector<std::string> words;
  } rows[] = {
      {"<robot", "no robot at all <", {"broken.urdf"}},
      {"<limit", "<limit effort=\"x\"", {"broken.urdf"}},
      {"<mass value=\"", "<mass value=\"-", {"broken.urdf", "mass"}},
  };
  std::ifstream in(kRig / "rig.urdf");
  const std::string urdf{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  for (const auto& row : rows) {
    if (urdf.find(row.from) == std::string::npos) continue;
    const TemporaryFolder folder;
    folder.Write("broken.urdf", Replaced(urdf, row.from, row.to));
    ExpectRefused({"sinew-world", "--config", (kRig / "world.yaml").string(), "--urdf",
                   (folder.path() / "broken.urdf").string()},
                  folder.path(), row.words);
  }
  const TemporaryFolder folder;
  ExpectRefused({"sinew-world", "--config", (kRig / "world.yaml").string(), "--urdf", "no.urdf"},
                folder.path(), {"no.urdf"});
  std::string links, joints;
  for (int i = 0; i < 20000; ++i) {
    const std::string child = std::to_string(i + 1);
    links += "<link name='l" + std::to_string(i) + "'/>\n";
    joints += "<joint name='j" + child + "' type='fixed'><parent link='l" + std::to_string(i) +
              "'/><child link='l" + child + "'/></joint>\n";
  }
  folder.Write("long.urdf",
               "<robot name='r'>\n" + links + "<link name='l20000'/>\n" + joints + "</robot>\n");
  ExpectRefused({"sinew-world", "--config", (kRig / "world.yaml").string(), "--urdf", "long.urdf"},
                folder.path(), {"long.urdf:1002: more than 1000 links, expected fewer"});
}

// ---- outputs

TEST(BadOutput, ADeviceIsWrittenAndNeverReplaced) {
  const TemporaryFolder folder;
  const fs::path device = folder.path() / "full";  // as /dev/full, which a failure would replace
  const bool is_made = ::mknod(device.c_str(), S_IFCHR | 0600, makedev(1, 7)) == 0 &&
                       std::ofstream(device).is_open();
  SKIP_WITHOUT_KERNEL(is_made, "device nodes for this user");
  folder.Write("m.yaml", kMap);
  folder.Write("d.csv", kCsv);
  ExpectRefused({"sinew", "import", "d.csv", "--map", "m.yaml", "--out", "full", "--overwrite"},
                folder.path(), {"full: cannot be written: No space left on device"});
  ExpectRefused({"sinew", "record", "--out", "full", "--domain", "40"}, folder.path(),
                {"full: is there already, expected a new name"});
  EXPECT_TRUE(fs::is_character_file(device));
}

}  // namespace
}  // namespace sinew
