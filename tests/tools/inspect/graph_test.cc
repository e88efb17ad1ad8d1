#include "tools/inspect/graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "tools/inspect/run_tool.h"

namespace sinew::inspect {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

node::Endpoint EndpointOf(const std::string& participant, const std::string& guid,
                          const std::string& topic, bool is_writer) {
  node::Endpoint endpoint;
  endpoint.participant = participant;
  endpoint.guid = guid + "|0.0.1.3";
  endpoint.topic = topic;
  endpoint.type_name = "T";
  endpoint.is_writer = is_writer;
  return endpoint;
}

TEST(Graph, WritersPointToTopicsAndTopicsToReaders) {
  const Graph graph = GraphOfDomain({EndpointOf("surrogate", "1", "joint_state", true),
                                     EndpointOf("control", "2", "joint_state", false),
                                     EndpointOf("control", "2", "component_status", true)},
                                    false);
  EXPECT_THAT(graph.participants, ElementsAre("surrogate", "control"));
  const std::string dot = DotText(graph, "rig");
  EXPECT_THAT(dot, HasSubstr("\"p:surrogate\" -> \"t:joint_state\";"));
  EXPECT_THAT(dot, HasSubstr("\"t:joint_state\" -> \"p:control\";"));
  EXPECT_THAT(dot, Not(HasSubstr("component_status")));
  EXPECT_EQ(
      GraphOfDomain({EndpointOf("control", "2", "component_status", true)}, true).links.size(), 1u);
}

TEST(Graph, TwoParticipantsOfOneNameAreTwoBoxes) {
  const Graph graph = GraphOfDomain({EndpointOf("control", "1", "joint_command", true),
                                     EndpointOf("control", "2", "joint_command", true)},
                                    false);
  EXPECT_THAT(graph.participants, ElementsAre("control", "control (2)"));
  EXPECT_EQ(graph.links.size(), 2u);
}

TEST(Graph, AReaderThatNoWriterMatchesIsRed) {
  node::Endpoint reader = EndpointOf("control", "2", "joint_state", false);
  reader.qos.reliable = true;
  const Graph graph =
      GraphOfDomain({EndpointOf("surrogate", "1", "joint_state", true), reader}, false);
  EXPECT_THAT(DotText(graph, "t"),
              HasSubstr("\"t:joint_state\" -> \"p:control\" [color=\"#b5402a\""));
  EXPECT_FALSE(GraphOfDomain({reader}, false).links[0].unmatched) << "nobody writes it";
}

TEST(Graph, AParticipantThatHearsOfOtherOwnersIsAReaderOnlyWhenThereIsOne) {
  const auto alone = GraphOfDomain({EndpointOf("control", "1", "joint_command", true),
                                    EndpointOf("control", "1", "joint_command", false)},
                                   false);
  EXPECT_EQ(alone.links.size(), 1u);
  const auto both = GraphOfDomain({EndpointOf("control", "1", "joint_command", true),
                                   EndpointOf("standby", "2", "joint_command", true),
                                   EndpointOf("standby", "2", "joint_command", false)},
                                  false);
  EXPECT_THAT(DotText(both, "t"), HasSubstr("\"t:joint_command\" -> \"p:standby\";"));
}

TEST(Graph, HostsAreNamedWhereThereAreSeveral) {
  const std::vector<node::Endpoint> endpoints = {EndpointOf("surrogate", "1", "joint_state", true),
                                                 EndpointOf("control", "2", "joint_state", false)};
  const auto id = [&endpoints](std::size_t at) { return node::ParticipantId(endpoints[at]); };
  const std::string two =
      DotText(GraphOfDomain(endpoints, false, {{id(0), "robot"}, {id(1), "desk"}}), "t");
  EXPECT_THAT(two, HasSubstr("\"p:control\" [label=\"control on desk\""));
  EXPECT_THAT(two, HasSubstr("\"p:surrogate\" [label=\"surrogate on robot\""));
  const std::string one =
      DotText(GraphOfDomain(endpoints, false, {{id(0), "robot"}, {id(1), "robot"}}), "t");
  EXPECT_THAT(one, HasSubstr("[label=\"control\""));
}

TEST(Graph, ATopicThatNobodyWritesIsGrey) {
  const Graph graph = GraphOfDomain({EndpointOf("surrogate", "1", "operator_command", false),
                                     EndpointOf("surrogate", "1", "joint_state", true)},
                                    false);
  EXPECT_THAT(graph.unwritten, ElementsAre("operator_command"));
  const std::string dot = DotText(graph, "t");
  EXPECT_THAT(dot, HasSubstr("[label=\"operator_command\", shape=ellipse, color="));
  EXPECT_THAT(dot, HasSubstr("[label=\"joint_state\", shape=ellipse];"));
  EXPECT_THAT(dot, HasSubstr("\"t:operator_command\" -> \"p:surrogate\" [color="));
}

TEST(Graph, OfARecordingTheWriterIsItsMetadataAndTheReadersAreInferred) {
  const std::vector<RecordedParticipant> participants = {
      {"plant", "surrogate"}, {"left", "control"}, {"recorder", "logger"}};
  const Graph graph = GraphOfRecording(
      {{"joint_command", "left"}, {"actuator_state", ""}, {"component_status", ""}}, participants,
      false);
  const std::string dot = DotText(graph, "run.mcap");
  EXPECT_THAT(dot, HasSubstr("\"p:left\" -> \"t:joint_command\";"));
  EXPECT_THAT(dot, HasSubstr("\"t:joint_command\" -> \"p:plant\" [style=dashed];"));
  EXPECT_THAT(dot, HasSubstr("\"p:plant\" -> \"t:actuator_state\" [style=dashed];"));
  EXPECT_THAT(dot, HasSubstr("\"t:actuator_state\" -> \"p:left\" [style=dashed];"));
  EXPECT_THAT(dot, Not(HasSubstr("\"p:recorder\""))) << "it only records";
  EXPECT_THAT(DotText(GraphOfRecording({}, participants, true), "t"), HasSubstr("\"p:recorder\""));
  EXPECT_THAT(dot, Not(HasSubstr("\"t:actuator_state\" -> \"p:plant\""))) << "its own topic";
  EXPECT_THAT(dot, Not(HasSubstr("\"t:joint_command\" -> \"p:left\""))) << "a condition";
}

TEST(Graph, AWriterWithoutStatusIsABoxAllTheSame) {
  const Graph graph = GraphOfRecording({{"reference", "script"}}, {}, false);
  EXPECT_THAT(graph.participants, ElementsAre("script"));
}

TEST(Graph, NamesWithQuotesAreDrawnByGraphviz) {
  const Graph graph = GraphOfDomain({EndpointOf("a \"b\" \\", "1", "joint_state", true)}, false);
  const std::string svg = OutputOf("dot", "graphviz", {"-Tsvg"}, DotText(graph, "x \"y\""));
  EXPECT_THAT(svg, HasSubstr("<svg"));
  EXPECT_THAT(svg, HasSubstr("joint_state"));
  EXPECT_THAT(svg, HasSubstr("a &quot;b&quot;"));
}

}  // namespace
}  // namespace sinew::inspect
