// A paper out of a plan: sections are collected, failures listed, and what is there is not made
// again. The command is a script that counts its calls.
#include "reproduction/paper/paper.h"

#include <filesystem>

#include "components/base/config/config.h"
#include "tests/support/temporary_folder.h"

namespace sinew::reproduction {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPlan = R"(schema: sinew-paper/1
title: A paper
introduction: What was measured.
steps:
  - id: good
    command: [measure, good, --trials, 100]
    quick: [measure, good, --trials, 2]
  - id: bad
    command: [fail, "{robots}/rig"]
  - id: silent
    command: [nothing]
)";

// Takes `measure ID ... --out DIR`: writes a section with all its words as title.
constexpr const char* kScript = R"(#!/bin/sh
echo "$@" >> "$(dirname "$0")/calls"
words="$*"
case "$1" in
  fail) echo "first line"; echo "no such thing: $2"; exit 3 ;;
  nothing) exit 0 ;;
esac
while [ "$1" != --out ]; do shift; done
cat > "$2/section.json" <<END
{"schema": "sinew-section/1", "id": "good", "title": "$words", "seconds": 1, "paragraphs": [],
 "comparisons": [], "tables": [], "pictures": []}
END
)";

class Paper : public ::testing::Test {
 protected:
  Paper() {
    options.program = folder.Write("sinew", kScript);
    fs::permissions(options.program, fs::perms::owner_all);
    options.robots = "/robots";
    options.out = folder.path() / "out";
  }
  std::string Calls() const { return config::ReadFile(folder.path() / "calls"); }
  std::string Page() const { return config::ReadFile(options.out / "index.html"); }

  testing::TemporaryFolder folder;
  PaperOptions options;
  PaperPlan plan = LoadPaperPlan(folder.Write("plan.yaml", kPlan));
};

TEST_F(Paper, CollectsSectionsAndReportsFailures) {
  const auto results = MakePaper(plan, options, {});
  ASSERT_EQ(results.size(), 3u);
  EXPECT_TRUE(results[0].ok);
  EXPECT_FALSE(results[1].ok);
  EXPECT_EQ(results[1].cause, "exit code 3: no such thing: /robots/rig");
  EXPECT_FALSE(results[2].ok);
  EXPECT_NE(results[2].cause.find("no section"), std::string::npos);
  EXPECT_NE(Page().find("measure good --trials 100 --out"), std::string::npos);
  EXPECT_NE(Page().find("bad: failed"), std::string::npos);
}

TEST_F(Paper, GoesOnWhereItStopped) {
  MakePaper(plan, options, {});
  const std::string first = Calls();
  const auto results = MakePaper(plan, options, {});
  EXPECT_TRUE(results[0].was_there);
  EXPECT_FALSE(results[1].was_there);
  EXPECT_EQ(Calls().find("good", first.size()), std::string::npos);
  EXPECT_NE(Calls().find("fail", first.size()), std::string::npos);
}

TEST_F(Paper, MakesAnewWhatAnotherCommandMadeOrWhenAsked) {
  options.only = {"good"};
  MakePaper(plan, options, {});
  options.quick = true;
  EXPECT_FALSE(MakePaper(plan, options, {})[0].was_there);
  EXPECT_TRUE(MakePaper(plan, options, {})[0].was_there);
  options.again = true;
  EXPECT_FALSE(MakePaper(plan, options, {})[0].was_there);
}

TEST_F(Paper, AQuickOneLeavesOutWhatHasNoQuickForm) {
  options.quick = true;
  const auto results = MakePaper(plan, options, {});
  ASSERT_EQ(results.size(), 1u);
  EXPECT_EQ(results[0].id, "good");
}

TEST_F(Paper, BadPlansAreRefusedWithFileAndKey) {
  options.only = {"other"};
  EXPECT_THROW(MakePaper(plan, options, {}), UsageError);
  const auto refuse = [&](const std::string& text, const std::string& expected) {
    try {
      LoadPaperPlan(folder.Write("bad.yaml", text));
      ADD_FAILURE() << "accepted: " << text;
    } catch (const UsageError& problem) {
      EXPECT_NE(std::string(problem.what()).find(expected), std::string::npos) << problem.what();
    }
  };
  const std::string head = "schema: sinew-paper/1\ntitle: T\nintroduction: I\n";
  refuse(head + "steps:\n  - id: Two Words\n    command: [x]\n", "bad.yaml:5: key 'steps[0].id'");
  refuse(head + "steps:\n  - id: a\n", "steps[0].command");
  refuse(head + "steps:\n  - {id: a, command: [x]}\n  - {id: a, command: [x]}\n", "twice");
  refuse(head + "steps:\n  - {id: a, command: [x], slow: [y]}\n", "slow");
}

}  // namespace
}  // namespace sinew::reproduction
